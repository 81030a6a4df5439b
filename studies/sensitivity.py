"""What the six transitions owe to the letter's errors, to its noise and to what it leaves open.

Claims (letter 1996): T = 40.80 +- 0.02 ms; the drive is stable to 0.5 um of 2 mm (2.5e-4); "the highest
observed period (p10) is at the limit of our experimental resolution and stability".

Computed, for each change of one parameter and each of the six frequencies:

    born period      of Nordmark's map, Eq. (1) and the beam at F/F_g - 1 = 1e-3, started just below grazing
    fold             F_m/F_g - 1 at the end of the p_m orbit that is born without the change: closed forms for
                     map and Eq. (1), shooting for the beam

Changes: T, mu within their errors, tau between 0.05 and 0.15, and the free assumptions of the spring.  A
change of the spring goes with the thickness of the sheet that keeps T; the rate of mode 1, gap and mass stay.

Noise of the amplitude, relative rms 2.5e-4, redrawn at every strobe, the motion relative to the base carried
along: jitter (independent from one drive period to the next) and drift (correlated over 100 periods).  The
strobe points of p_m form m clouds: one is told from the next if they are further apart than they are wide
(90 % of the points).  This is asked for m = 3 ... 16, in Eq. (1), where the letter's frequencies lie on
average: 15 % of the band below its upper edge; and for the beam at three of the letter's frequencies.

Run time: about a minute; --quick some ten seconds.  Command: python -m studies.sensitivity.  Outputs:
summary.json, sensitivity.csv, noise.csv, the figures fold_against_parameter, strobe_points, noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from beam import ModalModel
from contact.errors import ContactError
from contact.maximal_orbits import band
from contact.maximal_orbits import fold as fold_of_map
from contact.orbits.continuation import fold_of
from contact.orbits.kick import KickFamily
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.strobed_nordmark import StrobedNordmarkMap
from contact.stroboscope import StroboscopicMap
from studies.instruments.calibration import calibrate_damping, free_period, solve_for
from studies.instruments.command_line import Request, run_study
from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure
from studies.instruments.oscillators import beam_of, nordmark_of, single_mode_oscillator
from studies.instruments.periodicity import Settled, settle
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.published import (
    AMPLITUDE_STABILITY_M,
    BREAKDOWN,
    DRIVE_AMPLITUDE_M,
    FREE_PERIOD_ERROR_S,
)

BORN_EXCESS, BELOW, CYCLES = 1e-3, -1e-3, 3000
NOISE = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M
"""Relative rms of the amplitude: 2.5e-4."""

CORRELATION = 100.0
"""Drive periods over which the drift is correlated: some seconds, longer than 40 strobe points take."""

PERIOD_RANGE = range(3, 17)
SHARE_OF_BAND = 0.15
"""Where in its band p_m is asked about noise, from the upper edge."""

STROBES, SKIPPED = 1000, 200
"""Noisy drive periods followed, and those left out at the start."""

SEED = 1996
STEP = 1.1
"""Factor between excesses when the upper end of an orbit is looked for."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """One parameter changed: keys of the scene, or what has no key.

    Parameters
    ----------
    parameter, text : str
        Name, and the change in words.
    sign : int
        -1 or 1: lowered or raised.
    keys : mapping
        Dotted keys with their new values.
    tune : bool
        Whether the sheet has to be refitted to the free period.
    higher_damping : float
        Factor on the decay rates of modes above the first.
    """

    parameter: str
    text: str
    sign: int
    keys: Mapping[str, Any] = field(default_factory=dict)
    tune: bool = False
    higher_damping: float = 1.0


def changes_of(scene: Scene, quick: bool) -> list[Change]:
    """What is varied: first the letter's own errors, then the assumptions."""
    t, c, tau = (
        scene.single_mode.free_period_s,
        scene.single_mode.decay_rate_per_s,
        scene.single_mode.restitution,
    )
    rate = float(BREAKDOWN["decay_rate_error_per_s"])
    found = []
    for sign, name in ((-1, "-"), (1, "+")):
        found += [
            Change(
                parameter="free period",
                text=f"{name}0.02 ms",
                sign=sign,
                tune=True,
                keys={"single_mode.free_period_s": t + sign * FREE_PERIOD_ERROR_S},
            ),
            Change(
                parameter="decay rate of mode 1",
                text=f"{name}0.1 1/s",
                sign=sign,
                keys={"single_mode.decay_rate_per_s": c + sign * rate},
            ),
            Change(
                parameter="restitution of Eq. (1)",
                text=f"{name}0.05",
                sign=sign,
                keys={"single_mode.restitution": min(max(tau + sign * 0.05, 0.0), 1.0)},
            ),
            Change(
                parameter="damping of higher modes",
                text="x 0.5" if sign < 0 else "x 2",
                sign=sign,
                higher_damping=2.0**sign,
            ),
        ]
        if quick:
            continue
        found += [
            Change(
                parameter=words,
                text=f"x {factor:g}",
                sign=sign,
                tune=tune,
                keys={key: scene[key] * factor},
            )
            for words, key, low, high, tune in (
                ("mass of ball and mount", "tip.mass_kg", 0.8, 1.2, True),
                ("gap", "stop.gap_m", 0.8, 1.25, False),
                ("radius of the ball", "tip.ball_radius_m", 0.5, 2.0, False),
                ("radius of the bend", "spring.bend_radius_m", 0.7, 1.3, True),
                ("width of the strip", "spring.width_m", 0.7, 1.3, True),
                ("modulus of the tape", "spring.tape_modulus_pa", 0.5, 2.0, True),
                ("coverage of the tape", "spring.tape_coverage", 0.75, 1.25, True),
            )
            for factor in [low if sign < 0 else high]
            if key != "spring.tape_coverage" or scene[key] * factor <= 1.0
        ]
        count = scene.modes.count
        found.append(
            Change(
                parameter="number of modes",
                text=f"{count - 5 if sign < 0 else count + 5}",
                sign=sign,
                keys={"modes.count": max(1, count - 5) if sign < 0 else count + 5},
            )
        )
    return found


