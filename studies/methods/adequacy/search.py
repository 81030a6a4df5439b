"""Questions to a model, the distance of two answers, and the least model whose answer is near enough.

    frequency K      K-th frequency of the modes that move the ball [Hz]; error relative
    restitution      of the first collision at excess 0.0065, 0.013 and 0.026 [1]; error absolute
    delay            of these collisions over v/a, the time in which the tip would turn by itself; absolute
    kick             of these collisions [1]; error absolute
    born_period      period of the settled orbit at excess 1e-3, at the drive frequency and at both ends of
                     what the error of the free period (letter, Fig. 2) makes of it; error: how many differ
    fold             F/F_g - 1 at which the p_m orbit has its fold, by shooting; error relative to it, or to
                     the letter's amplitude stability where it is smaller; infinite if m differs
    tip_trace        tip over one period of the orbit settled at excess 0.013; error: root mean square
                     over the gap

A model that has no answer (no such mode, no return of the single mode, no orbit) is infinitely far off.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from contact import StroboscopicMap
from contact.orbits import born_period, fold_excess
from studies import letter
from studies.methods.adequacy.models import EQ_1, LAWS, MESHES, MODES, Choice, Models
from studies.physics import least_model
from studies.physics.least_model import (
    COLLISIONS,
    Answer,
    Ask,
    At,
    Distance,
    collisions,
    distances,
    error_of_fold,
    fold_of_born,
    largest_error,
)
from studies.shell.scene import approach_speed

MESH_ORDER = 4
"""Of frequencies and shapes, with cubic Hermite elements."""


def _delays(at: At, frequency: float) -> Answer:
    found, gap = collisions("delay", at, frequency), at(frequency).stop.gap
    speeds = np.array([approach_speed(frequency, gap, excess) for excess in COLLISIONS])
    return None if found is None else found * (2.0 * math.pi * frequency) ** 2 * gap / speeds


def _born_periods(at: At, frequency: float) -> Answer:
    error = letter.FREE_PERIOD_ERROR_S / letter.FREE_PERIOD_S
    drives = [frequency * (1.0 + shift) for shift in (-error, 0.0, error)]
    return np.array([float(born_period(StroboscopicMap(oscillator=at(drive)))) for drive in drives])


_SHARED = {name: found[:2] for name, found in least_model.QUANTITIES.items()}
QUANTITIES: Mapping[str, tuple[Ask, Distance, str, float]] = {
    "frequency": (
        lambda at, f: at(f).model.frequencies_hz,
        lambda a, b: largest_error(a / b, b / b),
        "relative",
        1e-3,
    ),
    "restitution": (*_SHARED["restitution"], "1", 1e-2),
    "delay": (_delays, largest_error, "v/a", 2e-2),
    "kick": (*_SHARED["kick"], "1", 1e-2),
    "born_period": (_born_periods, lambda a, b: float(np.count_nonzero(a != b)), "differing periods", 0.0),
    "fold": (partial(fold_of_born, fold_excess), error_of_fold, "relative", 2e-2),
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
        ask, distance, self.unit, self.tolerance = QUANTITIES[name]
        self.sharp = sharp or models.sharp

        def answer(choice: Choice) -> Answer:
            found = ask(lambda f: models.oscillator(choice, f), frequency)
            if not number or found is None:
                return found
            return found[int(number) - 1 : int(number)] if int(number) <= choice.modes else None

        self.between = distances(answer, distance)

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
