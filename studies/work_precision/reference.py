r"""The motion in extended precision: one Taylor series for flights and contacts, in 24 decimal digits.

    dq_k/ds = g v_k,   dv_k/ds = g (P_k sin(w t) - c_k v_k - omega_k^2 q_k - phi_k N),   dt/ds = g

    flight             g = 1,   N = 0
    linear contact     g = 1,   N = k d
    Hertz              g = r,   N = k r^3,   dr/ds = d'/2   with r = sqrt(d), in which nothing is singular
    Newton's law       at a touch v_k -> v_k - phi_k (1 + e) d'/sum phi^2

Products of series are Cauchy products; sin and cos of w t are carried along as two more components. A step
ends where the last terms of the velocities lie below the working precision, h = (S 10^(-digits)/|v_n|)^(1/n).
Touch (d rising) and release (d or r falling) are the first change of sign among `SAMPLES` points of the
step's polynomial in double precision, polished by Newton's method. The search is not certified; instead a
flight with a peak so near to the stop that sampling could be wrong about it is refused.

Everything starts from the same doubles that the package's own methods are given, so that a difference
between the two is an error of the method. Two runs, of other digits and therefore of other order and steps,
differ by what is stated as the reference's own error; tests compare it with closed forms and with matrix
exponentials. The numbers are those of Python's decimal module, thirty times as fast as mpmath's, which gives
sine and cosine at the start. Units: SI, q in m kg^0.5.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal, getcontext, localcontext
from itertools import accumulate, repeat
from operator import mul

import numpy as np
from mpmath import mp

from contact import HertzContact, ImpactOscillator, LinearContact, NewtonRestitution, State

__all__ = ["DIGITS", "ExtendedMotion", "ExtendedTouch", "NoReference", "extended_motion"]

DIGITS = (24, 30)
"""Decimal digits of the run that is kept and of the one that tells its error."""

SAMPLES = 24
"""Points of a step, which is some four radians of the fastest mode: a parabola through three of them errs by
1e-3 of that mode's part in a peak."""

TOO_NEAR = 1e-5
"""Peaks within this part of the gap before the stop are left to certified methods."""

MOST_STEPS = 100_000
"""Bound of series steps in a motion: a drive period with eight modes takes three hundred."""

MOST_ITERATIONS = 60
"""Bound of Newton's method: from a bracket of a sixth of a radian it takes six to reach 30 digits."""

ZERO, ONE = Decimal(0), Decimal(1)

Row = list[Decimal]