def changed(scene: Scene, change: Change | None) -> tuple[Scene, ModalModel]:
    """Scene and modes after a change; None for none."""
    if change is None:
        return scene, model_of(scene)
    target = change.keys.get("single_mode.free_period_s", free_period(scene))
    scene = scene.replace(change.keys)
    if "single_mode.decay_rate_per_s" in change.keys:
        rate = change.keys["single_mode.decay_rate_per_s"]
        scene = (
            scene.replace({"damping.decay_rate_per_s": rate})
            if scene.damping.kind == "strips"
            else calibrate_damping(scene, rate)
        )
    if change.tune:
        h = scene.spring.thickness_m
        scene = solve_for(
            "spring.thickness_m",
            scene,
            free_period,
            target,
            name="free period",
            unit="s",
            low=0.7 * h,
            high=1.4 * h,
        )
    model = model_of(scene)
    rates = np.array(model.decay_rate)
    rates[1:] *= change.higher_damping
    return scene, replace(model, decay_rate=rates)


def born(strobed: Any, excess: float = BORN_EXCESS) -> Settled[Any]:
    """The orbit at an excess, started from the motion just below grazing."""
    return settle(strobed.at(excess), strobed.at(BELOW).steady(), most_cycles=CYCLES)


def period_of_birth(strobed: Any) -> int | None:
    """Its period; None where it could not be computed."""
    try:
        return born(strobed).period
    except ContactError:
        return None


def beam_fold(scene: Scene, model: ModalModel, frequency: float, period: int) -> float | None:
    """F_m/F_g - 1 where the beam's p_m ends, from shooting started on kicks; None where there is no fold."""
    oscillator = beam_of(scene, frequency, model)
    try:
        kick = KickFamily(oscillator=oscillator, period=period).fold()
        if kick is None:
            return None
        found = fold_of(Shooting(oscillator=oscillator, period=period, impacts=kick.kick.touches))
    except ContactError:
        return None
    return None if found is None else found.excess


