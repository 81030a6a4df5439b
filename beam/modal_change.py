"""How the numbers that an impact sees of a spring change with a parameter of it.

Measured numbers: the damped free period T and the decay rate c_1 are read off the ring-down of mode 1,
omega_1^2 = (2 pi/T)^2 + (c_1/2)^2; with one mode they are those of `single_mode`. The ratios omega_k/omega_1
are kept, as under a change of the modulus. Damping ratios zeta_k = c_k/(2 omega_k) may stand for all c_k.

Finite elements: with K x = omega^2 M x, x^T M x = 1, a change (') of K and M moves a simple mode by

    (omega^2)' = x^T (K' - omega^2 M') x,
    [ K - omega^2 M   M x ] [ x' ]   [ ((omega^2)' M - K' + omega^2 M') x ]
    [ x^T M            0  ] [ 0  ] = [ -x^T M' x / 2                      ],

regular though K - omega^2 M is not (R. B. Nelson, AIAA J. 14 (1976) 1201, bordered), and Gamma = b^T x. The
rule of `damping` is given modes with the change as imaginary part, and so are the decay rates it returns
(complex step: W. Squire and G. Trapp, SIAM Rev. 40 (1998) 110).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import splu

from .assembly import carried
from .damping import Damping, require_rule
from .modal_model import ModalChange, ModalModel
from .modes import Modes
from .parameters import require, require_kind, require_whole
from .pieces import place
from .spring import Tip

CLOSEST = 1e-6
"""Relative distance of two frequencies below which rounding leaves no derivative of their shapes."""
STEP = 1e-30j
"""Complex step: its square is far below rounding."""


def free_period_change(model: ModalModel, *, ratios_kept: bool = False) -> ModalChange:
    """Return the change of `model` with T, per second, at fixed decay rates; with `ratios_kept` at fixed
    damping ratios."""
    omega, rates, k = _rows(model)
    if ratios_kept:
        return _of_numbers(-omega / model.free_period, -rates / model.free_period)
    return _of_numbers(-omega / omega[k] ** 2 * (2.0 * np.pi) ** 2 / model.free_period**3, 0.0 * rates)


def decay_rate_change(model: ModalModel, mode: int | None = 0) -> ModalChange:
    """Return the change of `model` at fixed T, per change [1/s] of the decay rate c of `mode` (0 is mode 1).

    With None, c of mode 1 changes, and the other rates in proportion. If mode 1 has no damping, all rates
    change by the same amount.
    """
    omega, rates, k = _rows(model)
    together = rates / rates[k] if rates[k] > 0.0 else np.ones(model.n_modes)
    change = together if mode is None else _one(model, mode)
    return _of_numbers(0.25 * rates[k] * change[k] * omega / omega[k] ** 2, change)


def damping_ratio_change(model: ModalModel, mode: int | None = None) -> ModalChange:
    """Return the change of `model` at fixed T with zeta of one `mode`, from 0 on; None: of all by the same
    amount."""
    omega, rates, k = _rows(model)
    change = np.ones(model.n_modes) if mode is None else _one(model, mode)
    first = 0.5 * rates[k] * omega[k] * (model.free_period / (2.0 * np.pi)) ** 2 * change[k]
    return _of_numbers(first * omega, 2.0 * omega * change + first * rates)


def frequency_change(model: ModalModel, mode: int) -> ModalChange:
    """Return the change of `model` with the undamped frequency of one `mode` alone, from 0 on, per Hz."""
    omega, _rates, _k = _rows(model)
    return _of_numbers(2.0 * np.pi * _one(model, mode), 0.0 * omega)


def tip_mass_change(modes: Modes, damping: Damping) -> ModalChange:
    """Return the change of those of `modes` that `reduce` keeps, under `damping`, with the tip mass, per
    kg."""
    require_kind("modes", modes, Modes, "Modes, from natural_modes")
    model = modes.discretization
    moved = place(model.spring.centreline, model.pieces, model.ties, model.spring.tip_at)
    return mode_changes(modes, damping, mass=carried(Tip(mass=1.0), moved), base_load=model.tip)


def mode_changes(
    modes: Modes,
    damping: Damping,
    *,
    stiffness: csr_array | None = None,
    loss_stiffness: csr_array | None = None,
    mass: csr_array | None = None,
    base_load: NDArray[np.float64] | None = None,
) -> ModalChange:
    """Return the change of those of `modes` that `reduce` keeps with a parameter of the matrices.

    `stiffness`, `loss_stiffness`, `mass` and `base_load` are the derivatives of those of the
    `Discretization`. What the rule of `damping` knows from elsewhere, such as a measured rate, is kept.

    Raises
    ------
    ValueError
        Where two frequencies coincide, or a rigid motion gets stiffness; if the rule does not follow.
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
        pencil = block_array([[model.stiffness - square * model.mass, border], [border.T, None]])
        right = d_square[k] * border[:, 0] - d_k @ x[:, k] + square * inert
        d_x[:, k] = splu(pencil.tocsc()).solve(np.append(right, -0.5 * x[:, k] @ inert))[:-1]
    d_phi, d_gamma = model.tip @ d_x, model.base_load @ d_x + (0.0 if base_load is None else base_load @ x)
    moving = replace(
        _Moving(**vars(modes)),
        discretization=replace(
            model, stiffness=model.stiffness + STEP * d_k, loss_stiffness=model.loss_stiffness + STEP * d_l
        ),
        omega=omega + STEP * d_omega,
        shapes=x + STEP * d_x,
    )
    rates = damping.decay_rates(moving)
    told = f"damping is {damping!r}; it must give complex rates for complex omega, to be followed"
    require(np.iscomplexobj(rates), told)
    rates = (rates / STEP).real
    changes = {"omega": d_omega, "decay_rate": rates, "phi": d_phi, "participation": d_gamma}
    return ModalChange(**{name: row[keep] for name, row in changes.items()})


class _Moving(Modes):
    """Modes with a change as imaginary part."""

    def __post_init__(self) -> None:
        """Complex numbers are valid."""


def _rows(model: ModalModel) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """omega, the decay rates, and the number of mode 1 among them."""
    require_kind("model", model, ModalModel, "a ModalModel")
    return model.omega, model.decay_rate, model.leading_mode


def _one(model: ModalModel, mode: int) -> NDArray[np.float64]:
    """1 at this mode, 0 at the others."""
    return np.eye(model.n_modes)[require_whole("mode", mode, "[1]", low=0, high=model.n_modes - 1)]


def _of_numbers(omega: NDArray[np.float64], rates: NDArray[np.float64]) -> ModalChange:
    """Tip values and participations stay."""
    return ModalChange(omega=omega, decay_rate=rates, phi=0.0 * omega, participation=0.0 * omega)
