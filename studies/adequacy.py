"""How much model each question needs: rung, mesh, modes, residual mode and contact law.

Claim: of the spring of the scene, a frequency needs the straight equivalent or less, the period that is
born at grazing needs Eq. (1) at most frequencies, and only the hysteresis needs the whole ladder.

For each quantity (``adequacy.asked``) the cheapest model within the tolerance is found
(``adequacy.needed``), checked against one with four times the modes and the mesh and the sharper law, and
against every choice one step smaller in one thing. Command: python -m studies.adequacy [--remember]. Run
time: about 1 min, --quick 15 s. Outputs: summary.json (rows), ladder.png and .pdf (error against
predicted cost for every model tried, chosen one marked), ladder.csv. With --remember the choices that the
other studies make for this scene are written to the file that is delivered with the scenes.
"""

from __future__ import annotations

import argparse
import importlib
import pkgutil
from collections.abc import Iterator, Sequence
from typing import Any

import studies
from studies.instruments.adequacy.asked import QUANTITIES, Asked
from studies.instruments.adequacy.fitted_scene import Need, fitted
from studies.instruments.adequacy.ladder_figure import as_points, columns_of, draw_ladder
from studies.instruments.adequacy.memory import DELIVERED, key_of, remember
from studies.instruments.adequacy.model_choice import Models, rungs_of
from studies.instruments.adequacy.needed import Search, needed
from studies.instruments.adequacy.rows import measured_row
from studies.instruments.command_line import Request, run_study
from studies.instruments.scene import Scene

__all__ = ["main", "questions", "run"]

FREQUENCIES = (1, 3, 5, 10)
"""Numbers of the modes whose frequencies are asked for."""


def questions(scene: Scene, quick: bool) -> list[tuple[Asked, float]]:
    """What is asked, and how exactly."""
    drives = sorted(scene.drive.frequencies_hz)
    middle = drives[(len(drives) - 1) // 2]
    tolerance = {name: entry[3] for name, entry in QUANTITIES.items()}
    found = [
        (Asked(quantity=f"frequency {number}", frequency=middle), tolerance["frequency"])
        for number in (FREQUENCIES[:2] if quick else FREQUENCIES)
    ]
    for name in ("restitution", "delay", "kick"):
        found.append((Asked(quantity=name, frequency=middle), tolerance[name]))
    born = [middle] if quick else drives
    found += [(Asked(quantity="born_period", frequency=f), tolerance["born_period"]) for f in born]
    folds = [middle] if quick else drives[:3]
    found += [(Asked(quantity="fold", frequency=f), tolerance["fold"]) for f in folds]
    if not quick:
        found.append((Asked(quantity="tip_trace", frequency=middle), tolerance["tip_trace"]))
    return found


def _needs() -> Iterator[tuple[str, Sequence[Need]]]:
    """What every study rests on."""
    for module in pkgutil.iter_modules(studies.__path__):
        if not module.name.startswith("_") and module.name not in ("instruments", "scenes", "adequacy"):
            needs = getattr(importlib.import_module(f"studies.{module.name}"), "NEEDS", ())
            if needs:
                yield module.name, needs


def _remember(scene: Scene) -> int:
    """Find the choices that the studies make for this scene and write them beside the scenes."""
    rungs, laws, models = rungs_of(scene)[-1:], (scene.contact.law,), Models(scene)
    kept: set[str] = set()
    for _name, needs in _needs():
        for need in needs:
            for asked in need.asked(scene):
                key = key_of(scene, asked, need.tolerance, rungs, laws, False)
                if key in kept:
                    continue
                search = Search(scene, asked, models=models, law=laws[-1])
                found = needed(
                    scene, asked, need.tolerance, rungs=rungs, laws=laws, residual=False, search=search
                )
                remember(DELIVERED, key, found)
                kept.add(key)
    return len(kept)


TABLE = "{:>14} {:>7} {:>10} {:>10} {:>10} {:>7}  {}"


def _number(value: float | None, none: str = "-") -> str:
    return none if value is None else f"{value:.1e}"


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; what a driven spring needs is asked here")
    asked = questions(scene, request.quick)
    print(TABLE.format("quantity", "f (Hz)", "tolerance", "error", "one less", "cost x", "least model"))
    rows, tried = [], []
    with request.progress("questions", total=len(asked)) as progress:
        for question, tolerance in asked:
            row, found, models = measured_row(scene, question, tolerance, repeats=1 if request.quick else 3)
            rows.append(row)
            tried += as_points(question, models, found.choice)
            less = "none" if row["one_less"] is None else _number(row["error_one_less"], "no answer")
            print(
                TABLE.format(
                    row["quantity"], f"{row['frequency_hz']:.2f}", f"{tolerance:g}",
                    _number(row["error_measured"]), less, f"{row['cost_ratio']:.1f}", row["words"],
                ),
                flush=True,
            )  # fmt: skip
            progress.advance()
    request.record.write_table("ladder", columns_of(tried))
    request.record.write_figure(draw_ladder(rows, tried), "ladder")
    for row in rows:
        if not row["reached"]:
            print(row["sentence"], flush=True)
    studied = {}
    for name, needs in _needs():
        studied[name] = fitted(scene, needs, lambda words: print(words, flush=True))[1]
        print(f"{name}: {studied[name]}", flush=True)
    if request.options.remember:
        print(f"{_remember(scene)} choices are in {DELIVERED}", flush=True)
    return {"rows": rows, "studies": studied, "failed_cells": 0}


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--remember", action="store_true", help="write the choices of all studies beside the scenes"
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "adequacy",
        "The least model that each question needs, and what one step less would cost in accuracy.",
        run,
        argv,
        options=add_options,
    )


if __name__ == "__main__":
    raise SystemExit(main())
