"""How well the strobe points of a noisy p_m orbit are told apart.

With noise the m strobe points are m clouds, sorted by the strobes since the last impact.  One cloud is told
from the next if they are further apart than they are wide (90 % of the points).
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["clouds", "since_impact"]


def since_impact(impacts: np.ndarray) -> np.ndarray:
    """Strobes since the last impact, -1 before the first one."""
    found, count = np.empty(impacts.size, dtype=np.int64), -1
    for n, touched in enumerate(impacts):
        count = 0 if touched else count + 1 if count >= 0 else -1
        found[n] = count
    return found


def clouds(points: np.ndarray, impacts: np.ndarray, period: int) -> dict[str, Any]:
    """How well the m strobe points of p_m are told apart.

    `regular`: part of the intervals between periods with impact that are m long.  `spread`: greatest width of
    a cloud (90 % of its points), `separation`: distance of the closest two, `told_apart`: least ratio of the
    distance of neighbours to their mean width (above 1 they do not overlap).
    """
    phase = since_impact(impacts)
    intervals = np.diff(np.flatnonzero(impacts))
    found: dict[str, Any] = {
        "regular": float(np.mean(intervals == period)) if intervals.size else 0.0,
        "spread": None,
        "separation": None,
        "told_apart": None,
        "closest": None,
    }
    groups = [points[phase == j] for j in range(period)]
    if min(group.size for group in groups) < 10:
        return found
    centre = np.array([np.median(group) for group in groups])
    width = np.array([np.quantile(group, 0.95) - np.quantile(group, 0.05) for group in groups])
    order = np.argsort(centre)
    apart = np.diff(centre[order])
    ratio = apart / np.maximum(0.5 * (width[order][1:] + width[order][:-1]), 1e-300)
    worst = int(np.argmin(ratio))
    found |= {
        "spread": float(width.max()),
        "separation": float(apart.min()),
        "told_apart": float(ratio[worst]),
        "closest": [int(order[worst]), int(order[worst + 1])],
    }
    return found
