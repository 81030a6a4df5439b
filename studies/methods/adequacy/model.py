"""The models that may be enough, the quantities that they are to give, and the search for the least one.

    Eq. (1)   Eq. (1) of the letter: one mode of measured period and decay rate, Newton's law with tau
    beam      the finite-element model of the spring, or its measured modes

A residual mode replaces the modes left out (``ModalModel.with_residual_mode``).  Quantities and errors are
as in ``studies.physics.least_model``, at one drive frequency each, with three differences:

    delay            of the three collisions over v/a, the time in which the tip would turn by itself;
                     absolute
    born_period      period of the settled orbit at excess 1e-3, at the drive frequency and at both ends of
                     what the error of the free period (letter, Fig. 2) makes of it; error: how many differ
    fold             by shooting

A model without an answer (no such mode, no return of the single mode, no orbit) is infinitely far off.
"""

import math
from bisect import bisect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from beam import ModalModel, reduce
from contact import ImpactOscillator, StroboscopicMap
from contact.orbits import fold_excess, onset_m
from studies import letter
from studies.physics import least_model
from studies.physics.least_model import REFERENCE, Answer, At, largest_error
from studies.shell.scene import Scene, approach_speed, beam_at, damping_of, model_of, modes_of, single_mode_at

IN_WORDS = {"newton": "Newton", "linear": "linear", "hertz": "Hertz", "hunt_crossley": "Hunt and Crossley"}
IN_WORDS["tsuji"] = "Tsuji"
LAWS = tuple(IN_WORDS)
MODES = (*least_model.LADDER, REFERENCE)
MESHES = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)  # elements on a leg

BEND_SHARE = 0.8  # elements on the bend for each one on a leg: the proportion of the default mesh


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


MESH_ORDER = 4  # of frequencies and shapes, with cubic Hermite elements


def _delays(at: At, frequency: float) -> Answer:
    found, gap = least_model.collisions("delay", at, frequency), at(frequency).stop.gap
    speeds = np.array([approach_speed(frequency, gap, excess) for excess in least_model.COLLISIONS])
    return None if found is None else found * (2.0 * math.pi * frequency) ** 2 * gap / speeds


def _born_periods(at: At, frequency: float) -> Answer:
    error = letter.FREE_PERIOD_ERROR_S / letter.FREE_PERIOD_S
    drives = [frequency * (1.0 + shift) for shift in (-error, 0.0, error)]
    return np.array([float(onset_m(StroboscopicMap(oscillator=at(drive)))) for drive in drives])


_SHARED = {name: found[:2] for name, found in least_model.QUANTITIES.items()}
QUANTITIES: Mapping[str, tuple[least_model.AnswerOf, least_model.Distance, str, float]] = {
    "frequency": (lambda at, f: at(f).model.frequencies_hz, least_model.relative_error, "relative", 1e-3),
    "restitution": (*_SHARED["restitution"], "1", 1e-2),
    "delay": (_delays, largest_error, "v/a", 2e-2),
    "kick": (*_SHARED["kick"], "1", 1e-2),
    "born_period": (_born_periods, lambda a, b: float(np.count_nonzero(a != b)), "differing periods", 0.0),
    "fold": (partial(least_model.fold_of_born, fold_excess), least_model.error_of_fold, "relative", 2e-2),
    "tip_trace": (*_SHARED["tip_trace"], "gap", 1e-2),
}
"""Name -> answer, distance of two answers, its unit, usual tolerance."""


@dataclass(frozen=True, kw_only=True)
class LeastModel(Choice):
    """The least model for a question, or the reference where none is good enough."""

    quantity: Annotated[str, "quantity"]
    frequency_hz: float
    unit: Annotated[str, "what errors are relative to; 1: absolute"]
    tolerance: Annotated[float, "tolerance"]
    reached: Annotated[bool, "whether a model is within the tolerance; if not, the row is of the reference"]
    error: Annotated[float, "error; with that of the reference; none where the reference has no answer"]
    error_one_less: Annotated[float | None, "error of the best model a step smaller; without the reference's"]
    parts: Annotated[Mapping[str, float], "part of the error; what this simplification changes alone"]
    least: Annotated[str, "least model"]


