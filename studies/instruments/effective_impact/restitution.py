"""Where restitution is smallest, and whether the letter's value needs loss in the contact.

Between the cells of a curve tau^2 is smooth where tau is not: with one impact

    tau^2 = (1 - kick)^2 + 2 a shift / v^2,

the first term has its zero, and tau its corner, where kick = 1.  Smallest values over the tip mass are read
off splines through the kick and through the rest, both in the logarithm of the mass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from studies.instruments.effective_impact.approaches import select
from studies.published import TIME_TRACE_EXCESS

__all__ = ["crossing", "floor_over_mass", "local_loss", "settled_orbits"]

Rows = Sequence[dict[str, Any]]

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


def floor_over_mass(rows: Rows, target: float) -> dict[str, Any]:
    """The smallest restitution over tip mass, where it is, and the mass ratios at which it is `target`."""
    kept = [
        r for r in rows if r["impacts"] == 1 and math.isfinite(r["restitution"]) and r["mass_ratio"] > 0.0
    ]
    if len(kept) < 3:
        return {
            "restitution": math.nan,
            "mass_ratio": math.nan,
            "kick": math.nan,
            "at_edge": False,
            "at_target": [],
        }
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
        {"value": float(name), **floor_over_mass(select(rows, curve, name), target)}
        for name in names
    ]


def local_loss(rows: Rows, target: float) -> dict[str, Any]:
    """Whether restitution `target` at the excess of Fig. 4 needs local loss, and what else gives it."""
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
    speed = [r for r in select(rows, "speed", "hertz") if math.isfinite(r["restitution"])]
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

    It shifts the touch to before or after t_in, by tens of microseconds, and with it shift and restitution;
    an outgoing motion that does not come back to the gap counts as restitution 0.
    """
    cells = []
    for r in rows:
        if (
            r["curve"] == "orbit"
            and r["orbit_period"] > 0
            and r["impacts"] > 0
            and not r["forced_by_ringing"]
        ):
            tau = r["restitution"] if r["returns"] else 0.0
            names = ("mass_ratio", "orbit_period", "approach_velocity", "kick", "force_delay_s")
            cells.append({name: r[name] for name in names} | {"restitution": tau})
    cells.sort(key=lambda cell: float(cell["mass_ratio"]))
    below = [cell["mass_ratio"] for cell in cells if cell["restitution"] <= target]
    return {"reached": bool(below), "mass_ratios_below_target": below, "orbits": cells}
