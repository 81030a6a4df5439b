"""Derivatives of a modal model with respect to one parameter of the spring.

Measured parameters: the damped free period T and the decay rate c_1 are read off the ring-down of mode 1,

    omega_1^2 = (2 pi/T)^2 + (c_1/2)^2.

The ratios omega_k/omega_1 are kept, as under a change of Young's modulus. Damping may be given by the ratios
zeta_k = c_k/(2 omega_k) in place of c_k.

Parameters of finite elements: with K x = omega^2 M x, x^T M x = 1, a change (') of K and M moves a simple
mode by (R. B. Nelson, AIAA J. 14 (1976) 1201, bordered)

    (omega^2)' = x^T (K' - omega^2 M') x,
    [ K - omega^2 M   M x ] [ x' ]   [ ((omega^2)' M - K' + omega^2 M') x ]
    [ x^T M            0  ] [ 0  ] = [ -x^T M' x / 2                      ].

The bordered matrix is regular though K - omega^2 M is not. phi and Gamma follow as linear functions of x. The
decay rates are differentiated by a complex step (W. Squire and G. Trapp, SIAM Rev. 40 (1998) 110): the rule
of `damping` is given modes with the change as imaginary part.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import splu

from .assembly import tip_inertia
from .damping import Damping, require_rule
from .modal_model import ModalChange, ModalModel
from .modes import Modes
from .parameters import Array, require, require_kind, require_whole
from .pieces import motion_at
from .spring import Tip

CLOSEST = 1e-6
"""Relative distance of two frequencies below which rounding leaves no derivative of their shapes."""
STEP = 1e-30j
"""Complex step: its square is far below rounding."""


def free_period_change(model: ModalModel, *, ratios_kept: bool = False) -> ModalChange:
    """Return the derivative of `model` with respect to its damped free period T, per second.

    The decay rates are fixed, or with `ratios_kept` the damping ratios. The ratios of the frequencies stay.
    """
    omega, rates, k = _frequencies(model)
    if ratios_kept:
        return _with_fixed_shapes(-omega / model.free_period, -rates / model.free_period)
    change = -omega / omega[k] ** 2 * (2.0 * np.pi) ** 2 / model.free_period**3
    return _with_fixed_shapes(change, 0.0 * rates)


def decay_rate_change(model: ModalModel, mode: int | None = 0) -> ModalChange:
    """Return the derivative of `model` with respect to the decay rate of one mode, per 1/s.

    The free period T is fixed; `mode` counts from 0. With None, all decay rates are scaled with that of
    mode 1. If mode 1 has no damping, None changes all rates by the same amount.
    """
    omega, rates, k = _frequencies(model)
    scaled = rates / rates[k] if rates[k] > 0.0 else np.ones(model.n_modes)
    change = scaled if mode is None else _unit(model, mode)
    return _with_fixed_shapes(0.25 * rates[k] * change[k] * omega / omega[k] ** 2, change)


def damping_ratio_change(model: ModalModel, mode: int | None = None) -> ModalChange:
    """Return the derivative of `model` with respect to the damping ratio zeta of one mode, per unit [1].

    The free period T is fixed; `mode` counts from 0. With None, all damping ratios change by the same amount.
    """
    omega, rates, k = _frequencies(model)
    change = np.ones(model.n_modes) if mode is None else _unit(model, mode)
    first = 0.5 * rates[k] * omega[k] * (model.free_period / (2.0 * np.pi)) ** 2 * change[k]
    return _with_fixed_shapes(first * omega, 2.0 * omega * change + first * rates)


def frequency_change(model: ModalModel, mode: int) -> ModalChange:
    """Return the derivative of `model` with respect to the undamped frequency of one mode, per Hz.

    `mode` counts from 0. All other frequencies and all decay rates are fixed.
    """
    return _with_fixed_shapes(2.0 * np.pi * _unit(model, mode), np.zeros(model.n_modes))


def tip_mass_change(modes: Modes, damping: Damping) -> ModalChange:
    """Return the derivative of ``reduce(modes, damping)`` with respect to the mass of the tip, per kg."""
    require_kind("modes", modes, Modes, "Modes, from natural_modes")
    model = modes.discretization
    motion = motion_at(model.spring.centreline, model.pieces, model.ties, model.spring.tip_at)
    return mode_changes(modes, damping, mass=tip_inertia(Tip(mass=1.0), motion), base_load=model.tip)


def mode_changes(
    modes: Modes,
    damping: Damping,
    *,
    stiffness: csr_array | None = None,
    loss_stiffness: csr_array | None = None,
    mass: csr_array | None = None,
    base_load: Array | None = None,
) -> ModalChange:
    """Return the derivative of ``reduce(modes, damping)`` with respect to a parameter of the matrices.

    Parameters
    ----------
    modes : Modes
    damping : Damping
        Measured rates and other numbers that the rule holds are fixed.
    stiffness, loss_stiffness, mass : sparse array, shape (n_dofs, n_dofs), optional
        Derivatives of the matrices of the `Discretization`, in their units per unit of the parameter; zero by
        default.
    base_load : ndarray, shape (n_dofs,), optional
        Derivative of its base load [kg per unit of the parameter].

    Raises
    ------
    ValueError
        If two frequencies coincide, a rigid motion gets stiffness, or the rule does not take complex numbers.
    """
    require_kind("modes", modes, Modes, "Modes, from natural_modes")
    require_rule("damping", damping)
    model, omega, x, keep = modes.discretization, modes.omega, modes.shapes, np.flatnonzero(modes.coupled)
    none = csr_array(model.mass.shape)
    d_k, d_m, d_l = (none if part is None else part for part in (stiffness, mass, loss_stiffness))
    d_square = np.einsum("ik,ik->k", x, d_k @ x - (d_m @ x) * omega**2)
    require(not d_square[omega == 0.0].any(), "omega holds 0 rad/s; a rigid motion must not get stiffness")
    d_omega, d_x = np.divide(d_square, 2.0 * omega, out=0.0 * omega, where=omega > 0.0), 0.0 * x
    for k in keep:
        apart = np.abs(np.delete(omega, k) - omega[k]).min(initial=np.inf)
        require(apart > CLOSEST * omega[k], f"omega holds {omega[k]} rad/s twice; there is no derivative")
        square, border, inert = omega[k] ** 2, (model.mass @ x[:, k])[:, None], d_m @ x[:, k]
        bordered = block_array([[model.stiffness - square * model.mass, border], [border.T, None]])
        right = d_square[k] * border[:, 0] - d_k @ x[:, k] + square * inert
        d_x[:, k] = splu(bordered.tocsc()).solve(np.append(right, -0.5 * x[:, k] @ inert))[:-1]
    d_phi, d_gamma = model.tip @ d_x, model.base_load @ d_x + (0.0 if base_load is None else base_load @ x)
    stepped = {"stiffness": model.stiffness + STEP * d_k, "loss_stiffness": model.loss_stiffness + STEP * d_l}
    moving = copy(modes)  # the constructor refuses complex numbers
    vars(moving).update(
        discretization=replace(model, **stepped), omega=omega + STEP * d_omega, shapes=x + STEP * d_x
    )
    rates = damping.decay_rates(moving)
    words = "it must give complex rates for complex omega, so that they can be differentiated"
    require(np.iscomplexobj(rates), f"damping is {damping!r}; {words}")
    changes = {"omega": d_omega, "decay_rate": (rates / STEP).real, "phi": d_phi, "participation": d_gamma}
    return ModalChange(**{name: row[keep] for name, row in changes.items()})


def _frequencies(model: ModalModel) -> tuple[Array, Array, int]:
    """Return omega [rad/s], the decay rates [1/s], and the index of mode 1 in them."""
    require_kind("model", model, ModalModel, "a ModalModel")
    return model.omega, model.decay_rate, model.leading_mode


def _unit(model: ModalModel, mode: int) -> Array:
    """Return a row with 1 at this mode and 0 at the others, shape (n_modes,)."""
    require_kind("model", model, ModalModel, "a ModalModel")
    return np.eye(model.n_modes)[require_whole("mode", mode, "[1]", low=0, high=model.n_modes - 1)]


def _with_fixed_shapes(omega: Array, rates: Array) -> ModalChange:
    """Return the change of these frequencies and rates, with phi and participation fixed."""
    return ModalChange(omega=omega, decay_rate=rates, phi=0.0 * omega, participation=0.0 * omega)
