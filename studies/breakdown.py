"""Where the map fails near grazing: the letter's Fig. 5, f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s.

Claim (letter 1996, Fig. 5): where the map has p3, "at rho = 0 the trivial noncolliding p1 orbit gives way to
a period-6 orbit. The stable periodic p3 orbit is found only at the very end of the downward scan"; and
"Eq. (1) predicts for this case a chaotic state at rho = -0.0707 that is not connected to the state that is
born at rho = 0".

Computed:

    Eq. (1)     upward and downward scan, and the island of p3 and chaos below grazing, for several
                restitutions tau
    beam        the scans of the scene's spring with its period and damping fitted again to T and mu
    search      the born period over what is not printed: mass of ball and mount, damping of the modes above
                the first, loss in the contact
    beam, p6    the scans of the cell that departs least from the scene, has period 6, and ends on p3

Run time: one to two minutes; --quick some ten seconds; --full (10000 drive periods at every amplitude)
several minutes.  Command: python -m studies.breakdown.  Outputs: summary.json, the figures breakdown and
born_period, born_period.csv, and the points of the scans as npz.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from contact.maximal_orbits import maximal_period
from contact.orbits.scan import OrbitDiagram
from contact.stroboscope import StroboscopicMap
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.breakdown.beam_of_fig_5 import CHAOS_AT, FREQUENCY_HZ, born, driven, scene_of_fig_5
from studies.instruments.breakdown.born_period_map import candidates, search, within_errors
from studies.instruments.breakdown.figures import draw_born, draw_scans
from studies.instruments.breakdown.plan import plan_of
from studies.instruments.breakdown.scans import beam_result, both_ways, periods, rows_of
from studies.instruments.breakdown.single_mode_island import island
from studies.instruments.breakdown.words import sentences
from studies.instruments.command_line import Request, run_study
from studies.instruments.oscillators import nordmark_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of

MOST_SCANNED = 4
"""Cells with period 6 whose scans are made: those that ask for least."""


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


NEEDS = (Need(quantity="kick", tolerance=0.005, mesh=False),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "breakdown",
        "Where the map fails near grazing: the letter's Fig. 5 for Eq. (1) and the beam.",
        run,
        argv,
        options=add_options,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
