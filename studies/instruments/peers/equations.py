"""The modal equations as a general solver sees them: y = (q, q'), one smooth right-hand side per regime.

    q_k' = v_k,   v_k' = g_k + P_k sin(w t) - c_k v_k - omega_k^2 q_k - phi_k N

    regime       force N                                     watched, each rising through zero
    off the wall 0                                           d - rounding bound of d
    in contact   k d + c d'  or  k d^(3/2) (1 + chi d')      -N for the linear law, -d for Hertz's
    inside       0  (linear law with a dashpot)              -d;  k d + c d'
    held         sum phi_k f_k / sum phi_k^2                 -N
                 (Newton's law; f_k is the rest of v_k')

The bound, some 1e-14 of the motion, keeps the noise of a tip that has just left the stop without speed from
being taken for a touch.  In contact N is not cut off at zero, so that the right-hand side is smooth past the
release, within the step that finds it; under Hertz's law it is continued by zero, which is as smooth as the
law itself.  With a dissipative force law a last component W' = N d' gathers the work done on the stop.

Parameters travel as two plain arrays, `modes` (5, n_modes): omega^2, c, phi, g, P, and `scalars`: w, clock,
gap, sum phi^2, the law and its two numbers, the rounding bound.  With these a call of the compiled right-hand
side from Python costs 0.4 us for 1 to 20 modes, against 2 us for the same in numpy (matrix times vector) and
1.6 us if the numbers come one by one; so it is compiled.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from contact.compiled import kernel
from contact.integrators.equation import (
    Equation,
    contact_force,
    contact_tangent,
    force_in_flight,
    tip_of,
)
from contact.laws import HERTZ, LINEAR
from contact.trajectory import CONTACT, INSIDE, OUTSIDE, SUSTAINED

__all__ = ["jacobian", "packed", "rates", "surfaces"]

AWAY = 1e-300
"""Added where a piece begins: what is watched is below zero there, whatever rounding says."""


def packed(e: Equation, rounding: float) -> tuple[np.ndarray, np.ndarray]:
    """The equation as plain arrays; `rounding` is a bound of the rounding error of d [m]."""
    modes = np.ascontiguousarray([e.stiffness, e.decay, e.phi, e.constant, e.push])
    scalars = np.array([e.drive, e.clock, e.gap, e.compliance, float(e.law), e.number0, e.number1, rounding])
    return modes, scalars


@kernel
def unpacked(modes: Any, scalars: Any) -> Any:
    """The equation from its plain arrays."""
    return Equation(
        modes[0], modes[1], modes[2], modes[3], modes[4],
        scalars[0], scalars[1], scalars[2], scalars[3], int(scalars[4]), scalars[5], scalars[6],
    )  # fmt: skip


@kernel
def force_of(equation: Any, regime: int, swing: float, q: Any, v: Any) -> Any:
    """Force of the stop on the tip in `regime` [N], the penetration [m] and its rate [m/s]."""
    depth, rate = tip_of(equation, q, v)
    force = 0.0
    if regime == CONTACT and equation.law == LINEAR:
        force = equation.number0 * depth + equation.number1 * rate
    elif regime == CONTACT:
        force = contact_force(equation, depth, rate)
    elif regime == SUSTAINED:
        for k in range(q.size):
            force += equation.phi[k] * force_in_flight(equation, k, swing, q, v)
        force /= equation.compliance
    return force, depth, rate


@kernel
def rates(t: float, y: Any, out: Any, modes: Any, scalars: Any, regime: int) -> None:
    """Fill `out` with dy/dt; `t` counts from the start of the run [s]."""
    equation = unpacked(modes, scalars)
    n = modes.shape[1]
    q, v = y[:n], y[n : 2 * n]
    swing = math.sin(equation.drive * (equation.clock + t))
    force, _depth, rate = force_of(equation, regime, swing, q, v)
    for k in range(n):
        out[k] = v[k]
        out[n + k] = force_in_flight(equation, k, swing, q, v) - equation.phi[k] * force
    if y.size > 2 * n:
        out[2 * n] = force * rate if regime == CONTACT else 0.0


@kernel
def jacobian(t: float, y: Any, out: Any, modes: Any, scalars: Any, regime: int) -> None:
    """Fill `out`, shape (y.size, y.size), with the derivatives of the rates."""
    equation = unpacked(modes, scalars)
    n = modes.shape[1]
    q, v = y[:n], y[n : 2 * n]
    swing = math.sin(equation.drive * (equation.clock + t))
    force, depth, rate = force_of(equation, regime, swing, q, v)
    stiff, damp = 0.0, 0.0
    if regime == CONTACT and equation.law == LINEAR:
        stiff, damp = equation.number0, equation.number1
    elif regime == CONTACT:
        stiff, damp = contact_tangent(equation, depth, rate)
    held = 1.0 / equation.compliance if regime == SUSTAINED else 0.0
    for i in range(y.size):
        for j in range(y.size):
            out[i, j] = 0.0
    for i in range(n):
        out[i, n + i] = 1.0
        for j in range(n):
            p = equation.phi[i] * equation.phi[j]
            out[n + i, j] = -p * (stiff - held * equation.stiffness[j])
            out[n + i, n + j] = -p * (damp - held * equation.decay[j])
        out[n + i, i] -= equation.stiffness[i]
        out[n + i, n + i] -= equation.decay[i]
    if y.size > 2 * n and regime == CONTACT:
        for j in range(n):
            out[2 * n, j] = equation.phi[j] * stiff * rate
            out[2 * n, n + j] = equation.phi[j] * (damp * rate + force)


@kernel
def surfaces(t: float, y: Any, out: Any, modes: Any, scalars: Any, regime: int, begin: float) -> None:
    """Fill `out`, shape (2,), with what is watched in `regime`; the piece began at `begin`, on a surface."""
    equation = unpacked(modes, scalars)
    n = modes.shape[1]
    q, v = y[:n], y[n : 2 * n]
    swing = math.sin(equation.drive * (equation.clock + t))
    force, depth, rate = force_of(equation, regime, swing, q, v)
    out[1] = -1.0
    if regime == OUTSIDE:
        out[0] = depth - scalars[7]
    elif regime == INSIDE:
        out[0] = -depth
        out[1] = equation.number0 * depth + equation.number1 * rate
    elif regime == CONTACT and equation.law == HERTZ:
        out[0] = -depth
    else:
        out[0] = -force
    if t <= begin:
        for i in range(2):
            out[i] = -abs(out[i]) - AWAY
