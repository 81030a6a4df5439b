"""The approaches to the plate: one quantity varied at a time, each curve a list of cases.

    speed        excess, hence approach speed v = 2 pi f gap sqrt((1 + excess)^2 - 1)
    reference    the spring as it is on a finer mesh, at the excess of Fig. 4
    mass         tip mass over leaf, free period and drive amplitude at grazing kept, at several excesses
    orbit        the same, but the collision of the orbit that settles at the letter's Fig. 4
    search       tip mass and restitution of the contact itself together
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from beam import ModalModel
from contact import (
    ContactLaw,
    HuntCrossley,
    ImpactOscillator,
    Stop,
)
from studies.calibration import leaf_mass, with_mass_ratio
from studies.letter import TIME_TRACE_EXCESS
from studies.scene import Scene, approach_speed, beam_at, contact_law_of, corresponding, hertz_of, model_of

OWN, HERTZ = "contact of the scene", "Hertz"
"""Series of the spring as it is; `OWN` is there where the scene's law is not Hertz's."""

ORBIT_HZ = 21.50
"""The letter's Fig. 4 [Hz]."""

EXCESSES = (*np.geomspace(1e-5, 5e-2, 38).tolist(), *np.geomspace(5e-2, 0.4, 9)[1:].tolist())
MASS_EXCESSES = (1e-4, 1e-3, TIME_TRACE_EXCESS, 5e-2)
MASS_RATIOS = (0.0, 0.02, 0.05, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25, 0.275, 0.3, 0.325, 0.35, 0.4, 0.5,
               0.7, 1.0, 1.4, 2.0, 3.0)  # fmt: skip
RESTITUTIONS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)


@dataclass(frozen=True, kw_only=True)
class Grid:
    """How finely the curves are sampled: every `every`-th value, with so many `modes`."""

    every: int
    modes: int


FULL, QUICK = Grid(every=1, modes=40), Grid(every=4, modes=20)


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """One approach: a curve, a series of it, the value on its axis, and the oscillator at its amplitude."""

    curve: str
    series: str
    value: float
    excess: float
    oscillator: ImpactOscillator
    mass_ratio: float

    def __str__(self) -> str:
        return f"{self.curve}, {self.series}, {self.value:g}"


@dataclass(frozen=True, kw_only=True, eq=False)
class Spring:
    """A spring whose modes are made once and then meet the plate in many cases."""

    scene: Scene
    model: ModalModel
    frequency: float
    mass_ratio: float

    @staticmethod
    def of(scene: Scene, frequency: float, modes: int) -> Spring:
        """The spring of a scene with this many modes, driven at `frequency` [Hz]."""
        model = model_of(scene.replace({"modes.count": modes}))
        return Spring(
            scene=scene, model=model, frequency=frequency, mass_ratio=scene.tip.mass_kg / leaf_mass(scene)
        )

    @staticmethod
    def of_mass(scene: Scene, frequency: float, modes: int, ratio: float) -> Spring:
        """The same with another tip mass, `ratio` times the leaf."""
        return Spring.of(with_mass_ratio(scene, ratio, frequency), frequency, modes)

    @property
    def speed(self) -> float:
        """Approach speed at the excess of Fig. 4 [m/s]."""
        return approach_speed(self.frequency, self.scene.stop.gap_m, TIME_TRACE_EXCESS)

    @property
    def laws(self) -> dict[str, ContactLaw]:
        """The law of the scene and Hertz's, once if they are the same."""
        own, hertz = contact_law_of(self.scene), hertz_of(self.scene)
        return {HERTZ: hertz} if own == hertz else {OWN: own, HERTZ: hertz}

    def lossy(self, restitution: float) -> HuntCrossley:
        """Hunt and Crossley's law that has this restitution with a free mass at `speed`."""
        stiffness = hertz_of(self.scene).stiffness
        return HuntCrossley.with_restitution(
            stiffness=stiffness, restitution=restitution, velocity=self.speed
        )

    def case(
        self, curve: str, series: str, value: float, law: ContactLaw, *, excess: float = TIME_TRACE_EXCESS,
        frequency: float | None = None,
    ) -> Case:  # fmt: skip
        """The spring under this law; another drive frequency [Hz] where given."""
        oscillator = beam_at(self.scene, frequency or self.frequency, self.model)
        oscillator = replace(oscillator, stop=Stop(gap=self.scene.stop.gap_m, law=law))
        return Case(
            curve=curve, series=series, value=value, excess=excess, oscillator=oscillator.with_excess(excess),
            mass_ratio=self.mass_ratio,
        )  # fmt: skip


def cases_of(spring: Spring, masses: Sequence[Spring], fine: Spring, grid: Grid) -> list[Case]:
    """Every case of the study.

    Parameters
    ----------
    spring : as it is.
    masses : the same with other tip masses, the bare tip first.
    fine : as it is, on a finer mesh.
    """
    return [
        *_speed(spring, masses[0], grid),
        *(fine.case("reference", name, fine.mass_ratio, law) for name, law in [*fine.laws.items()][:1]),
        *(case for one in masses for case in _mass(one, grid)),
    ]


def _speed(spring: Spring, bare: Spring, grid: Grid) -> Iterator[Case]:
    lines = [(name, spring, law) for name, law in spring.laws.items()]
    for name, one, law in [*lines, ("bare tip, Hertz", bare, hertz_of(bare.scene))]:
        for excess in EXCESSES[:: grid.every]:
            yield one.case("speed", name, excess, law, excess=excess)


def _mass(spring: Spring, grid: Grid) -> Iterator[Case]:
    ratio, hertz = spring.mass_ratio, hertz_of(spring.scene)
    for excess in MASS_EXCESSES:
        yield spring.case("mass", f"excess {excess:g}", ratio, hertz, excess=excess)
    orbit_hz = corresponding(spring.scene, ORBIT_HZ)
    yield spring.case("orbit", f"{orbit_hz:.2f} Hz", ratio, hertz, frequency=orbit_hz)
    for local in RESTITUTIONS[:: grid.every]:
        yield spring.case("search", f"{local:g}", ratio, spring.lossy(local))
