"""What the spring settles on: period, impacts and Lyapunov exponent, and which starts lead where.

Claim (letter 1996): besides the p_m orbits "other transitions" occur, which "may even be to chaotic states",
and below grazing p_m and the motion without impacts coexist.

Computed at one drive frequency (--frequency, 21.50 Hz) for Eq. (1) and for the beam with its N modes:

    period, impacts     of the settled orbit in an upward and a downward scan that carry the state along
    exponents, kind     largest Lyapunov exponent by two routes, and periodic or chaotic by it (see
                        studies.instruments.attractors.kinds)
    basins              for Eq. (1) at --basin-excess (-0.006): where each start on the strobe plane leads

Run time: some minutes; --quick some ten seconds.  Command: python -m studies.attractors.
Outputs: summary.json, attractors.png and .pdf, basins.png and .pdf (the strobe plane, and close to p1),
rows.csv, attractors.npz, basins.npz, basins_close.npz.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from contact.stroboscope import StroboscopicMap
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.attractors.basins import CLOSE, basins
from studies.instruments.attractors.figures import SHAPES, draw_basins, draw_scan
from studies.instruments.attractors.kinds import CHAOTIC, agreement
from studies.instruments.attractors.scan import TITLES, Start, carried, row_of
from studies.instruments.command_line import Request, run_study
from studies.instruments.corresponding import corresponding
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of

FREQUENCY = 21.50
"""Where the letter has period 4 [Hz]."""


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    began = time.perf_counter()
    options, quick = request.options, request.quick
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; attractors need a harmonic drive")
    frequency = corresponding(scene, FREQUENCY) if options.frequency is None else options.frequency
    low, high = options.lowest, options.highest
    if not -1.0 < low < high:
        raise ValueError(f"lowest is {low} and highest {high}; -1 < lowest < highest must hold")
    if not options.basin_excess > -1.0:
        raise ValueError(f"basin-excess is {options.basin_excess}; it must be above -1")
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
        "--frequency", type=float, metavar="HZ",
        help=f"drive frequency ({FREQUENCY:g} Hz; for another spring that of its f T)",
    )
    parser.add_argument("--model", choices=(*TITLES, "both"), default="both", help="which description (both)")
    parser.add_argument("--lowest", type=float, default=-0.016, help="lowest excess of the scan (-0.016)")
    parser.add_argument("--highest", type=float, default=0.06, help="highest excess of the scan (0.06)")
    parser.add_argument("--points", type=int, default=39, help="amplitudes of the scan (39)")
    parser.add_argument("--cycles", type=int, default=600, help="drive periods in the averages (600)")
    parser.add_argument("--basin-excess", type=float, default=-0.006, help="excess of the basins (-0.006)")
    parser.add_argument("--side", type=int, default=200, help="starts along each side of the basins (200)")


NEEDS = (Need(quantity="fold", tolerance=0.05, everywhere=True),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None, *, module: str | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "attractors",
        "Period, impacts and Lyapunov exponent of the settled motion, and basins of attraction.",
        run,
        argv,
        options=add_options,
        module=module,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
