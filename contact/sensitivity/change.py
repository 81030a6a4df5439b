"""Parameters of an impact oscillator, each a direction in which its numbers change.

A `Change` holds the derivatives of the oscillator's numbers with respect to one parameter p, written with a
dot: of omega_k, c_k, phi_k, Gamma_k, the gap, the drive frequency w and the numbers of the law.  The steady
motion (``contact.steady_response``) changes by

    H_k = Gamma_k w^2/E_k,      E_k = omega_k^2 - w^2 + i c_k w,
    H_k. = (Gamma_k. w^2 + 2 Gamma_k w w. - H_k (2 omega_k omega_k. - 2 w w. + i (c_k. w + c_k w.)))/E_k,
    a. + i b. = sum phi_k. H_k + phi_k H_k..
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import ModalChange, ModalModel
from beam.parameters import Array, final, require, require_array, require_each, require_kind, require_within
from beam.record import record
from contact.flight.variation import Variation, variation
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.steady_response import dynamic_stiffness

ARRAYS = ("omega", "decay_rate", "phi", "participation")
Path = Callable[[float], ImpactOscillator]

STRIDE, STENCIL = 1e-3, np.arange(-2.0, 3.0)
"""Part of the range of a path, and steps of it, for the differences of an oscillator's numbers along it."""


