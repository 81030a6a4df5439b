"""The letter's six transitions p1 <-> pm: map, Eq. (1), its two parameters and the beam side by side.

Claim (letter 1996, Fig. 2): when the drive amplitude passes grazing, the motion without impacts gives way to
an orbit of period m with one impact, m = 3, 4, 5, 6, 8, 10 at 20.90 ... 23.40 Hz; when the amplitude is
lowered again, that orbit lives on until some way below grazing.

Computed, at each frequency, for the Nordmark map (Eqs. (2), (3)), the single mode (Eq. (1)), the single mode
with restitution and delay as the beam's own collisions have them (`studies.physics.two_parameters`), and the
beam with its N modes:

    born period      period of the settled orbit at F/F_g - 1 = 1e-3 (and 2.5e-4, 1e-2), started below grazing
    excess_down      F/F_g - 1 at which that orbit ends when the amplitude is lowered: bracketed by a scan,
                     and then the fold, period doubling or grazing (ends_by) that is in the bracket
    exact            the fold of p_m in closed form, of the map and of Eq. (1); of the two parameters from the
                     kicks that collisions of the beam give mode 1
    extracted        restitution and delay on the settled orbit, and the map with that restitution
    orbit diagram    strobed points in an upward and a downward scan that carry the physical state along

In the figures filled points are the upward scan, open ones the downward scan; the dashed line is grazing,
the band around it as wide as the letter's amplitude was stable; a grey line marks an amplitude at which the
motion did not settle: its points, those of a moment, are stored but not drawn.

Run:     python -m studies, or python -m studies transitions [--quick] [--full]     --full takes some minutes;
         python -m studies --all runs every study
Writes:  transitions.csv (a row a frequency), orbit_diagram.csv (a row an amplitude: period, and whether the
         motion settled), orbit_diagram.npz (points), orbit_diagram.png (beam, at its read-out point),
         orbit_diagram_two_parameters.png, orbit_diagram_single_mode.png, orbit_diagram_map.png;
         two_parameters.csv (a row a frequency: what was extracted)
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from studies.experiment.transitions.descriptions import TITLES, Row, Scans, row_at, scans
from studies.letter import FREE_PERIOD_S
from studies.shell.run import Verdict
from studies.shell.scene import Scene, harmonic, model_of
from studies.shell.study import Run, study

QUICK_POINTS = 21
"""Amplitudes of a scan in the small form, at most."""

NEARLY = 1.25
"""Factor within which two ends of an orbit count as one."""

AT_THE_EDGE = (
    "the edge between p10 and p11 lies where f T = 20/21, at 23.343 Hz for T = 40.80 ms: p10 at grazing "
    "needs T below 40.70 ms, five times the printed error of 0.02 ms"
)
"""Why 23.40 Hz is p11."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One amplitude of one scan; `kind` is "periodic", "not settled" or "failed"."""

    frequency_hz: float
    model: str
    direction: str
    excess: float
    kind: str
    period: int
    impacts: int
    cycles: int


