"""Eq. (1) with the hard wall: time per drive period on settled orbits, one by one and many on two cores."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from contact.stroboscope import StroboscopicMap, strobed_orbits
from studies.instruments.benchmarks.bare_heyoka import batch_of, orbit_of
from studies.instruments.benchmarks.floor import carry, flows_of
from studies.instruments.benchmarks.timing import in_turns
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene

__all__ = ["EXCESS", "batch_rows", "single_rows"]

EXCESS = 0.02
SETTLING = 2000
"""Drive periods before the clock starts: a free motion falls to 0.92 in each."""

CORES, BATCH = 2, 32
"""Threads, and orbits in all: two batches of the widest kind on each."""


def _lanes() -> int:
    """Orbits side by side in one of heyoka's batches, as many as it recommends for this machine."""
    import heyoka as hy

    return int(min(hy.recommended_simd_size(), BATCH // CORES))


def _row(case: str, tool: str, frequency: float, microseconds: float, **more: Any) -> dict[str, Any]:
    return {
        "case": case, "tool": tool, "modes": 1, "law": "newton", "frequency_hz": frequency,
        "us_per_period": microseconds, "error": None, "missed": None, **more,
    }  # fmt: skip


def single_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[dict[str, Any]]:
    """One orbit at excess 0.02: the package, the floor and, if asked for, heyoka."""
    ours, theirs = (2000, 200) if quick else (20000, 2000)
    oscillator = single_mode_oscillator(scene, frequency).with_excess(EXCESS)
    strobed = StroboscopicMap(oscillator=oscillator)
    state = strobed.orbit(strobed.steady(), SETTLING).end
    impacts = strobed.orbit(state, ours).impacts.sum() / ours
    flow, u, v = flows_of(oscillator), np.full(1, 1e-3), np.full(1, 1e-3)
    runs: dict[str, Callable[[], object]] = {
        "grazing-spring": lambda: strobed.orbit(state, ours),
        "floor": lambda: carry(flow, np.ones(1), 1.0, u, v, ours),
    }
    length = {"grazing-spring": ours, "floor": ours, "heyoka": theirs}
    if peers:
        orbit = orbit_of(oscillator)
        orbit(SETTLING)
        runs["heyoka"] = lambda: orbit(theirs)
    spent = in_turns(runs, 3 if quick else 7)
    return [
        _row("single mode", tool, frequency, 1e6 * seconds / length[tool], impacts_per_period=float(impacts))
        for tool, seconds in spent.items()
    ]


def batch_rows(scene: Scene, frequency: float, *, quick: bool, peers: bool) -> list[dict[str, Any]]:
    """Many orbits on two cores, time per orbit and drive period: our lanes, or heyoka's batches."""
    ours, theirs = (2000, 200) if quick else (20000, 1000)
    base = single_mode_oscillator(scene, frequency)
    oscillators = [base.with_excess(EXCESS + 1e-4 * i) for i in range(BATCH)]
    maps = [StroboscopicMap(oscillator=oscillator) for oscillator in oscillators]
    states = [one.orbit(one.steady(), SETTLING).end for one in maps]
    with ThreadPoolExecutor(CORES) as pool:
        runs: dict[str, Callable[[], object]] = {
            "grazing-spring": lambda: strobed_orbits(maps, states, ours, workers=CORES)
        }
        length = {"grazing-spring": ours, "heyoka": theirs}
        if peers:
            lanes = _lanes()
            batches = [batch_of(oscillators[i : i + lanes]) for i in range(0, BATCH, lanes)]
            for batch in batches:
                batch(SETTLING)
            runs["heyoka"] = lambda: list(pool.map(lambda batch: batch(theirs), batches))
        spent = in_turns(runs, 3 if quick else 7, passing=True)
    return [
        _row("batch on two cores", tool, frequency, 1e6 * seconds / length[tool] / len(maps))
        for tool, seconds in spent.items()
    ]
