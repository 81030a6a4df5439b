"""The plan of a simulation, with times as stretches and clocks (``contact.flight.clock``)."""

from dataclasses import dataclass

import numpy as np

from beam.parameters import InvalidValue, require, require_array, require_whole, require_within, shown
from contact.flight.clock import split_time
from contact.oscillator import ImpactOscillator
from contact.state import State

MOST_STORED = 2.0**28  # largest number of values in the strobes of one run: 2 GB


@dataclass(frozen=True, eq=False)
class Plan:
    """Start, end and sample times of a simulation.

    `contact.simulate` makes it for the method.  Each time is kept as two numbers.  The first is the number of
    a stretch, which goes from one strobe to the next.  The second is a clock, the time since the strobe that
    begins the stretch.

    Parameters
    ----------
    start : State
        State at the start.
    length : float
        Duration of the run [s].
    first, last : int
        Stretches of start and end.
    clock, clock_end : float
        Clocks of start and end [s].
    times : ndarray, shape (n_times,)
        Times at which the state is wanted [s].
    sample_stretch : ndarray of int, shape (n_times,)
        Stretches of these times.
    sample_clock : ndarray, shape (n_times,)
        Clocks of these times [s].
    """

    start: State
    length: float
    first: int
    last: int
    clock: float
    clock_end: float
    times: np.ndarray
    sample_stretch: np.ndarray
    sample_clock: np.ndarray


def plan_of(
    oscillator: ImpactOscillator,
    start: State,
    duration: float | None,
    periods: int | None,
    times: np.ndarray | None,
) -> Plan:
    """The plan of a motion from `start` over one of `duration` and `periods`; wrong values are refused."""
    words = "duration and periods are both given or both missing; give exactly one of them"
    require((duration is None) != (periods is None), words)
    period = oscillator.period
    whole = 0 if periods is None else require_whole("periods", periods, "drive periods")
    length = whole * period if whole else require_within("duration", duration, "s", above=0)
    if length / period * 2 * oscillator.n_modes > MOST_STORED:
        given = f"{length:g} s, {length / period:g} drive periods with {oscillator.n_modes} modes"
        words = f"the strobes kept must stay below {MOST_STORED:g} numbers, so run it in pieces"
        raise InvalidValue(f"duration is {given}; {words}")
    first, clock = (x.item() for x in split_time(start.time, period))
    last, clock_end = first + whole, clock
    if not whole:
        last, clock_end = (x.item() for x in split_time(start.time + length, period))
    words = "a rising array"
    wanted = require_array("times", () if times is None else times, "s", dimensions=1, words=words)
    if np.any(np.diff(wanted) < 0.0):  # the sentence is slow to make
        raise InvalidValue(f"times is {shown(wanted.tolist())} s; it must be {words}")
    begin, end, beside = start.time, start.time + length, 1e-12 * length
    if wanted.size and (wanted[0] < begin - beside or wanted[-1] > end + beside):
        words = f"they must lie within {begin} to {end} s"
        raise InvalidValue(f"times run from {wanted[0]} to {wanted[-1]} s; {words}")
    sample_stretch, sample_clock = split_time(wanted, period)
    late = (sample_stretch > last) | ((sample_stretch == last) & (sample_clock > clock_end))
    sample_stretch[late], sample_clock[late] = last, clock_end
    early = (sample_stretch < first) | ((sample_stretch == first) & (sample_clock < clock))
    sample_stretch[early], sample_clock[early] = first, clock
    return Plan(start, length, first, last, clock, clock_end, wanted, sample_stretch, sample_clock)
