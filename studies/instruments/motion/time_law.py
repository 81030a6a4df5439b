"""When the frames of a film are taken: sparsely in flight, densely around contacts.

A frame of a film at `rate` frames a second that is shown for 1/rate and stands for the time dt is slowed down
1/(rate dt) times. The longest dt that is allowed at a distance d from a contact is

    dt = max(t_c / IN_CONTACT, min(dt_flight, d / n)),    n = BEFORE or AFTER,

t_c the usual length of a contact: five frames a contact, steps that shrink like the distance to it, fewer
before a contact than after it, when the spring rings. The slow motion is the next round number (1, 1.5, 2, 3,
4, 5, 6, 8, 10, ...), so that it can be told, and all of it is divided by one factor such that the film has
the length asked for.

A frame stands for the time from half a step before it to half a step after. Where a contact falls into this
time but not on the frame, in a short film, the frame is taken in the middle of the contact instead: a
contact is always seen, and seen as one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

__all__ = ["TimeLaw", "round_number", "time_law"]

IN_CONTACT, BEFORE, AFTER = 5.0, 4.0, 10.0
"""Frames in one contact; steps per distance before and after it."""

FLIGHT_STEPS = 250.0
"""Frames in one orbit period, were there no contact: the coarsest step of a long film."""

INSTANT = 0.01
"""Length of a contact that takes no time (a law of restitution), in steps of the flight."""

FINER = 2.0**0.125
"""Steps of the search for the length of the film."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TimeLaw:
    """The frames of a film.

    Parameters
    ----------
    time, step : ndarray, shape (n_frames,)
        When each is taken, and how long it stands for [s].
    slowed : ndarray, shape (n_frames,)
        Slow motion of each [1].
    rate : float
        Frames a second of the film.
    """

    time: NDArray[np.float64]
    step: NDArray[np.float64]
    slowed: NDArray[np.float64]
    rate: float

    def during(self, spans: Sequence[tuple[float, float]]) -> NDArray[np.bool_]:
        """Whether a frame is taken within one of `spans` [s]."""
        met = np.zeros(self.time.size, dtype=np.bool_)
        for first, last in spans:
            met |= (self.time >= first) & (self.time <= last)
        return met


def round_number(value: float, *, up: bool = True) -> float:
    """The next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 15, ... at or above `value` > 0, or at or below it."""
    power = 10.0 ** math.floor(math.log10(value))
    ladder = [step * power for step in (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)]
    slack = 1e-9 * value
    if up:
        return next(step for step in ladder if step >= value - slack)
    return next(step for step in reversed(ladder) if step <= value + slack)


def time_law(
    duration: float, spans: Sequence[tuple[float, float]], *, frames: int, rate: float = 20.0
) -> TimeLaw:
    """At most `frames` frames of the time from 0 to `duration` [s], slow around the contacts `spans` [s].

    Contacts before 0 and after `duration`, those of the neighbouring periods, may be among the spans. The
    search ends because the number of frames falls with their density, down to a single one.

    Raises
    ------
    ValueError
        If `frames` is less than 8 for each contact and for the flight.
    """
    contacts = sum(last >= 0.0 and first < duration for first, last in spans)
    least = 8 * (contacts + 1)
    if frames < least:
        raise ValueError(f"frames is {frames}; a film with {contacts} contacts needs at least {least} frames")
    flight = duration / FLIGHT_STEPS
    lengths = [last - first for first, last in spans if last > first]
    contact = float(np.median(lengths)) if lengths else INSTANT * flight
    density = max(1.0, frames / FLIGHT_STEPS)
    while True:
        law = _marched(duration, spans, density, flight, min(contact / IN_CONTACT, flight), rate)
        if law.time.size <= frames:
            return _with_contacts(law, spans)
        density /= FINER


def _marched(
    duration: float,
    spans: Sequence[tuple[float, float]],
    density: float,
    flight: float,
    least: float,
    rate: float,
) -> TimeLaw:
    """From frame to frame with `density` times the frames that the law asks for."""
    times: list[float] = []
    slow: list[float] = []
    now = 0.0
    while now < duration * (1.0 - 1e-12):
        factor = round_number(density / (rate * max(least, min(flight, _nearness(now, spans)))))
        if times and duration - now < 0.5 / (rate * factor):
            break
        times.append(now)
        slow.append(factor)
        now += 1.0 / (rate * factor)
    time, slowed = np.array(times), np.array(slow)
    return TimeLaw(time=time, step=np.diff(time, append=duration), slowed=slowed, rate=rate)


def _with_contacts(law: TimeLaw, spans: Sequence[tuple[float, float]]) -> TimeLaw:
    """Frames that a contact falls between moved into it."""
    time, step = law.time.copy(), law.step
    begin, end = law.time - 0.5 * np.concatenate([step[-1:], step[:-1]]), law.time + 0.5 * step
    for first, last in spans:
        if not np.any((time >= first) & (time <= last)):
            middle = 0.5 * (first + last)
            time[(begin <= middle) & (middle < end) & (middle >= 0.0)] = middle
    return replace(law, time=time)


def _nearness(now: float, spans: Sequence[tuple[float, float]]) -> float:
    """The step that the nearest contact allows [s]."""
    step = math.inf
    for first, last in spans:
        if now < first:
            step = min(step, (first - now) / BEFORE)
        elif now > last:
            step = min(step, (now - last) / AFTER)
        else:
            return 0.0
    return step
