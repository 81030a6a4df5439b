"""The cheapest model that answers a question well enough, and how far off it is and why.

The reference is the sharpest model of the ladder: top rung, finest mesh, `SHARP_MODES` modes, the scene's
own contact law or Hertz's. Its own error follows from one step less in modes and in mesh. Each pair
of a rung and a law is tried with mesh and modes sharp; where that is within the tolerance, the fewest modes
and then the coarsest mesh are found by bisection. Among the pairs the one of least predicted cost is taken,
and taken down further as long as one step less of anything is still within the tolerance: so the choice
meets it, and nothing one step smaller does. Errors that cancel get no credit: the error of a model is the
largest of its distance from the reference and of each of the parts below.

The parts of the error, each the change of the answer when that one thing is as in the choice and all others
are sharp,

    rung, law, modes, mesh, reference

say what remains to be done where no model is good enough.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from studies.instruments.adequacy.asked import Answer, Asked
from studies.instruments.adequacy.model_choice import LAWS, MESHES, MODES, ModelChoice, Models, rungs_of
from studies.instruments.scene import Scene

__all__ = ["Needed", "Search", "needed"]

SHARP_MODES = 40
SHARP_MESH = 96
MESH_ORDER = 4
"""Of frequencies and shapes, with cubic Hermite elements."""


@dataclass(frozen=True, kw_only=True)
class Needed:
    """The answer.

    Parameters
    ----------
    asked : Asked
    tolerance : float
        In the unit of the quantity's error.
    choice : ModelChoice
        The cheapest that is good enough; the best there is, if none is.
    reached : bool
        Whether it is good enough.
    error : float
        Its error (``Search.error``) plus the reference's own.
    sources : mapping of str to float
        What making one thing sharp changes.
    cost : float
        Predicted time of a drive period [us].
    """

    asked: Asked
    tolerance: float
    choice: ModelChoice
    reached: bool
    error: float
    sources: Mapping[str, float] = field(default_factory=dict)
    cost: float = math.nan

    def sentence(self) -> str:
        """In one line: what was chosen and why."""
        asked = self.asked
        wanted = f"{asked.quantity} at {asked.frequency:g} Hz to {self.tolerance:g} ({asked.unit})"
        if self.reached:
            return f"{self.choice.words()}: the least that gives {wanted}; error {self.error:.1e}"
        worst = max(self.sources, key=lambda name: self.sources[name]) if self.sources else "reference"
        return (
            f"no model gives {wanted}; the best, {self.choice.words()}, is off by {self.error:.1e}, "
            f"of which {worst} leaves {self.sources.get(worst, math.nan):.1e}"
        )


class Search:
    """Answers of one scene to one question, each computed once."""

    def __init__(
        self,
        scene: Scene,
        asked: Asked,
        models: Models | None = None,
        law: str | None = None,
        sharp: ModelChoice | None = None,
    ) -> None:
        self.scene, self.asked = scene, asked
        self.models = Models(scene) if models is None else models
        self.rungs = rungs_of(scene)
        self._answers: dict[ModelChoice, Answer] = {}
        top = self.rungs[-1]
        law = law or ("hertz" if scene.tip.ball_radius_m > 0 else scene.contact.law)
        most = len(scene.modal_data.frequencies_hz) if top == "modal_data" else SHARP_MODES
        self.sharp = sharp or ModelChoice(
            rung=top, law=law, modes=min(SHARP_MODES, most), mesh=0 if top == "modal_data" else SHARP_MESH
        )

    def answer(self, choice: ModelChoice) -> Answer:
        """The answer of a model."""
        if choice not in self._answers:
            self._answers[choice] = self.asked.answer(self.models, choice)
        return self._answers[choice]

    def off(self, choice: ModelChoice, reference: ModelChoice | None = None) -> float:
        """Distance of a model from the sharp one, or from another."""
        return self.asked.error(self.answer(choice), self.answer(reference or self.sharp))

    @property
    def tried(self) -> Mapping[ModelChoice, float]:
        """Every model answered so far, with its distance from the sharp one."""
        return {choice: self.off(choice) for choice in list(self._answers)}

    def own_error(self) -> float:
        """Of the reference: what one step less in modes changes, and what is left of what one in mesh does.

        The error of the mesh falls with the fourth power of the element length, so that of two meshes the
        finer has 1/(r^4 - 1) of their difference, r the ratio of their elements.
        """
        fewer = [n for n in MODES if n < self.sharp.modes][-1:]
        coarser = [m for m in MESHES if m < self.sharp.mesh][-1:]
        own = sum(self.off(replace(self.sharp, modes=n)) for n in fewer)
        for mesh in coarser:
            finer = (self.sharp.mesh / mesh) ** MESH_ORDER - 1.0
            own += self.off(replace(self.sharp, mesh=mesh)) / finer
        return own

    def smaller(self, choice: ModelChoice) -> list[ModelChoice]:
        """The models one step smaller in one thing: rung, law, modes or mesh."""
        if choice.rung == "single_mode":
            return []
        steps = []
        place = self.rungs.index(choice.rung)
        if place == 1:
            steps.append(ModelChoice(rung="single_mode", law="newton"))
        elif place > 1:
            steps.append(replace(choice, rung=self.rungs[place - 1]))
        if choice.law in LAWS[1:]:
            steps.append(replace(choice, law=LAWS[LAWS.index(choice.law) - 1]))
        if choice.residual:
            steps.append(replace(choice, residual=False))
        fewer = [n for n in MODES if n < choice.modes]
        if fewer:
            steps.append(replace(choice, modes=fewer[-1]))
        coarser = [m for m in MESHES if m < choice.mesh]
        if coarser:
            steps.append(replace(choice, mesh=coarser[-1]))
        return steps

    def error(self, choice: ModelChoice) -> float:
        """The largest of the distance from the sharp model and of what each thing that is not sharp changes.

        So errors that happen to cancel get no credit.
        """
        direct = self.off(choice)
        if not math.isfinite(direct) or choice.rung == "single_mode":
            return direct
        return max(direct, *(self._part(choice, name) for name in ("rung", "law", "modes", "mesh")))

    def _part(self, choice: ModelChoice, name: str) -> float:
        """What one thing changes when all others are sharp (the mesh: at the modes of the choice)."""
        sharp = self.sharp
        if name == "rung":
            return self.off(replace(sharp, rung=choice.rung)) if choice.rung != sharp.rung else 0.0
        if name == "law":
            return self.off(replace(sharp, law=choice.law)) if choice.law != sharp.law else 0.0
        if name == "modes":
            fewer = replace(sharp, modes=choice.modes, residual=choice.residual)
            return self.off(fewer) if choice.modes < sharp.modes else 0.0
        return self.off(choice, replace(choice, mesh=sharp.mesh)) if choice.mesh < sharp.mesh else 0.0

    def sources(self, choice: ModelChoice) -> dict[str, float]:
        """What each thing that is not sharp in `choice` changes when all others are sharp."""
        own = {"reference": self.own_error()}
        if choice.rung == "single_mode":
            return {"rung": self.off(choice), **own}
        parts = {name: self._part(choice, name) for name in ("rung", "law", "modes", "mesh")}
        return {name: part for name, part in parts.items() if part > 0.0} | own


def _least(values: list[int], enough: Callable[[int], bool]) -> int:
    """The smallest of rising `values` that is enough, by bisection; the last one is known to be."""
    low, high = -1, len(values) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if enough(values[middle]):
            high = middle
        else:
            low = middle
    return values[high]


def _descend(search: Search, corner: ModelChoice, allowed: float, residual: bool) -> ModelChoice:
    """A small mesh and few modes below `corner` whose error stays within `allowed`."""

    def enough(choice: ModelChoice) -> bool:
        return search.error(choice) <= allowed

    numbers = [n for n in MODES if n < corner.modes] + [corner.modes]
    modes = _least(numbers, lambda n: enough(replace(corner, modes=n)))
    found = [replace(corner, modes=modes)]
    if residual:
        # one residual mode may stand for several others
        few = [n for n in numbers if n < modes] + [modes]
        fewer = _least(few, lambda n: enough(replace(corner, modes=n, residual=True)))
        if fewer < modes - 1:
            found.append(replace(corner, modes=fewer, residual=True))
    # a few modes more than the fewest may do with a coarser mesh
    found += [replace(corner, modes=n) for n in numbers if n > modes][:1]
    meshes = [m for m in MESHES if m < corner.mesh] + [corner.mesh]
    coarse = [
        replace(one, mesh=_least(meshes, lambda m, one=one: enough(replace(one, mesh=m))))  # type: ignore[misc]
        for one in found
    ]
    return min(coarse, key=lambda one: one.cost())


def needed(
    scene: Scene,
    asked: Asked,
    tolerance: float,
    *,
    rungs: Sequence[str] | None = None,
    laws: Sequence[str] | None = None,
    residual: bool = True,
    search: Search | None = None,
) -> Needed:
    """The cheapest model of `scene` that answers `asked` to `tolerance`.

    Parameters
    ----------
    scene : Scene
    asked : Asked
        Quantity and drive frequency.
    tolerance : float
        In the unit of the quantity's error; for the born period the number of differing periods, so 0.
    rungs, laws : sequences of str, optional
        The rungs and laws that may be chosen, coarsest first; all by default.  The last law is that of the
        reference.
    residual : bool
        Whether a residual mode may be chosen.
    search : Search, optional
        With the answers found already.
    """
    if not (math.isfinite(tolerance) and tolerance >= 0):
        raise ValueError(f"tolerance is {tolerance} ({asked.unit}); it must be finite and zero or more")
    if search is None:
        search = Search(scene, asked, law=laws[-1] if laws else None)
    own = search.own_error()
    allowed = tolerance - own
    candidates: list[ModelChoice] = []
    for rung in search.rungs:
        if rungs is not None and rung not in rungs:
            continue
        if rung == "single_mode":
            single = ModelChoice(rung="single_mode", law="newton")
            if search.error(single) <= allowed:
                candidates.append(single)
            continue
        for law in LAWS[: LAWS.index(search.sharp.law) + 1]:
            corner = replace(search.sharp, rung=rung, law=law)
            if (laws is None or law in laws) and search.error(corner) <= allowed:
                candidates.append(_descend(search, corner, allowed, residual))
    if not candidates:
        # nothing is within the tolerance: the reference itself, and what of its error is left
        best = search.sharp
        return Needed(
            asked=asked, tolerance=tolerance, choice=best, reached=False, error=own,
            sources=search.sources(best), cost=best.cost(),
        )  # fmt: skip
    choice = min(candidates, key=lambda candidate: candidate.cost())
    while True:
        less = [
            step
            for step in search.smaller(choice)
            if (rungs is None or step.rung in rungs)
            and (laws is None or step.law in laws)
            and search.error(step) <= allowed
        ]
        if not less:
            break
        choice = min(less, key=lambda step: step.cost())
    return Needed(
        asked=asked, tolerance=tolerance, choice=choice, reached=True, error=search.error(choice) + own,
        sources=search.sources(choice), cost=choice.cost(),
    )  # fmt: skip
