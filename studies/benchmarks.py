"""What a drive period costs: against modes, law, outside solvers, and the arithmetic that none can avoid.

Claim: with one mode and the hard wall a drive period takes some tens of nanoseconds, two orders of magnitude
less than the fastest outside solver; with N modes and Hertz contact some microseconds, and no more than in
proportion to the modes.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02, one orbit and 32 on two cores; the beam's
p4 at 21.50 Hz and excess 0.013 against the number of modes, with Hertz's and the linear contact, and without
a touch; with eight modes against the excess; errors in extended precision and crossings missed
(``work_precision``); the first call of a fresh interpreter.  With --peers heyoka runs in turns with it, for
Eq. (1) bare and at its default tolerance, for the beam through the interface of all methods at the tolerance
that gives 1e-8 or better, with eight modes also at others.  "floor" is the arithmetic of periods without a
touch, as a kernel of its own (``benchmarks.floor``).

Run time: about 1 min, --quick 15 s.  Command: python -m studies.benchmarks [--peers].  Outputs: summary.json
(rows, ratios), costs.csv, costs.md (the table of the README), costs.png and .pdf.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from studies.instruments.benchmarks.beam import BELOW, EXCESS, FREQUENCY, beam_rows, measured_errors, slope_of
from studies.instruments.benchmarks.cost_figure import draw_costs
from studies.instruments.benchmarks.cost_table import cost_table
from studies.instruments.benchmarks.first_call import first_call
from studies.instruments.benchmarks.single_mode import EXCESS as EXCESS_OF_EQ_1
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
EXCESSES = (1e-4, 1e-3, 0.1)
"""Besides the one of the letter's Fig. 4: from grazing to chaos."""

PEER_TOLERANCE, OTHER_TOLERANCES = 1e-7, (1e-4, 1e-10, 1e-15)
"""Of heyoka on the beam: the coarsest of its decades whose error is below 1e-8, and others."""

GOALS = {"single_mode_median": 50.0, "single_mode_least": 20.0, "batch": 50.0, "hertz_8_modes": 20.0}
"""Least ratios of heyoka's time to ours."""

COLUMNS = (
    "case", "tool", "modes", "law", "frequency_hz", "excess", "tolerance", "us_per_period",
    "us_per_collision", "error", "missed",
)  # fmt: skip


def ratios_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """heyoka's time over ours, our time over the floor, and the growth with the modes."""

    def cost(case: str, tool: str, modes: int = 1) -> dict[float, float]:
        return {
            row["frequency_hz"]: row["us_per_period"]
            for row in rows
            if (row["case"], row["tool"], row["modes"]) == (case, tool, modes)
            and row["tolerance"] in (None, PEER_TOLERANCE)
            and (row["excess"] == EXCESS or not case.startswith("beam"))
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


TABLE = "{:>29} {:>15} {:>6} {:>8} {:>8} {:>9} {:>12} {:>14} {:>9} {:>7}"


def table_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The rows as a table."""
    lines = [
        TABLE.format(
            "case", "tool", "modes", "f (Hz)", "excess", "tolerance", "us/period", "us/collision", "error",
            "missed",
        )
    ]
    for row in rows:
        collision = row.get("us_per_collision")
        lines.append(
            TABLE.format(
                row["case"], row["tool"], row["modes"], f"{row['frequency_hz']:.2f}", f"{row['excess']:g}",
                "" if row["tolerance"] is None else f"{row['tolerance']:.0e}",
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
    others = () if quick else EXCESSES
    tolerances = () if quick or not peers else OTHER_TOLERANCES
    cases = len(frequencies) + 1 + len(ladder) * len(LAWS) + len(others) + len(tolerances)
    with request.progress("cases", total=cases) as progress:
        for frequency in frequencies:
            rows += single_rows(scene, frequency, quick=quick, peers=peers)
            progress.advance()
        rows += batch_rows(scene, frequencies[0], quick=quick, peers=peers)
        progress.advance()
        for law in LAWS:
            for modes in ladder:
                rows += beam_rows(scene, model, law, modes, quick=quick, peer_tolerance=tolerance)
                progress.advance()
        for excess in others:
            more = beam_rows(scene, model, LAWS[0], MODES, quick=quick, peer_tolerance=None, excess=excess)
            rows += [row for row in more if row["excess"] == excess and row["tool"] == "grazing-spring"]
            progress.advance()
        for other in tolerances:
            more = beam_rows(scene, model, LAWS[0], MODES, quick=quick, peer_tolerance=other)
            rows += [row for row in more if row["tool"] == "heyoka"]
            progress.advance()
    for row in rows:
        row.setdefault("excess", EXCESS_OF_EQ_1)
        row.setdefault("tolerance", None)
    problems = {problem.name: problem for problem in problems_of(scene)}
    asked = [t for t in (tolerance, *tolerances) if t is not None]
    for law in LAWS if not quick else LAWS[:1]:
        measured = measured_errors(problems[law], asked if law == LAWS[0] else asked[:1])
        for row in rows:
            if row["case"] == f"beam, {law} contact" and row["modes"] == MODES and row["tool"] != "floor":
                row["error"], row["missed"] = measured[row["tolerance"]]
    start = first_call(1 if quick else 3)
    ratios = ratios_of(rows)
    request.record.write_table("costs", {name: [row.get(name) for row in rows] for name in COLUMNS})
    drawn = [row for row in rows if row["case"].startswith("beam") and row["excess"] in (EXCESS, BELOW)]
    drawn = [row for row in drawn if row["tolerance"] in (None, PEER_TOLERANCE)]
    request.record.write_figure(draw_costs(drawn), "costs")
    request.record.write_text("costs.md", "\n".join(cost_table(rows, EXCESS, PEER_TOLERANCE)) + "\n")
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
