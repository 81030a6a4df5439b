"""Periodic motions by harmonic balance, with the contact force taken in time (alternating frequency/time).

    q_k = Re sum_h Q_kh exp(i h w t), h = 0 ... H,   D_kh = omega_k^2 - (h w)^2 + i h w c_k
    D_kh Q_kh = -i Gamma_k Z w^2 [h = 1] + g_k [h = 0] - phi_k F_h

F_h: Fourier coefficients of N = max(0, k d + c d'), d = x - gap > 0, of S samples by FFT (Cameron and
Griffin, J. Appl. Mech. 56 (1989) 149). Only the tip feels it: with h = -H ... H and A_h = sum phi_k^2/D_kh,

    r_h = (x_h - X_h)/A_h + F_h = 0,   dF_h/dx_m = K_(h-m) + i m w c C_(h-m)

where X is the steady response, C that of "in contact", 0 or 1, and K of k C + c delta(t - touch). A touch
at speed v makes x''' jump by k v sum phi_k^2: x_h falls as h^-4 once h w is above the frequency in contact,
what is left of the series as H^-3, of sampling as S^-2; with a dashpot each a power slower. SI units.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import toeplitz

from beam import InvalidValue
from contact import ImpactOscillator, LinearContact, NotPeriodic, State, simulate

MOST_ITERATIONS, HALVINGS, CONVERGED = 50, 10, 1e-9
"""Of Newton's method and of each step; largest A_h r_h/gap: r is linear in pieces, x errs by 1e-16 A k."""


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
        raise InvalidValue(
            f"law is {law}, order {order}, samples {samples}; harmonic balance needs modes "
            "above 0 Hz, LinearContact and 0 < 4 order < samples"
        )
    h, gap, (k, c) = np.arange(-order, order + 1), o.stop.gap, law.numbers
    rate = 1j * o.driven.angular_frequency * h
    flexible = 1.0 / (model.omega**2 + np.outer(rate, model.decay_rate) + rate[:, None] ** 2)
    receptance = flexible @ model.phi**2
    steady = -0.5j * o.driven.amplitude * o.steady_response() * (h == 1)[:, None]
    steady += steady[::-1].conj()
    steady[order] = 0.0 if o.load is None else o.load / model.omega**2
    free = x = steady @ model.phi
    if guess is not None:
        run = simulate(o, guess, periods=1, times=guess.time + o.period * np.arange(samples) / samples)
        x = np.fft.fft(o.tip(run.displacement), norm="forward")[h] * np.exp(-rate * guess.time)

    def evaluated(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """F, its derivative and r."""
        place, speed = np.fft.irfft([x[order:], (rate * x)[order:]], samples, norm="forward")
        force = k * (place - gap) + c * speed
        touch = (place > gap) & (force > 0.0)
        stiff = k * touch + c * samples / o.period * (touch & (np.roll(place, 1) <= gap))
        found, stiff, acts = np.fft.rfft([touch * force, stiff, touch], norm="forward")[:, : 2 * order + 1]
        found = np.append(found[order:0:-1].conj(), found[: order + 1])
        return found, toeplitz(stiff) + toeplitz(acts) * rate * c, (x - free) / receptance + found

    force, acts, residual = evaluated(x)
    for iteration in range(MOST_ITERATIONS):
        left = float(np.abs(receptance * residual).max() / gap)
        if left < CONVERGED + c * np.abs(rate * receptance).max() / samples:
            found = (2.0 - (h == 0))[order:, None] * (steady - flexible * model.phi * force[:, None])[order:]
            return Balance(oscillator=o, coefficients=found, residual=left, iterations=iteration)
        change = np.linalg.solve(np.diag(1.0 / receptance) + acts, residual)
        for part in 0.5 ** np.arange(HALVINGS):
            following = evaluated(x - part * change)
            if np.linalg.norm(following[-1]) < np.linalg.norm(residual):
                break
        x, (force, acts, residual) = x - part * change, following
    raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=f"order {order} left {left:.1e} of the gap")
