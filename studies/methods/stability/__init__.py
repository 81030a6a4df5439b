"""The families of the study, the one row of all of them, and the search for a limit.

A family is a file with the function ``measure(scene, quick) -> Findings``. One that leaves arrays also has
``draw(arrays) -> (figure, caption)``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from types import ModuleType
from typing import Annotated

import numpy as np

from contact.integrators import GeneralisedAlpha, Integrator
from studies.shell.scene import Scene

FAMILIES = (
    "explicit",
    "splitting",
    "implicit_energy",
    "false_restitution",
    "missed_crossings",
    "accumulation",
)
"""In the order of the table."""

IMPLICIT: Mapping[str, Callable[[float], Integrator]] = {
    "trapezoidal rule": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, α = 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "HHT, α = 0.3": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.3),
    "gen.-α, ρ = 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "gen.-α, ρ = 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
"""The implicit methods that take the stop as a spring, for a step [s]."""


@dataclass(frozen=True, kw_only=True)
class Limit:
    """One quantity of one method: what theory gives for it and what was found."""

    family: Annotated[str, "family of failures; as in the option families"]
    method: Annotated[str, "method"]
    case: Annotated[str, "case"]
    parameter: Annotated[str, "what is limited or measured"]
    unit: Annotated[str, "unit of theory and measurement"] = "1"
    theory: Annotated[float | None, "theory; none where it gives no number"]
    measured: Annotated[float | None, "measured; none where the failure did not appear"]
    refused: Annotated[bool | None, "refused just beyond; none if there is nothing to refuse"] = None


Findings = tuple[Sequence[Limit], Mapping[str, np.ndarray]]
"""The rows of a family, and the arrays that its figure is drawn from; without arrays it has none."""


def family(name: str) -> ModuleType:
    """The file of a family."""
    return import_module(f"{__name__}.{name}")


def findings(name: str, scene: Scene, quick: bool) -> Findings:
    """What a family finds."""
    found: Findings = family(name).measure(scene, quick)
    return found


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
