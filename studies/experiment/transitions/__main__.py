"""Fig. 2 of the letter: which period begins at grazing, in four models.

Claim (letter 1996, Fig. 2): when the drive amplitude passes grazing, the motion without impacts gives way to
an orbit of period m with one impact, m = 3, 4, 5, 6, 8, 10 at 20.90 ... 23.40 Hz; when the amplitude is
lowered again, that orbit remains until some way below grazing.

Computed, at each frequency, for the Nordmark map (Eqs. (2), (3)), the single mode (Eq. (1)), the single mode
with the restitution and delay of the beam's own collisions (`studies.physics.two_parameters`), and the beam
with its N modes:

    period           period of the settled orbit at F/F_g - 1 = 1e-3 (born: and at 2.5e-4, 1e-2), started
                     below grazing
    excess_down      F/F_g - 1 at which that orbit ends when the amplitude is lowered: bracketed by a scan,
                     and then the fold, period doubling or grazing (ends_by) that is in the bracket
    exact            the fold of p_m without simulation: in closed form for the map and Eq. (1), for the two
                     parameters from the kicks that collisions of the beam give mode 1
    extracted        restitution and delay on the settled orbit, and the map with that restitution
    orbit diagram    strobed points in an upward and a downward scan that carry the physical state along

In the figures filled points are the upward scan, open ones the downward scan. The dashed line is grazing,
the band around it as wide as the letter's amplitude was stable. A grey line marks an amplitude at which the
motion did not settle: its points, of one moment, are stored but not drawn.

Run:     python -m studies, or python -m studies transitions [--quick] [--full]     --full takes some minutes;
         python -m studies --all runs every study
Writes:  transitions.csv (a row a frequency and description), periods.csv (a line a frequency),
         two_parameters.csv (a row a frequency: what was extracted), orbit_diagram.npz (points, period and
         impacts by amplitude; period 0: not settled); the figures orbit_diagram (beam, at its read-out
         point), orbit_diagram_two_parameters, orbit_diagram_single_mode, orbit_diagram_map
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from studies.experiment.transitions.model import AtFrequency, Scans, Transition, rows_at, scans
from studies.letter import FREE_PERIOD_S
from studies.physics.descriptions import TITLES, word, words
from studies.physics.two_parameters import Extracted
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
class Line:
    """The descriptions at one frequency for a person: born period, and excess at which its orbit ends."""

    frequency_hz: float
    letter: str
    map: str
    single_mode: str
    two_parameters: str
    beam: str


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
    found = list[AtFrequency]()
    with run.pool() as pool:
        for at in pool.map(partial(rows_at, scene, model=model), sorted(scene.drive.frequencies_hz)):
            found.append(at)
            run.say(
                f"{at.rows[0].frequency_hz:.2f} Hz: letter {word(at.rows[0].letter)}; {in_words(at.rows)}"
            )
            for where, reason in at.failures:
                run.failed(where, reason)
    rows = [row for at in found for row in at.rows]
    parameters = [at.extracted for at in found if at.extracted is not None]
    run.json("rows", rows)
    run.table("transitions", rows, "Born periods, and how their orbits end.", of=Transition, show=())
    lines = [line_of(at.rows) for at in found]
    run.table("periods", lines, "Born period, and excess F/F_g - 1 at which its orbit ends.", of=Line)
    run.table("two_parameters", parameters, "Restitution and delay on the settled orbits.", of=Extracted)
    each = partial(scans, scene, model, full)
    diagrams = run.map(each, [at.rows for at in found], "orbit diagrams")
    store(run, found, diagrams)
    caption = "Strobed points against the amplitude; filled: upward scan, open: downward scan. "
    from studies.experiment.transitions.figure import draw  # matplotlib is slow to import

    for name in TITLES:
        stem = "orbit_diagram" if name == "beam" else f"orbit_diagram_{name}"
        drawn = draw(scene.readout.quantity, rows, diagrams, name)
        run.figure(stem, drawn, caption + TITLES[name] + ".")
    if (other := ends_beside_folds(rows)) and run.model_choice:
        run.warn(f"{other}: modes were chosen for folds, and more of them (modes.count) can move this end")
    compare(run, rows, parameters)
    seen = [at.rows for at in found if at.rows[0].letter is not None]
    agrees = [of_frequency[0].frequency_hz for of_frequency in seen if judge(run, of_frequency)]
    return {
        "rows": rows,
        "extracted": parameters,
        "modes": model.n_modes,
        "contact": scene.contact.law,
        "agrees_hz": agrees,
    }


def ends_beside_folds(rows: Sequence[Transition]) -> str:
    """A sentence on the orbits of the beam that do not end by a fold; empty if all do."""
    other = [row for row in rows if row.description == "beam" and row.ends_by not in (None, "fold")]
    places = ", ".join(f"{row.frequency_hz:g} Hz ({row.ends_by})" for row in other)
    return f"the beam's orbit does not end by a fold at {places}" if other else ""


def in_words(rows: Sequence[Transition]) -> str:
    """The born periods of one frequency."""
    return words({row.description: row.period for row in rows})


def line_of(rows: Sequence[Transition]) -> Line:
    """The rows of one frequency as one line."""
    ends = {row.description: "" if row.excess_down is None else f" {row.excess_down:+.4e}" for row in rows}
    cells = {row.description: word(row.period) + ends[row.description] for row in rows}
    return Line(frequency_hz=rows[0].frequency_hz, letter=word(rows[0].letter), **cells)


def judge(run: Run, rows: Sequence[Transition]) -> bool:
    """Verdict on the transition at a frequency; returns whether all descriptions agree."""
    same, first = [row.period == row.letter for row in rows], rows[0]
    note = "" if all(same) else f"at excess 0.01 {', '.join(word(row.born.get('0.01')) for row in rows)}"
    if note and first.frequency_hz == 23.40 and run.scene.single_mode.free_period_s == FREE_PERIOD_S:
        note += f"; {AT_THE_EDGE}"
    verdict: Verdict = "agrees" if all(same) else "in part" if any(same) else "differs"
    run.verdict(f"p{first.letter}", verdict, found=in_words(rows), note=note)
    return all(same)


def compare(run: Run, rows: Sequence[Transition], parameters: Sequence[Extracted]) -> None:
    """Whether Eq. (1) with the two parameters has the beam's periods and ends, and the map with them."""
    beams = {row.frequency_hz: row for row in rows if row.description == "beam" and row.period}
    twos = {row.frequency_hz: row for row in rows if row.description == "two_parameters"}
    found = [one for one in parameters if one.frequency_hz in beams]
    if not found:
        return
    pairs = [(twos[one.frequency_hz], beams[one.frequency_hz]) for one in found]
    same = [(two, beam) for two, beam in pairs if two.period == beam.period]
    ends = [(two.excess_down, beam.excess_down) for two, beam in same]
    close = sum(bool(a and b and 1.0 / NEARLY < a / b < NEARLY) for a, b in ends)
    of_map = sum(one.map == beams[one.frequency_hz].period for one in found)
    text = (
        "Eq. (1) with the restitution and delay of the beam's collisions has the beam's period at "
        f"{len(same)} of {len(found)} frequencies, and the map with that restitution at {of_map}. Its orbits "
        f"end where the beam's do, to a factor of {NEARLY:g}, at {close}."
        + " Elsewhere higher modes still ring when the tip comes back, which no restitution and no delay of "
        "a first collision contain." * (close < len(found))
    )
    run.answer("two_parameters", text)
    verdict: Verdict = "agrees" if close == len(found) else "in part" if same else "differs"
    said = f"period at {len(same)}, end at {close} of {len(found)} frequencies"
    run.verdict("two_parameters_born", verdict, found=said, note=text)


def store(run: Run, found: Sequence[AtFrequency], diagrams: Iterable[Scans]) -> None:
    """All scans, an array a column; failed amplitudes."""
    arrays = dict[str, np.ndarray]()
    for at, scanned in zip(found, diagrams, strict=True):
        frequency = at.rows[0].frequency_hz
        for name, ways in scanned.items():
            for way, diagram in ways.items():
                stem = f"{name}_{frequency:.2f}_hz_{way}".replace(".", "p")
                for column in ("excess", "points", "period", "impacts"):
                    arrays[f"{stem}_{column}"] = getattr(diagram, column)
                for reason in diagram.failures:
                    run.failed(f"{frequency:g} Hz, {TITLES[name]}, {way}ward scan", reason)
    run.arrays("orbit_diagram", **arrays)
