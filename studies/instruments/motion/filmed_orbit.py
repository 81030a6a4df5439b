"""A settled motion at the times of a film.

Times count from the strobe at which the film begins. A motion that repeats after m drive periods is filmed
for these m, so that the frame after the last is the first again; one without a period for `APERIODIC` of
them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import ImpactKind, State, Trajectory
from studies.instruments.motion.time_law import TimeLaw, time_law
from studies.instruments.settled_trace import contact_force

__all__ = ["FilmedOrbit", "Line", "film_orbit"]

APERIODIC = 4
"""Drive periods shown of a motion that has no period."""

LINE_POINTS = 400
"""Points of the drawn line in a drive period; the modes above the fourth do not show at the tip."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """Tip displacement [m] and velocity [m/s] over time [s], each of shape (n_points,)."""

    time: NDArray[np.float64]
    tip: NDArray[np.float64]
    velocity: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmedOrbit:
    """What a film shows.

    Parameters
    ----------
    oscillator : ImpactOscillator
    period : int
        Of the orbit in drive periods; 0 if it has none.
    duration : float
        [s].
    law : TimeLaw
        The times of the frames.
    coordinates : ndarray, shape (n_frames, n_modes)
        q_k of the modal model [kg^(1/2) m].
    tip, velocity, base, force : ndarray, shape (n_frames,)
        Tip displacement relative to the base [m], its rate [m/s], displacement of the base [m] and contact
        force [N]; the force is not a number under a law of restitution.
    touching : ndarray of bool, shape (n_frames,)
        Whether ball and plate touch while the frame stands.
    strobes, line : Line
        The motion at the strobes and throughout.
    contacts : list of (float, float)
        Begin and end of every contact that begins within the film [s].
    """

    oscillator: ImpactOscillator
    period: int
    duration: float
    law: TimeLaw
    coordinates: NDArray[np.float64]
    tip: NDArray[np.float64]
    velocity: NDArray[np.float64]
    base: NDArray[np.float64]
    force: NDArray[np.float64]
    touching: NDArray[np.bool_]
    strobes: Line
    line: Line
    contacts: list[tuple[float, float]]


def film_orbit(
    oscillator: ImpactOscillator, state: State, period: int, *, frames: int, rate: float
) -> FilmedOrbit:
    """The motion from `state`, which lies at a strobe, in at most `frames` frames at `rate` a second."""
    assert oscillator.drive is not None
    length = period or APERIODIC
    duration, begin = length * oscillator.period, state.time
    contacts = _contacts(simulate(oscillator, state, periods=length + 1), begin, duration)
    around = contacts
    if period:
        around = [(a + n * duration, b + n * duration) for n in (-1, 0, 1) for a, b in contacts]
    law = time_law(duration, around, frames=frames, rate=rate)
    run = _at(oscillator, state, law.time, length)
    even = np.linspace(0.0, duration, length * LINE_POINTS + 1)
    edges = [edge for span in contacts for edge in span if 0.0 <= edge <= duration]
    everywhere = _at(oscillator, state, np.unique(np.concatenate([even, edges])), length)
    phi = oscillator.model.phi
    tip, velocity = run.displacement @ phi, run.velocity @ phi
    force = contact_force(oscillator, tip - oscillator.stop.gap, velocity, run.time, run)
    at_strobes = _at(oscillator, state, np.arange(length) * oscillator.period, length)
    return FilmedOrbit(
        oscillator=oscillator,
        period=period,
        duration=duration,
        law=law,
        coordinates=run.displacement,
        tip=tip,
        velocity=velocity,
        base=oscillator.drive.displacement(law.time),
        force=force,
        touching=law.during(around),
        strobes=_line(at_strobes, begin, phi),
        line=_line(everywhere, begin, phi),
        contacts=contacts,
    )


def _contacts(run: Trajectory, begin: float, duration: float) -> list[tuple[float, float]]:
    """Contacts that begin before `duration`, times from `begin`; grazes are none."""
    impacts = run.impacts
    felt = impacts.kind != ImpactKind.GRAZE
    start, end = impacts.start[felt] - begin, impacts.end[felt] - begin
    end = np.where(np.isfinite(end), end, run.end.time - begin)
    inside = start < duration
    return list(zip(start[inside].tolist(), end[inside].tolist(), strict=True))


def _at(oscillator: ImpactOscillator, state: State, times: NDArray[Any], length: int) -> Trajectory:
    return simulate(oscillator, state, periods=length, times=state.time + times)


def _line(run: Trajectory, begin: float, phi: NDArray[np.float64]) -> Line:
    return Line(time=run.time - begin, tip=run.displacement @ phi, velocity=run.velocity @ phi)
