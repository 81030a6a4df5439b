"""A part of a motion, and one of its collisions close by: tip past the plate, and the contact force.

    N = k d + c d'  (linear),   N = k d^(3/2) (1 + chi d')  (Hertz: chi = 0),   at depth d [m], rate d' [m/s]

A law of restitution has no force: not a number. Between several stops the touches are listed instead of
collisions, which are defined for one stop.

The spectrum: a signal of period P, sampled over a whole number of periods, is a sum of lines at the multiples
of 1/P,

    x(t) = a_0 + sum_j a_j cos(2 pi j t / P + phase_j),

and the discrete Fourier transform gives a_j without leakage and without a window.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from beam import InvalidType
from contact import (
    Collision,
    HertzContact,
    HuntCrossley,
    ImpactKind,
    ImpactOscillator,
    LinearContact,
    NewtonRestitution,
    PowerContact,
    State,
    Trajectory,
    collisions,
    simulate,
)
from studies import letter
from studies.shell.scene import READOUT, Scene, own_frequency

PER_PERIOD = 16_384
"""Samples in a drive period: at 21.5 Hz up to 176 kHz without folding, beyond what the spectrum shows."""

MARGIN, LEAST_MARGIN, SAMPLES = 2.0, 50e-6, 1201
"""Time before and after in contact times, and at least [s]; samples."""

WORDS = {
    "time": "time at which mode 1 reaches the gap [s]; of the first touch where ringing made it",
    "end": "last release [s]",
    "approach": "approach velocity of mode 1 [m/s]; none where ringing made the touch",
    "restitution": "restitution τ; none where mode 1 does not come back to the gap",
    "delay": "time delay [s]; negative where mode 1 would have left the plate before it comes",
    "kick": "kick of mode 1 over its approach velocity; none where ringing made the touch",
    "kick_velocity": "kick of mode 1 [m/s]; positive away from the plate",
    "shift": "jump of the mode-1 tip displacement [m]",
    "deceleration": "deceleration of mode 1 at the gap [m/s^2]",
    "impacts": "impacts in the collision",
    "contact_time": "total time in contact [s]",
    "first_touch": "time of the first touch [s]",
    "real_approach": "velocity of the tip at the first touch [m/s]",
    "ringing": "amplitude of the ringing of higher modes at the tip before the collision [m]",
    "energy_to_higher_modes": "energy that the higher modes gain [J]",
    "energy_lost": "energy lost in the contact [J]",
    "impulse": "impulse of the plate [N s]",
    "peak_force": "largest contact force [N]; none under Newton's law",
    "forced_by_ringing": "ringing made the touch; mode 1 alone would not reach the gap",
    "returns": "mode 1 comes back to the gap",
}
"""What the fields of a collision hold, as the columns of a table."""

Array = NDArray[np.float64]


NEEDS = {"tip_trace": 2e-3, "kick": 0.005, "restitution": 0.01}
"""Answers of a study of one orbit, with their largest errors."""


def conditions(scene: Scene, options: Mapping[str, Any]) -> tuple[list[float], float]:
    """Drive frequency [Hz] and excess of the command."""
    given = options["frequency"]
    return [own_frequency(scene, letter.TIME_TRACE_HZ) if given is None else given], options["excess"]


def repeats(m: int) -> str:
    """When the motion repeats."""
    if not m:
        return "the motion has no period up to 64 drive periods"
    whole = "each drive period" if m == 1 else f"{m} drive periods"
    return f"the settled motion repeats after {whole}"


@dataclass(frozen=True, kw_only=True, eq=False)
class Trace:
    """The motion from a strobe on: tip [m] and read-out [m or rad] over time [s]."""

    time: Array
    tip: Array
    readout: Array
    impact_times: Array
    impacts: list[Touch]
    collisions: list[Collision]


@dataclass(frozen=True, kw_only=True)
class Touch:
    """An impact on one of the stops; the fields are as in `contact.Impacts`."""

    stop: Annotated[int, "number of the stop; 0 is that of [stop]"]
    start: Annotated[float, "time of the touch [s]"]
    end: Annotated[float, "time of the release [s]"]
    approach: Annotated[float, "velocity towards the stop at the touch [m/s]"]
    rebound: Annotated[float, "velocity towards the stop at the release [m/s]"]
    peak_force: Annotated[float, "largest contact force [N]; none under Newton's law"]


@dataclass(frozen=True, kw_only=True, eq=False)
class CloseUp:
    """Time from the first touch [s], tip past the plate [m], contact force [N]; `spans` are the contacts
    [s]."""

    time: Array
    height: Array
    force: Array
    spans: list[tuple[float, float]]


def trace_of(oscillator: ImpactOscillator, state: State, length: int) -> Trace:
    """The motion over `length` drive periods from `state`."""
    begin, span = state.time, length * oscillator.period
    time = span * np.arange(length * PER_PERIOD) / (length * PER_PERIOD)
    run = simulate(oscillator, state, periods=length + 2, times=begin + time)
    impacts, names = run.impacts, [field.name for field in fields(Touch)]
    felt = (impacts.kind == ImpactKind.IMPACT) & (impacts.start < begin + span)
    columns = [getattr(impacts, name)[felt].tolist() for name in names]
    final = [] if len(oscillator.stops) > 1 else collisions(run, unfinished="drop")
    return Trace(
        time=time,
        tip=oscillator.tip(run.displacement),
        readout=run.displacement @ oscillator.model.points[READOUT].row,
        impact_times=impacts.start[felt] - begin,
        impacts=[Touch(**dict(zip(names, row, strict=True))) for row in zip(*columns, strict=True)],
        collisions=[collision for collision in final if collision.first_touch < begin + span],
    )


def close_up(oscillator: ImpactOscillator, state: State, collision: Collision) -> CloseUp:
    """A collision of the motion from `state`."""
    margin = max(MARGIN * collision.contact_time, LEAST_MARGIN)
    first, last = collision.first_touch - margin, collision.end + margin
    times = np.linspace(max(first, state.time), last, SAMPLES)
    run = simulate(oscillator, state, duration=last - state.time + margin, times=times)
    impacts = run.impacts
    inside = (impacts.start >= first) & (impacts.start <= collision.end)
    ends = zip(impacts.start[inside], impacts.end[inside], strict=True)
    return CloseUp(
        time=times - collision.first_touch,
        height=oscillator.tip(run.displacement) - oscillator.stop.gap,
        force=contact_force(oscillator, run),
        spans=[(float(a) - collision.first_touch, float(b) - collision.first_touch) for a, b in ends],
    )


def touching(run: Trajectory, stop: int = 0) -> NDArray[np.bool_]:
    """Whether the stop with this number is touched at the samples of a trajectory, shape (n_samples,)."""
    begin, end = (times[run.impacts.stop == stop] for times in (run.impacts.start, run.impacts.end))
    inside: NDArray[np.bool_] = np.any((run.time[:, None] >= begin) & (run.time[:, None] <= end), axis=1)
    return inside


def contact_force(oscillator: ImpactOscillator, run: Trajectory) -> Array:
    """Force [N] at the samples of a trajectory, shape (n_samples,)."""
    law = oscillator.stop.law
    depth = np.maximum(oscillator.tip(run.displacement) - oscillator.stop.gap, 0.0)
    if isinstance(law, NewtonRestitution):
        return np.full(depth.shape, np.nan)
    if isinstance(law, LinearContact):
        force = law.stiffness * depth + law.damping * oscillator.tip(run.velocity)
    elif isinstance(law, HertzContact | HuntCrossley):
        dissipation = getattr(law, "dissipation", 0.0)
        force = law.stiffness * depth**1.5 * (1.0 + dissipation * oscillator.tip(run.velocity))
    elif isinstance(law, PowerContact):
        lever = depth ** (0.5 * law.exponent - 0.5)
        force = lever * (law.stiffness * lever * depth + law.damping * oscillator.tip(run.velocity))
    else:
        raise InvalidType(f"the force of {type(law).__name__} is not known here")
    return np.where(touching(run), np.maximum(force, 0.0), 0.0)


CLEAR, LOUD = 1e-3, 1e-7
"""Least part of the largest line at which a peak away from the modes, and one at a mode, is listed."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A line of the spectrum that is higher than its neighbours."""

    frequency_hz: Annotated[float, "frequency [Hz]"]
    amplitude: float
    mode: Annotated[int | None, "nearest mode; none away from all modes"]


