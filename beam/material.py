"""Linear elastic, isotropic solids with light internal friction.

    E     `youngs_modulus` [Pa]
    nu    `poissons_ratio` [1], -1 < nu < 1/2
    rho   `density` [kg/m^3]
    G     shear modulus, G = E / (2 (1 + nu)) [Pa]
    eta   `loss_factor` [1]: energy lost per radian over the largest stored energy; in harmonic motion the
          modulus is E (1 + i eta), and a mode that stores all its energy here has c = eta omega

The named solids have handbook values, to be replaced by measured ones. E of brass lies between 97 and 110 GPa
with composition and rolling, its loss factor between 1e-4 and 2e-3. A damping layer's E and eta vary by
factors of ten with temperature and frequency.
"""

import math

from .parameters import record, require_within, suspect

SLOWEST_WAVE, FASTEST_WAVE = 400.0, 20_000.0
"""Range of the speed of sound sqrt(E/rho) [m/s]: 450 in soft polyethylene, 3500 in brass, 18 000 in diamond.
E or rho wrong by a factor of 1000 brings metals, ceramics, glass and hard polymers out of this range."""
GREATEST_LOSS = 3.0
"""Largest loss factor without a warning; the best damping polymers have 1 to 2."""


@record(eq=True)
class Material:
    """A linear elastic, isotropic solid.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus E [Pa], positive.
    poissons_ratio : float
        Poisson's ratio nu [1], between -1 and 1/2.
    density : float
        Density rho [kg/m^3], positive.
    loss_factor : float
        Loss factor eta [1], not negative.

    Raises
    ------
    ValueError
        If a value is out of range or not finite.
    TypeError
        If a value is not a number.

    Warns
    -----
    SuspiciousValue
        If no solid has such a speed of sound, or the loss factor is above 3.

    See Also
    --------
    StripSection : The cross-section of a strip of this material.
    Layer : A damping layer glued to a strip.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from beam import BRASS, Material
    >>> spring_steel = Material(youngs_modulus=206e9, poissons_ratio=0.29, density=7850.0)
    >>> round(spring_steel.wave_speed), round(spring_steel.shear_modulus / 1e9, 1)  # [m/s], [GPa]
    (5123, 79.8)
    >>> replace(BRASS, youngs_modulus=99e9).density
    8500.0
    """

    youngs_modulus: float
    poissons_ratio: float
    density: float
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        require_within("youngs_modulus", self.youngs_modulus, "Pa", above=0)
        require_within("density", self.density, "kg/m^3", above=0)
        require_within("loss_factor", self.loss_factor, "[1]", low=0)
        require_within("poissons_ratio", self.poissons_ratio, "[1]", above=-1.0, below=0.5)
        speed = self.wave_speed
        if not SLOWEST_WAVE <= speed <= FASTEST_WAVE:
            given = f"youngs_modulus {self.youngs_modulus:g} Pa and density {self.density:g} kg/m^3"
            words = f"solids lie between {SLOWEST_WAVE:g} and {FASTEST_WAVE:g} m/s"
            suspect(f"{given} give a speed of sound of {speed:.3g} m/s; {words}")
        if self.loss_factor > GREATEST_LOSS:
            suspect(f"loss_factor is {self.loss_factor:g} [1]; materials stay below {GREATEST_LOSS:g}")

    @property
    def wave_speed(self) -> float:
        """Speed of sound in a thin rod, sqrt(E/rho) [m/s]."""
        return math.sqrt(self.youngs_modulus / self.density)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G = E / (2 (1 + nu)) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


#: Cold-rolled cartridge brass, CuZn30 to CuZn37.
BRASS = Material(youngs_modulus=105e9, poissons_ratio=0.34, density=8500.0, loss_factor=1e-3)

#: Hardened bearing steel.
STEEL = Material(youngs_modulus=210e9, poissons_ratio=0.29, density=7810.0, loss_factor=2e-4)

#: Sintered alumina, above 99 % pure, as in ceramic balls.
ALUMINA = Material(youngs_modulus=370e9, poissons_ratio=0.22, density=3900.0, loss_factor=1e-4)

#: Free-layer damping material (filled polymer) near room temperature and tens to hundreds of hertz.
#: Representative only: A. D. Nashif, D. I. G. Jones, J. P. Henderson, Vibration Damping (Wiley 1985), ch. 3.
DAMPING_TAPE = Material(youngs_modulus=1e9, poissons_ratio=0.40, density=1400.0, loss_factor=0.4)
