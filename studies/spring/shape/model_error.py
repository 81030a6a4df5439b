"""The error of beam theory: the flat U of the scene as a plate beside its beam, by modes and by orbits.

The plate replaces the beam in the contact problem. It carries the ball on a point of the sheet, or on a rigid
seat of the ball's radius; the real mount was not measured. All frequencies of a plate are multiplied by one
factor, so that mode 1 has the frequency of the beam's. Its decay rates are interpolated in the frequency from
the beam's. Gap, drive and contact law stay. A "refitted" plate has another mass of the ball, chosen so that
its first collision has the same kick as the beam's. Each mesh of three has elements half as long as the one
before. The modes are extrapolated from the two finest, as their errors fall as h^2.
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
from studies.physics.calibration import Targets
from studies.shell.scene import READOUT, Scene, beam_at, sections_of
from studies.shell.study import Run
from studies.spring.shape.plate import PlateModes, plate_modes
from studies.spring.shape.plate_mesh import half_u

MODES, LISTED = 30, 10
"""Symmetric modes computed for a plate, with which the kick has converged; modes listed in the table."""

WIDEST_SEAT = 0.8
"""Radius of the seat over half of the width, at most: the rim beside it needs room."""

REFITS = (-0.7, 2.0)
"""Bounds of the search for the refitted ball: added mass over the mass of the ball."""

PLATES = {
    "point": "ball on a point",
    "seat": "ball on a rigid seat",
    "point_refitted": "on a point, refitted",
    "seat_refitted": "on a seat, refitted",
}


@dataclass(frozen=True, kw_only=True)
class PlateMode:
    """A symmetric mode of the plate, with the ball on a point and on a seat, beside a mode of the beam.

    The columns of the beam are None if no mode of the beam has this mode as its nearest in frequency. Tip
    values are in kg^(-1/2), participations in kg^(1/2). `difference` is beam_hz/point_hz - 1 [1].
    `mesh_change` [1] is the relative difference of two extrapolated frequencies: one from the two coarser
    meshes, one from the two finer meshes. The larger of point and seat is given.
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
    """The orbit just above grazing, and the excess [1] at which it ends on the way down, for each spring.

    `period` is the period of the beam's orbit; `same_period` says whether all springs have it. `least` and
    `most` are the extremes of plate end over beam end. They are None if a plate's end has the other sign, or
    if no plate's end is known.
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
    """The modal model of the beam or of a plate, with the mass of its ball [kg]."""

    name: str
    mass: float
    model: ModalModel

    def collision(self, scene: Scene) -> Collision:
        """The first collision."""
        targets = Targets.of(scene)
        driven = beam_at(scene, targets.frequency_hz, self.model)
        return first_collision(driven.with_excess(targets.excess))


def plates_of(scene: Scene, cells: tuple[int, int]) -> dict[str, tuple[PlateModes, PlateModes]]:
    """Modes by name of the mount, "point" and "seat": extrapolated from the finer and the coarser two meshes.

    `cells` are the numbers of cells across seat and rim in the coarsest of the three meshes (`half_u`).
    """
    keys, (bare, taped), found = scene.spring, sections_of(scene), {}
    leg, width, covered = keys.leg_length_m, keys.width_m, keys.tape_coverage * keys.leg_length_m
    seat = min(scene.tip.ball_radius_m, 0.5 * WIDEST_SEAT * width)
    tip = Tip(mass=scene.tip.mass_kg, rotary_inertia=scene.tip.rotary_inertia_kg_m2)
    for name in ("point", "seat"):
        first, second, third = (
            plate_modes(
                half_u(
                    leg=leg,
                    radius=keys.bend_radius_m,
                    width=width,
                    seat=seat,
                    covered=covered,
                    cells=cells,
                    times=times,
                ),
                bare,
                taped or bare,
                tip,
                MODES,
                seated=name == "seat",
            )
            for times in (1, 2, 4)
        )
        found[name] = third.extrapolated(second), second.extrapolated(first)
    return found


def mode_rows(plates: Mapping[str, tuple[PlateModes, PlateModes]], beam: ModalModel) -> list[PlateMode]:
    """The first `LISTED` modes of the plate; each mode of the beam is beside the nearest in frequency."""
    (point, _), (seat, _) = plates.values()
    change = np.max([np.abs(rough.omega / fine.omega - 1.0) for fine, rough in plates.values()], axis=0)
    nearest = {int(np.argmin(np.abs(point.omega - omega))): k for k, omega in enumerate(beam.omega)}
    rows = []
    for i in range(LISTED):
        columns = {"mesh_change": change[i]}
        known: dict[str, ModalModel | PlateModes] = {"beam": beam} if i in nearest else {}
        for name, modes in (known | {"point": point, "seat": seat}).items():
            k = nearest[i] if name == "beam" else i
            columns |= {
                f"{name}_hz": modes.omega[k] / (2.0 * np.pi),
                f"tip_value_{name}": modes.phi[k],
                f"participation_{name}": modes.participation[k],
            }
        if known:
            columns["difference"] = columns["beam_hz"] / columns["point_hz"] - 1.0
        rows.append(PlateMode(number=i + 1, **{name: float(value) for name, value in columns.items()}))
    return rows


def springs_of(
    scene: Scene, run: Run, plates: Mapping[str, tuple[PlateModes, PlateModes]], beam: ModalModel
) -> list[Spring]:
    """The beam, the two plates and, without --quick, the two refitted plates."""
    own = scene.tip.mass_kg
    found = [Spring(name="beam", mass=own, model=beam)]
    kick = found[0].collision(scene).kick

    def plate(name: str, modes: PlateModes, added: float = 0.0) -> Spring:
        loaded = modes.with_more_mass(added)
        omega = loaded.omega * (beam.omega[0] / loaded.omega[0])
        rates = np.interp(omega, beam.omega, beam.decay_rate)
        model = ModalModel(
            omega=omega,
            decay_rate=rates,
            phi=loaded.phi,
            participation=loaded.participation,
            readouts={READOUT: loaded.phi},
        )
        return Spring(name=name, mass=own + added, model=model)

    found += [plate(name, modes) for name, (modes, _) in plates.items()]
    for name, (modes, _) in () if run.quick else plates.items():

        def excess(added: float, modes: PlateModes = modes) -> float:
            return plate("", modes, added).collision(scene).kick - kick

        low, high = (share * own for share in REFITS)
        if excess(low) < 0.0 < excess(high):
            found.append(plate(f"{name}_refitted", modes, float(brentq(excess, low, high, xtol=1e-9 * own))))
        else:
            run.failed(f"plate, {PLATES[name]}", "no mass of the ball gives the kick of the beam")
    return found


def collision_row(scene: Scene, spring: Spring) -> FirstCollision:
    """The first collision of a spring."""
    one = spring.collision(scene)
    return FirstCollision(
        spring=spring.name,
        modes=spring.model.n_modes,
        ball_mass_kg=spring.mass,
        kick=one.kick,
        restitution=one.restitution,
        delay_s=one.delay,
    )


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
        rows.append(
            OrbitEnds(
                frequency_hz=frequency,
                period=known["beam"][0] if "beam" in known else None,
                **ends,
                same_period=len(set(periods)) == 1,
                least=min(ratios) if good else None,
                most=max(ratios) if good else None,
            )
        )
    return rows
