"""Where a step of the Hertz contact ends.

The series of ``contact.hertz_lanes`` hold up to the sigma at which their last terms, in every mode and in r,
reach ``HERTZ_TOLERANCE`` of the modal speeds.  The step ends earlier where r falls to zero: the release.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

from contact.certificate import first_polynomial_root, polynomial_root
from contact.compiled import kernel
from contact.flight import EPS
from contact.hertz_lanes import CLOCK, LANE_ORDER, ROOT
from contact.hertz_series import HERTZ_TOLERANCE, evaluate
from contact.lanes import LANES
from contact.modal_flow import SQUARE

__all__ = ["lane_step"]

FAR = math.log(1.5)
"""Logarithm of the factor by which the last term but one of r must fall short of the others' bound to count:
where the modes take part, both ends of the series agree within it."""


@kernel
def longest(last, order, allowed):
    """Logarithm of the s at which `last` s^`order` reaches `allowed`; of infinity if it never does."""
    return (math.log(allowed) - math.log(last)) / order if last > 0.0 else math.inf


@kernel
def greatest_speed(numbers, series, order):
    """The largest coefficient of this order among all v and omega u."""
    m, top = numbers.shape[1], 0.0
    for k in range(m):
        u, v = series[order, LANES + k], series[order, LANES + m + k]
        top = max(top, v * v, numbers[SQUARE, k] * u * u)
    return math.sqrt(top)


@kernel
def release_in(r, s, negative):
    """The sigma in (0, s] at which r falls to zero, or -1."""
    rest, power = 0.0, s
    for n in range(2, LANE_ORDER + 1):
        power *= s
        rest += abs(r[n]) * power
    start, drift = abs(r[0]), r[1] * s
    size = start + abs(drift) + rest
    margin = 2.0 * EPS * size
    # r >= r_0 + (r_1 - rest/s) sigma if that grows, and r >= r_0 - |drift| - rest at any rate
    if drift - rest > margin or start - abs(drift) - rest > margin:
        return -1.0
    for n in range(LANE_ORDER + 1):
        negative[n] = -r[n]
    return first_polynomial_root(negative, 0.0, s, EPS * size)


@kernel
def lane_step(numbers, speed_size, series, scalars, negative, limit):
    """Length of the step in sigma and how it ends.

    Parameters
    ----------
    numbers, series, scalars
        As in ``contact.hertz_lanes``.
    speed_size : float
        From `speed_scale`, of the start of the contact.
    negative : ndarray, shape (LANE_ORDER + 1,)
        Work space.
    limit : float
        The longest step [s].

    Returns
    -------
    s : float
        Step in sigma.
    released : bool
        Whether the contact ends there.
    length : float
        Its duration [s], at most `limit`.
    """
    p, r, clock = LANE_ORDER, scalars[ROOT], scalars[CLOCK]
    allowed = HERTZ_TOLERANCE * speed_size
    power = min(
        longest(greatest_speed(numbers, series, p), p, allowed),
        longest(greatest_speed(numbers, series, p - 1), p - 1, allowed),
    )
    # r must be resolved as well as the modes, relative to the larger of its first two terms; under a contact
    # so soft that the modes give no bound, r is odd in sigma and its last term alone gives none either
    for n in (p, p - 1):
        if r[n] != 0.0 and (r[0] != 0.0 or r[1] != 0.0):
            whole = longest(abs(r[n]), n, HERTZ_TOLERANCE * abs(r[0])) if r[0] != 0.0 else -math.inf
            linear = longest(abs(r[n]), n - 1, HERTZ_TOLERANCE * abs(r[1])) if r[1] != 0.0 else -math.inf
            if n == p or max(whole, linear) < power - FAR:
                power = min(power, max(whole, linear))
    s = math.exp(power)
    if r[1] < 0.0 < r[0]:
        # no further than well behind the release: with no force left the terms give no bound
        s = min(s, -4.0 * r[0] / r[1])
    length, released = evaluate(clock, s), False
    end = release_in(r, s, negative)
    if end >= 0.0:
        s, released = end, True
        length = evaluate(clock, s)
    if length > limit:
        for n in range(p + 1):
            negative[n] = clock[n]
        negative[0] -= limit
        s, released, length = polynomial_root(negative, 0.0, s), False, limit
    return s, released, length
