"""Upward and downward scans of the amplitude through grazing.

The physical state is carried along from one amplitude to the next, in even steps below grazing and finer ones
above it, as in the experiment.  A scan is read as stretches of one period; p3 with one impact, met at the
very end of the downward scan, is the letter's observation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contact.orbits.scan import OrbitDiagram, orbit_diagram
from contact.stroboscope import StroboscopicMap
from studies.instruments.breakdown.beam_of_fig_5 import born, fold_of_p3
from studies.instruments.breakdown.plan import Plan
from studies.published import STROBE_POINTS

__all__ = ["HIGHEST", "beam_result", "both_ways", "end_of_p3", "excesses", "periods", "rows_of", "stretches"]

HIGHEST = 0.012
"""Upper end of the scans: the letter's finer steps above grazing."""


def excesses(lowest: float, plan: Plan) -> np.ndarray:
    """The amplitudes of an upward scan: even steps below grazing, finer ones above."""
    below = np.linspace(lowest, 0.0, plan.below)[:-1]
    return np.concatenate([below, np.linspace(0.0, HIGHEST, plan.above)[1:]])


def both_ways(
    strobed: StroboscopicMap, lowest: float, plan: Plan, observe: Callable[[np.ndarray], np.ndarray]
) -> dict[str, OrbitDiagram[Any]]:
    """Upward and downward scan."""
    values = excesses(lowest, plan)
    common: dict[str, Any] = {
        "observe": observe,
        "settle_cycles": plan.cycles,
        "record_cycles": STROBE_POINTS,
        "early": plan.early,
    }
    up = orbit_diagram(strobed, values, strobed.at(lowest).steady(), **common)
    return {"up": up, "down": orbit_diagram(strobed, values[::-1], up.end, **common)}


def periods(diagram: OrbitDiagram[Any]) -> np.ndarray:
    """Periods of a scan; a motion without impacts is p1, even while it has not quite come to rest."""
    return np.where(diagram.impacts == 0, 1, diagram.period)


def rows_of(diagram: OrbitDiagram[Any]) -> list[dict[str, Any]]:
    """A scan, amplitude by amplitude."""
    return [
        {"excess": float(e), "period": int(p), "impacts": int(i)}
        for e, p, i in zip(diagram.excess, periods(diagram), diagram.impacts, strict=True)
    ]


def stretches(diagram: OrbitDiagram[Any]) -> list[dict[str, Any]]:
    """The scan as stretches of one period: from, to, period; impacts where they stay the same."""
    found: list[dict[str, Any]] = []
    for row in rows_of(diagram):
        key = (row["period"], row["impacts"] if row["period"] else None)
        if not found or (found[-1]["period"], found[-1]["impacts"]) != key:
            found.append({"period": key[0], "impacts": key[1], "from": row["excess"], "to": row["excess"]})
        found[-1]["to"] = row["excess"]
    return found


def end_of_p3(diagram: OrbitDiagram[Any]) -> list[float] | None:
    """[first, last] excess at which a downward scan is on p3 with one impact."""
    on = (periods(diagram) == 3) & (diagram.impacts == 1)
    return [float(diagram.excess[on][0]), float(diagram.excess[on][-1])] if np.any(on) else None


def beam_result(
    strobed: StroboscopicMap, plan: Plan, lowest: float | None = None
) -> tuple[dict[str, Any], dict[str, OrbitDiagram[Any]]]:
    """What a beam does at birth and in the scans."""
    fold = fold_of_p3(strobed)
    reach = 1.12 * fold if fold is not None and fold < -0.01 else -0.1
    ways = both_ways(
        strobed, min(reach, lowest or 0.0), plan, lambda points: strobed.readout(points, "readout")
    )
    down = ways["down"]
    with_impacts = down.excess[down.impacts > 0]
    period, impacts = born(strobed, plan.cycles)
    return {
        "born": {"period": period, "impacts": impacts},
        "fold_p3": fold,
        "p3_in_downward_scan": end_of_p3(down),
        "impacts_end": float(with_impacts[-1]) if with_impacts.size else None,
        "stretches_up": stretches(ways["up"]),
        "stretches_down": stretches(down),
    }, ways
