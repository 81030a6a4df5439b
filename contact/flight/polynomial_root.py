"""The first crossing of zero by a polynomial, such as a contact force, and the roots of a quadratic.

The three proofs of ``contact.flight.bounds`` settle one span after the other.  The bound of the third
derivative is the sum of the absolute terms at the far end.
"""

import math

from contact.flight.bounds import PEAK, ROOT, SKIP, certify
from contact.flight.elementary import EPS
from contact.machine.compiled import kernel, part


@kernel
def horner(coefficients, sign, height, s):
    """`sign` times a polynomial, coefficients in rising order, minus `height`, and two derivatives at `s`."""
    y0, y1, y2 = 0.0, 0.0, 0.0
    for n in range(coefficients.size - 1, -1, -1):
        y2 = y2 * s + 2.0 * y1
        y1 = y1 * s + y0
        y0 = y0 * s + coefficients[n]
    return sign * y0 - height, sign * y1, sign * y2


@kernel
def first_polynomial_root(coefficients, sign, end, margin):
    """First s in (0, end] at which `sign` (1 or -1) times a polynomial rises through zero, or -1.

    It must be negative at zero, or zero there and falling.  Heights within `margin` are ignored, since a
    continuous contact force that only touches zero has no consequence.  A step without a proof is at least
    twice the one before, so that the search also ends for a polynomial that is zero or NaN.
    """
    m3, power = 0.0, 1.0
    for j in range(3, coefficients.size):
        m3 += j * (j - 1.0) * (j - 2.0) * abs(coefficients[j]) * power
        power *= end
    s, h, h_min = 0.0, end, 4.0 * EPS * end
    least = h_min
    while s < end:
        y0, y1, y2 = horner(coefficients, sign, 0.0, s)
        if y0 >= -margin:
            # at the start, or at a touch of zero: the slope leads out of the band of rounding
            if s > 0.0 and y1 > 0.0:
                return s
            out = 2.0 * max(margin, y0) / max(abs(y1), 1e-300)
            s += max(least, min(end - s, out, 1e-3 * end))
            least *= 2.0
            continue
        proof, step = certify(y0, y1, y2, m3, 0.0, margin, min(h, end - s), h_min)
        if proof == SKIP:
            s += step
            h, least = 2.0 * step, h_min
        elif proof == ROOT or (proof == PEAK and horner(coefficients, sign, 0.0, s + step)[0] > 0.0):
            return polynomial_root(coefficients, sign, 0.0, s, s + step)
        elif proof == PEAK:
            low, high = s, s + step
            for _ in range(60):
                middle = 0.5 * (low + high)
                rises = horner(coefficients, sign, 0.0, middle)[1] > 0.0
                low, high = (middle, high) if rises else (low, middle)
            if horner(coefficients, sign, 0.0, low)[0] > margin:
                return polynomial_root(coefficients, sign, 0.0, s, low)
            s += step
            h, least = step, h_min
        else:
            s += max(step, least)
            h = end
            least *= 2.0
    return -1.0


@part
def first_fall(r, s):
    """The first place in (0, `s`] at which a polynomial falls to zero, or -1; at zero it is zero or more."""
    rest, power = 0.0, s
    for n in range(2, r.size):
        power *= s
        rest += abs(r[n]) * power
    start, drift = abs(r[0]), r[1] * s
    size = start + abs(drift) + rest
    margin = 2.0 * EPS * size
    # r >= r_0 + (r_1 - rest/s) x if this bound grows, and always r >= r_0 - |drift| - rest
    if drift - rest > margin or start - abs(drift) - rest > margin:
        return -1.0
    return first_polynomial_root(r, -1.0, s, EPS * size)


@kernel
def polynomial_root(coefficients, sign, height, low, high):
    """The s in [low, high] at which `sign` times a polynomial rises through `height`."""
    s = 0.5 * (low + high)
    for _ in range(100):
        y0, y1, _unused = horner(coefficients, sign, height, s)
        if y0 == 0.0:
            return s
        low, high = (s, high) if y0 < 0.0 else (low, s)
        new = s - y0 / y1 if y1 > 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        if abs(new - s) <= EPS * abs(s):
            return new
        s = new
    return s


def positive_roots(a: float, b: float, c: float) -> list[float]:
    """The positive solutions of a X^2 + b X + c = 0, ascending."""
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return []
    half = -0.5 * (b + math.copysign(math.sqrt(square), b))
    found = ([half / a] if a != 0.0 else []) + ([c / half] if half != 0.0 else [])
    return sorted(root for root in found if root > 0.0)
