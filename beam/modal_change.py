"""Derivatives of a modal model with respect to one parameter of the spring.

Measured parameters: the damped free period T and the decay rate c_1 are read off the ring-down of mode 1,

    omega_1^2 = (2 pi/T)^2 + (c_1/2)^2.

The ratios omega_k/omega_1 are kept, as under a change of Young's modulus.
"""

from __future__ import annotations

import numpy as np

from .modal_model import ModalChange, ModalModel
from .parameters import Array, require_kind, require_whole


def free_period_change(model: ModalModel) -> ModalChange:
    """Return the derivative of `model` with respect to its damped free period T, per second.

    The decay rates and the ratios of the frequencies are fixed.
    """
    omega, rates, k = _frequencies(model)
    change = -omega / omega[k] ** 2 * (2.0 * np.pi) ** 2 / model.free_period**3
    return _with_fixed_shapes(change, 0.0 * rates)


def decay_rate_change(model: ModalModel, mode: int | None = 0) -> ModalChange:
    """Return the derivative of `model` with respect to the decay rate of one mode, per 1/s.

    The free period T is fixed; `mode` counts from 0. With None, all decay rates are scaled with that of
    mode 1. If mode 1 has no damping, None changes all rates by the same amount.
    """
    omega, rates, k = _frequencies(model)
    scaled = rates / rates[k] if rates[k] > 0.0 else np.ones(model.n_modes)
    if mode is None:
        change = scaled
    else:
        change = np.eye(model.n_modes)[require_whole("mode", mode, "[1]", low=0, high=model.n_modes - 1)]
    return _with_fixed_shapes(0.25 * rates[k] * change[k] * omega / omega[k] ** 2, change)


def _frequencies(model: ModalModel) -> tuple[Array, Array, int]:
    """Return omega [rad/s], the decay rates [1/s], and the index of mode 1 in them."""
    require_kind("model", model, ModalModel, "a ModalModel")
    return model.omega, model.decay_rate, model.leading_mode


def _with_fixed_shapes(omega: Array, rates: Array) -> ModalChange:
    """Return the change of these frequencies and rates, with phi and participation fixed."""
    return ModalChange(omega=omega, decay_rate=rates, phi=0.0 * omega, participation=0.0 * omega)
