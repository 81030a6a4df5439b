"""Where the map fails near grazing: the letter's Fig. 5, f = 19.65 Hz, T = 41.2 ms, mu = 3.56 1/s.

Claim (letter 1996, Fig. 5): where the map has p3, "at rho = 0 the trivial noncolliding p1 orbit gives way to
a period-6 orbit. The stable periodic p3 orbit is found only at the very end of the downward scan"; and
"Eq. (1) predicts for this case a chaotic state at rho = -0.0707 that is not connected to the state that is
born at rho = 0".

Computed:

    Eq. (1)     upward and downward scan, and the island of p3 and chaos below grazing, for several
                restitutions tau: it begins at the fold of p3 (closed form) and is followed upwards, the state
                carried along, until the motion is free of impacts
    beam        the scans of the scene's spring with its period and damping fitted again to T and mu
    search      the born period over what is not printed: mass of ball and mount, damping of the modes above
                the first, loss in the contact
    found       the scans of the cell that departs least from the scene, has period 6, and ends on p3

Run:     python -m studies.breakdown [--full] [--quick]     a minute; --quick ten seconds; --full some minutes
Writes:  scans.csv (a row an amplitude), outcomes.csv (a row a beam), islands.csv, born_period.csv (a row a
         cell of the search), within_errors.csv, breakdown.npz (strobe points), breakdown and born_period
         (png, pdf)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any

import numpy as np

from contact import StroboscopicMap, maximal_period
from contact.orbits import OrbitDiagram
from studies import letter
from studies.breakdown.beam import (
    BORN_PERIOD,
    FREQUENCY_HZ,
    Beam,
    Cell,
    Errors,
    at_errors,
    cell_of,
    fig_5,
    nearest_first,
    tuned,
)
from studies.breakdown.scans import CHAOS_AT, Island, Outcome, Scans, amplitudes, island, periods
from studies.run import Run, study
from studies.scene import Scene, model_of, nordmark_at, single_mode_at

__all__ = ["breakdown"]

RESTITUTIONS, QUICK_RESTITUTIONS = (0.0, 0.05, 0.06, 0.075, 0.1), (0.05, 0.1)
MASSES_KG = tuple(
    m / 1000 for m in (3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0)
)
FACTORS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 8.0)
LOCAL = (1.0, 0.7)
QUICK_MASSES_KG, QUICK_FACTORS, QUICK_LOCAL = (0.0035, 0.004), (1.0, 2.0), (1.0,)
"""Ball and mount [kg], factors on the damping of the higher modes, restitutions of a free ball."""

MOST_SCANNED = 4
"""Cells with period 6 whose scans are made: those that depart least from the scene."""


@study(needs={"kick": 0.005}, quick={"points": 21, "cycles": 500})
def breakdown(
    scene: Scene,
    run: Run,
    *,
    full: Annotated[bool, "as the experiment did: 10000 drive periods per amplitude, never fewer"] = False,
    points: Annotated[int, "amplitudes of a scan below grazing"] = 81,
    cycles: Annotated[int, "most drive periods at an amplitude"] = 2000,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    scene = fig_5(scene)
    tau, nordmark = scene.single_mode.restitution, nordmark_at(scene, FREQUENCY_HZ)
    scans = Scans(points=points, cycles=letter.SETTLE_CYCLES if full else cycles, early=not full)
    taus = sorted({*(QUICK_RESTITUTIONS if run.quick else RESTITUTIONS), tau})
    islands = run.map(partial(island, scene), taus, "islands")
    known = [entry for entry, _ in islands]
    run.table("islands", known, "Eq. (1): p3 and chaos below grazing.")
    single = StroboscopicMap(oscillator=single_mode_at(scene, FREQUENCY_HZ))
    ways = {"Eq. (1)": scans.of(single, -0.14, single.tip)}
    own, ways["Eq. (1)"]["island"] = islands[taus.index(tau)]
    outcomes = [scans.outcome(single, ways["Eq. (1)"]["down"], "Eq. (1)", own.fold_p3)]
    calibrated = Beam(scene=scene, model=model_of(scene), tip_mass_kg=scene.tip.mass_kg)
    cells, beams = search(scene, run)
    tried = nearest_first(cells, scene.tip.mass_kg)[:MOST_SCANNED]
    jobs = [("beam", calibrated), *((f"beam {i}", beams[place]) for i, place in enumerate(tried, 1))]
    for outcome, diagrams in run.map(scans.of_beam, jobs, "scans of the beam"):
        outcomes.append(outcome)
        ways[outcome.description] = diagrams
    # as in the letter: p3 in the downward scan; otherwise the first candidate
    place = next((i for i, o in enumerate(outcomes[2:]) if o.p3_last is not None), 0)
    found = outcomes[2 + place] if tried else None
    run.table("outcomes", outcomes, "What is born at grazing, and the end of the downward scan.")
    if not run.quick:
        run.table("within_errors", within_errors(scene, run), "Calibrated beam at the errors of T and mu.")
    store(run, ways)
    from studies.breakdown import figure

    shown = [outcome for outcome in (*outcomes[:2], found) if outcome is not None]
    run.figure("breakdown", figure.draw_scans([(o, ways[o.description]) for o in shown]),
               "Orbit diagrams at the frequency of Fig. 5: Eq. (1), with the island of p3 and chaos in grey; "
               "the beam as calibrated; the beam found in the search. Filled: amplitude raised; open: "
               "lowered; at the right, finer steps above grazing. Pale: did not settle.")  # fmt: skip
    run.figure("born_period", figure.draw_born(cells, scene.tip.mass_kg, tried[place] if tried else None),
               "Period born at grazing over the mass of ball and mount and the damping of the higher modes "
               "(–: none up to 64; framed: the beam found).")  # fmt: skip
    judge(run, maximal_period(nordmark), outcomes, found, known)
    return {
        "gap_m": scene.stop.gap_m, "thickness_m": scene.spring.thickness_m,
        "grazing_amplitude_m": calibrated.strobed().oscillator.grazing_amplitude(),
        "excess_of_letters_chaos_as_rho": nordmark.excess(CHAOS_AT), "map_period": maximal_period(nordmark),
        "islands": known, "outcomes": outcomes, "found": found, "cells": len(cells),
        "cells_with_period_6": [cell for cell in cells if cell.period == BORN_PERIOD],
    }  # fmt: skip


def search(scene: Scene, run: Run) -> tuple[list[Cell], list[Beam]]:
    """The born period in every cell of mass, factor on the higher modes' damping, local restitution."""
    masses, factors, local = (
        (QUICK_MASSES_KG, QUICK_FACTORS, QUICK_LOCAL) if run.quick else (MASSES_KG, FACTORS, LOCAL)
    )
    models = dict(zip(masses, run.map(partial(tuned, scene), masses, "springs"), strict=True))
    beams = [
        Beam(scene=scene, model=models[m], tip_mass_kg=m, higher_damping=k, local_restitution=e)
        for e in local for m in masses for k in factors
    ]  # fmt: skip
    cells = run.map(cell_of, beams, "search")
    for cell in cells:
        if cell.failure:
            run.failed(f"{1e3 * cell.tip_mass_kg:g} g, damping x {cell.higher_damping:g}", cell.failure)
    run.table("born_period", cells, "Period born at grazing over what the letter does not print.", show=())
    return cells, beams


