r"""A wall of finite hardness: how the square root is smoothed, and what orbit that adds at grazing.

Claim (letter 1996, last page): a wall "such that at impact the spring constant changes by a factor K >> 1" affects
the bifurcations close to grazing in a characteristic manner, to larger amplitudes the smaller K; the experiment did
not show it.

Computed, for Eq. (1) with a wall of K times the spring constant, without loss and with the dashpot that gives a hard
approach the letter's restitution, at each drive frequency and K = 10 ... 10^6:

    kick       of one collision against the peak h over the wall: J = (4/3) (K - 1) Omega^2 sqrt(2/a) h^(3/2) below
               h = (3/2) a/((K - 1) Omega^2), a = omega^2 gap, and the square root above; with a dashpot J = c h
    doubling   excess at which p1, which survives its first touch, loses stability by a multiplier -1: on the
               simulated period map, against  h_f [1 + (2/3)(1 + gamma + alpha)/(1 - alpha + gamma)],
               h_f = (omega^2/2) [(1 + gamma + alpha)/(2 M12 K Omega^2)]^2  for K -> infinity and against a closed
               form for finite K; settled motions on both sides
    hysteresis excess at which p_m ends, m as at that frequency in the map: fold of the simulated map, a downward
               scan, and the hard wall (closed form), from which it lies at a distance of order K^(-1/2)

and for the beam with Hertz contact the excess at which the kick leaves the square root, the orbit born below it and
whether the letter could have seen it.  Equations in `studies.instruments.soft_impact`, `contact_orbits` and
`hertz_smoothing`.

Run time: half a minute; --quick some seconds.  Command: python -m studies.soft_wall.  Outputs: summary.json,
rows.csv, kicks.csv, beam.csv, beam_born.csv; figures kick, doubling, hysteresis, beam (png and pdf).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact.errors import ContactError
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies.instruments.command_line import Request, run_study
from studies.instruments.contact_orbits import ContactOrbit, SoftMap, doubling, fold_of
from studies.instruments.fold_scan import orbit_end
from studies.instruments.hertz_smoothing import (
    HertzSmoothing,
    born_orbits,
    collision_above,
    doubling_excess,
    local_slope,
    reach_of,
)
from studies.instruments.oscillators import beam_of, hertz_of, nordmark_of, single_mode_oscillator
from studies.instruments.periodicity import settle
from studies.instruments.scene import Scene
from studies.instruments.soft_impact import SoftImpact, damping_ratio
from studies.instruments.soft_wall_figures import draw_beam, draw_doubling, draw_hysteresis, draw_kicks
from studies.instruments.spring_of_scene import model_of
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M, TIME_TRACE_EXCESS

SCHEMA = 1
RESOLUTION = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M
"""The letter's amplitude stability over its amplitude, 2.5e-4."""

HARDNESSES = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)
QUICK_HARDNESSES = (1e2, 1e4, 1e6)
SHOWN = 22.2
"""Frequency of the curves and of the beam, or the one of the scene nearest to it [Hz]."""

QUICK_FREQUENCIES = (22.2, 22.6)
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

LEAST_PEAK = 2e-11
"""Peak in gaps below which that is not done: its ten-thousandth part is ten roundings of the displacement."""


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


def powers(case: Case) -> dict[str, float | None]:
    """Local powers of the measured kick below and above the crossover, and where the measured laws cross."""
    crossover = case.wall.crossover
    below, above = max(SMALL * crossover, 1e-9), LARGE * crossover
    step = 1.2
    low, low_next = kick_at(case, below), kick_at(case, below * step)
    found: dict[str, float | None] = {
        "slope_below": math.log(low_next / low) / math.log(step),
        "slope_below_theory": case.wall.local_power(below * math.sqrt(step)),
        "prefactor_below": low / case.wall.soft_law(below),
        "slope_above": None, "slope_above_theory": None, "prefactor_above": None, "crossover_measured": None,
    }
    if above <= NEAR_GRAZING:
        high, high_next = kick_at(case, above), kick_at(case, above * step)
        found["slope_above"] = math.log(high_next / high) / math.log(step)
        found["slope_above_theory"] = case.wall.local_power(above * math.sqrt(step))
        found["prefactor_above"] = high / case.wall.hard_law(above)
    if crossover <= NEAR_GRAZING:
        # the peak at which the kick is the fraction of the smaller law that the closed form has at the crossover
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
        "K": case.hardness, "case": case.name, "excess": excesses, "kick_velocity": measured, "soft_law": soft,
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


