"""What one collision does to mode 1: restitution, delay and kick.

Claim (letter 1996): a collision of the spring with its many modes is, for the single mode of Eq. (1), an
impact with "energy loss and time delay"; the restitution is "estimated to be tau ~ 0.1", and the loss is put
down to energy given to the higher modes.

Computed: the first collision of the steady driven motion at an excess above grazing, and from it
(contact.collisions)

    restitution tau, delay, kick = -(jump of the mode-1 tip velocity)/v, shift = jump of its displacement,
    tau^2 = (1 - kick)^2 + 2 a shift / v^2,   delay = (v/a)(1 + tau - kick)         to leading order in v,

v the approach speed, v/a the time to the top of the arc beyond the gap, a = (2 pi f)^2 gap. Varied, one at a
time: excess and tip mass (free period and drive amplitude at grazing kept); and tip mass together with loss
in the contact, in search of the letter's tau.

`studies.experiment.soft_wall` shows how the kick fades towards grazing, `studies.methods.adequacy` how many
modes a collision needs.

Run:     python -m studies effective_impact [--quick]
Writes:  collisions.csv (a row an approach), floors.csv (smallest restitution over the tip mass), and the
         figures speed and mass
"""

import math
from collections.abc import Mapping, Sequence
from functools import partial

from studies import letter
from studies.experiment.effective_impact.model import (
    MASS_RATIOS,
    Approach,
    Case,
    Floor,
    Spring,
    cases_of,
    floor_of,
    on_orbits,
    select,
    series_of,
)
from studies.shell.digits import written
from studies.shell.run import Verdict
from studies.shell.scene import Scene, harmonic, spring_of
from studies.shell.study import Run, study

FINE_MESH = {"spring.elements_per_leg": 120, "spring.elements_on_arc": 60}
"""Twice the default, for the collision that the answer quotes."""

FULL, QUICK = (1, 40), (4, 20)  # every so manieth value of a curve, with so many modes

NEAR = 0.05  # how far a restitution may be from "about 0.1"

WHERE = "At a small amplitude above grazing", "At the amplitude of Fig. 4"
"""The excess of a first collision, for another spring and for the letter's."""


@study()
def effective_impact(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    spring_of(harmonic(scene))  # refuses measured modes, which have no tip mass to vary
    every, modes = QUICK if run.quick else FULL
    frequency = min(scene.drive.frequencies_hz, key=lambda f: abs(f - letter.TRANSITION_HZ[5]))
    fine = scene
    if not (scene.spring.elements_per_leg or scene.spring.elements_on_arc):
        fine = scene.replace(FINE_MESH)
    spring, reference = (Spring.of(one, frequency, modes) for one in (scene, fine))
    masses = run.map(partial(Spring.of, scene, frequency, modes), MASS_RATIOS[::every], "springs")
    found = run.attempt(Case.measured, cases_of(spring, masses, reference, every), "collisions")
    rows = [row for row in found if row is not None]
    run.table("collisions", rows, "One collision a row, and what it does to mode 1.", of=Approach, show=())
    searches = [select(rows, "search", name) for name in series_of(rows, "search")]
    floors = [floor for search in searches if (floor := floor_of(search)) is not None]
    run.table(
        "floors", floors, "Smallest restitution over the tip mass, by restitution of the contact.", of=Floor
    )
    from studies.experiment.effective_impact import figure  # matplotlib is slow to import

    for draw in (figure.mass, figure.speed) if select(rows, "mass") else (figure.speed,):
        run.figure(draw.__name__, draw(rows, run.letters), " ".join((draw.__doc__ or "").split()))
    quoted = next(iter(select(rows, "reference")), None)
    if quoted is not None:
        delay = f"delays mode 1 by {written(1e3 * quoted.delay_s, 2)} ms"
        delay = delay if quoted.returns else "keeps mode 1 from coming back to the gap"
        run.finding(f"{WHERE[run.letters]}, a first collision {delay}.")
        if quoted.returns and any(floor.local_restitution == 1.0 for floor in floors):
            judge(run, quoted, on_orbits(rows), floors)
    return {
        "rows": rows,
        "frequency_hz": frequency,
        "reference": quoted,
        "on_settled_orbits": on_orbits(rows),
        "floors": floors,
    }


def judge(run: Run, at: Approach, orbits: Sequence[Approach], floors: Sequence[Floor]) -> None:
    """Verdicts on restitution and delay, and what came out."""
    loss = {floor.local_restitution: floor.restitution for floor in floors}
    least, lossy = loss[1.0], min(loss.values())
    returned = [orbit.restitution for orbit in orbits if orbit.returns]
    lost = len(orbits) - len(returned)
    span = f"{min(returned):.2f} to {max(returned):.2f}" if returned else "none"
    span += f" (in {lost} of {len(orbits)} mode 1 does not come back to the gap)" if lost else ""
    reached = lost > 0 or min(returned, default=math.inf) <= letter.RESTITUTION
    verdict: Verdict = "in part" if reached else "differs"
    run.verdict(
        "restitution",
        "agrees" if least <= letter.RESTITUTION + NEAR else verdict,
        found=f"{least:.2f} at least in a first collision; {span} on settled orbits",
        note=f"{lossy:.2f} at least with any loss in the contact; on settled orbits the ringing of the "
        "collision before moves the touch",
    )
    delay = f"{1e3 * at.delay_s:.3f} ms at an excess of {at.excess:g}"
    note = f"{at.delay_s / at.arc_s:.2f} of the time v/a in which the tip would turn by itself"
    arc = at.arc_s * (1.0 + at.restitution - at.kick)
    late = 0.0 < at.delay_s and abs(at.delay_s - arc) <= NEAR * at.arc_s
    run.verdict("delay", "not printed" if late else "differs", found=delay, note=note, figure="speed")
    less = ": the letter estimates less" if run.letters and lossy > letter.RESTITUTION + NEAR else ""
    low = f"no first collision leaves mode 1 a restitution below {written(lossy, 2)}, whatever the ball{less}"
    run.finding(f"{WHERE[run.letters]}, {low}.")
    if returned:
        low = f"as low as {written(min(returned), 2)} at some masses"
        run.finding(f"On settled orbits, where the collision before still rings, the restitution is {low}.")
