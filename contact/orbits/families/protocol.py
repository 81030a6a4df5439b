"""The common properties of all families of periodic orbits, whatever describes the motion.

A family holds the orbits of period m with one collision, or a given number of touches, in m drive periods.
It is a curve over the approach speed v of the first touch.  Over the excess F/F_g - 1 it turns round at its
fold, where a node and a saddle meet.  ``contact.orbits.families`` lists three descriptions.  A fourth is
``contact.maps.nordmark_orbits.MapFamily``, whose "speed" is sqrt(x) at the impact.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class Orbit(Protocol):
    """A periodic orbit with impacts, in any description.

    This is a protocol: every class with these properties is such an orbit.
    """

    @property
    def m(self) -> int:
        """m, in drive periods."""

    @property
    def excess(self) -> float:
        """F/F_g - 1 [1]."""

    @property
    def speed(self) -> float:
        """Approach speed of the first touch [m/s]."""

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers, largest modulus first."""

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""

    @property
    def admissible(self) -> bool:
        """Whether the tip touches the stop at the impacts of the orbit only."""


class Family(Protocol):
    """The periodic orbits of one period, in any description.

    This is a protocol: every class with these methods is such a family.  `MaximalFamily`, `KickFamily`,
    `Shooting` and ``contact.MapFamily`` are.
    """

    @property
    def m(self) -> int:
        """m, in drive periods."""

    def orbit(self, speed: float) -> Orbit:
        """The orbit with approach speed `speed` [m/s]."""

    def orbits(self, excess: float) -> tuple[Orbit, ...]:
        """The orbits at F/F_g - 1 = `excess`, by rising speed."""

    def fold(self) -> Orbit | None:
        """The orbit of least amplitude, at which node and saddle meet; None if there is none."""
