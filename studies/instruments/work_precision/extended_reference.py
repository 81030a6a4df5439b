"""The motion and its first collision in extended precision, and how far two routes to it differ.

    first route     closed forms for flights, eigenvectors for a linear contact, Taylor series in time for
                    Hertz's
    second route    matrix exponentials for flights, Taylor series in time for a linear contact, in sigma for
                    Hertz's; other digits and therefore another order

The difference of the two is the error that is stated for the reference.  Both start from the doubles that the
package's methods get.  Newton's law: at a touch v -> v - (1 + e) phi d'/sum phi^2.

The collision is that of ``contact.collision`` in the same words, computed anew: with the virtual motion y(t)
of mode 1, t_in and t_out its crossings of the gap,

    restitution = -y'_out(t_out)/y'_in(t_in),   kick = -phi_1 (jump of u_1' at t_in)/y'_in(t_in),

the jump carried back to t_in by mode 1's free flow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp

from contact.laws import NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import State
from studies.instruments.work_precision.extended_contact import contact
from studies.instruments.work_precision.extended_flight import (
    ExtendedSpring,
    Modal,
    NoReference,
    extended_state,
    newton_root,
)

__all__ = [
    "DIGITS", "Reference", "extended_collision", "extended_motion", "reference_of", "relative_difference",
]  # fmt: skip

DIGITS = (24, 28)
"""Decimal digits of the first and of the second route: both far below the rounding of any method."""

MOST_TOUCHES = 200
"""Bound of touches in a reference motion; those of the study have one to three."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Touch:
    """One contact: times, deviations just before and just after."""

    start: Any
    end: Any
    before: Modal
    after: Modal


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """Modal states at the times asked for, and every touch."""

    spring: ExtendedSpring
    states: list[Modal]
    touches: list[Touch]


def extended_motion(
    oscillator: ImpactOscillator, start: State, times: Sequence[float], *, digits: int, second: bool = False
) -> Motion:
    """The motion from `start` to the last of the rising `times`, which must lie in flights [s].

    Raises
    ------
    NoReference
        If the tip passes the stop too near a graze, or one of `times` lies within a contact.
    """
    with mp.workdps(digits):
        spring = ExtendedSpring(oscillator, second=second)
        clock, last = mp.mpf(float(start.time)), mp.mpf(float(times[-1]))
        wanted = [mp.mpf(float(t)) for t in times]
        deviation = spring.deviation(extended_state(start), clock)
        depth, rate = spring.tip(deviation, clock)
        touching = abs(depth) <= mp.mpf("1e-15") * spring.gap and rate > 0
        states: list[Modal] = []
        touches: list[Touch] = []
        for _ in range(MOST_TOUCHES):
            wait = mp.mpf(0) if touching else spring.touch(deviation, clock, last - clock)
            touching = False
            until = last if wait is None else clock + wait
            while len(states) < len(wanted) and wanted[len(states)] <= until:
                t = wanted[len(states)]
                states.append(spring.state(spring.fly(deviation, t - clock), t))
            if wait is None or len(states) == len(wanted):
                return Motion(spring=spring, states=states, touches=touches)
            before = spring.fly(deviation, wait)
            clock += wait
            if spring.law == NEWTON:
                _depth, speed = spring.tip(before, clock)
                jump = (1 + spring.number) * speed * spring.mass
                after = before[0], [v - phi * jump for v, phi in zip(before[1], spring.phi, strict=True)]
                length = mp.mpf(0)
            else:
                met = contact(spring, before, clock, last - clock)
                if met is None:
                    raise NoReference(f"a contact lasts until {float(last)} s, a time that is asked for")
                length, after = met
            touches.append(Touch(start=clock, end=clock + length, before=before, after=after))
            clock, deviation = clock + length, after
            if len(states) < len(wanted) and wanted[len(states)] < clock:
                asked = float(wanted[len(states)])
                raise NoReference(f"{asked} s, a time that is asked for, is in a contact")
        raise NoReference(f"more than {MOST_TOUCHES} touches in a reference motion")


