"""The period-4 orbit of Fig. 4: its trace, one collision, its spectrum; and the same in motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, period, significant
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import RESTITUTION, TIME_TRACE_EXCESS

MILLI, MICRO = 1e3, 1e6
NEAR = 0.05
"""How far a restitution may be from "about 0.1"."""


def collisions(summary: Mapping[str, Any]) -> Table:
    found = summary["collisions"]
    return Table(
        caption=f"Collisions of the settled orbit at {summary['frequency_hz']:.2f} Hz, excess "
        f"{summary['excess']:g}, in two of its periods.",
        columns=[
            Column(head="approach (m/s)", values=[c["approach_velocity"] for c in found], write=fixed(3)),
            Column(head="restitution tau", values=[c["restitution"] for c in found], write=fixed(3)),
            Column(
                head="delay (ms)",
                values=[None if c["delay_s"] is None else MILLI * c["delay_s"] for c in found],
                write=fixed(3),
            ),
            Column(head="kick", values=[c["kick"] for c in found], write=fixed(3)),
            Column(head="impacts", values=[c["impacts"] for c in found], write=fixed(0)),
            Column(head="contact (us)", values=[MICRO * c["contact_s"] for c in found], write=fixed(1)),
            Column(
                head="ringing left before (um)",
                values=[MICRO * c["ringing_m"] for c in found],
                write=fixed(1),
            ),
        ],
    )


def peaks(summary: Mapping[str, Any]) -> Table:
    found = [peak for peak in summary["peaks"] if peak["mode"] != 1]
    unit, factor = ("um", MICRO) if summary["peak_unit"] == "m" else (summary["peak_unit"], 1.0)
    return Table(
        caption="Higher modes with a peak of their own in the spectrum of the read-out.",
        columns=[
            Column(head="mode", values=[peak["mode"] for peak in found], write=fixed(0)),
            Column(
                head="mode lies at (Hz)",
                values=[summary["modes_hz"][peak["mode"] - 1] for peak in found],
                write=fixed(1),
            ),
            Column(head="peak (Hz)", values=[peak["frequency_hz"] for peak in found], write=fixed(1)),
            Column(
                head=f"amplitude ({unit})",
                values=[factor * peak["amplitude_m"] for peak in found],
                write=significant(3),
            ),
        ],
    )


def period_four(stored: Stored) -> Finding:
    summary = stored.summary
    same = summary["period"] == summary["letter"]
    return Finding(verdict=AGREES if same else DIFFERS, beam=period(summary["period"]))


def many_modes(stored: Stored) -> Finding:
    found = {peak["mode"] for peak in stored.summary["peaks"]} - {1}
    return Finding(
        verdict=AGREES if len(found) > 2 else IN_PART if found else DIFFERS,
        beam=f"{len(found)} modes",
        why="higher modes with a peak of their own in the spectrum",
    )


def restitution(stored: Stored) -> Finding:
    values = [c["restitution"] for c in stored.summary["collisions"] if c["restitution"] is not None]
    near = all(abs(value - RESTITUTION) <= NEAR for value in values)
    return Finding(
        verdict=AGREES if near else DIFFERS,
        beam=", ".join(sorted({fixed(3)(value) for value in values})),
        why="in the collisions of this orbit; others have other values",
    )


TRACE = Entry(
    study="time_trace",
    title="A period-4 orbit and its collision",
    claim="At excess 0.013 the orbit has period 4, and each impact excites a multitude of higher modes.",
    captions={
        "time_trace": "Two periods of the settled orbit: tip and read-out point, impacts marked; at the "
        "right one collision from close by, with its contact force. The kinks of the read-out after an "
        "impact are the higher modes of the letter's Fig. 4.",
        "spectrum": "Spectrum of the read-out over one period of the orbit. Higher modes stand out as peaks "
        "near their own frequencies.",
    },
    tables=lambda summary: [collisions(summary), peaks(summary)],
    points=[
        Point(
            order=4.0,
            where="Fig. 4",
            letter=period(4),
            says=f"Period of the orbit at excess {TIME_TRACE_EXCESS:g}.",
            find=period_four,
        ),
        Point(
            order=4.1,
            where="Fig. 4",
            letter="a multitude",
            says="Higher modes excited at impact.",
            find=many_modes,
        ),
        Point(
            order=4.15,
            where="text after Fig. 3",
            letter=f"about {significant(1)(RESTITUTION)}",
            says="Restitution, on the orbit of Fig. 4.",
            find=restitution,
        ),
    ],
)

MOTION = Entry(
    study="motion",
    title="The spring in motion",
    claim="At impact a multitude of higher modes is excited, and still the motion repeats after its period.",
    captions={
        "motion.gif": "One period of the orbit, slowed where the ball meets the plate; what departs from the "
        "shape of mode 1 is enlarged. Each frame says by how much.",
        "motion": "Stills of the same film.",
    },
    findings=lambda summary: [line for line in summary["closing"] if not line.startswith("ParaView")],
)

TOUR = Entry(
    study="tour",
    title="From a strip to an orbit, in one script",
    claim="The orbit of the letter's Fig. 4, built step by step from strip, modes, contact and drive.",
    captions={"tour": "The settled motion of the tip and what the script draws of it."},
)
