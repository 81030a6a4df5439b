"""How long calls take: the thread's own time, in turns, the median of warm runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Mapping
from statistics import median
from typing import TypeVar

Name = TypeVar("Name", bound=Hashable)
Orbit = Callable[[int], object]
"""orbit(periods): carries a motion on by that many drive periods."""


def in_turns(runs: Mapping[Name, tuple[Orbit, int]], repeats: int) -> dict[Name, float]:
    """Median microseconds per drive period of each orbit over its periods.

    Compared programs run in turns, A B A B ..., so that a machine that slows down slows both. Each runs once
    before the clock starts.
    """
    spent: dict[Name, list[float]] = {name: [] for name in runs}
    for orbit, periods in runs.values():
        orbit(periods)
    for _ in range(repeats):
        for name, (orbit, periods) in runs.items():
            began = time.thread_time()
            orbit(periods)
            spent[name].append(1e6 * (time.thread_time() - began) / periods)
    return {name: median(times) for name, times in spent.items()}


def timed(call: Callable[[], object], repeats: int) -> float:
    """Median microseconds of a call."""
    return in_turns({"": (lambda _: call(), 1)}, repeats)[""]
