"""How fast each mode dies out: rules for the coefficient c_k of q_k'' + c_k q_k' + omega_k^2 q_k.

Amplitudes fall as exp(-c_k t / 2), energies as exp(-c_k t). The usual measures of the same thing are

    damping ratio  zeta_k = c_k / (2 omega_k),     loss factor  eta_k = c_k / omega_k,     both [1],

both for light damping. Rules, one a class, each with `decay_rates(modes)`, [1/s], shape (n_modes,):

    StripDamping        c = eta_k omega_k, eta_k from the strain energies of lossy sections
    ConstantLossFactor  c = eta omega
    ConstantRatio       c = 2 zeta omega
    Rayleigh            c = alpha + beta omega^2, from a damping matrix alpha M + beta K
    MeasuredDecay       c_1 as measured; the others from one of the rules above, scaled with it or not

Modal damping neglects what damping couples; see `modal_model`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .modes import Modes
from .parameters import InvalidType, require, require_kind, require_within, shown


class Damping(Protocol):
    """Anything that gives each mode its decay rate."""

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return c [1/s], shape (n_modes,)."""
        ...


def require_rule(name: str, rule: object) -> None:
    """TypeError unless `rule` is one for decay rates."""
    if isinstance(rule, type) or not callable(getattr(rule, "decay_rates", None)):
        raise InvalidType(
            f"{name} is {shown(rule)}; it must be a rule for decay rates such as StripDamping()"
        )


@dataclass(frozen=True, kw_only=True)
class StripDamping:
    """Internal friction of the strip and its glued layers, by modal strain energy."""

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return eta_k omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return modes.loss_factors() * modes.omega


@dataclass(frozen=True, kw_only=True)
class ConstantLossFactor:
    """The same loss factor in every mode.

    Parameters
    ----------
    loss_factor : float
        eta [1], not negative.
    """

    loss_factor: float

    def __post_init__(self) -> None:
        require_within("loss_factor", self.loss_factor, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return eta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return self.loss_factor * modes.omega


@dataclass(frozen=True, kw_only=True)
class ConstantRatio:
    """The same damping ratio in every mode.

    Parameters
    ----------
    ratio : float
        zeta [1], not negative; 1 is critical.
    """

    ratio: float

    def __post_init__(self) -> None:
        require_within("ratio", self.ratio, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return 2 zeta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return 2.0 * self.ratio * modes.omega


@dataclass(frozen=True, kw_only=True)
class Rayleigh:
    """Damping matrix alpha M + beta K.

    Parameters
    ----------
    mass_coefficient : float
        alpha [1/s], not negative.
    stiffness_coefficient : float
        beta [s], not negative.
    """

    mass_coefficient: float
    stiffness_coefficient: float

    def __post_init__(self) -> None:
        require_within("mass_coefficient", self.mass_coefficient, "1/s", low=0)
        require_within("stiffness_coefficient", self.stiffness_coefficient, "s", low=0)

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return alpha + beta omega_k^2 [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return self.mass_coefficient + self.stiffness_coefficient * modes.omega**2


@dataclass(frozen=True, kw_only=True)
class MeasuredDecay:
    """The decay rate of the first coupled mode as measured, the others by a rule.

    Parameters
    ----------
    decay_rate : float
        c_1 [1/s], not negative: the letter's mu.
    others : Damping
        Rule for the other modes.
    scaled : bool
        If true, the whole rule is multiplied so that it gives c_1 in the first coupled mode: the shape of the
        spectrum is the rule's, its level the measurement's. If false, only the first coupled mode is
        replaced.

    Raises
    ------
    ValueError
        From `decay_rates`, if no coupled mode vibrates, or a rule that is to be scaled gives the first no
        damping.
    """

    decay_rate: float
    others: Damping = field(default_factory=StripDamping)
    scaled: bool = True

    def __post_init__(self) -> None:
        require_within("decay_rate", self.decay_rate, "1/s", low=0)
        require_rule("others", self.others)
        require_kind("scaled", self.scaled, bool, "True or False")

    def decay_rates(self, modes: Modes) -> NDArray[np.float64]:
        """Return c [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        candidates = np.flatnonzero(modes.coupled & (modes.omega > 0.0))
        count = modes.omega.size
        require(candidates.size > 0, f"modes has {count} modes, none of which both couples and vibrates")
        first, rates = candidates[0], np.array(self.others.decay_rates(modes))
        if not self.scaled:
            rates[first] = self.decay_rate
            return rates
        rate = rates[first]
        require(rate > 0.0, f"others gives mode 1 a rate of {rate} 1/s; to be scaled it must be above zero")
        return rates * (self.decay_rate / rates[first])
