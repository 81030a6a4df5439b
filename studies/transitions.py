"""The letter's six transitions p1 <-> pm, in three descriptions side by side.

Claim (letter 1996, Fig. 2): when the drive amplitude passes grazing, the motion without impacts gives way to
an orbit of period m with one impact, m = 3, 4, 5, 6, 8, 10 at 20.90 ... 23.40 Hz; when the amplitude is
lowered again, that orbit lives on until some way below grazing.

Computed, at each frequency, for the Nordmark map (Eqs. (2), (3)), the single mode (Eq. (1)) and the beam with
its N modes:

    born period      period of the settled orbit at F/F_g - 1 = 1e-3 (and 2.5e-4, 1e-2), started below grazing
    excess_down      F/F_g - 1 at which that orbit ends when the amplitude is lowered: bracketed by a scan,
                     and then the fold, period doubling or grazing (ends_by) that is in the bracket
    orbit diagram    strobed points in an upward and a downward scan that carry the physical state along

Run time: some seconds; --quick half of that; --full (10000 drive periods per amplitude, as in the experiment)
some minutes.  Command: python -m studies.transitions.  Outputs: summary.json, orbit_diagram.png and .pdf (the
beam at its read-out point), orbit_diagram_single_mode, orbit_diagram_map, the points as csv and
npz; and results/report/index.html, the report of everything that is stored there (``studies.report``).
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from beam import ModalModel
from contact.errors import ContactError
from contact.nordmark import StrobedNordmarkMap
from contact.orbits import OrbitDiagram, born, born_period, orbit_diagram, orbit_end
from contact.stroboscope import StrobedMap, StroboscopicMap
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import DONE, FAILED_CELLS, Request, run_study
from studies.instruments.oscillators import beam_of, nordmark_of, single_mode_oscillator
from studies.instruments.report.writing import told_report
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.transition_figures import draw, store_points
from studies.published import PERIODS, SETTLE_CYCLES

MODELS = ("map", "single_mode", "beam")
TITLES = {"map": "Nordmark map", "single_mode": "Eq. (1)", "beam": "beam"}
OTHER_EXCESSES = (2.5e-4, 1e-2)
"""Where the born period is given as well: the letter's amplitude stability, and well above grazing."""


@dataclass(frozen=True, kw_only=True)
class Description:
    """One model at one frequency, with what is drawn of it."""

    strobed: Any
    observe: Callable[[np.ndarray], np.ndarray]


def describe(scene: Scene, frequency: float, model: ModalModel) -> dict[str, Description]:
    """The three descriptions at `frequency` [Hz]; displacements are observed in metres."""
    single = StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency))
    beam = StroboscopicMap(oscillator=beam_of(scene, frequency, model))
    return {
        "map": Description(
            strobed=StrobedNordmarkMap(map=nordmark_of(scene, frequency)), observe=lambda points: points[:, 0]
        ),
        "single_mode": Description(strobed=single, observe=single.tip),
        "beam": Description(strobed=beam, observe=lambda points: beam.readout(points, "readout")),
    }


def transition(strobed: StrobedMap[Any], excess: float, cycles: int) -> dict[str, Any]:
    """Born periods, 0 where the motion did not settle, and the end of the orbit on the way down."""
    orbit = born(strobed, excess, most_cycles=cycles)
    end = orbit_end(strobed, orbit.end, excess, most_cycles=cycles) if orbit.period > 1 else None
    return {
        "period": orbit.period,
        "excess_down": None if end is None else end.excess,
        "ends_by": None if end is None else end.kind,
        "bracket": None if end is None else [end.lost, end.held],
        "also": {
            f"{other:g}": born_period(strobed, other, most_cycles=cycles) for other in OTHER_EXCESSES
        },
    }


