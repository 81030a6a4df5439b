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
    Collision,
    ContactLaw,
    HuntCrossley,
    ImpactOscillator,
    Stop,
    StroboscopicMap,
    collisions,
    first_collision,
    simulate,
)
from contact.orbits import born
from studies.experiment.effective_impact.collision_rows import Row
from studies.letter import TIME_TRACE_EXCESS
from studies.physics.calibration import leaf_mass, with_mass_ratio
from studies.shell.scene import (
    Scene,
    approach_speed,
    beam_at,
    contact_law_of,
    corresponding,
    hertz_of,
    model_of,
)

OWN, HERTZ = "contact of the scene", "Hertz"
"""Series of the spring as it is; `OWN` is there where the scene's law is not Hertz's."""

ORBIT_HZ = 21.50
"""The letter's Fig. 4 [Hz]."""

EXCESSES = (*np.geomspace(1e-5, 5e-2, 38).tolist(), *np.geomspace(5e-2, 0.4, 9)[1:].tolist())
MASS_EXCESSES = (1e-4, 1e-3, TIME_TRACE_EXCESS, 5e-2)
MASS_RATIOS = (
    0.0,
    0.02,
    0.05,
    0.1,
    0.125,
    0.15,
    0.175,
    0.2,
    0.225,
    0.25,
    0.275,
    0.3,
    0.325,
    0.35,
    0.4,
    0.5,
    0.7,
    1.0,
    1.4,
    2.0,
    3.0,
)
RESTITUTIONS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """One approach: its row, still without numbers, and the oscillator at its amplitude."""

    row: Row
    oscillator: ImpactOscillator

    def __str__(self) -> str:
        return f"{self.row.curve}, {self.row.series}, {self.row.value:g}"

    def measured(self) -> Row:
        """The row with its numbers; ContactError or Refusal if there is no collision."""
        found, row = None, self.row
        if row.curve == "orbit":
            found, period = orbit_collision(self.oscillator)
            row = replace(row, orbit_period=period)
        else:
            found = first_collision(self.oscillator)
        if found is None:
            return row
        mode_1 = 2.0 * float(self.oscillator.model.phi[0]) ** 2
        return replace(
            row,
            approach_m_s=found.approach,
            restitution=found.restitution,
            delay_s=found.delay,
            kick=found.kick,
            shift_m=found.shift,
            contact_s=found.contact_time,
            arc_s=found.approach / found.deceleration,
            energy_share=found.energy_to_higher_modes * mode_1 / found.approach**2,
            impacts=found.impacts,
            forced_by_ringing=found.forced_by_ringing,
            returns=found.returns,
        )


def orbit_collision(oscillator: ImpactOscillator) -> tuple[Collision | None, int]:
    """The first collision of the settled orbit and its period; None where it has none or did not settle."""
    settled = born(StroboscopicMap(oscillator=oscillator), oscillator.excess)
    if not settled.period or not settled.impacts:
        return None, settled.period
    trajectory = simulate(oscillator, settled.end, periods=2 * settled.period + 2)
    found = collisions(oscillator, trajectory, unfinished="drop")
    return (found[0] if found else None), settled.period


@dataclass(frozen=True, kw_only=True, eq=False)
class Spring:
    """A spring whose modes are made once and then meet the plate in many cases, driven at `frequency`
    [Hz]."""

    scene: Scene
    model: ModalModel
    frequency: float

    @staticmethod
    def of(scene: Scene, frequency: float, modes: int, mass_ratio: float | None = None) -> Spring:
        """The spring of a scene with this many modes; with another tip mass, `mass_ratio` times the leaf, if
        that is given."""
        if mass_ratio is not None:
            scene = with_mass_ratio(scene, mass_ratio, frequency)
        return Spring(scene=scene, model=model_of(scene.replace({"modes.count": modes})), frequency=frequency)

    @property
    def mass_ratio(self) -> float:
        """Tip mass over that of the leaf [1]."""
        return self.scene.tip.mass_kg / leaf_mass(self.scene)

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
        self,
        curve: str,
        series: str,
        law: ContactLaw,
        *,
        value: float | None = None,
        excess: float = TIME_TRACE_EXCESS,
        frequency: float | None = None,
    ) -> Case:
        """The spring under this law; `value` on the axis of the curve is the ratio of masses by default."""
        oscillator = beam_at(self.scene, frequency or self.frequency, self.model)
        stop, ratio = Stop(gap=self.scene.stop.gap_m, law=law), self.mass_ratio
        row = Row(
            curve=curve,
            series=series,
            value=ratio if value is None else value,
            excess=excess,
            modes=self.model.n_modes,
            mass_ratio=ratio,
            ball_limit=2.0 * float(self.model.tip_mass or 0.0) * float(self.model.phi[0]) ** 2,
        )
        return Case(row=row, oscillator=replace(oscillator, stop=stop).with_excess(excess))


def cases_of(spring: Spring, masses: Sequence[Spring], fine: Spring, every: int = 1) -> Iterator[Case]:
    """Every case of the study, or every `every`-th of a curve.

    Parameters
    ----------
    spring : as it is.
    masses : the same with other tip masses, the bare tip first.
    fine : as it is, on a finer mesh.
    """
    hertz = hertz_of(spring.scene)
    lines = [(name, spring, law) for name, law in spring.laws.items()]
    for name, one, law in [*lines, ("bare tip, Hertz", masses[0], hertz)]:
        for excess in EXCESSES[::every]:
            yield one.case("speed", name, law, value=excess, excess=excess)
    yield fine.case("reference", *next(iter(fine.laws.items())))
    orbit_hz = corresponding(spring.scene, ORBIT_HZ)
    for one in masses:
        for excess in MASS_EXCESSES:
            yield one.case("mass", f"excess {excess:g}", hertz, excess=excess)
        yield one.case("orbit", f"{orbit_hz:.2f} Hz", hertz, frequency=orbit_hz)
        for local in RESTITUTIONS[::every]:
            yield one.case("search", f"{local:g}", one.lossy(local))