class NoReference(ValueError):
    """A motion that the extended reference cannot follow, or is not sure of."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ExtendedTouch:
    """A touch: times of touch and release [s], modal velocities just before and just after."""

    start: Decimal
    end: Decimal
    before: Row
    after: Row


@dataclass(frozen=True, kw_only=True, eq=False)
class ExtendedMotion:
    """Modal displacements and velocities at the times asked for, and every touch that has ended."""

    states: list[tuple[Row, Row]]
    touches: list[ExtendedTouch]


def dot(a: Iterable[Decimal], b: Iterable[Decimal]) -> Decimal:
    """sum a_k b_k."""
    return sum(map(mul, a, b), ZERO)


def value(series: Row, s: Decimal) -> Decimal:
    """Value of a power series."""
    return dot(series, accumulate(repeat(s, len(series) - 1), mul, initial=ONE))


class ExtendedSpring:
    """The numbers of an impact oscillator, and the series of its motion.

    A point of the motion is a list of modal displacements, modal velocities, sin w t, cos w t, r and t.
    """

    def __init__(self, oscillator: ImpactOscillator) -> None:
        law, model, drive = oscillator.stop.law, oscillator.model, oscillator.drive
        elastic = isinstance(law, HertzContact) or (isinstance(law, LinearContact) and law.damping == 0.0)
        if not (elastic or isinstance(law, NewtonRestitution)) or oscillator.load is not None:
            raise ValueError(
                f"law of the stop is {law}; the extended reference knows NewtonRestitution, LinearContact "
                "without damping and HertzContact, without a constant load"
            )
        self.hard, self.hertz = isinstance(law, NewtonRestitution), isinstance(law, HertzContact)
        self.number, self.gap, self.n = (
            Decimal(law.numbers[0]),
            Decimal(oscillator.stop.gap),
            oscillator.n_modes,
        )
        with mp.workdps(getcontext().prec):
            pi = Decimal(mp.nstr(+mp.pi, getcontext().prec))
        self.drive = ZERO if drive is None else 2 * pi * Decimal(drive.frequency)
        amplitude = ZERO if drive is None else Decimal(drive.amplitude) * self.drive**2
        self.phi = [Decimal(float(x)) for x in model.phi]
        self.mass = 1 / dot(self.phi, self.phi)
        numbers = zip(model.omega, model.decay_rate, self.phi, model.participation, strict=True)
        # v' = row . (q, v, N, sin w t)
        self.rows = [(-(Decimal(float(w)) ** 2), -Decimal(float(c)), -phi, Decimal(float(z)) * amplitude)
                     for w, c, phi, z in numbers]  # fmt: skip

    def begin(self, state: State) -> Row:
        """The point of a state."""
        time, digits = Decimal(state.time), getcontext().prec
        with mp.workdps(digits + 5):
            turn = mp.mpf(str(self.drive * time))
            swing = [Decimal(mp.nstr(f(turn), digits)) for f in (mp.sin, mp.cos)]
        modes = [Decimal(float(x)) for x in (*state.displacement, *state.velocity)]
        return [*modes, *swing, ZERO, time]

    def series(self, point: Row, contact: bool) -> list[Row]:
        """Coefficients of every component of a point; some forty terms."""
        n, sigma = self.n, contact and self.hertz
        rows = [[x] for x in point]
        q, v, (sine, cosine, root, time) = rows[:n], rows[n : 2 * n], rows[2 * n :]
        square: Row = []
        for order in range(int(1.45 * getcontext().prec) + 4):
            back, inverse, force = root[::-1], ONE / (order + 1), ZERO  # force: coefficient of g N
            if sigma:
                square.append(dot(root, back))
                force = self.number * dot(square, square[::-1])
            elif contact:
                depth = dot(self.phi, [row[order] for row in q]) - (self.gap if order == 0 else ZERO)
                force = self.number * depth
            now = [dot(row, back) if sigma else row[order] for row in rows[:-2]]
            rate = dot(self.phi, [row[order] for row in v])
            for k, row in enumerate(self.rows):
                pull = row[0] * now[k] + row[1] * now[n + k] + row[2] * force + row[3] * now[2 * n]
                q[k].append(now[n + k] * inverse)
                v[k].append(pull * inverse)
            sine.append(self.drive * now[2 * n + 1] * inverse)
            cosine.append(-self.drive * now[2 * n] * inverse)
            time.append((root[order] if sigma else ONE if order == 0 else ZERO) * inverse)
            root.append(rate * inverse / 2 if sigma else ZERO)
        return rows

    def reach(self, rows: list[Row]) -> Decimal:
        """Step for which the last six terms of the velocities lie below the working precision."""
        v, digits = rows[self.n : 2 * self.n], getcontext().prec
        goal, order = max(abs(row[0]) for row in v).scaleb(-digits), len(v[0])
        terms = [(abs(row[i]), i) for row in v for i in range(order - 6, order)]
        return Decimal(min((float((goal / x).ln() / i) for x, i in terms if x), default=0.0)).exp()

    def watched(self, rows: list[Row], contact: bool) -> Row:
        """The series of what changes its sign at the next event: the penetration, in Hertz's contact r."""
        if contact and self.hertz:
            return rows[-2]
        depth = [dot(self.phi, column) for column in zip(*rows[: self.n], strict=True)]
        return [depth[0] - self.gap, *depth[1:]]

    def struck(self, v: Row) -> Row:
        """The velocities after an impact under Newton's law."""
        jump = (1 + self.number) * dot(self.phi, v) * self.mass
        return [x - phi * jump for x, phi in zip(v, self.phi, strict=True)]