def row_at(scene: Scene, frequency: float, model: ModalModel) -> dict[str, Any]:
    """One row of the table."""
    scan = scene.scan
    row: dict[str, Any] = {"frequency_hz": frequency, "letter": PERIODS.get(frequency)}
    failures = []
    for name, description in describe(scene, frequency, model).items():
        try:
            found = transition(description.strobed, scan.born_excess, max(scan.settle_cycles, 1))
        except ContactError as error:
            failures.append(f"{frequency:g} Hz, {TITLES[name]}: {error}")
            found = {"period": None, "excess_down": None, "ends_by": None, "bracket": None, "also": {}}
        row[name] = found["period"]
        row[f"excess_down_{name}"] = found["excess_down"]
        row[f"ends_by_{name}"] = found["ends_by"]
        row[f"bracket_{name}"] = found["bracket"]
        row[f"born_{name}"] = found["also"]
    row["not_settled"] = [
        f"{TITLES[name]} at {excess}"
        for name in MODELS
        for excess, period in ({f"{scan.born_excess:g}": row[name]} | row[f"born_{name}"]).items()
        if period == 0
    ]
    if scene.contact.law == "hertz":
        row |= linear_instead(scene, frequency, model, failures)
    row["failures"] = failures
    return row


def linear_instead(
    scene: Scene, frequency: float, model: ModalModel, failures: list[str]
) -> dict[str, float | None]:
    """What the beam does with linear contact of the same contact time in place of Hertz's law."""
    beam = describe(scene.replace({"contact.law": "linear"}), frequency, model)["beam"]
    try:
        found = transition(beam.strobed, scene.scan.born_excess, max(scene.scan.settle_cycles, 1))
    except ContactError as error:
        failures.append(f"{frequency:g} Hz, beam with linear contact: {error}")
        return {"beam_linear": None, "excess_down_beam_linear": None}
    return {"beam_linear": found["period"], "excess_down_beam_linear": found["excess_down"]}


def amplitudes(scene: Scene, row: Mapping[str, Any]) -> np.ndarray:
    """The excesses of the scans: on both sides of grazing, in proportion to the largest hysteresis found.

    That is taken to two digits, so that the last bit of an end moves no amplitude, and none lies on a fold.
    """
    scan = scene.scan
    ends = [abs(row[f"excess_down_{name}"] or 0.0) for name in MODELS]
    reach = float(f"{max(*ends, scan.narrowest):.2g}")
    return np.linspace(-scan.reach_below * reach, scan.reach_above * reach, scan.points)


def scans(
    scene: Scene, row: Mapping[str, Any], model: ModalModel, full: bool, tell: Callable[[], None]
) -> dict[str, dict[str, OrbitDiagram[Any]]]:
    """Upward and downward scan of each description."""
    scan, found = scene.scan, {}
    for name, description in describe(scene, row["frequency_hz"], model).items():
        values = amplitudes(scene, row)
        common: dict[str, Any] = {
            "observe": description.observe,
            "settle_cycles": SETTLE_CYCLES if full else max(scan.settle_cycles, 1),
            "record_cycles": scan.record_cycles,
            "largest_period": scan.largest_period,
            "early": not full,
            "after_each": tell,
        }
        up = orbit_diagram(description.strobed, values, description.strobed.at(values[0]).steady(), **common)
        down = orbit_diagram(description.strobed, values[::-1], up.end, **common)
        found[name] = {"up": up, "down": down}
    return found


HEAD = f"{'f (Hz)':>7} {'letter':>7} {'map':>5} {'Eq. (1)':>8} {'beam':>5}   " + " ".join(
    f"{'end, ' + TITLES[name]:>20}" for name in MODELS
)


def word(period: int | None) -> str:
    """How the table and the sentences name a period."""
    return f"p{period}" if period else "-" if period is None else "not settled"


def table_line(row: Mapping[str, Any]) -> str:
    """A row of the table on the terminal."""
    periods = {name: word(row[name]) for name in MODELS}
    ends = [
        "-" if row[f"excess_down_{name}"] is None
        else f"{row[f'excess_down_{name}']:+.4e} {row[f'ends_by_{name}']}"
        for name in MODELS
    ]
    return (
        f"{row['frequency_hz']:7.2f} {word(row['letter']):>7} {periods['map']:>5} "
        f"{periods['single_mode']:>8} {periods['beam']:>5}   " + " ".join(f"{end:>20}" for end in ends)
    )


