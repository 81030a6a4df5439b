"""Flights of a mode with cubic stiffness and inertia, by Taylor series in time.

    (1 + a x^2) x'' + a x x'^2 + mu x' + W^2 (x + b x^3) = cosine cos(2 pi f t) + sine sin(2 pi f t)

x and x' are series of order `ORDER`, each step as long as its last terms allow (`SMALL` of the gap).  The
first crossing of the stop within a step is the first root of that polynomial, certified
(``contact.flight.polynomial_root``).  A flight that rises above the stop by less than `GRAZED` of the gap
counts as free; touches of linear modes are known to the last digit instead.  Accumulating impacts end at rest
on the stop, once a rebound stays within ten times that band; the tip leaves where the force on it changes its
sign.  Flights also work on complex numbers: an imaginary step gives a derivative exact to rounding.

The cubic terms hold for small x.  The run ends without a result beyond `validity_limit`, where the restoring
force would fall or the mass vanish, and in a drive period of more than `MOST_STEPS`.
"""

import math

import numpy as np

from contact.flight.polynomial_root import first_polynomial_root, horner
from contact.machine.compiled import kernel

FLOWN, CHATTERED, LOST = range(3)
"""How drive periods end: all followed; more impacts than `MOST_IMPACTS`; a motion beyond the model."""

ORDER = 22  # order of the Taylor series: a drive period takes some eight steps
SMALL = 1e-16  # size of the last term of a step, relative to the gap
GRAZED = 1e-14  # height above the stop up to which a flight counts as free, relative to the gap
MOST_IMPACTS, MOST_STEPS = 1000, 10_000  # bounds of impacts and of steps in a drive period


@kernel
def series(p, cosine, sine, x, v, phase, work):
    """The Taylor coefficients of x and x' in rising order, from x and v at `phase` = 2 pi f t.

    p = (W^2, mu, b, a, 2 pi f); the force is cosine cos(2 pi f t) + sine sin(2 pi f t). Products by Leibniz'
    rule. The rows of `work`, shape (4, order + 1), are the series of x, x', x^2 and x'^2.
    """
    stiffness, decay, b, a, w = p
    xs, vs, square, rates = work[0], work[1], work[2], work[3]
    xs[0], vs[0] = x, v
    force = cosine * math.cos(phase) + sine * math.sin(phase)
    quadrature = cosine * math.sin(phase) - sine * math.cos(phase)
    for n in range(xs.size - 1):
        squared, cubed, rated, inertial = 0.0 * x, 0.0 * x, 0.0 * x, 0.0 * x
        for j in range(n + 1):
            squared += xs[j] * xs[n - j]
            rated += vs[j] * vs[n - j]
        square[n], rates[n] = squared, rated
        for j in range(n + 1):
            cubed += square[j] * xs[n - j]
            inertial += xs[j] * rates[n - j]
        # (1 + a x^2) x'' term by term; vs[j + 1] (j + 1) are the coefficients of x'' known already
        left = force - decay * vs[n] - stiffness * (xs[n] + b * cubed) - a * inertial
        for j in range(1, n + 1):
            left -= a * square[j] * vs[n - j + 1] * (n - j + 1)
        xs[n + 1] = vs[n] / (n + 1)
        vs[n + 1] = left / ((1.0 + a * square[0]) * (n + 1))
        force, quadrature = -w * quadrature / (n + 1), w * force / (n + 1)


@kernel
def value(coefficients, s):
    """A polynomial at `s`."""
    return horner(coefficients, 1.0, 0.0, s)[0]


@kernel
def step_of(xs, gap, most):
    """The step that the last two coefficients of a series allow, at most `most` [s]."""
    h = most
    for n in (xs.size - 2, xs.size - 1):
        size = abs(xs[n])
        if size > 0.0:
            h = min(h, (SMALL * gap / size) ** (1.0 / n))
    return h


@kernel
def validity_limit(p):
    """The largest distance of the tip from its place at rest [m]."""
    return min(1.0 / math.sqrt(max(-3.0 * p[2], 1e-300)), 1.0 / math.sqrt(max(-p[3], 1e-300)))


@kernel
def free_flow(p, cosine, sine, x, v, start, time, gap, work):
    """x and x' after `time` [s] without a stop, from the drive's time `start` [s]; NaN beyond the model."""
    t, steps, most = 0.0, 0, validity_limit(p)
    while t < time:
        steps += 1
        if steps > MOST_STEPS or not abs(x) <= most:
            return x * math.nan, v * math.nan
        series(p, cosine, sine, x, v, p[4] * (start + t), work)
        h = step_of(work[0], gap, time - t)
        x, v = value(work[0], h), value(work[1], h)
        t = time if h >= time - t else t + h
    return x, v


@kernel
def periods(p, forces, gap, restitution, x, v, points, impacts):
    """Drive periods from a strobe, each with its amplitude of `forces`, shape (periods,) [m/s^2].

    `points`, shape (periods, 2), gets x and x'/W at the strobes, `impacts` their number in each period.
    Returns how the periods ended, and when [s]. Unless this is FLOWN, the first point is the place.
    """
    size, most = ORDER + 1, validity_limit(p)
    work, height = np.zeros((4, size)), np.zeros(size)
    xs, vs = work[0], work[1]
    period, root = 2.0 * math.pi / p[4], math.sqrt(p[0])
    restoring = p[0] * (gap + p[2] * gap**3)
    for i in range(impacts.size):
        t, steps, force = 0.0, 0, forces[i]
        while t < period:
            steps += 1
            if steps > MOST_STEPS or not abs(x) <= most:
                points[0, 0], points[0, 1] = x, v / root
                return LOST, i * period + t
            load = force * math.cos(p[4] * t) - restoring
            if x >= gap and load > GRAZED * restoring and v * v <= 20.0 * GRAZED * gap * load:
                # at rest on the stop until the force falls below the restoring force
                x, v = gap, 0.0
                end = math.acos(restoring / force) / p[4]
                t = min(period, end if end >= t else end + period)
                continue
            series(p, force, 0.0, x, v, p[4] * t, work)
            h = step_of(xs, gap, period - t)
            for n in range(size):
                height[n] = xs[n]
            height[0] -= gap
            hit = first_polynomial_root(height, 1.0, h, GRAZED * gap)
            if hit >= 0.0:
                x, v = gap, -restitution * value(vs, hit)
                t += hit
                impacts[i] += 1
                if impacts[i] > MOST_IMPACTS:
                    points[0, 0], points[0, 1] = x, v / root
                    return CHATTERED, i * period + t
            else:
                x, v = value(xs, h), value(vs, h)
                t = period if h >= period - t else t + h
        points[i, 0], points[i, 1] = x, v / root
    return FLOWN, impacts.size * period
