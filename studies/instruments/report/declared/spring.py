"""The spring: its modes, what its shape can mean, and the keys that were fitted to the letter's numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from studies.instruments.report.digits import fixed, percent, significant, words
from studies.instruments.report.entry import AGREES, DIFFERS, FITTED, IN_PART, Entry, Finding, Point
from studies.instruments.report.markup import Column, Table, code
from studies.instruments.report.stored import Stored
from studies.published import DRIVE_AMPLITUDE_M, FREE_PERIOD_ERROR_S, FREE_PERIOD_S

MILLI = 1e3
SHOWN = 12
"""Modes in the table; all of them are in modes.csv."""

SHAPES = {
    "folded": "strip folded into a U",
    "side_by_side": "legs side by side",
    "channel": "channel",
    "plain": "plain strip",
}


def modes_table(summary: Mapping[str, Any]) -> Table:
    frequencies = summary["frequencies_hz"][:SHOWN]
    rates = summary["decay_rates"][:SHOWN]
    ratios = [
        rate / (4.0 * math.pi * f) if f and rate is not None else None
        for rate, f in zip(rates, frequencies, strict=True)
    ]
    return Table(
        caption=f"The lowest {len(frequencies)} of {len(summary['frequencies_hz'])} modes; impacts see those "
        "with a tip value.",
        columns=[
            Column(head="mode", values=list(range(1, len(frequencies) + 1)), write=fixed(0)),
            Column(head="f (Hz)", values=frequencies, write=fixed(2)),
            Column(head="decay rate (1/s)", values=rates, write=fixed(2)),
            Column(head="damping ratio", values=ratios, write=percent(3)),
            Column(head="tip value (kg^-1/2)", values=summary["tip_values"][:SHOWN], write=fixed(3)),
            Column(head="participation (kg^1/2)", values=summary["participation"][:SHOWN], write=fixed(4)),
            Column(
                head="meets the plate",
                values=summary["coupled"][:SHOWN],
                write=words,
                numeric=False,
            ),
        ],
    )


def free_period(stored: Stored) -> Finding:
    omega = 2.0 * math.pi * stored.summary["frequencies_hz"][0]
    found = 2.0 * math.pi / math.sqrt(omega**2 - (stored.summary["decay_rates"][0] / 2.0) ** 2)
    taken = stored.parameters()["single_mode.free_period_s"]
    within = abs(found - FREE_PERIOD_S) <= FREE_PERIOD_ERROR_S
    fitted = stored.provenance().get("spring.thickness_m") == "calibrated"
    why = "the thickness of the sheet was fitted to it" if fitted else ""
    if not within:
        why = "the stored modes are those of another spring, or of a coarse mesh"
    return Finding(
        verdict=(FITTED if fitted else AGREES) if within else DIFFERS,
        single_mode=f"{fixed(2)(MILLI * taken)} ms",
        beam=f"{fixed(2)(MILLI * found)} ms",
        why=why,
    )


MODES = Entry(
    study="modes",
    title="Modes of the spring",
    claim="The folded strip has two kinds of modes: sway modes move the ball towards the plate, breathing "
    "modes leave it on its line and take no part in the impacts.",
    captions={
        "modes": "The first modes in the plane of the strip: grey, at rest; solid and dashed, half a period "
        "apart, enlarged. Blue modes move the ball towards the plate, orange ones do not.",
        "modes_3d": "The same modes in space: brass strip, damping tape, ceramic ball.",
        "mode_*.gif": "One period of each of the first modes, enlarged.",
    },
    tables=lambda summary: [modes_table(summary)],
    points=[
        Point(
            order=1.9,
            where="Fig. 2",
            letter=f"{fixed(2)(MILLI * FREE_PERIOD_S)} ± {fixed(2)(MILLI * FREE_PERIOD_ERROR_S)} ms",
            says="Period T of the freely swinging beam.",
            find=free_period,
        ),
    ],
)


def readings(summary: Mapping[str, Any]) -> Table:
    rows = summary["readings"]

    def column(head: str, key: str, places: int, factor: float = 1.0) -> Column:
        values = [None if row[key] is None else factor * row[key] for row in rows]
        return Column(head=head, values=values, write=fixed(places))

    return Table(
        caption="Springs of one free period.",
        columns=[
            Column(
                head="reading",
                values=[SHAPES.get(row["reading"], row["reading"]) for row in rows],
                write=words,
                numeric=False,
            ),
            column("sheet (mm)", "thickness_m", 2, MILLI),
            column("first bending (Hz)", "first_bending_hz", 2),
            column("first twist (Hz)", "first_twist_hz", 1),
            column("twist over bending", "ratio_twist", 1),
        ],
    )


def torsion(stored: Stored) -> Finding:
    rows = {row["reading"]: row for row in stored.summary["readings"]}
    ratios = {name: row["ratio_twist"] for name, row in rows.items() if row["ratio_twist"] is not None}
    bent = {name: ratio for name, ratio in ratios.items() if name != "plain"}
    highest = max(bent, key=lambda name: bent[name])
    plain = ratios.get("plain", 0.0)
    return Finding(
        verdict=IN_PART if plain > bent[highest] else AGREES,
        beam=f"{fixed(1)(bent[highest])} times the first bending",
        why=f"of the shapes that the words allow, the {SHAPES.get(highest, highest)} has its twist highest"
        + (
            f"; a plain strip of the same period has it at {plain:.1f} times" if plain > bent[highest] else ""
        ),
    )


SHAPE = Entry(
    study="spring_shape",
    title='What "U shaped" can mean',
    claim="Of the three shapes that the words allow, the strip folded into a U has its first twist mode "
    "highest above the first bending mode; that reading is the default here.",
    captions={
        "shapes": "First twist mode of four springs of one free period, enlarged; grey, at rest; the left "
        "ends are clamped.",
        "theory_error": "Error of strip theory in the frequencies, against solids.",
        "channels": "Channels of other sheets: flange that the free period needs, and where their lowest "
        "modes out of the plane lie.",
        "clamped_widths": "What a clamp adds to the bending stiffness of a strip, against its width over "
        "length.",
    },
    tables=lambda summary: [readings(summary)],
    points=[
        Point(
            order=1.0,
            where="Fig. 1 and text",
            letter="no number",
            says="The spring is U shaped to suppress torsional modes.",
            find=torsion,
        ),
    ],
)


def fitted_keys(summary: Mapping[str, Any]) -> Table:
    keys = summary["keys"]
    return Table(
        caption="Keys of the scene fitted to free period, decay rate, drive amplitude at grazing and "
        "restitution.",
        columns=[
            Column(head="key", values=list(keys), write=code, numeric=False),
            Column(head="value (SI)", values=list(keys.values()), write=significant(5)),
        ],
    )


def drive_amplitude(stored: Stored) -> Finding:
    gap = stored.summary["keys"]["stop.gap_m"]
    return Finding(
        verdict=FITTED,
        beam=f"gap {fixed(2)(MILLI * gap)} mm",
        why="the gap was fitted to it at 22.2 Hz; the letter prints no gap",
    )


CALIBRATION = Entry(
    study="calibrate",
    title="Four keys fitted to four numbers",
    claim="Thickness, loss of the tape, mass of ball and mount, and gap are not printed; each is fitted to "
    "one number that is.",
    tables=lambda summary: [fitted_keys(summary)],
    findings=lambda summary: [
        f"With them the collision at the excess of Fig. 4 has kick {summary['kick']:.4f}, restitution "
        f"{summary['restitution']:.4f}, delay {MILLI * summary['delay_s']:.4f} ms and "
        f"{1e6 * summary['contact_s']:.1f} us of contact."
    ],
    points=[
        Point(
            order=1.1,
            where="text after Fig. 1",
            letter=f"typically {fixed(0)(MILLI * DRIVE_AMPLITUDE_M)} mm",
            says="Amplitude of the excitation.",
            find=drive_amplitude,
        ),
    ],
)
