"""The equation of motion as methods with a time step see it: physical modal coordinates, forces evaluated.

    q_k'' = -c_k q_k' - omega_k^2 q_k + g_k + P_k sin(w t) - phi_k N(d, d'),   P_k = Gamma_k Z w^2
    d = sum_k phi_k q_k - gap

with N as in ``contact.touch``.  The limit of stability of many methods is met when a contact that lasts has a
tangent stiffness dN/dd beyond a critical one; the frequencies of K + k phi phi^T are the roots of

    1 + k sum_k phi_k^2 / (omega_k^2 - lambda) = 0,

so the stiffness at which the highest of them reaches lambda is k = 1 / sum_k phi_k^2/(lambda - omega_k^2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contact import touch
from contact.compiled import inlined
from contact.oscillator import ImpactOscillator

__all__ = ["Equation", "contact_force", "contact_tangent", "equation_of", "force_in_flight", "stiffness_at",
           "tip_of"]  # fmt: skip


class Equation(NamedTuple):
    """The numbers of one impact oscillator; arrays of shape (n_modes,).

    stiffness = omega^2, decay = c, constant = g, push = P, drive = w; clock: time since a strobe at which the
    run starts [s]; compliance = sum of phi^2; law, number0, number1: code of the contact law and its numbers.
    """

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
    model, law, drive, n = oscillator.model, oscillator.stop.law, oscillator.drive, oscillator.n_modes
    amplitude, w = (0.0, 0.0) if drive is None else (drive.amplitude, drive.angular_frequency)
    return Equation(
        stiffness=np.array(model.omega, dtype=float) ** 2,
        decay=np.array(model.decay_rate, dtype=float),
        phi=np.array(model.phi, dtype=float),
        constant=np.zeros(n) if oscillator.load is None else np.array(oscillator.load, dtype=float),
        push=np.array(model.participation * amplitude * w**2, dtype=float),
        drive=float(w),
        clock=float(clock),
        gap=float(oscillator.stop.gap),
        compliance=float(model.phi @ model.phi),
        law=law.code,
        number0=float(law.numbers[0]),
        number1=float(law.numbers[1]),
    )


def stiffness_at(omega: np.ndarray, phi: np.ndarray, frequency: float) -> float:
    """Contact stiffness that brings the highest frequency of K + k phi phi^T to `frequency` [rad/s] [N/m].

    Below zero if a mode lies higher already.
    """
    if not frequency > np.max(omega):
        return -1.0
    return float(1.0 / np.sum(phi**2 / ((frequency - omega) * (frequency + omega))))


@inlined
def tip_of(equation, q, v):
    """Penetration d [m] and its rate [m/s]."""
    depth, rate = -equation.gap, 0.0
    for k in range(q.size):
        depth += equation.phi[k] * q[k]
        rate += equation.phi[k] * v[k]
    return depth, rate


@inlined
def force_in_flight(equation, k, swing, q, v):
    """Acceleration of mode `k` without contact; `swing` is sin(w t)."""
    push = equation.constant[k] + equation.push[k] * swing
    return push - equation.decay[k] * v[k] - equation.stiffness[k] * q[k]


@inlined
def contact_force(numbers, depth, rate):
    """Force N of the stop on the tip [N]; zero for impact laws."""
    return touch.force(numbers, depth, rate) if depth > 0.0 else 0.0


@inlined
def contact_tangent(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m] where the contact pushes."""
    if depth <= 0.0:
        return 0.0, 0.0
    return touch.stiffness(numbers, depth, rate)
