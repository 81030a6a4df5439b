"""Where the orbits end on the way down, in nine descriptions, and the causes of their differences."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, period, scaled, significant, words
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import PERIODS

CHAIN = {
    "map": "Nordmark map",
    "map_measured_kick": "map, measured kick for 1 + tau",
    "single_mode": "Eq. (1)",
    "measured_kick": "Eq. (1), kick of the beam",
    "kick_of_velocity": "and its change with velocity",
    "two_parameters": "one mode, measured loss and delay",
    "all_mode_kick": "kick of all modes",
}
NEARLY = 1.1
"""A factor up to this counts as none, and a description that is off by no more as enough."""


def causes(summary: Mapping[str, Any]) -> Table:
    """Factor of each cause at the letter's frequencies; the product leads from the map to the beam."""
    at = summary["causes"]["at_the_letter"]
    all_names = list(summary["causes"]["over_all"])
    complete = {
        frequency: entry
        for frequency, entry in at.items()
        if all(entry.get(name) is not None for name in all_names)
    }
    columns = [Column(head="factor on the hysteresis", values=all_names, write=words, numeric=False)]
    for frequency, entry in complete.items():
        m = PERIODS.get(float(frequency))
        name = f"{frequency} Hz" + (f", p_{m}" if m else "")
        values = [math.exp(entry[cause]) for cause in all_names]
        columns.append(Column(head=name, values=values, write=fixed(2)))
    medians = [summary["causes"]["over_all"][name]["factor"] for name in all_names]
    columns.append(Column(head="median of all folds", values=medians, write=fixed(2)))
    return Table(
        caption="Causes of the difference between the map's hysteresis and the beam's: each row is one step "
        "from the map to the beam, and a column multiplies to their ratio.",
        columns=columns,
    )


def offs(summary: Mapping[str, Any]) -> Table:
    """How far each description is from the beam."""
    factors = summary["factors"]
    names = [name for name in CHAIN if name in factors]

    def column(head: str, key: str, digits: int) -> Column:
        return Column(head=head, values=[factors[name][key] for name in names], write=significant(digits))

    return Table(
        caption="Factor by which the hysteresis of a description differs from that of the beam, up or down.",
        columns=[
            Column(head="description", values=[CHAIN[name] for name in names], write=words, numeric=False),
            column("median", "median", 4),
            column("nine of ten within", "nine_tenths", 4),
            column("worst", "worst", 3),
            column("folds", "count", 2),
        ],
    )


def tables(summary: Mapping[str, Any]) -> list[Table]:
    letter = [row for row in summary["rows"] if PERIODS.get(row["frequency_hz"]) == row["m"]]
    names = ("map", "single_mode", "two_parameters", "all_mode_kick", "beam")
    heads = ("map", "Eq. (1)", "one mode, loss and delay", "kick of all modes", "beam")
    folds = Table(
        caption="Fold F_m/F_g - 1 of the orbits that the letter saw (10^-4).",
        columns=[
            Column(head="f (Hz)", values=[row["frequency_hz"] for row in letter], write=fixed(2)),
            Column(head="orbit", values=[row["m"] for row in letter], write=period),
            *(
                Column(head=head, values=[row[name] for row in letter], write=scaled(1e4, 2))
                for name, head in zip(names, heads, strict=True)
            ),
        ],
    )
    return [folds, offs(summary)]


def differs_from_map(stored: Stored) -> Finding:
    factors, over = stored.summary["factors"], stored.summary["causes"]["over_all"]
    truncation = over["truncation of the map"]["factor"]
    off = {name: f"off by {significant(3)(factors[name]['median'])}" for name in ("map", "single_mode")}
    own = max(truncation, 1.0 / truncation) > NEARLY
    return Finding(
        verdict=IN_PART if own else AGREES,
        **off,
        beam="reference",
        why="the letter prints curves, no values. The beam differs from the map as the experiment did; "
        + (
            f"but a factor of {truncation:.2f} (median) is the map's own truncation, with no higher mode in "
            "it"
            if own
            else "what the map itself leaves out is no cause"
        ),
    )


def two_parameters(stored: Stored) -> Finding:
    found = stored.summary["factors"]["two_parameters"]
    every = stored.summary["factors"]["all_mode_kick"]
    enough = found["worst"] <= NEARLY
    return Finding(
        verdict=AGREES if enough else IN_PART if found["median"] <= 2.0 * NEARLY else DIFFERS,
        single_mode=f"off by {significant(3)(found['median'])}, worst {significant(3)(found['worst'])}",
        beam=f"kick of all modes {significant(4)(every['median'])}, worst {significant(3)(every['worst'])}",
        why="they carry the higher modes as far as these have died out when the tip comes back; what is "
        "missing is the ringing that the next collision meets",
    )


def coexistence(stored: Stored) -> Finding:
    rows = [row for row in stored.summary["rows"] if row["m"] - 1 in row["coexisting"]]
    found = ", ".join(f"p_{row['m']} at {row['frequency_hz']:.2f} Hz" for row in rows[:4])
    return Finding(
        verdict=AGREES if rows else DIFFERS,
        beam=f"{len(rows)} {'fold' if len(rows) == 1 else 'folds'}",
        why=f"{found}{' and others' if len(rows) > 4 else ''}, beside p_m of one less"
        if rows
        else "none found",
    )


ENTRY = Entry(
    study="hysteresis",
    title="Why the measured hysteresis differs from the map's",
    claim="The resonances are where the map has them, the hysteresis is not. Followed through descriptions "
    "that differ in one thing each, the difference is a product of causes of opposite sign.",
    captions={
        "hysteresis": "The letter's Fig. 3, computed: where the p_m orbits end when the amplitude is "
        "lowered, against the drive frequency, for m = 3 to 10; below the same on a logarithmic scale. The "
        "beam follows the bands of the map, at another size and bent by the ringing of its second mode.",
        "hysteresis_causes": "Factor of each cause at the letter's frequencies; above one it enlarges the "
        "hysteresis. Truncation of the map and size of the kick oppose each other everywhere; delay and "
        "ringing decide where the hysteresis is small.",
        "hysteresis_ratio": "Hysteresis of each description over that of the beam. Only the kick of all "
        "modes stays at one throughout.",
    },
    tables=tables,
    findings=lambda summary: list(summary["answers"].values()),
    points=[
        Point(
            order=3.0,
            where="Fig. 3",
            letter="curves only",
            says="The measured hysteresis differs from the map's, because of higher modes.",
            find=differs_from_map,
        ),
        Point(
            order=3.1,
            where="Fig. 3",
            letter="a few cases",
            says="p_m orbits continue to exist in the region of one period less.",
            find=coexistence,
        ),
        Point(
            order=9.0,
            where="last paragraph",
            letter="no number",
            says="Energy loss and time delay represent the higher modes in a single-mode description.",
            find=two_parameters,
        ),
    ],
)
