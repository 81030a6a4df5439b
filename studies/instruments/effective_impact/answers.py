"""What the curves of one approach to the plate say of kick, modes and clusters: read off the rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from studies.instruments.effective_impact.restitution import crossing
from studies.published import TIME_TRACE_EXCESS

__all__ = ["clusters", "fade", "hard_stop", "stands_still", "worst_of_closed_forms"]

Rows = Sequence[dict[str, Any]]

STILL = 1e-3
"""How closely a result must agree with that of the most modes: absolute in restitution and kick, in the delay
relative to the arc v/a."""

FLAT = 0.9
"""Part of its largest value that a kick on its plateau has."""


def fade(rows: Rows, resolution: float, born_excess: float) -> dict[str, float]:
    """Plateau of the kick, the excess at which it has fallen to half, and its share at two excesses.

    Not a number for a kick that has no plateau: one that is still below `FLAT` of its largest at Fig. 4.

    Parameters
    ----------
    rows : of one spring and law, by rising excess.
    resolution : the letter's relative amplitude stability [1].
    born_excess : where born periods are read [1].
    """
    excess, kick = [float(r["excess"]) for r in rows], [float(r["kick"]) for r in rows]
    finite = [k for k in kick if math.isfinite(k)]
    nothing = dict.fromkeys(
        ("plateau", "half_excess", "share_at_resolution", "share_at_born_excess"), math.nan
    )
    if len(finite) < 2:
        return nothing
    plateau = max(finite)
    reference = min(range(len(excess)), key=lambda i: abs(math.log(excess[i] / TIME_TRACE_EXCESS)))
    if not kick[reference] >= FLAT * plateau:
        return nothing
    share = PchipInterpolator(np.log(excess), np.array(kick) / plateau, extrapolate=False)
    return {
        "plateau": plateau,
        "half_excess": crossing(excess, kick, 0.5 * plateau),
        "share_at_resolution": float(share(math.log(resolution))),
        "share_at_born_excess": float(share(math.log(born_excess))),
    }


def stands_still(rows: Rows, most: int) -> dict[str, Any]:
    """From how many modes on all results lie within `STILL` of that of `most` modes; None if they never do.

    Results beyond `most` have to agree as well: a slow drift passes for rest where it is compared with its
    own last step.
    """
    by_count = {int(r["modes"]): r for r in rows}
    empty = {"modes": None, "drift": math.nan, "impacts": 0, "kick": math.nan, "restitution": math.nan}
    last = by_count.get(most)
    if last is None:
        return empty

    def away(row: Mapping[str, Any]) -> float:
        off = [abs(row[name] - last[name]) for name in ("restitution", "kick")]
        off.append(abs(row["delay_s"] - last["delay_s"]) / abs(last["arc_s"]))
        return max((math.inf if math.isnan(o) else o) for o in off)

    beyond = [n for n in by_count if n > most]
    drift = max((away(by_count[n]) for n in beyond), default=0.0)
    still = None
    if drift <= STILL:
        for count in sorted((n for n in by_count if n <= most), reverse=True):
            if away(by_count[count]) > STILL:
                break
            still = count
    ends = {name: last[name] for name in ("impacts", "kick", "restitution")}
    return {
        "modes": still,
        "drift": drift,
        **ends,
        "impacts_beyond": {n: by_count[n]["impacts"] for n in beyond},
    }


def clusters(rows: Rows) -> dict[str, Any]:
    """Where a collision first consists of more than one impact."""

    def first(curve: str, key: str, pick: Callable[..., float]) -> dict[str, float | None]:
        found: dict[str, float | None] = {}
        for name in dict.fromkeys(r["series"] for r in rows if r["curve"] == curve):
            many = [r[key] for r in rows if r["curve"] == curve and r["series"] == name and r["impacts"] > 1]
            found[name] = pick(many) if many else None
        return found

    by_mass: dict[str, float | None] = {}
    for ratio in sorted({r["mass_ratio"] for r in rows if r["curve"] == "mass"}):
        cells = [r for r in rows if r["curve"] == "mass" and r["mass_ratio"] == ratio and r["impacts"] > 1]
        by_mass[f"{ratio:.3g}"] = min((r["excess"] for r in cells), default=None)
    return {
        "first_excess": first("speed", "excess", min),
        "heaviest_mass_ratio": first("mass", "mass_ratio", max),
        "first_excess_by_mass_ratio": by_mass,
        "first_stiffness_ratio": first("stiffness", "value", min),
        "first_modes": first("modes", "value", min),
    }


def worst_of_closed_forms(rows: Rows) -> dict[str, float]:
    """Largest deviation of leading-order restitution and delay [arcs] in first collisions with one impact."""
    kept = [
        r
        for r in rows
        if r["impacts"] == 1
        and r["curve"] != "orbit"
        and r["excess"] <= 0.05
        and math.isfinite(r["restitution"])
        and math.isfinite(r["closed_restitution"])
    ]
    return {
        "restitution": max((abs(r["restitution"] - r["closed_restitution"]) for r in kept), default=math.nan),
        "delay_over_arc": max(
            (abs(r["delay_s"] - r["closed_delay_s"]) / r["arc_s"] for r in kept), default=math.nan
        ),
        "collisions": len(kept),
    }


def hard_stop(rows: Rows) -> dict[str, float]:
    """The kick on the hardest linear stop of a series beside that of the ball by itself, 2 M phi_1^2."""
    if not rows:
        return dict.fromkeys(("kick", "contact_s", "ball_limit", "stiffness_ratio"), math.nan)
    last = rows[-1]
    return {
        "kick": last["kick"], "contact_s": last["contact_s"], "ball_limit": last["ball_limit"],
        "stiffness_ratio": last["value"],
    }
