"""Starts of a motion that does not repeat: a transient, or chaos.

Rows of chaos that nearly repeat after m drive periods are next to an unstable orbit, and give its kicks
(close returns: Auerbach et al., Phys. Rev. Lett. 58 (1987) 2387).  The motion begins with the first flight.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact import ImpactOscillator
from studies.measurement.identify.motion.linear import Linear, state_of
from studies.measurement.identify.motion.readings import Readings
from studies.measurement.identify.motion.starts import TRIED, starts_at
from studies.measurement.identify.record.kicks import Search, kicked_motions, poles
from studies.measurement.identify.record.records import Array, NoAnswer
from studies.physics.parameters import with_values

BELOW = 0.98  # gaps below which a row is off the stop
SHORT, EARLY = 0.3, 3.0  # drive periods that show a state at least, and that are fitted first
FINE = 64  # rows a drive period at which a record is compared with itself
LONGEST_RETURN = 9  # drive periods after which it may nearly repeat


def unsteady_starts(
    linear: Linear, oscillator: ImpactOscillator, names: Sequence[str], free: Sequence[str]
) -> list[tuple[Readings, ImpactOscillator]]:
    """Starts of a motion that does not repeat, at the first row off the stop, from kicked and linear ones.

    Its state there is that of the steady motion and of mode 1, as the rows until the first impact show it.
    """
    record = linear.record
    if record.order:
        raise NoAnswer("a motion that does not repeat is fitted to a displacement alone: record that")
    times, x, found = *record.rows.T, list[tuple[Readings, ImpactOscillator]]()
    part, period = close_return(times, x, linear.frequency)
    at = with_values(oscillator, {"frequency": linear.frequency})
    motions = kicked_motions(record, oscillator)
    motions += Search(replace(record, rows=record.rows[part]), at, period).found()
    likely = [one for one in motions if one.reading()["gap"] > 0.0 and one.base != 0.0]
    pairs = [pair for one in likely[:TRIED] for pair in starts_at(record, one, oscillator, names, free, True)]
    for steady, at in pairs:
        sensor, w = steady.reading(steady.extra), at.driven.angular_frequency
        tip = (x - sensor["offset"]) / sensor["scale"]
        below = tip < BELOW * at.stop.gap
        begin = int(np.argmax(below))
        least = int(np.searchsorted(times, times[begin] + SHORT * at.period))
        end = max(least, begin + int(np.argmin(np.append(below[begin:], False))))
        base = -1j * at.driven.amplitude * np.exp(1j * (w * times[begin:end] + sensor["phase"]))
        wave = np.exp(poles(at)[at.model.leading_mode] * (times[begin:end] - times[begin]))
        off = tip[begin:end] - (at.tip_response() * base).real
        a, b = np.linalg.lstsq(np.array([wave.real, -wave.imag]).T, off, rcond=None)[0]
        state = state_of(at, base[0], complex(a, b))
        rest = replace(record, rows=record.rows[begin:])
        first = int(np.searchsorted(rest.rows[:, 0], times[begin] + EARLY * at.period))
        found.append((Readings(rest, at, state, sensor, free, first=first), at))
    return found


def close_return(times: Array, x: Array, frequency: float) -> tuple[slice, int]:
    """Rows that nearly repeat after some drive periods, and how many: they are next to an orbit."""
    rate, best = FINE * frequency, (math.inf, 0, 0)
    even = np.interp(np.arange(times[0], times[-1], 1.0 / rate), times, x)
    for period in range(2, max(3, min(LONGEST_RETURN, even.size // FINE - 1))):
        off = (even[FINE * period :] - even[: -FINE * period]) ** 2
        near = np.convolve(off, np.ones(FINE), "valid")
        best = min(best, (float(near.min()), period, int(np.argmin(near))))
    _, period, row = best
    ends = times[0] + np.array([row, row + (period + 1) * FINE]) / rate
    return slice(*np.searchsorted(times, ends).tolist()), period
