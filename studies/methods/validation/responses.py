"""Response curves: orbits of period 1 along a path of oscillators, from the motion that has settled on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contact import ImpactOscillator, State, simulate
from contact.orbits import Branch, PeriodicOrbit, Shooting, follow_path
from studies.methods.validation.rows import Curve

Array = NDArray[np.float64]
SAMPLES = 128
"""Of a period."""


def followed(
    path: Callable[[float], ImpactOscillator],
    at: float,
    *,
    low: float,
    high: float,
    step: float,
    settling: int = 400,
) -> Branch:
    """The curve through the motion that has settled at `at`, from rest in `settling` periods."""
    here = path(at)
    settled = replace(simulate(here, State.rest(here.n_modes), periods=settling).end, time=0.0)
    touches = simulate(here, settled, periods=1).impacts.kind.size
    start = Shooting(oscillator=here, period=1, impacts=touches).from_state(settled)
    return follow_path(path, start, at, low=low, high=high, step=step)


def motion(orbit: PeriodicOrbit) -> tuple[Array, Array]:
    """Times from a strobe on [s] and modal displacements, shape (`SAMPLES`, n_modes), over one orbit."""
    times = np.arange(SAMPLES) / SAMPLES * orbit.duration
    start = replace(orbit.strobe_state(), time=0.0)
    return times, simulate(orbit.oscillator, start, periods=orbit.period, times=times).displacement


def harmonic(orbit: PeriodicOrbit, readout: str) -> complex:
    """First harmonic of a read-out [m]; along -i it is a quarter period later than the base."""
    times, modes = motion(orbit)
    turning = np.exp(-2j * np.pi * times / orbit.duration)
    return complex(2j * np.mean(turning * (modes @ orbit.oscillator.model.readouts[readout])))


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
