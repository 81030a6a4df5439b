"""Where the map fails near grazing: the letter's Fig. 5, f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s.

Claim (letter 1996, Fig. 5): where the map has p3, "at rho = 0 the trivial noncolliding p1 orbit gives way to
a period-6 orbit. The stable periodic p3 orbit is found only at the very end of the downward scan"; and
"Eq. (1) predicts for this case a chaotic state at rho = -0.0707 that is not connected to the state that is
born at rho = 0".

Computed, with the physical state carried along and finer steps above grazing, as in the experiment:

    Eq. (1)     upward and downward scan, and the island of p3 and chaos below grazing: from the fold of p3
                (closed form) to its other end, followed upwards, for several restitutions tau
    beam        the scene's spring with thickness and tape fitted again to T and mu, ball and gap as they were
                (the letter prints no drive amplitude with Fig. 5); its p3 fold from shooting
    search      the born period (at F/F_g - 1 = 1e-3) over what is not printed: mass of ball and mount,
                damping of the modes above the first (a factor on what the strips give), loss in the contact
                (Hunt-Crossley, by the restitution of a free ball at the approach speed of excess 0.013);
                each mass with the thickness that keeps T, and the gap kept
    beam, p6    the scans of the cell that departs least from the scene, has period 6, and ends on p3

Run time: one to two minutes; --quick some ten seconds; --full (10000 drive periods at every amplitude)
several minutes.  Command: python -m studies.breakdown.  Outputs: summary.json, the figures breakdown and
born_period, born_period.csv, and the points of the scans as npz.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.errors import ContactError
from contact.laws import ContactLaw, HuntCrossley
from contact.maximal_orbits import maximal_period
from contact.orbits.continuation import fold_of
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from studies.instruments.calibration import calibrate, free_period, solve_for
from studies.instruments.command_line import Request, run_study
from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.orbit_scan import OrbitDiagram, orbit_diagram
from studies.instruments.oscillators import (
    REFERENCE_EXCESS,
    approach_speed,
    contact_law_of,
    hertz_of,
    nordmark_of,
    single_mode_oscillator,
)
from studies.instruments.periodicity import settle
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.published import BREAKDOWN, SETTLE_CYCLES, STROBE_POINTS

FREQUENCY_HZ, FREE_PERIOD_S = float(BREAKDOWN["frequency_hz"]), float(BREAKDOWN["free_period_s"])
DECAY_RATE_PER_S, CHAOS_AT = float(BREAKDOWN["decay_rate_per_s"]), float(BREAKDOWN["chaos_at"])
BORN_EXCESS, BELOW = 1e-3, -1e-3

HIGHEST = 0.012
"""Upper end of the scans: the letter's finer steps above grazing."""

RESTITUTIONS = (0.0, 0.05, 0.06, 0.075, 0.1)
ISLAND_STEP, ISLAND_CYCLES = 5e-4, 1500
"""Step of the excess and drive periods at each, for the end of the island; beyond it chaos is a transient."""

MASSES_KG = tuple(
    m / 1000 for m in (3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0)
)
FACTORS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 8.0)
LOCAL_RESTITUTIONS = (1.0, 0.7)
SEARCH_CYCLES = 1500

MOST_SCANNED = 4
"""Cells with period 6 whose scans are made: those that ask for least."""

