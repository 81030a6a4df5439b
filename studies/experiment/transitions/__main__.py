"""Fig. 2 of the letter: which period begins at grazing, in four models.

Claim (letter 1996, Fig. 2): when the drive amplitude passes grazing, the motion without impacts gives way to
an orbit of period m with one impact, m = 3, 4, 5, 6, 8, 10 at 20.90 ... 23.40 Hz; when the amplitude is
lowered again, that orbit remains until some way below grazing.

Computed, at each frequency, for the Nordmark map (Eqs. (2), (3)), the single mode (Eq. (1)), the single mode
with the restitution and delay of the beam's own collisions (`studies.physics.two_parameters`), and the beam
with its N modes: the period of the settled orbit at F/F_g - 1 = 1e-3, started below grazing; where that
orbit ends when the amplitude is lowered, bracketed by a scan and then located; orbit diagrams, in which the
physical state is carried along.

Run:     python -m studies, or python -m studies transitions [--quick] [--full]     --full takes some minutes;
         python -m studies --all runs every study
Writes:  transitions.csv (a row a frequency and description), two_parameters.csv (a row a frequency: what was
         extracted), orbit_diagram.csv (a row a strobed point); the figures orbit_diagram (beam, at its
         read-out point), orbit_diagram_two_parameters, orbit_diagram_single_mode, orbit_diagram_map
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated

from studies.experiment.transitions.model import AtFrequency, Scans, Transition, rows_at, scans
from studies.letter import FREE_PERIOD_S, TRANSITION_HZ
from studies.physics.descriptions import TITLES, StrobePoint, strobe_points_of, word, words
from studies.physics.two_parameters import Extracted
from studies.shell.digits import written
from studies.shell.run import Verdict
from studies.shell.scene import Scene, harmonic, model_of
from studies.shell.study import Run, study

QUICK_POINTS = 21  # amplitudes of a scan in the small form, at most

NEARLY = 1.25  # factor within which two ends of an orbit count as one

AT_THE_EDGE = (
    "the edge between p10 and p11 lies at 23.343 Hz, where f T = 20/21: p10 at grazing needs T below 40.70 ms"
)
"""Why 23.40 Hz is p11."""


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
            first = at.rows[0]
            run.say(f"{first.frequency_hz:.2f} Hz: letter {word(first.letter)}; {in_words(at.rows)}")
            for where, reason in at.failures:
                run.failed(where, reason)
    rows = [row for at in found for row in at.rows]
    parameters = [at.extracted for at in found if at.extracted is not None]
    shown = ("frequency_hz", "description", "letter", "m", "excess_down", "ends_by")
    words = "Periods that begin at grazing, and where their orbits end when the drive is lowered."
    run.table("transitions", rows, words, of=Transition, show=shown)
    words = "Restitution and time delay of the beam's collisions on the settled orbits."
    run.table("two_parameters", parameters, words, of=Extracted)
    each = partial(scans, scene, model, full)
    diagrams = run.map(each, [at.rows for at in found], "orbit diagrams")
    store(run, found, diagrams)
    from studies.experiment.transitions.figure import draw  # matplotlib is slow to import

    for name in reversed(TITLES):
        stem = "orbit_diagram" if name == "beam" else f"orbit_diagram_{name}"
        drawn = draw(scene.readout.quantity, rows, diagrams, name, letters=run.letters)
        caption = "Displacement once in each drive period, while the amplitude is raised and lowered"
        run.figure(stem, drawn, f"{caption}: {TITLES[name]}.")
    if (other := ends_beside_folds(rows)) and run.model_choice:
        run.warn(f"{other}: modes were chosen for folds, and more of them (modes.count) can move this end")
    findings(run, rows)
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
    return words({row.description: row.m for row in rows})


def findings(run: Run, rows: Sequence[Transition]) -> None:
    """The findings on the beam: its born periods, and the deepest of its orbits below grazing."""
    beams = [row for row in rows if row.description == "beam" and row.m is not None]
    ours = {row.frequency_hz: row.m for row in beams}
    sentence, seen = "Map, Eq. (1) and beam have the same period just above grazing", rows
    if run.letters:
        sentence, seen = "Just above grazing the beam has the period that the letter saw", beams
    own = [row.letter if run.letters else row.m for row in seen]
    pairs = zip(seen, own, strict=True)
    other = sorted({row.frequency_hz for row, m in pairs if m not in (None, ours.get(row.frequency_hz))})
    but = f" but {other[0]:.2f} Hz" if len(other) == 1 else f" but {len(other)}" if other else ""
    if beams and len(other) < len(ours):
        run.finding(f"{sentence}, at every drive frequency{but}.")
    depth, m = min(((row.excess_down or 0.0, row.m) for row in beams), default=(0.0, 0))
    if depth < 0.0:
        words = f"When the amplitude is lowered again, the beam's p{m} remains until"
        run.finding(f"{words} {written(-100.0 * depth, 2)} % below grazing, the widest of these hystereses.")


def judge(run: Run, rows: Sequence[Transition]) -> bool:
    """Verdict on the transition at a frequency; returns whether all descriptions agree."""
    same, first = [row.m == row.letter for row in rows], rows[0]
    above = {row.description: row.born.get("0.01") for row in rows}
    note = "" if all(same) else f"at excess 0.01: {words(above)}"
    own = run.scene.single_mode.free_period_s == FREE_PERIOD_S
    if note and own and first.frequency_hz == TRANSITION_HZ[10]:
        note += f"; {AT_THE_EDGE}"
    verdict: Verdict = "agrees" if all(same) else "in part" if any(same) else "differs"
    run.verdict(f"p{first.letter}", verdict, found=in_words(rows), note=note)
    return all(same)


def compare(run: Run, rows: Sequence[Transition], parameters: Sequence[Extracted]) -> None:
    """Whether Eq. (1) with the two parameters has the beam's periods and ends, and the map with them."""
    beams = {row.frequency_hz: row for row in rows if row.description == "beam" and row.m}
    twos = {row.frequency_hz: row for row in rows if row.description == "two_parameters"}
    found = [one for one in parameters if one.frequency_hz in beams]
    if not found:
        return
    pairs = [(twos[one.frequency_hz], beams[one.frequency_hz]) for one in found]
    same = [(two, beam) for two, beam in pairs if two.m == beam.m]
    ends = [(two.excess_down, beam.excess_down) for two, beam in same]
    close = sum(bool(a and b and 1.0 / NEARLY < a / b < NEARLY) for a, b in ends)
    of_map = sum(one.map == beams[one.frequency_hz].m for one in found)
    if same:
        missed = len(found) - close
        where = "every frequency" if len(same) == len(found) else "some frequencies"
        end = f"; its orbits end elsewhere at {missed} of them" if missed else ""
        words = "Eq. (1) with the beam's restitution and time delay has the beam's period at"
        run.finding(f"{words} {where}{end}.")
    verdict: Verdict = "agrees" if close == len(found) else "in part" if same else "differs"
    said = f"the beam's period at {len(same) or 'none'} of {len(found)} frequencies"
    said += f", its end to a factor of {NEARLY:g} at {close or 'none'}"
    note = f"the map with that restitution has the beam's period at {of_map} of them"
    if close < len(found):
        note += "; elsewhere higher modes still ring when the tip comes back"
    name = "orbit_diagram_two_parameters"
    run.verdict("two_parameters_born", verdict, found=said, note=note, figure=name)


def store(run: Run, found: Sequence[AtFrequency], diagrams: Sequence[Scans]) -> None:
    """The strobed points of all scans; failed amplitudes."""
    points = list[StrobePoint]()
    for at, scanned in zip(found, diagrams, strict=True):
        for row in (row for row in at.rows if row.description in scanned):
            ways = scanned[row.description]
            points += strobe_points_of(row.frequency_hz, row.description, row.grazing_amplitude, ways)
            for way, diagram in ways.items():
                for reason in diagram.failures:
                    where = f"{row.frequency_hz:g} Hz, {TITLES[row.description]}, {way}ward scan"
                    run.failed(where, reason)
    run.table("orbit_diagram", points, "Strobed points of the orbit diagrams.", of=StrobePoint, show=())
