r"""The plane of the chart: drive frequency [Hz] by excess F/F_g - 1.

Frequencies are evenly spaced.  Excesses are even in

    s = asinh(excess / KNEE),   KNEE = 0.005,

that is in steps of (range of s) KNEE/(n - 1) around grazing and in proportion to the excess far from it.  The
hysteresis of the letter's transitions, 1e-4 to 1.3e-2, would be lost within a step or two of an even grid of
400 amplitudes over -0.15 ... 0.1 (6e-4); here the step at grazing is 1e-4 and the last ones are 3e-3, still
ten to the width of the islands near -0.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.instruments.sweep.tasks import Grid

__all__ = ["EXCESSES", "FREQUENCIES_HZ", "KNEE", "Plane", "sheared"]

FREQUENCIES_HZ = (19.5, 24.0)
EXCESSES = (-0.15, 0.1)
KNEE = 0.005


def sheared(excess: Any) -> Any:
    """s of the module's docstring: the upright coordinate of the chart [1]."""
    return np.arcsinh(np.asarray(excess, dtype=float) / KNEE)


@dataclass(frozen=True, kw_only=True)
class Plane:
    """`columns` frequencies by `rows` excesses between given ends."""

    columns: int
    rows: int
    frequencies_hz: tuple[float, float] = FREQUENCIES_HZ
    excesses: tuple[float, float] = EXCESSES

    def __post_init__(self) -> None:
        for name in ("columns", "rows"):
            if getattr(self, name) < 2:
                raise ValueError(
                    f"points of the chart are {self.columns} by {self.rows}; each must be 2 or more"
                )
        for name, lowest in (("frequencies_hz", 0.0), ("excesses", -1.0)):
            low, high = getattr(self, name)
            if not lowest < low < high:
                raise ValueError(
                    f"{name} of the chart are {low} to {high}; they must rise from above {lowest:g}"
                )

    def grid(self) -> Grid:
        """The cells."""
        low, high = sheared(self.excesses)
        s = np.linspace(low, high, self.rows)
        excesses = KNEE * np.sinh(s)
        excesses[[0, -1]] = self.excesses
        low, high = self.frequencies_hz
        frequencies = np.linspace(low, high, self.columns)
        return Grid(frequencies=tuple(frequencies.tolist()), excesses=tuple(excesses.tolist()))

    def as_dict(self) -> dict[str, Any]:
        """In terms of JSON, for the plan of a store."""
        return {
            "points": [self.columns, self.rows],
            "frequencies_hz": list(self.frequencies_hz),
            "excesses": list(self.excesses),
            "knee": KNEE,
        }
