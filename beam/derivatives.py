"""Derivatives of a modal model with respect to one parameter of the spring.

Measured parameters: the damped free period T and the decay rate c_1 are read off the ring-down of mode 1,

    omega_1^2 = (2 pi/T)^2 + (c_1/2)^2.

The ratios omega_k/omega_1 are kept, as under a change of Young's modulus.

A mass m added at the tip mixes the modes. With q = V r,

    diag(omega^2) V = (1 + m phi phi^T) V diag(omega'^2),   V^T (1 + m phi phi^T) V = 1,

and phi' = V^T phi, Gamma' = V^T (Gamma + m phi). T and the decay rates are kept: all omega' are scaled.
"""

from dataclasses import replace

import numpy as np

from .modal_model import UNITS, ModalModel, Point
from .parameters import Array, final, require, require_array, require_kind, require_whole, require_within
from .record import record


@final
@record
class ModalChange:
    """Derivatives of the four arrays of a `ModalModel` with respect to one parameter.

    Parameters
    ----------
    omega, decay_rate, phi, participation : array_like, shape (n_modes,)
        Derivatives [unit of the array per unit of the parameter]; stored as read-only float64 copies.

    Raises
    ------
    ValueError
        If an array is not finite, or has another shape than `omega`.
    TypeError
        If an array does not hold real numbers.
    """

    omega: Array
    decay_rate: Array
    phi: Array
    participation: Array

    def __post_init__(self) -> None:
        shape, words = np.shape(self.omega), "a row of numbers"
        for name, unit in UNITS.items():
            given, unit = getattr(self, name), f"{unit} per unit of the parameter"
            row = require_array(name, given, unit, dimensions=1, shape=shape, words=words)
            object.__setattr__(self, name, row)


def free_period_change(model: ModalModel) -> ModalChange:
    """Return the derivative of a modal model with respect to its damped free period T.

    The decay rates and the ratios of the frequencies are fixed.

    Parameters
    ----------
    model : ModalModel
        The model to vary.

    Returns
    -------
    ModalChange
        Derivatives of the arrays [their unit per second], each of shape (n_modes,).

    Raises
    ------
    ValueError
        If mode 1 is overdamped and has no free period.
    TypeError
        If `model` is not a ModalModel.
    """
    omega, rates, k = _frequencies(model)
    change = -omega / omega[k] ** 2 * (2.0 * np.pi) ** 2 / model.free_period**3
    return ModalChange(omega=change, decay_rate=0.0 * rates, phi=0.0 * change, participation=0.0 * change)


def decay_rate_change(model: ModalModel, mode: int | None = 0) -> ModalChange:
    """Return the derivative of a modal model with respect to the decay rate of one mode, or of all.

    The free period T is fixed.

    Parameters
    ----------
    model : ModalModel
        The model to vary.
    mode : int, optional
        Index of the mode, from 0. With None, all decay rates are scaled with the one of mode 1. If mode 1
        has no damping, None changes all rates by the same amount.

    Returns
    -------
    ModalChange
        Derivatives of the arrays [their unit per 1/s], each of shape (n_modes,).

    Raises
    ------
    ValueError
        If the model has no such mode.
    TypeError
        If `model` is not a ModalModel, or `mode` is neither a number nor None.
    """
    (omega, rates, k), n = _frequencies(model), model.n_modes
    scaled = rates / rates[k] if rates[k] > 0.0 else np.ones(n)
    change = scaled if mode is None else np.eye(n)[require_whole("mode", mode, "[1]", low=0, high=n - 1)]
    moved = 0.25 * rates[k] * change[k] * omega / omega[k] ** 2
    return ModalChange(omega=moved, decay_rate=change, phi=0.0 * moved, participation=0.0 * moved)


def tip_mass_change(model: ModalModel) -> ModalChange:
    """Return the derivative of a modal model with respect to the mass at its tip.

    The free period T and the decay rates are fixed.

    Parameters
    ----------
    model : ModalModel
        The model to vary.

    Returns
    -------
    ModalChange
        Derivatives of the arrays [their unit per kg], each of shape (n_modes,).

    Raises
    ------
    ValueError
        If a mode that moves the tip has the frequency of another mode, or the frequency 0.
    TypeError
        If `model` is not a ModalModel.
    """
    omega, rates, lead = _frequencies(model)
    phi, gamma, square = model.phi, model.participation, omega**2
    apart = square[:, None] - square + np.diag(square)
    require(bool(np.all(apart[:, phi != 0.0])), "omega", f"is {omega} rad/s; no two frequencies may be equal")
    mixed = np.outer(phi, square * phi) / np.where(apart, apart, 1.0)  # of e_j in mode k, to first order
    np.fill_diagonal(mixed, -0.5 * phi**2)
    change = -0.5 * phi**2 * omega
    return ModalChange(
        omega=change - omega * (change[lead] / omega[lead]),
        decay_rate=0.0 * rates,
        phi=phi @ mixed,
        participation=phi + gamma @ mixed,
    )


def with_tip_mass(model: ModalModel, mass: float) -> ModalModel:
    """Return a modal model with another mass at its tip.

    The modes of the given model span the motion. The free period T, the decay rates, the signs of `phi` and
    the masses of other points are kept.

    Parameters
    ----------
    model : ModalModel
        The model to vary; its `tip_mass` must be known.
    mass : float
        The new mass at the tip [kg], above zero.

    Returns
    -------
    ModalModel
        The model with the new mass, with as many modes.

    Raises
    ------
    ValueError
        If the model has no tip mass, or `mass` is not positive or so small that a mode loses its inertia.
    TypeError
        If `model` is not a ModalModel, or `mass` is not a number.
    """
    from scipy.linalg import eigh  # slow to import

    omega, _rates, lead = _frequencies(model)
    require(bool(model.tip_mass), "tip_mass", f"is {model.tip_mass} kg; the model must have one, above zero")
    added = require_within("mass", mass, "kg", above=0) - float(model.tip_mass or 0.0)
    left = 1.0 + added * float(model.phi @ model.phi)
    require(left > 0.0, "mass", f"is {mass} kg; with phi = {model.phi} that leaves a mode less than no mass")
    found, shapes = eigh(np.diag(omega**2), np.eye(omega.size) + added * np.outer(model.phi, model.phi))
    place = np.argsort(np.argsort(omega))  # one more mass moves no frequency beyond the next
    shapes, paces = shapes[:, place], np.sqrt(np.maximum(found[place], 0.0))
    shapes = shapes * np.where(model.phi * (model.phi @ shapes) < 0.0, -1.0, 1.0)
    scale = omega[lead] / paces[lead]
    points = dict[str, Point]()
    for name, point in model.points.items():
        compliance = point.static_compliance and point.static_compliance / scale**2
        points[name] = replace(point, row=point.row @ shapes, static_compliance=compliance)
    return ModalModel(
        omega=paces * scale,
        decay_rate=model.decay_rate,
        phi=points["tip"].row,
        participation=(model.participation + added * model.phi) @ shapes,
        static_compliance=points["tip"].static_compliance,
        tip_mass=float(mass),
        points=points,
        dimensionless=model.dimensionless,
    )


def _frequencies(model: ModalModel) -> tuple[Array, Array, int]:
    """Return omega [rad/s], the decay rates [1/s], and the index of mode 1 in them."""
    require_kind("model", model, ModalModel, "a ModalModel")
    return model.omega, model.decay_rate, model.leading_mode