QUICK_MASSES_KG, QUICK_FACTORS, QUICK_LOCAL = (0.0035, 0.004), (1.0, 2.0), (1.0,)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How finely a run looks."""

    below: int
    above: int
    cycles: int
    early: bool
    masses: tuple[float, ...]
    factors: tuple[float, ...]
    local: tuple[float, ...]
    restitutions: tuple[float, ...]


def plan_of(request: Request) -> Plan:
    """The plan of a quick, a usual or a full run."""
    full = bool(request.options.full)
    if request.quick:
        return Plan(
            below=21,
            above=10,
            cycles=SETTLE_CYCLES if full else 500,
            early=not full,
            masses=QUICK_MASSES_KG,
            factors=QUICK_FACTORS,
            local=QUICK_LOCAL,
            restitutions=(0.05, 0.1),
        )
    return Plan(
        below=81,
        above=41,
        cycles=SETTLE_CYCLES if full else 2000,
        early=not full,
        masses=MASSES_KG,
        factors=FACTORS,
        local=LOCAL_RESTITUTIONS,
        restitutions=RESTITUTIONS,
    )


def scene_of_fig_5(scene: Scene) -> Scene:
    """The scene with period and damping of Fig. 5; ball and gap as they were."""
    if scene.spring.kind == "modal_data":
        raise ValueError(
            "spring.kind is modal_data; Fig. 5 needs a spring whose thickness can be fitted to its period"
        )
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; Fig. 5 needs a harmonic drive")
    fitted = calibrate(scene, free_period_s=FREE_PERIOD_S, decay_rate_per_s=DECAY_RATE_PER_S)
    return fitted.replace(
        {"single_mode.free_period_s": FREE_PERIOD_S, "single_mode.decay_rate_per_s": DECAY_RATE_PER_S}
    )


def tuned(scene: Scene, period: float, *, mass: float | None = None) -> ModalModel:
    """Modes of the spring with another ball [kg], its sheet so thick that mode 1 has this period [s]."""
    here = scene if mass is None else scene.replace({"tip.mass_kg": mass})
    h = scene.spring.thickness_m
    return model_of(
        solve_for(
            "spring.thickness_m",
            here,
            free_period,
            period,
            name="free period",
            unit="s",
            low=0.7 * h,
            high=1.25 * h,
        )
    )


def driven(
    scene: Scene, model: ModalModel, *, factor: float = 1.0, local_restitution: float | None = None
) -> StroboscopicMap:
    """The driven spring; `factor` on the rates of the higher modes, `local_restitution` of the contact."""
    rates = np.array(model.decay_rate)
    rates[1:] *= factor
    law = contact_law_of(scene) if local_restitution is None else lossy(scene, local_restitution)
    return StroboscopicMap(
        oscillator=ImpactOscillator(
            model=replace(model, decay_rate=rates),
            stop=Stop(gap=scene.stop.gap_m, law=law),
            drive=HarmonicDrive(frequency=FREQUENCY_HZ),
        )
    )


def lossy(scene: Scene, restitution: float) -> ContactLaw:
    """Hertz's law with the loss that gives a free ball this restitution at the speed of excess 0.013."""
    return HuntCrossley.with_restitution(
        stiffness=hertz_of(scene).stiffness,
        restitution=restitution,
        velocity=approach_speed(FREQUENCY_HZ, scene.stop.gap_m, REFERENCE_EXCESS),
    )


def born(strobed: StroboscopicMap, cycles: int = SEARCH_CYCLES) -> tuple[int, int]:
    """Period and impacts of the settled orbit at excess 1e-3, started from the motion just below grazing."""
    settled = settle(strobed.at(BORN_EXCESS), strobed.at(BELOW).steady(), most_cycles=cycles)
    return settled.period, settled.impacts


def fold_of_p3(strobed: StroboscopicMap) -> float | None:
    """F_3/F_g - 1 of the p3 orbit with one collision; None where there is none."""
    try:
        orbit = fold_of(Shooting(oscillator=strobed.oscillator, period=3))
    except ContactError:
        return None
    return None if orbit is None else orbit.excess


def excesses(lowest: float, plan: Plan) -> np.ndarray:
    """The amplitudes of an upward scan: even steps below grazing, finer ones above."""
    below = np.linspace(lowest, 0.0, plan.below)[:-1]
    return np.concatenate([below, np.linspace(0.0, HIGHEST, plan.above)[1:]])


def both_ways(
    strobed: StroboscopicMap, lowest: float, plan: Plan, observe: Callable[[np.ndarray], np.ndarray]
) -> dict[str, OrbitDiagram[Any]]:
    """Upward and downward scan."""
    values = excesses(lowest, plan)
    common: dict[str, Any] = {
        "observe": observe,
        "settle_cycles": plan.cycles,
        "record_cycles": STROBE_POINTS,
        "early": plan.early,
    }
    up = orbit_diagram(strobed, values, strobed.at(lowest).steady(), **common)
    return {"up": up, "down": orbit_diagram(strobed, values[::-1], up.end, **common)}


