"""What the spring settles on: period, impacts and Lyapunov exponent, and which starts lead where.

Claim (letter 1996): besides the p_m orbits "other transitions" occur, which "may even be to chaotic states",
and below grazing p_m and the motion without impacts coexist.

Computed at one drive frequency (--frequency, 21.50 Hz) for Eq. (1) and for the beam with its N modes:

    period, impacts     of the settled orbit in an upward and a downward scan that carry the state along
    lyapunov_map        largest exponent per drive period, from the Jacobians of the period map
    lyapunov_flow       the same per second, from two neighbouring motions: an independent route
    kind                periodic, chaotic (exponent above zero by three standard errors), not settled (below
                        zero by as much: a long period or a slow transient), or undecided
    basins              for Eq. (1) at --basin-excess (-0.006): where each start on the strobe plane leads

Both exponents are one number, lyapunov_map = lyapunov_flow / f.

Run time: some minutes; --quick some ten seconds.  Command: python -m studies.attractors.
Outputs: summary.json, attractors.png and .pdf, basins.png and .pdf (the strobe plane, and close to p1),
rows.csv, attractors.npz, basins.npz, basins_close.npz.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from typing import Any, TypeVar

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D

from contact.errors import ContactError
from contact.orbits.lyapunov import (
    Differentiable,
    divergence_rate,
    map_exponents,
    of_oscillator,
    orbit_exponents,
)
from contact.simulation import steady_motion
from contact.stroboscope import StrobedMap, StroboscopicMap
from contact.trajectory import State
from studies.instruments.command_line import Request, run_study
from studies.instruments.figures import COLUMN, PAGE, house_style, label, new_figure
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.periodicity import settle
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of

S = TypeVar("S")

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}
SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

WITHOUT, PERIODIC, CHAOTIC = "without impacts", "periodic", "chaotic"
NOT_SETTLED, UNDECIDED = "not settled", "undecided"
COLOURS = {
    WITHOUT: "#56B4E9",
    PERIODIC: "#0072B2",
    CHAOTIC: "#D55E00",
    NOT_SETTLED: "#E69F00",
    UNDECIDED: "0.5",
}
SHAPES = {WITHOUT: "v", PERIODIC: "o", CHAOTIC: "s", NOT_SETTLED: "^", UNDECIDED: "x"}


@dataclass(frozen=True, kw_only=True)
class Attractor:
    """What a motion settled on.

    `period` in drive periods, 0 for none; `impacts` in one such period, or `impacts_per_period` on average;
    `lyapunov_map` per drive period and `lyapunov_flow` [1/s] with their standard errors; `kind` as in the
    module's docstring.
    """

    kind: str
    period: int
    impacts: int
    impacts_per_period: float
    lyapunov_map: float
    error_map: float
    lyapunov_flow: float
    error_flow: float


def classify(
    strobed: StrobedMap[S],
    state: S,
    derivatives: Callable[[Any], Differentiable[Any]] = of_oscillator,
    *,
    most_cycles: int = 4000,
    cycles: int = 600,
    largest_period: int = 64,
    flow: bool = True,
) -> Attractor:
    """Settle from `state`, then tell chaos from a long period or a slow transient by the exponents.

    Parameters
    ----------
    strobed : StrobedMap
        At its amplitude.
    state : State
        Where to start.
    derivatives : callable
        From the strobed map to its derivatives; `of_oscillator` by default.
    most_cycles, largest_period : int
        Bounds of settling, as in `settle`.
    cycles : int
        Drive periods in the averages.
    flow : bool
        Whether the second route is taken as well; without it those fields are not numbers.

    Raises
    ------
    ContactError
        If the motion could not be followed.
    """
    system = derivatives(strobed)
    settled = settle(strobed, state, most_cycles=most_cycles, largest_period=largest_period)
    if settled.period:
        exponents = orbit_exponents(system, settled.end, settled.period)
        impacts, mean = settled.impacts, settled.impacts / settled.period
        kind = PERIODIC if impacts else WITHOUT
    else:
        exponents, _end = map_exponents(system, settled.end, cycles, align=ALIGN)
        counted = strobed.orbit(settled.end, cycles).impacts
        impacts, mean = 0, float(counted.mean())
        clear = abs(exponents.largest) > SIGNIFICANT * exponents.error
        kind = UNDECIDED if not clear else CHAOTIC if exponents.largest > 0 else NOT_SETTLED
    rate = error = float("nan")
    if flow:
        found = divergence_rate(system, settled.end, cycles * system.period, align=ALIGN * system.period)
        rate, error = found.largest, found.error
    return Attractor(
        kind=kind,
        period=settled.period,
        impacts=impacts,
        impacts_per_period=mean,
        lyapunov_map=exponents.largest,
        error_map=exponents.error,
        lyapunov_flow=rate,
        error_flow=error,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """A state of a scan and what is drawn of it: `tip`, its strobed read-out, (record_cycles,) [m]."""

    model: str
    direction: str
    excess: float
    state: State
    tip: np.ndarray


def carried(
    strobed: StroboscopicMap, name: str, values: np.ndarray, scene: Scene, readout: str = "readout"
) -> tuple[list[Start], list[str]]:
    """Upward and downward scan of one model: the state is carried from one amplitude to the next."""
    found, failures = [], []
    state = strobed.at(float(values[0])).steady()
    for direction, ordered in (("up", values), ("down", values[::-1])):
        for excess in ordered:
            here = strobed.at(float(excess))
            try:
                settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
                orbit = here.orbit(settled.end, scene.scan.record_cycles)
            except ContactError as error:
                failures.append(f"{TITLES[name]}, excess {excess:.6g}: {error}")
                continue
            state = replace(settled.end, time=0.0)
            tip = here.readout(orbit.points, readout)
            found.append(Start(model=name, direction=direction, excess=float(excess), state=state, tip=tip))
    return found, failures


def row_of(strobed: StroboscopicMap, start: Start, cycles: int, settle_cycles: int) -> dict[str, Any]:
    """One row of the table."""
    head = {"model": start.model, "direction": start.direction, "excess": start.excess}
    try:
        found = classify(strobed.at(start.excess), start.state, cycles=cycles, most_cycles=settle_cycles)
    except ContactError as error:
        empty = {"period": None, "impacts": None, "lyapunov_map": None, "lyapunov_flow": None}
        return {**head, **empty, "kind": UNDECIDED, "failure": f"{TITLES[start.model]}: {error}"}
    return {**head, **asdict(found), "failure": ""}


# basins ---------------------------------------------------------------------------------------------------

FAR, CLOSE = 1.5, 0.03
"""Half the sides of the two planes of starts, in x/gap and x'/(2 pi f gap): all of it, and around p1."""

