"""The verdict on a claim, and what the claims have in common: restitutions, frequencies, monotony.

Rounding is no change: a sequence falls where no step rises by more than `MONOTONE`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.instruments.scene import Scene

__all__ = ["Claim", "MONOTONE", "RESTITUTIONS", "falls", "frequencies_of"]

RESTITUTIONS = np.round(np.linspace(0.0, 0.9, 19), 3)
MONOTONE = 1e-12
"""Change of an excess that is rounding."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """The verdict on one claim: `holds` is None where the computation cannot decide."""

    holds: bool | None
    numbers: Mapping[str, Any]
    sentence: str
    table: Mapping[str, Sequence[Any]]
    figure: Any

    def as_dict(self) -> dict[str, Any]:
        return {"holds": self.holds, "numbers": dict(self.numbers), "sentence": self.sentence}


def frequencies_of(scene: Scene) -> list[float]:
    return sorted(scene.drive.frequencies_hz)


def falls(values: Sequence[float]) -> bool:
    return bool(np.all(np.diff(values) <= MONOTONE))
