"""The plane of drive frequency and amplitude: which period, how many impacts, upwards and downwards.

Claim (letter 1996, Figs. 1 to 3, for a whole plane): below grazing an orbit p_m coexists with the motion
without impacts down to its fold; at grazing the period follows the bands of the map; above it periods double,
and chaos lies between.  Computed on a grid refined around grazing (``chart.plane``): at each frequency the
amplitude is raised and lowered again with the state carried along, and each cell gets the period (up to 64)
and the impacts of the orbit on which the motion settles, within a stated bound of drive periods (--cycles;
``sweep.settled_column``).  Drawn over it: the band edges of the map and the exact folds.

    python -m studies.chart                          Eq. (1), 400 x 400, both directions
    python -m studies.chart --model beam             the beam of the scene, 120 x 120
    python -m studies.chart --quick                  a coarse one
    python -m studies.chart --executor processes     or dask://host:port, for a cluster
    python -m studies.chart --shard 2/8              part 2 of 8, for a job array; when all are there, the
                                                     command without --shard gathers them and draws

Every finished cell is in MODEL-NxM.sqlite (``sweep.store``); the same command goes on where the last one was
stopped, in whatever way; --fresh begins anew.

Run time on two cores: 40 s, for --model beam as well.  Command: python -m studies.chart.  Outputs:
summary.json, chart_MODEL.png and .pdf, the cells as chart_MODEL.npz, folds_MODEL.csv; `python -m
studies.export` for the cells with their end states.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contact.orbits.settling import TOLERANCE
from contact.oscillator import ImpactOscillator
from studies.instruments.adequacy.fitted_scene import Need, fitted
from studies.instruments.chart.cells import Cells, fold_agreement
from studies.instruments.chart.overlays import bands_in, folds_of_beam, folds_of_single_mode
from studies.instruments.chart.plane import EXCESSES, FREQUENCIES_HZ, Plane
from studies.instruments.chart.words import closing_lines
from studies.instruments.command_line import Request, run_study
from studies.instruments.corresponding import corresponding
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.sweep.column_scan import ColumnScan
from studies.instruments.sweep.executors import pool_of
from studies.instruments.sweep.program import program
from studies.instruments.sweep.run import run_sweep
from studies.instruments.sweep.settled_column import LARGEST_PERIOD
from studies.instruments.sweep.store import Store, remove_store
from studies.instruments.sweep.tasks import Shard

TITLES = {"single_mode": "Eq. (1)", "beam": "beam"}
POINTS = {"single_mode": (400, 400), "beam": (120, 120)}
QUICK_POINTS = {"single_mode": (46, 40), "beam": (10, 16)}
CYCLES = {"single_mode": 8192, "beam": 1024}
"""Bounds of settling in drive periods: free motion falls by e^-1 in 12 of them, so that a motion that is not
periodic to 1e-9 of the gap after 512 is chaotic or next to a bifurcation.  With one mode 8192 are cheap, and
then the orbits next to all folds have come to rest."""

QUICK_CYCLES = 256

NEEDS = (
    Need(quantity="born_period", tolerance=0.0),
    Need(quantity="fold", tolerance=0.07),
)
"""What the chart of the beam rests on, at the middle frequency; Eq. (1) needs nothing."""

MOST_REASONS = 20
"""Sentences of failed cells that the summary quotes; all are in the store."""


def plan_of(scene: Scene, model: str, plane: Plane, cycles: int) -> dict[str, Any]:
    """All that the cells depend on, in terms of JSON."""
    settling = {"most_cycles": cycles, "largest_period": LARGEST_PERIOD, "tolerance": TOLERANCE}
    return {
        "study": "chart",
        "model": model,
        "plane": plane.as_dict(),
        "settling": settling,
        "program": program(),
        "scene": scene.as_dict(),
    }


def gather(store: Store, folder: Path, stem: str) -> None:
    """Take over what the shards of the same chart have stored."""
    for path in sorted(folder.glob(f"{stem}-*-of-*.sqlite")):
        with Store.read(path) as part:
            store.gather(part)


def reasons(store: Store) -> list[str]:
    """The first failures, one sentence each."""
    found: list[str] = []
    for _number, frequency, direction, _step, excess, _p, _i, _c, reason, _state in store.rows():
        if reason and len(found) < MOST_REASONS:
            found.append(f"{frequency:.6g} Hz, excess {excess:.6g}, {direction}: {reason}")
    return found


def oscillator_of(scene: Scene, model: str, frequency: float) -> ImpactOscillator:
    """The oscillator that the chart is of."""
    make = single_mode_oscillator if model == "single_mode" else beam_of
    return make(scene, frequency)


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    options, model, folder = request.options, request.options.model, request.record.folder
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the chart needs a harmonic drive")
    columns, rows = options.points or (QUICK_POINTS if request.quick else POINTS)[model]
    low, high = options.frequencies or (corresponding(scene, f) for f in FREQUENCIES_HZ)
    least, most = options.excesses
    plane = Plane(columns=columns, rows=rows, frequencies_hz=(low, high), excesses=(least, most))
    cycles = options.cycles or (QUICK_CYCLES if request.quick else CYCLES[model])
    shard = Shard.of_text(options.shard)
    choice = ""
    if model == "beam":
        scene, choice = fitted(scene, NEEDS, print)
        request.record.scene = scene
    grid = plane.grid()
    oscillator = oscillator_of(scene, model, 0.5 * sum(plane.frequencies_hz))
    work = ColumnScan(oscillator=oscillator, most_cycles=cycles)
    stem = f"{model}-{columns}x{rows}"
    path = folder / f"{stem}{shard.name}.sqlite"
    if options.fresh:
        remove_store(path)
    began = time.perf_counter()
    with Store.begin(path, plan_of(scene, model, plane, cycles)) as store:
        if shard.count == 1:
            gather(store, folder, stem)
        there, total = store.count(), grid.cells(shard)
        if there < total:
            with (
                pool_of(request.executor, request.workers) as pool,
                request.progress(f"cells of {TITLES[model]}", total=total - there) as progress,
            ):
                run_sweep(grid=grid, work=work, store=store, pool=pool, shard=shard, tell=progress.advance)
        took = time.perf_counter() - began
        failed, failures = store.failed(), reasons(store) if store.failed() else []
        cells = Cells.of_store(store, grid) if shard.count == 1 else None
    result: dict[str, Any] = {
        "model": model,
        "modes": oscillator.n_modes,
        "model_choice": choice,
        "points": [columns, rows],
        "most_cycles": cycles,
        "largest_period": LARGEST_PERIOD,
        "shard": options.shard,
        "store": path.name,
        "cells": total,
        "computed_now": total - there,
        "cells_per_s": (total - there) / took if there < total else None,
        "sweep_s": took,
        "failures": failures,
        "failed_cells": failed,
    }
    if cells is None:
        result["closing"] = [f"shard {options.shard}: {total} cells in {path}"]
    else:
        result |= drawn(scene, request, plane, oscillator, cells, result)
        result["closing"] = closing_lines(result, str(folder / f"chart_{model}.png"))
    for line in [*failures, *([choice] if choice else []), *result["closing"]]:
        print(line, flush=True)
    return result


def drawn(
    scene: Scene, request: Request, plane: Plane, oscillator: ImpactOscillator, cells: Cells,
    result: dict[str, Any],
) -> dict[str, Any]:  # fmt: skip
    """Store the cells and what theory says, draw both, and compare them."""
    # matplotlib is slow to import, and a shard draws nothing
    from studies.instruments.chart.figure import draw

    (low, high), model, record = plane.frequencies_hz, result["model"], request.record
    edges = bands_in(scene, low, high)
    if model == "single_mode":
        folds = folds_of_single_mode(oscillator, cells.frequencies, plane.excesses[0])
    else:
        folds = folds_of_beam(oscillator, edges, cells.frequencies, plane.excesses[0])
    record.write_arrays(
        f"chart_{model}", frequency_hz=cells.frequencies, excess=cells.excesses, period=cells.period,
        impacts=cells.impacts, cycles=cells.cycles,
    )  # fmt: skip
    names = ("period", "frequency_hz", "excess")
    record.write_table(f"folds_{model}", {name: [fold[name] for fold in folds] for name in names})
    title = f"{TITLES[model]}, {cells.frequencies.size} × {cells.excesses.size}"
    record.write_figure(draw(cells, edges, folds, title=title), f"chart_{model}")
    met, seen = fold_agreement(cells, folds)
    return {
        "bands": [{"period": b.period, "lower_hz": b.lower, "upper_hz": b.upper} for b in edges],
        "counts": cells.counts(),
        "share_without_period": float(np.mean(cells.period == 0)),
        "drive_periods": int(cells.cycles[cells.cycles > 0].sum()),
        "folds": len(folds),
        "folds_seen": seen,
        "folds_met": met,
    }


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own options."""
    parser.add_argument("--model", choices=sorted(TITLES), default="single_mode", help="Eq. (1) or the beam")
    parser.add_argument("--points", nargs=2, type=int, metavar=("N", "M"), default=None,
                        help="frequencies and amplitudes (default: 400 400, beam 120 120)")
    parser.add_argument("--frequencies", nargs=2, type=float, metavar=("LOW", "HIGH"), default=None,
                        help="range of drive frequencies [Hz] (default: 19.5 24; other springs, same f T)")
    parser.add_argument("--excesses", nargs=2, type=float, metavar=("LOW", "HIGH"), default=EXCESSES,
                        help="range of F/F_g - 1")
    parser.add_argument("--cycles", type=int, default=None, metavar="N",
                        help="bound of the drive periods at one amplitude (default: 8192, beam 1024)")
    parser.add_argument("--shard", default="1/1", metavar="k/n",
                        help="compute part k of n only, and draw nothing")
    parser.add_argument("--fresh", action="store_true", help="forget what is stored and begin anew")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "chart",
        "Period and impacts over drive frequency and amplitude, upwards and downwards.",
        run,
        argv,
        options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
