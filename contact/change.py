"""Directions in which the numbers of an impact oscillator change: what derivatives are taken in.

A `Change` holds the derivatives of those numbers with respect to one parameter p, written with a dot.  What a
motion sees of them are the changes of omega_k^2, c_k, phi_k, of the level -gap (with a constant load), of the
drive w, of the law's numbers, and, by the chain rule, of the steady motion (``contact.oscillator``)

    H_k = Gamma_k w^2/E_k,      E_k = omega_k^2 - w^2 + i c_k w,
    H_k. = (Gamma_k. w^2 + 2 Gamma_k w w. - H_k (2 omega_k omega_k. - 2 w w. + i (c_k. w + c_k w.)))/E_k,
    a. + i b. = sum phi_k. H_k + phi_k H_k..
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam import ModalChange
from beam.parameters import require, require_kind, shown
from contact.laws import DELAYED
from contact.oscillator import ImpactOscillator
from contact.touch.tangents import NUMBERS, Variation, variation

__all__ = ["Change", "Changes"]

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Change:
    """The derivatives of an oscillator's numbers with respect to one parameter, per its unit.

    Parameters
    ----------
    model : ModalChange, optional
        Those of omega, decay_rate, phi and participation, each (n_modes,).
    gap : float
        Of the gap [m].
    law : (float, float)
        Of the numbers of the law, in the order of its `units`; of restitution and delay for
        ``DelayedRestitution``, whose functions of the speed are then moved as they are.
    frequency, amplitude : float
        Of drive frequency [Hz] and base amplitude [m].
    """

    model: ModalChange | None = None
    gap: float = 0.0
    law: tuple[float, float] = (0.0, 0.0)
    frequency: float = 0.0
    amplitude: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Changes:
    """Several changes of one oscillator, side by side; arrays have one row for each.

    Raises
    ------
    ValueError
        For a change of another number of modes, of a number that the law does not have, or of a mode that
        moves freely under a constant load.
    """

    oscillator: ImpactOscillator
    changes: Sequence[Change] = ()

    def __post_init__(self) -> None:
        law, n = self.oscillator.stop.law, self.oscillator.n_modes
        known = 2 if law.code == DELAYED else len(law.units)
        for change in self.changes:
            require_kind("changes", change, Change, "Change objects")
            if change.model is not None:
                size = change.model.omega.size
                require(size == n, f"model of the change has {size} modes; the oscillator has {n}")
            require(
                len(change.law) == 2 and not any(change.law[known:]),
                f"law of the change is {shown(change.law)}; {type(law).__name__} has {known} numbers",
            )
        falling = (self.oscillator.model.omega == 0.0) & (self._load != 0.0)
        require(
            not np.any(falling & ((self.omega != 0.0) | (self.decay != 0.0))),
            "model of the change moves omega or decay_rate of a mode without stiffness under a constant "
            "load, of which there is no derivative here",
        )

    @property
    def _load(self) -> Array:
        load = self.oscillator.load
        return np.zeros(self.oscillator.n_modes) if load is None else load

    def of_model(self, name: str) -> Array:
        """The changes of one array of the model, shape (changes, n_modes)."""
        none = np.zeros(self.oscillator.n_modes)
        rows = [none if each.model is None else getattr(each.model, name) for each in self.changes]
        return np.array(rows).reshape(len(rows), none.size)

    @cached_property
    def omega(self) -> Array:
        """Those of omega [rad/s]."""
        return self.of_model("omega")

    @cached_property
    def decay(self) -> Array:
        """Those of c [1/s]."""
        return self.of_model("decay_rate")

    @cached_property
    def phi(self) -> Array:
        """Those of phi [kg^-0.5]."""
        return self.of_model("phi")

    @cached_property
    def pace(self) -> Array:
        """Those of w, shape (changes,) [rad/s]."""
        return 2.0 * math.pi * np.array([each.frequency for each in self.changes])

    @property
    def of_period(self) -> Array:
        """Those of the drive period, shape (changes,) [s]."""
        drive = self.oscillator.driven
        return np.asarray(-self.pace / drive.angular_frequency * drive.period)

    @cached_property
    def amplitude(self) -> Array:
        """Those of the base amplitude, shape (changes,) [m]."""
        return np.array([each.amplitude for each in self.changes], dtype=float)

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """Those of H_k, shape (changes, n_modes) [kg^0.5]."""
        model, steady = self.oscillator.model, self.oscillator.steady_response()
        if self.oscillator.drive is None:
            return np.zeros_like(self.omega, dtype=complex)
        w, turn = self.oscillator.drive.angular_frequency, self.pace[:, None]
        distance = (model.omega - w) * (model.omega + w) + 1j * model.decay_rate * w
        moved = 2.0 * (model.omega * self.omega - w * turn) + 1j * (self.decay * w + model.decay_rate * turn)
        pushed = self.of_model("participation") * w**2 + 2.0 * model.participation * w * turn
        found: NDArray[np.complex128] = (pushed - steady * moved) / distance
        return found

    @cached_property
    def tip_response(self) -> NDArray[np.complex128]:
        """Those of a + i b, shape (changes,) [1]."""
        found: NDArray[np.complex128] = (
            self.phi @ self.oscillator.steady_response() + self.response @ self.oscillator.model.phi
        )
        return found

    @cached_property
    def offset(self) -> Array:
        """Those of the static displacement g_k/omega_k^2, shape (changes, n_modes) [m kg^0.5]."""
        stiff = self.oscillator.model.omega > 0.0
        omega = np.where(stiff, self.oscillator.model.omega, 1.0)
        return np.where(stiff, -2.0 * self._load * self.omega / omega**3, 0.0)

    @cached_property
    def level(self) -> Array:
        """Those of the static tip displacement less the gap, shape (changes,) [m]."""
        model, gap = self.oscillator.model, np.array([each.gap for each in self.changes], dtype=float)
        stiff = model.omega > 0.0
        static = np.where(stiff, self._load / np.where(stiff, model.omega, 1.0) ** 2, 0.0)
        return self.phi @ static + self.offset @ model.phi - gap

    @cached_property
    def grazing_amplitude(self) -> Array:
        """Those of the base amplitude Z_g = -level/|a + i b| at which the steady motion grazes, (changes,)
        [m]."""
        response, graze = self.oscillator.tip_response(), self.oscillator.grazing_amplitude()
        turned = (self.tip_response / response).real
        return -self.level / abs(response) - graze * turned

    @cached_property
    def variation(self) -> Variation:
        """The same for the kernels."""
        law = np.array([each.law for each in self.changes], dtype=float).reshape(-1, 2)
        rest = np.column_stack(
            [self.level, self.tip_response.real, self.tip_response.imag, self.pace, law]
        ).reshape(-1, NUMBERS)
        return variation(
            self.oscillator.motion(), self.oscillator.tip_response(),
            2.0 * self.oscillator.model.omega * self.omega, self.decay, self.phi, rest,
        )  # fmt: skip

    def steady(self, clock: float | Array) -> Array:
        """The changes of the steady motion (q, q') at fixed times `clock` [s] after a strobe, shape
        (..., 2 n_modes, changes)."""
        clock = np.asarray(clock, dtype=float)[..., None, None]
        if self.oscillator.drive is None:
            still = np.vstack([self.offset.T, np.zeros_like(self.offset.T)])
            return np.broadcast_to(still, (*clock.shape[:-2], *still.shape))
        drive, steady = self.oscillator.drive, self.oscillator.steady_response()
        w, turn = drive.angular_frequency, np.exp(1j * drive.angular_frequency * clock)
        size = drive.amplitude * self.response + np.multiply.outer(self.amplitude, steady)
        moved = (size + 1j * clock * drive.amplitude * self.pace[:, None] * steady) * turn
        rate = w * moved + self.pace[:, None] * drive.amplitude * steady * turn
        parts = self.offset + moved.imag, rate.real
        return np.concatenate([np.swapaxes(part, -1, -2) for part in parts], axis=-2)