def periods(diagram: OrbitDiagram[Any]) -> np.ndarray:
    """Periods of a scan; a motion without impacts is p1, even while it has not quite come to rest."""
    return np.where(diagram.impacts == 0, 1, diagram.period)


def rows_of(diagram: OrbitDiagram[Any]) -> list[dict[str, Any]]:
    """A scan, amplitude by amplitude."""
    return [
        {"excess": float(e), "period": int(p), "impacts": int(i)}
        for e, p, i in zip(diagram.excess, periods(diagram), diagram.impacts, strict=True)
    ]


def stretches(diagram: OrbitDiagram[Any]) -> list[dict[str, Any]]:
    """The scan as stretches of one period: from, to, period; impacts where they stay the same."""
    found: list[dict[str, Any]] = []
    for row in rows_of(diagram):
        key = (row["period"], row["impacts"] if row["period"] else None)
        if not found or (found[-1]["period"], found[-1]["impacts"]) != key:
            found.append({"period": key[0], "impacts": key[1], "from": row["excess"], "to": row["excess"]})
        found[-1]["to"] = row["excess"]
    return found


def island(
    scene: Scene, restitution: float, *, step: float = ISLAND_STEP
) -> tuple[dict[str, Any], OrbitDiagram[Any]]:
    """The p3 of Eq. (1) and what it turns into, followed upwards from its fold until the motion is free."""
    scene = scene.replace({"single_mode.restitution": restitution})
    oscillator = single_mode_oscillator(scene, FREQUENCY_HZ)
    strobed = StroboscopicMap(oscillator=oscillator)
    fold = MaximalFamily.from_oscillator(oscillator, period=3).fold()
    assert fold is not None  # theta lies in the band of p3
    family = Shooting(oscillator=oscillator, period=3)
    orbit = family.at_speed(1.02 * fold.speed)
    values = np.arange(orbit.excess, HIGHEST, step)
    state, used = orbit.strobe_state(), values.size
    period = np.zeros(values.size, dtype=np.int64)
    impacts, points = np.zeros(values.size, dtype=np.int64), np.full((values.size, STROBE_POINTS), np.nan)
    for i, excess in enumerate(values):
        here = strobed.at(float(excess))
        settled = settle(here, state, most_cycles=ISLAND_CYCLES)
        if settled.impacts == 0:
            used = i
            break
        recorded = here.orbit(settled.end, STROBE_POINTS)
        state, points[i] = recorded.end, strobed.tip(recorded.points)
        period[i], impacts[i] = settled.period, settled.impacts
    last = float(values[used - 1])
    around = np.flatnonzero(np.abs(values[:used] - CHAOS_AT) <= step)
    found = {
        "restitution": restitution,
        "fold_p3": fold.excess,
        "end": last,
        "alive_at_letters_chaos": last >= CHAOS_AT,
        "period_at_letters_chaos": int(period[around[0]]) if around.size else None,
    }
    kept = slice(0, used)
    return found, OrbitDiagram(
        excess=values[kept],
        points=points[kept],
        period=period[kept],
        impacts=impacts[kept],
        cycles=np.zeros(used, dtype=np.int64),
        failures=(),
        end=state,
    )


def search(
    scene: Scene, plan: Plan, pool: ThreadPoolExecutor, tell: Callable[[], None]
) -> tuple[list[dict[str, Any]], dict[float, ModalModel]]:
    """The born period in every cell of mass, factor on the higher modes' damping, local restitution."""

    def of_mass(mass: float) -> ModalModel:
        model = tuned(scene, FREE_PERIOD_S, mass=mass)
        tell()
        return model

    models = dict(zip(plan.masses, pool.map(of_mass, plan.masses), strict=True))

    def cell(numbers: tuple[float, float, float]) -> dict[str, Any]:
        mass, factor, local = numbers
        strobed = driven(scene, models[mass], factor=factor, local_restitution=local)
        found: dict[str, Any] = {
            "tip_mass_kg": mass,
            "higher_damping": factor,
            "local_restitution": local,
            "period": None,
            "impacts": None,
        }
        try:
            found["period"], found["impacts"] = born(strobed)
            if found["period"] == BREAKDOWN["born_period"]:
                found["fold_p3"] = fold_of_p3(strobed)
        except ContactError as error:
            found["failure"] = str(error)
        tell()
        return found

    numbers = [(m, k, e) for e in plan.local for m in plan.masses for k in plan.factors]
    return list(pool.map(cell, numbers)), models


