"""Walls of finite hardness and the Hertz contact: how the square root is smoothed."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from studies.instruments.report.digits import fixed, significant, words
from studies.instruments.report.entry import AGREES, DIFFERS, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table
from studies.instruments.report.stored import Stored

SMOOTH_FROM = 1e-9
"""An excess of a period doubling below this is that of a hard wall."""


def doublings(summary: Mapping[str, Any]) -> Table:
    rows = [row for row in summary["rows"] if row["case"] == "lossless"]

    def column(head: str, key: str, digits: int) -> Column:
        return Column(head=head, values=[row[key] for row in rows], write=significant(digits))

    return Table(
        caption="Eq. (1) with a wall of K times the spring constant, without loss: excess at which the p_1 "
        "orbit, which survives its first touch, doubles its period.",
        columns=[
            Column(head="f (Hz)", values=[row["frequency_hz"] for row in rows], write=fixed(2)),
            column("K", "K", 1),
            column("doubling, measured", "excess_pd_measured", 4),
            column("closed form", "excess_pd_theory", 4),
            column("limit of large K", "excess_pd_leading", 4),
        ],
    )


def smoothing(summary: Mapping[str, Any]) -> Table:
    beam = summary["beam"]
    rows = [
        ("drive frequency (Hz)", fixed(2)(beam["frequency_hz"])),
        ("p_1 with impacts lives up to an excess of", significant(3)(beam["doubling_excess"])),
        ("by the formula", significant(3)(beam["doubling_theory"])),
        ("half of the kick at an excess of", significant(3)(beam["half_excess"])),
        ("local power within 0.1 of one half from an excess of", significant(3)(beam["square_root_from"])),
        ("letter's amplitude stability", significant(2)(beam["resolution"])),
    ]
    return Table(
        caption="The beam with its Hertz contact, near grazing.",
        columns=[
            Column(head="quantity", values=[name for name, _value in rows], write=words, numeric=False),
            Column(head="value", values=[value for _name, value in rows], write=str),
        ],
    )


def not_seen(stored: Stored) -> Finding:
    beam = stored.summary["beam"]
    end, resolution = beam["doubling_excess"], beam["resolution"]
    unseen = end < resolution
    return Finding(
        verdict=(IN_PART if end > SMOOTH_FROM else AGREES) if unseen else DIFFERS,
        beam=f"period doubling at {significant(2)(end)}",
        why=f"the square root is smoothed, but its period doubling lies {resolution / end:.0f} times below "
        f"the amplitude stability of {resolution:.1e}: it could not be seen"
        if unseen
        else "the doubling lies above the amplitude stability",
    )


def extends(stored: Stored) -> Finding:
    by_frequency: dict[float, list[tuple[float, float]]] = {}
    for row in stored.summary["rows"]:
        if row["case"] == "lossless" and row["excess_pd_measured"]:
            by_frequency.setdefault(row["frequency_hz"], []).append((row["K"], row["excess_pd_measured"]))
    ordered = [[excess for _hardness, excess in sorted(pairs)] for pairs in by_frequency.values()]
    falls = all(a > b for values in ordered for a, b in pairwise(values))
    first = min(by_frequency)
    (soft, most), (hard, least) = min(by_frequency[first]), max(by_frequency[first])
    return Finding(
        verdict=AGREES if falls else DIFFERS,
        single_mode=f"{significant(2)(most)} at K = {significant(1)(soft)}, {significant(2)(least)} at K = "
        f"{significant(1)(hard)}",
        why=f"excess of the period doubling at {first:.2f} Hz",
    )


ENTRY = Entry(
    study="soft_wall",
    title="How the square root is smoothed",
    claim="A wall of finite hardness turns the square root into a power 3/2 near grazing, a Hertz contact "
    "into a square; the p_1 orbit then survives its first touch and doubles its period a little above it.",
    captions={
        "beam": "The beam near grazing: kick of one collision, its local power in the excess, and the period "
        "that is born, raised gently and in one step. The square root holds only well above the shaded "
        "range, in which the letter's drive was not stable.",
        "kick": "Eq. (1), kick of one collision against the excess for three hardnesses, without loss (a) "
        "and with a dashpot (b). All go over into the power 1/2 of the hard wall.",
        "doubling": "Excess of the period doubling against the hardness (a), and how far the two formulas "
        "are off (b).",
        "hysteresis": "Hysteresis against hardness: it nears that of the hard wall as K^(-1/2).",
    },
    tables=lambda summary: [doublings(summary)],
    findings=lambda summary: summary["answers"]["sentences"],
    points=[
        Point(
            order=7.0,
            where="last page",
            letter="larger as K decreases",
            says="A soft wall affects the bifurcations near grazing.",
            find=extends,
        ),
        Point(
            order=7.1,
            where="last page",
            letter="not observed",
            says="Higher modes do not effectively smooth the singularity: its secondary bifurcations were "
            "not seen.",
            find=not_seen,
        ),
    ],
)