def extended_collision(
    motion: Motion, near: tuple[float, float], *, digits: int, touches: int
) -> tuple[Any, Any]:
    """(restitution, kick) of the collision made of the first `touches`.

    `near` is where t_in and t_out are to be looked for [s]; both are found anew by Newton's method.
    """
    with mp.workdps(digits):
        spring, first, last = motion.spring, motion.touches[0], motion.touches[touches - 1]

        def mode(deviation: Modal, t: Any) -> tuple[Any, Any]:
            a, b, c, d = spring.flow(0, t)
            u, v = deviation[0][0], deviation[1][0]
            return a * u + b * v, c * u + d * v

        def virtual(deviation: Modal, base: Any, t: Any) -> tuple[Any, Any]:
            u, v = mode(deviation, t - base)
            turn = spring.tip_response * mp.expjpi(spring.drive * t / mp.pi)
            return (
                spring.level + turn.imag + spring.phi[0] * u,
                spring.drive * turn.real + spring.phi[0] * v,
            )

        slack = mp.mpf(1) / (1000 * spring.drive)
        t_in, t_out = (
            newton_root(lambda t, of=of, at=at: virtual(of, at, t), guess - slack, guess + slack, guess)
            for of, at, guess in ((first.before, first.start, near[0]), (last.after, last.end, near[1]))
        )
        _height, speed = virtual(first.before, first.start, t_in)
        _height, leaving = virtual(last.after, last.end, t_out)
        _u, before = mode(first.before, t_in - first.start)
        _u, after = mode(last.after, t_in - last.end)
        return -leaving / speed, -spring.phi[0] * (after - before) / speed


def relative_difference(a: Any, b: Any) -> float:
    """|a - b| over |a|, 0 where both vanish."""
    return float(abs(a - b) / abs(a)) if a != 0 else float(abs(b))


@dataclass(frozen=True, kw_only=True, eq=False)
class Reference:
    """What methods are measured against, rounded to doubles only where a difference is taken.

    Parameters
    ----------
    states : list of (displacements, velocities)
        At the times asked for.
    start, end : float
        First touch and first release, extended [s].
    restitution, kick : mpf or None
    error : dict
        Difference of the two routes: states in the scales given, times over the unit of time, pure numbers.
    """

    states: list[Modal]
    start: Any
    end: Any
    restitution: Any
    kick: Any
    error: dict[str, float]


def reference_of(
    oscillator: ImpactOscillator,
    start: State,
    times: Sequence[float],
    *,
    scales: tuple[np.ndarray, np.ndarray],
    period: float,
    near: tuple[float, float] | None = None,
    touches: int = 1,
) -> Reference:
    """Both routes, and what lies between them.

    Parameters
    ----------
    oscillator, start, times : see `extended_motion`
    scales : (ndarray, ndarray), shape (n_modes,)
        Sizes of modal displacements and velocities in which errors are given.
    period : float
        Unit in which errors of times are given [s].
    near, touches : see `extended_collision`; no collision is measured without `near`.
    """
    found = []
    for digits, second in zip(DIGITS, (False, True), strict=True):
        motion = extended_motion(oscillator, start, times, digits=digits, second=second)
        pair: tuple[Any, Any] = (None, None)
        if near is not None:
            pair = extended_collision(motion, near, digits=digits, touches=touches)
        found.append((motion, pair))
    (first, pair), (other, other_pair) = found
    state = 0.0
    for a, b in zip(first.states, other.states, strict=True):
        for part, scale in zip((0, 1), scales, strict=True):
            for x, y, size in zip(a[part], b[part], scale, strict=True):
                state = max(state, float(abs(x - y)) / float(size))
    error = {"state": state}
    if first.touches:
        one, two = first.touches[0], other.touches[0]
        late = max(abs(one.start - two.start), abs(one.end - two.end))
        error["time"] = float(late) / period
    if near is not None:
        error["restitution"] = relative_difference(pair[0], other_pair[0])
        error["kick"] = relative_difference(pair[1], other_pair[1])
    return Reference(
        states=first.states,
        start=first.touches[0].start if first.touches else None,
        end=first.touches[0].end if first.touches else None,
        restitution=pair[0], kick=pair[1], error=error,
    )  # fmt: skip