def candidates(cells: Sequence[Mapping[str, Any]], scene: Scene) -> list[Mapping[str, Any]]:
    """The cells with period 6, by what they ask for: elastic, damping as the strips', the nearest mass."""

    def asks(cell: Mapping[str, Any]) -> tuple[float, float, float]:
        return (
            -cell["local_restitution"],
            abs(math.log(cell["higher_damping"])),
            abs(math.log(cell["tip_mass_kg"] / scene.tip.mass_kg)),
        )

    return sorted((cell for cell in cells if cell["period"] == BREAKDOWN["born_period"]), key=asks)


def within_errors(scene: Scene, pool: ThreadPoolExecutor) -> list[dict[str, Any]]:
    """The born period at the ends of the letter's errors of T and mu, all else as calibrated."""

    def one(numbers: tuple[float, float]) -> dict[str, Any]:
        more, rate = numbers
        here = scene.replace({"damping.decay_rate_per_s": DECAY_RATE_PER_S + rate})
        period, impacts = born(driven(here, tuned(here, FREE_PERIOD_S + more)))
        return {
            "free_period_s": FREE_PERIOD_S + more,
            "decay_rate_per_s": DECAY_RATE_PER_S + rate,
            "period": period,
            "impacts": impacts,
        }

    t, c = float(BREAKDOWN["free_period_error_s"]), float(BREAKDOWN["decay_rate_error_per_s"])
    return list(pool.map(one, [(-t, 0.0), (t, 0.0), (0.0, -c), (0.0, c)]))


def word(period: int, impacts: int | None = None) -> str:
    """p6, or what stands for no period."""
    return "no period" if period == 0 else f"p{period}" + (f" ({impacts} impacts)" if impacts else "")


def end_of_p3(diagram: OrbitDiagram[Any]) -> list[float] | None:
    """[first, last] excess at which a downward scan is on p3 with one impact."""
    on = (periods(diagram) == 3) & (diagram.impacts == 1)
    return [float(diagram.excess[on][0]), float(diagram.excess[on][-1])] if np.any(on) else None


def sentences(found: Mapping[str, Any]) -> list[str]:
    """The results in words."""
    lines = []
    single, alive = (
        found["single_mode"],
        [e for e in found["single_mode"]["islands"] if e["alive_at_letters_chaos"]],
    )
    largest = max((e["restitution"] for e in alive), default=math.nan)
    lines.append(
        f"Eq. (1): born {word(single['born']['period'])}; island of p3 and chaos, not connected to it: "
        + ", ".join(
            f"{e['fold_p3']:+.4f} to {e['end']:+.4f} at tau = {e['restitution']:g}" for e in single["islands"]
        )
        + f". A motion with impacts at {CHAOS_AT} needs tau <= {largest:g} of these (as a rho of the map, "
        f"{CHAOS_AT} is an excess of {single['excess_of_letters_chaos_as_rho']:+.4f})."
    )
    beam = found["beam"]
    end = beam["p3_in_downward_scan"]
    lines.append(
        f"Beam as calibrated ({1e3 * beam['tip_mass_kg']:.2f} g): born {word(beam['born']['period'])}; "
        f"p3 fold at {number(beam['fold_p3'])}; downward scan "
        + (f"on p3 from {end[0]:+.4f} to {end[1]:+.4f}" if end else "falls to p1 without reaching p3")
        + f"; impacts end at {number(beam['impacts_end'])}."
    )
    six = [cell for cell in found["born"] if cell["period"] == BREAKDOWN["born_period"]]
    if six:
        masses = sorted({1e3 * cell["tip_mass_kg"] for cell in six})
        lines.append(
            f"Period 6 at birth in {len(six)} of {len(found['born'])} cells, at ball masses of "
            f"{masses[0]:.2f} to {masses[-1]:.2f} g."
        )
    at = found["found"]
    if at is not None:
        end = at["p3_in_downward_scan"]
        lines.append(
            f"With {1e3 * at['tip_mass_kg']:.2f} g, damping of the higher modes x {at['higher_damping']:g}, "
            f"local restitution {at['local_restitution']:g}: born "
            f"{word(at['born']['period'], at['born']['impacts'])}; p3 "
            + (
                f"in the downward scan only from {end[0]:+.4f} to {end[1]:+.4f}, its very end"
                if end
                else "not reached"
            )
            + f"; fold at {number(at['fold_p3'])}."
        )
    return lines


