"""One choice on the ladder of models: rung, mesh, modes, residual mode, contact law.

    single_mode   Eq. (1) of the letter: one mode of measured period and decay rate, Newton's law with tau
    straight      the guided leg that has the sway stiffness of the folded U (``beam.straight_equivalent``),
                  or the straight spring itself
    folded_u      the arc-length model of the whole U
    modal_data    modes that were measured

On each rung but the first: elements on a leg (four fifths of that on the bend), number of modes, whether one
residual mode stands for the modes left out (``ModalModel.with_residual_mode``), and the contact law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from beam import ModalModel, as_one_spring, assemble, natural_modes, reduce, straight_equivalent
from contact.drive import HarmonicDrive
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from studies.instruments.oscillators import contact_law_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import damping_of, model_of, single_mode_of, spring_of

__all__ = ["LAWS", "MESHES", "MODES", "RUNGS", "Models", "ModelChoice", "rungs_of"]

Rung = Literal["single_mode", "straight", "folded_u", "modal_data"]

RUNGS: tuple[Rung, ...] = ("single_mode", "straight", "folded_u", "modal_data")
MESHES = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)
"""Elements on a leg."""

MODES = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 21, 25, 30, 40)
LAWS = ("newton", "linear", "hertz")

BEND_SHARE = 0.8
"""Elements on the bend for each one on a leg: the proportion of the default mesh."""


@dataclass(frozen=True, kw_only=True)
class ModelChoice:
    """A model of the spring and its contact.

    Parameters
    ----------
    rung : str
        One of `RUNGS`.
    law : str
        One of `LAWS`.
    modes : int
        Modes kept, the residual one not counted.
    mesh : int
        Elements on a leg; 0 where nothing is meshed.
    residual : bool
        One mode more, for those left out.
    """

    rung: Rung
    law: str
    modes: int = 1
    mesh: int = 0
    residual: bool = False

    def words(self) -> str:
        """In a few words."""
        if self.rung == "single_mode":
            return "Eq. (1)"
        shapes = {"straight": "straight leg", "folded_u": "folded U", "modal_data": "measured modes"}
        mesh = f", {self.mesh} elements a leg" if self.mesh else ""
        more = " and a residual one" if self.residual else ""
        modes = f"{self.modes} mode{'s' if self.modes > 1 else ''}"
        return f"{shapes[self.rung]}{mesh}, {modes}{more}, {self.law} contact"

    def sharper(self, factor: int) -> ModelChoice:
        """`factor` times the modes and the mesh, no residual mode."""
        return replace(self, modes=factor * self.modes, mesh=factor * self.mesh, residual=False)

    def cost(self) -> float:
        """Predicted time of a drive period on an orbit with impacts, and of the mesh in the same unit [us].

        Contact and flight cost a fixed part and one proportional to the modes; the eigenvalue problem, some
        milliseconds for each element on a leg and paid once, is shared by as many periods as a diagram takes.
        """
        fixed, each = {"newton": (1.5, 0.3), "linear": (2.5, 0.4), "hertz": (4.0, 0.6)}[self.law]
        return fixed + each * (self.modes + self.residual) + 0.06 * self.mesh


def rungs_of(scene: Scene) -> tuple[Rung, ...]:
    """The rungs that a scene has, coarsest first."""
    kind = scene.spring.kind
    if kind == "folded_u":
        return ("single_mode", "straight", "folded_u")
    return ("single_mode", "modal_data" if kind == "modal_data" else "straight")


class Models:
    """The models of one scene; each mesh is solved once, for all its modes that may be asked for."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._solved: dict[tuple[str, int], ModalModel] = {}

    def _whole(self, rung: Rung, mesh: int, modes: int) -> ModalModel | None:
        """A model of at least `modes` modes, None if the mesh has not that many."""
        known = self._solved.get((rung, mesh))
        if known is not None and known.n_modes >= modes:
            return known
        if rung == "modal_data":
            known = model_of(self.scene.replace({"modes.count": 500}))
        else:
            spring = spring_of(self.scene)
            straight = rung == "straight" and self.scene.spring.kind == "folded_u"
            if straight:
                spring = straight_equivalent(spring)
            lengths = [p.length for p in spring.centreline.pieces if p.curvature == 0.0]
            leg = sum(lengths) / (2 if rung == "folded_u" else 1)
            elements = [
                max(1, math.ceil(mesh * p.length / leg - 1e-9)) if p.curvature == 0.0
                else max(2, math.ceil(BEND_SHARE * mesh))
                for p in spring.centreline.pieces
            ]  # fmt: skip
            discretization = assemble(spring, elements)
            asked = min(discretization.n_dofs, (2 if rung == "folded_u" else 1) * max(modes, 16) + 1)
            solved = natural_modes(discretization, asked)
            known = reduce(solved, damping_of(self.scene))
            while known.n_modes < modes and asked < discretization.n_dofs:
                asked = min(2 * asked, discretization.n_dofs)
                known = reduce(natural_modes(discretization, asked), damping_of(self.scene))
            known = as_one_spring(known) if straight else known
        self._solved[rung, mesh] = known
        return known if known.n_modes >= modes else None

    def model(self, choice: ModelChoice) -> ModalModel | None:
        """The modal model of a choice, None if its mesh is too coarse for its modes or leaves no residual."""
        if choice.rung == "single_mode":
            return single_mode_of(self.scene)
        whole = self._whole(choice.rung, choice.mesh, choice.modes)
        if whole is None:
            return None
        kept = whole.truncated(choice.modes)
        if not choice.residual:
            return kept
        try:
            return kept.with_residual_mode()
        except ValueError:
            return None

    def oscillator(self, choice: ModelChoice, frequency: float) -> ImpactOscillator | None:
        """The impact oscillator of a choice at drive `frequency` [Hz].

        None as for `model`, or if the drive is faster than its highest mode.
        """
        if choice.rung == "single_mode":
            return single_mode_oscillator(self.scene, frequency)
        model = self.model(choice)
        if model is None or model.frequencies_hz.max() < frequency:
            return None
        scene = self.scene.replace({"contact.law": choice.law})
        return ImpactOscillator(
            model=model,
            stop=Stop(gap=scene.stop.gap_m, law=contact_law_of(scene)),
            drive=HarmonicDrive(frequency=frequency),
        )
