"""Families of orbits found one from another, by Newton's method on the equations of an orbit.

The unknowns are the deviations (u, v) at the first touch, and its approach speed s through log s.  They give
the drive (S, C) by two linear equations: the tip is at the stop, y = 0, with velocity y' = s.  An orbit with
k touches in m drive periods then obeys 2 N equations for 2 N + 1 unknowns
(``contact.orbits.families.equations``).  With the approach speed the curve is single-valued through its fold
and down to grazing.
"""

import math
from dataclasses import replace
from functools import cached_property

import numpy as np

from beam.parameters import Array, record, require, require_kind, require_whole, require_within
from contact.errors import NotPeriodic
from contact.orbits.families.equations import STEEPEST, driven_at, shoot, sizes_of
from contact.orbits.families.kick import KickFamily
from contact.orbits.families.newton import Iterate, newton
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Sensitivities
from contact.simulation import simulate
from contact.state import ImpactKind, Regime, State


@record
class NewtonFamily:
    """The orbits with `impacts` touches in `m` drive periods; the `oscillator` has any amplitude."""

    oscillator: ImpactOscillator
    m: int
    impacts: int = 1

    def __post_init__(self) -> None:
        require_whole("impacts", self.impacts, "touches")
        _ = self.kicks

    @cached_property
    def kicks(self) -> KickFamily:
        """The description by kicks, from which a search starts."""
        return KickFamily(oscillator=self.oscillator, m=self.m)

    @cached_property
    def _sizes(self) -> Array:
        return sizes_of(self.oscillator)

    @cached_property
    def _drive(self) -> tuple[Array, Array]:
        """K, shape (2, 2 N + 1), and k: (S, C) = K (u, v, s) + k puts the tip on the stop with velocity s."""
        phi, response = self.oscillator.model.phi, self.oscillator.tip_response()
        still, w = np.zeros(phi.size), self.oscillator.driven.angular_frequency
        steady = np.array([[response.real, response.imag], [-w * response.imag, w * response.real]])
        rows = np.array([[*-phi, *still, 0.0], [*still, *-phi, 1.0]])
        return np.linalg.solve(steady, rows), np.linalg.solve(steady, [self.oscillator.stop.gap, 0.0])

    def unknowns(self, start: Array, speed: float) -> Array:
        """(u, v) in units of their sizes, and log v over 2 pi f gap, shape (2 n_modes + 1,)."""
        return np.append(start / self._sizes, math.log(speed / self.oscillator.unit_speed))

    def equations(self, x: Array) -> Iterate:
        """The equations of a closed orbit at these unknowns; the parameter of the curve is the excess."""
        (rows, offset), size, n = self._drive, x.size, x.size - 1
        speed, start = self.oscillator.unit_speed * math.exp(x[-1]), x[:-1] * self._sizes
        drive, grazing = rows @ np.append(start, speed) + offset, self.oscillator.grazing_amplitude()
        here, at = driven_at(self.oscillator, drive)
        orbit, miss, flow = shoot(Sensitivities(oscillator=here), at, start, self.m, self.impacts, speed)
        scale = np.append(self._sizes, speed)
        start_slope = np.vstack([np.eye(n, size), rows])
        closing = flow @ start_slope - np.eye(n, size)
        slopes = drive @ rows * scale / (orbit.amplitude * grazing), speed * np.eye(size)[-1]
        derivatives = closing * scale / self._sizes[:, None], *slopes, start_slope * scale
        return Iterate(orbit, miss / self._sizes, *derivatives)

    def _solve(self, x: Array, *, speed: float | None = None, excess: float = 0.0) -> PeriodicOrbit:
        """The orbit next to `x` with its approach speed, or with this excess [1]."""

        def pick(_there: Array, here: Iterate) -> tuple[float, Array]:
            if speed is not None:
                return 0.0, np.eye(x.size)[-1]
            return here.orbit.excess - excess, here.parameter_slope

        point = newton(self.equations, x, pick)
        if not abs(point.direction[-1]) * STEEPEST > 1.0:
            words = f"the orbits of period {self.m} do not follow from their approach velocity here"
            raise point.orbit.failure(NotPeriodic, words)
        return point.orbit if speed is None else replace(point.orbit, speed=speed)

    def at_speed(self, speed: float, near: PeriodicOrbit | None = None) -> PeriodicOrbit:
        """The orbit whose first touch has approach velocity `speed` [m/s].

        The search starts from the neighbour `near`, or else from the kick description.  NotPeriodic is raised
        if Newton's method finds no orbit.
        """
        require_within("speed", speed, "m/s", above=0)
        if near is not None:
            require_orbit(self, "near", near)
        start = (near or self.kicks.orbit(speed)).deviations
        return self._solve(self.unknowns(start, speed), speed=speed)

    orbit = at_speed  # its name in every family

    def at_excess(self, excess: float, near: PeriodicOrbit) -> PeriodicOrbit:
        """The orbit at F/F_g - 1 = `excess` that is next to `near`."""
        require_within("excess", excess, "[1]", above=-1)
        require_orbit(self, "near", near)
        return self._solve(self.unknowns(near.deviations, near.speed), excess=excess)

    def from_state(self, state: State) -> PeriodicOrbit:
        """The orbit on which a simulated motion has settled, next to its first touch from `state`."""
        require_kind("state", state, State, "a State")
        trajectory = simulate(self.oscillator, state, periods=self.m + 1)
        hits = trajectory.impacts.kind == ImpactKind.IMPACT
        hits[:1] &= state.regime == Regime.OUTSIDE  # a contact under way began with a touch that is not known
        if not np.any(hits):
            raise NotPeriodic(time=state.time, detail="the motion has no impact to start from")
        i = int(np.flatnonzero(hits)[0])
        start = self.unknowns(trajectory.impacts.deviations_start[i].ravel(), trajectory.impacts.approach[i])
        return self._solve(start, excess=self.oscillator.excess)


def require_family(family: NewtonFamily, near: object = None) -> None:
    """Refuse what is no family to follow, and a `near` that is neither an orbit near it nor None."""
    require_kind("family", family, NewtonFamily, "a Shooting family, such as Shooting(oscillator=..., m=4)")
    if near is not None:
        require_orbit(family, "near", near)


def require_orbit(family: NewtonFamily, name: str, orbit: object, *, member: bool = False) -> None:
    """Refuse what is no orbit, or one of other modes or of a period that does not divide that of the family.

    A `member` has the period and the touches of the family and, to rounding, its oscillator at any amplitude.
    """
    known: PeriodicOrbit = require_kind(name, orbit, PeriodicOrbit, "a PeriodicOrbit")
    pair = known.oscillator, family.oscillator
    m = known.m if family.m % known.m == 0 and not member else family.m
    counts = [("drive periods", known.m, m), ("modes", *(one.n_modes for one in pair))]
    for what, found, valid in [*counts, ("touches", known.impacts, family.impacts)][: 3 if member else 2]:
        require(found == valid, f"{name} has {found} {what}; it must have {valid}, like the family")
    numbers = zip(*(one.with_amplitude(1.0).numbers() for one in pair), strict=True)
    same = all(np.shape(a) == np.shape(b) and np.allclose(a, b, 1e-9, 1e-12) for a, b in numbers)
    words = "is not that of the family; it must be the same but for the amplitude of its drive"
    require(same or not member, f"oscillator of the {name} {words}")
