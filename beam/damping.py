"""Damping of the modes: rules for the decay rate c_k in q_k'' + c_k q_k' + omega_k^2 q_k.

Amplitudes fall as exp(-c_k t / 2), energies as exp(-c_k t). Other measures of light damping are

    damping ratio  zeta_k = c_k / (2 omega_k),     loss factor  eta_k = c_k / omega_k,     both [1].

Each rule is a class with `decay_rates(modes)` [1/s], shape (n_modes,):

    StripDamping        c = eta_k omega_k, eta_k from the strain energies of lossy sections
    ConstantLossFactor  c = eta omega
    ConstantRatio       c = 2 zeta omega
    Rayleigh            c = alpha + beta omega^2, from a damping matrix alpha M + beta K
    MeasuredDecay       c_1 as measured; the others from one of the rules above, scaled with it or not
"""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from .modes import Modes
from .parameters import Array, require, require_kind, require_within


@runtime_checkable
class Damping(Protocol):
    """Anything that gives each mode its decay rate."""

    def decay_rates(self, modes: Modes) -> Array:
        """Return c [1/s], shape (n_modes,)."""
        ...


@dataclass(frozen=True, kw_only=True)
class StripDamping:
    """Internal friction of strip and glued layers: c = eta_k omega_k [1/s], eta_k from strain energies."""

    def decay_rates(self, modes: Modes) -> Array:
        """Return eta_k omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return modes.loss_factors() * modes.omega


@dataclass(frozen=True, kw_only=True)
class ConstantLossFactor:
    """One loss factor for all modes: c = eta omega.

    Parameters
    ----------
    loss_factor : float
        eta [1], not negative.
    """

    loss_factor: float

    def __post_init__(self) -> None:
        require_within("loss_factor", self.loss_factor, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> Array:
        """Return eta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return self.loss_factor * modes.omega


@dataclass(frozen=True, kw_only=True)
class ConstantRatio:
    """One damping ratio for all modes: c = 2 zeta omega.

    Parameters
    ----------
    ratio : float
        zeta [1], not negative; 1 is critical.
    """

    ratio: float

    def __post_init__(self) -> None:
        require_within("ratio", self.ratio, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> Array:
        """Return 2 zeta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return 2.0 * self.ratio * modes.omega


@dataclass(frozen=True, kw_only=True)
class Rayleigh:
    """Damping matrix alpha M + beta K: c = alpha + beta omega^2.

    Parameters
    ----------
    mass_coefficient, stiffness_coefficient : float
        alpha [1/s] and beta [s], not negative.
    """

    mass_coefficient: float
    stiffness_coefficient: float

    def __post_init__(self) -> None:
        require_within("mass_coefficient", self.mass_coefficient, "1/s", low=0)
        require_within("stiffness_coefficient", self.stiffness_coefficient, "s", low=0)

    def decay_rates(self, modes: Modes) -> Array:
        """Return alpha + beta omega_k^2 [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return self.mass_coefficient + self.stiffness_coefficient * modes.omega**2


@dataclass(frozen=True, kw_only=True)
class MeasuredDecay:
    """The decay rate of the first coupled mode as measured, the others by a rule.

    Parameters
    ----------
    decay_rate : float
        c_1 [1/s], not negative: the letter's mu. Amplitudes fall as exp(-c_1 t/2).
    others : Damping
        Rule for the other modes.
    scaled : bool
        If true, one factor multiplies all rates of the rule, so that the first coupled mode has c_1. If
        false, only the rate of the first coupled mode is replaced.

    Raises
    ------
    ValueError
        From `decay_rates`, if no coupled mode vibrates, or if a rule to be scaled gives the first no damping.
    """

    decay_rate: float
    others: Damping = field(default_factory=StripDamping)
    scaled: bool = True

    def __post_init__(self) -> None:
        require_within("decay_rate", self.decay_rate, "1/s", low=0)
        require_kind("others", self.others, Damping, "a rule for decay rates such as StripDamping()")
        require_kind("scaled", self.scaled, bool, "True or False")

    def decay_rates(self, modes: Modes) -> Array:
        """Return c [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        candidates, count = np.flatnonzero(modes.coupled & (modes.omega > 0.0)), modes.omega.size
        require(candidates.size > 0, "modes", f"has {count} modes, none of which is coupled and vibrates")
        first, rates = candidates[0], np.array(self.others.decay_rates(modes))
        if not self.scaled:
            rates[first] = self.decay_rate
            return rates
        own = rates[first]
        require(own > 0.0, "others", f"gives mode 1 a rate of {own} 1/s; to be scaled it must be above zero")
        return rates * (self.decay_rate / own)
