"""Directions in which the numbers of an impact oscillator change: what derivatives are taken in.

A `Change` holds the derivatives of those numbers with respect to one parameter p, written with a dot.  What a
motion sees of them are the changes of omega_k^2, c_k, phi_k, of the level -gap, of the drive w, of the law's
numbers, and, by the chain rule, of the steady motion (``contact.oscillator``)

    H_k = Gamma_k w^2/E_k,      E_k = omega_k^2 - w^2 + i c_k w,
    H_k. = (Gamma_k. w^2 + 2 Gamma_k w w. - H_k (2 omega_k omega_k. - 2 w w. + i (c_k. w + c_k w.)))/E_k,
    a. + i b. = sum phi_k. H_k + phi_k H_k..
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from beam import ModalChange
from beam.parameters import final, require, require_array, require_each, require_kind, require_within, shown
from contact.flight.variation import Variation, variation
from contact.laws import DELAYED
from contact.oscillator import ImpactOscillator

Array = NDArray[np.float64]
ARRAYS = ("omega", "decay_rate", "phi", "participation")
Path = Callable[[float], ImpactOscillator]

STRIDE, STENCIL = 1e-3, np.arange(-2.0, 3.0)
"""Part of the range of a path, and steps of it, for the differences of an oscillator's numbers along it."""


@final
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

    def __post_init__(self) -> None:
        require_kind("model", self.model, (ModalChange, type(None)), "a ModalChange or None")
        for name, unit in (("gap", "m"), ("frequency", "Hz"), ("amplitude", "m")):
            require_within(name, getattr(self, name), f"{unit} per unit of the parameter")
        require_array("law", self.law, "its units", shape=(2,), words="two numbers")


