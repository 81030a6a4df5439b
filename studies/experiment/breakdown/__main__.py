"""Fig. 5 of the letter: where the square-root map fails near grazing.
Its values are f = 19.65 Hz, T = 41.2 ms and mu = 3.56 1/s.

Claim (letter 1996, Fig. 5): where the map has p3, "at rho = 0 the trivial noncolliding p1 orbit gives way to
a period-6 orbit. The stable periodic p3 orbit is found only at the very end of the downward scan"; and
"Eq. (1) predicts for this case a chaotic state at rho = -0.0707 that is not connected to the state that is
born at rho = 0".

Computed:

    Eq. (1)     both scans, and for several restitutions the island of p3 and chaos below grazing: from the
                fold of p3 (closed form) upwards until the motion is free of impacts
    beam        both scans of the scene's spring, fitted again to T and mu
    search      the born period over what is not printed: mass of ball and mount, damping of higher modes
    found       the scans of the cell with period 6 that departs least from the scene and ends on p3

Run:     python -m studies breakdown [--full] [--quick]     --full takes some minutes
Writes:  outcomes.csv (a row a beam), islands.csv, born_period.csv (a row a cell of the search),
         breakdown.csv (a row a strobed point of the scans), and the figures breakdown, born_period
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated

from contact import maximal_m
from studies import letter
from studies.experiment.breakdown.model import (
    BORN_PERIOD,
    CHAOS_AT,
    FREQUENCY_HZ,
    Cell,
    Island,
    Outcome,
    Spring,
    cell_of,
    fig_5,
    island,
    nearest_first,
    scanned,
    single_mode,
    tuned,
)
from studies.physics.descriptions import Diagram, StrobePoint, strobe_points_of, word
from studies.physics.least_model import TRACE_EXCESS
from studies.shell.digits import written
from studies.shell.options import MOST_CELLS, Within
from studies.shell.scene import Scene, model_of, nordmark_at
from studies.shell.study import Run, study

RESTITUTIONS, QUICK_RESTITUTIONS = (0.0, 0.05, 0.06, 0.075, 0.1), (0.05, 0.1)
MASSES_G = (3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0)
FACTORS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 8.0)
QUICK_MASSES_G, QUICK_FACTORS = (3.5, 4.0), (1.0, 2.0)
"""Ball and mount [g], factors on the damping of the higher modes."""

MOST_SCANNED = 4  # cells with period 6 whose scans are made: those that depart least from the scene


@study(
    needs={"kick": 0.005},
    quick={"points": 21, "cycles": 500},
    at=lambda scene, options: ([FREQUENCY_HZ], TRACE_EXCESS),
)
def breakdown(
    scene: Scene,
    run: Run,
    *,
    full: Annotated[bool, "as the experiment did: 10000 drive periods per amplitude, never fewer"] = False,
    points: Annotated[int, "amplitudes of a scan below grazing", Within(2, MOST_CELLS // 5)] = 81,
    cycles: Annotated[int, "most drive periods at an amplitude"] = 2000,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    scene = fig_5(scene)
    tau, nordmark = scene.single_mode.restitution, nordmark_at(scene, FREQUENCY_HZ)
    taus = sorted({*(QUICK_RESTITUTIONS if run.quick else RESTITUTIONS), tau})
    islands = run.map(partial(island, scene), taus, "islands")
    known = [entry for entry, _ in islands]
    run.table("islands", known, "The island of p3 and chaos of Eq. (1) below grazing.", of=Island)
    calibrated = Spring(scene=scene, model=model_of(scene), tip_mass_kg=scene.tip.mass_kg)
    cells, with_6 = search(scene, run)
    jobs = [("Eq. (1)", single_mode(scene, tau)), ("beam", calibrated)]
    jobs += [(f"beam {number}", one) for number, one in enumerate(with_6[:MOST_SCANNED], start=1)]
    cycles = letter.SETTLE_CYCLES if full else cycles
    found_by = partial(scanned, points=points, cycles=cycles, early=not full)
    scans = run.map(found_by, jobs, "scans")
    if (own := islands[taus.index(tau)][1]).excess.size:
        scans[0][1]["island"] = own
    outcomes = [outcome for outcome, _ in scans]
    # as in the letter: p3 in the downward scan; otherwise the first candidate
    candidates = [*(o for o in outcomes[2:] if o.p3_last is not None), *outcomes[2:]]
    found = candidates[0] if candidates else None
    words = "The period that begins at grazing, and the end of the downward scan."
    run.table("outcomes", outcomes, words, of=Outcome)
    springs = [spring for _, spring in jobs]
    store(run, scans, [spring.strobed().oscillator.grazing_amplitude() for spring in springs])
    from studies.experiment.breakdown import figure

    shown = [pair for pair in scans if pair[0] in (*outcomes[:2], found)]
    run.figure("breakdown", figure.draw_scans(shown, tau, letters=run.letters), figure.SCANS)
    born = figure.draw_born(cells, scene.tip.mass_kg, found, letters=run.letters)
    run.figure("born_period", born, figure.BORN)
    findings(run, outcomes[1], found, known[taus.index(tau)])
    judge(run, maximal_m(nordmark), outcomes, found, known)
    return {
        "excess_of_letters_chaos_as_rho": nordmark.excess(CHAOS_AT),
        "islands": known,
        "rows": outcomes,
        "found": found,
        "cells_with_period_6": [cell for cell in cells if cell.m == BORN_PERIOD],
    }


def search(scene: Scene, run: Run) -> tuple[list[Cell], list[Spring]]:
    """The born period in every cell of mass and factor on the higher modes' damping; and the beams born with
    period 6, those first that depart least from the scene."""
    grams, factors = (QUICK_MASSES_G, QUICK_FACTORS) if run.quick else (MASSES_G, FACTORS)
    masses = [m / 1000 for m in grams]
    models = dict(zip(masses, run.map(partial(tuned, scene), masses, "springs"), strict=True))
    springs = [
        Spring(scene=scene, model=models[m], tip_mass_kg=m, higher_damping=k) for m in masses for k in factors
    ]
    found = run.attempt(cell_of, springs, "cells of the search")
    cells = [cell for cell in found if cell is not None]
    words = "Period that begins at grazing, by what is not printed."
    run.table("born_period", cells, words, of=Cell, show=())
    with_6 = [one for one, cell in zip(springs, found, strict=True) if cell and cell.m == BORN_PERIOD]
    return cells, nearest_first(with_6, scene.tip.mass_kg)


def store(run: Run, scans: Sequence[tuple[Outcome, Mapping[str, Diagram]]], grazing: Sequence[float]) -> None:
    """The strobed points of all scans; failed amplitudes. `grazing`: grazing amplitudes [m]."""
    points = list[StrobePoint]()
    for (outcome, ways), amplitude in zip(scans, grazing, strict=True):
        points += strobe_points_of(FREQUENCY_HZ, outcome.description, amplitude, ways)
        for way, diagram in ways.items():
            for reason in diagram.failures:
                run.failed(f"{outcome.description}, {way}", reason)
    run.table("breakdown", points, "Strobed points of the scans.", of=StrobePoint, show=())


def findings(run: Run, beam: Outcome, found: Outcome | None, own: Island) -> None:
    """The findings: what is born of the calibrated beam, and of the one found; the island of Eq. (1)."""
    born = word(beam.born_period) if beam.born_period else "no periodic motion"
    saw = f"; the letter saw p{BORN_PERIOD}" * run.letters
    run.finding(f"With period and damping of Fig. 5 the calibrated beam has {born} just above grazing{saw}.")
    if found is not None:
        mass = written(1e3 * (found.tip_mass_kg or 0.0), 3)
        ends = ", and its downward scan ends on p3" if found.ends_on_p3 else ""
        run.finding(f"A beam with ball and mount of {mass} g has p{BORN_PERIOD} just above grazing{ends}.")
    if own.end > own.fold_p3:
        words = "Below grazing Eq. (1) has p3 and chaos, not connected with grazing, up to an excess of"
        run.finding(f"{words} {written(own.end, 2)}.")


def judge(
    run: Run, map_period: int, outcomes: Sequence[Outcome], found: Outcome | None, islands: Sequence[Island]
) -> None:
    """The three points of the letter; `outcomes` begin with Eq. (1) and the calibrated beam."""
    single, beam = outcomes[:2]
    born = [word(one.born_period) for one in (single, beam)]
    said = f"map {word(map_period)}, Eq. (1) {born[0]}, beam {born[1]} as calibrated"
    note = "no cell of the search has it"
    if found is not None:
        said += f", {word(found.born_period)} in the search"
        note = f"the calibrated ball of {1e3 * (beam.tip_mass_kg or 0.0):.2f} g does not; one of "
        note += (
            f"{1e3 * (found.tip_mass_kg or 0.0):.2f} g, higher modes damped × {found.higher_damping:g}, does"
        )
    agrees, in_part = (one is not None and one.born_period == BORN_PERIOD for one in (beam, found))
    run.verdict(
        "breakdown",
        "agrees" if agrees else "in part" if in_part else "differs",
        found=said,
        note="" if agrees else note,
        figure="" if agrees else "born_period",
    )
    ends = next((outcome for outcome in (beam, found) if outcome is not None and outcome.ends_on_p3), None)
    run.verdict(
        "breakdown_p3",
        "differs" if ends is None else "agrees" if ends is beam else "in part",
        found=f"beam: {'not so' if ends is None else 'p3 at the end of the downward scan'}",
        note="no downward scan ends in p3" if ends is None else "" if ends is beam else note,
    )
    spans = [f"{written(i.fold_p3, 3)} to {written(i.end, 3)} at τ = {i.restitution:g}" for i in islands]
    alive = [entry.restitution for entry in islands if entry.end >= CHAOS_AT]
    printed = any(abs(tau - letter.RESTITUTION) < 1e-9 for tau in alive)
    needs = f"the island is there; at the quoted place it needs τ of {max(alive, default=0.0):g} or less"
    run.verdict(
        "island",
        "agrees" if printed else "in part" if alive else "differs",
        found=f"Eq. (1): {'; '.join(spans)}",
        note=f"{needs}, read as an excess" if alive else "no island reaches the quoted place",
    )
