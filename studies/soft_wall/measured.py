"""What is measured at one wall and one frequency: kick of a collision, period doubling of p1, end of p_m."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact import ContactError, MaximalFamily, StroboscopicMap, first_collision, maximal_period
from contact.orbits import PeriodicOrbit, Shooting, fold_of, follow, orbit_end, settle
from studies.scene import Scene, nordmark_at, single_mode_at
from studies.soft_wall.closed_forms import SoftWall

__all__ = ["Case", "Doubling", "End", "Kick", "doubling_of", "end_of", "kicks_of"]

SMALL = 1e-4
"""Peak, over that of the crossover, at which p1 is looked at where it is unstable from its first touch on."""

SPAN = 3.0
"""The doubling is looked for between a third and three times the approach velocity that the formula gives."""

SIDES, NUDGE = 0.02, 1e-2
"""Relative distance from the doubling at which motions are settled; where they start, in heights of the peak
off p1."""

LEAST_PEAK = 1e-10
"""Peak in gaps below which that is not done: orbits differ by a hundredth of it, 1e4 roundings."""

GONE = 6000
"""Drive periods after which a transient that alternates and falls by a percent a period no longer looks like
p2."""

OTHERS = 1e-4
"""At a fold one multiplier is 1 to the root of rounding; none may be larger."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One wall at one frequency."""

    scene: Scene
    frequency_hz: float
    hardness: float
    zeta: float = 0.0

    @cached_property
    def wall(self) -> SoftWall:
        """With its closed forms."""
        oscillator = single_mode_at(self.scene, self.frequency_hz)
        return SoftWall(oscillator=oscillator, hardness=self.hardness, zeta=self.zeta)

    def __str__(self) -> str:
        return f"{self.frequency_hz:g} Hz, K = {self.hardness:g}, {self.wall.name}"


@dataclass(frozen=True, kw_only=True)
class Row:
    """Where a row belongs; `case` is "lossless" or "dashpot"."""

    frequency_hz: float
    hardness: float
    case: str


@dataclass(frozen=True, kw_only=True)
class Kick(Row):
    """Kick velocity of the collision that ends the motion without impacts at `excess` [m/s]."""

    excess: float
    kick_velocity: float
    closed_form: float | None
    soft_law: float
    hard_law: float


@dataclass(frozen=True, kw_only=True)
class Doubling(Row):
    """The period doubling of p1: `excess` by shooting, 0 where p1 is unstable from its first touch on, None
    without one; periods on which motions settle just below and above it (0: on none, None: not tried)."""

    excess: float | None
    closed_form: float | None
    limit: float | None
    peak_closed_form: float | None
    least_multiplier: float | None
    grazing_multiplier: float | None
    period_below: int | None
    period_above: int | None


@dataclass(frozen=True, kw_only=True)
class End(Row):
    """The fold of p_m with one touch: of this wall, of the hard wall, and as bracketed by a downward scan."""

    period: int
    excess: float | None
    hard_wall: float | None
    shift: float | None
    scanned: float | None
    reason: str


def kicks_of(case: Case, excesses: np.ndarray) -> list[Kick]:
    """The measured kicks, the closed form and the two power laws."""
    wall = case.wall
    return [
        Kick(
            frequency_hz=case.frequency_hz, hardness=case.hardness, case=wall.name, excess=e,
            kick_velocity=first_collision(wall.struck.with_excess(e)).kick_velocity,
            closed_form=None if case.zeta else wall.kick(e), soft_law=wall.soft_law(e),
            hard_law=wall.hard_law(e),
        )
        for e in excesses.tolist()
    ]  # fmt: skip