def lines_of(signal: Array, duration: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and amplitudes, in the unit of the signal, of its lines.

    `signal`, shape (n_samples,), lies at equal steps over a whole number of periods that last `duration` [s],
    the last step before the end left out.
    """
    amplitude = np.abs(np.fft.rfft(signal) / signal.size)
    amplitude[1 : (signal.size + 1) // 2] *= 2.0
    return np.arange(amplitude.size) / duration, amplitude


def peaks_of(frequency: Array, amplitude: Array, modes_hz: Array, width: float) -> list[Peak]:
    """The strongest peak at each mode, within `width` [Hz], and all others that are loud; by rising
    frequency.

    A peak is a line that is higher than both its neighbours, the constant part left out.
    """
    padded = np.concatenate([[0.0], amplitude[1:], [0.0]])
    places, _ = find_peaks(padded, height=LOUD * float(amplitude[1:].max()))
    modes: dict[int, int] = {}
    for number, at in enumerate(modes_hz, start=1):
        near = [int(i) for i in places if abs(frequency[i] - at) <= width]
        if near:
            modes.setdefault(max(near, key=lambda i: float(amplitude[i])), number)
    loud = CLEAR * float(amplitude[1:].max())
    return [
        Peak(frequency_hz=float(frequency[i]), amplitude=float(amplitude[i]), mode=modes.get(int(i)))
        for i in places
        if int(i) in modes or amplitude[i] >= loud
    ]
