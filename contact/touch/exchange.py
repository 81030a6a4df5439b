"""What the tip gives to the stop in a step of a contact: work, impulse and the largest force.

A step runs over the variable s of its series, which hold P = N dt/ds, the rate d' and q = dt/ds.  Then

    work = integral of P d' ds,   impulse = integral of P ds,   N = P/q,   dN/ds = (P' q - P q')/q^2,

and the largest force lies at an end or where P' q - P q' falls through zero.  The integrals are sums over the
nodes of Gauss's rule.  The same values of N show every maximum: two nodes are less than half a radian of the
fastest mode apart, and so are a node and an end.  A maximum that may exceed the largest force so far is then
found to rounding.
"""

import math

import numpy as np

from contact.flight.polynomial_root import horner
from contact.machine.compiled import kernel
from contact.machine.vector_loops import weighted_rows

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
NODES, WEIGHTS = 0.5 * (1.0 + _NODES), 0.5 * _WEIGHTS
NODE_POWERS = NODES ** np.arange(31.0)[:, None]
"""Gauss's rule on [0, 1], and powers of its nodes up to the highest order of a series.  For a product that
turns by some six radians in a step its error is below 1e-20.  For series that converge up to R and a step s
it falls as rho^-32, rho = q + sqrt(q^2 - 1), q = 2 R/s - 1: faster than the (s/R)^p of the series."""

UNIFORM = np.eye(1, 31)[0]
"""dt/ds of a series in time."""

SLOW = 1e-6  # part of the largest dt/ds of a step, below which N = P/q is zero, or lost in rounding
SHARP = 1e-8  # part of a step within which a maximum is found: the force there is right to the square of this


@kernel
def force_and_slope(push, slow, least, s):
    """The force at `s`, a number with the sign of its slope, and the slope of this number.

    The force counts as zero where dt/ds is at most `least`.
    """
    p0, p1, p2 = horner(push, 1.0, 0.0, s)
    q0, q1, q2 = horner(slow, 1.0, 0.0, s)
    return p0 / q0 if q0 > least else 0.0, p1 * q0 - p0 * q1, p2 * q0 - p0 * q2


@kernel
def maximum(push, slow, least, near, width):
    """The maximum of the force next to the middle one of three places `near`, to `SHARP` of the `width`."""
    low, s, high = near
    for _ in range(60):
        force, slope, curvature = force_and_slope(push, slow, least, s)
        if slope > 0.0:
            low = s
        else:
            high = s
        new = s - slope / curvature if curvature < 0.0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) <= SHARP * width:
            return force
        s = new
    return force


@kernel
def largest_force(push, slow, at_nodes, span, known):
    """The larger of `known` and the largest force in a `span` of the step [N].

    `at_nodes` holds P and q at the nodes of the whole step, which ends with the span.
    """
    first, end = span
    least, count, top = SLOW * at_nodes[1].max(), NODES.size, known if known > 0.0 else 0.0
    here, after = first, first
    before, force, following = -math.inf, -math.inf, force_and_slope(push, slow, least, first)[0]
    for i in range(count + 2):
        if i < count and end * NODES[i] <= first:
            continue
        place, here = here, after
        before, force = force, following
        after, following = end, -math.inf
        if i < count:
            after = end * NODES[i]
            following = at_nodes[0, i] / at_nodes[1, i] if at_nodes[1, i] > least else 0.0
        elif i == count:
            following = force_and_slope(push, slow, least, end)[0]
        top = max(top, force)
        if force >= before and force >= following:
            spread = max(force - before if before > -math.inf else 0.0, force - max(following, 0.0))
            if force + spread > top:
                top = max(top, maximum(push, slow, least, (place, here, after), end))
    return top


@kernel
def exchange_of(series, push, rate, slow, span, known):
    """Work [J], impulse [N s] and the larger of `known` and the largest force [N] of a step, uses two rows.

    The step has the series P, d' and q, as `push`, `rate` and `slow`.  Its `span` is (first, end): the whole
    step up to `end` gives work and impulse, but the force counts from `first` on only.
    """
    terms, nodes, power, end = push.size, WEIGHTS.size, 1.0, span[1]
    pushes, rates, at_nodes, speeds = (
        series.scalars[6],
        series.scalars[7],
        np.empty((2, nodes)),
        np.empty(nodes),
    )
    for n in range(terms):
        pushes[n], rates[n] = power * push[n], power * rate[n]
        power *= end
    weighted_rows(pushes, 0, 1, NODE_POWERS, terms, at_nodes[0])
    weighted_rows(rates, 0, 1, NODE_POWERS, terms, speeds)
    work, impulse, power = 0.0, 0.0, 1.0
    for i in range(nodes):
        given = WEIGHTS[i] * end * at_nodes[0, i]
        work += given * speeds[i]
        impulse += given
    for n in range(terms):
        rates[n] = power * slow[n]
        power *= end
    weighted_rows(rates, 0, 1, NODE_POWERS, terms, at_nodes[1])
    return work, impulse, largest_force(push, slow, at_nodes, span, known)