def row_at(
    scene: Scene, model: ModalModel, frequency: float, change: Change | None, base: Mapping[str, int] | None
) -> tuple[dict[str, Any], Mapping[str, int]]:
    """One row of the table, and the born periods whose folds it gives: those of `base`, or its own."""
    strobed: dict[str, Any] = {
        "map": StrobedNordmarkMap(map=nordmark_of(scene, frequency)),
        "single_mode": StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency)),
        "beam": StroboscopicMap(oscillator=beam_of(scene, frequency, model)),
    }
    row: dict[str, Any] = {
        "frequency_hz": frequency,
        "parameter": "none" if change is None else change.parameter,
        "change": "" if change is None else change.text,
        "sign": 0 if change is None else change.sign,
    }
    for name, one in strobed.items():
        row[f"born_{name}"] = period_of_birth(one)
    periods = base or {name: row[f"born_{name}"] or 0 for name in strobed}
    row |= {"m": periods["beam"], "fold_map": None, "fold_single_mode": None, "fold_beam": None}
    if periods["map"] > 1:
        on_map = fold_of_map(strobed["map"].map, periods["map"])
        row["fold_map"] = None if on_map is None else strobed["map"].map.excess(on_map.rho)
    if periods["single_mode"] > 1:
        single = MaximalFamily.from_oscillator(
            strobed["single_mode"].oscillator, period=periods["single_mode"]
        ).fold()
        row["fold_single_mode"] = None if single is None else single.excess
    if periods["beam"] > 1:
        row["fold_beam"] = beam_fold(scene, model, frequency, periods["beam"])
    return row, periods


def upper_end(strobed: StroboscopicMap, period: int, highest: float = 0.1) -> float | None:
    """Highest excess, in steps of 10 %, up to which the orbit born at 1e-3 keeps its period."""
    settled = born(strobed)
    if settled.period != period:
        return None
    excess, state = BORN_EXCESS, settled.end
    while excess < highest:
        settled = settle(strobed.at(STEP * excess), state, most_cycles=CYCLES)
        if settled.period != period:
            break
        excess, state = STEP * excess, settled.end
    return excess


def first_birth(strobed: StroboscopicMap, period: int, highest: float = 0.02) -> float | None:
    """Lowest excess, in steps of 10 %, at which a start from just below grazing gives this period."""
    excess = NOISE
    while excess < highest:
        if born(strobed, excess).period == period:
            return excess
        excess *= STEP
    return None


def noisy(
    strobed: StroboscopicMap,
    observe: Callable[[np.ndarray], np.ndarray],
    kind: str,
    strobes: int,
    seed: int = SEED,
) -> tuple[np.ndarray, np.ndarray]:
    """Strobe points [m] and impacts in each period, at excess 1e-3 with a noisy amplitude."""
    dice, correlation = np.random.default_rng(seed), math.exp(-1.0 / CORRELATION)
    state, deviation = born(strobed).end, 0.0
    points, impacts = np.empty(strobes), np.zeros(strobes, dtype=np.int64)
    for n in range(strobes):
        fresh = float(dice.standard_normal())
        deviation = (
            fresh if kind == "jitter" else correlation * deviation + math.sqrt(1.0 - correlation**2) * fresh
        )
        one = strobed.at(BORN_EXCESS + NOISE * deviation).orbit(state, 1)
        state, points[n], impacts[n] = one.end, observe(one.points)[0], one.impacts[0]
    return points[SKIPPED:], impacts[SKIPPED:]


def since_impact(impacts: np.ndarray) -> np.ndarray:
    """Strobes since the last impact, -1 before the first one."""
    found, count = np.empty(impacts.size, dtype=np.int64), -1
    for n, touched in enumerate(impacts):
        count = 0 if touched else count + 1 if count >= 0 else -1
        found[n] = count
    return found


