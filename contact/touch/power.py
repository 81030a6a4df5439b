"""A power of the depth with a dashpot: N = max(0, k d^p + c d^((p-1)/2) d') for d > 0 (``PowerContact``).

In w = d^((p+1)/2) and dtau = d^((p-1)/2) dt a free mass m is a linear oscillator at every speed,

    w'' + (c/m) w' + (p+1)/2 (k/m) w = 0,      N = -2 m/(p+1) d^((p-1)/2) w''.

The force has no Taylor series at d = 0.  As in ``contact.touch.hertz`` the motion is computed in a variable
sigma in which all right-hand sides are polynomials.  With d = rho^m, a = m p and b = m (p-1)/2,

    dt/dsigma = rho^(m-1),  drho/dsigma = d'/m,  du/dsigma = rho^(m-1) v,
    dv/dsigma = rho^(m-1) (g - c_k v - omega^2 u) - phi_k rho^l G,      G = k rho^h + c d',

with l = b + m - 1 and h = b + m, or without damping l = a - 1 and h = m.  The least m is taken for which a
and, with damping, b are whole numbers.  The powers come from each other by products of two series, by a plan
in the law's table, so that no kernel branches by exponent.

With damping the contact lets go where G falls to zero, before d does (regime INSIDE).  There the tip moves
without a force, until G rises through zero again, or the tip leaves where rho falls to zero.

A force enters the speeds at the order 2 (b + m), or b + m, of sigma.  If it is above `WINDOW`, the terms of a
step could all be small although the force is not.  Such a step reaches at most thrice the rho of its start,
or the depth up to which the impulse of this force is below rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import ClassVar

import numpy as np

from beam.parameters import InvalidValue, final, require_within
from contact.flight.elementary import EPS, sine_cosine
from contact.flight.modal_flow import speed_scale, tip_sum
from contact.flight.polynomial_root import first_polynomial_root, horner
from contact.laws import ContactLaw
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import LANES, next_modes, weighted_rows
from contact.restitution import damping_ratio
from contact.touch import hertz
from contact.touch.exchange import exchange_of
from contact.touch.hertz import CLOCK, COSINE, INVERSE, ORDER, PUSH, ROOT, SINE, SPEED, TOLERANCE
from contact.touch.power_plan import (
    DASHPOT_SLOPE,
    EFFECT,
    EXPONENT,
    FINENESS,
    LEFT,
    LEVER,
    NUMBERS,
    ONE,
    PRODUCTS,
    RIGHT,
    RISE,
    SLOPE,
    TIME,
    plan_of,
)
from contact.touch.series import WINDOW, limited_by_force, log_longest
from contact.trajectory import CONTACT, INSIDE, OUTSIDE

LAW, METHOD = "PowerContact", "power-series"
REGIMES = (OUTSIDE, CONTACT, INSIDE)
POWER = 4  # code of the law
MOST = WINDOW  # largest m: a mode moves at each order m of sigma, and `WINDOW` last orders limit a step

series_size, series_variable, state = hertz.series_size, hertz.series_variable, hertz.state

LETS_GO = 4
"""Row of the scalar series that holds G."""


@final
@dataclass(frozen=True, kw_only=True)
class PowerContact(ContactLaw):
    """Power of the depth with a dashpot: N = max(0, k d^p + c d^((p-1)/2) d') for d > 0.

    For p = 3/2 it is the law of Y. Tsuji, T. Tanaka and T. Ishida (Powder Technol. 71 (1992) 239), cut at
    zero force.  The restitution of a free mass is the same at every speed, for any exponent.

    Parameters
    ----------
    stiffness : float
        k, above zero [N/m^p].
    exponent : float
        p, from 1 to 3 [1]: a fraction with a denominator of at most 8.  With damping (p - 1)/2 must be such a
        fraction: all halves, thirds and quarters are valid in both cases.
    damping : float
        c, zero or more [N s/m^((p+1)/2)].
    """

    stiffness: float
    exponent: float
    damping: float = 0.0
    code: ClassVar[int] = POWER
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^p", "damping": "N s/m^((p+1)/2)"}

    def __post_init__(self) -> None:
        super().__post_init__()
        given = require_within("exponent of the contact", self.exponent, "[1]", low=1.0, high=3.0)
        nearest = self._fraction
        if abs(given - float(nearest)) > 4.0 * EPS * given:
            one = "with damping (p - 1)/2" if self.damping > 0.0 else "without damping it"
            words = f"{one} must be a fraction with a denominator of at most {MOST}"
            near = f"the nearest valid exponent is {nearest} = {float(nearest)!r}"
            raise InvalidValue("exponent of the contact", f"is {given!r} [1]; {words}, and {near}")

    @property
    def _fraction(self) -> Fraction:
        """The valid exponent next to the given one."""
        part = 2 if self.damping > 0.0 else 1
        return 1 + part * (Fraction(float(self.exponent) - 1.0) / part).limit_denominator(MOST)

    @property
    def adjustable(self) -> tuple[float, ...]:
        """Stiffness and damping; only the stiffness without damping, as m may differ with it."""
        return self.numbers if self.damping > 0.0 else self.numbers[:1]

    @property
    def table(self) -> np.ndarray:
        """The plan of the powers of rho; see `plan_of`."""
        return plan_of(self._fraction, self.damping > 0.0)

    @staticmethod
    def with_restitution(
        *, stiffness: float, exponent: float, restitution: float, mass: float
    ) -> PowerContact:
        """The law under which a free `mass` m [kg] leaves with `restitution` times its approach speed.

        `restitution` lies above 0 and is at most 1, and holds at every speed: c = 2 zeta sqrt((p + 1)/2 k m)
        with zeta of ``contact.damping_ratio``.  `mass` is that of ``LinearContact.with_restitution``.
        """
        elastic = PowerContact(stiffness=stiffness, exponent=exponent)
        mass = require_within("mass", mass, "kg", above=0)
        rate = math.sqrt(0.5 * (elastic.exponent + 1.0) * elastic.stiffness * mass)
        return replace(elastic, damping=2.0 * damping_ratio(restitution) * rate)


@kernel
def force(numbers, depth, rate):
    """N at penetration `depth` >= 0 and its `rate` [N]."""
    lever = depth ** (0.5 * numbers.table[NUMBERS, EXPONENT] - 0.5)
    return max(0.0, lever * (numbers.number0 * lever * depth + numbers.number1 * rate))


@kernel
def stiffness(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m]."""
    p = numbers.table[NUMBERS, EXPONENT]
    lever = depth ** (0.5 * p - 0.5)
    spring, dashpot = numbers.number0 * lever, numbers.number1 * rate
    if spring * depth + dashpot <= 0.0:
        return 0.0, 0.0
    bend = 0.5 * (p - 1.0) * lever * dashpot / depth if dashpot != 0.0 else 0.0
    return p * spring * lever + bend, numbers.number1 * lever


@part
def product(x, y, n):
    """Order n of the product of two series."""
    total = 0.0
    for i in range(n + 1):
        total += x[i] * y[n - i]
    return total


@part
def power(motion, series, number):
    """The scalar series in the row that this number of the table names."""
    return series.scalars[int(motion.table[NUMBERS, number])]


@part
def fill(motion, base, u, v, pushes, series):
    """The Taylor coefficients in sigma from (u, v) at drive time `base` [s], with or without the force.

    On entry scalars[ROOT, 0] holds rho."""
    rows, sums, modes, w, scalars = series.rows, series.sums, motion.modes, motion.drive, series.scalars
    a, b, table, damping = motion.tip_sine, motion.tip_cosine, motion.table, motion.number1
    root, clock, push, lets_go = scalars[ROOT], scalars[CLOCK], scalars[PUSH], scalars[LETS_GO]
    time, lever, rise = power(motion, series, TIME), power(motion, series, LEVER), power(motion, series, RISE)
    at_v, fineness, products = LANES + modes.shape[1], table[NUMBERS, FINENESS], int(table[NUMBERS, PRODUCTS])
    sine, cosine = sine_cosine(w * base, 0.0)
    speed = tip_sum(motion, w * (a * cosine - b * sine), v)
    for k in range(u.size):
        rows[0, LANES + k] = u[k]
        rows[0, at_v + k] = v[k]
    rows[0, SPEED], rows[0, SINE], rows[0, COSINE] = speed, sine, cosine
    clock[0], push[ORDER], scalars[ONE, 0] = 0.0, 0.0, 1.0
    for n in range(ORDER):
        for i in range(products):
            left, right = int(table[LEFT, i]), int(table[RIGHT, i])
            scalars[ONE + 1 + i, n] = product(scalars[left], scalars[right], n)
        lets_go[n] = motion.number0 * rise[n] + damping * speed
        push[n] = product(lever, lets_go, n) if pushes else 0.0
        inverse, start = INVERSE[n + 1], time[0]
        weighted_rows(time, n, -1, rows, n, sums)
        root[n + 1], clock[n + 1] = inverse / fineness * speed, inverse * time[n]
        tip = next_modes(modes, sums, start, inverse, time[n], inverse * push[n], n, rows)
        turn = w * inverse
        sine, cosine = turn * (sums[COSINE] + start * cosine), -turn * (sums[SINE] + start * sine)
        speed = w * (a * cosine - b * sine) + tip
        rows[n + 1, SPEED], rows[n + 1, SINE], rows[n + 1, COSINE] = speed, sine, cosine


@kernel
def slopes(motion, run, series, weights):
    """The series for the tangents: rho^(m-1) times 1, dN/dd, dN/dd', N, dN/dk and dN/dc."""
    k, c, p, rates = motion.number0, motion.number1, motion.table[NUMBERS, EXPONENT], series.rows[:, SPEED]
    time, lever, rise = power(motion, series, TIME), power(motion, series, LEVER), power(motion, series, RISE)
    slope, dashpot = power(motion, series, SLOPE), power(motion, series, DASHPOT_SLOPE)
    pushes, half = 0.0 if run.regime == INSIDE else 1.0, 0.5 * (p - 1.0) * c
    for n in range(ORDER):
        weights.time[n], weights.force[n] = time[n], series.scalars[PUSH, n]
        weights.depth[n] = pushes * (p * k * slope[n] + half * product(dashpot, rates, n))
        weights.rate[n] = pushes * c * lever[n]
        weights.first[n] = pushes * product(lever, rise, n)
        weights.second[n] = pushes * product(lever, rates, n)
    return ORDER


@kernel
def exchange(motion, run, span, series, known):
    """What the tip gives to the stop: work, impulse and largest force; see ``contact.touch``."""
    rate, time = series.rows[:, SPEED], power(motion, series, TIME)
    return exchange_of(series, series.scalars[PUSH], rate, time, span, known)


@part
def farthest(motion, speed, root):
    """The sigma up to which a step sees each force that enters the speeds beyond `WINDOW` orders."""
    m, p, e = motion.table[NUMBERS, FINENESS], motion.table[NUMBERS, EXPONENT], motion.table[NUMBERS, EFFECT]
    allowed, negligible = 0.5 * (p + 1.0) * TOLERANCE * speed / math.sqrt(motion.inverse_mass), math.inf
    if 2.0 * e > WINDOW:  # the impulse k d^(p+1)/((p+1) d'), d' = m root[1]
        negligible = (2.0 * allowed * m * abs(root[1]) / motion.number0) ** (0.5 / e)
    if motion.number1 > 0.0 and e > WINDOW:  # 2 c d^((p+1)/2)/(p+1)
        negligible = min(negligible, (allowed / motion.number1) ** (1.0 / e))
    way = max(2.0 * root[0], negligible - root[0])
    s = way / abs(root[1]) if root[1] != 0.0 else math.inf
    return min(s, math.sqrt(way / abs(root[2]))) if root[2] != 0.0 and way > 0.0 else s


@part
def longest_step(motion, speed, series):
    """The sigma up to which the series holds: the last `WINDOW` orders of modes, rho and force are small."""
    root, longest, size = series.scalars[ROOT], math.inf, math.log(TOLERANCE) / ORDER
    for n in range(ORDER - WINDOW + 1, ORDER + 1):
        top = hertz.greatest_speed(motion.modes, series.rows, n)
        longest = min(longest, size + log_longest(top, n, speed))
        if root[n] != 0.0 and (root[0] != 0.0 or root[1] != 0.0):
            whole = log_longest(abs(root[n]), n, abs(root[0])) if root[0] != 0.0 else -math.inf
            linear = log_longest(abs(root[n]), n - 1, abs(root[1])) if root[1] != 0.0 else -math.inf
            longest = min(longest, size + max(whole, linear))
    push, mobility, edge = series.scalars[PUSH], math.sqrt(motion.inverse_mass), TOLERANCE ** (1.0 / ORDER)
    s = limited_by_force(math.exp(longest), push, ORDER - 1, mobility, speed, edge)
    s = min(s, farthest(motion, speed, root))
    if root[1] < 0.0 < root[0]:  # stop well behind the release: without a force the terms give no bound
        s = min(s, -4.0 * root[0] / root[1])
    deep = max(root[0], horner(root, 1.0, 0.0, s)[0]) if s < math.inf else root[0]
    rate = motion.inverse_mass * motion.number1 * deep ** (motion.table[NUMBERS, EFFECT] - 1.0)
    return min(s, hertz.RELAXED / rate) if rate > 0.0 else s


@kernel
def step(motion, run, u, v, limit, series):
    """One step from (u, v), at most `limit` [s]; see ``contact.touch``."""
    root, clock, lets_go = series.scalars[ROOT], series.scalars[CLOCK], series.scalars[LETS_GO]
    if run.memory1 < 0.0:
        run.memory1 = speed_scale(motion, u, v)
    if run.memory0 < 0.0:
        run.memory0 = hertz.first_depth(motion, run, u, v) ** (1.0 / motion.table[NUMBERS, FINENESS])
    root[0], regime = run.memory0, run.regime
    fill(motion, run.clock, u, v, regime == CONTACT, series)
    if run.memory1 == 0.0:  # nothing moves
        return 0.0, limit, regime
    s = longest_step(motion, run.memory1, series)
    if not (0.0 < s < math.inf):
        return math.nan, math.nan, CONTACT
    end, following = hertz.release_in(root, s), regime
    if end >= 0.0:
        s, following = end, OUTSIDE
    if motion.number1 > 0.0:
        margin = 4.0 * EPS * motion.number1 * math.sqrt(motion.inverse_mass) * run.memory1
        end = first_polynomial_root(lets_go, -1.0 if regime == CONTACT else 1.0, s, margin)
        if 0.0 <= end < s:
            s, following = end, INSIDE if regime == CONTACT else CONTACT
    length = horner(clock, 1.0, 0.0, s)[0]
    if length > limit:
        s, length, following = series_variable(motion, limit, s, series), limit, regime
    run.memory0 = horner(root, 1.0, 0.0, s)[0]
    return s, length, following
