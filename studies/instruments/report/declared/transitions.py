"""The main job: born periods and ends of the six orbits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from studies.instruments.report.digits import ABSENT, fixed, period, scaled
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import PERIODS

MODELS = ("map", "single_mode", "beam")
ABOVE = "0.01"
"""Excess, as the summary names it, at which the period is given once more."""


def row_at(summary: Mapping[str, Any], frequency: float) -> Mapping[str, Any]:
    (row,) = (row for row in summary["rows"] if abs(row["frequency_hz"] - frequency) < 1e-6)
    return row


def edge_words(frequency: float, m: int, stored: Stored) -> str:
    """Where the map has the edge between p_m and p_(m+1), and the free period that p_m would need."""
    free = stored.parameters()["single_mode.free_period_s"]
    edge = 2 * m / ((2 * m + 1) * free)
    needed = 2 * m / ((2 * m + 1) * frequency)
    return (
        f"the edge between p_{m} and p_{m + 1} lies at f T = {2 * m}/{2 * m + 1}, that is {edge:.3f} Hz; "
        f"p_{m} at grazing needs T below {1e3 * needed:.2f} ms instead of {1e3 * free:.2f} ms"
    )


def born_at(frequency: float) -> Callable[[Stored], Finding]:
    """The born period at one of the letter's frequencies, beside the letter's."""

    def find(stored: Stored) -> Finding:
        row, letter = row_at(stored.summary, frequency), PERIODS[frequency]
        born = [row[name] for name in MODELS]
        above = [row[f"born_{name}"].get(ABOVE) for name in MODELS]
        why = ""
        if all(value == letter for value in born):
            verdict = AGREES
        elif letter in born or letter in above:
            verdict = IN_PART
            seen = [
                name
                for name, value in zip(("the map", "Eq. (1)", "the beam"), above, strict=True)
                if value == letter
            ]
            if seen:
                why = f"p_{letter} is what {' and '.join(seen)} settle on further up, at excess {ABOVE}; "
        else:
            verdict = DIFFERS
        if letter + 1 in born:
            why += edge_words(frequency, letter, stored)
        cells = dict(zip(MODELS, map(period, born), strict=True))
        return Finding(verdict=verdict, why=why, **cells)

    return find


def tables(summary: Mapping[str, Any]) -> list[Table]:
    rows = summary["rows"]

    def column(head: str, key: str, write: Callable[[Any], str]) -> Column:
        return Column(head=head, values=[row[key] for row in rows], write=write)

    ends, way = scaled(1e4, 4), (lambda kind: kind or ABSENT)
    return [
        Table(
            caption="Period of the settled orbit just above grazing, and F_m/F_g - 1 at which it ends when "
            "the amplitude is lowered, by a fold, a period doubling or the grazing of another touch.",
            columns=[
                column("f (Hz)", "frequency_hz", fixed(2)),
                column("letter", "letter", period),
                column("map", "map", period),
                column("Eq. (1)", "single_mode", period),
                column("beam", "beam", period),
                column("end: map (10^-4)", "excess_down_map", ends),
                column("by", "ends_by_map", way),
                column("Eq. (1) (10^-4)", "excess_down_single_mode", ends),
                column("by", "ends_by_single_mode", way),
                column("beam (10^-4)", "excess_down_beam", ends),
                column("by", "ends_by_beam", way),
            ],
        )
    ]


def findings(summary: Mapping[str, Any]) -> list[str]:
    return [line for line in summary["closing"] if not line.startswith("figure:")]


DOTS = (
    "against the drive amplitude at the six frequencies: filled, amplitude raised; open, lowered; dashed, "
    "grazing."
)

ENTRY = Entry(
    study="transitions",
    title="The six transitions",
    claim="When the drive amplitude passes grazing, the motion without impacts gives way to an orbit of "
    "period m with one impact; when the amplitude is lowered again, that orbit lives on until some way below "
    "grazing.",
    captions={
        "orbit_diagram": f"Beam. Strobed displacement at the read-out point {DOTS} The upward scan leaves "
        "the motion without impacts at grazing, the downward scan keeps the m points until below it: the "
        "hysteresis of the letter's Fig. 2. A grey line marks an amplitude at which the motion did not "
        "settle; its points are not drawn.",
        "orbit_diagram_single_mode": f"Eq. (1). Strobed displacement {DOTS} The same transitions with one "
        "mode.",
        "orbit_diagram_map": f"Nordmark map. Its x {DOTS} Periods and band edges come out as in the other "
        "two; the square root makes every branch leave steeply.",
    },
    tables=tables,
    findings=findings,
    points=[
        Point(
            order=2 + 0.1 * number,
            where=f"Fig. 2({'abcdef'[number]})",
            says=f"At {frequency:.2f} Hz p_1 goes over into p_{m}.",
            letter=period(m),
            find=born_at(frequency),
        )
        for number, (frequency, m) in enumerate(sorted(PERIODS.items()))
    ],
)
