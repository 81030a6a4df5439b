"""What the power series of all force laws share: their workspace, and the length of a step.

While the tip is in contact all modes are coupled through one number, the contact force N:

    u_k'' = -c_k u_k' - omega_k^2 u_k + g_k - phi_k N(d, d'),   d(t) = sum_k phi_k u_k + x_s(t) - gap.

A step ends where the last terms reach rounding.  Each order n estimates the radius of convergence by the root
test, R_n = (A/|x_n|)^(1/n), and a step of R tol^(1/p) leaves terms of tol A at the order p.  Some orders can
vanish, so that the last two orders of the modes and the last orders of N limit the step
(``docs/theory/contact.md``).
"""

import math
from typing import NamedTuple

import numpy as np

from contact.flight.tip import tip_state
from contact.machine.compiled import aligned, inlined, kernel, part
from contact.state import CONTACT

WINDOW = 8  # number of last orders of the force that limit a step
LOOSE = 1.15  # largest ratio of a step to the bound by an earlier order: no two agree better


class Series(NamedTuple):
    """Workspace of one step in contact."""

    rows: np.ndarray  # coefficients of the modes, row n of order n, shape (order + 1, columns)
    sums: np.ndarray  # shape (columns,)
    scalars: np.ndarray  # series of single numbers, rows 6, 7 are the law's own, shape (8, order + 1)
    scaled: np.ndarray  # for ``contact.touch.exchange``: P, d' and q of a step of length 1, (3, order + 1)
    places: np.ndarray  # for the same: numbers at places of the step, shape (4, 16)


@kernel
def new_series(order, columns):
    """A workspace of zeros."""
    rows, sums = aligned(order + 1, columns), aligned(1, columns)[0]
    return Series(rows, sums, np.zeros((8, order + 1)), np.zeros((3, order + 1)), aligned(4, 16))


@kernel
def fitted(series, order, columns):
    """A part of a workspace that has just this order and these columns."""
    terms = order + 1
    rows = series.rows.reshape(series.rows.size)[: terms * columns].reshape(terms, columns)
    scalars = series.scalars.reshape(series.scalars.size)[: 8 * terms].reshape(8, terms)
    scaled = series.scaled.reshape(series.scaled.size)[: 3 * terms].reshape(3, terms)
    return Series(rows, series.sums[:columns], scalars, scaled, series.places)


@part
def strike(numbers, run, u, v, approach):
    """A touch under a force law: the contact begins at d = 0; see ``contact.touch``."""
    run.memory0, run.memory1 = 0.0, -1.0
    return CONTACT, math.nan, 0.0, math.nan


@part
def leave(numbers, run, u, v):
    """The release of a force law: the next flight starts on the wall with a velocity."""
    run.contact_order = 1
    return tip_state(numbers, run.clock, u, v)[1]


@part
def saltation(numbers, vary, before, after, tangent):
    """No immediate effect: the tangents have gone through the contact with its series."""


@part
def inside(numbers, vary, now, length, tangent):
    """No more effect: the tangents have gone up to this time with the series."""


@part
def joins(numbers):
    """Whether contacts of this law are followed while others are closed: not without more."""
    return False


@part
def coefficient(numbers, n, depth):
    """No series of its own beside others."""
    return math.nan


def acceleration(force, numbers, free, q, rate):
    """The acceleration `free` of the modes less that by the push of the stop, under the `force` of a law."""
    depth = numbers.tip(q) - numbers.gap
    return free - numbers.phi * force(numbers, depth, numbers.tip(rate)) if depth > 0.0 else free


def repeated_touch(numbers, speed, m):
    """No closed form."""
    return None


@part
def product(x, y, n):
    """Order n of the product of two series; the newest terms are added last."""
    even, odd = 0.0, 0.0
    for i in range(1, n - 1, 2):
        even += x[i] * y[n - i]
        odd += x[i + 1] * y[n - i - 1]
    if n > 0 and n % 2 == 0:
        even += x[n - 1] * y[1]
    return even + odd + x[0] * y[n] + (x[n] * y[0] if n > 0 else 0.0)


@part
def add_modes(rows, first, weight, level, out):
    """Add a level and the modes, from the column `first` on, to the series of a height; returns the order."""
    for n in range(rows.shape[0]):
        for k in range(weight.size):
            out[n] += weight[k] * rows[n, first + k]
    out[0] += level
    return rows.shape[0] - 1


@part
def powers_of(s, out):
    """Fill `out` with 1, s, s^2, ..."""
    power = 1.0
    for n in range(out.size):
        out[n] = power
        power *= s


@kernel
def log_longest(last, order, allowed):
    """Logarithm of the s at which `last` s^`order` is `allowed`; infinity if `last` is zero."""
    return (math.log(allowed) - math.log(last)) / order if last > 0.0 else math.inf


@inlined
def limited_by_force(s, push, last, mobility, speed, edge):
    """The step `s`, or a shorter one where the orders of the force allow less than the orders of the modes.

    That step is infinite if the last two orders of the modes are zero.  `push` is the series of the force on
    the modes, filled up to the order `last`: phi_k push_n/(n + 1) enters order n + 1 of the speeds.
    `mobility` is sqrt(sum phi^2), the size of all phi_k [kg^-0.5], `speed` the size of the speeds, and `edge`
    the tolerance to the power of one over the order of the series.
    """
    x, first = s / (LOOSE * edge), last - WINDOW + 1
    power, fits = mobility * x**first, True
    for n in range(first, last + 1):
        power *= x
        fits = fits and abs(push[n]) * power <= speed * (n + 1)
    if fits:
        return s
    for n in range(first, last + 1):
        if push[n] != 0.0:
            s = min(s, edge * (speed * (n + 1) / (mobility * abs(push[n]))) ** (1.0 / (n + 1)))
    return s
