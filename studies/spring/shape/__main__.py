"""Which springs the words "U shaped" allow, and what they change.

Claim (letter 1996, Fig. 1 and text): the spring is U shaped to suppress torsional modes. The words allow
three shapes: legs side by side in the plane of the sheet, a channel, and a strip folded into a U. A plain
strip of the same width and period is their measure. In every shape the ball moves in a twist mode only as far
as it sits off the plane of symmetry. Torsion leaves the reading open. What decides is how far each spring is
from linear at its gap (`finite_amplitude`): a folded U with a tight bend softens so much that it loses the
letter's periods; a single leaf, legs side by side or a wide bend keep them.

Strip theory, of centreline r(s), displacements u t + w n + v z and twist phi about t, tied to the ball, has

    (EA, u' - k w), (EI_z, w'' + k u'), (EI_n, v'' - k phi), (GJ, phi' + k v'), (EG, phi'' + k v'')

as stiffness and strain (beam.space). Each shape is brought to omega_1^2 = (2 pi/T)^2 + (c/2)^2 by its sheet's
thickness, the channel by its flanges. The scene gives length, width, bend radius, sheet material, ball and
period; its tape plays no part. The rotary inertia of ball and mount counts about every axis.

The beam of the scene simplifies the flat U, which is a sheet. As a Kirchhoff plate (`plate`) it has modes in
which the legs twist. Question: does the plate change the born periods and the ends of the orbits? This part
needs spring.kind = "flat_u" and a harmonic drive.

Run:     python -m studies shape [--quick]
Writes:  readings.csv (a row a shape); of a flat U plate_ends.csv (a row a frequency);
         springs.csv (a row a reading, bend radius, gap and ball); the figure finite_amplitude
"""

from collections.abc import Mapping
from functools import partial

from studies.shell.scene import Scene, model_of
from studies.shell.study import Run, study
from studies.spring.shape.finite_amplitude import Survival, springs_of, survivals
from studies.spring.shape.model_error import COARSE, FINE, MODES, OrbitEnds, models_of, orbit_rows, plates_of
from studies.spring.shape.shapes import TITLES, Reading, ReadingRow, reading_row, shapes_of


@study()
def shape(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    readings = {name: reading_row(one) for name, one in shapes_of(scene).items()}
    run.table("readings", list(readings.values()), "Four springs of one free period.", of=ReadingRow)
    judge(run, readings)
    return {
        "rows": list(readings.values()),
        "plate_ends": compare_plate(scene, run),
        "springs": finite_amplitude(scene, run),
    }


def judge(run: Run, readings: Mapping[Reading, ReadingRow]) -> None:
    """The verdict on the suppression of torsion."""
    plain = readings["plain"]
    highest = max((n for n in readings if n != "plain"), key=lambda n: readings[n].ratio_twist)
    least = min(readings, key=lambda n: readings[n].turn_of_twist)
    twist, turn = readings[highest].ratio_twist, readings[least].turn_of_twist / plain.turn_of_twist
    run.verdict(
        "torsion",
        "in part" if plain.ratio_twist > twist else "agrees",
        found=f"{twist:.1f} times the first bending",
        note=f'Of the shapes that the words allow, "{TITLES[highest]}" has its twist highest; '
        f"a plain strip of the same period has it at {plain.ratio_twist:.1f} times; in that of "
        f'"{TITLES[least]}" the ball turns least, {turn:.2f} of this.',
    )
    of = f'Of the U shapes, "{TITLES[highest]}" has its first twist mode highest'
    run.finding(f"{of}, at {twist:.1f} times the frequency of the first bending mode.")


def compare_plate(scene: Scene, run: Run) -> list[OrbitEnds]:
    """Table of the flat U as a plate; none for another spring or drive."""
    if (scene.spring.kind, scene.drive.kind) != ("flat_u", "harmonic"):
        run.say("The part on the plate is left out: it needs a flat U with a harmonic drive.")
        return []
    beam, plates = model_of(scene), plates_of(scene, COARSE if run.quick else FINE)
    springs, frequencies = models_of(plates, beam), scene.drive.frequencies_hz
    orbits = orbit_rows(scene, run, springs, frequencies[:: 2 if run.quick else 1])
    known = [row for row in orbits if row.factors]
    caption = f"Where the orbits end, by plates of {MODES} modes and by the beam with {beam.n_modes}."
    if doubtful := [f"{row.frequency_hz:.2f}" for row in known if min(row.factors) < 0.0]:
        caption += f" Plates and beam differ in the sign of the end at {', '.join(doubtful)} Hz."
    run.table("plate_ends", orbits, caption, of=OrbitEnds)
    kept = "keeps every period" if all(row.same_period for row in orbits) else "changes a period"
    said = f"As a plate the spring {kept} that is born"
    if factors := [f for row in known if min(row.factors) > 0.0 for f in row.factors]:
        most = max(*factors, *(1.0 / factor for factor in factors))
        said += f"; the ends of the orbits move by a factor of up to {most:.1f}"
    run.finding(f"{said}.")
    return orbits


def finite_amplitude(scene: Scene, run: Run) -> list[Survival]:
    """The springs of the map, stored and drawn."""
    from studies.spring.shape import figure  # matplotlib is slow to import

    springs, gaps = springs_of(scene, run.quick)
    found = run.map(partial(survivals, scene, gaps), springs, "springs")
    rows = [row for part in found for row in part]
    shown = ("reading", "bend_radius_m", "gap_m", "tip_mass_kg", "kappa", "survive")
    run.table("springs", rows, "Springs by shape, bend radius, gap and ball.", of=Survival, show=shown)
    run.figure("finite_amplitude", figure.draw_survival(scene, rows, run.letters), figure.SURVIVAL)
    own = TITLES["folded"], scene.spring.bend_radius_m, scene.stop.gap_m, scene.tip.mass_kg
    row = next(r for r in rows if (r.reading, r.bend_radius_m, r.gap_m, r.tip_mass_kg) == own)
    kept = f" and keeps {row.survive or 'none'} of the letter's periods" if run.letters else ""
    bends = "softens" if row.kappa < 0.0 else "stiffens"
    run.finding(f"Folded with the scene's bend, the strip {bends} at large amplitudes{kept}.")
    return rows
