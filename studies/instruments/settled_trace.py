"""A settled orbit against time: tip, read-out point, impacts, contact force.

Time counts from the strobe at which the trace begins.  The tip position relative to the plate is
h = phi . q - gap [m], above zero where the ball is pressed into the plate; the contact force follows from it
by the contact law, N = k h (+ c h') or k h^(3/2) (1 + chi h').
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.collision import Collision, collisions
from contact.laws import HERTZ, LINEAR
from contact.orbits.settling import born
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stroboscope import StroboscopicMap
from contact.trajectory import ImpactKind, State, Trajectory
from studies.instruments.spring_of_scene import READOUT

__all__ = ["CloseUp", "Trace", "close_up", "settled_state", "trace_of"]

PER_PERIOD = 16_384
"""Samples in a drive period: at 21.5 Hz up to 176 kHz without folding, beyond what the spectrum shows."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trace:
    """The motion over some orbit periods.

    Parameters
    ----------
    period : int
        Of the orbit in drive periods; 0 if none was found.
    time, tip, readout : ndarray, shape (n_samples,)
        Time [s], tip displacement [m], read-out [m or rad].
    impact_times : ndarray
        First touches [s].
    collisions : list of Collision
        Those that are final.
    """

    period: int
    time: np.ndarray
    tip: np.ndarray
    readout: np.ndarray
    impact_times: np.ndarray
    collisions: list[Collision]


@dataclass(frozen=True, kw_only=True, eq=False)
class CloseUp:
    """One collision: time from the first touch [s], tip relative to the plate [m], contact force [N].

    `spans` holds begin and end of each impact; the force is not a number for an impact law.
    """

    time: np.ndarray
    height: np.ndarray
    force: np.ndarray
    spans: list[tuple[float, float]]


def settled_state(oscillator: ImpactOscillator, cycles: int) -> tuple[int, State]:
    """Period of the orbit that settles when the drive is raised from below grazing, and its strobed state."""
    settled = born(StroboscopicMap(oscillator=oscillator), oscillator.excess, most_cycles=cycles)
    return settled.period, settled.end


def trace_of(oscillator: ImpactOscillator, state: State, period: int, length: int) -> Trace:
    """The motion over `length` drive periods from `state`; `period` is that of the orbit."""
    begin, span = state.time, length * oscillator.period
    time = span * np.arange(length * PER_PERIOD) / (length * PER_PERIOD)
    run = simulate(oscillator, state, periods=length + 2, times=begin + time)
    touches = run.impacts.start[(run.impacts.kind == ImpactKind.IMPACT) & (run.impacts.start < begin + span)]
    model = oscillator.model
    return Trace(
        period=period,
        time=time,
        tip=run.displacement @ model.phi,
        readout=run.displacement @ model.readouts[READOUT],
        impact_times=touches - begin,
        collisions=[
            c for c in collisions(oscillator, run, unfinished="drop") if c.first_touch < begin + span
        ],
    )


def close_up(
    oscillator: ImpactOscillator, state: State, collision: Collision, margin: float, count: int
) -> CloseUp:
    """A collision of the motion from `state`, with `margin` [s] before and after it, in `count` samples."""
    first, last = collision.first_touch - margin, collision.end + margin
    times = np.linspace(max(first, state.time), last, count)
    run = simulate(oscillator, state, duration=last - state.time + margin, times=times)
    impacts = run.impacts
    inside = (impacts.start >= first) & (impacts.start <= collision.end)
    model = oscillator.model
    height = run.displacement @ model.phi - oscillator.stop.gap
    return CloseUp(
        time=times - collision.first_touch,
        height=height,
        force=contact_force(oscillator, height, run.velocity @ model.phi, times, run),
        spans=[
            (float(a) - collision.first_touch, float(b) - collision.first_touch)
            for a, b in zip(impacts.start[inside], impacts.end[inside], strict=True)
        ],
    )


def contact_force(
    oscillator: ImpactOscillator, height: np.ndarray, velocity: np.ndarray, times: np.ndarray, run: Trajectory
) -> np.ndarray:
    """Force of the plate on the ball [N] at `times`, zero out of contact; not a number for an impact law."""
    law = oscillator.stop.law
    k, loss = law.numbers
    depth = np.maximum(height, 0.0)
    if law.code == LINEAR:
        force = k * depth + loss * velocity
    elif law.code == HERTZ:
        force = k * depth**1.5 * (1.0 + loss * velocity)
    else:
        return np.full(height.shape, np.nan)
    begin, end = run.impacts.start, run.impacts.end
    touching = np.any((times[:, None] >= begin) & (times[:, None] <= end), axis=1)
    return np.where(touching, np.maximum(force, 0.0), 0.0)
