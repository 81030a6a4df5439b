"""What the scans, the island and the search of Fig. 5 give, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from studies.instruments.breakdown.beam_of_fig_5 import CHAOS_AT
from studies.published import BREAKDOWN

__all__ = ["number", "sentences", "word"]


def word(period: int, impacts: int | None = None) -> str:
    """p6, or what stands for no period."""
    return "no period" if period == 0 else f"p{period}" + (f" ({impacts} impacts)" if impacts else "")


def sentences(found: Mapping[str, Any]) -> list[str]:
    """The results in words."""
    lines = []
    single, alive = (
        found["single_mode"],
        [e for e in found["single_mode"]["islands"] if e["alive_at_letters_chaos"]],
    )
    largest = max((e["restitution"] for e in alive), default=math.nan)
    lines.append(
        f"Eq. (1): born {word(single['born']['period'])}; island of p3 and chaos, not connected to it: "
        + ", ".join(
            f"{e['fold_p3']:+.4f} to {e['end']:+.4f} at tau = {e['restitution']:g}" for e in single["islands"]
        )
        + f". A motion with impacts at {CHAOS_AT} needs tau <= {largest:g} of these (as a rho of the map, "
        f"{CHAOS_AT} is an excess of {single['excess_of_letters_chaos_as_rho']:+.4f})."
    )
    beam = found["beam"]
    end = beam["p3_in_downward_scan"]
    lines.append(
        f"Beam as calibrated ({1e3 * beam['tip_mass_kg']:.2f} g): born {word(beam['born']['period'])}; "
        f"p3 fold at {number(beam['fold_p3'])}; downward scan "
        + (f"on p3 from {end[0]:+.4f} to {end[1]:+.4f}" if end else "falls to p1 without reaching p3")
        + f"; impacts end at {number(beam['impacts_end'])}."
    )
    six = [cell for cell in found["born"] if cell["period"] == BREAKDOWN["born_period"]]
    if six:
        masses = sorted({1e3 * cell["tip_mass_kg"] for cell in six})
        lines.append(
            f"Period 6 at birth in {len(six)} of {len(found['born'])} cells, at ball masses of "
            f"{masses[0]:.2f} to {masses[-1]:.2f} g."
        )
    at = found["found"]
    if at is not None:
        end = at["p3_in_downward_scan"]
        lines.append(
            f"With {1e3 * at['tip_mass_kg']:.2f} g, damping of the higher modes x {at['higher_damping']:g}, "
            f"local restitution {at['local_restitution']:g}: born "
            f"{word(at['born']['period'], at['born']['impacts'])}; p3 "
            + (
                f"in the downward scan only from {end[0]:+.4f} to {end[1]:+.4f}, its very end"
                if end
                else "not reached"
            )
            + f"; fold at {number(at['fold_p3'])}."
        )
    return lines


def number(value: float | None) -> str:
    """An excess in words."""
    return "none" if value is None else f"{value:+.4f}"
