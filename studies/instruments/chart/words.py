"""What the chart says in the end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["closing_lines"]


def closing_lines(result: Mapping[str, Any], figure: str) -> list[str]:
    """Where the figure is, and what it rests on."""
    lines = [
        f"figure: {figure}",
        f"{result['cells']} cells, {result['computed_now']} of them computed now"
        + (f" at {result['cells_per_s']:.0f} per s" if result["cells_per_s"] else "")
        + f"; {100 * result['share_without_period']:.1f} % without a period up to 64 in "
        f"{result['most_cycles']} drive periods",
    ]
    if result["folds_seen"]:
        lines.append(
            f"the exact fold lies in the very step of the grid in which p_m ends in {result['folds_met']} of "
            f"the {result['folds_seen']} columns that come down on p_m"
        )
    return lines
