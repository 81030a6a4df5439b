r"""The motion in extended precision: one Taylor series for flights and contacts, in 24 decimal digits.

    dq_k/ds = g v_k,   dv_k/ds = g (P_k sin(w t) - c_k v_k - omega_k^2 q_k - phi_k N),   dt/ds = g

    flight             g = 1,   N = 0
    linear contact     g = 1,   N = k d
    Hertz              g = r,   N = k r^3,   dr/ds = d'/2   with r = sqrt(d), in which nothing is singular
    Newton's law       at a touch v_k -> v_k - phi_k (1 + e) d'/sum phi^2

Products of series are Cauchy products; sin and cos of w t are carried along as two more components. A step
ends where the last terms of the velocities lie below the working precision, h = (S 10^(-digits)/|v_n|)^(1/n).
Touch (d rising) and release (d or r falling) are the first change of sign among `SAMPLES` points of the
step's polynomial in double precision, polished by Newton's method. That search is not certified; where it
passed over a touch, the exact method would stand in the table with a large error.

Everything starts from the same doubles that the package's own methods are given, so that a difference
between the two is an error of the method. Two runs, of other digits and therefore of other order and steps,
differ by what is stated as the reference's own error; tests compare it with closed forms and with matrix
exponentials. The numbers are of Python's decimal module, thirty times as fast as mpmath's, which gives
sine and cosine at the start. Units: SI, q in m kg^0.5.
"""

from dataclasses import dataclass
from decimal import Decimal, getcontext, localcontext

import numpy as np
from mpmath import mp
from numpy.polynomial.polynomial import polyder, polyval

from beam import InvalidValue
from contact import HertzContact, ImpactOscillator, LinearContact, NewtonRestitution, State

DIGITS = (24, 30)  # decimal digits of the run that is kept and of the one that gives its error

SAMPLES = 24
"""Points of a step, which is some four radians of the fastest mode: a parabola through three of them errs by
1e-3 of that mode's part in a peak."""

MOST_STEPS = 100_000  # bound of series steps in a motion: a drive period with eight modes takes three hundred

MOST_ITERATIONS = 60
"""Bound of Newton's method: from a bracket of a sixth of a radian it takes six to reach 30 digits."""

ZERO, ONE = Decimal(0), Decimal(1)


@dataclass(frozen=True, kw_only=True, eq=False)
class ExtendedMotion:
    """Modal displacements and velocities at the probe, and the times of every touch and its release [s]."""

    displacement: np.ndarray
    velocity: np.ndarray
    touches: list[tuple[Decimal, Decimal]]


def extended(numbers: np.ndarray) -> np.ndarray:
    """Doubles as they are, in an array of decimal numbers."""
    return np.array([Decimal(float(x)) for x in numbers], dtype=object)


