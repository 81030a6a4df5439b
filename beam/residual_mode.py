"""The residual mode: one mode that replaces all modes left out of a truncated modal model.

It supplies the terms missing in the sums over all modes, C the static compliance of the tip [m/N] and M its
lumped mass [kg]:

    phi^2 = 1/M - sum phi_k^2,   phi^2/omega^2 = C - sum phi_k^2/omega_k^2,
    Gamma phi = 1 - sum Gamma_k phi_k.
"""

from collections.abc import Mapping

import numpy as np

from .parameters import Array, require

LEAST_RESIDUAL = 1e-5
"""Smallest ratio of residual to static compliance of a residual mode. Finite elements give statics to 1e-7,
so that the residual is then uncertain by 1 %."""


def residual_mode(
    rows: Mapping[str, Array], static_compliance: float | None, tip_mass: float | None
) -> dict[str, float]:
    """Return omega, decay_rate, phi and participation of the mode that the modes `rows` lack.

    `rows` are the same four arrays of the other modes. The mode has the damping ratio of the last of them.
    """
    for name, value, unit in (("static_compliance", static_compliance, "m/N"), ("tip_mass", tip_mass, "kg")):
        require(bool(value), name, f"is {value} {unit}; the residual mode needs it, above zero")
    assert static_compliance is not None and tip_mass is not None
    omega_k, phi_k = rows["omega"], rows["phi"]
    oscillating = omega_k > 0.0
    squares = np.where(oscillating, omega_k, 1.0) ** 2
    square = 1.0 / tip_mass - float(phi_k @ phi_k)
    compliance = static_compliance - float(np.where(oscillating, phi_k**2 / squares, 0.0).sum())
    given = f"tip_mass is {tip_mass} kg and static_compliance {static_compliance} m/N"
    left = f"the modes lack {square:.3g} 1/kg of 1/tip_mass and {compliance:.3g} m/N of the compliance"
    words = f"{given}; {left}, which must be above zero and above {LEAST_RESIDUAL:g} of the whole"
    require(square > 0.0 and compliance > LEAST_RESIDUAL * static_compliance, words)
    phi, omega = np.sqrt(square), np.sqrt(square / compliance)
    ratio = rows["decay_rate"][-1] / omega_k[-1] if omega_k[-1] > 0.0 else 0.0
    participation = (1.0 - float(phi_k @ rows["participation"])) / phi
    return dict(omega=omega, decay_rate=ratio * omega, phi=phi, participation=participation)
