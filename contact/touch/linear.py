"""A linear stop: N = max(0, k d + c d') for d > 0 (``LinearContact``).

With a dashpot the force vanishes while the tip is still behind the wall (regime INSIDE): there it moves
freely until it pushes again or leaves.  The series is that of ``contact.touch.time_series`` with

    N[n] = k d[n] + c (n+1) d[n+1].

Motion in contact is linear: the series is that of a matrix exponential, summed to rounding (S. W. Shaw, P. J.
Holmes, J. Sound Vib. 90 (1983) 129, for one mode).
"""

import math

from contact.flight.elementary import EPS
from contact.flight.polynomial_root import first_polynomial_root
from contact.flight.tip import tip_rounding
from contact.machine.compiled import kernel, part
from contact.state import CONTACT, INSIDE, OUTSIDE
from contact.touch import time_series
from contact.touch.time_series import DEPTH, FORCE, begin, extend, longest_step

LAW, METHOD = "LinearContact", "piecewise-linear"
REGIMES = (OUTSIDE, CONTACT, INSIDE)


@part
def force(numbers, depth, rate):
    """N at penetration `depth` >= 0 and its `rate` [N]."""
    return max(0.0, numbers.number0 * depth + numbers.number1 * rate)


@part
def stiffness(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m]."""
    if numbers.number0 * depth + numbers.number1 * rate <= 0.0:
        return 0.0, 0.0
    return numbers.number0, numbers.number1


@part
def slopes(numbers, run, series, weights):
    """The series for the tangents: dN/dd and dN/dd' are constants, and zero behind the wall without force."""
    pushes = 0.0 if run.regime == INSIDE else 1.0
    weights.time[0] = 1.0
    weights.depth[0], weights.rate[0] = pushes * numbers.number0, pushes * numbers.number1
    for n in range(time_series.ORDER):
        depth, rate = series.scalars[DEPTH, n], (n + 1.0) * series.scalars[DEPTH, n + 1]
        weights.force[n] = pushes * (numbers.number0 * depth + numbers.number1 * rate)
        weights.first[n], weights.second[n] = pushes * depth, pushes * rate
    return 1


@part
def joins(numbers):
    """It is followed beside other contacts."""
    return True


@part
def coefficient(numbers, n, depth):
    """Order n of k d + c d'."""
    return numbers.number0 * depth[n] + numbers.number1 * (n + 1.0) * depth[n + 1]


@kernel
def step(numbers, run, u, v, limit, series):
    """One step from (u, v), at most `limit` [s]; see ``contact.touch``."""
    k, c = numbers.number0, numbers.number1
    depth, force = series.scalars[DEPTH], series.scalars[FORCE]
    begin(numbers, run.clock, u, v, series)
    for n in range(time_series.ORDER - 1):
        force[n] = coefficient(numbers, n, depth)
        extend(numbers, n, 0.0 if run.regime == INSIDE else force[n], series)
    h = min(longest_step(numbers, k * depth[0] ** 2, u, v, series), limit)
    if not h > EPS * run.clock:
        return math.nan, math.nan, CONTACT
    rounding = tip_rounding(numbers, u, v)
    if run.regime == CONTACT:
        end = first_polynomial_root(force, -1.0, h, rounding * k)
        if end >= 0.0:
            return end, end, OUTSIDE if c == 0.0 else INSIDE
        return h, h, CONTACT
    closes = first_polynomial_root(force, 1.0, h, rounding * k)
    leaves = first_polynomial_root(depth, -1.0, h, rounding)
    if leaves >= 0.0 and (closes < 0.0 or leaves <= closes):
        return leaves, leaves, OUTSIDE
    if closes >= 0.0:
        return closes, closes, CONTACT
    return h, h, INSIDE