def number(value: float | None) -> str:
    """An excess in words."""
    return "none" if value is None else f"{value:+.4f}"


def draw_scans(panels: Sequence[tuple[str, Mapping[str, OrbitDiagram[Any]], str, float | None]]) -> Any:
    """The scans below one another: steps below grazing on the left, the finer ones above it on the right."""
    figure, axes = new_figure(
        len(panels),
        2,
        width=PAGE,
        height=0.052 * len(panels) + 0.014,
        squeeze=False,
        sharey="row",
        width_ratios=[1.7, 1.0],
    )
    styles = {
        "down": ("#D55E00", "none", 2.6, "downward scan", 2),
        "up": (PALETTE[1], PALETTE[1], 1.3, "upward scan", 3),
        "island": ("0.55", "none", 1.2, "island, followed upwards from its fold", 1),
    }
    lowest = min(float(d.excess.min()) for _, ways, _, _ in panels for d in ways.values())
    with house_style():
        for i, (title, ways, quantity, fold) in enumerate(panels):
            for j, axis in enumerate(axes[i]):
                for way, diagram in ways.items():
                    colour, face, size, name, order = styles[way]
                    kept = diagram.excess >= -1e-12 if j else diagram.excess <= 1e-12
                    x = np.repeat(diagram.excess[kept, None], diagram.points.shape[1], axis=1)
                    axis.plot(
                        1e2 * x.ravel(),
                        1e3 * diagram.points[kept].ravel(),
                        linestyle="none",
                        marker="o",
                        markersize=size,
                        markerfacecolor=face,
                        markeredgecolor=colour,
                        markeredgewidth=0.4,
                        label=name,
                        zorder=order,
                        rasterized=True,
                    )
                axis.axvline(0.0, color="0.6", linestyle="--", linewidth=0.6, zorder=0)
                axis.set_xlim(*((-0.03, 1e2 * HIGHEST + 0.03) if j else (1e2 * lowest - 0.3, 0.2)))
            axes[i, 0].set_title(f"({chr(ord('a') + i)}) {title}", loc="left")
            label(axes[i, 0].yaxis, quantity, "mm")
            if fold is not None:
                room = fold > 0.85 * lowest  # on the left of the line
                axes[i, 0].axvline(1e2 * fold, color="#009E73", linestyle=":", linewidth=0.9, zorder=0)
                axes[i, 0].annotate(
                    "fold of p$_3$",
                    (1e2 * fold, 0.98 if room else 0.86),
                    xycoords=("data", "axes fraction"),
                    xytext=(-3 if room else 3, 0),
                    textcoords="offset points",
                    ha="right" if room else "left",
                    va="top",
                    fontsize=7,
                    color="#00704F",
                )
        axes[0, 1].set_title("finer steps above grazing", loc="right")
        for axis in axes[-1]:
            label(axis.xaxis, "excess F/F$_g$ - 1", "%")
        handles, names = [], []
        for axis in axes.flat:
            for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
                if name not in names:
                    handles.append(handle)
                    names.append(name)
        figure.legend(handles, names, loc="outside lower center", ncols=3, markerscale=2.0)
    return figure


