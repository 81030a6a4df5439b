"""What the study of the soft wall measures at one wall and one frequency, and along K.

Kick of one collision, period doubling of p1, end of p_m; the closed forms beside them are in `soft_impact`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.errors import ContactError
from contact.orbits.ends import orbit_end
from contact.orbits.settling import settle
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies.instruments.oscillators import nordmark_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.soft_wall.contact_orbits import ContactOrbit, SoftMap, doubling, fold_of
from studies.instruments.soft_wall.hertz_smoothing import (
    collision_above,
    reach_of,
)
from studies.instruments.soft_wall.soft_impact import SoftImpact

SMALL, LARGE = 1e-4, 100.0
"""Local powers are read at these multiples of the crossover."""

NEAR_GRAZING = 0.05
"""Largest excess at which a collision counts as near grazing: a varies by as much over the arc."""

HARDEST = 1e8
"""The fold is followed in K from here down: there the hard wall's orbit is a good guess."""

SIDES = 0.02
"""Relative distance from the period doubling at which motions are settled."""

NUDGE = 1e-2
"""Distance from p1 at which they start, in heights of its peak over the wall."""

LEAST_PEAK = 1e-10
"""Peak in gaps below which that is not done: orbits differ by a hundredth of it, 1e4 roundings."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One wall at one frequency."""

    scene: Scene
    frequency: float
    hardness: float
    zeta: float

    @property
    def name(self) -> str:
        return "dashpot" if self.zeta > 0.0 else "lossless"

    @property
    def oscillator(self) -> ImpactOscillator:
        return single_mode_oscillator(self.scene, self.frequency)

    @property
    def wall(self) -> SoftImpact:
        return SoftImpact.of_mode(self.oscillator, hardness=self.hardness, zeta=self.zeta)


def kick_at(case: Case, excess: float) -> float:
    """Kick velocity of the collision that ends the motion without impacts at `excess` [m/s]."""
    return collision_above(SoftMap.of(case.oscillator, case.wall).oscillator, excess).kick_velocity


def powers(case: Case) -> dict[str, Any]:
    """Local powers of the measured kick below and above the crossover, and where the measured laws cross."""
    crossover = case.wall.crossover
    below, above = max(SMALL * crossover, 1e-9), LARGE * crossover
    step = 1.2
    low, low_next = kick_at(case, below), kick_at(case, below * step)
    found: dict[str, Any] = {
        "slope_below": math.log(low_next / low) / math.log(step),
        "slope_below_theory": case.wall.local_power(below * math.sqrt(step)),
        "prefactor_below": low / case.wall.soft_law(below),
        "slope_above": None,
        "slope_above_theory": None,
        "prefactor_above": None,
        "crossover_measured": None,
    }
    if above <= NEAR_GRAZING:
        high, high_next = kick_at(case, above), kick_at(case, above * step)
        found["slope_above"] = math.log(high_next / high) / math.log(step)
        found["slope_above_theory"] = case.wall.local_power(above * math.sqrt(step))
        found["prefactor_above"] = high / case.wall.hard_law(above)
    if crossover <= NEAR_GRAZING:
        # where the kick is that part of the hard wall's which the closed form has at the crossover
        share = case.wall.kick(crossover) / case.wall.hard_law(crossover)
        found["crossover_measured"] = reach_of(
            lambda e: kick_at(case, e) / case.wall.hard_law(e) - share, 0.3 * crossover, 3.0 * crossover
        )
    return found


def curve_of(case: Case, excesses: np.ndarray) -> dict[str, Any]:
    """Measured kicks, the closed form and the two power laws."""
    wall = case.wall
    measured = np.array([kick_at(case, float(e)) for e in excesses])
    soft = np.array([wall.soft_law(float(e)) for e in excesses])
    return {
        "K": case.hardness,
        "case": case.name,
        "excess": excesses,
        "kick_velocity": measured,
        "soft_law": soft,
        "hard_law": np.array([wall.hard_law(float(e)) for e in excesses]),
        "closed_form": np.array([wall.kick(float(e)) for e in excesses]),
        "rate_of_error": rate_of_error(excesses, np.abs(measured / soft - 1.0)),
    }


def rate_of_error(excesses: np.ndarray, error: np.ndarray) -> float | None:
    """Power of h with which the relative error against the law of small peaks vanishes."""
    chosen = (error > 1e-4) & (error < 0.05)
    if np.count_nonzero(chosen) < 3:
        return None
    return float(np.polyfit(np.log(excesses[chosen]), np.log(error[chosen]), 1)[0])


