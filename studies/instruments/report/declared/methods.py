"""How the numbers were got: model, methods, their failures and their cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, percent, significant, span, words
from studies.instruments.report.entry import AGREES, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table, code, escaped, prose
from studies.instruments.report.stored import Stored

MOST = 14
"""Rows shown of a long table; its csv has the others."""

ERRORS = (1e-2, 1e-4, 1e-8)
"""Errors at which methods are compared."""

SAMPLED = "sampled flight"
"""The letter's own scheme."""


def least_models(summary: Mapping[str, Any]) -> Table:
    rows = summary["rows"]

    def column(head: str, key: str, digits: int) -> Column:
        return Column(head=head, values=[row[key] for row in rows], write=significant(digits))

    names = [row["quantity"].replace("_", " ") for row in rows]
    return Table(
        caption="The least model that answers each question.",
        columns=[
            Column(head="question", values=names, write=words, numeric=False),
            Column(head="f (Hz)", values=[row["frequency_hz"] for row in rows], write=fixed(2)),
            column("tolerance", "tolerance", 2),
            Column(head="least model", values=[row["words"] for row in rows], write=words, numeric=False),
            column("its error", "error_measured", 2),
            column("one step less", "error_one_less", 2),
        ],
    )


def choices(summary: Mapping[str, Any]) -> Table:
    chosen = summary["studies"]
    return Table(
        caption="What the other studies get for this scene.",
        columns=[
            Column(head="study", values=list(chosen), write=code, numeric=False),
            Column(
                head="model",
                values=[words.removeprefix("model: ") for words in chosen.values()],
                write=prose,
                numeric=False,
            ),
        ],
    )


ADEQUACY = Entry(
    study="adequacy",
    title="How much model each question needs",
    claim="The periods need one mode, the collision about ten, the hysteresis the whole ladder: folded "
    "spring, Hertz contact and the more modes.",
    captions={
        "ladder": "Error of every model tried against its predicted cost, one panel for each question; "
        "dashed, the tolerance; ringed, the model chosen.",
    },
    tables=lambda summary: [least_models(summary), choices(summary)],
)


def cheapest(rows: list[Mapping[str, Any]], method: str, bound: float) -> float | None:
    """Time per drive period at which the method stays within the error."""
    fit = [
        row["us_per_period"]
        for row in rows
        if row["method"] == method
        and row["error"] is not None
        and row["error"] <= bound
        and row["us_per_period"] is not None
    ]
    return min(fit, default=None)


def costs(summary: Mapping[str, Any], problem: str, name: str) -> Table:
    rows = [row for row in summary["rows"] if row["problem"] == problem]
    methods = list(dict.fromkeys(row["method"] for row in rows))
    missed = [
        [row["missed"] for row in rows if row["method"] == m and row["missed"] is not None] for m in methods
    ]
    return Table(
        caption=f"{name}: time per drive period (us) for an error of mode 1, and the part of planted shallow "
        "crossings that is missed, from the finest setting to the coarsest.",
        columns=[
            Column(head="method", values=methods, write=escaped, numeric=False),
            *(
                Column(
                    head=f"error {bound:.0e}",
                    values=[cheapest(rows, method, bound) for method in methods],
                    write=significant(2),
                )
                for bound in ERRORS
            ),
            Column(head="missed at best", values=[min(m, default=None) for m in missed], write=percent(2)),
            Column(head="at worst", values=[max(m, default=None) for m in missed], write=percent(2)),
        ],
    )


def work_tables(summary: Mapping[str, Any]) -> list[Table]:
    named = {"single mode": "Eq. (1) with the hard wall", "hertz": "Beam with Hertz contact"}
    there = {row["problem"] for row in summary["rows"]}
    return [costs(summary, problem, name) for problem, name in named.items() if problem in there]


def sampled(stored: Stored) -> Finding:
    rows = [
        row
        for row in stored.summary["rows"]
        if row["problem"] == "single mode" and row["method"] == SAMPLED and row["missed"] is not None
    ]
    most, best = max(row["missed"] for row in rows), min(row["missed"] for row in rows)
    return Finding(
        verdict=AGREES if most == 0.0 else IN_PART,
        single_mode=f"{span(best, most, percent(2))} missed",
        why=f"that scheme with {rows[0]['setting']} to {rows[-1]['setting']}, on planted shallow crossings; "
        "it proves nothing, the default here does",
    )