def doubling_of(case: Case) -> Doubling:
    """Period doubling of p1 by shooting, beside the formulas, with settled motions on both sides."""
    wall = case.wall
    orbit: PeriodicOrbit | None
    peak, leading = wall.doubling_peak(), wall.leading_doubling()
    family = Shooting(oscillator=wall.struck, period=1)
    grazing, below, above = None, None, None
    if peak == 0.0:  # p1 far below the crossover
        near = max(SMALL * wall.crossover, 1e-11)
        orbit = family.at_speed(speed_at(wall, near))
        grazing, excess = wall.grazing_multiplier, 0.0 if least_of(orbit) < -1.0 else None
    else:
        speed = speed_at(wall, peak or leading[0])
        branch = follow(
            family, family.at_speed(speed), low=speed / SPAN, high=SPAN * speed, step=math.log(SPAN)
        )
        orbit = next(iter(branch.of_kind("period doubling")), None)
        excess = None if orbit is None else orbit.excess
        if orbit is not None and (peak or leading[0]) >= LEAST_PEAK:
            below, above = (settles_on(family, orbit, sign) for sign in (-1.0, 1.0))
    return Doubling(
        frequency_hz=case.frequency_hz, hardness=case.hardness, case=wall.name, excess=excess,
        closed_form=None if peak is None else wall.excess_of(peak) if peak else 0.0,
        limit=None if case.zeta else leading[1], peak_closed_form=peak, grazing_multiplier=grazing,
        least_multiplier=None if orbit is None else least_of(orbit), period_below=below, period_above=above,
    )  # fmt: skip


def speed_at(wall: SoftWall, peak: float) -> float:
    """Approach velocity at which a parabola of height `peak` gaps meets the wall [m/s]."""
    return math.sqrt(2.0 * wall.deceleration * peak * wall.gap)


def least_of(orbit: PeriodicOrbit) -> float:
    """The most negative real part of its multipliers."""
    return float(np.min(orbit.multipliers.real))


def settles_on(family: Shooting, orbit: PeriodicOrbit, side: float) -> int | None:
    """Period on which a motion near p1 settles on this side of the doubling `orbit`; None if it is lost."""
    excess, gap = orbit.excess * (1.0 + side * SIDES), family.oscillator.stop.gap
    here = StroboscopicMap(oscillator=family.oscillator).at(excess)
    peak = 0.5 * (orbit.speed / (2.0 * math.pi / family.oscillator.period * gap)) ** 2
    try:
        start = family.at_excess(excess, orbit).strobe_state()
        moved = replace(start, displacement=start.displacement + NUDGE * peak * gap, time=0.0)
        gone = here.orbit(moved, GONE).end
        return settle(here, gone, most_cycles=GONE, tolerance=1e-3 * peak, prove=False).period
    except ContactError:
        return None


def end_of(case: Case, *, scan: bool = True) -> End:
    """Where the p_m orbit with one touch ends, m as at that frequency in the map."""
    wall = case.wall
    period = maximal_period(nordmark_at(case.scene, case.frequency_hz))
    hard = MaximalFamily.from_oscillator(wall.oscillator, period=period, restitution=wall.restitution).fold()
    fold, reason = None, "the branch has no fold"
    try:
        fold = fold_of(Shooting(oscillator=wall.struck, period=period))
    except ContactError as error:
        reason = str(error)
    if fold is not None and fold.excess >= 0.0:
        fold, reason = None, "the fold lies above grazing"
    elif fold is not None and (not fold.admissible or abs(fold.multipliers[0]) > 1.0 + OTHERS):
        fold, reason = None, "at the fold the orbit touches again, or is unstable"
    limit = hard.excess if hard is not None and hard.admissible else None
    scanned = None
    if fold is not None and scan:
        start = fold.excess + 0.05 * abs(fold.excess)
        end = orbit_end(
            StroboscopicMap(oscillator=wall.struck), replace(fold.strobe_state(), time=0.0), start,
            most_cycles=20000, relative=5e-3, absolute=1e-10, first_step=0.01 * abs(fold.excess),
        )  # fmt: skip
        same = end is not None and (end.period, end.impacts) == (period, 1)
        scanned = 0.5 * (end.held + end.lost) if end is not None and same else None
    return End(
        frequency_hz=case.frequency_hz, hardness=case.hardness, case=wall.name, period=period,
        excess=None if fold is None else fold.excess, hard_wall=limit,
        shift=None if fold is None or limit is None else fold.excess - limit, scanned=scanned,
        reason="" if fold is not None else reason,
    )  # fmt: skip