def doubling_of(case: Case) -> dict[str, Any]:
    """Period doubling of p1: formulas, the simulated map, settled motions on both sides."""
    wall = case.wall
    peak = wall.doubling_peak()
    theory = None if peak is None else wall.excess_of(peak)
    leading = wall.leading_doubling()
    soft = SoftMap.of(case.oscillator, wall)
    row: dict[str, Any] = {
        "h_f_theory": peak if case.zeta else leading[0],
        "h_f_closed_form": peak,
        "excess_pd_leading": leading[1] if case.zeta == 0.0 else None,
        "excess_pd_theory": theory,
        "excess_pd_measured": None,
        "unstable_from": None,
        "grazing_multiplier": None,
        "period_below": None,
        "period_above": None,
        "least_multiplier": None,
    }
    scale = theory if theory else leading[1]
    if peak == 0.0:
        # p1 is unstable as soon as it touches: its multiplier at a peak far below the crossover
        start = wall.excess_of(max(SMALL * wall.crossover, 1e-11))
        found = soft.fixed_point(start, soft.guess_at(start))
        least = float(np.min(found.multipliers.real))
        row |= {
            "least_multiplier": least,
            "grazing_multiplier": wall.grazing_multipliers[0].real,
            "unstable_from": start if least < -1.0 else None,
            "excess_pd_measured": 0.0 if least < -1.0 else None,
        }
        return row
    found_or_none = doubling(soft, 0.2 * scale, min(5.0 * scale, 0.5), 24)
    if found_or_none is None:
        return row
    row["excess_pd_measured"] = found_or_none.excess
    row["least_multiplier"] = float(np.min(found_or_none.multipliers.real))
    return row | sides_of(soft, found_or_none)


def sides_of(soft: SoftMap, orbit: ContactOrbit, cycles: int = 6000) -> dict[str, int | None]:
    """Periods on which motions near p1 settle just below and just above its period doubling (0: on none).

    None where the peak over the wall is too small to tell orbits apart above rounding.
    """
    strobed = StroboscopicMap(oscillator=soft.oscillator)
    found: dict[str, int | None] = {"period_below": None, "period_above": None}
    peak = orbit.excess * soft.wall.leading_doubling()[0] / soft.wall.leading_doubling()[1]
    if peak < LEAST_PEAK:
        return found
    for name, sign in (("period_below", -1.0), ("period_above", 1.0)):
        excess = orbit.excess * (1.0 + sign * SIDES)
        try:
            start = soft.fixed_point(excess, orbit.deviation).deviation + np.array([NUDGE * peak, 0.0])
            # a transient that alternates and falls by a percent a period looks like p2 until it is gone
            here = strobed.at(excess)
            gone = here.orbit(soft.state(excess, start), cycles).end
            found[name] = settle(here, gone, most_cycles=cycles, tolerance=1e-3 * peak, prove=False).period
        except ContactError:
            continue
    return found


