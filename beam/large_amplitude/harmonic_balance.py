"""Periodic motion of a leaf spring at finite rotations, free or driven, and the decay of deviations from it.

With f of `finite_rotation`, the motion is

    M x'' + mu M x' + f(x) = -b z'',     x(t) = sum_k c_k e^(i k w t),     z'' = Z e^(i w t) + conjugate.

Harmonic balance solves for the c_k, |k| <= H, by Newton's method. At t = 0 the tip has a given displacement
and is at rest. These two conditions determine two more unknowns: w and mu of a free motion (mu turns out
zero), or both parts of Z of a driven one. Forces and their derivatives are sampled at 4 (H + 1) times (T. M.
Cameron and J. H. Griffin, J. Appl. Mech. 56 (1989) 149).

Deviations are e^(lambda t) sum_k d_k e^(i k w t). Their lambda make the matrix of the equations singular if
i k w + lambda replaces i k w (G. W. Hill's method). The effective period belongs to the single linear
mode under the same drive whose deviations have the same frequency as in mode 1.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from ..parameters import Array, record, require, require_kind, require_whole, require_within
from .finite_rotation import FiniteRotation

MOST_STEPS = 30
"""Largest number of steps of Newton's method; it takes four or five."""
CLOSE = 1e-11
"""Relative change at which Newton's method ends."""


