"""Periodic orbits of any contact law, by shooting from touch to touch.

`Shooting` finds an orbit by Newton's method next to another one (``contact.orbits.families.equations``).  Its
folds, and all its orbits at one amplitude, are found by following the branch
(``contact.orbits.branches.continuation``).
"""

from dataclasses import dataclass

from contact.orbits.branches.continuation import lowest_fold, orbits_at
from contact.orbits.families.continuable_family import ContinuableFamily
from contact.orbits.families.family import PeriodicOrbit


@dataclass(frozen=True, kw_only=True, eq=False)
class Shooting(ContinuableFamily):
    """The family of orbits with `impacts` touches in `period` drive periods, under any contact law.

    The drive amplitude of the `oscillator` does not matter.
    """

    def orbits(self, excess: float) -> tuple[PeriodicOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising approach speed, on the whole branch.

        The branch is searched from 1e-6 to 100 times 2 pi f gap.  BranchEnded is raised if it is lost, or if
        another orbit lies beyond these speeds.
        """
        return orbits_at(self, excess)

    def fold(self) -> PeriodicOrbit | None:
        """The orbit of least amplitude at which two orbits meet; None if the branch has none."""
        return lowest_fold(self)[0]
