"""The letter's Fig. 5: where the map has p3 and the spring does something else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import Writer, fixed, period, span, trimmed
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import BREAKDOWN

GRAM = 1e3
LAST = 0.05
"""Impacts may go on below p3 for this part of its excess and still end with it."""

MOST = 12
"""Beams of the search in the table; its csv has all."""


def searched(summary: Mapping[str, Any]) -> Table:
    every, letter = summary["born"], BREAKDOWN["born_period"]
    same = [cell for cell in every if cell["period"] == letter]
    cells = (same or every)[:MOST]

    def column(head: str, key: str, write: Writer, factor: float = 1.0) -> Column:
        return Column(head=head, values=[factor * cell[key] for cell in cells], write=write)

    return Table(
        caption=f"What the letter does not print: period {letter} is born in {len(same)} of {len(every)} "
        f"beams that were tried{f'; the first {MOST} of them' if len(same) > MOST else ''}.",
        columns=[
            column("ball and mount (g)", "tip_mass_kg", fixed(2), GRAM),
            column("damping of higher modes, times that of the strips", "higher_damping", fixed(2)),
            column("local restitution", "local_restitution", fixed(2)),
            Column(head="born", values=[cell["period"] for cell in cells], write=period),
            Column(head="its impacts", values=[cell["impacts"] for cell in cells], write=fixed(0)),
        ],
    )


def islands(summary: Mapping[str, Any]) -> Table:
    found = summary["single_mode"]["islands"]
    return Table(
        caption="Eq. (1): the island of p_3 and chaos below grazing, which is not connected to what is born "
        "there.",
        columns=[
            Column(head="restitution tau", values=[i["restitution"] for i in found], write=fixed(2)),
            Column(head="from excess", values=[i["fold_p3"] for i in found], write=fixed(4)),
            Column(head="to excess", values=[i["end"] for i in found], write=fixed(4)),
            Column(
                head=f"alive at {BREAKDOWN['chaos_at']}",
                values=[i["alive_at_letters_chaos"] for i in found],
                write=lambda alive: "yes" if alive else "no",
            ),
        ],
    )


def _born(of: Mapping[str, Any]) -> int:
    return int(of["born"]["period"])


def period_six(stored: Stored) -> Finding:
    summary, letter = stored.summary, BREAKDOWN["born_period"]
    calibrated, found = _born(summary["beam"]), summary.get("found")
    if calibrated == letter:
        verdict, why = AGREES, "with the calibrated ball"
    elif found and _born(found) == letter:
        verdict = IN_PART
        why = (
            f"the calibrated ball of {GRAM * summary['beam']['tip_mass_kg']:.2f} g does not; one of "
            f"{GRAM * found['tip_mass_kg']:.2f} g with {found['higher_damping']:g} times the damping of the "
            "higher modes does, and the letter prints neither"
        )
    else:
        verdict, why = DIFFERS, "no cell of the search has it"
    beam = f"{period(calibrated)} as calibrated"
    if found:
        beam += f", {period(_born(found))} found"
    return Finding(
        verdict=verdict,
        map=period(summary["map"]["period"]),
        single_mode=period(_born(summary["single_mode"])),
        beam=beam,
        why=why,
    )


def _at_its_end(of: Mapping[str, Any]) -> bool:
    """Whether p3 is met in the downward scan, and met last."""
    stretch, end = of["p3_in_downward_scan"], of["impacts_end"]
    return bool(stretch) and end is not None and abs(end - stretch[1]) <= LAST * abs(stretch[1])


def very_end(stored: Stored) -> Finding:
    calibrated, found = stored.summary["beam"], stored.summary.get("found")
    if _at_its_end(calibrated):
        verdict, of, why = AGREES, calibrated, "with the calibrated ball"
    elif found and _at_its_end(found):
        verdict, of = IN_PART, found
        why = (
            f"so in the beam that has period 6 ({GRAM * found['tip_mass_kg']:.2f} g); with the calibrated "
            "ball the downward scan does not end in p_3"
        )
    else:
        return Finding(verdict=DIFFERS, why="no downward scan ends in p_3")
    first, last = of["p3_in_downward_scan"]
    return Finding(verdict=verdict, beam=span(first, last, fixed(4)), why=why)


def island(stored: Stored) -> Finding:
    found = stored.summary["single_mode"]["islands"]
    alive = [entry for entry in found if entry["alive_at_letters_chaos"]]
    printed = [entry for entry in found if abs(entry["restitution"] - 0.1) < 1e-9]
    ends = "; ".join(
        f"{fixed(3)(i['fold_p3'])} to {fixed(3)(i['end'])} at τ = {trimmed(2)(i['restitution'])}"
        for i in found
    )
    if printed and printed[0]["alive_at_letters_chaos"]:
        verdict = AGREES
    else:
        verdict = IN_PART if alive else DIFFERS
    most = max((entry["restitution"] for entry in alive), default=None)
    return Finding(
        verdict=verdict,
        single_mode=ends,
        why=(
            f"the island is there; at the quoted place it needs tau of {most:g} or less"
            if most is not None
            else "no island reaches the quoted place"
        )
        + ", read as an excess",
    )


ENTRY = Entry(
    study="breakdown",
    title="Where the map fails: Fig. 5",
    claim="At 19.65 Hz the map has a stable p_3. The experiment saw period 6 born at grazing, and p_3 only "
    "at the very end of the downward scan.",
    captions={
        "breakdown": "Orbit diagrams at the frequency of Fig. 5: (a) Eq. (1), with the island of p_3 and "
        "chaos in grey; (b) the beam as calibrated; (c) the beam found in the search. Filled, amplitude "
        "raised; open, lowered; at the right, finer steps above grazing.",
        "born_period": "Period born at grazing over the mass of ball and mount and the damping of the higher "
        "modes.",
    },
    tables=lambda summary: [searched(summary), islands(summary)],
    findings=lambda summary: summary["closing"],
    points=[
        Point(
            order=5.0,
            where="Fig. 5",
            letter=period(BREAKDOWN["born_period"]),
            says="At grazing the motion without impacts gives way to period 6, where the map has p_3.",
            find=period_six,
        ),
        Point(
            order=5.1,
            where="Fig. 5",
            letter="at its very end",
            says="p_3 is found only at the very end of the downward scan.",
            find=very_end,
        ),
        Point(
            order=5.2,
            where="text on Fig. 5",
            letter=fixed(4)(BREAKDOWN["chaos_at"]),
            says="Eq. (1) has a chaotic state there that is not connected to the one born at grazing.",
            find=island,
        ),
    ],
)
