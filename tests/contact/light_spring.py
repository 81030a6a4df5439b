"""A spring with a light tip and Eq. (1), for collisions; their motion without impacts."""

import math

import numpy as np
import oscillators

from contact import Collision, ContactLaw, ImpactOscillator

PHI = 10.0 * np.array([1.0, 0.9, 0.8, 0.7, 0.6, 0.5])


def spring(
    n_modes: int,
    law: ContactLaw,
    *,
    excess: float | None = 0.05,
    damping: float = 0.02,
    frequency: float = 21.5,
) -> ImpactOscillator:
    """The first modes of a spring of 24.5 Hz with a light tip; undriven if `excess` is None."""
    if excess is None:
        return oscillators.spring(n_modes, law, damping=damping, phi=PHI)
    driven = oscillators.spring(n_modes, law, damping=damping, phi=PHI, drive=(frequency, 0.0))
    return driven.with_excess(excess)


def equation_1(frequency: float, law: ContactLaw, excess: float) -> ImpactOscillator:
    return oscillators.equation_1(frequency, law, gap=0.0107, excess=excess)


def real_differs(collision: Collision) -> bool:
    """Whether real and virtual approach speed differ by more than 1 %."""
    return not abs(collision.real_approach / collision.approach - 1.0) <= 0.01


def steady(oscillator: ImpactOscillator, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Modal displacement and velocity of the motion without wall."""
    if oscillator.drive is None:
        return np.zeros(oscillator.n_modes), np.zeros(oscillator.n_modes)
    w = oscillator.drive.angular_frequency
    turning = oscillator.drive.amplitude * oscillator.steady_response() * np.exp(1j * w * time)
    return turning.imag, (1j * w * turning).imag


def flow(oscillator: ImpactOscillator, u: float, v: float, span: float, k: int = 0) -> tuple[float, float]:
    """Free displacement and velocity of under-damped mode k after `span`, by its complex eigenvalue."""
    half = 0.5 * float(oscillator.model.decay_rate[k])
    pole = complex(-half, math.sqrt(float(oscillator.model.omega[k]) ** 2 - half**2))
    c = (v - pole.conjugate() * u) / (2j * pole.imag)  # u = 2 Re(c), v = 2 Re(pole c)
    turned = c * np.exp(pole * span)
    return 2 * turned.real, 2 * (pole * turned).real
