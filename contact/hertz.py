"""Hertz's law of an elastic ball, and Hunt and Crossley's law with dissipation.

With the penetration d [m] and its rate d' [m/s] the force of the stop is, for d > 0,

    HertzContact    N = k d^(3/2)
    HuntCrossley    N = k d^(3/2) (1 + chi d')

(H. Hertz, J. reine angew. Math. 92 (1882) 156; K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440).
Under both laws the force vanishes only at d = 0.  The compiled part is ``contact.touch.power``.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from beam.parameters import final, record, require_within, suspect
from contact.laws import POWER, ContactLaw

HERTZ_TIME = 0.8 * math.sqrt(math.pi) * 2.0757065006382507
"""Contact time of a free mass under Hertz's law over (greatest approach / approach velocity): 0.8 sqrt(pi)
Gamma(0.4)/Gamma(0.9) = 2.9432 [1]."""

SOFTEST, HARDEST = 1e8, 1.5e12
"""Young's moduli of the bodies in contact beyond which a warning is given [Pa]: soft polymers and diamond; in
GPa or MPa a modulus is far below."""


@final
@record(eq=True)
class HertzContact(ContactLaw):
    """Elastic contact of a ball: N = `stiffness` d^(3/2) for d > 0.

    Parameters
    ----------
    stiffness : float
        Stiffness k of the contact, above zero [N/m^1.5].

    Raises
    ------
    ValueError
        If the stiffness is not above zero or not finite.
    TypeError
        If the stiffness is no number.

    See Also
    --------
    HuntCrossley : The same force with dissipation.
    PowerContact : A force with another power of the depth.
    LinearContact : Spring and dashpot.

    Notes
    -----
    The law holds for a smooth ball on a thick plate while both stay elastic and the contact is slow against
    the waves in them.  No run checks this.  The pressure in the contact is at most 3 N/(2 pi R d), with the
    radius R of the ball.  How many modes a force needs depends on the contact time:
    see ``docs/methods/adequacy.md``.

    Examples
    --------
    A steel ball with a radius of 2.5 mm hits a thick steel plate at 0.1 m/s:

    >>> from contact import HertzContact
    >>> steel = dict(youngs_modulus=210e9, poissons_ratio=0.3, other_modulus=210e9, other_ratio=0.3)
    >>> law = HertzContact.of_bodies(radius=2.5e-3, **steel)
    >>> print(f"{law.stiffness:.3g} N/m^1.5")
    7.69e+09 N/m^1.5
    >>> print(f"{1e6 * law.contact_time(mass=0.51e-3, velocity=0.1):.1f} µs")
    27.3 µs
    """

    stiffness: float
    code: ClassVar[int] = POWER
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^1.5"}

    @property
    def table(self) -> np.ndarray:
        """m, m x and m y of ``contact.touch.power``, with x = 3/2 and y = 0."""
        return np.array([[2.0, 3.0, 0.0]])

    @staticmethod
    def of_bodies(
        *,
        radius: float,
        youngs_modulus: float,
        poissons_ratio: float,
        other_modulus: float,
        other_ratio: float,
    ) -> HertzContact:
        """Return the law of a ball of `radius` [m] on a plate, with moduli in Pa.

        k = (4/3) sqrt(R) / ((1 - nu^2)/E + (1 - nu'^2)/E') [N/m^1.5].  A modulus that no such solid has
        brings a SuspiciousValue warning.
        """
        require_within("radius", radius, "m", above=0)
        for name, value in (("youngs_modulus", youngs_modulus), ("other_modulus", other_modulus)):
            require_within(name, value, "Pa", above=0)
            if not SOFTEST <= value <= HARDEST:
                known = f"solids that a ball rebounds from lie between {SOFTEST:g} and {HARDEST:g} Pa"
                suspect(f"{name} is {value:g} Pa; {known}")
        for name, value in (("poissons_ratio", poissons_ratio), ("other_ratio", other_ratio)):
            require_within(name, value, "[1]", above=-1, high=0.5)
        compliance = (1 - poissons_ratio**2) / youngs_modulus + (1 - other_ratio**2) / other_modulus
        return HertzContact(stiffness=4.0 / 3.0 * math.sqrt(radius) / compliance)

    def greatest_approach(self, mass: float, velocity: float) -> float:
        """Return the largest depth of a free `mass` [kg] at approach `velocity` [m/s]: (5 m v^2/(4 k))^(2/5)
        [m]."""
        require_within("mass", mass, "kg", above=0)
        require_within("velocity", velocity, "m/s", above=0)
        return float((1.25 * mass * velocity**2 / self.stiffness) ** 0.4)

    def contact_time(self, mass: float, velocity: float) -> float:
        """Return the duration of the contact of a free `mass` [kg] at approach `velocity` [m/s] [s]."""
        return HERTZ_TIME * self.greatest_approach(mass, velocity) / velocity


@final
@record(eq=True)
class HuntCrossley(ContactLaw):
    """Hertz's law with dissipation: N = `stiffness` d^(3/2) (1 + `dissipation` d') for d > 0.

    Parameters
    ----------
    stiffness : float
        Stiffness k of the contact, above zero [N/m^1.5].
    dissipation : float
        Coefficient chi of the dissipation, zero or more [s/m].

    Raises
    ------
    ValueError
        If a number is out of its range or not finite.
    TypeError
        If one of them is no number.

    See Also
    --------
    HertzContact : The same force without dissipation.
    PowerContact : A law with the same restitution at every speed.
    LinearContact : Spring and dashpot.

    Notes
    -----
    The law is used as its authors published it.  At d' < -1/chi the force pulls.  A free mass never leaves so
    fast; a heavily damped tip that is torn off the stop can.

    Let v_in be the approach speed of a free mass and v_out the speed with which it leaves.  Then
    a = chi v_in and b = chi v_out obey the equation ``a - log(1 + a) = -b - log(1 - b)``.

    Examples
    --------
    The dissipation under which a ball keeps 60 % of an approach speed of 0.1 m/s:

    >>> from contact import HuntCrossley
    >>> law = HuntCrossley.with_restitution(stiffness=8e9, restitution=0.6, velocity=0.1)
    >>> print(f"{law.dissipation:.2f} s/m")
    9.75 s/m
    """

    stiffness: float
    dissipation: float
    code: ClassVar[int] = POWER
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^1.5", "dissipation": "s/m"}
    table = HertzContact.table

    @staticmethod
    def with_restitution(*, stiffness: float, restitution: float, velocity: float) -> HuntCrossley:
        """Return the law under which a free mass leaves with `restitution` times `velocity` [m/s].

        `velocity` is the approach speed, and `restitution` lies above 0 and is at most 1.  The relation is
        exact, for any exponent of d.  It holds at this speed only: slower masses leave with more of their
        speed, faster ones with less.  Under ``PowerContact.with_restitution`` it holds at every speed.
        """
        e = require_within("restitution", restitution, "[1]", above=0, high=1)
        require_within("velocity", velocity, "m/s", above=0)
        if e == 1.0:
            return HuntCrossley(stiffness=stiffness, dissipation=0.0)

        from scipy.optimize import brentq  # slow to import

        def balance(w: float) -> float:
            """The relation with b = 1 - exp(-w), a = b/e: b itself comes too close to 1 when e is small."""
            b = -math.expm1(-w)
            return b / e - math.log1p(b / e) + b - w

        # for e near 1 the root is at b = (3/2)(1/e^2 - 1)/(1/e^3 + 1), for small e just below w = 1/e + 1
        low = 0.5 * min(1.0, 1.5 * e * (1.0 - e * e) / (1.0 + e**3))
        root = -math.expm1(-float(brentq(balance, low, 1.0 / e + 2.0, xtol=1e-300, rtol=1e-15, maxiter=500)))
        return HuntCrossley(stiffness=stiffness, dissipation=root / (e * velocity))