WORK = Entry(
    study="work_precision",
    title="Error against cost of every method",
    claim="On these problems no outside solver and no method with a time step is both faster and as accurate "
    "as the exact method that is the default.",
    captions={
        "work_precision": "Error of mode 1 past the first collision against time per drive period, four "
        "problems; grey, the front; black marks, the defaults.",
        "other_errors": "The same for impact time, restitution, kick, shift of a fold and missed crossings.",
        "model_error": "Error of too few modes beside that of a time step, and the cost of both.",
    },
    tables=work_tables,
    points=[
        Point(
            order=10.0,
            where="note [11]",
            letter="no number",
            says="Positions are computed at a few points per period; crossings must not be missed.",
            find=sampled,
        ),
    ],
)


def limits(summary: Mapping[str, Any]) -> Table:
    families: dict[str, list[Mapping[str, Any]]] = {}
    for row in summary["rows"]:
        families.setdefault(row["family"], []).append(row)

    def part(rows: list[Mapping[str, Any]]) -> float | None:
        off = [
            abs(row["limit_measured"] / row["limit_theory"] - 1.0)
            for row in rows
            if row["limit_theory"] and row["limit_measured"] is not None
        ]
        return sorted(off)[len(off) // 2] if off else None

    names = list(families)
    return Table(
        caption="Limits by family of failures.",
        columns=[
            Column(
                head="family", values=[name.replace("_", " ") for name in names], write=words, numeric=False
            ),
            Column(head="rows", values=[len(families[name]) for name in names], write=fixed(0)),
            Column(
                head="refused beforehand",
                values=[sum(row["refused"] is True for row in families[name]) for name in names],
                write=fixed(0),
            ),
            Column(
                head="measured off theory (median)",
                values=[part(families[name]) for name in names],
                write=significant(2),
            ),
        ],
    )


STABILITY = Entry(
    study="stability",
    title="Where methods fail",
    claim="Each method for impacts has its own way to fail; the limit that theory gives is set beside the "
    "one found, and whether it is refused before a number comes out.",
    captions={
        "explicit_limits": "Central difference: largest stable step of one mode (a), and of five modes "
        "pressed on the stop (b), theory and measurement.",
        "explicit_contact": "Central difference makes energy in short contacts within its limit of "
        "stability.",
        "splitting_planes": "Splitting methods: where the motion stays bounded, over contact stiffness and "
        "step.",
        "splitting_resonances": "Splitting of order 2 beyond h omega_N = pi: bands of step sizes in which "
        "the motion grows.",
        "implicit_plane": "Implicit methods: growth of energy per contact over stiffness and step. Without "
        "numerical dissipation a contact shorter than the step makes energy.",
        "implicit_single_contact": "Mean growth of energy in one contact of a free mass against the step; "
        "the trapezoidal rule reaches (5/2) ln 3 - 2.",
        "implicit_energy": "Energy over many contacts, linear stop and Newton's law.",
        "numerical_restitution": "Restitution, kick and energy lost that a time step pretends, by step size.",
        "missed_crossings": "Part of the planted crossings that is missed, against their depth.",
        "accumulation": "Impacts that accumulate: summed by the default, and where loops without a sum fail.",
        "newton_modes": "Newton's law has no limit as modes are added to a bare tip; a tip mass gives it "
        "one.",
        "stiff_contact": "A stiff contact: error, cost, and the limit of Newton's law.",
        "odd_modes": "Modes near critical damping and far over it: error of the closed form beside other "
        "ways.",
        "long_runs": "Phase and amplitude over long runs.",
        "moreau_jean_penetration": "How far the Moreau-Jean scheme lets the tip into the stop, by step size.",
    },
    tables=lambda summary: [limits(summary)],
)


def times(summary: Mapping[str, Any]) -> Table:
    rows = sorted(
        (row for row in summary["rows"] if row["us_per_period"] is not None),
        key=lambda row: row["us_per_period"],
    )[-MOST:]
    return Table(
        caption="Time per drive period, the longest rows.",
        columns=[
            Column(head="case", values=[row["case"] for row in rows], write=words, numeric=False),
            Column(head="tool", values=[row["tool"] for row in rows], write=words, numeric=False),
            Column(head="modes", values=[row["modes"] for row in rows], write=fixed(0)),
            Column(head="f (Hz)", values=[row["frequency_hz"] for row in rows], write=fixed(2)),
            Column(head="time (us)", values=[row["us_per_period"] for row in rows], write=significant(3)),
        ],
    )


BENCHMARKS = Entry(
    study="benchmarks",
    title="What a drive period costs",
    claim="With one mode and the hard wall a drive period takes some tens of nanoseconds, with many modes "
    "and a Hertz contact some microseconds, and no more than in proportion to the modes.",
    captions={
        "costs": "Time per drive period against the number of modes, with two contact laws, without a touch, "
        "and the arithmetic that none can avoid.",
    },
    tables=lambda summary: [times(summary)],
)
