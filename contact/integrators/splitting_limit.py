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

Beyond omega h = pi residues of both signs occur, two roots can meet and leave the real axis: a resonance of
step and contact, near theta_j + theta_k = 2 pi m (theta_k = m pi included).  There, and for order 4, whose
sub-flows go backwards too, the first k at which the spectral radius exceeds one is searched for.  Width of
the scan: from 1e-6 to 10 times 4/(h^2 Phi), 30 values a decade; narrower gaps of stability are passed over,
and a limit below the scan is given as its lower end.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from contact.flight import Motion, flow_matrix
from contact.integrators.splitting_step import Composition

__all__ = ["closed_form_limit", "first_instability", "spectral_radius", "step_matrix"]

PER_DECADE = 30
SCAN = (-6, 1)
"""Decades of k h^2 Phi / 4 between which the search runs, and its values in each."""

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


def first_instability(
    motion: Motion, composition: Composition, step: float, damping: float = 0.0
) -> float:
    """The lowest contact stiffness at which the spectral radius of the step exceeds one [N/m]."""

    def unstable(stiffness: ArrayLike) -> np.ndarray:
        return spectral_radius(motion, composition, step, stiffness, damping) > 1.0 + EXCEEDS

    scale = 4.0 / (step**2 * motion.compliance)
    values = scale * 10.0 ** np.linspace(*SCAN, int(PER_DECADE * (SCAN[1] - SCAN[0])) + 1)
    for chunk in np.split(values[1:], range(PER_DECADE, values.size - 1, PER_DECADE)):
        found = np.flatnonzero(unstable(chunk))
        if found.size:
            place = int(np.searchsorted(values, chunk[found[0]]))
            low, high = float(values[place - 1]), float(values[place])
            break
    else:
        return float(values[-1])
    if unstable(low):
        return low  # below the scan
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if unstable(middle) else (middle, high)
    return low
