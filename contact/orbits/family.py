"""What all families of periodic orbits share, whatever describes the motion.

A family holds the orbits of period m with one collision, or a given number of touches, in m drive periods. It
is a curve, told by the approach speed v of the first touch; over the excess F/F_g - 1 it turns round at its
fold, where a node and a saddle meet. Four descriptions offer it:

    ``single_impact.MaximalFamily``      Newton's law, several modes, closed form
    ``kick.KickFamily``                  any law, the collision as a kick of all modes
    ``shooting.Shooting``                any law, any number of touches, Newton's method on exact tangents
    ``contact.maximal_orbits.MapFamily`` the Nordmark map, closed form; its "speed" is sqrt(x) at the impact
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from contact.flight.crossing import CROSSES, FREE, first_crossing
from contact.flight.modal_flow import flow_over
from contact.flight.motion import Motion

__all__ = ["Family", "Orbit", "ends_in_touch", "modal_flow", "sorted_multipliers"]

Array = NDArray[np.float64]
CLOSING = 1e-9  # part of a flight by which it is prolonged, so that the touch at its end is met


class Orbit(Protocol):
    """A periodic orbit with impacts."""

    @property
    def period(self) -> int:
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
    """The orbits of one period, in one description."""

    @property
    def period(self) -> int:
        """m, in drive periods."""

    def orbit(self, speed: float) -> Orbit:
        """The orbit with approach speed `speed` [m/s]."""

    def orbits(self, excess: float) -> tuple[Orbit, ...]:
        """The orbits at F/F_g - 1 = `excess`, by rising speed."""

    def fold(self) -> Orbit | None:
        """The orbit of least amplitude, at which node and saddle meet; None if there is none."""


def modal_flow(motion: Motion, time: float) -> Array:
    """Free flow (u, u') -> (u, u') of each mode over `time` [s], of either sign, shape (n_modes, 2, 2)."""
    flows: Array = flow_over(motion, time)[:, :4].reshape(-1, 2, 2)
    return flows


def ends_in_touch(
    motion: Motion, start: float, state: tuple[Array, Array], length: float, *, leaves: bool, slack: float
) -> bool:
    """Whether a flight from the wall meets it at its end only (certified; a graze counts as a meeting).

    Parameters
    ----------
    start, length : float
        Drive time of its start, and its duration [s].
    state : (ndarray, ndarray)
        Deviations (u, u') at its start, shape (n_modes,) each.
    leaves : bool
        Whether the tip has a velocity away from the wall there, or is at rest.
    slack : float
        Time by which the touch may miss the end [s].
    """
    u, v = (part.copy() for part in state)
    outcome, time = first_crossing(motion, start, u, v, length * (1.0 + CLOSING), 1 if leaves else 2)
    return bool(outcome == FREE or (outcome == CROSSES and abs(time - length) <= slack))


def sorted_multipliers(matrix: Array) -> NDArray[np.complex128]:
    """Eigenvalues of a square matrix, largest modulus first."""
    values = np.linalg.eigvals(matrix).astype(complex)
    return np.asarray(values[np.argsort(-np.abs(values))])
