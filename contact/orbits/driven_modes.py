r"""Driven modes between the impacts of a periodic motion: response to the drive and free flow over m/f.

    q_k = Z Im(H_k exp(i w t)) + u_k,   H_k = Gamma_k w^2/(omega_k^2 - w^2 + i c_k w),   w = 2 pi f

u_k is free: over m/f, (u_k, u_k') -> N (u_k, u_k') with G = det N = exp(-c_k m/f). A deviation comes back to
itself after m/f only if D = det(I - N) = 1 - tr N + G is zero.

Units: SI with mass-normalised modes (q in m kg^0.5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require, require_array, require_whole, require_within
from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import Motion, damped_frequency, motion_of
from contact.laws import NewtonRestitution
from contact.nordmark import restitution_of

__all__ = ["SINGULAR", "DrivenModes", "modal_flow"]

Array = NDArray[np.float64]
SINGULAR = 1e-13  # a D below this is rounding of 1 - tr N + G, terms of size 1: the mode is back after m/f


def modal_flow(omega: Array, decay_rate: Array, time: float) -> Array:
    """Free flow (u, u') -> (u, u') of each mode over `time` [s], of either sign, shape (n_modes, 2, 2)."""
    rows = []
    for w, c in zip(omega.tolist(), decay_rate.tolist(), strict=True):
        high, low = damped_frequency(w, c)
        rows.append(flow_matrix(w, c, high, low, time))
    return np.array(rows).reshape(-1, 2, 2)


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenModes:
    """Modes, drive, wall and restitution, with the free flow over `period` drive periods.

    Parameters
    ----------
    omega, decay_rate, phi, participation : array_like, shape (n_modes,)
        omega_k [rad/s], c_k [1/s], phi_k [kg^-0.5], Gamma_k [kg^0.5].
    drive_frequency : float
        f [Hz].
    gap : float
        Distance of the wall, above zero [m].
    restitution : float
        e of the law, from 0 to 1 [1].
    period : int
        m, one or more [1].

    Raises
    ------
    ValueError
        For numbers outside these ranges; if the drive is at the frequency of an undamped mode; or if a mode
        that the impact excites returns to itself after m/f (zero frequency, or undamped and in resonance),
        for then no orbit is periodic.
    """

    omega: Array
    decay_rate: Array
    phi: Array
    participation: Array
    drive_frequency: float
    gap: float
    restitution: float
    period: int

    def __post_init__(self) -> None:
        units = {"omega": "rad/s", "decay_rate": "1/s", "phi": "kg^-0.5", "participation": "kg^0.5"}
        size = np.shape(self.omega)
        for name, unit in units.items():
            words = "a row of one finite number for each mode"
            row = require_array(name, getattr(self, name), unit, dimensions=1, words=words)
            require(row.size > 0 and row.shape == size, f"{name} has shape {row.shape}; it must be {words}")
            object.__setattr__(self, name, row)
        for name in ("omega", "decay_rate"):
            least = float(getattr(self, name).min())
            require(least >= 0.0, f"{name} holds {least} {units[name]}; no entry may be negative")
        require(bool(np.any(self.phi != 0.0)), "phi is zero in every mode; the tip must move in one of them")
        for name, unit in (("drive_frequency", "Hz"), ("gap", "m")):
            require_within(name, getattr(self, name), unit, above=0)
        require_within("restitution", self.restitution, "[1]", low=0, high=1)
        m = require_whole("period", self.period, "drive periods")
        free = (self.decay_rate == 0.0) & (self.omega == self.angular_frequency)
        f = self.drive_frequency
        require(not np.any(free), f"drive_frequency is {f} Hz, that of an undamped mode; it must differ")
        require(self.tip_response != 0.0, "participation does not let the drive move the tip; it must")
        trapped = np.flatnonzero((self.distance_from_return <= SINGULAR) & (self.phi != 0.0))
        if trapped.size:
            raise ValueError(
                f"omega[{trapped[0]}] is {self.omega[trapped[0]]} rad/s, a mode that is back after {m} drive "
                "periods; it must have damping or another frequency"
            )

    @classmethod
    def single_mode(
        cls, *, drive_frequency: float, free_period: float, decay_rate: float, restitution: float,
        period: int, gap: float = 1.0,
    ) -> Self:  # fmt: skip
        """Those of Eq. (1), from f [Hz], damped free period T [s], mu [1/s], tau and m."""
        require_within("free_period", free_period, "s", above=0)
        require_within("decay_rate", decay_rate, "1/s", low=0)
        omega, one = math.hypot(2.0 * math.pi / free_period, 0.5 * decay_rate), np.ones(1)
        return cls(
            omega=omega * one, decay_rate=decay_rate * one, phi=one, participation=one,
            drive_frequency=drive_frequency, gap=gap, restitution=restitution, period=period,
        )  # fmt: skip

    @classmethod
    def from_oscillator(
        cls, oscillator: Any, *, period: int, restitution: float | None = None
    ) -> Self:
        """Those of an `ImpactOscillator` without constant load.

        `restitution` replaces the law's `local_restitution`; TypeError if there is neither.
        """
        restitution = restitution_of(oscillator) if restitution is None else restitution
        require(oscillator.load is None, "load is given; it must be None for these orbits")
        require(oscillator.drive is not None, "drive is None; it must be a HarmonicDrive")
        model, drive = oscillator.model, oscillator.drive
        return cls(
            omega=model.omega, decay_rate=model.decay_rate, phi=model.phi, participation=model.participation,
            drive_frequency=drive.frequency, gap=oscillator.stop.gap, restitution=restitution, period=period,
        )  # fmt: skip

    @property
    def size(self) -> int:
        """Number of modes."""
        return self.omega.size

    @property
    def angular_frequency(self) -> float:
        """w = 2 pi f [rad/s]."""
        return 2.0 * math.pi * self.drive_frequency

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """H_k, shape (n_modes,) [kg^0.5]."""
        w = self.angular_frequency
        stiffness = (self.omega - w) * (self.omega + w)
        return np.asarray(self.participation * w**2 / (stiffness + 1j * self.decay_rate * w), dtype=complex)

    @property
    def tip_response(self) -> complex:
        """sum phi_k H_k: steady tip displacement per base displacement [1]."""
        return complex(self.phi @ self.response)

    @cached_property
    def flow(self) -> Array:
        """Phi, mode by mode, shape (n_modes, 2, 2)."""
        return modal_flow(self.omega, self.decay_rate, self.period / self.drive_frequency)

    @cached_property
    def determinant(self) -> Array:
        """G, mode by mode, shape (n_modes,)."""
        return np.exp(-self.decay_rate * self.period / self.drive_frequency)

    @cached_property
    def distance_from_return(self) -> Array:
        """D, mode by mode, shape (n_modes,)."""
        return np.abs(1.0 - self.flow[:, 0, 0] - self.flow[:, 1, 1] + self.determinant)

    @property
    def grazing_amplitude(self) -> float:
        """Base amplitude Z_g at which the steady motion touches the wall [m]."""
        return self.gap / abs(self.tip_response)

    def motion(self, amplitude: float) -> Motion:
        """The numbers of the flight between impacts, driven at the base amplitude `amplitude` [m]."""
        return motion_of(
            self.omega, self.decay_rate, self.phi, gap=self.gap, drive=self.angular_frequency,
            law=NewtonRestitution(local_restitution=self.restitution), period=1.0 / self.drive_frequency,
            response=amplitude * self.response,
        )  # fmt: skip
