"""The first crossing of the stop, certified.

A signal y(s) (tip displacement minus gap, or a contact force) is known in closed form with its first two
derivatives, and a bound M of its third.  Starting where y < 0, time is skipped only by a bound that proves
the stretch free:

    y(s + h) <= max over [0, h] of (y + y' h + y'' h^2/2) + M h^3/6 + R < -margin

R is the sum of amplitudes of those high modes that are bounded instead of sampled; they are taken in one by
one as the gap closes.  Where no such h exists, two other proofs end the search: y' > 0 throughout and y
changes sign (one root), or y'' < 0 throughout and y' changes sign (one peak: its height decides).  The bounds
of the single modes are those of ``contact.flight``.

A graze, |peak| within the rounding bound of y (at most 1e-13 of the gap), is an outcome of its own.  A
stretch that none of this settles, with h down to rounding, is reported as unresolved and never passed.
"""

from __future__ import annotations

import math

from contact.compiled import kernel
from contact.flight import (
    EPS,
    mode_acceleration,
    mode_flow,
    tip_rounding,
    tip_steady,
)

__all__ = ["CROSSES", "FREE", "GRAZES", "UNRESOLVED", "first_crossing", "first_polynomial_root"]

FREE, CROSSES, GRAZES, UNRESOLVED = 0, 1, 2, 3
_SKIP, _ROOT, _PEAK, _NEAR, _STALL = 0, 1, 2, 3, 4

GRAZE_TOLERANCE = 1e-13
"""Largest rounding bound, relative to the gap, within which a peak may be called a graze."""


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
            return _SKIP, h
        if y1 > 0.0:
            slope_loss = 0.5 * m3 * h * h
            if y1 + min(0.0, y2 * h) - slope_loss > 0.0:
                if y0 + h * (y1 + 0.5 * h * y2) - cubic > margin:
                    return (_ROOT if rest == 0.0 else _NEAR), h
            elif y2 + m3 * h < 0.0 and y1 + y2 * h + slope_loss < 0.0:
                return (_PEAK if rest == 0.0 else _NEAR), h
        h *= 0.5
    return _STALL, h


@kernel
def depart(motion, base, u, v, order, h, h_min):
    """The longest of h, h/2, ... on which a flight that starts on the wall is proved free; 0 if none is.

    `order` derivatives of the tip displacement vanish at the start, from the zeroth on: 1, 2 or 3.
    """
    w = motion.drive
    _level, y1, y2 = tip_steady(motion, base)
    y3 = -w * w * y1
    m4 = math.sqrt(motion.tip_sine**2 + motion.tip_cosine**2) * w**4
    for k in range(motion.omega.size):
        c, o2 = motion.decay[k], motion.omega[k] ** 2
        d2 = mode_acceleration(motion, k, u[k], v[k])
        d3 = -c * d2 - o2 * v[k]
        d4 = -c * d3 - o2 * d2
        y1 += motion.phi[k] * v[k]
        y2 += motion.phi[k] * d2
        y3 += motion.phi[k] * d3
        m4 += abs(motion.phi[k]) * math.sqrt(d4 * d4 + o2 * d3 * d3)
    while h > h_min:
        # (y - vanishing terms) / (leading power of h), bounded from above on (0, h]
        bound = m4 * h * h * h / 24.0
        if order == 1:
            bound += y1 + max(0.0, 0.5 * y2 * h) + max(0.0, y3 * h * h / 6.0)
        elif order == 2:
            bound += 0.5 * y2 * h + max(0.0, y3 * h * h / 6.0)
        else:
            bound += y3 * h * h / 6.0
        if bound < 0.0:
            return h
        h *= 0.5
    return 0.0


