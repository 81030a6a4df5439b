"""Median times of repeated runs.

What is compared is timed in turns, A B A B ..., so that a machine that slows down slows both; the processor
time of the thread is taken where one thread works, the time that passes where several do.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from statistics import median

__all__ = ["in_turns"]

REPEATS = 7


def in_turns(
    runs: Mapping[str, Callable[[], object]], repeats: int = REPEATS, *, passing: bool = False
) -> dict[str, float]:
    """Median seconds of each run, after one of each to warm up.

    `passing` takes the time that passes instead of the thread's own.
    """
    clock = time.perf_counter if passing else time.thread_time
    spent: dict[str, list[float]] = {name: [] for name in runs}
    for run in runs.values():
        run()
    for _ in range(repeats):
        for name, run in runs.items():
            began = clock()
            run()
            spent[name].append(clock() - began)
    return {name: median(times) for name, times in spent.items()}