def doubling_of(case: Case) -> tuple[dict[str, Any], ContactOrbit | None]:
    """Period doubling of p1: formulas, the simulated map, settled motions on both sides."""
    wall = case.wall
    peak = wall.doubling_peak()
    theory = None if peak is None else wall.excess_of(peak)
    leading = wall.leading_doubling()
    soft = SoftMap.of(case.oscillator, wall)
    row: dict[str, Any] = {
        "h_f_theory": peak if case.zeta else leading[0], "h_f_closed_form": peak,
        "excess_pd_leading": leading[1] if case.zeta == 0.0 else None, "excess_pd_theory": theory,
        "excess_pd_measured": None, "unstable_from": None, "grazing_multiplier": None,
        "period_below": None, "period_above": None, "least_multiplier": None,
    }
    scale = theory if theory else leading[1]
    if peak == 0.0:
        # p1 is unstable as soon as it touches: its multiplier at a peak far below the crossover
        start = wall.excess_of(max(SMALL * wall.crossover, 1e-11))
        found = soft.fixed_point(start, soft.guess_at(start))
        least = float(np.min(found.multipliers.real))
        row |= {"least_multiplier": least, "grazing_multiplier": wall.grazing_multipliers[0].real,
                "unstable_from": start if least < -1.0 else None,
                "excess_pd_measured": 0.0 if least < -1.0 else None}
        return row, found
    found_or_none = doubling(soft, 0.2 * scale, min(5.0 * scale, 0.5), 24)
    if found_or_none is None:
        return row, None
    row["excess_pd_measured"] = found_or_none.excess
    row["least_multiplier"] = float(np.min(found_or_none.multipliers.real))
    return row | sides_of(soft, found_or_none), found_or_none


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
            found[name] = settle(
                strobed.at(excess), soft.state(excess, start), most_cycles=cycles, tolerance=1e-4 * peak
            ).period
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
        "period": period, "hysteresis": None, "hysteresis_hard": None if hard is None else hard.excess,
        "hysteresis_shift": None, "hysteresis_theory": None, "hysteresis_scan": None,
    }
    found = {K: dict(nothing) for K in hardnesses}
    if hard is None:
        return found, {"shift": None, "remainder": None}
    chain = sorted({HARDEST, *np.geomspace(HARDEST, 10.0, 15).tolist(), *hardnesses}, reverse=True)
    q, v = hard.state(1.0 / frequency)
    orbit: ContactOrbit | None = None
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
        if K not in found:
            continue
        row = {
            "hysteresis": orbit.excess, "hysteresis_shift": orbit.excess - hard.excess,
            "hysteresis_theory": wall.fold_excess(period),
        }
        if scan:
            row["hysteresis_scan"] = scanned(soft, orbit)
        found[K] |= row
    return found, fitted_exponents(tail)


def fitted_exponents(tail: Mapping[float, tuple[float, float]]) -> dict[str, float | None]:
    """Powers of K in the two columns of `tail`."""
    if len(tail) < 2:
        return {"shift": None, "remainder": None}
    hardness, columns = np.log(list(tail)), np.log(np.abs(list(tail.values())))
    shift, remainder = (float(np.polyfit(hardness, column, 1)[0]) for column in columns.T)
    return {"shift": shift, "remainder": remainder}


def scanned(soft: SoftMap, orbit: ContactOrbit) -> float | None:
    """End of the orbit in a downward scan that starts a little above its fold, to 0.5 %."""
    start = orbit.excess + 0.05 * abs(orbit.excess)
    end = orbit_end(
        StroboscopicMap(oscillator=soft.oscillator), soft.state(start, orbit.deviation), start, most_cycles=20000,
        relative=5e-3, absolute=1e-10, first_step=0.01 * abs(orbit.excess),
    )
    return None if end is None or end.period != soft.period else end.excess


