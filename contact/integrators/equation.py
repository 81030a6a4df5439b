"""The equation of motion as methods with a time step see it: physical modal coordinates, forces evaluated.

    q_k'' = -c_k q_k' - omega_k^2 q_k + g_k + P_k sin(w t) - phi_k N(d, d'),   P_k = Gamma_k Z w^2
    d = sum_k phi_k q_k - gap

with N as in ``contact.laws``.  The limit of stability of many methods is met when a contact that lasts has a
tangent stiffness dN/dd beyond a critical one; the frequencies of K + k phi phi^T are the roots of

    1 + k sum_k phi_k^2 / (omega_k^2 - lambda) = 0,

so the stiffness at which the highest of them reaches lambda is k = 1 / sum_k phi_k^2/(lambda - omega_k^2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.laws import HERTZ, LINEAR
from contact.oscillator import ImpactOscillator

__all__ = ["Equation", "contact_force", "contact_tangent", "equation_of", "force_in_flight", "stiffness_at",
    "tip_of",
]


class Equation(NamedTuple):
    """The numbers of one impact oscillator; arrays of shape (n_modes,), times s from the run's start."""

    stiffness: np.ndarray
    decay: np.ndarray
    phi: np.ndarray
    constant: np.ndarray
    push: np.ndarray
    drive: float
    clock: float
    gap: float
    compliance: float
    law: int
    number0: float
    number1: float


def equation_of(oscillator: ImpactOscillator, clock: float) -> Equation:
    """The equation of `oscillator` for a run that starts a time `clock` [s] after a strobe."""
    model, law, drive = oscillator.model, oscillator.stop.law, oscillator.drive
    n, numbers = oscillator.n_modes, law.numbers
    return Equation(
        stiffness=np.array(model.omega, dtype=float) ** 2,
        decay=np.array(model.decay_rate, dtype=float),
        phi=np.array(model.phi, dtype=float),
        constant=np.zeros(n) if oscillator.load is None else np.array(oscillator.load, dtype=float),
        push=(
            np.zeros(n)
            if drive is None
            else np.array(model.participation * drive.amplitude * drive.angular_frequency**2, dtype=float)
        ),
        drive=0.0 if drive is None else float(drive.angular_frequency),
        clock=float(clock),
        gap=float(oscillator.stop.gap),
        compliance=float(model.phi @ model.phi),
        law=law.code,
        number0=float(numbers[0]),
        number1=float(numbers[1]),
    )


def stiffness_at(omega: np.ndarray, phi: np.ndarray, frequency: float) -> float:
    """Contact stiffness that brings the highest frequency of K + k phi phi^T to `frequency` [rad/s] [N/m].

    Below zero if a mode lies higher already.
    """
    if not frequency > np.max(omega):
        return -1.0
    return float(1.0 / np.sum(phi**2 / ((frequency - omega) * (frequency + omega))))


@kernel
def tip_of(equation, q, v):
    """Penetration d [m] and its rate [m/s]."""
    depth, rate = -equation.gap, 0.0
    for k in range(q.size):
        depth += equation.phi[k] * q[k]
        rate += equation.phi[k] * v[k]
    return depth, rate


@kernel
def force_in_flight(equation, k, swing, q, v):
    """Acceleration of mode `k` without contact; `swing` is sin(w t)."""
    return (
        equation.constant[k]
        + equation.push[k] * swing
        - equation.decay[k] * v[k]
        - equation.stiffness[k] * q[k]
    )


@kernel
def contact_force(equation, depth, rate):
    """Force N of the stop on the tip, not negative for an elastic law [N]; zero for impact laws."""
    if depth <= 0.0:
        return 0.0
    if equation.law == LINEAR:
        return max(0.0, equation.number0 * depth + equation.number1 * rate)
    if equation.law == HERTZ:
        return equation.number0 * depth * math.sqrt(depth) * (1.0 + equation.number1 * rate)
    return 0.0


@kernel
def contact_tangent(equation, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m] where the contact pushes."""
    if depth <= 0.0:
        return 0.0, 0.0
    if equation.law == LINEAR:
        if equation.number0 * depth + equation.number1 * rate <= 0.0:
            return 0.0, 0.0
        return equation.number0, equation.number1
    if equation.law == HERTZ:
        root = math.sqrt(depth)
        return (
            1.5 * equation.number0 * root * (1.0 + equation.number1 * rate),
            equation.number0 * depth * root * equation.number1,
        )
    return 0.0, 0.0
