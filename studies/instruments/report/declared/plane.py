"""The plane of frequency and amplitude, and what the spring settles on along one line of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, period, significant, span, trimmed, words
from studies.instruments.report.entry import AGREES, DIFFERS, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored

MOST = 10
"""Periods in the table of cells; the others are added up."""

MODELS = {"single_mode": "Eq. (1)", "beam": "beam"}


def cells(summary: Mapping[str, Any]) -> Table:
    up, down = summary["counts"]["up"], summary["counts"]["down"]
    periods = sorted({*up, *down}, key=int)
    shown = [name for name in periods if int(name) <= MOST]
    names = ["no period" if name == "0" else f"p_{name}" for name in shown] + ["longer periods"]
    columns = [Column(head="cells with", values=names, write=words, numeric=False)]
    for head, counts in (("upward scan", up), ("downward scan", down)):
        longer = sum(count for name, count in counts.items() if name not in shown)
        values = [counts.get(name, 0) for name in shown] + [longer]
        columns.append(Column(head=head, values=values, write=fixed(0)))
    return Table(
        caption=f"Cells of a grid of {summary['points'][0]} frequencies by {summary['points'][1]} "
        "amplitudes.",
        columns=columns,
    )


CHART = Entry(
    study="chart",
    title="The plane of frequency and amplitude",
    claim="Below grazing an orbit p_m coexists with the motion without impacts down to its fold; at grazing "
    "the period follows the bands of the map; above it periods double, and chaos lies between.",
    captions={
        name: "Period and impacts of the settled orbit over drive frequency and excess, amplitude raised and "
        "lowered, with the band edges of the map and the exact folds. The tongues below grazing in the "
        "downward scan end on the folds."
        for name in ("chart", "chart_single_mode", "chart_beam")
    },
    tables=lambda summary: [cells(summary)],
    findings=lambda summary: [line for line in summary["closing"] if not line.startswith("figure:")],
)


def kinds(summary: Mapping[str, Any]) -> Table:
    rows = summary["rows"]
    models = [name for name in MODELS if any(row["model"] == name for row in rows)]
    found = {name: Counter(row["kind"] for row in rows if row["model"] == name) for name in models}
    names = sorted({kind for counts in found.values() for kind in counts})
    return Table(
        caption=f"Settled motions at {summary['frequency_hz']:.2f} Hz, upward and downward scan together.",
        columns=[
            Column(head="kind", values=names, write=words, numeric=False),
            *(
                Column(head=MODELS[name], values=[found[name][kind] for kind in names], write=fixed(0))
                for name in models
            ),
        ],
    )


def basins(summary: Mapping[str, Any]) -> Table:
    found = summary["basins"]
    return Table(
        caption=f"Eq. (1) at excess {found['excess']:g}: part of the starts on the strobe plane that lead to "
        "each motion.",
        columns=[
            Column(head="leads to", values=list(found["parts"]), write=words, numeric=False),
            Column(head="whole plane", values=list(found["parts"].values()), write=significant(3)),
            Column(
                head="around p_1",
                values=[found["parts_close"][name] for name in found["parts"]],
                write=significant(3),
            ),
        ],
    )


def chaotic(stored: Stored) -> Finding:
    found = stored.summary["chaotic"]
    cells = {
        name: f"excess {span(min(values), max(values), trimmed(3))}" if values else "none"
        for name, values in found.items()
        if name in MODELS
    }
    return Finding(
        verdict=AGREES if any(found.values()) else DIFFERS,
        **cells,
        why=f"excess with a positive Lyapunov exponent at {stored.summary['frequency_hz']:.2f} Hz",
    )


def coexist(stored: Stored) -> Finding:
    found = stored.summary["basins"]
    parts = {**found["parts"], **found.get("parts_close", {})}
    name = f"p{found['period']}"
    both = found["parts"].get(name, 0.0) > 0.0 and any(
        value > 0.0 for key, value in parts.items() if key.startswith("p1")
    )
    return Finding(
        verdict=AGREES if both else DIFFERS,
        single_mode=f"{period(1)} and {period(found['period'])}",
        why=f"at excess {found['excess']:g} the start decides which of them is reached",
    )


ATTRACTORS = Entry(
    study="attractors",
    title="What the spring settles on",
    claim="Besides the p_m orbits other motions occur, some of them chaotic; and below grazing p_m and the "
    "motion without impacts coexist.",
    captions={
        "attractors": "Strobe points and largest Lyapunov exponent against the excess, for Eq. (1) and the "
        "beam; filled, amplitude raised; open, lowered.",
        "basins": "Where starts on the strobe plane of Eq. (1) lead below grazing: the motion without "
        "impacts has a small basin, p_m the rest.",
    },
    tables=lambda summary: [kinds(summary), basins(summary)],
    findings=lambda summary: summary["closing"],
    points=[
        Point(
            order=2.7,
            where="text on Fig. 2",
            letter="hysteretic",
            says="Below grazing the motion without impacts and p_m coexist.",
            find=coexist,
        ),
        Point(
            order=4.5,
            where="text after Fig. 4",
            letter="no number",
            says="Other transitions occur; these may even be to chaotic states.",
            find=chaotic,
        ),
    ],
)