def event_in(series: Row, h: Decimal, contact: bool, fresh: bool, near: float) -> Decimal | None:
    """The first change of sign within the step `h`, None if there is none; `fresh`: the step begins on one.

    NoReference for a peak of a flight within `near` [m] of the stop.
    """
    grid = float(h) * np.arange(-1, SAMPLES + 1) / SAMPLES
    found = np.polyval([float(x) for x in series[::-1]], grid)
    past = found < 0.0 if contact else found > 0.0
    past[: 2 if fresh else 1] = False
    if fresh and past[2]:
        raise NoReference("a contact or a flight is shorter than the sampling of the reference")
    places = np.flatnonzero(past)
    if not contact:
        peak = np.flatnonzero((found[1:-1] > found[:-2]) & (found[1:-1] >= found[2:])) + 1
        peak = peak[(peak < (places[0] if places.size else grid.size)) & ((peak > 1) | (not fresh))]
        if np.any(np.abs(found[peak]) < near):
            raise NoReference(
                f"the tip passes within {near:.3g} m of the stop: too near a graze for a reference"
            )
    if not places.size:
        return None
    low, high = (Decimal(float(x)) for x in grid[places[0] - 1 : places[0] + 1])
    slope = [i * x for i, x in enumerate(series)][1:]
    s = (low + high) / 2
    for _ in range(MOST_ITERATIONS):
        step = value(series, s) / value(slope, s)
        s = min(max(s - step, low - h / SAMPLES), high + h / SAMPLES)
        if abs(step) < h.scaleb(-round(0.6 * getcontext().prec)):  # the next one would be its square
            return s
    raise NoReference("an event of the reference was not found to its digits")


def extended_motion(
    oscillator: ImpactOscillator, start: State, times: Sequence[float], digits: int = DIGITS[0]
) -> ExtendedMotion:
    """The motion from `start` to the last of the rising `times`, which must lie in flights [s].

    The tip starts before the stop, or on it and moves in.

    Raises
    ------
    NoReference
        If the tip passes the stop too near a graze, or one of `times` lies within a contact.
    ValueError
        For a law or load that is not known.
    """
    with localcontext() as context:
        context.prec = digits
        spring = ExtendedSpring(oscillator)
        n, point, near = spring.n, spring.begin(start), TOO_NEAR * oscillator.stop.gap
        velocity = slice(n, 2 * n)
        wanted, states, touches = (
            [Decimal(float(t)) for t in times],
            list[tuple[Row, Row]](),
            list[ExtendedTouch](),
        )
        fresh = abs(dot(spring.phi, point[:n]) - spring.gap) <= spring.gap.scaleb(-15)
        fresh = fresh and dot(spring.phi, point[velocity]) > 0
        contact, begun = fresh and not spring.hard, point
        if fresh and spring.hard:
            point[velocity] = spring.struck(point[velocity])
        for _ in range(MOST_STEPS):
            rows = spring.series(point, contact)
            h = spring.reach(rows)
            event = event_in(spring.watched(rows, contact), h, contact, fresh, near)
            following = [value(row, h if event is None else event) for row in rows]
            while len(states) < len(wanted) and wanted[len(states)] <= following[-1]:
                if contact:
                    raise NoReference(f"{times[len(states)]} s, a time that is asked for, is in a contact")
                s = wanted[len(states)] - point[-1]
                states.append(
                    ([value(row, s) for row in rows[:n]], [value(row, s) for row in rows[velocity]])
                )
            if len(states) == len(wanted):
                return ExtendedMotion(states=states, touches=touches)
            point, fresh = following, event is not None
            if not fresh:
                continue
            if spring.hard:
                begun, point = point, [*point[:n], *spring.struck(point[velocity]), *point[2 * n :]]
            if contact or spring.hard:
                touches.append(ExtendedTouch(start=begun[-1], end=point[-1], before=begun[velocity],
                                             after=point[velocity]))  # fmt: skip
                contact = False
            else:
                contact, begun = True, point
                point = [*point[:-2], ZERO, point[-1]]
        raise NoReference(f"more than {MOST_STEPS} steps of the series")