def draw_born(
    cells: Sequence[Mapping[str, Any]], plan: Plan, scene: Scene, at: Mapping[str, Any] | None
) -> Any:
    """The born period as a map of labelled cells, one panel for each restitution of the contact."""
    figure, axes = new_figure(
        1, len(plan.local), width=PAGE, height=0.030 + 0.0058 * len(plan.masses), squeeze=False, sharey=True
    )
    colours = {3: "#56B4E9", 6: "#E69F00", 12: "#F5D9A0", 0: "#DDDDDD", None: "#FFFFFF"}
    with house_style():
        for axis, local in zip(axes[0], plan.local, strict=True):
            for cell in (c for c in cells if c["local_restitution"] == local):
                i, j = plan.masses.index(cell["tip_mass_kg"]), plan.factors.index(cell["higher_damping"])
                period = cell["period"]
                axis.add_patch(_cell(j, i, colours.get(period, "#CFE8D5")))
                axis.text(
                    j,
                    i,
                    "×" if period is None else str(period) if period else "–",
                    ha="center",
                    va="center",
                    fontsize=7,
                    fontweight="bold" if period == 6 else "normal",
                )
                if at is not None and cell is at:
                    axis.add_patch(_cell(j, i, "none", edge="black", width=1.2))
            axis.set_xlim(-0.5, len(plan.factors) - 0.5)
            axis.set_ylim(-0.5, len(plan.masses) - 0.5)
            axis.set_xticks(range(len(plan.factors)), [f"{k:g}" for k in plan.factors])
            axis.tick_params(length=0)
            for side in axis.spines.values():
                side.set_visible(False)
            words = "elastic contact" if local == 1.0 else f"lossy contact, local restitution {local:g}"
            axis.set_title(words)
            label(axis.xaxis, "damping of the higher modes / that of the strips")
        axes[0, 0].set_yticks(range(len(plan.masses)), [f"{1e3 * m:.2f}" for m in plan.masses])
        label(axes[0, 0].yaxis, "ball and mount", "g")
        framed = "; framed: scanned in panel (c) of the orbit diagrams" if at is not None else ""
        figure.supxlabel(
            "number: period of the orbit born at grazing, at excess 10$^{-3}$; –: none up to 64"
            + f"{framed}\nthe calibrated ball and mount have {1e3 * scene.tip.mass_kg:.2f} g",
            fontsize=7,
        )
    return figure


def _cell(x: float, y: float, face: str, edge: str = "white", width: float = 0.8) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle(
        (x - 0.5, y - 0.5),
        1.0,
        1.0,
        facecolor=face,
        edgecolor=edge,
        linewidth=width,
        zorder=2 if face == "none" else 1,
    )


