"""Laws of the contact between tip and stop: plain numbers, no materials.

With the penetration d = x - gap [m] and its rate d' [m/s], the stop pushes the tip back with a force
-N, N >= 0, that acts only where d > 0.

* Impact law: ``NewtonRestitution``, velocity of the tip d' -> -e d' at once (letter 1996, below Eq. (1)).
* Force laws: ``LinearContact``, N = max(0, k d + c d').  With a dashpot (c > 0) the force vanishes before the
  tip has left the wall: the contact lets go inside, and may close again there.  ``HertzContact``, N = k
  d^(3/2) (H. Hertz, J. reine angew. Math. 92 (1882) 156), and ``HuntCrossley``, N = k d^(3/2) (1 + chi d')
  (K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440), which vanishes only at d = 0.  Other powers
  of d, with a restitution that holds at every speed, are ``PowerContact``.

Compiled code sees no objects: a law gives it a small integer, two numbers and a table (`code`, `numbers`,
`table`).  ``contact.touch`` has the compiled part of each law, and says how to add one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from beam.parameters import final, require_within, suspect
from contact.restitution import damping_ratio
from contact.speed_table import SPEEDS, Points, SpeedFunction, raised, require_points, require_speeds, sampled

NEWTON, LINEAR, POWER = 0, 1, 2
"""Codes of the laws in this file; another law stands with its code and its compiled part in one file of
``contact.touch``, as ``DelayedRestitution`` does."""

HERTZ_TIME = 0.8 * math.sqrt(math.pi) * 2.0757065006382507
"""Contact time of a free mass under Hertz's law over (greatest approach / approach velocity): 0.8 sqrt(pi)
Gamma(0.4)/Gamma(0.9) = 2.9432 [1]."""

SOFTEST, HARDEST = 1e8, 1.5e12
"""Young's moduli of the bodies in contact beyond which a warning is given [Pa]: soft polymers and diamond; in
GPa or MPa a modulus is far below."""


class ContactLaw:
    """What all laws offer to the compiled motion.

    Attributes
    ----------
    code : int
        The number by which ``contact.touch.LAWS`` finds the compiled part of the law.
    units : dict of str to str
        Names and units of the plain numbers of the law, two at most.  In a force law the first, its
        stiffness, is above zero and the other zero or more.
    one_mode_only : bool
        Whether the law holds for one mode only.
    """

    code: ClassVar[int] = -1
    units: ClassVar[dict[str, str]] = {}
    one_mode_only: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for name, unit in self.units.items():
            above, low = (0.0, None) if name == "stiffness" else (None, 0.0)
            require_within(f"{name} of the contact", getattr(self, name), unit, above=above, low=low)

    @property
    def numbers(self) -> tuple[float, float]:
        """The law's plain numbers for the kernels, filled up with zero."""
        first, second = (*(getattr(self, name) for name in self.units), 0.0, 0.0)[:2]
        return first, second

    @property
    def adjustable(self) -> tuple[float, ...]:
        """The numbers that ``contact.sensitivity.change.Change`` can move, two at most."""
        return self.numbers[: len(self.units)]

    @property
    def table(self) -> np.ndarray:
        """More numbers for the kernels, in two dimensions; none for most laws."""
        return np.empty((0, 0))

    def moved(self: Any, first: float, second: float) -> Any:
        """The law with its adjustable numbers moved by so much, in their order."""
        steps = zip(self.units, (first, second), strict=False)
        return replace(self, **{name: getattr(self, name) + step for name, step in steps})


@final
@dataclass(frozen=True, kw_only=True)
class NewtonRestitution(ContactLaw):
    """Instantaneous impact: the tip leaves with -`local_restitution` times its approach velocity.

    Parameters
    ----------
    local_restitution : float, callable or array_like of shape (2, n)
        e, from 0 (plastic) to 1 (elastic) [1].  The letter's tau is this number for one mode only.  It can be
        a function of the approach speed [m/s], or a table: two or more rising speeds [m/s], zero or more, and
        the restitutions there.  A table is interpolated by monotone cubics (F. N. Fritsch, J. Butland, SIAM
        J. Sci. Stat. Comput. 5 (1984) 300) and kept as a pair of tuples.  At vanishing speed (hops, grazing,
        Nordmark's map) the value at the lowest speed holds.
    speeds : (float, float)
        Range of approach speeds in which a function is sampled [m/s].  Functions and tables keep their end
        values beyond their range.

    Raises InvalidValue for a restitution outside 0 to 1 at any of these speeds, or speeds that do not rise,
    and InvalidType for one that is no number.
    """

    local_restitution: float | SpeedFunction | Points
    speeds: tuple[float, float] = field(default=(1e-5, 10.0), repr=False)
    code: ClassVar[int] = NEWTON
    units: ClassVar[dict[str, str]] = {"local_restitution": "[1]"}

    def __post_init__(self) -> None:
        given, name = self.local_restitution, "local_restitution"
        require_speeds(self.speeds)
        if isinstance(given, list | tuple | np.ndarray):
            given = require_points(name, given, "[1]")
            object.__setattr__(self, name, given)
        elif not callable(given):
            require_within(name, given, "[1]", low=0, high=1)
        for v, e in zip(*given, strict=True) if isinstance(given, tuple) else self.table[:2].T:
            if not 0.0 <= e <= 1.0:
                require_within(f"{name} at an approach speed of {v:g} m/s", e, "[1]", low=0, high=1)

    @property
    def numbers(self) -> tuple[float, float]:
        """The restitution, that at the lowest speed if it depends on the speed, and zero."""
        return (float(self.table[1, 0]), 0.0) if self.table.size else super().numbers

    @cached_property
    def table(self) -> np.ndarray:
        """Rows: speed, restitution and its slope, shape (3, n); of a constant restitution, shape (0, 0)."""
        given = self.local_restitution
        if callable(given):
            speed = np.geomspace(*self.speeds, SPEEDS)
            return np.array([speed, *sampled("local_restitution", given, speed)])
        if not isinstance(given, tuple):
            return np.empty((0, 0))
        from scipy.interpolate import PchipInterpolator  # slow to import

        speed, values = np.array(given)
        return np.array([speed, values, PchipInterpolator(speed, values)(speed, 1)])

    def moved(self, first: float, second: float) -> NewtonRestitution:
        """The law with its restitution moved by `first` at every speed."""
        return replace(self, local_restitution=raised(self.local_restitution, first))


