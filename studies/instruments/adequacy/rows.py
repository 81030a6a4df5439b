"""One row of the adequacy study: the choice, what it is worth against a larger model, what less would give.

    error_estimate   error of the choice against the sharp model, plus that model's own
    error_measured   error against a model with four times the modes and the mesh, on the top rung, with the
                     sharpest law; as everywhere without credit for errors that cancel (``Search.error``)
    error_one_less   the smallest such error among all choices one step smaller in one thing: rung, law,
                     residual mode, modes or mesh; None where there is no smaller choice
    cost_ratio       time of the larger model's answer over that of the choice, each with its mesh solved
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import asdict, replace
from statistics import median
from typing import Any

from studies.instruments.adequacy.asked import Asked
from studies.instruments.adequacy.model_choice import ModelChoice
from studies.instruments.adequacy.needed import Needed, Search, needed
from studies.instruments.scene import Scene

__all__ = ["larger", "measured_row"]

MOST_MODES = 100
MOST_ELEMENTS = 250
"""Beyond these on a leg the rounding of the stiffness matrix exceeds what is asked for."""


def larger(search: Search, choice: ModelChoice) -> ModelChoice:
    """Four times the modes and the mesh of `choice`, never less than the sharp model."""
    sharp = search.sharp
    if choice.rung == "single_mode":
        choice = replace(sharp, modes=1, mesh=0)
    most = sharp.modes if sharp.rung == "modal_data" else MOST_MODES
    return replace(
        sharp,
        modes=min(most, max(sharp.modes, 4 * choice.modes)),
        mesh=min(MOST_ELEMENTS, max(sharp.mesh, 4 * choice.mesh)) if sharp.mesh else 0,
    )


def _seconds(scene: Scene, asked: Asked, choice: ModelChoice, repeats: int) -> float:
    """Time of one answer, mesh included: the median of `repeats`."""
    spent = []
    for _ in range(repeats):
        search = Search(scene, asked)
        began = time.perf_counter()
        search.answer(choice)
        spent.append(time.perf_counter() - began)
    return median(spent)


def measured_row(
    scene: Scene, asked: Asked, tolerance: float, repeats: int = 3
) -> tuple[dict[str, Any], Needed, Mapping[ModelChoice, float]]:
    """The row, the choice, and every model tried with its error."""
    search = Search(scene, asked)
    found = needed(scene, asked, tolerance, search=search)
    tried = dict(search.tried)
    check = larger(search, found.choice)
    against = Search(scene, asked, models=search.models, sharp=check)
    smaller = {step: against.error(step) for step in search.smaller(found.choice)}
    one_less = min(smaller, key=lambda step: smaller[step]) if smaller else None
    error_less = None if one_less is None else smaller[one_less]
    ratio = _seconds(scene, asked, check, repeats) / max(_seconds(scene, asked, found.choice, repeats), 1e-6)
    row = {
        "quantity": asked.quantity,
        "frequency_hz": asked.frequency,
        "unit": asked.unit,
        "tolerance": tolerance,
        "chosen": asdict(found.choice),
        "words": found.choice.words(),
        "reached": found.reached,
        "sentence": found.sentence(),
        "sources": {name: _number(part) for name, part in found.sources.items()},
        "predicted_us_per_period": found.cost,
        "error_estimate": _number(found.error),
        "error_measured": _number(against.error(found.choice)),
        "error_one_less": None if error_less is None else _number(error_less),
        "one_less": None if one_less is None else one_less.words(),
        "no_answer_with_one_less": error_less is not None and not math.isfinite(error_less),
        "checked_against": check.words(),
        "cost_ratio": ratio,
    }
    return row, found, tried


def _number(value: float) -> float | None:
    """A number of JSON: a model without an answer is infinitely far off, which JSON cannot say."""
    return value if math.isfinite(value) else None