def hysteresis_chain(
    scene: Scene, frequency: float, zeta: float, hardnesses: Sequence[float], scan: bool
) -> tuple[dict[float, dict[str, Any]], dict[str, float | None]]:
    """The fold of p_m for each K, followed from the hard wall down, and the end of the orbit in a scan.

    Second, the powers of K with which the distance from the hard wall, and what the closed form leaves of it,
    vanish over the hardest decade.
    """
    tail: dict[float, tuple[float, float]] = {}
    oscillator = single_mode_oscillator(scene, frequency)
    period = math.ceil(math.pi / nordmark_of(scene, frequency).angle)
    restitution = scene.single_mode.restitution if zeta > 0.0 else 1.0
    hard = MaximalFamily.from_oscillator(oscillator, period=period, restitution=restitution).fold()
    nothing = {
        "period": period,
        "hysteresis": None,
        "hysteresis_hard": None if hard is None else hard.excess,
        "hysteresis_shift": None,
        "hysteresis_theory": None,
        "hysteresis_scan": None,
        "hysteresis_none": None if hard is not None else "the hard wall has no fold",
    }
    found = {K: dict(nothing) for K in hardnesses}
    if hard is None:
        return found, {"shift": None, "remainder": None}
    chain = sorted({HARDEST, *np.geomspace(HARDEST, 10.0, 15).tolist(), *hardnesses}, reverse=True)
    q, v = hard.state(1.0 / frequency)
    orbit: ContactOrbit | None = None
    reached = math.inf
    for K in chain:
        wall = SoftImpact.of_mode(oscillator, hardness=K, zeta=zeta)
        soft = SoftMap.of(oscillator, wall, period)
        if orbit is None:
            guess, excess = soft.deviation(hard.excess, State(displacement=q, velocity=v)), hard.excess
        else:
            guess, excess = orbit.deviation, orbit.excess
        try:
            orbit = fold_of(soft, excess, guess)
        except ContactError:
            break
        if orbit.touches != 1 or np.max(np.abs(orbit.multipliers)) > 1.0 + 1e-4:
            break
        if K >= 0.099 * HARDEST:
            tail[K] = orbit.excess - hard.excess, orbit.excess - wall.fold_excess(period)
        reached = K
        if K not in found:
            continue
        row: dict[str, Any] = {
            "hysteresis": orbit.excess,
            "hysteresis_shift": orbit.excess - hard.excess,
            "hysteresis_theory": wall.fold_excess(period),
        }
        if scan:
            row["hysteresis_scan"] = scanned(soft, orbit)
        found[K] |= row
    reason = f"followed down in K, the orbit ends between {reached:.3g} and the next smaller K tried"
    if math.isinf(reached):
        first = SoftImpact.of_mode(oscillator, hardness=HARDEST, zeta=zeta)
        soft = SoftMap.of(oscillator, first, period)
        start = soft.deviation(hard.excess, State(displacement=q, velocity=v))
        touches = soft.advance(hard.excess, start).touches
        reason = f"started on the hard wall's orbit, the motion meets the wall {touches} times in its period"
    for K in hardnesses:
        if K < reached:
            found[K]["hysteresis_none"] = reason
    return found, fitted_exponents(tail)


def fitted_exponents(tail: Mapping[float, tuple[float, float]]) -> dict[str, float | None]:
    """Powers of K in the two columns of `tail`."""
    if len(tail) < 2:
        return {"shift": None, "remainder": None}
    hardness, columns = np.log(list(tail)), np.log(np.abs(list(tail.values())))
    shift, remainder = (float(np.polyfit(hardness, column, 1)[0]) for column in columns.T)
    return {"shift": shift, "remainder": remainder}


def scanned(soft: SoftMap, orbit: ContactOrbit) -> float | None:
    """End of the orbit in a downward scan that starts a little above its fold, the middle of a bracket of
    0.5 %."""
    start = orbit.excess + 0.05 * abs(orbit.excess)
    end = orbit_end(
        StroboscopicMap(oscillator=soft.oscillator),
        soft.state(start, orbit.deviation),
        start,
        most_cycles=20000,
        relative=5e-3,
        absolute=1e-10,
        first_step=0.01 * abs(orbit.excess),
    )
    return None if end is None or end.period != soft.period else 0.5 * (end.held + end.lost)


def row_of(case: Case, hysteresis: Mapping[str, Any]) -> dict[str, Any]:
    """One row of the table."""
    wall = case.wall
    row: dict[str, Any] = {
        "frequency_hz": case.frequency,
        "K": case.hardness,
        "case": case.name,
        "dashpot": case.zeta,
        "restitution": wall.restitution,
        "crossover_excess": wall.crossover,
        "half_kick_excess": wall.half_peak,
    }
    failures: list[str] = []
    for step in (powers, doubling_of):
        try:
            row |= step(case)
        except (ContactError, ValueError) as error:
            failures.append(f"{case.frequency:g} Hz, K = {case.hardness:g}, {case.name}: {error}")
    return row | dict(hysteresis) | {"failures": failures}


def theory_lines(scene: Scene, frequencies: Sequence[float]) -> list[dict[str, Any]]:
    """The two formulas for the lossless period doubling, on a fine grid of K."""
    found = []
    for frequency in frequencies:
        hardness = np.geomspace(10.0, 1e6, 121)
        walls = [
            SoftImpact.of_mode(single_mode_oscillator(scene, frequency), hardness=float(K)) for K in hardness
        ]
        peaks = [wall.doubling_peak() for wall in walls]
        found.append(
            {
                "frequency_hz": frequency,
                "K": hardness,
                "leading": [wall.leading_doubling()[1] for wall in walls],
                "closed_form": [
                    math.nan if h is None else w.excess_of(h) for w, h in zip(walls, peaks, strict=True)
                ],
            }
        )
    return found