def beam_result(
    strobed: StroboscopicMap, plan: Plan, lowest: float | None = None
) -> tuple[dict[str, Any], dict[str, OrbitDiagram[Any]]]:
    """What a beam does at birth and in the scans."""
    fold = fold_of_p3(strobed)
    reach = 1.12 * fold if fold is not None and fold < -0.01 else -0.1
    ways = both_ways(
        strobed, min(reach, lowest or 0.0), plan, lambda points: strobed.readout(points, "readout")
    )
    down = ways["down"]
    with_impacts = down.excess[down.impacts > 0]
    period, impacts = born(strobed, plan.cycles)
    return {
        "born": {"period": period, "impacts": impacts},
        "fold_p3": fold,
        "p3_in_downward_scan": end_of_p3(down),
        "impacts_end": float(with_impacts[-1]) if with_impacts.size else None,
        "stretches_up": stretches(ways["up"]),
        "stretches_down": stretches(down),
    }, ways


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    plan = plan_of(request)
    scene = scene_of_fig_5(scene)
    nordmark = nordmark_of(scene, FREQUENCY_HZ)
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        tau = scene.single_mode.restitution
        taus = sorted({*plan.restitutions, tau})
        islands = [pool.submit(island, scene, value) for value in taus]
        model = model_of(scene)
        calibrated = driven(scene, model)
        beam_future = pool.submit(beam_result, calibrated, plan)
        single = StroboscopicMap(oscillator=single_mode_oscillator(scene, FREQUENCY_HZ))
        single_future = pool.submit(both_ways, single, -0.14, plan, single.tip)
        total = len(plan.masses) * (1 + len(plan.factors) * len(plan.local))
        with request.progress("search", total=total) as progress:
            cells, models = search(scene, plan, pool, progress.advance)
        tried = candidates(cells, scene)[:MOST_SCANNED]

        def scanned(cell: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, OrbitDiagram[Any]]]:
            numbers = {k: cell[k] for k in ("tip_mass_kg", "higher_damping", "local_restitution")}
            strobed = driven(
                scene,
                models[cell["tip_mass_kg"]],
                factor=cell["higher_damping"],
                local_restitution=cell["local_restitution"],
            )
            result, ways = beam_result(strobed, plan)
            return {**numbers, **result}, ways

        scans = list(pool.map(scanned, tried))
        # as in the letter: p3 in the downward scan, at its end; otherwise the first candidate
        place = next((i for i, (r, _) in enumerate(scans) if r["p3_in_downward_scan"]), 0)
        at = tried[place] if tried else None
        found, found_ways = scans[place] if tried else (None, {})
        errors = [] if request.quick else within_errors(scene, pool)
        beam, ways = beam_future.result()
        single_ways = single_future.result()
        traced = [future.result() for future in islands]
    own = traced[taus.index(tau)]
    single_ways["island"] = own[1]
    period, impacts = born(single)
    panels = [
        (f"Eq. (1), τ = {tau:g}", single_ways, "tip displacement", own[0]["fold_p3"]),
        (
            f"beam as calibrated, ball and mount {1e3 * scene.tip.mass_kg:.2f} g",
            ways,
            "read-out",
            beam["fold_p3"],
        ),
    ]
    if found is not None:
        title = f"beam, {1e3 * found['tip_mass_kg']:.2f} g"
        if found["higher_damping"] != 1.0:
            title += f", damping of the higher modes × {found['higher_damping']:g}"
        if found["local_restitution"] != 1.0:
            title += f", local restitution {found['local_restitution']:g}"
        panels.append((title, found_ways, "read-out", found["fold_p3"]))
    arrays = {
        f"{name}_{way}_{part}": values
        for name, several in (("single_mode", single_ways), ("beam", ways), ("found", found_ways))
        for way, diagram in several.items()
        for part, values in (
            ("excess", diagram.excess),
            ("points", diagram.points),
            ("period", periods(diagram)),
            ("impacts", diagram.impacts),
        )
    }
    request.record.write_arrays("breakdown", **arrays)
    request.record.write_table("born_period", _columns(cells))
    request.record.write_figure(draw_scans(panels), "breakdown")
    request.record.write_figure(draw_born(cells, plan, scene, at), "born_period")
    failures = [cell["failure"] for cell in cells if "failure" in cell]
    failures += [
        s for several in (single_ways, ways, found_ways) for d in several.values() for s in d.failures
    ]
    result: dict[str, Any] = {
        "up": rows_of(ways["up"]),
        "down": rows_of(ways["down"]),
        "gap": {
            "gap_m": scene.stop.gap_m,
            "kept": True,
            "grazing_amplitude_m": calibrated.oscillator.grazing_amplitude(),
        },
        "beam": {"tip_mass_kg": scene.tip.mass_kg, "thickness_m": scene.spring.thickness_m, **beam},
        "single_mode": {
            "restitution": tau,
            "born": {"period": period, "impacts": impacts},
            "up": rows_of(single_ways["up"]),
            "down": rows_of(single_ways["down"]),
            "islands": [entry for entry, _ in traced],
            "excess_of_letters_chaos_as_rho": nordmark.excess(CHAOS_AT),
        },
        "map": {"period": maximal_period(nordmark)},
        "born": cells,
        "within_errors": errors,
        "found": found,
        "scanned": [
            {k: r[k] for k in ("tip_mass_kg", "higher_damping", "local_restitution", "p3_in_downward_scan")}
            for r, _ in scans
        ],
        "failures": failures,
        "failed_cells": len(failures),
    }
    result["closing"] = sentences(result)
    for line in [*failures, *result["closing"]]:
        print(line, flush=True)
    return result


def _columns(cells: Iterable[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """The cells of the search as columns of a table."""
    names = ("tip_mass_kg", "higher_damping", "local_restitution", "period", "impacts")
    rows = list(cells)
    return {name: [-1 if row[name] is None else row[name] for row in rows] for name in names}


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--full",
        action="store_true",
        help="as the experiment did: 10000 drive periods at every amplitude, never fewer",
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "breakdown",
        "Where the map fails near grazing: the letter's Fig. 5 for Eq. (1) and the beam.",
        run,
        argv,
        options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