NEAR = 1e-5
"""Distance from an orbit at which a motion has reached it, in gaps (a basin narrower than that is missed)."""

MOST_PERIODS = 4000
"""Bound of a motion in the basins; what has not been told by then is counted as something else."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Basins:
    """Starts on the strobe plane and where they lead.

    `x` [m] and `velocity` [m/s] of the starts, `rest` those of p1; `leads`, shape (velocities, x): 1 motion
    without impacts, m for the p_m orbit, 0 something else, -1 starts behind the wall; `orbit`, shape (m, 2):
    strobe points of p_m.
    """

    x: np.ndarray
    velocity: np.ndarray
    leads: np.ndarray
    orbit: np.ndarray
    rest: tuple[float, float]
    period: int

    def parts(self) -> dict[str, float]:
        """Part of the starts before the wall that leads to each."""
        before = self.leads >= 0
        names = {1: "p1 without impacts", self.period: f"p{self.period}", 0: "something else"}
        return {name: float(np.mean(self.leads[before] == code)) for code, name in names.items()}


def basins(
    scene: Scene,
    frequency: float,
    excess: float,
    side: int,
    workers: int,
    tell: Callable[[], None],
    *,
    close: bool = False,
) -> Basins:
    """Basins of Eq. (1) between fold and grazing on a grid of `side` by `side` starts, all or `close` to p1.

    A motion has settled on p1 when the envelope of its deviation is smaller than what is left to the wall:
    then it never touches again.  It has settled on p_m at a distance `NEAR` of one of its points.
    """
    strobed = StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency))
    here = strobed.at(excess)
    motion, gap = here.oscillator.motion(), here.oscillator.stop.gap
    born = settle(strobed.at(1e-3), strobed.steady(), most_cycles=MOST_PERIODS)
    below = strobed.at(1e-3)
    state = born.end
    for part in np.linspace(0.0, 1.0, 9):  # carry p_m down to the excess
        below = strobed.at(1e-3 + part * (excess - 1e-3))
        state = settle(below, state, most_cycles=MOST_PERIODS).end
    end = settle(here, state, most_cycles=MOST_PERIODS)
    period = end.period
    orbit = end.points[-period:] if period else end.points[-1:]
    q, q_rate = steady_motion(motion, np.zeros(1))
    weight = float(here.oscillator.model.phi[0])
    omega, damped, half = float(motion.omega[0]), float(motion.damped[0]), 0.5 * float(motion.decay[0])
    speed = 2.0 * np.pi * frequency
    rest = (weight * float(q[0, 0]), weight * float(q_rate[0, 0]))
    grid = np.linspace(-1.0, 1.0, side)
    x = rest[0] + CLOSE * gap * grid if close else np.linspace(-FAR, 1.0, side) * gap
    velocity = rest[1] + CLOSE * speed * gap * grid if close else FAR * speed * gap * grid

    def envelope(points: np.ndarray) -> np.ndarray:
        u = points[:, 0] / weight - q[0, 0]
        v = points[:, 1] * omega / weight - q_rate[0, 0]
        return weight * np.hypot(u, (v + half * u) / damped)

    room = -excess * gap  # between the steady peak and the wall

    def line(j: int) -> np.ndarray:
        leads = np.zeros(side, dtype=np.int64)
        for i in range(side):
            now = State(displacement=np.array([x[i] / weight]), velocity=np.array([velocity[j] / weight]))
            if x[i] >= gap:
                leads[i] = -1
                continue
            try:
                for _ in range(MOST_PERIODS // 32):
                    run = here.orbit(now, 32)
                    now = run.end
                    if envelope(run.points[-1:])[0] < room:
                        leads[i] = 1
                        break
                    if period > 1 and np.min(np.max(np.abs(orbit - run.points[-1]), axis=1)) < NEAR * gap:
                        leads[i] = period
                        break
            except ContactError:
                pass
        tell()
        return leads

    with ThreadPoolExecutor(max_workers=workers) as pool:
        leads = np.array(list(pool.map(line, range(side))))
    points = np.column_stack([orbit[:, 0], orbit[:, 1] * omega])
    return Basins(x=x, velocity=velocity, leads=leads, orbit=points, rest=rest, period=period)


# figures --------------------------------------------------------------------------------------------------


def draw_scan(
    starts: Sequence[Start], rows: Sequence[Mapping[str, Any]], frequency: float, quantity: str
) -> Any:
    """Strobe points and exponents against the excess, a column for each model."""
    names = [name for name in TITLES if any(row["model"] == name for row in rows)]
    figure, axes = new_figure(
        2, len(names), width=PAGE if len(names) > 1 else COLUMN, height=0.105, squeeze=False, sharex="col"
    )
    for column, name in enumerate(names):
        upper, lower = axes[:, column]
        for direction, colour, face, size in (
            ("down", "#D55E00", "none", 2.6),
            ("up", "#0072B2", "#0072B2", 1.4),
        ):
            chosen = [start for start in starts if start.model == name and start.direction == direction]
            across = np.concatenate([np.full(start.tip.size, start.excess) for start in chosen])
            upper.plot(
                1e2 * across,
                1e3 * np.concatenate([start.tip for start in chosen]),
                linestyle="none",
                marker="o",
                markersize=size,
                markeredgewidth=0.4,
                markeredgecolor=colour,
                markerfacecolor=face,
                label=f"{direction}ward scan",
                rasterized=True,
                zorder=2 if direction == "down" else 3,
            )
        mine = [row for row in rows if row["model"] == name and row["lyapunov_map"] is not None]
        lower.axhline(0.0, color="0.6", linewidth=0.6)
        for kind in SHAPES:
            alike = [row for row in mine if row["kind"] == kind]
            lower.plot(
                [1e2 * row["excess"] for row in alike],
                [row["lyapunov_map"] for row in alike],
                linestyle="none",
                marker=SHAPES[kind],
                markersize=3.4,
                markerfacecolor="none",
                markeredgewidth=0.7,
                markeredgecolor=COLOURS[kind],
            )
        lower.plot(
            [1e2 * row["excess"] for row in mine],
            [row["lyapunov_flow"] / frequency for row in mine],
            linestyle="none",
            marker=".",
            markersize=1.6,
            color="black",
            zorder=4,
        )
        for axis in (upper, lower):
            axis.axvline(0.0, color="0.6", linewidth=0.6, linestyle="--", zorder=1)
        with house_style():
            upper.set_title(f"({chr(ord('a') + column)}) {TITLES[name]}, {frequency:.2f} Hz")
            label(lower.xaxis, "excess F/F$_g$ - 1", "%")
            if column == 0:
                label(
                    upper.yaxis, *(("rotation", "mrad") if quantity == "rotation" else ("displacement", "mm"))
                )
                label(lower.yaxis, "largest exponent per drive period")
    kinds = [kind for kind in SHAPES if any(row["kind"] == kind for row in rows)]
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=SHAPES[kind],
            markersize=3.8,
            markerfacecolor="none",
            markeredgecolor=COLOURS[kind],
            label=kind,
        )
        for kind in kinds
    ] + [Line2D([], [], linestyle="none", marker=".", markersize=3, color="black", label="from two motions")]
    scans = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=3,
            markerfacecolor=face,
            markeredgecolor=colour,
            label=f"{way}ward scan",
        )
        for way, colour, face in (("up", "#0072B2", "#0072B2"), ("down", "#D55E00", "none"))
    ]
    with house_style():
        figure.legend(
            handles=[*scans, *handles], loc="outside lower center", ncols=3 if len(names) > 1 else 2
        )
    return figure


def draw_basins(planes: Sequence[Basins], frequency: float, excess: float, gap: float) -> Any:
    """The strobe plane and a part of it, coloured by where the points lead."""
    figure, axes = new_figure(1, 2, width=PAGE, height=0.082)
    period = planes[0].period
    codes = {1: 0, period: 1, 0: 2}
    colours = ("#CFE8F7", "#0072B2", "#E69F00")
    speed = 2.0 * np.pi * frequency * gap
    for number, (axis, found) in enumerate(zip(axes, planes, strict=True)):
        picture = np.full(found.leads.shape, np.nan)
        for code, place in codes.items():
            picture[found.leads == code] = place
        x, y = found.x / gap, found.velocity / speed
        axis.imshow(
            picture,
            origin="lower",
            aspect="auto",
            interpolation="nearest",
            vmin=-0.5,
            vmax=2.5,
            cmap=ListedColormap(colours),
            extent=(x[0], x[-1], y[0], y[-1]),
        )
        marks = {"white": found.orbit / (gap, speed), "#D55E00": np.array([found.rest]) / (gap, speed)}
        for colour, places in marks.items():
            inside = (abs(places[:, 0] - x.mean()) < np.ptp(x) / 2) & (
                abs(places[:, 1] - y.mean()) < np.ptp(y) / 2
            )
            axis.plot(
                places[inside, 0],
                places[inside, 1],
                linestyle="none",
                marker="o" if colour == "white" else "D",
                markersize=4,
                markerfacecolor=colour,
                markeredgecolor="black",
                markeredgewidth=0.7,
            )
        parts = found.parts()
        with house_style():
            where = "the strobe plane" if number == 0 else "around p$_1$"
            axis.set_title(
                f"({'ab'[number]}) {where}: {100 * parts['p1 without impacts']:.1f} % lead to p$_1$"
            )
            label(axis.xaxis, "x / gap at the strobe")
            if number == 0:
                label(axis.yaxis, "x′ / (2π f gap) at the strobe")
    names = {1: "to p$_1$ without impacts", period: f"to p$_{{{period}}}$", 0: "to something else"}
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker="s",
            markersize=5,
            markerfacecolor=colours[place],
            markeredgecolor="0.4",
            markeredgewidth=0.4,
            label=names[code],
        )
        for code, place in codes.items()
        if any(np.any(found.leads == code) for found in planes)
    ]
    for marker, colour, name in (("o", "white", f"points of p$_{{{period}}}$"), ("D", "#D55E00", "p$_1$")):
        handles.append(
            Line2D(
                [],
                [],
                linestyle="none",
                marker=marker,
                markersize=4,
                markerfacecolor=colour,
                markeredgecolor="black",
                label=name,
            )
        )
    with house_style():
        figure.suptitle(f"Eq. (1), {frequency:.2f} Hz, F/F$_g$ - 1 = {excess:g}", fontsize=8)
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def agreement(rows: Sequence[Mapping[str, Any]], frequency: float) -> dict[str, float | None]:
    """Largest difference of both routes on periodic orbits, and on chaos in standard errors."""
    regular, chaos = [], []
    for row in rows:
        if row["lyapunov_map"] is None:
            continue
        difference = abs(row["lyapunov_map"] - row["lyapunov_flow"] / frequency)
        if row["period"]:
            regular.append(difference)
        else:
            chaos.append(difference / float(np.hypot(row["error_map"], row["error_flow"] / frequency)))
    return {"periodic": max(regular, default=None), "chaotic_in_standard_errors": max(chaos, default=None)}


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    began = time.perf_counter()
    options, quick = request.options, request.quick
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; attractors need a harmonic drive")
    frequency, low, high = options.frequency, options.lowest, options.highest
    if not -1.0 < low < high:
        raise ValueError(f"lowest is {low} and highest {high}; -1 < lowest < highest must hold")
    names = [name for name in TITLES if options.model in (name, "both")]
    count = min(options.points, 11) if quick else options.points
    values = np.linspace(low, high, count)
    maps = {}
    if "single_mode" in names:
        maps["single_mode"] = StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency))
    if "beam" in names:
        model = model_of(scene)
        scene.refuse_drive_above(float(model.frequencies_hz.max()))
        maps["beam"] = StroboscopicMap(oscillator=beam_of(scene, frequency, model))
    starts: list[Start] = []
    failures: list[str] = []
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        for scanned, failed in pool.map(lambda name: carried(maps[name], name, values, scene), names):
            starts += scanned
            failures += failed
        cycles = min(options.cycles, 100) if quick else options.cycles
        with request.progress("exponents", total=len(starts)) as progress:

            def one(start: Start) -> dict[str, Any]:
                row = row_of(maps[start.model], start, cycles, scene.scan.settle_cycles)
                progress.advance()
                return row

            rows = list(pool.map(one, starts))
    failures += [row.pop("failure") for row in rows if row["failure"]]
    for row in rows:
        row.pop("failure", None)
    request.record.write_json("rows", rows)
    columns = sorted({key for row in rows for key in row})
    request.record.write_table("rows", {key: [row.get(key) for row in rows] for key in columns})
    request.record.write_arrays(
        "attractors",
        tip=np.array([start.tip for start in starts]),
        excess=np.array([s.excess for s in starts]),
    )
    request.record.write_figure(draw_scan(starts, rows, frequency, scene.readout.quantity), "attractors")
    side = min(options.side, 32) if quick else options.side
    excess = options.basin_excess
    with request.progress("basins", total=2 * side) as progress:
        plane, part = (
            basins(scene, frequency, excess, side, request.workers, progress.advance, close=close)
            for close in (False, True)
        )
    for name, found in (("basins", plane), ("basins_close", part)):
        request.record.write_arrays(
            name, x=found.x, velocity=found.velocity, leads=found.leads, orbit=found.orbit
        )
    request.record.write_figure(draw_basins((plane, part), frequency, excess, scene.stop.gap_m), "basins")
    chaotic = {
        name: [row["excess"] for row in rows if row["model"] == name and row["kind"] == CHAOTIC]
        for name in names
    }
    agree = agreement(rows, frequency)
    lines = []
    for name in names:
        kinds = {kind: sum(r["model"] == name and r["kind"] == kind for r in rows) for kind in SHAPES}
        lines.append(f"{TITLES[name]}: " + ", ".join(f"{n} {kind}" for kind, n in kinds.items() if n))
        if chaotic[name]:
            lines.append(
                f"{TITLES[name]}: chaos from excess {min(chaotic[name]):+.4f} to {max(chaotic[name]):+.4f}"
            )
    lines.append(
        "basins: " + ", ".join(f"{100 * share:.1f} % {name}" for name, share in plane.parts().items())
    )
    for line in [*failures, *lines]:
        print(line, flush=True)
    return {
        "frequency_hz": frequency,
        "rows": rows,
        "chaotic": chaotic,
        "agreement": agree,
        "basins": {
            "excess": excess,
            "period": plane.period,
            "parts": plane.parts(),
            "parts_close": part.parts(),
            "close": CLOSE,
        },
        "closing": lines,
        "failures": failures,
        "failed_cells": len(failures),
        "wall_s": time.perf_counter() - began,
    }


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own options."""
    parser.add_argument(
        "--frequency", type=float, default=21.50, metavar="HZ", help="drive frequency (21.50)"
    )
    parser.add_argument("--model", choices=(*TITLES, "both"), default="both", help="which description (both)")
    parser.add_argument("--lowest", type=float, default=-0.016, help="lowest excess of the scan (-0.016)")
    parser.add_argument("--highest", type=float, default=0.06, help="highest excess of the scan (0.06)")
    parser.add_argument("--points", type=int, default=39, help="amplitudes of the scan (39)")
    parser.add_argument("--cycles", type=int, default=600, help="drive periods in the averages (600)")
    parser.add_argument("--basin-excess", type=float, default=-0.006, help="excess of the basins (-0.006)")
    parser.add_argument("--side", type=int, default=200, help="starts along each side of the basins (200)")


def main(argv: Sequence[str] | None = None, *, module: str | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "attractors",
        "Period, impacts and Lyapunov exponent of the settled motion, and basins of attraction.",
        run,
        argv,
        options=add_options,
        module=module,
    )


if __name__ == "__main__":
    raise SystemExit(main())