@kernel
def tip_at(motion, base, u, v, s):
    """Tip displacement relative to the stop and two derivatives, a time `s` into the flight from (u, v)."""
    y0, y1, y2 = tip_steady(motion, base + s)
    omega, decay, damped, low, load, phi = (
        motion.omega, motion.decay, motion.damped, motion.damped_low, motion.load, motion.phi
    )
    for k in range(omega.size):
        uk, vk = mode_flow(omega[k], decay[k], damped[k], low[k], load[k], u[k], v[k], s)
        y0 += phi[k] * uk
        y1 += phi[k] * vk
        y2 += phi[k] * (load[k] - decay[k] * vk - omega[k] * omega[k] * uk)
    return y0, y1, y2


@kernel
def find_root(motion, base, u, v, low, high, margin):
    """The root of the tip displacement in [low, high], where it rises from below to above zero [s]."""
    s = 0.5 * (low + high)
    for _ in range(200):
        y0, y1, _unused = tip_at(motion, base, u, v, s)
        if abs(y0) <= 0.05 * margin:
            return s
        if y0 < 0.0:
            low = s
        else:
            high = s
        step = -y0 / y1 if y1 > 0.0 else 0.0
        new = s + step
        if not (low < new < high):
            new = 0.5 * (low + high)
        if abs(new - s) <= 2.0 * EPS * abs(s) or high - low <= 2.0 * EPS * high:
            return new
        s = new
    return s


@kernel
def find_peak(motion, base, u, v, low, high, margin):
    """The peak of the tip displacement in [low, high], where it is concave [s]."""
    s = 0.5 * (low + high)
    for _ in range(200):
        _unused, y1, y2 = tip_at(motion, base, u, v, s)
        if y1 == 0.0:
            return s
        if y1 > 0.0:
            low = s
        else:
            high = s
        new = s - y1 / y2 if y2 < 0.0 else 0.5 * (low + high)
        if not (low < new < high):
            new = 0.5 * (low + high)
        # the height is settled long before the place: its error is y'' (new - s)^2 / 2
        if abs(y2) * (new - s) ** 2 <= 1e-3 * margin or high - low <= 4.0 * EPS * (base + high):
            return new
        s = new
    return s