class ExtendedSpring:
    """The numbers of an impact oscillator, and the series of its motion.

    A point of the motion is an array of modal displacements, modal velocities, sin w t, cos w t, r and t.
    """

    def __init__(self, oscillator: ImpactOscillator) -> None:
        law, model, drive = oscillator.stop.law, oscillator.model, oscillator.drive
        self.hard = isinstance(law, NewtonRestitution) and law.table.size == 0  # a constant restitution
        self.hertz = isinstance(law, HertzContact)
        linear = isinstance(law, LinearContact) and law.damping == 0.0
        if not (self.hard or self.hertz or linear) or oscillator.load is not None:
            raise InvalidValue(
                f"law of the stop is {law}; the extended reference knows NewtonRestitution, LinearContact "
                "without damping and HertzContact, without a constant load"
            )
        self.n, self.number = oscillator.n_modes, Decimal(law.numbers[0])
        self.gap, self.digits = Decimal(oscillator.stop.gap), getcontext().prec
        with mp.workdps(self.digits):
            pi = Decimal(mp.nstr(+mp.pi, self.digits))
        self.drive = ZERO if drive is None else 2 * pi * Decimal(drive.frequency)
        amplitude = ZERO if drive is None else Decimal(drive.amplitude) * self.drive**2
        self.stiffness, self.decay = extended(model.omega) ** 2, extended(model.decay_rate)
        self.phi, self.push = extended(model.phi), extended(model.participation) * amplitude

    def begin(self, state: State) -> np.ndarray:
        """The point of a state."""
        time = Decimal(state.time)
        with mp.workdps(self.digits + 5):
            turn = mp.mpf(str(self.drive * time))
            shake = [Decimal(mp.nstr(f(turn), self.digits)) for f in (mp.sin, mp.cos)]
        return np.array(
            [*extended(state.displacement), *extended(state.velocity), *shake, ZERO, time], dtype=object
        )

    def series(self, point: np.ndarray, contact: bool) -> np.ndarray:
        """Coefficients of every component of a point, some forty orders as rows."""
        n, sigma, orders = self.n, contact and self.hertz, int(1.45 * self.digits) + 4
        rows = np.full((orders + 1, point.size), ZERO, dtype=object)
        rows[0], root, square = point, rows[:, -2], np.full(orders, ZERO, dtype=object)
        for order in range(orders):
            now, force, stretch = rows[order], ZERO, ONE if order == 0 else ZERO  # times g; g N; g
            if sigma:
                back, stretch = root[order::-1], root[order]
                now, square[order] = back @ rows[: order + 1], back @ root[: order + 1]
                force = self.number * (square[order::-1] @ square[: order + 1])
            elif contact:
                force = self.number * (self.phi @ now[:n] - self.gap * stretch)
            q, v, sine, cosine = now[:n], now[n : 2 * n], now[2 * n], now[2 * n + 1]
            following = rows[order + 1]
            following[:n] = v
            following[n : 2 * n] = self.push * sine - self.decay * v - self.stiffness * q - self.phi * force
            rate = self.phi @ rows[order, n : 2 * n] / 2 if sigma else ZERO
            following[2 * n :] = [self.drive * cosine, -self.drive * sine, rate, stretch]
            following *= ONE / (order + 1)
        return rows

    def reach(self, rows: np.ndarray) -> Decimal:
        """Step for which the last six terms of the velocities lie below the working precision."""
        v = np.abs(rows[:, self.n : 2 * self.n])
        goal, order = v[0].max().scaleb(-self.digits), len(v)
        terms = [(x, i) for i in range(order - 6, order) for x in v[i] if x]
        return Decimal(min((float((goal / x).ln() / i) for x, i in terms), default=0.0)).exp()

    def watched(self, rows: np.ndarray, contact: bool) -> np.ndarray:
        """The series of what changes its sign at the next event: the penetration, in Hertz's contact r."""
        if contact and self.hertz:
            return rows[:, -2]
        depth = rows[:, : self.n] @ self.phi
        depth[0] -= self.gap
        return depth

    def after_touch(self, point: np.ndarray) -> np.ndarray:
        """The point with r = 0, under Newton's law with the velocities after the impact."""
        point, velocity = point.copy(), slice(self.n, 2 * self.n)
        point[-2] = ZERO
        if self.hard:
            jump = (1 + self.number) * (self.phi @ point[velocity]) / (self.phi @ self.phi)
            point[velocity] -= self.phi * jump
        return point


def event_in(series: np.ndarray, h: Decimal, contact: bool, fresh: bool) -> Decimal | None:
    """The first change of sign within the step `h`, None if there is none; `fresh`: it begins on one."""
    grid = float(h) * np.arange(-1, SAMPLES + 1) / SAMPLES
    found = polyval(grid, series.astype(float))
    past = found < 0.0 if contact else found > 0.0
    past[: 2 if fresh else 1] = False
    places = np.flatnonzero(past)
    if not places.size:
        return None
    low, high = extended(grid[places[0] - 1 : places[0] + 1])
    slope, s = polyder(series), (low + high) / 2
    for _ in range(MOST_ITERATIONS):
        step = polyval(s, series) / polyval(s, slope)
        s = min(max(s - step, low - h / SAMPLES), high + h / SAMPLES)
        if abs(step) < h.scaleb(-round(0.6 * getcontext().prec)):  # the next one would be its square
            return Decimal(s)
    raise ArithmeticError("an event of the reference was not found to its digits")


def extended_motion(
    oscillator: ImpactOscillator, start: State, probe: float, digits: int = DIGITS[0]
) -> ExtendedMotion:
    """The motion from `start`, before the stop or on it and moving in, to the time `probe` in a flight [s].

    ValueError for a law or load that is not known, and for a probe in a contact.
    """
    with localcontext() as context:
        context.prec = digits
        spring = ExtendedSpring(oscillator)
        n, point, end = spring.n, spring.begin(start), Decimal(float(probe))
        touches: list[tuple[Decimal, Decimal]] = []
        on_stop = abs(spring.phi @ point[:n] - spring.gap) <= spring.gap.scaleb(-15)
        event = ZERO if on_stop and spring.phi @ point[n : 2 * n] > 0 else None
        contact, begun = False, point[-1]
        for _ in range(MOST_STEPS):
            if event is not None and contact:
                touches.append((begun, point[-1]))
                contact = False
            elif event is not None:
                begun, contact, point = point[-1], not spring.hard, spring.after_touch(point)
                touches += [] if contact else [(begun, begun)]
            rows = spring.series(point, contact)
            h = spring.reach(rows)
            event = event_in(spring.watched(rows, contact), h, contact, event is not None)
            following = polyval(h if event is None else event, rows)
            if following[-1] >= end:
                if contact:
                    raise InvalidValue(f"probe is {probe} s, which is in a contact")
                there = polyval(end - point[-1], rows)
                return ExtendedMotion(displacement=there[:n], velocity=there[n : 2 * n], touches=touches)
            point = following
        raise ArithmeticError(f"more than {MOST_STEPS} steps of the series")