def row_of(case: Case, hysteresis: Mapping[str, Any]) -> dict[str, Any]:
    """One row of the table."""
    wall = case.wall
    row: dict[str, Any] = {
        "frequency_hz": case.frequency, "K": case.hardness, "case": case.name, "dashpot": case.zeta,
        "restitution": wall.restitution, "crossover_excess": wall.crossover, "half_kick_excess": wall.half_peak,
    }
    failures: list[str] = []
    steps: tuple[Callable[[], Mapping[str, Any]], ...] = (lambda: powers(case), lambda: doubling_of(case)[0])
    for step in steps:
        try:
            row |= step()
        except (ContactError, ValueError) as error:
            failures.append(f"{case.frequency:g} Hz, K = {case.hardness:g}, {case.name}: {error}")
    return row | dict(hysteresis) | {"failures": failures}


def beam_part(scene: Scene, frequency: float, quick: bool) -> dict[str, Any]:
    """The beam with Hertz contact at one frequency."""
    scene = scene.replace({"contact.law": "hertz"}, provenance="Hertz contact")
    oscillator = beam_of(scene, frequency, model_of(scene))
    theory = HertzSmoothing(oscillator=oscillator)
    excesses = np.geomspace(1e-7, 1e-1, 13 if quick else 37)
    collisions = [collision_above(oscillator, float(e)) for e in excesses]
    speed = np.array([c.kick_velocity for c in collisions])
    drive = oscillator.drive
    assert drive is not None
    approach = drive.angular_frequency * oscillator.stop.gap * np.sqrt(excesses * (2.0 + excesses))
    plateau = collision_above(oscillator, TIME_TRACE_EXCESS).kick

    def half(excess: float) -> float:
        return collision_above(oscillator, excess).kick - 0.5 * plateau

    half_excess = reach_of(half, 1e-8, 1e-2)
    predicted = theory.doubling()
    measured = doubling_excess(oscillator, 0.2 * predicted, 10.0 * predicted, 4000) if predicted else None
    born = born_orbits(oscillator, np.geomspace(1e-7, 1e-2, 11 if quick else 26), 4000)
    return {
        "frequency_hz": frequency, "modes": oscillator.n_modes, "excess": excesses, "kick_velocity": speed,
        "kick": [c.kick for c in collisions], "slope": [local_slope(oscillator, float(e)) for e in excesses],
        "soft_law": [theory.kick_velocity(float(e)) for e in excesses], "hard_law": plateau * approach,
        "contact_time_s": [c.contact_time for c in collisions], "restitution": [c.restitution for c in collisions],
        "plateau": plateau, "half_excess": half_excess,
        "square_root_from": reach_of(lambda e: local_slope(oscillator, e) - 0.6, 1e-5, 1e-1),
        "square_law_up_to": reach_of(lambda e: local_slope(oscillator, e) - 1.9, 1e-7, 1e-3),
        "doubling_theory": predicted, "doubling_excess": None if measured is None else measured[0],
        "period_beyond": None if measured is None else measured[1], "born": born,
        "resolution": RESOLUTION, "hertz_stiffness": hertz_of(scene).stiffness,
    }


def theory_lines(scene: Scene, frequencies: Sequence[float]) -> list[dict[str, Any]]:
    """The two formulas for the lossless period doubling, on a fine grid of K."""
    found = []
    for frequency in frequencies:
        hardness = np.geomspace(10.0, 1e6, 121)
        walls = [SoftImpact.of_mode(single_mode_oscillator(scene, frequency), hardness=float(K)) for K in hardness]
        peaks = [wall.doubling_peak() for wall in walls]
        found.append({
            "frequency_hz": frequency, "K": hardness, "leading": [wall.leading_doubling()[1] for wall in walls],
            "closed_form": [math.nan if h is None else w.excess_of(h) for w, h in zip(walls, peaks, strict=True)],
        })
    return found


