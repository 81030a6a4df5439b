"""Periodic motions by harmonic balance, with the contact force taken in time (alternating frequency/time).

    q_k = Re sum_h Q_kh exp(i h w t), h = 0 ... H,   D_kh = omega_k^2 - (h w)^2 + i h w c_k
    D_kh Q_kh = -i Gamma_k Z w^2 [h = 1] + g_k [h = 0] - phi_k F_h

F_h: Fourier coefficients of N = max(0, k d + c d'), d = x - gap > 0, of S samples in a drive period by FFT
(Cameron and Griffin, J. Appl. Mech. 56 (1989) 149). It acts at the tip alone, so that the modes go out: with
A_h = sum phi_k^2/D_kh, the steady response X and a two-sided series, h, m = -H ... H,

    r_h = (x_h - X_h)/A_h + F_h = 0,   dr_h/dx_m = [h = m]/A_h + K_(h-m) (k + i m w c)

K: coefficients of "in contact", 0 or 1. At a touch with speed v, x''' jumps by sum phi_k^2 k v: x_h falls as
h^-4 once h w is above the frequency in contact, its remainder as H^-3, what sampling adds as S^-2. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import toeplitz

from contact import ImpactOscillator, LinearContact, NotPeriodic, State, simulate

__all__ = ["Balance", "balanced"]

MOST_ITERATIONS, HALVINGS, CONVERGED = 50, 10, 1e-9
"""Bounds of Newton's steps, of which a good start takes two to eight, and of their halvings; largest A_h r_h
in units of the gap: r is linear in pieces, and in the right one rounding is left, 1e-16 A k."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """A motion by its coefficients Q, shape (order + 1, n_modes); residual in units of the gap [1]."""

    oscillator: ImpactOscillator
    coefficients: np.ndarray
    residual: float
    iterations: int

    def modes(self, times: np.ndarray, rates: int = 0) -> np.ndarray:
        """q_k, or their derivatives of order `rates`, at drive times [s], shape (n_times, n_modes)."""
        turn = 1j * self.oscillator.driven.angular_frequency * np.arange(len(self.coefficients))
        return np.asarray((np.exp(np.outer(times, turn)) * turn**rates @ self.coefficients).real)

    def tip(self, times: np.ndarray) -> np.ndarray:
        """Tip displacement relative to the base at drive times [s], shape (n_times,) [m]."""
        return self.oscillator.tip(self.modes(times))


def balanced(oscillator: ImpactOscillator, order: int, samples: int, guess: State | None = None) -> Balance:
    """The motion of period 1/f near that from `guess`, or the steady response; NotPeriodic if not found."""
    o, model, law = oscillator, oscillator.model, oscillator.stop.law
    if not isinstance(law, LinearContact) or not samples > 4 * order > 0 or not np.all(model.omega > 0):
        raise ValueError(f"law is {law}, order {order}, samples {samples}; harmonic balance needs modes "
                         "above 0 Hz, LinearContact and 0 < 4 order < samples")  # fmt: skip
    h, w, gap = np.arange(-order, order + 1), o.driven.angular_frequency, o.stop.gap
    rate = 1j * w * h[:, None]
    flexible = 1.0 / (model.omega**2 + rate * model.decay_rate + rate**2)
    receptance, push = flexible @ model.phi**2, law.stiffness + 1j * h * w * law.damping
    steady = -0.5j * o.driven.amplitude * o.steady_response() * (h == 1)[:, None]
    steady += steady[::-1].conj()
    steady[order] = 0.0 if o.load is None else o.load / model.omega**2
    free = x = steady @ model.phi
    if guess is not None:
        times = guess.time + np.arange(samples) * o.period / samples
        tip = o.tip(simulate(o, guess, duration=o.period, times=times).displacement)
        x = np.fft.fft(tip, norm="forward")[h] * np.exp(-1j * h * w * guess.time)

    def evaluated(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """F, K from h = 0 on, and r."""
        place, force = np.fft.irfft([x[order:], (push * x)[order:]], samples, norm="forward")
        touch, force = (place > gap) & (force > law.stiffness * gap), force - law.stiffness * gap
        found, acts = np.fft.rfft([touch * force, touch], norm="forward")[:, : 2 * order + 1]
        found = np.append(found[order:0:-1].conj(), found[: order + 1])
        return found, acts, (x - free) / receptance + found

    force, acts, residual = evaluated(x)
    for iteration in range(MOST_ITERATIONS):
        left = float(np.abs(receptance * residual).max() / gap)
        if left < CONVERGED:
            found = (2.0 - (h == 0))[order:, None] * (steady - flexible * model.phi * force[:, None])[order:]
            return Balance(oscillator=o, coefficients=found, residual=left, iterations=iteration)
        change = np.linalg.solve(np.diag(1.0 / receptance) + toeplitz(acts) * push, residual)
        for part in 0.5 ** np.arange(HALVINGS):
            following = evaluated(x - part * change)
            if np.linalg.norm(following[-1]) < np.linalg.norm(residual):
                break
        x, (force, acts, residual) = x - part * change, following
    raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=f"order {order} left {left:.1e} of the gap")
