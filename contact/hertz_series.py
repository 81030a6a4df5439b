"""Contact under Hertz's law as a power series without its singularity.

The force k d^(3/2) (1 + chi d') has no Taylor series at the touch d = 0, where every contact begins and ends.
With r = sqrt(d) as an unknown of its own and a new variable sigma that runs slowly while the contact is
shallow,

    dt/dsigma = r,  dr/dsigma = d'/2,  du/dsigma = r v,  dv/dsigma = r (-c v - omega^2 u - phi N),
    N = k r^3 (1 + chi d'),  d' = sum phi v + x_s'(t),  d sin(w t)/dsigma = w r cos(w t), ...

all right-hand sides are polynomials: the motion is analytic right through touch and release (r changes sign
there), and its Taylor coefficients follow from products of series.  Cost per step: modes times the square of
the order.  Tolerance: the last terms of a step lie below ``HERTZ_TOLERANCE`` of the modal speeds, so that the
energy of a lossless contact is conserved to that order.
"""

from __future__ import annotations

import math

import numpy as np

from contact.certificate import first_polynomial_root, polynomial_root
from contact.compiled import kernel
from contact.flight import EPS

__all__ = ["HERTZ_ORDER", "HERTZ_TOLERANCE", "hertz_series", "hertz_state", "hertz_step"]

HERTZ_ORDER = 20
"""Order of the series: the cost per unit of time is flat to ten per cent between 16 and 24."""

HERTZ_TOLERANCE = 1e-15
"""Size of the last terms of a step, relative to the modal speeds: at the rounding of the sum of all terms."""


@kernel
def hertz_series(motion, base, u, v, us, vs, scalars):
    """Fill the Taylor coefficients in sigma of a contact that is at (u, v) at time `base` after the strobe.

    Parameters
    ----------
    motion : Motion
        number0 = k [N/m^1.5], number1 = chi [s/m].
    base : float
        [s]
    u, v : ndarray, shape (n_modes,)
    us, vs : ndarray, shape (HERTZ_ORDER + 1, n_modes)
        Results: deviations and their velocities.
    scalars : ndarray, shape (7, HERTZ_ORDER + 1)
        Results: r, time, sin, cos, d', N, r N.  On entry scalars[0, 0] holds r, which the caller carries
        along: computed anew from the tip displacement it would lose its digits at shallow depth.
    """
    n_modes = motion.omega.size
    w = motion.drive
    stiffness, chi = motion.number0, motion.number1
    r, sine, cosine = scalars[0], scalars[2], scalars[3]
    speed, force, push = scalars[4], scalars[5], scalars[6]
    clock, square = scalars[1], np.empty(HERTZ_ORDER)
    clock[0] = 0.0
    sine[0], cosine[0] = math.sin(w * base), math.cos(w * base)
    for k in range(n_modes):
        us[0, k] = u[k]
        vs[0, k] = v[k]
    for n in range(HERTZ_ORDER):
        total = w * (motion.tip_sine * cosine[n] - motion.tip_cosine * sine[n])
        for k in range(n_modes):
            total += motion.phi[k] * vs[n, k]
        speed[n] = total
        cube = 0.0
        rs, rc = 0.0, 0.0
        square[n] = 0.0
        for i in range(n + 1):
            square[n] += r[i] * r[n - i]
        for i in range(n + 1):
            cube += r[i] * square[n - i]
            rs += r[i] * sine[n - i]
            rc += r[i] * cosine[n - i]
        push[n] = cube  # r^3 for now
        damped = cube
        if chi != 0.0:
            for i in range(n + 1):
                damped += chi * push[i] * speed[n - i]
        force[n] = stiffness * damped
        scale = 1.0 / (n + 1.0)
        r_force = 0.0
        for i in range(n + 1):
            r_force += r[i] * force[n - i]
        for k in range(n_modes):
            us[n + 1, k] = 0.0
            vs[n + 1, k] = 0.0
        for i in range(n + 1):
            ri = r[i] * scale
            for k in range(n_modes):
                us[n + 1, k] += ri * vs[n - i, k]
                vs[n + 1, k] += ri * us[n - i, k]
        for k in range(n_modes):
            acceleration = -motion.decay[k] * us[n + 1, k] - motion.omega[k] ** 2 * vs[n + 1, k]
            acceleration += scale * (motion.load[k] * r[n] - motion.phi[k] * r_force)
            vs[n + 1, k] = acceleration
        r[n + 1] = 0.5 * scale * total
        clock[n + 1] = scale * r[n]
        sine[n + 1] = w * scale * rc
        cosine[n + 1] = -w * scale * rs
    speed[HERTZ_ORDER] = 0.0
    force[HERTZ_ORDER] = 0.0


