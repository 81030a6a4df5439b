"""The costs in one table, as the README has it: a row a case, in Markdown.

Times of Eq. (1) are medians over the letter's frequencies; "floor" is the arithmetic of carrying the modes
through a period without a touch.  What was not run is a dash.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

__all__ = ["HEADING", "cost_table"]

HEADING = "| case | modes | per drive period | per collision | floor | heyoka | its error |"
RULE = "|---|---|---|---|---|---|---|"

SHOWN = (
    ("single mode", "Eq. (1), hard wall, excess 0.02", (1,)),
    ("batch on two cores", "the same, 32 orbits on two cores", (1,)),
    ("beam, hertz contact", "beam, p4 at 0.013, Hertz contact", (8, 20, 40)),
    ("beam, linear contact", "the same, linear contact", (8, 20, 40)),
    ("beam, hertz contact, no touch", "the same without a touch, at -0.02", (8, 20, 40)),
)
"""Case, its words, numbers of modes."""


UNITS = ((1e6, "s"), (1e3, "ms"), (1.0, "us"), (1e-3, "ns"))
"""In microseconds."""


def seconds_told(microseconds: float | None) -> str:
    """Two digits with the unit in which they read well."""
    if microseconds is None:
        return "-"
    size, unit = next((pair for pair in UNITS if microseconds >= pair[0]), UNITS[-1])
    return f"{float(f'{microseconds / size:.2g}'):g} {unit}"


def cost_table(rows: Sequence[Mapping[str, Any]], excess: float, peer_tolerance: float) -> list[str]:
    """The lines of the table; of the beam's rows those at `excess`, and of heyoka those at its tolerance."""

    def found(case: str, tool: str, modes: int) -> list[Mapping[str, Any]]:
        return [
            row
            for row in rows
            if (row["case"], row["tool"], row["modes"]) == (case, tool, modes)
            and (not case.startswith("beam") or case.endswith("no touch") or row["excess"] == excess)
            and (tool != "heyoka" or not case.startswith("beam") or row["tolerance"] == peer_tolerance)
        ]

    def middle(entries: Sequence[Mapping[str, Any]], key: str) -> float | None:
        values = [row[key] for row in entries if row.get(key) is not None]
        return median(values) if values else None

    lines = [HEADING, RULE]
    for case, words, ladder in SHOWN:
        for modes in ladder:
            ours, theirs = found(case, "grazing-spring", modes), found(case, "heyoka", modes)
            if not ours:
                continue
            bottom = found(case.removesuffix(", no touch"), "floor", modes)
            error = middle(theirs, "error")
            cells = (
                words, str(modes), seconds_told(middle(ours, "us_per_period")),
                seconds_told(middle(ours, "us_per_collision")), seconds_told(middle(bottom, "us_per_period")),
                seconds_told(middle(theirs, "us_per_period")), "-" if error is None else f"{error:.0e}",
            )  # fmt: skip
            lines.append("| " + " | ".join(cells) + " |")
    return lines