@study(needs={"born_period": 0.0, "fold": 0.07})
def transitions(
    scene: Scene,
    run: Run,
    *,
    full: Annotated[bool, "as the experiment did: 10000 drive periods per amplitude, never fewer"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if run.quick:
        scene = scene.replace({"scan.points": min(scene.scan.points, QUICK_POINTS)}, provenance="quick")
    model = model_of(harmonic(scene))
    rows: list[Row] = []
    with run.pool() as pool:
        at = partial(row_at, scene, model=model)
        for row, failures in pool.map(at, sorted(scene.drive.frequencies_hz)):
            rows.append(row)
            run.say(sentence(row))
            for where, reason in failures:
                run.failed(where, reason)
    run.json("rows", rows)
    shown = ["frequency_hz", "letter", *TITLES]
    shown += [*(f"excess_down_{model}" for model in TITLES), "end_speed_beam"]
    run.table("transitions", rows, "Born period, and excess F/F_g - 1 at which the orbit ends.", show=shown)
    diagrams = run.map(partial(scans, scene, model=model, full=full), rows, "orbit diagrams")
    store(run, rows, diagrams)
    caption = "Strobed points against the amplitude; filled: upward scan, open: downward scan. "
    from studies.experiment.transitions.figure import draw  # matplotlib is slow to import

    for name in TITLES:
        stem = "orbit_diagram" if name == "beam" else f"orbit_diagram_{name}"
        run.figure(stem, draw(scene, rows, diagrams, name), caption + TITLES[name] + ".")
    compare(run, rows)
    agrees = [row.frequency_hz for row in rows if row.letter is not None and judge(run, row)]
    return {"rows": rows, "modes": model.n_modes, "contact": scene.contact.law, "agrees_hz": agrees}


def word(period: int | None) -> str:
    """How table and sentences name a period."""
    return f"p{period}" if period else "-" if period is None else "not settled"


def sentence(row: Row) -> str:
    """A row as a line, as soon as it is known."""
    found = ", ".join(f"{TITLES[name]} {word(period)}" for name, period in row.periods().items())
    return f"{row.frequency_hz:.2f} Hz: letter {word(row.letter)}; {found}"


def judge(run: Run, row: Row) -> bool:
    """Verdict on the transition at a frequency; returns whether all descriptions agree."""
    same = [period == row.letter for period in row.periods().values()]
    above = [word(getattr(row, f"born_{name}").get("0.01")) for name in TITLES]
    note = "" if all(same) else f"at excess 0.01 {', '.join(above)}"
    if note and row.frequency_hz == 23.40 and run.scene.single_mode.free_period_s == FREE_PERIOD_S:
        note += f"; {AT_THE_EDGE}"
    verdict: Verdict = "agrees" if all(same) else "in part" if any(same) else "differs"
    found = ", ".join(f"{TITLES[name]} {word(period)}" for name, period in row.periods().items())
    run.verdict(f"p{row.letter}", verdict, found=found, note=note)
    return all(same)


def compare(run: Run, rows: Sequence[Row]) -> None:
    """Where the two extracted parameters have the beam's bifurcations, and the map with them."""
    found = [(row, row.extracted) for row in rows if row.extracted and row.beam]
    run.table(
        "two_parameters",
        [parameters for _, parameters in found],
        "Restitution and delay on the settled orbits, and what they give.",
    )
    if not found:
        return
    same = [(row, one) for row, one in found if row.two_parameters == row.beam]
    ratios = [(row.excess_down_two_parameters or 0.0) / (row.excess_down_beam or math.inf) for row, _ in same]
    far = [
        f"{one.frequency_hz:g} Hz ({one.ringing_left:.0%})"
        for (_, one), ratio in zip(same, ratios, strict=True)
        if not 1.0 / NEARLY < ratio < NEARLY
    ]
    close, taus = len(same) - len(far), sorted(one.restitution for _, one in found)
    text = (
        f"With restitution, {taus[0]:.2f} to {taus[-1]:.2f}, and delay as the beam's own collisions have "
        f"them, one mode has the beam's period at {len(same)} of {len(found)} frequencies, the map with that "
        f"restitution at {sum(one.map == row.beam for row, one in found)}. Lowered again, the orbit ends "
        f"where the beam's does, to a factor of {NEARLY:g}, at {close}"
    )
    if far:
        text += (
            f"; elsewhere, {', '.join(far)}, higher modes still ring by that part when the tip comes back, "
            "which no restitution and no delay of a first collision contain"
        )
    run.answer("two_parameters", f"{text}.")
    verdict: Verdict = "agrees" if close == len(found) else "in part" if same else "differs"
    run.verdict(
        "two_parameters_born",
        verdict,
        found=f"period at {len(same)}, end at {close} of {len(found)} frequencies",
        note=f"{text}.",
    )


def store(run: Run, rows: Iterable[Row], diagrams: Iterable[Scans]) -> None:
    """The points of all scans as npz, period and kind of each amplitude as csv."""
    arrays, cells = dict[str, NDArray[np.float64]](), list[Cell]()
    for row, found in zip(rows, diagrams, strict=True):
        for name, ways in found.items():
            for way, diagram in ways.items():
                stem = f"{name}_{row.frequency_hz:.2f}_hz_{way}".replace(".", "p")
                arrays[f"{stem}_excess"], arrays[f"{stem}_points"] = diagram.excess, diagram.points
                for k, kind in enumerate(diagram.kind):
                    cells.append(
                        Cell(
                            frequency_hz=row.frequency_hz,
                            model=name,
                            direction=way,
                            kind=kind,
                            excess=float(diagram.excess[k]),
                            period=int(diagram.period[k]),
                            impacts=int(diagram.impacts[k]),
                            cycles=int(diagram.cycles[k]),
                        )
                    )
                for reason in diagram.failures:
                    run.failed(f"{row.frequency_hz:g} Hz, {TITLES[name]}, {way}ward scan", reason)
    run.arrays("orbit_diagram", **arrays)
    run.table("orbit_diagram", cells, show=())
