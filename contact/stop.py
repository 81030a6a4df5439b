"""The stop: a wall that rides on the base, at distance `gap` from the resting tip."""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact.laws import ContactLaw

__all__ = ["Stop"]


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A wall at tip displacement `gap` relative to the base, with the law of its contact.

    Parameters
    ----------
    gap : float
        Distance from the tip at rest to the wall, zero or more [m]; a driven spring needs more than zero.
    law : ContactLaw
        What happens when the tip reaches it.
    """

    gap: float
    law: ContactLaw

    def __post_init__(self) -> None:
        if not (math.isfinite(self.gap) and self.gap >= 0):
            raise ValueError(f"gap is {self.gap} m; it must be finite and zero or more")
        if not isinstance(self.law, ContactLaw):
            raise TypeError(
                f"law of the stop is {self.law!r}; it must be a contact law such as NewtonRestitution"
            )
