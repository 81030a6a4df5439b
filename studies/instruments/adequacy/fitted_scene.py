"""A scene with the modes and the mesh that a study needs.

A study states what its numbers rest on, e.g. the fold of the p_m orbit to 5 %; the modes and the mesh
that this takes (``adequacy.needed``), for the spring and the contact law as they stand in the scene, are
put where the scene leaves them open (modes.count = 0, spring.elements_per_leg = 0). What the user has
given stays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from studies.instruments.adequacy.asked import Asked
from studies.instruments.adequacy.memory import remembered
from studies.instruments.adequacy.model_choice import BEND_SHARE, Models, rungs_of
from studies.instruments.adequacy.needed import Needed
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import elements_of, spring_of

__all__ = ["Need", "fitted"]


LEAST_MESH = 2
"""Elements on a leg for each mode kept, about four a half wave: a study shows more of the modes than what it
rests on."""


USUAL_MESH = 60
"""Elements on a leg where none are asked for (``beam.default_elements``): a choice never goes beyond."""


@dataclass(frozen=True, kw_only=True)
class Need:
    """What a study rests on: a quantity and its tolerance, at the middle or at every drive frequency.

    A study that varies the number of modes itself, or hangs on the last digits of a frequency, needs the
    usual mesh: `mesh` is then false.
    """

    quantity: str
    tolerance: float
    everywhere: bool = False
    mesh: bool = True

    def asked(self, scene: Scene) -> list[Asked]:
        """The questions that it comes to."""
        frequencies = sorted(scene.drive.frequencies_hz)
        chosen = frequencies if self.everywhere else [frequencies[(len(frequencies) - 1) // 2]]
        return [Asked(quantity=self.quantity, frequency=frequency) for frequency in chosen]


def fitted(scene: Scene, needs: Sequence[Need], tell: Callable[[str], None]) -> tuple[Scene, str]:
    """The scene with modes and mesh for all `needs`, and in one line the model that runs and why.

    The line is empty where the user has given the modes, by their number or by their data.  Where the mesh
    that runs is another than the least, it says both.

    `tell` is called with a sentence when the choice is not known yet and has to be made.
    Where no model reaches a tolerance the sharpest is taken, and the line says what error remains.
    """
    if scene.modes.count or scene.spring.kind == "modal_data":
        return scene, ""
    rungs, laws, models = rungs_of(scene)[-1:], (scene.contact.law,), Models(scene)
    allowed: dict[str, Any] = {"rungs": rungs, "laws": laws, "residual": False}
    found: list[Needed] = [
        remembered(scene, asked, need.tolerance, models=models, tell=tell, **allowed)
        for need in needs
        for asked in need.asked(scene)
    ]
    most = max(found, key=lambda answer: (answer.choice.modes, answer.choice.mesh))
    mesh = max(answer.choice.mesh for answer in found) if all(need.mesh for need in needs) else 0
    mesh = max(mesh, LEAST_MESH * most.choice.modes) if 0 < mesh < USUAL_MESH else 0
    changes: dict[str, object] = {"modes.count": most.choice.modes}
    if mesh and not scene.spring.elements_per_leg:
        changes["spring.elements_per_leg"] = mesh
    if mesh and not scene.spring.elements_on_arc and scene.spring.kind == "folded_u":
        changes["spring.elements_on_arc"] = math.ceil(BEND_SHARE * mesh)
    scene = scene.replace(changes, provenance="needed")
    run, least = replace(most.choice, mesh=_elements_on_a_leg(scene)), most.sentence()
    line = least if run == most.choice else f"{run.words()}; for the accuracy required alone, {least}"
    return scene, f"model: {line}"


def _elements_on_a_leg(scene: Scene) -> int:
    """Elements on a leg of the mesh that the scene gets, given or by default."""
    if scene.spring.elements_per_leg:
        return scene.spring.elements_per_leg
    spring = spring_of(scene)
    pieces = zip(spring.centreline.pieces, elements_of(scene, spring), strict=True)
    straight = sum(count for piece, count in pieces if piece.curvature == 0.0)
    return straight // (2 if scene.spring.kind == "folded_u" else 1)
