"""The families of the stability study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from studies.scene import Scene
from studies.stability import (
    Findings,
    accumulation,
    explicit,
    false_restitution,
    implicit_energy,
    missed_crossings,
    splitting,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FAMILIES", "findings"]


class Family(Protocol):
    """What a file of a family offers."""

    def measure(self, scene: Scene, quick: bool) -> Findings:
        """The rows, and the arrays of the figure."""

    def draw(self, arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
        """The figure and its caption."""


FAMILIES = {
    name: cast(Family, module)
    for name, module in (
        ("explicit", explicit), ("splitting", splitting), ("implicit_energy", implicit_energy),
        ("false_restitution", false_restitution), ("missed_crossings", missed_crossings),
        ("accumulation", accumulation),
    )
}  # fmt: skip
"""The families in the order of the table."""


def findings(name: str, scene: Scene, quick: bool) -> Findings:
    """What the family finds."""
    return FAMILIES[name].measure(scene, quick)
