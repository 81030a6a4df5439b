"""Motion in contact as a power series in time.

    u_k'' = -c_k u_k' - omega_k^2 u_k + g_k - phi_k N(t),   d(t) = sum_k phi_k u_k + x_s(t) - gap

While the tip is in contact all modes are coupled through one number, the contact force N.  For a force that
is linear in d and d', and for sustained contact (d = 0 held by N), the series coefficients follow from each
other,

    u[n+2] = ( -c (n+1) u[n+1] - omega^2 u[n] - phi N[n] ) / ((n+1)(n+2))

at a cost proportional to the number of modes, without eigenvectors and so without their ill-conditioning for
repeated or critically damped ones.  The step is chosen so that the last terms lie below rounding: with order
24 that is about two radians of the fastest mode, and the propagation is exact in the sense that only rounding
error remains.
"""

from __future__ import annotations

import math

from contact.compiled import kernel
from contact.flight import EPS
from contact.laws import NEWTON
from contact.trajectory import Regime

__all__ = [
    "CONTACT",
    "INSIDE",
    "OUTSIDE",
    "SERIES_ORDER",
    "SUSTAINED",
    "WAITING",
    "contact_series",
    "series_state",
    "series_step",
]

OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = map(int, Regime)
"""The regimes as kernels compare them, plain integers."""

SERIES_ORDER = 24
"""Order of the series: between 20 and 30 the cost per unit of time is flat to a few per cent."""


@kernel
def contact_series(motion, regime, base, u, v, series, depth, force):
    """Fill the coefficients of the modes, the penetration and the contact force.

    Parameters
    ----------
    motion : Motion
    regime : int
        CONTACT (linear law), INSIDE (no force; `force` then holds k d + c d') or SUSTAINED.
    base : float
        Time since the strobe [s].
    u, v : ndarray, shape (n_modes,)
        Deviations at the start.
    series : ndarray, shape (SERIES_ORDER + 1, n_modes)
    depth, force : ndarray, shape (SERIES_ORDER + 1,)
        Results; the last two coefficients of `force` are left zero.
    """
    omega, decay, phi, load = motion.omega, motion.decay, motion.phi, motion.load
    n_modes = omega.size
    w = motion.drive
    s, c = math.sin(w * base), math.cos(w * base)
    x0 = motion.tip_sine * s + motion.tip_cosine * c
    x1 = w * (motion.tip_sine * c - motion.tip_cosine * s)
    depth[0], depth[1] = motion.level + x0, x1
    for k in range(n_modes):
        series[0, k] = u[k]
        series[1, k] = v[k]
        depth[0] += phi[k] * u[k]
        depth[1] += phi[k] * v[k]
    for n in range(SERIES_ORDER - 1):
        x2 = -w * w * x0 / ((n + 1.0) * (n + 2.0))
        if regime == SUSTAINED:
            pull = (n + 1.0) * (n + 2.0) * x2
            for k in range(n_modes):
                pull -= phi[k] * (decay[k] * (n + 1.0) * series[n + 1, k] + omega[k] ** 2 * series[n, k])
                if n == 0:
                    pull += phi[k] * load[k]
            force[n] = pull / motion.compliance
        else:
            force[n] = motion.number0 * depth[n] + motion.number1 * (n + 1.0) * depth[n + 1]
        push = 0.0 if regime == INSIDE else force[n]
        scale = 1.0 / ((n + 1.0) * (n + 2.0))
        total = x2
        now, after, fresh = series[n], series[n + 1], series[n + 2]
        for k in range(n_modes):
            a = -decay[k] * (n + 1.0) * after[k] - omega[k] ** 2 * now[k]
            if n == 0:
                a += load[k]
            fresh[k] = (a - phi[k] * push) * scale
        for k in range(n_modes):
            total += phi[k] * fresh[k]
        depth[n + 2] = total
        x0, x1 = x1, x2
    force[SERIES_ORDER - 1] = 0.0
    force[SERIES_ORDER] = 0.0


@kernel
def series_step(motion, u, v, series, depth):
    """Longest time over which the neglected terms stay below rounding [s]."""
    energy = motion.number0 * depth[0] ** 2 if motion.law != NEWTON else 0.0
    top, below = 0.0, 0.0
    for k in range(motion.omega.size):
        energy += v[k] ** 2 + (motion.omega[k] * u[k]) ** 2
        energy += motion.drive**2 * (motion.sine[k] ** 2 + motion.cosine[k] ** 2)
        top = max(top, abs(series[SERIES_ORDER, k]))
        below = max(below, abs(series[SERIES_ORDER - 1, k]))
    speed = 0.1 * EPS * math.sqrt(energy)
    h = motion.period
    if top > 0.0:
        h = min(h, (speed / (SERIES_ORDER * top)) ** (1.0 / (SERIES_ORDER - 1)))
    if below > 0.0:
        h = min(h, (speed / ((SERIES_ORDER - 1.0) * below)) ** (1.0 / (SERIES_ORDER - 2)))
    return h


@kernel
def series_state(series, h, u, v):
    """Deviations of all modes a time `h` [s] into the step."""
    for k in range(series.shape[1]):
        u[k], v[k] = series[SERIES_ORDER, k], 0.0
    for n in range(SERIES_ORDER - 1, -1, -1):
        for k in range(series.shape[1]):
            v[k] = v[k] * h + u[k]
            u[k] = u[k] * h + series[n, k]