def closing_lines(rows: Sequence[Mapping[str, Any]], figure: str) -> list[str]:
    """Where the figure is, what agrees with the letter, and what does not and why."""
    told = [row for row in rows if row["letter"]]
    agree = [row for row in told if all(row[name] == row["letter"] for name in MODELS)]
    lines = [f"figure: {figure}"]
    lines.append(
        "agrees with the letter in all three descriptions: "
        + (", ".join(f"p{row['letter']} at {row['frequency_hz']:.2f} Hz" for row in agree) or "none")
    )
    moved = [row for row in rows if row.get("excess_down_beam_linear") and row["excess_down_beam"]]
    if moved:
        lines.append(
            "Hertz's law against linear contact of the same duration moves the beam's end: "
            + ", ".join(
                f"{row['frequency_hz']:.2f} Hz {row['excess_down_beam_linear']:+.2e} -> "
                f"{row['excess_down_beam']:+.2e}"
                for row in moved
            )
        )
    for row in told:
        if row in agree:
            continue
        found = ", ".join(f"{TITLES[name]} {word(row[name])}" for name in MODELS)
        above = ", ".join(f"{TITLES[name]} {word(row[f'born_{name}'].get('0.01'))}" for name in MODELS)
        line = (
            f"{row['frequency_hz']:.2f} Hz: the letter saw p{row['letter']}, here {found}; "
            f"at excess 0.01 {above}"
        )
        if row["frequency_hz"] == 23.40:
            line += (
                "; the edge between p10 and p11 lies where f T = 20/21, at 23.343 Hz for T = 40.80 ms, "
                "so that p10 "
                "at grazing needs T below 40.70 ms, five times the printed error of 0.02 ms"
            )
        lines.append(line)
    return lines


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    began = time.perf_counter()
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the transitions need a harmonic drive")
    if request.quick:
        scene = scene.replace({"scan.points": min(scene.scan.points, 21)}, provenance="quick")
    model = model_of(scene)
    scene.refuse_drive_above(float(model.frequencies_hz.max()))
    frequencies = sorted(scene.drive.frequencies_hz)
    print(HEAD, flush=True)
    rows: list[dict[str, Any]] = []
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        for row in pool.map(lambda f: row_at(scene, f, model), frequencies):
            row["grazing_amplitude_m"] = beam_of(scene, row["frequency_hz"], model).grazing_amplitude()
            rows.append(row)
            print(table_line(row), flush=True)
        request.record.write_json("rows", rows)
        full = bool(request.options.full)
        with request.progress(
            "orbit diagrams", total=len(rows) * len(MODELS) * 2 * scene.scan.points
        ) as progress:
            futures = {
                pool.submit(scans, scene, row, model, full, progress.advance): i for i, row in enumerate(rows)
            }
            diagrams: list[Any] = [None] * len(rows)
            for future in as_completed(futures):
                diagrams[futures[future]] = future.result()
    store_points(request, rows, diagrams)
    for name in MODELS:
        request.record.write_figure(
            draw(scene, rows, diagrams, name), "orbit_diagram" if name == "beam" else f"orbit_diagram_{name}"
        )
    failures = [sentence for row in rows for sentence in row.pop("failures")]
    failures += [
        s for found in diagrams for ways in found.values() for d in ways.values() for s in d.failures
    ]
    lines = closing_lines(rows, str(request.record.folder / "orbit_diagram.png"))
    for line in [*failures, *lines]:
        print(line, flush=True)
    return {
        "rows": rows,
        "modes": model.n_modes,
        "contact": scene.contact.law,
        "closing": lines,
        "failures": failures,
        "failed_cells": len(failures),
        "wall_s": time.perf_counter() - began,
    }


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--full",
        action="store_true",
        help="as the experiment did: 10000 drive periods per amplitude, never fewer",
    )


NEEDS = (
    Need(quantity="born_period", tolerance=0.0, everywhere=True),
    Need(quantity="fold", tolerance=0.07, everywhere=True),
)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None, *, module: str | None = None) -> int:
    """Run the study from the command line, then write the report of all that is stored beside it."""
    results: list[Path] = []

    def noted(scene: Scene, request: Request) -> dict[str, Any]:
        results.append(request.record.folder.parent)
        return run(scene, request)

    code = run_study(
        "transitions",
        "The letter's six transitions p1 <-> pm: Nordmark map, Eq. (1) and the beam side by side.",
        noted,
        argv,
        options=add_options,
        module=module,
        needs=NEEDS,
    )
    if results and code in (DONE, FAILED_CELLS):
        print(told_report(results[0]), file=sys.stderr)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