def clouds(points: np.ndarray, impacts: np.ndarray, period: int) -> dict[str, Any]:
    """How well the m strobe points of p_m are told apart.

    `regular`: part of the intervals between periods with impact that are m long.  `spread`: greatest width of
    a cloud (90 % of its points), `separation`: distance of the closest two, `told_apart`: least ratio of the
    distance of neighbours to their mean width (above 1 they do not overlap).
    """
    phase = since_impact(impacts)
    intervals = np.diff(np.flatnonzero(impacts))
    found: dict[str, Any] = {
        "regular": float(np.mean(intervals == period)) if intervals.size else 0.0,
        "spread": None,
        "separation": None,
        "told_apart": None,
        "closest": None,
    }
    groups = [points[phase == j] for j in range(period)]
    if min(group.size for group in groups) < 10:
        return found
    centre = np.array([np.median(group) for group in groups])
    width = np.array([np.quantile(group, 0.95) - np.quantile(group, 0.05) for group in groups])
    order = np.argsort(centre)
    apart = np.diff(centre[order])
    ratio = apart / np.maximum(0.5 * (width[order][1:] + width[order][:-1]), 1e-300)
    worst = int(np.argmin(ratio))
    found |= {
        "spread": float(width.max()),
        "separation": float(apart.min()),
        "told_apart": float(ratio[worst]),
        "closest": [int(order[worst]), int(order[worst + 1])],
    }
    return found


def noise_at(scene: Scene, period: int, strobes: int) -> dict[str, Any]:
    """p_m of Eq. (1) in noise, 15 % of its band below the upper edge."""
    keys = scene.single_mode
    edges = band(
        period, free_period=keys.free_period_s, decay_rate=keys.decay_rate_per_s, restitution=keys.restitution
    )
    frequency = edges.upper - SHARE_OF_BAND * (edges.upper - edges.lower)
    oscillator = single_mode_oscillator(scene, frequency)
    strobed = StroboscopicMap(oscillator=oscillator)
    fold = MaximalFamily.from_oscillator(oscillator, period=period).fold()
    row: dict[str, Any] = {
        "m": period,
        "frequency_hz": frequency,
        "band_hz": edges.upper - edges.lower,
        "born": born(strobed).period,
        "fold": None if fold is None else fold.excess,
        "upper_end": upper_end(strobed, period),
    }
    for kind in ("jitter", "drift"):
        points, impacts = noisy(strobed, strobed.tip, kind, strobes)
        row[kind] = clouds(points / scene.stop.gap_m, impacts, period)
    return row


def answers_of(
    scene: Scene,
    model: ModalModel,
    rows: Sequence[Mapping[str, Any]],
    noise: Sequence[Mapping[str, Any]],
    pool: Any,
) -> dict[str, Any]:
    """What the letter's errors can and cannot explain."""
    last = max(scene.drive.frequencies_hz)
    names = ("map", "single_mode", "beam")
    ten = [row for row in rows if row["frequency_hz"] == last and any(row[f"born_{n}"] == 10 for n in names)]
    period = next(
        row["born_beam"] for row in rows if row["frequency_hz"] == last and row["parameter"] == "none"
    )
    short = scene.replace(
        {"single_mode.free_period_s": scene.single_mode.free_period_s - FREE_PERIOD_ERROR_S}
    )
    jobs: dict[str, Callable[[], float | None]] = {}
    for name, strobed in (
        ("single_mode", StroboscopicMap(oscillator=single_mode_oscillator(scene, last))),
        ("single_mode_short_period", StroboscopicMap(oscillator=single_mode_oscillator(short, last))),
        ("beam", StroboscopicMap(oscillator=beam_of(scene, last, model))),
    ):
        jobs[f"p{period}_lives_up_to_{name}"] = lambda s=strobed: upper_end(s, period)  # type: ignore[misc]
        jobs[f"p10_born_from_{name}"] = lambda s=strobed: first_birth(s, 10)  # type: ignore[misc]
    futures = {name: pool.submit(job) for name, job in jobs.items()}
    merged = {
        kind: next((r["m"] for r in noise if (r[kind]["told_apart"] or 0.0) < 1.0), None)
        for kind in ("jitter", "drift")
    }
    irregular = {
        kind: next((r["m"] for r in noise if r[kind]["regular"] < 0.9), None) for kind in ("jitter", "drift")
    }
    hidden = [
        row["frequency_hz"]
        for row in rows
        if row["parameter"] == "none" and row["m"] > 1 and abs(row["fold_beam"] or 0.0) < NOISE
    ]
    return {
        "noise": NOISE,
        "periods_examined": [noise[0]["m"], noise[-1]["m"]],
        "first_period_with_merged_points": merged,
        "first_period_that_noise_breaks": irregular,
        "first_period_with_hysteresis_below_noise": next(
            (r["m"] for r in noise if r["fold"] is not None and abs(r["fold"]) < NOISE), None
        ),
        "frequencies_with_hysteresis_below_noise_hz": hidden,
        "changes_that_give_p10": [f"{r['parameter']} {r['change']}" for r in ten],
        "free_period_for_p10_at_grazing_s": 20.0 / (21.0 * last),
        **{name: future.result() for name, future in futures.items()},
    }


