"""The one row of all families: what theory gives, what was found, and whether the package refuses beyond."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

__all__ = ["Findings", "Limit", "threshold"]

MOST_HALVINGS = 200
"""64 suffice for neighbouring doubles, three times that for a bracket over all exponents."""


@dataclass(frozen=True, kw_only=True)
class Limit:
    """One quantity of one method: what theory gives for it and what was found."""

    family: str
    method: str
    """As in ``contact.integrators.INTEGRATORS``, or the name of an outside solver."""
    case: str
    parameter: str
    """What is limited, or measured, with its unit: "h omega_max [1]"."""
    theory: float | None
    """None where theory gives no number: a method without such a limit, or a statistical onset."""
    measured: float | None
    """None where the failure did not appear."""
    refused: bool | None = None
    """Whether it is refused just beyond the limit, before a number comes out; None if nothing is to be
    refused."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """The rows of a family, and the arrays that its figures are drawn from."""

    limits: Sequence[Limit]
    arrays: Mapping[str, np.ndarray]


def threshold(
    fails: Callable[[float], bool], holds_at: float, fails_at: float, *, relative: float = 1e-6
) -> float | None:
    """Where `fails` turns true between `holds_at` and `fails_at`, both above zero, to a part `relative`.

    The bracket is halved at its geometric mean, so that many decades take no longer than one. None if the two
    ends do not differ: a limit that was not seen on both sides is not a measured one.
    """
    if fails(holds_at) or not fails(fails_at):
        return None
    low, high = holds_at, fails_at
    for _ in range(MOST_HALVINGS):
        middle = math.sqrt(low * high)
        if abs(high - low) <= relative * max(low, high) or middle in (low, high):
            break
        low, high = (low, middle) if fails(middle) else (middle, high)
    return math.sqrt(low * high)