@kernel
def evaluate(coefficients, s):
    """Value of a series at `s`."""
    total = 0.0
    for n in range(coefficients.size - 1, -1, -1):
        total = total * s + coefficients[n]
    return total


@kernel
def hertz_state(us, vs, s, u, v):
    """Deviations of all modes at sigma = `s`."""
    for k in range(us.shape[1]):
        x, y = us[HERTZ_ORDER, k], vs[HERTZ_ORDER, k]
        for n in range(HERTZ_ORDER - 1, -1, -1):
            x = x * s + us[n, k]
            y = y * s + vs[n, k]
        u[k] = x
        v[k] = y


@kernel
def hertz_step(motion, u, v, us, vs, scalars, limit):
    """Length of the step in sigma and how it ends.

    Returns
    -------
    s : float
        Step in sigma.
    released : bool
        Whether the contact ends there.
    length : float
        Its duration [s], at most `limit`.
    """
    energy, top, below = 0.0, 0.0, 0.0
    for k in range(motion.omega.size):
        energy += v[k] ** 2 + (motion.omega[k] * u[k]) ** 2
        energy += motion.drive**2 * (motion.sine[k] ** 2 + motion.cosine[k] ** 2)
        top = max(top, abs(vs[HERTZ_ORDER, k]), motion.omega[k] * abs(us[HERTZ_ORDER, k]))
        below = max(below, abs(vs[HERTZ_ORDER - 1, k]), motion.omega[k] * abs(us[HERTZ_ORDER - 1, k]))
    allowed = HERTZ_TOLERANCE * math.sqrt(energy)
    s = math.inf
    if top > 0.0:
        s = (allowed / top) ** (1.0 / HERTZ_ORDER)
    if below > 0.0:
        s = min(s, (allowed / below) ** (1.0 / (HERTZ_ORDER - 1)))
    if scalars[0, 1] < 0.0 < scalars[0, 0]:
        # no further than well behind the release: with no force left the terms give no bound
        s = min(s, -4.0 * scalars[0, 0] / scalars[0, 1])
    # r and the time must be resolved as well as the modes
    size = 0.0
    for n in range(1, 4):
        size = max(size, abs(scalars[0, n]) ** (1.0 / n))
    r_last = abs(scalars[0, HERTZ_ORDER])
    if r_last > 0.0 and size > 0.0:
        for _ in range(40):
            r_size = abs(scalars[0, 0]) + abs(scalars[0, 1]) * s
            if r_last * s**HERTZ_ORDER <= HERTZ_TOLERANCE * r_size:
                break
            s *= 0.9
    r_size = 0.0
    power = 1.0
    for n in range(HERTZ_ORDER + 1):
        r_size += abs(scalars[0, n]) * power
        power *= s
    released = False
    end = first_polynomial_root(-scalars[0], 0.0, s, EPS * r_size)
    if end >= 0.0:
        s, released = end, True
    length = evaluate(scalars[1], s)
    if length > limit:
        late = scalars[1].copy()
        late[0] -= limit
        s, released, length = polynomial_root(late, 0.0, s), False, limit
    return s, released, length
