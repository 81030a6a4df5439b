"""Tables and sentences about the readings of "U shaped"."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from studies.instruments.spring_shape.readings import TITLES

U_SHAPES = ("side_by_side", "channel", "folded")


def verdict_of(
    rows: Mapping[str, Mapping[str, Any]],
    variations: Sequence[Mapping[str, Any]],
    channels: Sequence[Mapping[str, Any]],
) -> dict[str, Any]:
    """Which U has its first twist mode highest above the first bending mode, and what speaks against it.

    `channels` come with increasing thickness of their sheet.
    """

    def best(ratios: Mapping[str, float]) -> str:
        return max((name for name in U_SHAPES if name in ratios), key=lambda name: ratios[name])

    chosen = best({name: rows[name]["ratio_twist"] for name in U_SHAPES if name in rows})
    names = list(dict.fromkeys(row["variation"] for row in variations))

    def agree(ratio: str) -> list[str]:
        return [
            name
            for name in names
            if best({r["reading"]: r[ratio] for r in variations if r["variation"] == name}) == chosen
        ]

    beaten = rows[chosen]["ratio_twist"]
    sheet, flange = _crossing(channels, beaten)
    return {
        "default": chosen,
        "criterion": "highest ratio of first twist to first bending frequency among the U shapes",
        "variations": names,
        "variations_that_agree": agree("ratio_twist"),
        "variations_that_agree_on_the_lowest": agree("ratio"),
        "plain_strip_is_higher": rows["plain"]["ratio_twist"] > beaten,
        "channel_is_higher_from_sheet_m": sheet,
        "channel_flange_there_m": flange,
        "twist_to_nearest_bending": rows[chosen]["first_twist_hz"]
        / rows[chosen]["bending_mode_nearest_to_twist_hz"] - 1.0,
    }


def _crossing(channels: Sequence[Mapping[str, Any]], ratio: float) -> tuple[float, float]:
    """Sheet and flange [m] of the channel whose twist mode reaches this ratio, between two neighbours."""
    for thin, thick in pairwise(channels):
        if thin["ratio_twist"] <= ratio < thick["ratio_twist"]:
            part = (ratio - thin["ratio_twist"]) / (thick["ratio_twist"] - thin["ratio_twist"])
            sheet = thin["thickness_m"] + part * (thick["thickness_m"] - thin["thickness_m"])
            return sheet, thin["flange_m"] + part * (thick["flange_m"] - thin["flange_m"])
    return math.nan, math.nan


def verdict_words(rows: Mapping[str, Mapping[str, Any]], verdict: Mapping[str, Any]) -> str:
    """The verdict for a person."""
    chosen, row = verdict["default"], rows[verdict["default"]]
    others = " and ".join(
        f"{rows[name]['ratio_twist']:.1f} ({TITLES[name]})" for name in U_SHAPES if name != chosen
    )
    agree, tried = len(verdict["variations_that_agree"]), len(verdict["variations"])
    text = (
        f'Of the U shapes, "{TITLES[chosen]}" has its twist mode highest: {row["ratio_twist"]:.1f} times '
        f"the first bending frequency, against {others}; {agree} of {tried} variations agree. That is why it "
        f"is the default. With sideways modes counted too its lowest is at {row['ratio']:.1f}, and "
        f"{len(verdict['variations_that_agree_on_the_lowest'])} of {tried} variations agree.\n"
    )
    if verdict["plain_strip_is_higher"]:
        plain = rows["plain"]
        text += (
            f"A plain strip has it higher still, {plain['ratio_twist']:.1f} times: of the same width and "
            "period, it has the thicker sheet. What the fold changes is how far the twist mode turns the "
            f"ball, {row['turn_of_twist']:.0f} against {plain['turn_of_twist']:.0f} kg^-1/2 m^-1.\n"
        )
    if math.isfinite(verdict["channel_is_higher_from_sheet_m"]):
        sheet = 1e3 * verdict["channel_is_higher_from_sheet_m"]
        flange = 1e3 * verdict["channel_flange_there_m"]
        text += (
            f"Channels of sheets from {sheet:.2f} mm on have it higher too, with flanges of {flange:.2f} mm "
            "and less: plain strips with raised edges.\n"
        )
    near = 100.0 * abs(verdict["twist_to_nearest_bending"])
    return text + (
        "On the plane of symmetry the ball sees no twist mode in any reading. Off it by "
        f"{1e3 * row['off_line_m']:.2g} mm it sees that of \"{TITLES[chosen]}\" with phi = "
        f"{row['tip_value_twist_off_line']:.3g} kg^-1/2, the first bending mode with "
        f"{row['tip_value_bending']:.3g}; a bending mode {near:.1f} % away from it takes part in that."
    )


def printed_readings(rows: Sequence[Mapping[str, Any]]) -> str:
    """The table of the readings."""
    heads = ("reading", "sheet (mm)", "flange (mm)", "bending (Hz)", "twist (Hz)", "sideways (Hz)",
             "twist/bending", "lowest/bending", "phi bending", "phi twist", "phi off line", "turn")
    cells = [
        (
            TITLES[row["reading"]],
            f"{1e3 * row['thickness_m']:.3f}",
            f"{1e3 * row['flange_m']:.2f}" if row["flange_m"] else "-",
            f"{row['first_bending_hz']:.2f}",
            f"{row['first_twist_hz']:.1f}",
            _number(row["first_sideways_hz"], ".1f"),
            f"{row['ratio_twist']:.2f}",
            f"{row['ratio']:.2f}",
            f"{row['tip_value_bending']:.2f}",
            f"{row['tip_value_twist']:.0e}",
            f"{row['tip_value_twist_off_line']:.3f}",
            f"{row['turn_of_twist']:.0f}",
        )
        for row in rows
    ]
    return _columns([heads, *cells])


def printed_variations(rows: Sequence[Mapping[str, Any]]) -> str:
    """Twist over bending, a line a variation."""
    names = list(dict.fromkeys(row["variation"] for row in rows))
    table = [("twist/bending (lowest/bending)", *TITLES.values())]
    for name in names:
        found = {row["reading"]: row for row in rows if row["variation"] == name}
        table.append((name, *(
            f"{found[r]['ratio_twist']:.1f} ({found[r]['ratio']:.1f})" if r in found else "-" for r in TITLES
        )))
    return _columns(table)


def printed_solids(rows: Sequence[Mapping[str, Any]]) -> str:
    """The readings as solids: the size that gives the period, bending and twist of the size in the table."""
    heads = ("as a solid", "needs sheet (mm)", "flange (mm)", "bending (Hz)", "error (%)", "twist (Hz)",
             "error (%)")
    cells = [
        (
            TITLES[row["reading"]],
            f"{1e3 * row['thickness_needed_m']:.3f}",
            f"{1e3 * row['flange_needed_m']:.2f}" if row["flange_needed_m"] else "-",
            f"{row['first_bending_solid_hz']:.2f}",
            f"{100.0 * row['error_bending']:+.2f}",
            f"{row['first_twist_solid_hz']:.1f}",
            f"{100.0 * row['error_twist']:+.2f}",
        )
        for row in rows
    ]
    return _columns([heads, *cells])


def printed_errors(rows: Sequence[Mapping[str, Any]]) -> str:
    """Errors of strip theory, mode by mode."""
    heads = ("reading", "family", "mode", "kind", "strip (Hz)", "solid (Hz)", "error (%)", "mesh (%)",
             "bend as plate (%)", "phi (%)")
    cells = [
        (
            TITLES[row["reading"]], row["family"], str(row["number"]), row["kind"], f"{row['strip_hz']:.2f}",
            f"{row['solid_hz']:.2f}", f"{100.0 * row['error']:+.2f}", f"{100.0 * row['mesh_change']:+.3f}",
            f"{100.0 * row['error_bend_as_plate']:+.2f}" if row["reading"] == "folded" else "-",
            _number(100.0 * row["tip_value_error"], "+.2f"),
        )
        for row in rows
    ]
    return _columns([heads, *cells])


def _number(value: float, form: str) -> str:
    return f"{value:{form}}" if math.isfinite(value) else "-"


def _columns(rows: Sequence[Sequence[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(f"{cell:<{width}}" if place == 0 else f"{cell:>{width}}"
                  for place, (cell, width) in enumerate(zip(row, widths, strict=True)))
        for row in rows
    )