@final
@dataclass(frozen=True, kw_only=True)
class LinearContact(ContactLaw):
    """Spring and dashpot at the stop: N = max(0, `stiffness` d + `damping` d') for d > 0.

    Parameters
    ----------
    stiffness : float
        k, above zero [N/m].
    damping : float
        c, zero or more [N s/m].
    """

    stiffness: float
    damping: float = 0.0
    code: ClassVar[int] = LINEAR
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m", "damping": "N s/m"}

    @staticmethod
    def with_restitution(*, stiffness: float, restitution: float, mass: float) -> LinearContact:
        """The law under which a free `mass` m [kg] leaves with `restitution` times its approach speed.

        `restitution` lies above 0 and is at most 1, and holds at every speed: c = 2 zeta sqrt(k m) with zeta
        of ``contact.damping_ratio``.  The tip of a modal model meets the stop with the mass 1/sum phi^2 of
        its modes; ``ModalModel.tip_mass`` is the limit for all modes.  If its modes move during the contact,
        the tip leaves with another restitution than the free mass.
        """
        elastic = LinearContact(stiffness=stiffness)
        mass = require_within("mass", mass, "kg", above=0)
        damping = 2.0 * damping_ratio(restitution) * math.sqrt(elastic.stiffness * mass)
        return replace(elastic, damping=damping)


@final
@dataclass(frozen=True, kw_only=True)
class HertzContact(ContactLaw):
    """Elastic contact of a ball: N = `stiffness` d^(3/2) for d > 0.

    Parameters
    ----------
    stiffness : float
        k, above zero [N/m^1.5].
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
        """A ball of `radius` [m] on a plate: k = (4/3) sqrt(R) / ((1 - nu^2)/E + (1 - nu'^2)/E')
        [N/m^1.5]."""
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
        """Depth that a free `mass` [kg] reaches at approach `velocity` [m/s]: (5 m v^2 / (4 k))^(2/5) [m]."""
        require_within("mass", mass, "kg", above=0)
        require_within("velocity", velocity, "m/s", above=0)
        return float((1.25 * mass * velocity**2 / self.stiffness) ** 0.4)

    def contact_time(self, mass: float, velocity: float) -> float:
        """Duration of the contact of a free `mass` [kg] at approach `velocity` [m/s] [s]."""
        return HERTZ_TIME * self.greatest_approach(mass, velocity) / velocity


@final
@dataclass(frozen=True, kw_only=True)
class HuntCrossley(ContactLaw):
    """Hertz's law with dissipation: N = `stiffness` d^(3/2) (1 + `dissipation` d') for d > 0.

    The law as its authors have it: for d' < -1/chi the force would pull, which a free mass never reaches but
    a heavily damped tip that is torn off the stop can.  A free mass leaves with v_out given by
    a - ln(1 + a) = -b - ln(1 - b), a = chi v_in, b = chi v_out.

    Parameters
    ----------
    stiffness : float
        k, above zero [N/m^1.5].
    dissipation : float
        chi, zero or more [s/m].
    """

    stiffness: float
    dissipation: float
    code: ClassVar[int] = POWER
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^1.5", "dissipation": "s/m"}
    table = HertzContact.table

    @staticmethod
    def with_restitution(*, stiffness: float, restitution: float, velocity: float) -> HuntCrossley:
        """The law under which a free mass with approach `velocity` [m/s] leaves with `restitution` times it.

        `restitution` lies above 0 and is at most 1; the relation is exact, for any exponent of d.  It holds
        at this speed only: slower masses leave with more of their speed, faster ones with less.  Under
        ``PowerContact.with_restitution`` the restitution holds at every speed.
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
