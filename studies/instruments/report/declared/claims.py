"""The letter's other claims, and how far the six transitions hang on what is uncertain."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from studies.instruments.report.digits import fixed, percent, period, significant, words
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored
from studies.published import PERIODS

CLAIMS = {
    "a": "The hysteresis falls with rising energy loss per collision.",
    "b": "Secondary bifurcations lie above grazing in the map, and may lie below it in Eq. (1).",
    "c": "The transitions occur in bands; the hysteresis is zero at the upper edge and grows towards the "
    "lower.",
    "d": "The same structure is expected in a wide class of impacting systems.",
    "e": "The overdamped oscillator has an infinite series of period addings.",
}
PLACES = {
    "a": "text after Fig. 4",
    "b": "text after Fig. 4",
    "c": "text on Fig. 3",
    "d": "last paragraph",
    "e": "introduction",
}
ORDERS = {"a": 4.3, "b": 4.4, "c": 2.9, "d": 8.0, "e": 0.5}


def verdicts(summary: Mapping[str, Any]) -> Table:
    claims = summary["claims"]
    return Table(
        caption="Verdict on each claim.",
        columns=[
            Column(head="", values=[f"({key})" for key in claims], write=words, numeric=False),
            Column(head="claim", values=[CLAIMS.get(key, "") for key in claims], write=words, numeric=False),
            Column(
                head="holds", values=[claim["holds"] for claim in claims.values()], write=words, numeric=False
            ),
        ],
    )


def bands(summary: Mapping[str, Any]) -> Table:
    found = summary["claims"]["c"]["numbers"]["bands"]
    return Table(
        caption="Bands of the map, and the hysteresis 1 - F_m/F_g at their lower edge.",
        columns=[
            Column(head="orbit", values=[int(name[1:]) for name in found], write=period),
            Column(head="from (Hz)", values=[band["lower_hz"] for band in found.values()], write=fixed(3)),
            Column(head="to (Hz)", values=[band["upper_hz"] for band in found.values()], write=fixed(3)),
            Column(head="map", values=[band["map"] for band in found.values()], write=percent(3)),
            Column(head="Eq. (1)", values=[band["eq1"] for band in found.values()], write=percent(3)),
        ],
    )


def claimed(key: str) -> Callable[[Stored], Finding]:
    def find(stored: Stored) -> Finding:
        claim = stored.summary["claims"][key]
        if claim["holds"] is None:
            raise ValueError("the computation could not decide")
        verdict = AGREES if claim["holds"] else DIFFERS
        if key == "a" and claim["holds"] and not claim["numbers"]["falls"]["rho"]:
            verdict = IN_PART
        return Finding(verdict=verdict, why=claim["sentence"].rstrip("."))

    return find


OTHERS = Entry(
    study="claims",
    title="The letter's other claims",
    claim="Energy loss, secondary bifurcations, bands, universality and the overdamped case, each with the "
    "numbers that decide it.",
    captions={
        "a_hysteresis": "(a) Hysteresis against restitution at the six frequencies, in the map and in Eq. "
        "(1): it falls with the energy lost in both.",
        "b_secondary": "(b) Excess of the secondary bifurcation in Eq. (1) against restitution, and where it "
        "lies below grazing.",
        "c_bands": "(c) Bands of p_m in the plane of alpha and gamma with the path of the experiment, and "
        "the hysteresis along that path.",
        "d_universality": "(d) Period born at grazing for seven springs and contact laws; grey, the bands of "
        "the map. Near the upper edge of a band all agree with it.",
        "e_overdamped": "(e) The overdamped map: windows of periods that overlap, are parted by chaos, or "
        "are gone, as alpha grows.",
    },
    tables=lambda summary: [verdicts(summary), bands(summary)],
    points=[
        Point(
            order=ORDERS[key],
            where=PLACES[key],
            letter="no number",
            says=says,
            find=claimed(key),
        )
        for key, says in CLAIMS.items()
    ],
)


def noise(summary: Mapping[str, Any]) -> Table:
    rows = summary["noise"]
    return Table(
        caption="Strobe points of p_m in Eq. (1) near the upper edge of its band, with the amplitude noise "
        "of the letter: distance of the closest neighbours over the width of their clouds; below one they "
        "merge.",
        columns=[
            Column(head="orbit", values=[row["m"] for row in rows], write=period),
            Column(head="f (Hz)", values=[row["frequency_hz"] for row in rows], write=fixed(3)),
            Column(head="fold F_m/F_g - 1", values=[row["fold"] for row in rows], write=significant(3)),
            Column(head="jitter", values=[row["jitter"]["told_apart"] for row in rows], write=fixed(2)),
            Column(head="drift", values=[row["drift"]["told_apart"] for row in rows], write=fixed(2)),
        ],
    )


def at_the_limit(stored: Stored) -> Finding:
    merged = stored.summary["answers"]["first_period_with_merged_points"]
    highest, first = max(PERIODS.values()), merged["jitter"]
    close = first is not None and 0 <= first - highest <= 1
    return Finding(
        verdict=AGREES if close else IN_PART,
        single_mode=f"{period(first)} (jitter), {period(merged['drift'])} (drift)",
        why="first period whose closest strobe points merge in amplitude noise of the size of the letter's "
        "stability",
    )


SENSITIVITY = Entry(
    study="sensitivity",
    title="What the transitions owe to errors, noise and assumptions",
    claim="Each parameter is changed by the letter's error or within what it leaves open; the amplitude is "
    "made noisy by the letter's stability.",
    captions={
        "fold_against_parameter": "Factor on the hysteresis at each frequency after each change of one "
        "parameter.",
        "noise": "(a) Distance of neighbouring strobe points over the width of their clouds against the "
        "period; below one they merge. (b) Hysteresis and upper end of p_m beside the noise.",
        "strobe_points": "Strobe points of the beam in amplitude noise at three of the letter's frequencies, "
        "and the two clouds closest to each other.",
    },
    tables=lambda summary: [noise(summary)],
    findings=lambda summary: summary["answers"]["words"],
    points=[
        Point(
            order=2.8,
            where="text on Fig. 2",
            letter=period(max(PERIODS.values())),
            says="The highest observed period is at the limit of resolution and stability.",
            find=at_the_limit,
        ),
    ],
)
