"""The modes under a contact force that is a power series in time.

    u[n+2] = ( g - c (n+1) u[n+1] - omega^2 u[n] - phi_k N[n] ) / ((n+1)(n+2))      (g for n = 0 only)

A law computes N[n] from d[0] ...  d[n + 1], then `extend` the next order of all modes, eight at a time
(``contact.machine.vector_loops``).  With order 30 a step covers some three radians of the fastest mode.  A
higher order would save work and lose more digits (``docs/theory/contact.md``).
"""

import math

from contact.flight.elementary import EPS, sine_cosine
from contact.flight.modal_flow import speed_scale
from contact.flight.tip import tip_steady, tip_sum
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import next_order, weighted_rows
from contact.state import INSIDE
from contact.touch.exchange import UNIFORM, exchange_of
from contact.touch.series import add_modes, limited_by_force, log_longest, powers_of

ORDER = 30  # order of the series in time

DEPTH, RATE, FORCE, STEADY, POWERS, SLOPES = range(6)
"""Rows of the scalar series: d, d' (filled by `exchange`), N, the steady tip motion, powers of time and their
derivatives."""

TOLERANCE = 0.1 * EPS  # size of the last terms of a step, relative to the modal speeds

EDGE = TOLERANCE ** (1.0 / (ORDER - 1))

OVERFLOW = 1e300
"""Coefficients beyond this are about to leave the range of doubles, at some 1e18 times the stiffness of the
spring."""


@part
def series_size(numbers):
    """Order and columns of the series."""
    return ORDER, numbers.modes.shape[1]


@part
def begin(numbers, base, u, v, series):
    """The first two orders of a step from (u, v) at drive time `base` [s]."""
    rows, depth, steady, w = series.rows, series.scalars[DEPTH], series.scalars[STEADY], numbers.drive
    depth[0], depth[1], _acceleration = tip_steady(numbers, base)
    steady[0], steady[1] = depth[0] - numbers.level, depth[1]
    depth[0], depth[1] = tip_sum(numbers, depth[0], u), tip_sum(numbers, depth[1], v)
    for k in range(u.size):
        rows[0, k] = u[k]
        rows[1, k] = v[k]
    for n in range(ORDER - 1):
        steady[n + 2] = -w * w * steady[n] / ((n + 1.0) * (n + 2.0))
    series.scalars[FORCE, ORDER - 1 :] = 0.0


@part
def extend(numbers, n, push, series):
    """Compute order n + 2 of all modes and of d from the force coefficient `push` of order n."""
    scale, lift = 1.0 / ((n + 1.0) * (n + 2.0)), 1.0 if n == 0 else 0.0
    tip = next_order(numbers.modes, n + 1.0, scale, push, lift, n, series.rows)
    series.scalars[DEPTH, n + 2] = series.scalars[STEADY, n + 2] + tip


@part
def free_pull(numbers, n, series):
    """Order n of the tip acceleration without a force."""
    divisor, lift = (n + 1.0) * (n + 2.0), 1.0 if n == 0 else 0.0
    tip = next_order(numbers.modes, n + 1.0, 1.0 / divisor, 0.0, lift, n, series.rows)
    return divisor * (series.scalars[STEADY, n + 2] + tip)


@part
def largest(row):
    """The largest absolute value of a row."""
    a, b = 0.0, 0.0
    for k in range(0, row.size, 2):
        a, b = max(a, abs(row[k])), max(b, abs(row[k + 1]))
    return max(a, b)


@part
def longest_of_modes(numbers, stored, u, v, rows):
    """Longest time by the last terms of the modes [s], and the size of the speeds; see `longest_step`."""
    scale = speed_scale(numbers, u, v)
    speed = math.sqrt(scale * scale + stored)
    top, below = largest(rows[ORDER]), largest(rows[ORDER - 1])
    allowed = TOLERANCE * speed
    last = log_longest(ORDER * top, ORDER - 1, allowed)
    power = min(last, log_longest((ORDER - 1.0) * below, ORDER - 2, allowed))
    return min(math.exp(power), numbers.period), speed


@kernel
def longest_step(numbers, stored, u, v, series):
    """Longest time over which the neglected terms stay below rounding [s]; NaN if the series overflows.

    `stored` is twice the energy in the stop at the start of the step [J].
    """
    depth, force = series.scalars[DEPTH], series.scalars[FORCE]
    if not (abs(depth[ORDER]) < OVERFLOW and abs(force[ORDER - 2]) < OVERFLOW):
        return math.nan
    h, speed = longest_of_modes(numbers, stored, u, v, series.rows)
    return limited_by_force(h, force, ORDER - 2, math.sqrt(numbers.inverse_mass), speed, EDGE)


@part
def series_variable(numbers, t, end, series):
    """The variable of the series a time `t` [s] into a step: this time itself."""
    return t


@kernel
def height_over(numbers, run, weight, own, series, out):
    """The series of the height over another stop, in `out`; see ``contact.touch``."""
    w = numbers.drive
    sine, cosine = sine_cosine(w * run.clock, 0.0)
    out[0], out[1] = own[1] * sine + own[2] * cosine, w * (own[1] * cosine - own[2] * sine)
    for n in range(ORDER - 1):
        out[n + 2] = -w * w * out[n] / ((n + 1.0) * (n + 2.0))
    return add_modes(series.rows, 0, weight, own[0], out)


@kernel
def state(numbers, run, h, series, u, v):
    """Deviations of all modes a time `h` [s] into the step, in `u` and `v`."""
    powers, slopes = series.scalars[POWERS], series.scalars[SLOPES]
    powers_of(h, powers)
    for n in range(ORDER):
        slopes[n + 1] = (n + 1.0) * powers[n]
    weighted_rows(powers, 0, 1, series.rows, ORDER + 1, series.sums)
    for k in range(u.size):
        u[k] = series.sums[k]
    weighted_rows(slopes, 0, 1, series.rows, ORDER + 1, series.sums)
    for k in range(u.size):
        v[k] = series.sums[k]


@kernel
def exchange(numbers, run, span, series, known):
    """What the tip gives to the stop: work, impulse and largest force; see ``contact.touch``."""
    depth, rate = series.scalars[DEPTH], series.scalars[RATE]
    if run.regime == INSIDE:
        return 0.0, 0.0, max(known, 0.0)
    for n in range(ORDER):
        rate[n] = (n + 1.0) * depth[n + 1]
    return exchange_of(series, series.scalars[FORCE], rate, UNIFORM, span, known)
