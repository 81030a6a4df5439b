"""What the tip gives to the stop in a step of a contact: work, impulse and the largest force.

A step runs over the variable s of its series, which hold P = N dt/ds, the rate d' and q = dt/ds.  Then

    work = integral of P d' ds,   impulse = integral of P ds,   N = P/q,   dN/ds = (P' q - P q')/q^2,

as sums over the nodes of Gauss's rule.  The largest force lies at an end or where P' q - P q' falls through
zero between two of these nodes (``docs/theory/contact.md``).
"""

import numpy as np

from contact.flight.polynomial_root import horner
from contact.machine.compiled import kernel
from contact.machine.vector_loops import LANES, weighted_rows

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(13)
PLACES, WEIGHTS = np.r_[0.0, 0.5 * (1.0 + _NODES), 1.0], np.r_[0.0, 0.5 * _WEIGHTS, 0.0]
SLOPE = PLACES.size  # column that gives the slope at the end
POWERS = np.zeros((31, 2 * LANES))
POWERS[:, :SLOPE], POWERS[:, SLOPE] = PLACES ** np.arange(31.0)[:, None], np.arange(31.0)
"""Gauss's rule on [0, 1], and powers of its nodes and both ends up to the highest order of a series.  For a
product that turns by some six radians in a step its error is below 1e-20.  For series that converge up to R
and a step s it falls as rho^-26, rho = q + sqrt(q^2 - 1), q = 2 R/s - 1: faster than the (s/R)^p of the
series."""

UNIFORM = np.eye(1, 31)[0]
"""dt/ds of a series in time."""

SLOW = 1e-6  # part of the largest dt/ds of a step, below which N = P/q is zero, or lost in rounding
SHARP = 1e-5  # part of a step from which a maximum is found by a parabola: right to the cube of this


@kernel
def force_and_slopes(push, slow, least, s):
    """The force at `s` and its first two derivatives, all zero where dt/ds is at most `least`."""
    p0, p1, p2 = horner(push, 1.0, 0.0, s)
    q0, q1, q2 = horner(slow, 1.0, 0.0, s)
    if not q0 > least:
        return 0.0, 0.0, 0.0
    force, inverse = p0 / q0, 1.0 / q0
    slope = inverse * (p1 - force * q1)
    return force, slope, inverse * (p2 - force * q2 - 2.0 * slope * q1)


@kernel
def maximum(push, slow, least, near, width):
    """The maximum of the force next to the middle one of three places `near` in a step of this `width`."""
    low, s, high = near
    for _ in range(60):
        force, slope, curvature = force_and_slopes(push, slow, least, s)
        low, high = (s, high) if slope > 0.0 else (low, s)
        new = s - slope / curvature if curvature < 0.0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= SHARP * width:
            return force + 0.5 * slope * (new - s)
        s = new
    return force


@kernel
def largest_force(push, slow, least, places, span, known):
    """The larger of `known` and the largest force in a `span` of the step, which ends with it [N].

    The rows of `places` hold P, d', q and N at `PLACES`, and the slopes of P and q at `SLOPE`.
    """
    (first, end), start, last, force = span, 0, PLACES.size - 1, places[3]
    while start < last - 1 and end * PLACES[start + 1] <= first:
        start += 1
    rises, falls = push[1] * slow[0] - push[0] * slow[1], places[0, SLOPE] * places[2, last]
    falls -= places[0, last] * places[2, SLOPE]
    if first > 0.0:
        force[start], rises, _curvature = force_and_slopes(push, slow, least, first)
    top = max(known if known > 0.0 else 0.0, max(force[start], force[last]))
    for j in range(start, last + 1):
        left, right = max(j - 1, start), min(j + 1, last)
        lower = min(force[left], force[right])
        if force[j] < max(force[left], force[right]) or not 2.0 * force[j] - max(lower, 0.0) > top:
            continue
        if (j > start or rises > 0.0) and (j < last or falls < 0.0):
            near = max(first, end * PLACES[left]), max(first, end * PLACES[j]), end * PLACES[right]
            top = max(top, max(force[j], maximum(push, slow, least, near, end)))
    return top


@kernel
def exchange_of(series, push, rate, slow, span, known):
    """Work [J], impulse [N s] and the larger of `known` and the largest force [N] of a step.

    The step has the series P, d' and q, as `push`, `rate` and `slow`.  Its `span` is (first, end): the whole
    step up to `end` gives work and impulse, but the force counts from `first` on only.
    """
    terms, end, places, scaled, power = push.size, span[1], series.places, series.scaled, 1.0
    for n in range(terms):
        scaled[0, n], scaled[1, n], scaled[2, n] = power * push[n], power * rate[n], power * slow[n]
        power *= end
    for i in range(3):
        weighted_rows(scaled[i], 0, 1, POWERS, terms, places[i])
    work, impulse, least = 0.0, 0.0, SLOW * places[2, : PLACES.size].max()
    for i in range(PLACES.size):
        given = WEIGHTS[i] * end * places[0, i]
        work += given * places[1, i]
        impulse += given
        places[3, i] = places[0, i] / places[2, i] if places[2, i] > least else 0.0
    return work, impulse, largest_force(push, slow, least, places, span, known)
