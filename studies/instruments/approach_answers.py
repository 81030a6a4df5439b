"""What the curves of one approach to the plate say: numbers read off the rows, nothing computed anew.

Between the cells of a curve tau^2 is smooth where tau is not: with one impact

    tau^2 = (1 - kick)^2 + 2 a shift / v^2,

the first term has its zero, and tau its corner, where kick = 1.  Smallest values and crossings are therefore
read off splines through tau^2, in the logarithm of the tip mass or of the excess.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from studies.instruments.approaches import select
from studies.published import TIME_TRACE_EXCESS

__all__ = [
    "clusters", "crossing", "fade", "floor_over_mass", "hard_stop", "local_loss", "settled_orbits", "stands_still",
    "worst_of_closed_forms",
]

Rows = Sequence[Mapping[str, Any]]
STILL = 1e-3
"""How closely a result must agree with that of the most modes: absolute in restitution and kick, in the delay
relative to the arc v/a."""

FLAT = 0.9
"""Part of its largest value that a kick on its plateau has."""

_FINE = 2001
"""Points at which a spline is looked through: the smallest value is good to 1e-6 of itself."""


def crossing(x: Sequence[float], y: Sequence[float], level: float) -> float:
    """The first x at which y(x) goes through `level`, by a monotone spline in log x; NaN if it never does."""
    keep = [i for i in range(len(x)) if math.isfinite(y[i]) and x[i] > 0.0]
    if len(keep) < 2:
        return math.nan
    where, what = np.log([x[i] for i in keep]), np.array([y[i] for i in keep]) - level
    turns = np.flatnonzero(what[:-1] * what[1:] <= 0.0)
    if not turns.size:
        return math.nan
    spline = PchipInterpolator(where, what)
    roots = spline.roots(extrapolate=False)
    inside = roots[(roots >= where[turns[0]] - 1e-9) & (roots <= where[turns[0] + 1] + 1e-9)]
    return float(math.exp(inside[0])) if inside.size else math.nan


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
    nothing = dict.fromkeys(("plateau", "half_excess", "share_at_resolution", "share_at_born_excess"), math.nan)
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
    return {"modes": still, "drift": drift, **ends, "impacts_beyond": {n: by_count[n]["impacts"] for n in beyond}}


def floor_over_mass(rows: Rows, target: float) -> dict[str, Any]:
    """The smallest restitution over tip mass, where it is, and the mass ratios at which it is `target`."""
    kept = [r for r in rows if r["impacts"] == 1 and math.isfinite(r["restitution"]) and r["mass_ratio"] > 0.0]
    if len(kept) < 3:
        return {"restitution": math.nan, "mass_ratio": math.nan, "kick": math.nan, "at_edge": False, "at_target": []}
    where = np.log([r["mass_ratio"] for r in kept])
    # tau^2 - (1 - kick)^2 varies slowly, and so does the kick: interpolate these, not their sum
    kick = PchipInterpolator(where, [r["kick"] for r in kept])
    rest = PchipInterpolator(where, [r["restitution"] ** 2 - (1.0 - r["kick"]) ** 2 for r in kept])
    fine = np.linspace(where[0], where[-1], _FINE)
    square = np.maximum((1.0 - kick(fine)) ** 2 + rest(fine), 0.0)
    least = int(np.argmin(square))
    turns = np.flatnonzero((square[:-1] - target**2) * (square[1:] - target**2) < 0.0)
    return {
        "restitution": float(math.sqrt(square[least])),
        "mass_ratio": float(math.exp(fine[least])),
        "kick": float(kick(fine[least])),
        "at_edge": least in (0, fine.size - 1),
        "at_target": [float(math.exp(0.5 * (fine[i] + fine[i + 1]))) for i in turns],
    }


def _floors(rows: Rows, curve: str, target: float) -> list[dict[str, Any]]:
    """`floor_over_mass` of every series of a curve, its number first."""
    names = sorted({r["series"] for r in rows if r["curve"] == curve}, key=float)
    return [
        {"value": float(name), **floor_over_mass(select([dict(r) for r in rows], curve, name), target)}
        for name in names
    ]


def local_loss(rows: Rows, target: float) -> dict[str, Any]:
    """Whether restitution `target` at the excess of Fig. 4 needs loss in the contact, and what else gives it."""
    floors, hard = _floors(rows, "search", target), _floors(rows, "hardness", target)
    elastic = next((f for f in floors if f["value"] == 1.0), None)
    elastic_floor = elastic["restitution"] if elastic else math.nan
    lossy = [f["restitution"] for f in floors if f["value"] < 1.0 and math.isfinite(f["restitution"])]
    lossy_floor = min(lossy, default=math.nan)
    if elastic_floor <= target:
        verdict = "reached without local loss"
    elif lossy_floor <= target:
        verdict = "reached with local loss only"
    else:
        verdict = "not reached, with or without local loss"
    arcs = [r["arc_s"] for r in rows if r["curve"] == "search" and math.isfinite(r["arc_s"])]
    speed = [r for r in select([dict(r) for r in rows], "speed", "hertz") if math.isfinite(r["restitution"])]
    return {
        "target": target,
        "excess": TIME_TRACE_EXCESS,
        "verdict": verdict,
        "elastic_floor": elastic_floor,
        "lossy_floor": lossy_floor,
        "by_local_restitution": floors,
        "by_hardness": hard,
        "hardness_needed": crossing([f["value"] for f in hard], [f["restitution"] for f in hard], target),
        "contact_time_needed_s": target**2 * float(np.median(arcs)) if arcs else math.nan,
        "excess_needed": crossing([r["excess"] for r in speed], [r["restitution"] for r in speed], target),
        "settled_orbits": settled_orbits(rows, target),
    }


def settled_orbits(rows: Rows, target: float) -> dict[str, Any]:
    """Restitution in the orbits that settle at Fig. 4, where the ringing of the last collision is not over.

    It shifts the touch to before or after t_in, by tens of microseconds, and with it shift and restitution; an
    outgoing motion that does not come back to the gap counts as restitution 0.
    """
    cells = []
    for r in rows:
        if r["curve"] == "orbit" and r["orbit_period"] > 0 and r["impacts"] > 0 and not r["forced_by_ringing"]:
            tau = r["restitution"] if r["returns"] else 0.0
            names = ("mass_ratio", "orbit_period", "approach_velocity", "kick", "force_delay_s")
            cells.append({name: r[name] for name in names} | {"restitution": tau})
    cells.sort(key=lambda cell: float(cell["mass_ratio"]))
    below = [cell["mass_ratio"] for cell in cells if cell["restitution"] <= target]
    return {"reached": bool(below), "mass_ratios_below_target": below, "orbits": cells}


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
    """Largest deviation of the leading-order restitution and delay [arcs] in first collisions with one impact."""
    kept = [
        r for r in rows
        if r["impacts"] == 1 and r["curve"] != "orbit" and r["excess"] <= 0.05 and math.isfinite(r["restitution"])
        and math.isfinite(r["closed_restitution"])
    ]
    return {
        "restitution": max((abs(r["restitution"] - r["closed_restitution"]) for r in kept), default=math.nan),
        "delay_over_arc": max((abs(r["delay_s"] - r["closed_delay_s"]) / r["arc_s"] for r in kept), default=math.nan),
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
