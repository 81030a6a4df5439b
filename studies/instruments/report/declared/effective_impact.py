"""One collision as the single mode sees it: restitution, delay, kick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, percent, significant, words
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, NOT_PRINTED, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import RESTITUTION, TIME_TRACE_EXCESS

MILLI = 1e3
NEAR = 0.05
"""How far a restitution may be from "about 0.1"."""


def reference(summary: Mapping[str, Any]) -> Table:
    found, least = summary["answers"]["reference"], summary["answers"]["smallest_restitution"]
    fades = summary["answers"]["fade"]
    fade = fades.get("scene", fades["hertz"])
    rows = [
        ("excess of the collision", significant(3)(found["excess"])),
        ("restitution tau", significant(3)(found["restitution"])),
        ("smallest over the mass of ball and mount", significant(3)(least["restitution"])),
        ("kick on mode 1 over the approach speed", significant(4)(found["kick"])),
        ("delay (ms)", significant(3)(MILLI * found["delay_s"])),
        ("delay over the time v/a to the top of the arc", significant(3)(found["delay_over_arc"])),
        ("contact (ms)", significant(3)(MILLI * found["contact_s"])),
        ("excess at which half of the kick is left", significant(3)(fade["half_excess"])),
        ("kick left at the letter's amplitude stability", percent(3)(fade["share_at_resolution"])),
    ]
    return Table(
        caption="First collision of the beam above grazing, at the excess of the letter's Fig. 4.",
        columns=[
            Column(head="quantity", values=[name for name, _value in rows], write=words, numeric=False),
            Column(head="value", values=[value for _name, value in rows], write=str),
        ],
    )


def orbits(summary: Mapping[str, Any]) -> Table:
    found = summary["answers"]["local_loss"]["settled_orbits"]["orbits"]
    return Table(
        caption="On settled orbits, where the collision before still rings (0: mode 1 does not return to the "
        "gap).",
        columns=[
            Column(
                head="ball and mount / leaf", values=[o["mass_ratio"] for o in found], write=significant(3)
            ),
            Column(head="period", values=[o["orbit_period"] for o in found], write=fixed(0)),
            Column(head="approach (m/s)", values=[o["approach_velocity"] for o in found], write=fixed(3)),
            Column(head="kick", values=[o["kick"] for o in found], write=fixed(3)),
            Column(head="restitution tau", values=[o["restitution"] for o in found], write=fixed(3)),
        ],
    )


def restitution(stored: Stored) -> Finding:
    answers = stored.summary["answers"]
    first = answers["smallest_restitution"]["restitution"]
    settled = answers["local_loss"]["settled_orbits"]
    if first <= RESTITUTION + NEAR:
        verdict = AGREES
    else:
        verdict = IN_PART if settled["reached"] else DIFFERS
    values = [orbit["restitution"] for orbit in settled["orbits"] if orbit["restitution"] is not None]
    return Finding(
        verdict=verdict,
        beam=f"{significant(2)(first)} at least in a first collision; {significant(2)(min(values))} to "
        f"{significant(2)(max(values))} on settled orbits",
        why="the time that the contact takes sets a floor which loss in the contact does not lower; on "
        "settled orbits the ringing of the collision before moves the touch",
    )


def delay(stored: Stored) -> Finding:
    found = stored.summary["answers"]["reference"]
    return Finding(
        verdict=NOT_PRINTED,
        beam=f"{significant(3)(MILLI * found['delay_s'])} ms at excess {significant(2)(found['excess'])}",
        why=f"{found['delay_over_arc']:.2f} of the time v/a in which the tip would turn by itself",
    )


ENTRY = Entry(
    study="effective_impact",
    title="What a collision does to the single mode",
    claim="For the single mode of Eq. (1) a collision of the beam is an impact with a restitution, a delay "
    "and a kick, and all three depend on the approach speed and on what the letter leaves open.",
    captions={
        "speed": "Restitution, delay and kick against the excess above grazing. Kick and loss fade towards "
        "grazing, where the contact takes longer than the arc beyond the plate; shaded: below the letter's "
        "amplitude stability.",
        "mass": "The same against the mass of ball and mount. The restitution is smallest where the kick is "
        "near one; crosses: collisions on settled orbits.",
        "search": "In search of the letter's restitution: loss in the contact (a) moves the minimum but not "
        "its depth, hardness (b) lowers it.",
        "modes": "The same against the number of modes kept, and the impacts in the collision. Springs that "
        "carry a ball settle with some twenty modes; a bare tip needs more, and under Newton's law its "
        "impacts never settle.",
        "stiffness": "The same against the stiffness of the contact. The scene's restitution falls as the "
        "contact gets harder, that of a bare tip does not.",
        "damping": "The same against the damping of the higher modes, by three laws of damping.",
        "loss": "The same against the loss in the contact (1: none). With this ball more loss means a "
        "smaller kick, and the restitution rises.",
    },
    tables=lambda summary: [orbits(summary)],
    findings=lambda summary: summary["closing"],
    points=[
        Point(
            order=4.2,
            where="text after Fig. 3",
            letter=f"about {significant(1)(RESTITUTION)}",
            says="The restitution coefficient is estimated from the loss in a collision.",
            find=restitution,
        ),
        Point(
            order=6.1,
            where="text after Fig. 5",
            letter="no number",
            says="Higher modes introduce a time delay at impact (here at the excess of Fig. 4, "
            f"{TIME_TRACE_EXCESS}).",
            find=delay,
        ),
    ],
)
