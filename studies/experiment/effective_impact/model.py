"""The approaches to the plate, one quantity varied at a time; the row of each, and what is read off a curve.

    speed        excess, hence approach speed v = 2 pi f gap sqrt((1 + excess)^2 - 1)
    reference    the spring as it is on a finer mesh, at the excess of Fig. 4
    mass         tip mass over leaf, free period and drive amplitude at grazing kept, at several excesses
    orbit        the same, but the collision of the orbit that settles at the letter's Fig. 4
    search       tip mass and restitution of the contact itself together

Beside what `contact.collisions` measures a row holds `arc_s` = v/a [s], the time in which the arc of the
single mode beyond the gap reaches its top.

Between the cases of a curve restitution has a corner where the kick is 1, its square has none. Smallest
values over the tip mass are therefore read off monotone splines through the kick and through
restitution^2 - (1 - kick)^2 = 2 a shift/v^2.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.interpolate import PchipInterpolator

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
from contact.orbits import onset_orbit
from studies.letter import TIME_TRACE_EXCESS, TIME_TRACE_HZ
from studies.physics.calibration import calibrate_gap, with_mass_ratio
from studies.shell.scene import (
    Scene,
    approach_speed,
    beam_at,
    contact_law_of,
    hertz_of,
    model_of,
    own_frequency,
    spring_of,
)

OWN, HERTZ = "contact of the scene", "Hertz"
"""Series of the spring as it is; `OWN` is there where the scene's law is not Hertz's."""

EXCESSES = (*np.geomspace(1e-5, 5e-2, 38).tolist(), *np.geomspace(5e-2, 0.4, 9)[1:].tolist())
MASS_EXCESSES = (1e-4, 1e-3, TIME_TRACE_EXCESS, 5e-2)
MASS_RATIOS = (
    *(0.0, 0.02, 0.05, 0.1, *np.round(0.025 * np.arange(5, 15), 3).tolist()),
    *(0.4, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0),
)
RESTITUTIONS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)

FINE = 2001  # points at which a spline is looked through: the smallest value is good to 1e-6 of itself


@dataclass(frozen=True, kw_only=True)
class Approach:
    """One approach; what does not exist is not a number."""

    curve: Annotated[str, "what is varied; studies.experiment.effective_impact.model lists the curves"]
    series: str
    value: Annotated[float, "value that is varied; the excess on the curve speed, else the ratio of masses"]
    excess: float
    mass_ratio: Annotated[float, "tip mass over the mass of the leaf"]
    orbit_m: Annotated[int | None, "period; none for a first collision, 0 if not settled"] = None
    restitution: Annotated[float, "restitution tau; none where mode 1 does not come back"] = math.nan
    delay_s: Annotated[float, "time delay [s]; none where mode 1 does not come back"] = math.nan
    kick: Annotated[float, "kick of the mode-1 velocity over the approach velocity"] = math.nan
    contact_s: Annotated[float, "time in contact [s]"] = math.nan
    arc_s: Annotated[float, "time v/a to the top of the arc beyond the gap [s]"] = math.nan
    peak_force_newton: Annotated[float, "largest contact force [N]; none under a law of restitution"] = (
        math.nan
    )
    impacts: Annotated[int, "impacts in the collision"] = 0
    forced_by_ringing: Annotated[bool, "whether ringing alone reaches the gap; the kick is then in m/s"] = (
        False
    )

    @property
    def returns(self) -> bool:
        """Whether mode 1 comes back to the gap."""
        return math.isfinite(self.restitution)


@dataclass(frozen=True, kw_only=True, eq=False)
class Case:
    """One approach: its row, still without numbers, and the oscillator at its amplitude."""

    row: Approach
    oscillator: ImpactOscillator

    def __str__(self) -> str:
        return f"{self.row.curve}, {self.row.series}, {self.row.value:g}"

    def measured(self) -> Approach:
        """The row with its numbers; ContactError or Refusal if there is no collision."""
        row = self.row
        if row.curve == "orbit":
            found, m = orbit_collision(self.oscillator)
            row = replace(row, orbit_m=m)
        else:
            found = first_collision(self.oscillator)
        if found is None:
            return row
        return replace(
            row,
            restitution=found.restitution,
            delay_s=found.delay,
            kick=found.kick,
            contact_s=found.contact_time,
            arc_s=found.approach / found.deceleration,
            peak_force_newton=found.peak_force,
            impacts=found.impacts,
            forced_by_ringing=found.forced_by_ringing,
        )


def orbit_collision(oscillator: ImpactOscillator) -> tuple[Collision | None, int]:
    """The first collision of the settled orbit and its period; None where it has none or did not settle."""
    settled = onset_orbit(StroboscopicMap(oscillator=oscillator), oscillator.excess)
    if not settled.m or not settled.impacts:
        return None, settled.m
    trajectory = simulate(oscillator, settled.end, periods=2 * settled.m + 2)
    found = collisions(trajectory, unfinished="drop")
    return (found[0] if found else None), settled.m


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
            amplitude = beam_at(scene, frequency).grazing_amplitude()
            scene = calibrate_gap(with_mass_ratio(scene, mass_ratio, frequency), amplitude, frequency)
        return Spring(scene=scene, model=model_of(scene.replace({"modes.count": modes})), frequency=frequency)

    @property
    def mass_ratio(self) -> float:
        """Tip mass over that of the leaf [1]."""
        return self.scene.tip.mass_kg / spring_of(self.scene).strip_mass

    def lossy(self, restitution: float) -> HuntCrossley:
        """Hunt and Crossley's law that has this restitution with a free mass at the excess of Fig. 4."""
        return HuntCrossley.with_restitution(
            stiffness=hertz_of(self.scene).stiffness,
            restitution=restitution,
            velocity=approach_speed(self.frequency, self.scene.stop.gap_m, TIME_TRACE_EXCESS),
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
        row = Approach(
            curve=curve,
            series=series,
            value=ratio if value is None else value,
            excess=excess,
            mass_ratio=ratio,
        )
        return Case(row=row, oscillator=replace(oscillator, stop=stop).with_excess(excess))


def cases_of(spring: Spring, masses: Sequence[Spring], fine: Spring, every: int = 1) -> Iterator[Case]:
    """Every case, or every `every`-th of a curve: of the spring, on a finer mesh and, if the law of the scene
    is Hertz's, with other tip masses."""
    own, hertz = contact_law_of(spring.scene), hertz_of(spring.scene)
    other: list[tuple[str, Spring, ContactLaw]] = [] if own == hertz else [(OWN, spring, own)]
    lines = [*other, (HERTZ, spring, hertz), ("Hertz, no tip mass", masses[0], hertz)]
    for name, one, law in lines:
        for excess in EXCESSES[::every]:
            yield one.case("speed", name, law, value=excess, excess=excess)
    yield fine.case("reference", HERTZ if own == hertz else OWN, own)
    orbit_hz = own_frequency(spring.scene, TIME_TRACE_HZ)
    for one in masses if own == hertz else ():
        for excess in MASS_EXCESSES:
            yield one.case("mass", f"excess {excess:g}", hertz, excess=excess)
        yield one.case("orbit", f"{orbit_hz:.2f} Hz", hertz, frequency=orbit_hz)
        for local in RESTITUTIONS[::every]:
            yield one.case("search", f"{local:g}", one.lossy(local))


def select(rows: Sequence[Approach], curve: str, series: str | None = None) -> list[Approach]:
    """The rows of a curve, or of one of its series, by rising value."""
    chosen = [row for row in rows if row.curve == curve and series in (None, row.series)]
    return sorted(chosen, key=lambda row: row.value)


def series_of(rows: Sequence[Approach], curve: str) -> list[str]:
    """The series of a curve, in their order."""
    return list(dict.fromkeys(row.series for row in rows if row.curve == curve))


def on_orbits(rows: Sequence[Approach]) -> list[Approach]:
    """The collisions on settled orbits that belong to a peak of mode 1."""
    return [row for row in select(rows, "orbit") if row.impacts and not row.forced_by_ringing]


@dataclass(frozen=True, kw_only=True)
class Floor:
    """The smallest restitution over the tip mass, for one local restitution."""

    local_restitution: Annotated[float, "restitution of the contact itself"]
    restitution: Annotated[float, "smallest restitution tau over the tip mass"]
    mass_ratio: Annotated[float, "tip mass over the mass of the leaf"]
    kick: Annotated[float, "kick of the mode-1 velocity over the approach velocity"]


def floor_of(rows: Sequence[Approach]) -> Floor | None:
    """The floor of one series over tip mass; None with fewer than three collisions of one impact, and if
    restitution falls up to the end of the range."""
    kept = [row for row in rows if row.impacts == 1 and row.mass_ratio > 0.0]
    kept = [row for row in kept if math.isfinite(row.restitution)]
    if len(kept) < 3:
        return None
    where = np.log([row.mass_ratio for row in kept])
    kick = PchipInterpolator(where, [row.kick for row in kept])
    rest = PchipInterpolator(where, [row.restitution**2 - (1.0 - row.kick) ** 2 for row in kept])
    fine = np.linspace(where[0], where[-1], FINE)
    square = np.maximum((1.0 - kick(fine)) ** 2 + rest(fine), 0.0)
    least = int(np.argmin(square))
    if least in (0, FINE - 1):
        return None
    return Floor(
        local_restitution=float(kept[0].series),
        restitution=math.sqrt(square[least]),
        mass_ratio=math.exp(fine[least]),
        kick=float(kick(fine[least])),
    )
