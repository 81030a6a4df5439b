"""Response curves: orbits of period 1 along a path of oscillators, from the motion that has settled on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact import ImpactOscillator, State, simulate
from contact.orbits import Branch, PeriodicOrbit, Shooting, follow_path
from studies.validation.rows import Curve

__all__ = ["drawn", "followed", "motion"]

Array = NDArray[np.float64]
Path = Callable[[float], ImpactOscillator]

SAMPLES = 128
"""Of a period."""


def followed(path: Path, at: float, *, low: float, high: float, step: float, settling: int = 400) -> Branch:
    """The curve through the motion that has settled at `at`, from rest in `settling` periods."""
    here = path(at)
    settled = replace(simulate(here, State.rest(here.n_modes), periods=settling).end, time=0.0)
    touches = simulate(here, settled, periods=1).impacts.kind.size
    start = Shooting(oscillator=here, period=1, impacts=touches).from_state(settled)
    return follow_path(path, start, at, low=low, high=high, step=step)


def motion(orbit: PeriodicOrbit) -> tuple[Array, Array]:
    """Times from a strobe on [s] and modal displacements, shape (`SAMPLES`, n_modes), over one period."""
    times = np.arange(SAMPLES) / SAMPLES * orbit.duration
    run = simulate(
        orbit.oscillator, replace(orbit.strobe_state(), time=0.0), periods=orbit.period, times=times
    )
    return times, run.displacement


def drawn(
    branch: Branch, size: Callable[[PeriodicOrbit], float], unit: float = 1.0, look: int = 0
) -> list[Curve]:
    """Sizes of the orbits along a curve over its parameter in `unit`: the stable ones, and the others up to
    their neighbours."""
    stable = np.array([orbit.stable for orbit in branch.orbits])
    x, y = np.array(branch.parameters) / unit, np.array([size(orbit) for orbit in branch.orbits])
    beside = np.convolve(~stable, np.ones(3), "same") > 0.0
    return [
        Curve(x=np.where(part, x, np.nan), y=y, name=name, look=look, faint=name == "unstable")
        for part, name in ((stable, "stable"), (beside, "unstable"))
    ]