def visible_hardness(scene: Scene, frequency: float) -> float | None:
    """K above which the period doubling lies within the letter's amplitude stability."""
    oscillator = single_mode_oscillator(scene, frequency)

    def beyond(log_hardness: float) -> float:
        wall = SoftImpact.of_mode(oscillator, hardness=math.exp(log_hardness))
        peak = wall.doubling_peak()
        return 1.0 if peak is None else math.log(wall.excess_of(peak) / RESOLUTION)

    low, high = math.log(1.0 + 1e-3), math.log(1e8)
    return math.exp(float(brentq(beyond, low, high, xtol=1e-6))) if beyond(high) < 0.0 else None


def answers_of(
    scene: Scene, rows: Sequence[Mapping[str, Any]], curves: Any, exponents: Mapping[str, Any],
    beam: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """What was found, in numbers and in words."""
    frequencies = sorted({row["frequency_hz"] for row in rows})
    hardest = max(row["K"] for row in rows)
    zeta = damping_ratio(scene.single_mode.restitution)
    ratios = [
        abs(r["excess_pd_measured"] / r["excess_pd_leading"] - 1.0) * r["K"]
        for r in rows if r["case"] == "lossless" and r["excess_pd_measured"] and 1e4 <= r["K"] <= 1e5
    ]
    sharper = [
        abs(r["excess_pd_measured"] / r["excess_pd_theory"] - 1.0)
        for r in rows if r["case"] == "lossless" and r["excess_pd_measured"] and 1e4 <= r["K"] <= 1e5
    ]
    touching = [r for r in rows if r["case"] == "dashpot" and r.get("unstable_from") is not None]
    found: dict[str, Any] = {
        "damping_ratio": zeta,
        "kick_rates": {f"{c['case']} K={c['K']:g}": c["rate_of_error"] for c in curves},
        "doubling_error_times_K": [min(ratios), max(ratios)] if ratios else None,
        "doubling_closed_form_error": max(sharper) if sharper else None,
        "doubling_shortfall_times_K": {
            f"{f:g}": SoftImpact.of_mode(single_mode_oscillator(scene, f), hardness=2.0).leading_shortfall
            for f in frequencies
        },
        "least_hardness": {
            f"{f:g}": SoftImpact.of_mode(single_mode_oscillator(scene, f), hardness=2.0).least_hardness
            for f in frequencies
        },
        "visible_below_hardness": {f"{f:g}": visible_hardness(scene, f) for f in frequencies},
        "dashpot_unstable_from_grazing": [len(touching), sum(r["case"] == "dashpot" for r in rows)],
        "hysteresis_exponents": exponents,
    }
    lines = [
        f"a restitution of {scene.single_mode.restitution:g} from spring and dashpot needs a damping ratio of "
        f"{zeta:.4f}: overdamped, and the force sets in with c v; the kick of small peaks is then c h, not h^(3/2)",
    ]
    if ratios and sharper:
        lines.append(
            f"lossless: p1 survives grazing and doubles; measured over the formula for K -> infinity is 1 up to "
            f"{min(ratios):.1f}/K to {max(ratios):.1f}/K, over the closed form 1 up to {max(sharper):.0e} for K from "
            "1e4 to 1e5"
        )
    limits = [(f, K) for f, K in found["visible_below_hardness"].items() if K]
    if limits:
        lines.append(
            "the doubling lies above the letter's amplitude stability only for K below "
            + ", ".join(f"{K:.0f} at {f} Hz" for f, K in limits)
        )
    lines.append(
        f"with the dashpot p1 is unstable from its first touch on, as with a hard wall, in {len(touching)} of "
        f"{sum(r['case'] == 'dashpot' for r in rows)} cases (in all with c > Lambda): a wall that loses that much "
        "hides the smoothing"
    )
    for case in ("lossless", "dashpot"):
        powers_found = [e["shift"] for key, e in exponents.items() if key.endswith(case) and e["shift"] is not None]
        rests = [e["remainder"] for key, e in exponents.items() if key.endswith(case) and e["shift"] is not None]
        if powers_found:
            lines.append(
                f"{case}: the end of p_m approaches the hard wall's as K to the power {min(powers_found):.3f} to "
                f"{max(powers_found):.3f} for K up to 1e8, and what the closed form of order K^(-1/2) leaves falls as "
                f"K to the power {min(rests):.3f} to {max(rests):.3f}"
            )
    if beam is not None:
        lines += beam_lines(beam, scene)
        wall = SoftImpact.of_mode(single_mode_oscillator(scene, beam["frequency_hz"]), hardness=hardest)
        if beam["half_excess"]:
            found["beam_equivalent_K"] = 1.0 + wall.half_peak * (wall.hardness - 1.0) / beam["half_excess"]
            lines.append(f"a lossless soft wall is half smooth at the same excess for K = {found['beam_equivalent_K']:.2g}")
    return found | {"sentences": lines}


def beam_lines(beam: Mapping[str, Any], scene: Scene) -> list[str]:
    """The beam in words."""
    def told(value: float | None) -> str:
        return "no excess looked at" if value is None else f"{value:.2g}"

    grazing = DRIVE_AMPLITUDE_M * 1e9
    gently = [row for row in beam["born"] if row["period_gently"] is not None]
    p1 = [row["excess"] for row in gently if row["period_gently"] == 1]
    beyond = sorted({row["period_gently"] for row in gently if row["excess"] > (max(p1) if p1 else 0.0)})
    steps = sorted({row["period_in_one_step"] for row in beam["born"] if row["period_in_one_step"] is not None})
    lines = [
        f"beam with Hertz contact at {beam['frequency_hz']:.2f} Hz: the kick has half of its plateau at "
        f"{told(beam['half_excess'])}, the local power is within 0.1 of one half from {told(beam['square_root_from'])} "
        f"on and above 1.9 (Hertz: 2) up to {told(beam['square_law_up_to'])}"
    ]
    if beam["doubling_excess"]:
        size = beam["doubling_excess"]
        lines.append(
            f"the p1 orbit with impacts lives from 0 to {size:.3g} ({grazing * size:.2g} nm of a 2 mm drive; formula "
            f"{beam['doubling_theory']:.3g}), then the motion settles on p"
            f"{', p'.join(str(p) for p in beyond if p) or '?'}; the letter's amplitude is stable to "
            f"{RESOLUTION:.2g}, {RESOLUTION / size:.0f} times more"
        )
    lines.append(
        "raised in one step from 1e-3 below grazing, the beam settles on p" + ", p".join(str(p) for p in steps)
        + " throughout"
    )
    return lines


HEAD = (
    f"{'f (Hz)':>7} {'wall':>9} {'K':>7} {'crossover':>10} {'powers':>12} {'doubling':>10} {'formula':>10} "
    f"{'K -> inf':>10} {'sides':>8} {'p_m end':>11} {'hard wall':>11}"
)


def table_line(row: Mapping[str, Any]) -> str:
    """A row of the table on the terminal."""

    def number(key: str, form: str = ".3e") -> str:
        value = row.get(key)
        return "-" if value is None else format(value, form)

    sides = "-" if row.get("period_below") is None else f"p{row['period_below']}|p{row['period_above']}"
    return (
        f"{row['frequency_hz']:7.2f} {row['case']:>9} {row['K']:7.0e} {number('crossover_excess', '.2e'):>10} "
        f"{number('slope_below', '.3f') + ' ' + number('slope_above', '.3f'):>12} "
        f"{number('excess_pd_measured'):>10} {number('excess_pd_theory'):>10} {number('excess_pd_leading'):>10} "
        f"{sides:>8} {number('hysteresis', '+.3e'):>11} {number('hysteresis_hard', '+.3e'):>11}"
    )


def hardnesses_of(request: Request) -> tuple[float, ...]:
    """The K asked for, or the usual ones."""
    asked = request.options.hardness
    if asked:
        return tuple(sorted(set(asked)))
    return QUICK_HARDNESSES if request.quick else HARDNESSES


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; a soft wall needs a harmonic drive")
    if scene.single_mode.restitution == 0.0:
        raise ValueError("single_mode.restitution is 0.0; a wall with spring and dashpot needs one above zero")
    hardnesses, quick = hardnesses_of(request), request.quick
    frequencies = sorted(set(scene.drive.frequencies_hz))
    shown = min(frequencies, key=lambda f: abs(f - SHOWN))
    if quick:
        frequencies = sorted({min(frequencies, key=lambda f: abs(f - g)) for g in QUICK_FREQUENCIES})
    zeta = damping_ratio(scene.single_mode.restitution)
    zetas = (0.0, zeta) if zeta > 0.0 else (0.0,)
    cases = [
        Case(scene=scene, frequency=f, hardness=K, zeta=z) for f in frequencies for z in zetas for K in hardnesses
    ]
    chains = sorted({(case.frequency, case.zeta) for case in cases})
    excesses = np.geomspace(1e-8, 3e-2, 14 if quick else 27)
    shown_cases = [case for case in cases if case.frequency == shown]
    with ThreadPoolExecutor(max_workers=request.workers) as pool, request.progress(
        "soft wall", total=len(cases) + len(chains) + len(shown_cases) + 1
    ) as progress:

        def counted(work: Callable[..., Any], *arguments: Any) -> Any:
            result = work(*arguments)
            progress.advance()
            return result

        beam_job = pool.submit(counted, beam_part, scene, shown, quick)
        chain_jobs = {
            key: pool.submit(counted, hysteresis_chain, scene, *key, hardnesses, not quick) for key in chains
        }
        curve_jobs = [pool.submit(counted, curve_of, case, excesses) for case in shown_cases]
        chained = {key: job.result() for key, job in chain_jobs.items()}
        row_jobs = [
            pool.submit(counted, row_of, case, chained[case.frequency, case.zeta][0][case.hardness]) for case in cases
        ]
        curves = [job.result() for job in curve_jobs]
        rows = [job.result() for job in row_jobs]
        failures = [sentence for row in rows for sentence in row.pop("failures")]
        beam: dict[str, Any] | None = None
        try:
            beam = beam_job.result()
        except ContactError as error:
            failures.append(f"beam: {error}")
    print(HEAD)
    for row in rows:
        print(table_line(row))
    exponents = {
        f"{f:g} Hz, {'dashpot' if z else 'lossless'}": found for (f, z), (_rows, found) in chained.items()
    }
    answers = answers_of(scene, rows, curves, exponents, beam)
    store(request, rows, curves, beam)
    request.record.write_figure(draw_kicks(curves, RESOLUTION), "kick")
    lossless = [row for row in rows if row["case"] == "lossless"]
    request.record.write_figure(
        draw_doubling(lossless, theory_lines(scene, frequencies), RESOLUTION), "doubling"
    )
    request.record.write_figure(draw_hysteresis(rows), "hysteresis")
    if beam is not None:
        request.record.write_figure(draw_beam(beam, RESOLUTION), "beam")
    for line in [*failures, *answers["sentences"]]:
        print(line, flush=True)
    return {
        "soft_wall_schema": SCHEMA, "rows": rows, "beam": beam, "answers": answers, "failures": failures,
        "failed_cells": len(failures),
    }


def store(request: Request, rows: Sequence[Mapping[str, Any]], curves: Any, beam: Mapping[str, Any] | None) -> None:
    """The tables."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    request.record.write_table("rows", {key: [row.get(key) for row in rows] for key in columns})
    names = ("excess", "kick_velocity", "closed_form", "soft_law", "hard_law")
    table: dict[str, list[Any]] = {"K": [], "case": [], **{name: [] for name in names}}
    for curve in curves:
        table["K"] += [curve["K"]] * len(curve["excess"])
        table["case"] += [curve["case"]] * len(curve["excess"])
        for name in names:
            table[name] += list(curve[name])
    request.record.write_table("kicks", table)
    if beam is not None:
        names = ("excess", "kick_velocity", "kick", "slope", "soft_law", "hard_law", "contact_time_s", "restitution")
        request.record.write_table("beam", {name: beam[name] for name in names})
        request.record.write_table("beam_born", {key: [row[key] for row in beam["born"]] for key in beam["born"][0]})


def hardness(text: str) -> float:
    """A hardness from the command line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 2.0 <= value <= 1e7:
        raise argparse.ArgumentTypeError(f"must be a number from 2 to 1e7, not {text!r}")
    return value


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--hardness", type=hardness, nargs="+", metavar="K",
        help="hardness of the wall, 2 to 1e7, one or more (default: 10 to 1e6 in decades)",
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "soft_wall", "A wall of K times the spring constant: the smoothed square root and the orbits that it adds.",
        run, argv, options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