@record
class PeriodicMotion:
    """A periodic motion whose tip is at its turning point at t = 0.

    Parameters
    ----------
    model : FiniteRotation
        The spring that moves.
    omega : float
        Angular frequency w [rad/s].
    decay_rate : float
        Decay rate mu of every mode [1/s].
    coefficients : ndarray of complex, shape (2 H + 1, n_dofs)
        Fourier coefficients c_k, k = -H ... H [m].
    drive : complex
        Coefficient Z of the acceleration of the base [m/s^2]; its amplitude is ``2 abs(Z)``.
    """

    model: FiniteRotation
    omega: float
    decay_rate: float
    coefficients: NDArray[np.complex128]
    drive: complex

    @property
    def harmonics(self) -> NDArray[np.intp]:
        """Numbers of the harmonics, -H ... H."""
        most = len(self.coefficients) // 2
        return np.arange(-most, most + 1)

    def tip(self, time: Array) -> Array:
        """Return the displacement of the tip [m] at `time` [s], of the same shape."""
        waves = np.exp(1j * self.omega * np.multiply.outer(np.asarray(time), self.harmonics))
        return (waves @ (self.coefficients @ self.model.linear.tip)).real

    def _sampled(self) -> tuple[NDArray[np.complex128], Array]:
        """Return e^(i k w t) at the sampled times, (times, harmonics), and x [m] there, (n_dofs, times)."""
        times = 4 * (len(self.coefficients) // 2 + 1)
        waves = np.exp(2j * np.pi * np.multiply.outer(np.arange(times) / times, self.harmonics))
        return waves, (waves @ self.coefficients).real.T

    def residual(self) -> NDArray[np.complex128]:
        """Return the residual of the equations [N], shape (2 H + 1, n_dofs)."""
        waves, x = self._sampled()
        model, rate = self.model, 1j * self.harmonics * self.omega
        forces = waves.conj().T @ model.force(x).T / len(waves)
        forces += (rate * (rate + self.decay_rate))[:, None] * (self.coefficients @ model.linear.mass)
        for k, part in ((1, self.drive), (-1, np.conj(self.drive))):
            forces[self.harmonics == k] += part * model.linear.base_load
        return forces

    @cached_property
    def _stiffness(self) -> list[csr_array]:
        """Fourier coefficients of df/dx along the motion [N/m], order k at index k, -2 H ... 2 H."""
        waves, x = self._sampled()
        densities, times = self.model.densities(x), np.arange(len(waves)) / len(waves)
        found = [
            self.model.stiffness(densities @ np.exp(-2j * np.pi * k * times) / len(waves))
            for k in range(len(self.coefficients))
        ]
        return found + [part.conj() for part in found[:0:-1]]  # the densities are real

    def derivative(self, growth: complex = 0.0) -> csc_array:
        """Return the matrix [N/m] of small deviations that grow as e^(growth t), all harmonics end to end."""
        rate = 1j * self.harmonics * self.omega + growth
        inertia = [factor * self.model.linear.mass for factor in rate * (rate + self.decay_rate)]
        rows = [
            [self._stiffness[int(k - j)] + (inertia[i] if k == j else 0.0) for j in self.harmonics]
            for i, k in enumerate(self.harmonics)
        ]
        return csc_array(block_array(rows))

    def exponent(self) -> complex:
        """Return the exponent lambda of mode 1 [1/s], near i (omega_1 - w) - mu/2.

        ArithmeticError if the iteration, which starts from the linear mode, does not converge.
        """
        growth = 1j * (self.model.first_mode[0] - self.omega) - 0.5 * self.decay_rate
        vector = np.zeros(self.coefficients.shape, dtype=complex)
        vector[self.harmonics == 1] = self.coefficients[self.harmonics == 1]
        for _ in range(MOST_STEPS):
            rate = 2.0 * (1j * self.harmonics * self.omega + growth) + self.decay_rate
            pushed = (rate[:, None] * (vector @ self.model.linear.mass)).ravel()
            found = splu(self.derivative(growth)).solve(pushed)
            change = np.vdot(vector, vector) / np.vdot(vector, found)
            growth, vector = growth - change, (found / np.linalg.norm(found)).reshape(vector.shape)
            if abs(change) < 1e-8 * self.omega:
                return complex(growth)
        raise ArithmeticError(f"the exponent at {self.omega / (2.0 * np.pi):g} Hz was not found")

    @property
    def effective_period(self) -> float:
        """Effective period 2 pi/(w + Im lambda) [s]."""
        return float(2.0 * np.pi / (self.omega + self.exponent().imag))


def periodic_motion(
    model: FiniteRotation,
    amplitude: float,
    *,
    frequency: float | None = None,
    decay_rate: float = 0.0,
    harmonics: int = 5,
) -> PeriodicMotion:
    """Return the periodic motion whose tip has a turning point at a displacement of `amplitude`.

    Parameters
    ----------
    model : FiniteRotation
        The spring that moves.
    amplitude : float
        Displacement of the tip at its turning point [m], not zero.
    frequency : float, optional
        Frequency of the drive [Hz]; by default the motion is free, and its frequency is computed.
    decay_rate : float
        Decay rate mu of a driven motion [1/s].
    harmonics : int
        Highest harmonic H.

    Returns
    -------
    PeriodicMotion
        Frequency, Fourier coefficients and drive of the motion.

    Raises
    ------
    ArithmeticError
        If Newton's method, which starts from the linear motion, does not converge.
    ValueError
        If a value is out of range, the supports leave a rigid motion, or no mode moves the tip.
    TypeError
        If `model` is not a FiniteRotation, or a value is not a number.
    """
    require_kind("model", model, FiniteRotation, "a FiniteRotation")
    size = require_within("amplitude", amplitude, "m")
    require(size != 0.0, "amplitude", f"is {amplitude} m; it must be finite and not zero")
    most = require_whole("harmonics", harmonics, "[1]", low=1)
    omega, shape = model.first_mode
    parts = np.zeros((2 * most + 1, model.linear.tip.size), dtype=complex)
    parts[most - 1] = parts[most + 1] = 0.5 * amplitude * shape
    motion = PeriodicMotion(model=model, omega=omega, decay_rate=0.0, coefficients=parts, drive=0j)
    if frequency is not None:
        omega = 2.0 * np.pi * require_within("frequency", frequency, "Hz", above=0)
        rate = require_within("decay_rate", decay_rate, "1/s", low=0)
        motion = replace(motion, omega=omega, decay_rate=rate)
    for _ in range(MOST_STEPS):
        motion, change = _newton(motion, amplitude, driven=frequency is not None)
        if change < CLOSE:
            return motion
    raise ArithmeticError(f"no motion of {amplitude:g} m was found; Newton's last step was {change:.0e}")


def _newton(motion: PeriodicMotion, amplitude: float, driven: bool) -> tuple[PeriodicMotion, float]:
    """Return the motion after a step of Newton's method, and the relative size of the step."""
    model, k, c = motion.model, motion.harmonics, motion.coefficients
    momentum, size = c @ model.linear.mass, c.size
    if driven:
        columns = [np.where(k[:, None] == sign, model.linear.base_load, 0.0) for sign in (1, -1)]
    else:
        factors = -2.0 * motion.omega * k**2, 1j * motion.omega * k
        columns = [factor[:, None] * momentum for factor in factors]
    border = csr_array(np.array([column.ravel() for column in columns]).T)
    conditions = np.array([np.kron(weights, model.linear.tip) for weights in (np.ones(k.size), 1j * k)])
    bordered = block_array([[motion.derivative(), border], [csr_array(conditions), None]])
    displacement, velocity = (row @ c.ravel() for row in conditions)
    residual = np.concatenate((motion.residual().ravel(), [displacement - amplitude, velocity]))
    step = -splu(csc_array(bordered)).solve(residual)
    c = c + step[:size].reshape(c.shape)
    c = 0.5 * (c + c[::-1].conj())  # the displacement is real
    first, second = step[size:]
    drive, omega, rate = motion.drive, motion.omega, motion.decay_rate
    if driven:
        drive = complex(drive + 0.5 * (first + np.conj(second)))
    else:
        omega, rate = omega + first.real, rate + second.real
    change = float(np.linalg.norm(step[:size]) / np.linalg.norm(c))
    return replace(motion, coefficients=c, drive=drive, omega=omega, decay_rate=rate), change
