"""Largest contact stiffness that a splitting method bears, while the contact is closed.

With N = k d + c d' and no drive a step is a linear map of (u, v), a product of flows and of kicks over t

    v -> v - phi s (k d + c r),   s = (1 - exp(-c Phi t)) / (c Phi),   d = phi . u,  r = phi . v,

and the method is stable as long as no eigenvalue of that map lies outside the unit circle.

Order 2.  An eigenvector to the eigenvalue -1 satisfies for each mode, whose flow over the step h is (A, B; C,
D) with determinant e = exp(-c_k h),

    u_k = phi_k J B / (1 + A + D + e),   v_k = phi_k J (D + e) / (1 + A + D + e),   J = s (k d + c r),

hence, with X = sum phi_k u_k / J, Y = sum phi_k v_k / J,

    k_crit = (1/s - c Y) / X.

Without damping X = sum phi^2 tan(omega h/2) / (2 omega), Y = Phi/2, so that

    k_crit = (c Phi/2) coth(c Phi h/2) / X,   which is  1 / (h sum phi^2 tan(omega h/2)/(2 omega))  for c = 0.

It is the first eigenvalue to leave the circle if omega h < pi for all modes.  To see this for c = 0, write
the map as a recurrence of displacements; its eigenvalues exp(i psi) are the roots z = cos(psi) of

    1 + k h sum_k phi_k^2 sin(theta_k) / (2 omega_k (z - cos(theta_k))) = 0,   theta_k = omega_k h.

All residues have one sign, so that one root lies below each cos(theta_k) and above the next: all are real,
fall as k rises, and only the lowest can pass -1.  For h -> 0 the limit becomes 4/(h^2 Phi), that of central
difference on a free body of mass 1/Phi: here too the frequencies of the spring itself set none.

Any order.  Each kick adds a matrix of rank one times k, and the first and the last are one kick, so that

    det(M(k) + I)  and  det(M(k) - I)  are polynomials in k of degree s, the number of sub-flows,

known from s + 1 values; their lowest positive root is where an eigenvalue passes -1 or 1.  For omega h < pi
and no damping nothing fails before: at k = 0 all eigenvalues in the upper half plane have the same signature
(M. G. Krein), and such eigenvalues may meet, but not leave the circle, until they meet their conjugates.  A
composition of order 4 fails there by little: at h sqrt(k Phi) = 3.163 to 3.169 for a free body, by 1.0024 a
step, and by much only from 5.03 on.  The lower value is the limit.

With damping, and beyond omega h = pi, pairs may leave the circle elsewhere: beyond pi near the resonances of
step and contact, theta_j + theta_k = 2 pi m.  There the first k below that root at which the spectral radius
exceeds one is searched for, at 100 values a decade over one decade, or, beyond pi, over six.  Resonances
narrower than that may be passed over.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import Motion
from contact.integrators.splitting_step import Composition

__all__ = ["closed_form_limit", "first_instability", "passage", "spectral_radius", "step_matrix"]

SEARCH, SEARCH_BEYOND_PI = (1, 100), (6, 100)
"""Decades of k below the lowest root, and values in each, for omega h < pi and beyond."""

JUST_BEYOND = 1e-5
"""How far beyond a root its instability is looked for, relative."""

EXCEEDS = 1e-7
"""By how much the spectral radius must exceed one: at a double eigenvalue rounding alone makes 1e-8."""


def _flow_numbers(motion: Motion, time: float) -> np.ndarray:
    """The flow of each mode as rows A, B, C, D; shape (4, n_modes)."""
    columns = zip(motion.omega, motion.decay, motion.damped, motion.damped_low, strict=True)
    return np.array([flow_matrix(*numbers, time) for numbers in columns]).T


def _action(damping: float, compliance: float, time: float) -> float:
    """s, the time that a kick of length `time` acts with its initial force [s]."""
    rate = damping * compliance
    return -math.expm1(-rate * time) / rate if rate > 0.0 else time


def closed_form_limit(motion: Motion, step: float, damping: float = 0.0) -> float | None:
    """k_crit of order 2 for a contact with dashpot `damping` [N s/m], or None where the form does not hold.

    [N/m]
    """
    under = motion.omega > 0.5 * motion.decay
    if np.any(motion.damped[under] * step >= math.pi):
        return None
    a, b, _c, d = _flow_numbers(motion, step)
    e = np.exp(-motion.decay * step)
    weight = motion.phi**2 / (1.0 + a + d + e)
    x, y = float(weight @ b), float(weight @ (d + e))
    return (1.0 / _action(damping, motion.compliance, step) - damping * y) / x


def step_matrix(
    motion: Motion, composition: Composition, step: float, stiffness: ArrayLike, damping: float = 0.0
) -> np.ndarray:
    """The map (u, v) -> (u, v) of one step with the contact closed, shape (..., 2 n_modes, 2 n_modes).

    `stiffness` may be an array, of the shape (...) [N/m].
    """
    n, phi = motion.omega.size, motion.phi
    stiff = np.asarray(stiffness, dtype=float)[..., None]
    upper = np.broadcast_to(np.eye(n, 2 * n), (*stiff.shape[:-1], n, 2 * n))
    lower = np.broadcast_to(np.eye(n, 2 * n, n), upper.shape)
    for j, part in enumerate(composition.kicks):
        s = _action(damping, motion.compliance, part * step)
        pull = s * (stiff * (phi @ upper) + damping * (phi @ lower))
        lower = lower - phi[:, None] * pull[..., None, :]
        if j < composition.flows.size:
            a, b, c, d = (row[:, None] for row in _flow_numbers(motion, composition.flows[j] * step))
            upper, lower = a * upper + b * lower, c * upper + d * lower
    return np.concatenate([upper, lower], axis=-2)


def spectral_radius(
    motion: Motion, composition: Composition, step: float, stiffness: ArrayLike, damping: float = 0.0
) -> np.ndarray:
    """Largest modulus of an eigenvalue of `step_matrix`, of the shape of `stiffness`."""
    speed = np.where(motion.omega > 0, motion.omega, 1.0 / step)
    scale = np.concatenate([speed, np.ones(motion.omega.size)])  # (omega u, v): the flow is then a rotation
    matrix = step_matrix(motion, composition, step, stiffness, damping)
    return np.abs(np.linalg.eigvals(scale[:, None] * matrix / scale)).max(axis=-1)


def _roots(
    motion: Motion, composition: Composition, step: float, damping: float, sign: float, width: float
) -> np.ndarray:
    """Positive stiffnesses at which det(M + sign I) vanishes, from values up to `width` [N/m]."""
    degree = composition.flows.size
    nodes = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    matrices = step_matrix(motion, composition, step, width * nodes, damping)
    values = np.linalg.det(matrices + sign * np.eye(2 * motion.omega.size))
    found = np.polynomial.Polynomial.fit(nodes, values, degree, domain=[0.0, 1.0]).roots()
    real = np.abs(found.imag) <= 1e-9 * np.abs(found)
    return width * np.sort(found.real[real & (found.real > 0.0)])


def passage(motion: Motion, composition: Composition, step: float, damping: float = 0.0) -> float:
    """The lowest contact stiffness at which an eigenvalue passes -1 or 1, infinite if there is none [N/m].

    A root counts if the step is unstable just beyond it: rounding may add one to det(M - I), which is small
    where the frequencies are.  It is found anew from values closer to it.
    """
    widest = 4.0 * composition.flows.size**2 / (step**2 * motion.compliance)
    lowest = math.inf
    for sign in (1.0, -1.0):
        for coarse in _roots(motion, composition, step, damping, sign, widest):
            near = _roots(motion, composition, step, damping, sign, 2.0 * coarse)
            root = float(near[np.argmin(np.abs(near - coarse))]) if near.size else float(coarse)
            beyond = spectral_radius(motion, composition, step, (1.0 + JUST_BEYOND) * root, damping)
            if beyond > 1.0 + EXCEEDS:
                lowest = min(lowest, root)
                break
    return lowest


def first_instability(
    motion: Motion, composition: Composition, step: float, damping: float = 0.0
) -> float:
    """The lowest contact stiffness at which a lasting contact is unstable [N/m]."""

    def unstable(stiffness: ArrayLike) -> np.ndarray:
        return spectral_radius(motion, composition, step, stiffness, damping) > 1.0 + EXCEEDS

    high = passage(motion, composition, step, damping)
    under = motion.omega > 0.5 * motion.decay
    beyond_pi = bool(np.any(motion.damped[under] * step >= math.pi))
    if not (beyond_pi or damping > 0.0 or np.any(motion.decay > 0.0)):
        return high
    if not math.isfinite(high):
        high = 40.0 * composition.flows.size**2 / (step**2 * motion.compliance)
    decades, each = SEARCH_BEYOND_PI if beyond_pi else SEARCH
    values = high * 10.0 ** np.linspace(-decades, 0.0, decades * each + 1)[:-1]
    low = 0.0
    for chunk in np.split(values, decades):
        found = np.flatnonzero(unstable(chunk))
        if found.size:
            place = int(np.searchsorted(values, chunk[found[0]]))
            if place == 0:
                return float(values[0])  # at the end of the search, or below
            low, high = float(values[place - 1]), float(values[place])
            break
    else:
        return high
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return low
