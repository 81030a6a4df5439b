"""The born period over what the letter's Fig. 5 leaves open.

A cell is a mass of ball and mount (with the thickness that keeps T, and the gap kept), a factor on the
damping of the modes above the first, and a restitution of the contact.  Cells with period 6 are tried by what
they ask for: contact elastic, damping as the strips', the nearest mass.  Beside the map: the born period at
the ends of the letter's errors of T and mu.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from beam import ModalModel
from contact.errors import ContactError
from studies.instruments.breakdown.beam_of_fig_5 import (
    DECAY_RATE_PER_S,
    FREE_PERIOD_S,
    born,
    driven,
    fold_of_p3,
    tuned,
)
from studies.instruments.breakdown.plan import Plan
from studies.instruments.scene import Scene
from studies.published import BREAKDOWN

__all__ = ["candidates", "search", "within_errors"]


def search(
    scene: Scene, plan: Plan, pool: ThreadPoolExecutor, tell: Callable[[], None]
) -> tuple[list[dict[str, Any]], dict[float, ModalModel]]:
    """The born period in every cell of mass, factor on the higher modes' damping, local restitution."""

    def of_mass(mass: float) -> ModalModel:
        model = tuned(scene, FREE_PERIOD_S, mass=mass)
        tell()
        return model

    models = dict(zip(plan.masses, pool.map(of_mass, plan.masses), strict=True))

    def cell(numbers: tuple[float, float, float]) -> dict[str, Any]:
        mass, factor, local = numbers
        strobed = driven(scene, models[mass], factor=factor, local_restitution=local)
        found: dict[str, Any] = {
            "tip_mass_kg": mass,
            "higher_damping": factor,
            "local_restitution": local,
            "period": None,
            "impacts": None,
        }
        try:
            found["period"], found["impacts"] = born(strobed)
            if found["period"] == BREAKDOWN["born_period"]:
                found["fold_p3"] = fold_of_p3(strobed)
        except ContactError as error:
            found["failure"] = str(error)
        tell()
        return found

    numbers = [(m, k, e) for e in plan.local for m in plan.masses for k in plan.factors]
    return list(pool.map(cell, numbers)), models


def candidates(cells: Sequence[Mapping[str, Any]], scene: Scene) -> list[Mapping[str, Any]]:
    """The cells with period 6, by what they ask for: elastic, damping as the strips', the nearest mass."""

    def asks(cell: Mapping[str, Any]) -> tuple[float, float, float]:
        return (
            -cell["local_restitution"],
            abs(math.log(cell["higher_damping"])),
            abs(math.log(cell["tip_mass_kg"] / scene.tip.mass_kg)),
        )

    return sorted((cell for cell in cells if cell["period"] == BREAKDOWN["born_period"]), key=asks)


def within_errors(scene: Scene, pool: ThreadPoolExecutor) -> list[dict[str, Any]]:
    """The born period at the ends of the letter's errors of T and mu, all else as calibrated."""

    def one(numbers: tuple[float, float]) -> dict[str, Any]:
        more, rate = numbers
        here = scene.replace({"damping.decay_rate_per_s": DECAY_RATE_PER_S + rate})
        period, impacts = born(driven(here, tuned(here, FREE_PERIOD_S + more)))
        return {
            "free_period_s": FREE_PERIOD_S + more,
            "decay_rate_per_s": DECAY_RATE_PER_S + rate,
            "period": period,
            "impacts": impacts,
        }

    t, c = float(BREAKDOWN["free_period_error_s"]), float(BREAKDOWN["decay_rate_error_per_s"])
    return list(pool.map(one, [(-t, 0.0), (t, 0.0), (0.0, -c), (0.0, c)]))