def within_errors(scene: Scene, run: Run) -> list[Errors]:
    """The born period at the ends of the letter's errors of T and mu, all else as calibrated."""
    t, c = letter.BREAKDOWN["free_period_error_s"], letter.BREAKDOWN["decay_rate_error_per_s"]
    changes = [(-t, 0.0), (t, 0.0), (0.0, -c), (0.0, c)]
    return run.map(partial(at_errors, scene), changes, "errors of T and mu")


def store(run: Run, ways: Mapping[str, Mapping[str, OrbitDiagram[Any]]]) -> None:
    """Rows and points of all scans; failed amplitudes."""
    rows, arrays = [], dict[str, np.ndarray]()
    for name, several in ways.items():
        for way, diagram in several.items():
            rows += amplitudes(name, way, diagram)
            stem = f"{'single_mode' if name == 'Eq. (1)' else name.replace(' ', '_')}_{way}"
            arrays |= {f"{stem}_excess": diagram.excess, f"{stem}_points": diagram.points,
                       f"{stem}_period": periods(diagram), f"{stem}_impacts": diagram.impacts}  # fmt: skip
            for reason in diagram.failures:
                run.failed(f"{name}, {way}", reason)
    run.table("scans", rows, "Scans through grazing.", show=())
    run.arrays("breakdown", **arrays)


def word(period: int) -> str:
    """How verdicts name a period."""
    return f"p{period}" if period else "no period"


def judge(
    run: Run, map_period: int, outcomes: Sequence[Outcome], found: Outcome | None, islands: Sequence[Island]
) -> None:
    """The three points of the letter; `outcomes` begin with Eq. (1) and the calibrated beam."""
    single, beam = outcomes[:2]
    which = "" if found is None or found.tip_mass_kg is None else (
        f"one of {1e3 * found.tip_mass_kg:.2f} g with {found.higher_damping:g} times the damping of the "
        "higher modes does, and the letter prints neither"
    )  # fmt: skip
    mass = f"the calibrated ball of {1e3 * (beam.tip_mass_kg or 0.0):.2f} g does not"
    said = (f"map {word(map_period)}, Eq. (1) {word(single.born_period)}, "
            f"beam {word(beam.born_period)} as calibrated")  # fmt: skip
    if beam.born_period == BORN_PERIOD:
        run.verdict("breakdown", "agrees", found=said)
    elif found is not None and found.born_period == BORN_PERIOD:
        run.verdict("breakdown", "in part", found=f"{said}, {word(found.born_period)} found",
                    note=f"{mass}; {which}")  # fmt: skip
    else:
        run.verdict("breakdown", "differs", found=said, note="no cell of the search has it")
    ends = [outcome for outcome in (beam, found) if outcome is not None and outcome.ends_on_p3]
    if ends:
        run.verdict("breakdown_p3", "agrees" if ends[0] is beam else "in part",
                    found=f"beam: {ends[0].p3_first:.4f} to {ends[0].p3_last:.4f}",
                    note="" if ends[0] is beam else f"{mass}; {which}")  # fmt: skip
    else:
        run.verdict("breakdown_p3", "differs", found="beam: not so", note="no downward scan ends in p3")
    alive = [entry.restitution for entry in islands if entry.alive_at_letters_chaos]
    printed = any(abs(tau - letter.RESTITUTION) < 1e-9 for tau in alive)
    run.verdict("island", "agrees" if printed else "in part" if alive else "differs",
                found="Eq. (1): " + "; ".join(
                    f"{i.fold_p3:.3f} to {i.end:.3f} at tau = {i.restitution:g}" for i in islands),
                note=(f"the island is there; at the quoted place it needs tau of {max(alive):g} or less, "
                      "read as an excess") if alive else "no island reaches the quoted place")  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(breakdown.main())
