"""What a drive period costs: against modes, law, outside solvers, and the arithmetic that none can avoid.

Claim: with one mode and the hard wall a drive period takes some tens of nanoseconds, two orders of magnitude
less than the fastest outside solver; with N modes and Hertz contact some microseconds, and no more than in
proportion to the modes.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02, one orbit and eight on two cores; the beam's
p4 at 21.50 Hz and excess 0.013 against the number of modes, with Hertz's and the linear contact, and without
a touch; errors in extended precision and crossings missed (``work_precision``); the first call of a fresh
interpreter.  With --peers heyoka runs in turns with it, for Eq. (1) bare and at its default tolerance, for
the beam through the interface of all methods at the tolerance that gives 1e-8 or better.  "floor" is the
arithmetic of periods without a touch, as a kernel of its own (``benchmarks.floor``).

Run time: about 1 min, --quick 15 s.  Command: python -m studies.benchmarks [--peers].  Outputs: summary.json
(rows, ratios), costs.csv, costs.png and .pdf.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from studies.instruments.benchmarks.beam import FREQUENCY, beam_rows, measured_errors, slope_of
from studies.instruments.benchmarks.cost_figure import draw_costs
from studies.instruments.benchmarks.first_call import first_call
from studies.instruments.benchmarks.single_mode import batch_rows, single_rows
from studies.instruments.command_line import Request, run_study
from studies.instruments.peers import available
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.work_precision.problems import MODES, problems_of
from studies.published import PERIODS

__all__ = ["main", "run"]

LADDER = (1, 2, 4, 8, 15, 20, 40)
LAWS = ("hertz", "linear")
PEER_TOLERANCE = 1e-7
"""Of heyoka on the beam: the coarsest of its decades whose error is below 1e-8."""

GOALS = {"single_mode_median": 50.0, "single_mode_least": 20.0, "beam_8_modes": 20.0}
"""Least ratios of heyoka's time to ours."""

COLUMNS = (
    "case", "tool", "modes", "law", "frequency_hz", "us_per_period", "us_per_collision", "error", "missed",
)  # fmt: skip


def ratios_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """heyoka's time over ours, our time over the floor, and the growth with the modes."""

    def cost(case: str, tool: str, modes: int = 1) -> dict[float, float]:
        return {
            row["frequency_hz"]: row["us_per_period"]
            for row in rows
            if row["case"] == case and row["tool"] == tool and row["modes"] == modes
        }

    ratios: dict[str, float] = {}
    ours, theirs = (cost("single mode", tool) for tool in ("grazing-spring", "heyoka"))
    if theirs:
        single = [theirs[f] / ours[f] for f in theirs]
        ratios |= {"single_mode_median": median(single), "single_mode_least": min(single)}
    bottom = cost("single mode", "floor")
    ratios["single_mode_over_floor"] = median(ours[f] / bottom[f] for f in ours)
    ours, theirs = (cost("batch on two cores", tool) for tool in ("grazing-spring", "heyoka"))
    if theirs:
        ratios["batch"] = median(theirs[f] / ours[f] for f in theirs)
    for law in LAWS:
        case = f"beam, {law} contact"
        modes = sorted({row["modes"] for row in rows if row["case"] == case})
        if not modes:
            continue
        times = [cost(case, "grazing-spring", n)[FREQUENCY] for n in modes]
        if len(modes) > 1:
            ratios[f"{law}_growth_with_modes"] = slope_of(modes, times)
        for n, mine in zip(modes, times, strict=True):
            peer, bottom = cost(case, "heyoka", n), cost(case, "floor", n)
            ratios[f"{law}_{n}_modes_over_floor"] = mine / bottom[FREQUENCY]
            if peer:
                ratios[f"{law}_{n}_modes"] = peer[FREQUENCY] / mine
    return ratios


TABLE = "{:>28} {:>15} {:>6} {:>8} {:>12} {:>14} {:>9} {:>7}"


def table_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The rows as a table."""
    lines = [
        TABLE.format("case", "tool", "modes", "f (Hz)", "us/period", "us/collision", "error", "missed")
    ]
    for row in rows:
        collision = row.get("us_per_collision")
        lines.append(
            TABLE.format(
                row["case"], row["tool"], row["modes"], f"{row['frequency_hz']:.2f}",
                f"{row['us_per_period']:.4g}", "" if collision is None else f"{collision:.3g}",
                "" if row["error"] is None else f"{row['error']:.0e}",
                "" if row["missed"] is None else f"{row['missed']:.2f}",
            )
        )  # fmt: skip
    return lines


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    peers = bool(request.options.peers)
    if peers and "heyoka" not in available():
        raise ValueError('heyoka is not installed; it comes with the extra peers: pip install -e ".[peers]"')
    quick = request.quick
    frequencies = sorted(PERIODS)[:2] if quick else sorted(PERIODS)
    ladder = (1, 8) if quick else LADDER
    tolerance = PEER_TOLERANCE if peers else None
    model = model_of(scene.replace({"modes.count": max(ladder)}))
    rows: list[dict[str, Any]] = []
    with request.progress("cases", total=len(frequencies) + 1 + len(ladder) * len(LAWS)) as progress:
        for frequency in frequencies:
            rows += single_rows(scene, frequency, quick=quick, peers=peers)
            progress.advance()
        rows += batch_rows(scene, frequencies[0], quick=quick, peers=peers)
        progress.advance()
        for law in LAWS:
            for modes in ladder:
                rows += beam_rows(scene, model, law, modes, quick=quick, peer_tolerance=tolerance)
                progress.advance()
    problems = {problem.name: problem for problem in problems_of(scene)}
    for law in LAWS if not quick else LAWS[:1]:
        for tool, (error, missed) in measured_errors(problems[law], tolerance).items():
            for row in rows:
                if row["case"] == f"beam, {law} contact" and row["tool"] == tool and row["modes"] == MODES:
                    row["error"], row["missed"] = error, missed
    start = first_call(1 if quick else 3)
    ratios = ratios_of(rows)
    request.record.write_table("costs", {name: [row.get(name) for row in rows] for name in COLUMNS})
    request.record.write_figure(draw_costs([row for row in rows if row["case"].startswith("beam")]), "costs")
    for line in table_lines(rows):
        print(line)
    for name, ratio in ratios.items():
        goal = GOALS.get(name)
        print(f"{name}: {ratio:.3g}" + ("" if goal is None else f" (goal {goal:g})"))
    print(
        f"first call: imports {start['imports_s']:.2f} s, modes {start['modes_s']:.2f} s, first collision "
        f"{start['first_collision_s']:.2f} s, {start['peak_memory_mb']:.0f} MB",
        flush=True,
    )
    return {"rows": rows, "ratios": ratios, "first_call": start, "failed_cells": 0}


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument("--peers", action="store_true", help="run heyoka in turns with the package")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "benchmarks",
        "Time per drive period and collision against modes and law, floors and outside solvers.",
        run,
        argv,
        options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
