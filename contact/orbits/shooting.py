"""Periodic orbits of any contact law, by shooting from touch to touch.

`Shooting` finds an orbit by Newton's method next to another one (``contact.orbits.families.equations``).  Its
folds, and all its orbits at one amplitude, are found by following the branch
(``contact.orbits.branches.folds``).
"""

import math
from itertools import pairwise

from beam.parameters import record, require_within
from contact.orbits.branches.amplitude_curve import branch_ended, whole_branch
from contact.orbits.branches.events import Arc
from contact.orbits.branches.folds import lowest_fold
from contact.orbits.families.newton_family import NewtonFamily
from contact.orbits.families.touch_orbit import PeriodicOrbit


@record
class Shooting(NewtonFamily):
    """The family of periodic orbits under any contact law, by shooting.

    Its orbits have a given number of touches in a given number of drive periods.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven oscillator with one stop and without constant load; its drive amplitude does not matter.
    m : int
        Period of the orbits in drive periods, one or more.
    impacts : int, optional
        Touches in one such period, one or more.

    Raises
    ------
    TypeError
        If `oscillator` is no ImpactOscillator, or `m` or `impacts` is no number.
    ValueError
        If the oscillator has several stops, a constant load, or no drive that moves the tip.  If `m` or
        `impacts` is no whole number of one or more.

    See Also
    --------
    MaximalFamily : Orbits under Newton's law in closed form.
    KickFamily : Orbits under any law from one simulated collision.
    fold_of : The fold, also from an orbit close to it.
    follow : The branch of orbits with all its events.

    Examples
    --------
    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop
    >>> from contact.orbits import Shooting
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> law = LinearContact.with_restitution(stiffness=1e7, restitution=0.3, mass=1.0)
    >>> stop, drive = Stop(gap=11.9e-3, law=law), HarmonicDrive(frequency=21.5)
    >>> family = Shooting(oscillator=ImpactOscillator(model=spring, stop=stop, drive=drive), m=4)
    >>> print(f"{family.fold().excess:.4f}")
    -0.0073
    >>> [(f"{orbit.speed:.2f} m/s", orbit.stable) for orbit in family.orbits(-5e-3)]
    [('0.26 m/s', False), ('0.74 m/s', True)]
    """

    def orbits(self, excess: float) -> tuple[PeriodicOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising approach speed, on the whole branch.

        The branch is searched from 1e-6 to 100 times 2 pi f gap.  BranchEnded is raised if it is lost, or if
        another orbit lies beyond these speeds.
        """
        require_within("excess", excess, "[1]", above=-1)
        curve, points, branch = whole_branch(self, None)
        found = []
        for last in (branch.orbits[0], branch.orbits[-1]):
            fast, slow = (math.isclose(last.speed, bound) for bound in (curve.fastest, curve.slowest))
            to_graze = slow and self.impacts == 1 and 0.0 < excess / last.excess < 1.0
            if to_graze or (fast and last.excess < excess):
                raise branch_ended(last, f"an orbit at excess {excess:g} is beyond the speeds of the search")
        for start, end in pairwise(points):
            a, b = (point.oriented(end.x - start.x) for point in (start, end))
            turns = [Arc(curve, a, b).root(lambda point: point.rate)] if a.rate * b.rate < 0.0 else []
            for c, d in pairwise([a, *turns, b]):  # both sides of a fold may have an orbit
                if (c.orbit.excess - excess) * (d.orbit.excess - excess) < 0.0:
                    found.append(Arc(curve, c, d).root(lambda point: point.orbit.excess - excess).orbit)
        return tuple(sorted(found, key=lambda orbit: orbit.speed))

    def fold(self) -> PeriodicOrbit | None:
        """The orbit of least amplitude at which two orbits meet; None if the branch has none."""
        return lowest_fold(self)[0]
