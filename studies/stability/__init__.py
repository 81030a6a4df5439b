"""The one row of all families: what theory gives, what was found, and whether the package refuses beyond."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

__all__ = ["Findings", "Limit", "threshold"]


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


def threshold(fails: Callable[[float], bool], ladder: Sequence[float], relative: float) -> float | None:
    """Where `fails` turns true on a `ladder` of values above zero, to a part `relative`.

    The first interval whose end fails is halved at its geometric mean. None if nothing fails, or the first
    value does: a limit that was not seen on both sides is not a measured one.
    """
    if fails(ladder[0]):
        return None
    found = next(((low, high) for low, high in pairwise(ladder) if fails(high)), None)
    if found is None:
        return None
    low, high = found
    while abs(high - low) > relative * max(low, high):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    return math.sqrt(low * high)
