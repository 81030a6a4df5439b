"""Stretches proved free of a crossing, and the crossings of polynomials.

A signal y(s) is known with its first two derivatives, and a bound M of its third.  A stretch h is settled by
one of three proofs:

    max over [0, h] of (y + y' s + y'' s^2/2) + M h^3/6 + R < -margin        no crossing,
    y' > 0 throughout, and y changes sign                                    one root,
    y'' < 0 throughout, and y' changes sign                                  one peak.

R bounds what is not sampled.  For a polynomial M is the sum of the absolute terms of its third derivative at
the far end.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

from contact.compiled import kernel
from contact.flight import EPS

__all__ = ["NEAR", "PEAK", "ROOT", "SKIP", "STALL", "certify", "first_polynomial_root", "polynomial_root"]

SKIP, ROOT, PEAK, NEAR, STALL = 0, 1, 2, 3, 4


@kernel
def certify(y0, y1, y2, m3, rest, margin, h, h_min):
    """The longest stretch of h, h/2, h/4, ... that one of the three proofs settles: (proof, stretch).

    As long as some modes are only bounded (`rest` > 0), a stretch on which the others alone have a root or a
    peak that matters is reported as near: there all modes must be sampled.
    """
    while h > h_min:
        top = max(y0, y0 + h * (y1 + 0.5 * h * y2))
        if y2 < 0.0 and y1 > 0.0 and -y1 > y2 * h:
            top = max(top, y0 - 0.5 * y1 * y1 / y2)
        cubic = m3 * h * h * h / 6.0
        if top + cubic + rest < -margin:
            return SKIP, h
        if y1 > 0.0:
            slope_loss = 0.5 * m3 * h * h
            if y1 + min(0.0, y2 * h) - slope_loss > 0.0:
                if y0 + h * (y1 + 0.5 * h * y2) - cubic > margin:
                    return (ROOT if rest == 0.0 else NEAR), h
            elif y2 + m3 * h < 0.0 and y1 + y2 * h + slope_loss < 0.0:
                return (PEAK if rest == 0.0 else NEAR), h
        h *= 0.5
    return STALL, h


@kernel
def horner(coefficients, s):
    """Value of a polynomial and its first two derivatives at `s`; coefficients in rising order."""
    y0, y1, y2 = 0.0, 0.0, 0.0
    for n in range(coefficients.size - 1, -1, -1):
        y2 = y2 * s + 2.0 * y1
        y1 = y1 * s + y0
        y0 = y0 * s + coefficients[n]
    return y0, y1, y2


@kernel
def first_polynomial_root(coefficients, start, end, margin):
    """First s in (start, end] at which a polynomial rises through zero, or -1 if there is none.

    The polynomial is negative at `start`, or zero there and falling.  Heights within `margin` count as none:
    meant for forces of continuous laws, where a touch of zero has no consequence.  A step that no proof
    gives is at least twice the one before, so that a polynomial that is zero, or no number, ends as well.
    """
    m3 = 0.0
    power = 1.0
    for j in range(3, coefficients.size):
        m3 += j * (j - 1.0) * (j - 2.0) * abs(coefficients[j]) * power
        power *= end
    s = start
    h = end - start
    h_min = 4.0 * EPS * end
    least = h_min
    while s < end:
        y0, y1, y2 = horner(coefficients, s)
        if y0 >= -margin:
            # at the start, or a touch: leave the band of rounding by the slope
            if s > start and y1 > 0.0:
                return s
            out = 2.0 * max(margin, y0) / max(abs(y1), 1e-300)
            s += max(least, min(end - s, out, 1e-3 * (end - start)))
            least *= 2.0
            continue
        proof, step = certify(y0, y1, y2, m3, 0.0, margin, min(h, end - s), h_min)
        if proof == SKIP:
            s += step
            h = 2.0 * step
            least = h_min
        elif proof == ROOT or (proof == PEAK and horner(coefficients, s + step)[0] > 0.0):
            return polynomial_root(coefficients, s, s + step)
        elif proof == PEAK:
            low, high = s, s + step
            for _ in range(60):
                middle = 0.5 * (low + high)
                if horner(coefficients, middle)[1] > 0.0:
                    low = middle
                else:
                    high = middle
            if horner(coefficients, low)[0] > margin:
                return polynomial_root(coefficients, s, low)
            s += step
            h, least = step, h_min
        else:
            s += max(step, least)
            h = end - start
            least *= 2.0
    return -1.0


@kernel
def polynomial_root(coefficients, low, high):
    """The root of a polynomial in [low, high], negative at `low` and positive at `high`."""
    s = 0.5 * (low + high)
    for _ in range(100):
        y0, y1, _unused = horner(coefficients, s)
        if y0 == 0.0:
            return s
        if y0 < 0.0:
            low = s
        else:
            high = s
        new = s - y0 / y1 if y1 > 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        if abs(new - s) <= EPS * abs(s):
            return new
        s = new
    return s