@final
@record
class Change:
    """The derivatives of an oscillator's numbers with respect to one parameter.

    All derivatives are per unit of the parameter.  A parameter can change several numbers at the same time.

    Parameters
    ----------
    model : ModalChange, optional
        Derivatives of omega, decay_rate, phi and participation, each of shape (n_modes,).
    gap : float, optional
        Derivative of the gap [m].
    law : (float, float), optional
        Derivatives of the numbers of the law, in the order of its `units`; zero for a number that it does not
        have.  For ``DelayedRestitution`` they are added to restitution and delay at every speed.  The
        derivative of a `local_restitution` is added at every speed, too.
    frequency : float, optional
        Derivative of the drive frequency [Hz].
    amplitude : float, optional
        Derivative of the base amplitude [m].

    Raises
    ------
    TypeError
        If `model` is no ModalChange, or another argument is no number.
    ValueError
        If a number is not finite, or `law` does not hold two numbers.
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

    def applied(self, oscillator: ImpactOscillator, step: float) -> ImpactOscillator:
        """The oscillator with its numbers moved by `step` times this change, statics of the tip left out."""

        def moved(one: object, change: object, names: Sequence[str]) -> dict[str, Any]:
            return {name: getattr(one, name) + step * getattr(change, name) for name in names}

        model, stop, drive = oscillator.model, oscillator.stop, oscillator.driven
        if self.model is not None:
            model = ModalModel(**moved(model, self.model, ARRAYS), dimensionless=model.dimensionless)
        law = stop.law.moved(*(step * np.array(self.law)))
        stop = replace(stop, **moved(stop, self, ["gap"]), law=law)
        drive = replace(drive, **moved(drive, self, ["frequency", "amplitude"]))
        return replace(oscillator, model=model, stop=stop, drive=drive)


@record
class Sensitivities:
    """Derivatives of an oscillator's numbers and steady motion with respect to P parameters, `changes`.

    The attributes are arrays with one row for each parameter.  ValueError is raised for a change of another
    number of modes, or of a number that the law does not have, and for an oscillator with a constant load.
    """

    oscillator: ImpactOscillator
    changes: Sequence[Change] = ()

    def __post_init__(self) -> None:
        require_one_stop(self.oscillator, "derivatives")
        changes = require_each("changes", self.changes, Change, "Change objects")
        object.__setattr__(self, "changes", changes)
        law, n = self.oscillator.stop.law, self.oscillator.n_modes
        known = len(law.adjustable)
        words = "load is given; it must be None for derivatives with respect to numbers of the oscillator"
        require(self.oscillator.load is None or not self.changes, words)
        for change in self.changes:
            size = n if change.model is None else change.model.omega.size
            require(size == n, f"model of the change has {size} modes; the oscillator has {n}")
            words = f"law of the change is {change.law!r}; {type(law).__name__} has {known} numbers"
            require(not any(change.law[known:]), words)

    def _row(self, name: str) -> Array:
        return np.array([getattr(each, name) for each in self.changes], dtype=float)

    @cached_property
    def model(self) -> dict[str, Array]:
        """Derivatives of omega, decay_rate, phi and participation by name, each (P, n_modes)."""
        still = ModalChange(**{name: np.zeros(self.oscillator.n_modes) for name in ARRAYS})
        models = [each.model or still for each in self.changes]
        shape = len(models), self.oscillator.n_modes
        return {name: np.array([getattr(each, name) for each in models]).reshape(shape) for name in ARRAYS}

    @cached_property
    def frequency(self) -> Array:
        """Derivatives of the angular drive frequency w, shape (P,) [rad/s]."""
        return 2.0 * math.pi * self._row("frequency")

    @cached_property
    def amplitude(self) -> Array:
        """Derivatives of the base amplitude, shape (P,) [m]."""
        return self._row("amplitude")

    @cached_property
    def level(self) -> Array:
        """Derivatives of the static tip displacement less the gap, shape (P,) [m]."""
        return -self._row("gap")

    @property
    def period(self) -> Array:
        """Derivatives of the drive period, shape (P,) [s]."""
        drive = self.oscillator.driven
        return np.asarray(-self.frequency / drive.angular_frequency * drive.period)

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """Derivatives of H_k, shape (P, n_modes) [kg^0.5]."""
        model, change, steady = self.oscillator.model, self.model, self.oscillator.steady_response()
        w, w_dot = self.oscillator.driven.angular_frequency, self.frequency[:, None]
        damping = 1j * (change["decay_rate"] * w + model.decay_rate * w_dot)
        stiffness = 2.0 * (model.omega * change["omega"] - w * w_dot) + damping
        push = change["participation"] * w**2 + 2.0 * model.participation * w * w_dot
        dynamic = dynamic_stiffness(model.omega, model.decay_rate, w)
        return np.asarray((push - steady * stiffness) / dynamic)

    @cached_property
    def tip_response(self) -> NDArray[np.complex128]:
        """Derivatives of a + i b, shape (P,) [1]."""
        steady = self.model["phi"] @ self.oscillator.steady_response()
        return np.asarray(steady + self.response @ self.oscillator.model.phi)

    @cached_property
    def grazing_amplitude(self) -> Array:
        """Derivatives of Z_g = gap/|a + i b|, the base amplitude at grazing, shape (P,) [m]."""
        response, graze = self.oscillator.tip_response(), self.oscillator.grazing_amplitude()
        return np.asarray(-self.level / abs(response) - graze * (self.tip_response / response).real)

    @cached_property
    def variation(self) -> Variation:
        """All derivatives in the form that compiled functions take."""
        known = self.oscillator.numbers(), self.oscillator.tip_response()
        if not self.changes:
            return variation(*known)
        tip, change, law = self.tip_response, self.model, self._row("law")
        square = 2.0 * self.oscillator.model.omega * change["omega"]
        scalars = np.column_stack([self.level, tip.real, tip.imag, self.frequency, law])
        return variation(*known, square, change["decay_rate"], change["phi"], scalars)

    def steady(self, clock: float | Array) -> Array:
        """Derivatives of the steady motion (q, q') at fixed times `clock` [s] after a strobe, shape
        (..., 2 n_modes, P)."""
        times, drive = np.asarray(clock, dtype=float)[..., None, None], self.oscillator.driven
        steady, w = self.oscillator.steady_response(), drive.angular_frequency
        phasor, w_dot = np.exp(1j * w * times), self.frequency[:, None]
        size = drive.amplitude * self.response + np.multiply.outer(self.amplitude, steady)
        moved = (size + 1j * times * drive.amplitude * w_dot * steady) * phasor
        rate = w * moved + w_dot * drive.amplitude * steady * phasor
        return np.concatenate([np.swapaxes(part, -1, -2) for part in (moved.imag, rate.real)], axis=-2)


def change_along(path: Path, p: float, low: float, high: float) -> Change:
    """The derivatives of the numbers of ``path(p)`` with respect to p, per unit of p.

    Central differences of order four within [low, high] have them to 1e-12 of the numbers per range.
    """
    stride = STRIDE * (high - low)
    middle = min(max(p, low + 2.0 * stride), high - 2.0 * stride)
    rows = np.array([_numbers(path(q)) for q in middle + STENCIL * stride])
    powers = np.vander((middle - p) / stride + STENCIL, increasing=True)
    rates, n = np.linalg.solve(powers, rows)[1] / stride, (rows.shape[1] - 5) // 4
    *arrays, others = np.split(rates, n * np.arange(1, 5))
    model = ModalChange(**dict(zip(ARRAYS, arrays, strict=True)))
    gap, first, second, frequency, amplitude = others.tolist()
    return Change(model=model, gap=gap, law=(first, second), frequency=frequency, amplitude=amplitude)


def _numbers(oscillator: ImpactOscillator) -> Array:
    """The rows of the model, the gap, the numbers of the law, drive frequency and amplitude in one row."""
    law, drive = oscillator.stop.law, oscillator.driven
    adjustable = (*law.adjustable, 0.0, 0.0)[:2]
    rows = [getattr(oscillator.model, name) for name in ARRAYS]
    return np.concatenate([*rows, [oscillator.stop.gap, *adjustable, drive.frequency, drive.amplitude]])
