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

from dataclasses import field
from typing import Protocol, runtime_checkable

import numpy as np

from .modes import Modes
from .parameters import Array, record, require, require_kind, require_within


@runtime_checkable
class Damping(Protocol):
    """A rule that gives each mode its decay rate: any class with the method `decay_rates`."""

    def decay_rates(self, modes: Modes) -> Array:
        """Return the decay rates c [1/s], shape (n_modes,)."""
        ...


@record(eq=True)
class StripDamping:
    """Internal friction of the strip and its glued layers.

    The decay rates are c_k = eta_k omega_k [1/s], with eta_k from the strain energies of the lossy sections.
    """

    def decay_rates(self, modes: Modes) -> Array:
        """Return eta_k omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return modes.loss_factors() * modes.omega


@record(eq=True)
class ConstantLossFactor:
    """One loss factor eta for all modes, c = eta omega [1/s].

    Parameters
    ----------
    loss_factor : float
        Loss factor eta [1], not negative.

    Raises
    ------
    ValueError
        If `loss_factor` is negative or not finite.
    TypeError
        If `loss_factor` is not a number.
    """

    loss_factor: float

    def __post_init__(self) -> None:
        require_within("loss_factor", self.loss_factor, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> Array:
        """Return eta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return self.loss_factor * modes.omega


@record(eq=True)
class ConstantRatio:
    """One damping ratio zeta for all modes, c = 2 zeta omega [1/s].

    Parameters
    ----------
    ratio : float
        Damping ratio zeta [1], not negative; 1 is critical.

    Raises
    ------
    ValueError
        If `ratio` is negative or not finite.
    TypeError
        If `ratio` is not a number.

    See Also
    --------
    MeasuredDecay : The measured decay rate of the first mode, and a rule for the others.
    StripDamping : Damping by the internal friction of the strip and its layers.
    reduce : The modal model of a spring with such a rule.

    Examples
    --------
    >>> from beam import STEEL, ConstantRatio, StripSection, assemble, cantilever, natural_modes
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip)), count=3)
    >>> rates = ConstantRatio(ratio=0.005).decay_rates(modes)
    >>> [round(rate, 2) for rate in rates.tolist()]
    [1.17, 7.33, 20.52]
    >>> [round(ratio, 4) for ratio in (rates / (2 * modes.omega)).tolist()]
    [0.005, 0.005, 0.005]
    """

    ratio: float

    def __post_init__(self) -> None:
        require_within("ratio", self.ratio, "[1]", low=0)

    def decay_rates(self, modes: Modes) -> Array:
        """Return 2 zeta omega_k [1/s], shape (n_modes,)."""
        require_kind("modes", modes, Modes, "Modes, from natural_modes")
        return 2.0 * self.ratio * modes.omega


@record(eq=True)
class Rayleigh:
    """A damping matrix alpha M + beta K, which gives c = alpha + beta omega^2 [1/s].

    Parameters
    ----------
    mass_coefficient, stiffness_coefficient : float
        Coefficients alpha [1/s] and beta [s], not negative.

    Raises
    ------
    ValueError
        If a coefficient is negative or not finite.
    TypeError
        If a coefficient is not a number.
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


@record(eq=True)
class MeasuredDecay:
    """The measured decay rate of the first coupled mode, and a rule for the other modes.

    Parameters
    ----------
    decay_rate : float
        Decay rate c_1 [1/s], not negative: the letter's mu. Amplitudes fall as exp(-c_1 t/2).
    others : Damping
        Rule for the other modes; the internal friction of the strip by default.
    scaled : bool
        If true, one factor multiplies all rates of the rule, so that the first coupled mode has c_1. If
        false, only the rate of the first coupled mode is replaced.

    Raises
    ------
    ValueError
        If `decay_rate` is negative or not finite. Also from the method `decay_rates`, if no coupled mode
        vibrates, or if a rule to be scaled gives the first one no damping.
    TypeError
        If `decay_rate` is not a number, `others` is not a rule, or `scaled` is not True or False.

    See Also
    --------
    ConstantRatio : One damping ratio for all modes.
    StripDamping : Damping by the internal friction of the strip and its layers.
    reduce : The modal model of a spring with such a rule.

    Examples
    --------
    The measured rate belongs to mode 1, and the others keep their damping ratio:

    >>> from beam import STEEL, ConstantRatio, MeasuredDecay, StripSection
    >>> from beam import assemble, cantilever, natural_modes
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip)), count=3)
    >>> rule = MeasuredDecay(decay_rate=3.56, others=ConstantRatio(ratio=0.005), scaled=False)
    >>> [round(rate, 2) for rate in rule.decay_rates(modes).tolist()]
    [3.56, 7.33, 20.52]
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
