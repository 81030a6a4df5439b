"""The error of beam theory: the flat U of the scene as a plate beside its beam, by modes and by orbits.

The plate replaces the beam in the contact problem. It carries the ball on a point of the sheet, or on a rigid
seat of the ball's radius; the real mount was not measured. One factor on all frequencies, as from Young's
moduli, gives mode 1 the frequency of the beam. The beam's decay rates at the same frequencies are taken over.
Gap, drive and contact law stay. A "refitted" plate has a ball whose first collision has the beam's kick.
Modes are extrapolated from two meshes, one with elements of half the length; their errors fall as h^2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import brentq

from beam import ModalModel, Tip
from contact import Collision, StroboscopicMap, first_collision
from contact.orbits import born, orbit_end
from studies.calibration import Targets
from studies.run import Run
from studies.scene import READOUT, Scene, beam_at, sections_of
from studies.spring_shape.plate import PlateModes, plate_modes
from studies.spring_shape.plate_mesh import half_u

MODES, LISTED = 30, 10
"""Symmetric modes of a plate, after which the kick of a collision has converged; those in the table."""

WIDEST_SEAT = 0.8
"""Radius of the seat over half of the width, at most: the rim beside it needs room."""

REFITS = (-0.7, 2.0)
"""Mass added to the ball over its mass, where the kick of the beam is looked for."""

PLATES = {"point": "ball on a point", "seat": "ball on a rigid seat",
          "point_refitted": "on a point, refitted", "seat_refitted": "on a seat, refitted"}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PlateMode:
    """A symmetric mode, ball on a point or on a seat; None: the beam has no mode whose nearest it is.

    `difference`: beam over plate - 1. `mesh_change`: the larger one of the two extrapolated frequencies, from
    the coarser two of three meshes over the finer two - 1.
    """

    number: int
    beam_hz: float | None = None
    point_hz: float
    seat_hz: float
    difference: float | None = None
    tip_value_beam: float | None = None
    tip_value_point: float
    tip_value_seat: float
    participation_beam: float | None = None
    participation_point: float
    participation_seat: float
    mesh_change: float


@dataclass(frozen=True, kw_only=True)
class FirstCollision:
    """The first collision at the drive frequency and excess of `Targets`."""

    spring: str
    modes: int
    ball_mass_kg: float
    kick: float
    restitution: float | None
    delay_s: float | None


@dataclass(frozen=True, kw_only=True)
class OrbitEnds:
    """The orbit just above grazing, and the excess at which it ends on the way down, by each spring.

    `least`, `most`: end of a plate over that of the beam; None where one has the other sign.
    """

    frequency_hz: float
    period: int | None
    same_period: bool
    beam: float | None = None
    point: float | None = None
    seat: float | None = None
    point_refitted: float | None = None
    seat_refitted: float | None = None
    least: float | None
    most: float | None


@dataclass(frozen=True, kw_only=True)
class Spring:
    """Beam or plate as an impact sees it, with the mass of its ball [kg]."""

    name: str
    mass: float
    model: ModalModel

    def collision(self, scene: Scene) -> Collision:
        """The first collision."""
        targets = Targets.of(scene)
        driven = beam_at(scene, targets.frequency_hz, self.model)
        return first_collision(driven.with_excess(targets.excess))


def plates_of(scene: Scene, cells: tuple[int, int]) -> dict[str, tuple[PlateModes, PlateModes]]:
    """Modes with the ball on a point and a seat, from the finer and from the coarser two of three meshes."""
    keys, (bare, taped), found = scene.spring, sections_of(scene), {}
    leg, width, covered = keys.leg_length_m, keys.width_m, keys.tape_coverage * keys.leg_length_m
    seat = min(scene.tip.ball_radius_m, 0.5 * WIDEST_SEAT * width)
    tip = Tip(mass=scene.tip.mass_kg, rotary_inertia=scene.tip.rotary_inertia_kg_m2)
    for name in ("point", "seat"):
        first, second, third = (plate_modes(
            half_u(leg=leg, radius=keys.bend_radius_m, width=width, seat=seat, covered=covered, cells=cells,
                   times=times), bare, taped or bare, tip, MODES, seated=name == "seat",
        ) for times in (1, 2, 4))  # fmt: skip
        found[name] = third.extrapolated(second), second.extrapolated(first)
    return found


def mode_rows(plates: Mapping[str, tuple[PlateModes, PlateModes]], beam: ModalModel) -> list[PlateMode]:
    """The first modes of the plate, each beside the mode of the beam that is nearest to it."""
    (point, _), (seat, _) = plates.values()
    change = np.max([np.abs(rough.omega / fine.omega - 1.0) for fine, rough in plates.values()], axis=0)
    nearest = {int(np.argmin(np.abs(point.omega - omega))): k for k, omega in enumerate(beam.omega)}
    rows = []
    for i in range(LISTED):
        columns = {"mesh_change": change[i]}
        known: dict[str, ModalModel | PlateModes] = {"beam": beam} if i in nearest else {}
        for name, modes in (known | {"point": point, "seat": seat}).items():
            k = nearest[i] if name == "beam" else i
            columns |= {f"{name}_hz": modes.omega[k] / (2.0 * np.pi), f"tip_value_{name}": modes.phi[k],
                        f"participation_{name}": modes.participation[k]}  # fmt: skip
        if known:
            columns["difference"] = columns["beam_hz"] / columns["point_hz"] - 1.0
        rows.append(PlateMode(number=i + 1, **{name: float(value) for name, value in columns.items()}))
    return rows


def springs_of(
    scene: Scene, run: Run, plates: Mapping[str, tuple[PlateModes, PlateModes]], beam: ModalModel
) -> list[Spring]:
    """The beam and the plates, in the full form with refitted ones."""
    own = scene.tip.mass_kg
    found = [Spring(name="beam", mass=own, model=beam)]
    kick = found[0].collision(scene).kick

    def plate(name: str, modes: PlateModes, added: float = 0.0) -> Spring:
        loaded = modes.with_more_mass(added)
        omega = loaded.omega * (beam.omega[0] / loaded.omega[0])
        rates = np.interp(omega, beam.omega, beam.decay_rate)
        model = ModalModel(omega=omega, decay_rate=rates, phi=loaded.phi, participation=loaded.participation,
                           readouts={READOUT: loaded.phi})  # fmt: skip
        return Spring(name=name, mass=own + added, model=model)

    found += [plate(name, modes) for name, (modes, _) in plates.items()]
    for name, (modes, _) in () if run.quick else plates.items():

        def excess(added: float, modes: PlateModes = modes) -> float:
            return plate("", modes, added).collision(scene).kick - kick

        low, high = (share * own for share in REFITS)
        if excess(low) < 0.0 < excess(high):
            found.append(plate(f"{name}_refitted", modes, float(brentq(excess, low, high, xtol=1e-9 * own))))
        else:
            run.failed(f"plate, {PLATES[name]}", "no ball gives its first collision the kick of the beam's")
    return found


def collision_row(scene: Scene, spring: Spring) -> FirstCollision:
    """The first collision of a spring."""
    one = spring.collision(scene)
    return FirstCollision(spring=spring.name, modes=spring.model.n_modes, ball_mass_kg=spring.mass,
                          kick=one.kick, restitution=one.restitution, delay_s=one.delay)  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """A spring at one drive frequency [Hz]."""

    spring: Spring
    frequency: float

    def __str__(self) -> str:
        return f"{self.spring.name}, {self.frequency:g} Hz"

    def end(self, scene: Scene) -> tuple[int, float | None]:
        """The period just above grazing, and the excess at which it ends on the way down."""
        strobed = StroboscopicMap(oscillator=beam_at(scene, self.frequency, self.spring.model))
        cycles, excess = max(scene.scan.settle_cycles, 1), scene.scan.born_excess
        orbit = born(strobed, excess, most_cycles=cycles)
        end = orbit_end(strobed, orbit.end, excess, most_cycles=cycles) if orbit.period > 1 else None
        return orbit.period, None if end is None else end.excess


def orbit_rows(
    scene: Scene, run: Run, springs: Sequence[Spring], frequencies: Sequence[float]
) -> list[OrbitEnds]:
    """The orbits at each frequency."""
    cells = [Cell(spring, frequency) for frequency in frequencies for spring in springs]
    found, rows = iter(run.attempt(partial(Cell.end, scene=scene), cells, "ends")), []
    for frequency in frequencies:
        known = {spring.name: one for spring, one in zip(springs, found, strict=False) if one}
        periods, ends = (
            [period for period, _ in known.values()],
            {name: end for name, (_, end) in known.items()},
        )
        beam = ends.get("beam")
        ratios = [end / beam for name, end in ends.items() if end and beam and name != "beam"]
        good = bool(ratios) and min(ratios) > 0.0
        rows.append(OrbitEnds(
            frequency_hz=frequency, period=known["beam"][0] if "beam" in known else None, **ends,
            same_period=len(set(periods)) == 1, least=min(ratios) if good else None,
            most=max(ratios) if good else None,
        ))  # fmt: skip
    return rows