class Search:
    """One question to the models of one scene; each answer is computed once.

    `quantity` is a key of `QUANTITIES`, "frequency" followed by the number of the mode; `frequency` that of
    the drive [Hz]; `sharp` the reference, that of the models by default.
    """

    def __init__(self, models: Models, quantity: str, frequency: float, sharp: Choice | None = None) -> None:
        name, _, number = quantity.partition(" ")
        self.models, self.quantity, self.frequency = models, quantity, frequency
        answer_of, distance, self.unit, self.tolerance = QUANTITIES[name]
        self.sharp = sharp or models.sharp

        def answer(choice: Choice) -> Answer:
            found = answer_of(lambda f: models.oscillator(choice, f), frequency)
            if not number or found is None:
                return found
            return found[int(number) - 1 : int(number)] if int(number) <= choice.modes else None

        self.between = least_model.distances(answer, distance)

    def off(self, choice: Choice) -> float:
        """Distance of a model's answer from the reference's; infinite without an answer."""
        return self.between(self.sharp, choice)

    def own_error(self) -> float:
        """Of the reference: what one step less in modes changes, and what is left of what one in mesh does.

        The error of the mesh falls with the fourth power of the element length, so that of two meshes the
        finer has 1/(r^4 - 1) of their difference, r the ratio of their elements.
        """
        own = sum(self.off(replace(self.sharp, modes=n)) for n in _below(MODES, self.sharp.modes)[-1:])
        for mesh in _below(MESHES, self.sharp.mesh)[-1:]:
            own += self.off(replace(self.sharp, mesh=mesh)) / ((self.sharp.mesh / mesh) ** MESH_ORDER - 1.0)
        return own

    def parts(self, choice: Choice) -> dict[str, float]:
        """What one thing changes, all others as in the reference (the mesh: with the choice's modes)."""
        sharp, found = self.sharp, dict[str, float]()
        if choice == EQ_1:
            return {"one_mode": self.off(choice)}
        if choice.law != sharp.law:
            found["contact_law"] = self.off(replace(sharp, law=choice.law))
        if choice.modes < sharp.modes:
            found["fewer_modes"] = self.off(replace(sharp, modes=choice.modes, residual=choice.residual))
        if choice.mesh < sharp.mesh:
            found["coarser_mesh"] = self.between(replace(choice, mesh=sharp.mesh), choice)
        return found

    def error(self, choice: Choice) -> float:
        """The largest of distance and parts, so that errors that happen to cancel get no credit."""
        direct = self.off(choice)
        return max([direct, *self.parts(choice).values()]) if math.isfinite(direct) else direct

    def smaller(self, choice: Choice) -> Iterator[Choice]:
        """The models one step smaller in one thing: level, law, residual mode, modes or mesh."""
        if choice == EQ_1:
            return
        yield EQ_1
        yield from (replace(choice, law=law) for law in LAWS[: LAWS.index(choice.law)][-1:])
        yield from [replace(choice, residual=False)] if choice.residual else []
        yield from (replace(choice, modes=modes) for modes in _below(MODES, choice.modes)[-1:])
        yield from (replace(choice, mesh=mesh) for mesh in _below(MESHES, choice.mesh)[-1:])

    def least(self, tolerance: float) -> LeastModel:
        """The cheapest model whose error and that of the reference stay within the tolerance."""
        own, laws = self.own_error(), LAWS[: LAWS.index(self.sharp.law) + 1]

        def enough(choice: Choice) -> bool:
            return self.error(choice) <= tolerance - own

        corners = [replace(self.sharp, law=law) for law in laws]
        found = [one for corner in corners if enough(corner) for one in self._below_corner(corner, enough)]
        found += [EQ_1] if enough(EQ_1) else []
        reached, choice = bool(found), self.sharp
        while found:
            choice = min(found, key=lambda one: one.cost)
            found = [one for one in self.smaller(choice) if enough(one)]
        error = self.error(choice) + own
        return LeastModel(
            **asdict(choice),
            quantity=self.quantity.replace("frequency ", "frequency of mode ").replace("_", " "),
            frequency_hz=self.frequency,
            unit=self.unit,
            tolerance=tolerance,
            reached=reached,
            error=error,
            error_one_less=min(map(self.error, self.smaller(choice)), default=None),
            parts={**self.parts(choice), "reference": own},
            least=choice.words if math.isfinite(error) else "none",
        )

    def _below_corner(self, corner: Choice, enough: Callable[[Choice], bool]) -> Iterator[Choice]:
        """Few modes and a coarse mesh below `corner`, which is enough; then fewer and a residual one."""
        meshes, most = [mesh for mesh in MESHES if mesh <= corner.mesh] or [corner.mesh], corner.modes
        for residual in (False, True):
            ladder = [replace(corner, modes=n, residual=residual) for n in MODES if n <= most]
            few = first(ladder, enough)
            if enough(few):
                yield first([replace(few, mesh=mesh) for mesh in meshes], enough)
            most = few.modes


def _below(steps: Sequence[int], value: int) -> list[int]:
    return [step for step in steps if step < value]


def first(rising: Sequence[Choice], enough: Callable[[Choice], bool]) -> Choice:
    """The first that is enough, by bisection; the last one counts as enough."""
    return rising[bisect(range(len(rising) - 1), False, key=lambda place: enough(rising[place]))]