def number(value: float | None, form: str = "+.2e") -> str:
    """A number or its absence."""
    return "-" if value is None else format(value, form)


def sentences(scene: Scene, answers: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The answers in words."""
    merged, broken = answers["first_period_with_merged_points"], answers["first_period_that_noise_breaks"]
    last = max(scene.drive.frequencies_hz)
    base = {(row["frequency_hz"]): row for row in rows if row["parameter"] == "none"}

    def words(m: int | None) -> str:
        least, most = answers["periods_examined"]
        return f"none up to {most}" if m is None else f"{m} or less" if m == least else str(m)

    other = [
        row
        for row in rows
        if any(
            row[f"born_{n}"] != base[row["frequency_hz"]][f"born_{n}"] for n in ("map", "single_mode", "beam")
        )
    ]
    shortest = 1e3 * answers["free_period_for_p10_at_grazing_s"]
    lines = [
        f"Amplitude noise of {answers['noise']:.1e}, Eq. (1) near the upper edge of each band: the "
        f"closest strobe points of p_m run into one another from m = {words(merged['jitter'])} on with "
        f"jitter, {words(merged['drift'])} with drift; the order of the impacts itself is lost from m = "
        f"{words(broken['jitter'])} with jitter, {words(broken['drift'])} with drift; the hysteresis is "
        f"below the noise from m = {words(answers['first_period_with_hysteresis_below_noise'])} on.",
        "The hysteresis of the beam is below that noise at "
        + (", ".join(f"{f:.2f}" for f in answers["frequencies_with_hysteresis_below_noise_hz"]) or "none")
        + " Hz of the letter's frequencies.",
        f"{last:.2f} Hz: p10 at grazing needs T <= {shortest:.2f} ms; "
        f"changes that give it at excess 1e-3: {', '.join(answers['changes_that_give_p10']) or 'none'}. "
        "Without any change p10 is what is born from excess "
        f"{number(answers['p10_born_from_single_mode'])} (Eq. (1)) or "
        f"{number(answers['p10_born_from_beam'])} (beam) on: a first step past grazing of "
        f"{number(_microns(answers['p10_born_from_beam']), '.1f')} um of 2 mm skips p11.",
        "Born periods other than the scene's: "
        + (
            "; ".join(
                f"{row['frequency_hz']:.2f} Hz, {row['parameter']} {row['change']}: map {row['born_map']}, "
                f"Eq. (1) {row['born_single_mode']}, beam {row['born_beam']}"
                for row in other
            )
            or "none"
        )
        + ".",
    ]
    return lines


def _microns(excess: float | None) -> float | None:
    return None if excess is None else 1e6 * excess * DRIVE_AMPLITUDE_M


def draw_tornado(rows: Sequence[Mapping[str, Any]]) -> Any:
    """The fold after a change over the fold without it, one panel for each frequency."""
    frequencies = sorted({row["frequency_hz"] for row in rows})
    parameters = list(dict.fromkeys(row["parameter"] for row in rows if row["parameter"] != "none"))[::-1]
    columns = min(3, len(frequencies))
    lines = math.ceil(len(frequencies) / columns)
    figure, axes = new_figure(
        lines,
        columns,
        width=PAGE,
        height=(0.016 + 0.0044 * len(parameters)) * lines + 0.012,
        squeeze=False,
        sharey=True,
        sharex=True,
    )
    with house_style():
        for axis in axes.flat[len(frequencies) :]:
            axis.set_visible(False)
        for panel, (axis, frequency) in enumerate(zip(axes.flat, frequencies, strict=False)):
            here = [row for row in rows if row["frequency_hz"] == frequency]
            base = next(row for row in here if row["parameter"] == "none")
            for row in here:
                if row["parameter"] == "none":
                    continue
                place, raised = parameters.index(row["parameter"]), row["sign"] > 0
                for model, height, shift in (
                    ("beam", 0.23, 0.27 if raised else 0.03),
                    ("single_mode", 0.2, -0.24),
                ):
                    now, then = row[f"fold_{model}"], base[f"fold_{model}"]
                    if now is None and then is not None:
                        axis.plot(
                            0.23,
                            place + shift,
                            marker="x",
                            markersize=3,
                            color="#D55E00" if raised else "#0072B2",
                            clip_on=False,
                        )
                    if now is None or then is None or now * then <= 0 or abs(now / then - 1.0) < 1e-9:
                        continue
                    axis.barh(
                        place + shift,
                        now / then - 1.0,
                        height,
                        left=1.0,
                        zorder=2,
                        color=("#D55E00" if raised else "#0072B2") if model == "beam" else "white",
                        edgecolor="#D55E00" if raised else "#0072B2",
                        linewidth=0.6,
                        hatch=None if model == "beam" else "//////",
                    )
                if row["born_beam"] != base["born_beam"]:
                    words = f"p$_{{{row['born_beam']}}}$" if row["born_beam"] else "no period"
                    axis.annotate(
                        f"{words} at {row['change']}",
                        (0.99, place),
                        xycoords=("axes fraction", "data"),
                        ha="right",
                        va="center" if not raised else "top",
                        fontsize=6,
                    )
            axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3)
            axis.set_xscale("log")
            axis.set_xlim(0.22, 4.5)
            axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
            axis.minorticks_off()
            axis.set_yticks(range(len(parameters)), parameters)
            axis.set_ylim(-0.6, len(parameters) - 0.4)
            fold = (
                "no hysteresis"
                if base["fold_beam"] is None
                else f"hysteresis {_tex(format(-base['fold_beam'], '.1e'))}"
            )
            axis.set_title(
                f"({chr(ord('a') + panel)}) {frequency:.2f} Hz, p$_{{{base['m']}}}$, {fold}",
                fontsize=7,
            )
        figure.supxlabel("hysteresis after the change / before it (×: none is left)")
        from matplotlib.patches import Patch

        handles = [
            Patch(facecolor="#0072B2", label="lowered, beam"),
            Patch(facecolor="#D55E00", label="raised, beam"),
            Patch(facecolor="white", edgecolor="#0072B2", hatch="//////", label="lowered, Eq. (1)"),
            Patch(facecolor="white", edgecolor="#D55E00", hatch="//////", label="raised, Eq. (1)"),
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=4)
    return figure


def _tex(text: str) -> str:
    """1.2e-04 as a power of ten."""
    if "e" not in text:
        return text
    digits, power = text.split("e")
    return f"{digits}·10$^{{{int(power)}}}$"


def draw_points(stored: Mapping[str, Any], panels: Sequence[Mapping[str, Any]]) -> Any:
    """Strobe points of the beam in noise: all of them, and the closest two clouds."""
    figure, axes = new_figure(2, len(panels), width=PAGE, height=0.105, squeeze=False)
    looks = {"jitter": (PALETTE[1], -0.16, "o"), "drift": ("#D55E00", 0.16, "^")}
    with house_style():
        for column, panel in enumerate(panels):
            top, bottom = axes[:, column]
            low, high = panel["jitter"]["closest"] or panel["drift"]["closest"] or (0, 1)
            edges = []
            for kind, (colour, shift, mark) in looks.items():
                y, phase = 1e3 * stored[f"{panel['stem']}_{kind}"], stored[f"{panel['stem']}_{kind}_phase"]
                inside = (phase >= 0) & (phase < panel["m"])
                top.plot(
                    phase[inside] + shift,
                    y[inside],
                    linestyle="none",
                    marker=mark,
                    markersize=1.6,
                    color=colour,
                    markerfacecolor="none",
                    markeredgewidth=0.4,
                    label=kind,
                    rasterized=True,
                )
                two = [y[phase == j] for j in (low, high)]
                edges += [q for group in two if group.size for q in np.quantile(group, (0.03, 0.97))]
                looks_of = {"color": colour, "label": kind, "linewidth": 0.9}
                span = (min(edges), max(edges)) if edges else (0.0, 1.0)
                for number_, group in enumerate(two):
                    middle = 0.5 * (span[0] + span[1])
                    bottom.hist(
                        1e3 * (group - middle),
                        bins=40,
                        range=(-0.9e3 * (span[1] - span[0]), 0.9e3 * (span[1] - span[0])),
                        histtype="step" if kind == "jitter" else "stepfilled",
                        linestyle="-" if number_ == 0 else "--",
                        alpha=1.0 if kind == "jitter" else 0.45,
                        **looks_of,
                    )
            top.set_title(
                f"({chr(ord('a') + column)}) {panel['frequency_hz']:.2f} Hz, p$_{{{panel['m']}}}$", loc="left"
            )
            top.locator_params(axis="x", integer=True)
            label(top.xaxis, "strobes since the impact")
            ratio = number(panel["jitter"]["told_apart"], ".2g")
            bottom.set_title(f"distance/width {ratio} (jitter)", fontsize=7)
            label(bottom.xaxis, f"strobes {low} and {high}, offset", "µm")
        label(axes[0, 0].yaxis, "read-out", "mm")
        label(axes[1, 0].yaxis, "points")
        handles, names = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=2, markerscale=2.5)
    return figure


def draw_noise(noise: Sequence[Mapping[str, Any]]) -> Any:
    """Against m: how far the strobe points stay apart, and the amplitudes of p_m beside the noise."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.066)
    m = np.array([row["m"] for row in noise])
    with house_style():
        for kind, number_ in (("jitter", 1), ("drift", 2)):
            y = np.array(
                [math.nan if row[kind]["told_apart"] is None else row[kind]["told_apart"] for row in noise]
            )
            axes[0].plot(
                m,
                y,
                color=PALETTE[number_],
                marker="o^"[number_ - 1],
                linestyle=("-", "--")[number_ - 1],
                markerfacecolor="none",
                label=kind,
            )
            lost = np.array([row[kind]["regular"] < 0.9 for row in noise])
            if not np.any(lost):
                continue
            axes[0].plot(
                m[lost],
                np.full(lost.sum(), (0.04, 0.03)[number_ - 1]),
                linestyle="none",
                marker="x",
                markersize=4,
                color=PALETTE[number_],
                label=f"{kind}: order of impacts lost",
            )
        axes[0].axhline(1.0, color="0.4", linewidth=0.7)
        axes[0].set_yscale("log")
        axes[0].axvline(10, color="0.6", linestyle=":", linewidth=0.8)
        axes[0].set_title("(a) strobe points told apart above 1", loc="left")
        label(axes[0].yaxis, "distance of neighbours / width of clouds")
        for key, name, number_ in (("fold", "hysteresis of p$_m$", 0), ("upper_end", "p$_m$ lives up to", 3)):
            y = np.array([math.nan if row[key] is None else abs(row[key]) for row in noise])
            axes[1].plot(
                m,
                y,
                color=PALETTE[number_],
                marker="sD"[number_ > 0],
                linestyle=("-", "--")[number_ > 0],
                markerfacecolor="none",
                label=name,
            )
        axes[1].axhline(NOISE, color="0.4", linewidth=0.7)
        axes[1].annotate(
            "noise, 2.5·10$^{-4}$", (0.02, NOISE), xycoords=("axes fraction", "data"), va="top", fontsize=7
        )
        axes[1].axvline(10, color="0.6", linestyle=":", linewidth=0.8)
        axes[1].set_yscale("log")
        axes[1].set_title("(b) amplitudes beside the noise", loc="left")
        label(axes[1].yaxis, "|F/F$_g$ - 1|")
        for axis in axes:
            label(axis.xaxis, "m")
            axis.set_xticks(m)
            axis.legend(loc="best")
    return figure


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the transitions need a harmonic drive")
    if scene.spring.kind == "modal_data":
        raise ValueError("spring.kind is modal_data; this study varies the dimensions of a spring")
    frequencies = sorted(scene.drive.frequencies_hz)
    todo = changes_of(scene, request.quick)
    model = model_of(scene)
    strobes = 400 + SKIPPED if request.quick else STROBES
    range_of_m = range(8, 12) if request.quick else PERIOD_RANGE
    failures: list[str] = []
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        noise_futures = [pool.submit(noise_at, scene, m, strobes) for m in range_of_m]
        first = list(pool.map(lambda f: row_at(scene, model, f, None, None), frequencies))
        rows = [row for row, _ in first]

        def of_change(change: Change) -> list[dict[str, Any]]:
            try:
                there, modes = changed(scene, change)
            except ValueError as error:
                failures.append(f"{change.parameter} {change.text}: {error}")
                return []
            return [
                row_at(there, modes, f, change, base)[0]
                for f, (_, base) in zip(frequencies, first, strict=True)
            ]

        with request.progress("changes", total=len(todo)) as progress:
            for found in pool.map(of_change, todo):
                rows += found
                progress.advance()
        noise = [future.result() for future in noise_futures]
        answers = answers_of(scene, model, rows, noise, pool)
        shown = [f for f in (20.90, 22.60, 23.40) if f in frequencies] or frequencies[:3]
        panels, stored = [], {}
        for f in shown:
            strobed = StroboscopicMap(oscillator=beam_of(scene, f, model))
            m = next(row["m"] for row in rows if row["frequency_hz"] == f and row["parameter"] == "none")
            stem = f"beam_{f:.2f}_hz".replace(".", "p")
            panel: dict[str, Any] = {"frequency_hz": f, "m": m, "stem": stem}
            for kind in ("jitter", "drift"):
                points, impacts = noisy(strobed, lambda p, s=strobed: s.readout(p, "readout"), kind, strobes)  # type: ignore[misc]
                stored[f"{stem}_{kind}"], stored[f"{stem}_{kind}_phase"] = points, since_impact(impacts)
                panel[kind] = clouds(points, impacts, m) if m > 1 else clouds(points, impacts, 2)
            panels.append(panel)
    request.record.write_arrays("strobe_points", **stored)
    names = (
        "frequency_hz",
        "parameter",
        "change",
        "born_map",
        "born_single_mode",
        "born_beam",
        "fold_map",
        "fold_single_mode",
        "fold_beam",
    )
    request.record.write_table(
        "sensitivity", {n: [math.nan if row[n] is None else row[n] for row in rows] for n in names}
    )
    request.record.write_table("noise", _noise_columns(noise))
    request.record.write_figure(draw_tornado(rows), "fold_against_parameter")
    request.record.write_figure(draw_points(stored, panels), "strobe_points")
    request.record.write_figure(draw_noise(noise), "noise")
    answers["words"] = sentences(scene, answers, rows)
    print(
        f"{'f (Hz)':>7} {'parameter':>24} {'change':>9} {'born: map, Eq. (1), beam':>26}   "
        "fold: map, Eq. (1), beam"
    )
    for row in rows:
        periods = ", ".join(f"p{row[f'born_{n}']}" for n in ("map", "single_mode", "beam"))
        folds = ", ".join(number(row[f"fold_{n}"], "+.3e") for n in ("map", "single_mode", "beam"))
        print(f"{row['frequency_hz']:7.2f} {row['parameter']:>24} {row['change']:>9} {periods:>26}   {folds}")
    for line in [*failures, *answers["words"]]:
        print(line, flush=True)
    return {
        "rows": rows,
        "answers": answers,
        "noise": noise,
        "beam_in_noise": panels,
        "failures": failures,
        "failed_cells": len(failures),
    }


def _noise_columns(noise: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """The table of the noise."""
    found: dict[str, list[Any]] = {
        name: [math.nan if row[name] is None else row[name] for row in noise]
        for name in ("m", "frequency_hz", "band_hz", "born", "fold", "upper_end")
    }
    for kind in ("jitter", "drift"):
        for name in ("regular", "spread", "separation", "told_apart"):
            found[f"{kind}_{name}"] = [
                math.nan if row[kind][name] is None else row[kind][name] for row in noise
            ]
    return found


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "sensitivity", "The six transitions under the letter's errors, noise and open assumptions.", run, argv
    )


if __name__ == "__main__":
    raise SystemExit(main())
