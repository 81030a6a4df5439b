"""A p_m orbit of Eq. (1) at a drive frequency: its fold, the effect of noise there, its strobes.

Next to a fold the m-th iterate is the normal form eta' = eta + (K/4)(x - x_fold) - eta^2 of one coordinate,
in which K is the one number of the orbit: its multiplier there obeys (1 - lambda)^2 = K (x - x_fold), x the
excess.  Noise e_j of the m periods moves the excess by their sum with weights w_j/(sum w), w_j how far e_j
moves the critical coordinate: the left eigenvector of the multiplier 1 times what is left of b_j at the end.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contact import MaximalFamily, StroboscopicMap
from contact.orbits import fold_excess, strobe_derivatives
from studies.shell.scene import Scene, nordmark_at, single_mode_at

BESIDE = 1e-3  # how far from the fold, in speed, a multiplier gives K: it is then good to 1e-3


@dataclass(frozen=True, kw_only=True, eq=False)
class Place:
    """p_m of Eq. (1) at a drive frequency."""

    scene: Scene
    m: int
    frequency_hz: float

    @cached_property
    def strobed(self) -> StroboscopicMap:
        """Its period map, at grazing."""
        oscillator = single_mode_at(self.scene, self.frequency_hz)
        return StroboscopicMap(oscillator=oscillator.with_excess(0.0))

    @cached_property
    def family(self) -> MaximalFamily:
        """The orbits p_m."""
        return MaximalFamily.from_oscillator(self.strobed.oscillator, m=self.m)

    @cached_property
    def map_fold(self) -> float | None:
        """The excess of the fold in Nordmark's map [1]."""
        return fold_excess(nordmark_at(self.scene, self.frequency_hz), self.m)

    @cached_property
    def fold(self) -> Any:
        """The orbit at the fold; None where there is none below grazing."""
        found = self.family.fold()
        return found if found is not None and found.excess < 0.0 else None

    def stable(self, excess: float) -> Any:
        """A strobe of the stable p_m at `excess`, or None."""
        orbits = (one for one in self.family.orbits(excess) if one.stable and one.admissible)
        return next((one.strobe_state() for one in orbits), None)

    @cached_property
    def steepness(self) -> float:
        """K [1]."""
        beside = self.family.orbit(self.fold.speed * (1.0 + BESIDE))
        return float((1.0 - beside.multipliers.real.max()) ** 2 / (beside.excess - self.fold.excess))

    @cached_property
    def unevenness(self) -> float:
        """Standard deviation of the weighted mean of the e_j over their own: 1/sqrt(m) or more."""
        steps = strobe_derivatives(self.strobed.at(self.fold.excess), self.fold.strobe_state(), self.m)
        whole = np.eye(len(steps[0][1]))
        for step, _pull in steps:
            whole = step @ whole
        values, left = np.linalg.eig(whole.T)
        row, weights = left[:, np.argmin(np.abs(values - 1.0))].real, []
        for step, pull in reversed(steps):
            weights.append(row @ pull)
            row = row @ step
        return float(np.sqrt(np.sum(np.square(weights))) / abs(np.sum(weights)))