@dataclass(frozen=True, kw_only=True, eq=False)
class Changes:
    """Several changes of one oscillator, side by side; arrays have one row for each.

    Parameters
    ----------
    oscillator : ImpactOscillator
    changes : sequence of Change

    Raises
    ------
    ValueError
        For a change of another number of modes, or of a number that the law does not have; or if the
        oscillator carries a constant load.
    """

    oscillator: ImpactOscillator
    changes: Sequence[Change] = ()

    def __post_init__(self) -> None:
        require_kind("oscillator", self.oscillator, ImpactOscillator, "an ImpactOscillator")
        changes = require_each("changes", self.changes, Change, "Change objects")
        object.__setattr__(self, "changes", changes)
        law, n = self.oscillator.stop.law, self.oscillator.n_modes
        known = 2 if law.code == DELAYED else len(law.units)
        require(
            self.oscillator.load is None or not self.changes,
            "load is given; it must be None for derivatives with respect to numbers of the oscillator",
        )
        for change in self.changes:
            size = n if change.model is None else change.model.omega.size
            require(size == n, f"model of the change has {size} modes; the oscillator has {n}")
            words = f"law of the change is {shown(change.law)}; {type(law).__name__} has {known} numbers"
            require(not any(change.law[known:]), words)

    def _row(self, name: str) -> Array:
        return np.array([getattr(each, name) for each in self.changes], dtype=float)

    @cached_property
    def model(self) -> dict[str, Array]:
        """Those of omega, decay_rate, phi and participation by name, each (changes, n_modes)."""
        still = ModalChange(**{name: np.zeros(self.oscillator.n_modes) for name in ARRAYS})
        models = [each.model or still for each in self.changes]
        shape = len(models), self.oscillator.n_modes
        return {name: np.array([getattr(each, name) for each in models]).reshape(shape) for name in ARRAYS}

    @cached_property
    def pace(self) -> Array:
        """Those of w, shape (changes,) [rad/s]."""
        return 2.0 * math.pi * self._row("frequency")

    @cached_property
    def amplitude(self) -> Array:
        """Those of the base amplitude, shape (changes,) [m]."""
        return self._row("amplitude")

    @cached_property
    def level(self) -> Array:
        """Those of the static tip displacement less the gap, shape (changes,) [m]."""
        return -self._row("gap")

    @property
    def of_period(self) -> Array:
        """Those of the drive period, shape (changes,) [s]."""
        drive = self.oscillator.driven
        return np.asarray(-self.pace / drive.angular_frequency * drive.period)

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """Those of H_k, shape (changes, n_modes) [kg^0.5]."""
        model, change, steady = self.oscillator.model, self.model, self.oscillator.steady_response()
        w, turn = self.oscillator.driven.angular_frequency, self.pace[:, None]
        fading = 1j * (change["decay_rate"] * w + model.decay_rate * turn)
        turned = 2.0 * (model.omega * change["omega"] - w * turn) + fading
        pushed = change["participation"] * w**2 + 2.0 * model.participation * w * turn
        found: NDArray[np.complex128] = (pushed - steady * turned) / self.oscillator.dynamic_stiffness()
        return found

    @cached_property
    def tip_response(self) -> NDArray[np.complex128]:
        """Those of a + i b, shape (changes,) [1]."""
        steady = self.model["phi"] @ self.oscillator.steady_response()
        return np.asarray(steady + self.response @ self.oscillator.model.phi)

    @cached_property
    def grazing_amplitude(self) -> Array:
        """Those of Z_g = gap/|a + i b|, the base amplitude at grazing, shape (changes,) [m]."""
        response, graze = self.oscillator.tip_response(), self.oscillator.grazing_amplitude()
        return np.asarray(-self.level / abs(response) - graze * (self.tip_response / response).real)

    @cached_property
    def variation(self) -> Variation:
        """The same for the kernels."""
        if not self.changes:
            return variation(self.oscillator.motion(), self.oscillator.tip_response())
        tip, law = self.tip_response, self._row("law")
        return variation(
            self.oscillator.motion(),
            self.oscillator.tip_response(),
            2.0 * self.oscillator.model.omega * self.model["omega"],
            self.model["decay_rate"],
            self.model["phi"],
            np.column_stack([self.level, tip.real, tip.imag, self.pace, law]),
        )

    def steady(self, clock: float | Array) -> Array:
        """The changes of the steady motion (q, q') at fixed times `clock` [s] after a strobe, shape
        (..., 2 n_modes, changes)."""
        times, drive = np.asarray(clock, dtype=float)[..., None, None], self.oscillator.driven
        steady, w = self.oscillator.steady_response(), drive.angular_frequency
        turn, pace = np.exp(1j * w * times), self.pace[:, None]
        size = drive.amplitude * self.response + np.multiply.outer(self.amplitude, steady)
        moved = (size + 1j * times * drive.amplitude * pace * steady) * turn
        rate = w * moved + pace * drive.amplitude * steady * turn
        return np.concatenate([np.swapaxes(part, -1, -2) for part in (moved.imag, rate.real)], axis=-2)


def change_along(path: Path, p: float, low: float, high: float) -> Change:
    """How the numbers of ``path(p)`` change with p, per unit of p: of numbers, so that differences of order
    four within [low, high] are good to 1e-12 of them per range."""
    stride = STRIDE * (high - low)
    middle = min(max(p, low + 2.0 * stride), high - 2.0 * stride)
    rows = np.array([_numbers(path(q)) for q in middle + STENCIL * stride])
    powers = np.vander((middle - p) / stride + STENCIL, increasing=True)
    rates, n = np.linalg.solve(powers, rows)[1] / stride, (rows.shape[1] - 5) // 4
    *model, (gap, first, second, frequency, amplitude) = np.split(rates, n * np.arange(1, 5))
    return Change(
        model=ModalChange(**dict(zip(ARRAYS, model, strict=True))),
        gap=float(gap),
        law=(float(first), float(second)),
        frequency=float(frequency),
        amplitude=float(amplitude),
    )


def _numbers(oscillator: ImpactOscillator) -> Array:
    """The four rows of its model, gap, numbers of the law, drive frequency and amplitude."""
    law, drive = oscillator.stop.law, oscillator.driven
    numbers = law.table[[1, 3], 0] if law.code == DELAYED else law.numbers
    rows = [getattr(oscillator.model, name) for name in ARRAYS]
    return np.concatenate([*rows, [oscillator.stop.gap, *numbers, drive.frequency, drive.amplitude]])
