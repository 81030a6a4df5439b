"""One choice on the ladder of models, and the oscillator that it stands for.

    Eq. (1)   Eq. (1) of the letter: one mode of measured period and decay rate, Newton's law with tau
    beam      the finite-element model of the spring, or its measured modes

A residual mode replaces those left out (``ModalModel.with_residual_mode``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from beam import ModalModel, reduce
from contact import ImpactOscillator
from studies.physics.least_model import LADDER, REFERENCE
from studies.shell.scene import Scene, beam_at, damping_of, model_of, modes_of, single_mode_at

IN_WORDS = {"newton": "Newton", "linear": "linear", "hertz": "Hertz", "hunt_crossley": "Hunt and Crossley"}
IN_WORDS["tsuji"] = "Tsuji"
LAWS = tuple(IN_WORDS)
MODES = (*LADDER, REFERENCE)
MESHES = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)
"""Elements on a leg."""

BEND_SHARE = 0.8
"""Elements on the bend for each one on a leg: the proportion of the default mesh."""


@dataclass(frozen=True, kw_only=True)
class Choice:
    """A model of the spring and its contact."""

    level: Annotated[str, "model level"]
    law: Annotated[str, "contact law"]
    modes: Annotated[int, "modes; without the residual one"] = 1
    mesh: Annotated[int, "elements on a leg; 0 without a mesh"] = 0
    residual: Annotated[bool, "a residual mode for those left out"] = False

    @property
    def words(self) -> str:
        """In a few words."""
        if self.level == EQ_1.level:
            return self.level
        mesh = f", {self.mesh} elements a leg" if self.mesh else ""
        more = " and a residual one" if self.residual else ""
        modes = f"{self.modes} mode{'s' if self.modes > 1 else ''}{more}"
        return f"{self.level}{mesh}, {modes}, {IN_WORDS[self.law]} contact"

    @property
    def cost(self) -> float:
        """Predicted time of a drive period on an orbit with impacts, and of the mesh in the same unit [µs].

        Contact and flight cost a fixed part and one proportional to the modes; the eigenvalue problem, some
        milliseconds for each element on a leg and paid once, is shared by as many periods as a diagram takes.
        """
        fixed, each = {"newton": (1.5, 0.3), "linear": (2.5, 0.4)}.get(self.law, (4.0, 0.6))
        return fixed + each * (self.modes + self.residual) + 0.06 * self.mesh


EQ_1 = Choice(level="Eq. (1)", law="newton")


class Models:
    """The models of one scene, and `sharp`, the reference; each mesh is solved once."""

    def __init__(self, scene: Scene) -> None:
        kind, radius = scene.spring.kind, scene.tip.ball_radius_m
        self.scene, self._solved = scene, dict[int, ModalModel]()
        modes = min(REFERENCE, len(scene.modal_data.frequencies_hz) or REFERENCE)
        mesh, law = 0 if kind == "modal_data" else MESHES[-1], scene.contact.law
        law = "hertz" if radius > 0 and law != LAWS[-1] else law
        self.sharp = Choice(level="beam", law=law, modes=modes, mesh=mesh)

    def oscillator(self, choice: Choice, frequency: float) -> ImpactOscillator:
        """The impact oscillator of a choice at drive `frequency` [Hz].

        ValueError if the mesh is too coarse for the modes, these leave no residual, or the drive is above
        them all.
        """
        if choice.level == EQ_1.level:
            return single_mode_at(self.scene, frequency)
        mesh = choice.mesh
        if mesh not in self._solved or self._solved[mesh].n_modes < choice.modes:
            self._solved[mesh] = self._spring(mesh, choice.modes)
        model = self._solved[mesh].truncated(choice.modes)
        model = model.with_residual_mode() if choice.residual else model
        return beam_at(self.scene.replace({"contact.law": choice.law}), frequency, model)

    def _spring(self, mesh: int, modes: int) -> ModalModel:
        """The spring of the scene itself."""
        bend = math.ceil(BEND_SHARE * mesh)
        changes = {"spring.elements_per_leg": mesh, "spring.elements_on_arc": bend, "modes.count": modes}
        scene = self.scene.replace(changes)
        return reduce(modes_of(scene), damping_of(scene), modes) if mesh else model_of(scene)
