"""Periodic orbits with any number of touches, found by shooting."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from beam.parameters import Array
from contact.orbits.families.family import Release, TouchOrbit
from contact.simulation import simulate
from contact.trajectory import ImpactKind

ALIKE = 1e-5
"""Difference between touches that is taken for none.  Behind a branch point touches part in proportion to the
distance, and the equations are singular up to about this distance."""

SLACK = 1e-6
"""Part of a drive period by which the touch that closes an orbit may miss it, in addition to the residual."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PeriodicOrbit(TouchOrbit):
    """An orbit from shooting.  Its fields are those of `TouchOrbit` and the following.

    Parameters
    ----------
    record : ndarray, shape (impacts, 4 + 2 n_modes)
        Its touches, as in ``contact.sensitivity.touch_flow``.
    tangent : ndarray, shape (2 n_modes, 2 n_modes)
        Its monodromy matrix.
    slope : float
        Change of the excess with the approach velocity along the family [s/m].
    residual : float
        What is left of the equations, in units of the gap.
    """

    record: Array = field(repr=False)
    tangent: Array = field(repr=False)
    slope: float
    residual: float

    @property
    def impacts(self) -> int:
        """Touches in one period."""
        return len(self.record)

    @property
    def approach(self) -> Array:
        """Approach velocities of all touches in one period, shape (impacts,) [m/s]."""
        return self.record[:, 2]

    @cached_property
    def touches(self) -> int:
        """Touches in one period of the motion simulated from the first touch on.

        This is the number `impacts` if the orbit is `admissible`.
        """
        hits = simulate(self.oscillator, self.state(), periods=self.period).impacts
        closing = (1.0 - SLACK) * self.duration
        return int(np.count_nonzero((hits.kind == ImpactKind.IMPACT) & (hits.start - self.phase < closing)))

    def repeats(self, within: float = ALIKE) -> int:
        """How often the orbit runs through one of a shorter period: 1 for most.

        Times and speeds of its touches must agree `within` this part of the largest.
        """
        k, rows, shift = self.impacts, self.record[:, :4], np.zeros(4)
        for times in (times for times in range(k, 1, -1) if k % times == self.period % times == 0):
            shift[:2] = self.duration / times
            off = np.abs(rows[k // times :] - shift - rows[: -(k // times)])
            if np.all(off <= within * np.max(np.abs(rows), axis=0)):
                return times
        return 1

    def monodromy(self) -> Array:
        """The monodromy matrix, shape (2 n_modes, 2 n_modes)."""
        return self.tangent

    def release(self) -> Release:
        """The end of the last touch; its slack grows with the residual."""
        n, last = self.oscillator.n_modes, self.record[-1]
        off = 4.0 * self.residual * self.oscillator.stop.gap / self.record[0, 2]
        slack = SLACK * self.oscillator.period + off
        return Release(float(last[1]), last[4 : 4 + n], last[4 + n :], bool(last[3] < 0.0), slack)