@kernel
def first_crossing(motion, base, u, v, duration, order, envelope):
    """First time in (0, duration] at which a free flight crosses the stop.

    Parameters
    ----------
    motion : Motion
        The oscillator.
    base : float
        Time since the strobe at which the flight starts [s].
    u, v : ndarray, shape (n_modes,)
        Deviation from the steady motion at the start, and its velocity.
    duration : float
        Length of the flight [s].
    order : int
        How many derivatives of the tip displacement, from the zeroth on, vanish at the start by construction:
        0 for a tip off the wall, 1 after an impact, 2 after a plastic one or a graze, 3 at a release.
    envelope : ndarray, shape (n_modes + 1,)
        Work space.

    Returns
    -------
    outcome : int
        FREE, CROSSES, GRAZES or UNRESOLVED.
    s : float
        Time since the start of the flight [s].
    """
    omega, decay, damped, low, load, phi = (
        motion.omega, motion.decay, motion.damped, motion.damped_low, motion.load, motion.phi
    )
    n = omega.size
    w = motion.drive
    tip_amplitude = math.sqrt(motion.tip_sine**2 + motion.tip_cosine**2)
    margin = tip_rounding(motion, u, v)
    must = 0  # modes that are always sampled: zero frequency means no bound of the displacement
    fastest = w
    for k in range(n):
        fastest = max(fastest, omega[k], decay[k])
        if omega[k] <= 0.0:
            must = k + 1
    envelope[n] = 0.0
    for k in range(n - 1, -1, -1):
        if k >= must:
            envelope[k] = envelope[k + 1] + abs(phi[k]) * math.sqrt(u[k] ** 2 + (v[k] / omega[k]) ** 2)
        else:
            envelope[k] = math.inf
    if order == 0 and motion.level + tip_amplitude + envelope[0] < -margin:
        return FREE, duration

    h_min = 64.0 * EPS * (base + duration)
    if fastest > 0.0:
        h_min += 1e-15 / fastest
    h = 0.05 * motion.period
    s = 0.0
    if order > 0:
        s = depart(motion, base, u, v, order, h, h_min)
        if s == 0.0:
            return UNRESOLVED, 0.0
    sampled = n if order > 0 else max(must, 1)
    distance = 0.0
    while s < duration:
        if distance > 0.0:
            while sampled > max(must, 1) and envelope[sampled - 1] < 0.125 * distance:
                sampled -= 1
        y0, y1, y2 = tip_steady(motion, base + s)
        m3 = tip_amplitude * w**3
        k = 0
        while k < sampled:
            uk, vk = mode_flow(omega[k], decay[k], damped[k], low[k], load[k], u[k], v[k], s)
            o2 = omega[k] * omega[k]
            d2 = load[k] - decay[k] * vk - o2 * uk
            d3 = -decay[k] * d2 - o2 * vk
            y0 += phi[k] * uk
            y1 += phi[k] * vk
            y2 += phi[k] * d2
            m3 += abs(phi[k]) * math.sqrt(d3 * d3 + o2 * d2 * d2)
            k += 1
            if k == sampled and sampled < n and envelope[sampled] > 0.25 * max(-y0, 0.0):
                sampled += 1
        if sampled == n and s == 0.0 and abs(y0) <= margin:
            # on the wall within rounding although not by construction: the velocity decides
            if y1 > 0.0:
                return CROSSES, 0.0
            s = depart(motion, base, u, v, 1 if y1 < 0.0 else 2, h, h_min)
            if s == 0.0:
                return UNRESOLVED, 0.0
            continue
        rest = envelope[sampled]
        proof, step = certify(y0, y1, y2, m3, rest, margin, h, h_min)
        if proof == _SKIP:
            s += step
            distance = -y0
            h = 2.0 * step
        elif proof == _ROOT:
            root = find_root(motion, base, u, v, s, s + step, margin)
            if root > duration:
                return FREE, duration
            return CROSSES, root
        elif proof == _PEAK:
            peak = find_peak(motion, base, u, v, s, s + step, margin)
            if peak > duration:
                # the motion rises all the way to the end: its height there decides
                if tip_at(motion, base, u, v, duration)[0] > margin:
                    return CROSSES, find_root(motion, base, u, v, s, duration, margin)
                return FREE, duration
            height = tip_at(motion, base, u, v, peak)[0]
            if height > margin:
                return CROSSES, find_root(motion, base, u, v, s, peak, margin)
            if height >= -margin:
                if margin > GRAZE_TOLERANCE * motion.gap:
                    return UNRESOLVED, peak
                return GRAZES, peak
            s += step
            distance = -height
            h = 2.0 * step
        elif sampled < n:
            sampled = n
            distance = 0.0
        else:
            return UNRESOLVED, s
    return FREE, duration


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
    meant for forces of continuous laws, where a touch of zero has no consequence.
    """
    m3 = 0.0
    power = 1.0
    for j in range(3, coefficients.size):
        m3 += j * (j - 1.0) * (j - 2.0) * abs(coefficients[j]) * power
        power *= end
    s = start
    h = end - start
    h_min = 4.0 * EPS * end
    while s < end:
        y0, y1, y2 = horner(coefficients, s)
        if y0 >= -margin:
            # at the start, or a touch: leave the band of rounding by the slope
            if s > start and y1 > 0.0:
                return s
            out = 2.0 * max(margin, y0) / max(abs(y1), 1e-300)
            s += max(h_min, min(end - s, out, 1e-3 * (end - start)))
            continue
        proof, step = certify(y0, y1, y2, m3, 0.0, margin, min(h, end - s), h_min)
        if proof == _SKIP:
            s += step
            h = 2.0 * step
        elif proof == _ROOT or (proof == _PEAK and horner(coefficients, s + step)[0] > 0.0):
            return polynomial_root(coefficients, s, s + step)
        elif proof == _PEAK:
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
            h = step
        else:
            s += max(step, h_min)
            h = end - start
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
