"""The error of beam theory: the flat U of the scene as a plate beside its beam, by the ends of its orbits.

The plate replaces the beam in the contact problem. It carries the ball on a point of the sheet, or on a rigid
seat of the ball's radius; the real mount was not measured. All frequencies of a plate are multiplied by one
factor, so that mode 1 has the frequency of the beam's. Its decay rates are interpolated in the frequency from
the beam's. Gap, drive and contact law stay. A "refitted" plate has another mass of the ball, chosen so that
its first collision has the same kick as the beam's. The modes are extrapolated from two meshes, the second
with elements half as long, as their errors fall as h^2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import skfem as sk
from scipy.optimize import brentq

from beam import ModalModel, Tip
from contact import Collision, StroboscopicMap, first_collision
from studies.physics.calibration import Targets
from studies.physics.descriptions import born_and_lowered
from studies.shell.scene import READOUT, Scene, beam_at, sections_of
from studies.shell.study import Run
from studies.spring.shape.plate import PlateModes, half_u, plate_modes

MODES = 30
"""Symmetric modes computed for a plate, with which the kick has converged."""

COARSE, FINE = (1, 2), (2, 3)
"""Cells over the radius of the seat and over the rim beside it, in the coarser of two meshes, in pairs."""

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
class OrbitEnds:
    """The orbit just above grazing, and the excess [1] at which it ends on the way down, for each spring.

    `period` is the period of the beam's orbit; `same_period` says whether all springs have it.
    """

    frequency_hz: float
    period: int | None
    same_period: bool
    beam: float | None = None
    point: float | None = None
    seat: float | None = None
    point_refitted: float | None = None
    seat_refitted: float | None = None

    @property
    def factors(self) -> list[float]:
        """Plate end over beam end, for each plate whose end is known."""
        ends = (getattr(self, name) for name in PLATES)
        return [end / self.beam for end in ends if end and self.beam]


@dataclass(frozen=True, kw_only=True)
class Spring:
    """The modal model of the beam or of a plate."""

    name: str
    model: ModalModel

    def collision(self, scene: Scene) -> Collision:
        """The first collision."""
        targets = Targets.of(scene)
        driven = beam_at(scene, targets.frequency_hz, self.model)
        return first_collision(driven.with_excess(targets.excess))


def plates_of(scene: Scene, cells: tuple[int, int]) -> dict[str, PlateModes]:
    """Modes by name of the mount, "point" and "seat"; `cells` across seat and rim as in `half_u`."""
    keys, (bare, taped) = scene.spring, sections_of(scene)
    tip = Tip(mass=scene.tip.mass_kg, rotary_inertia=scene.tip.rotary_inertia_kg_m2)
    coarse, fine = (
        half_u(
            leg=keys.leg_length_m,
            radius=keys.bend_radius_m,
            width=keys.width_m,
            seat=min(scene.tip.ball_radius_m, 0.5 * WIDEST_SEAT * keys.width_m),
            covered=keys.tape_coverage * keys.leg_length_m,
            cells=cells,
            times=times,
        )
        for times in (2, 4)
    )

    def modes(mesh: sk.MeshTri, name: str) -> PlateModes:
        return plate_modes(mesh, bare, taped or bare, tip, MODES, seated=name == "seat")

    return {name: modes(fine, name).extrapolated(modes(coarse, name)) for name in ("point", "seat")}


def with_refitted(scene: Scene, run: Run, plates: Mapping[str, PlateModes], beam: ModalModel) -> list[Spring]:
    """The beam, the two plates and, without --quick, the two refitted plates."""
    own = scene.tip.mass_kg
    found = [Spring(name="beam", model=beam)]
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
        return Spring(name=name, model=model)

    found += [plate(name, modes) for name, modes in plates.items()]
    for name, modes in () if run.quick else plates.items():

        def excess(added: float, modes: PlateModes = modes) -> float:
            return plate("", modes, added).collision(scene).kick - kick

        low, high = (share * own for share in REFITS)
        if excess(low) < 0.0 < excess(high):
            found.append(plate(f"{name}_refitted", modes, float(brentq(excess, low, high, xtol=1e-9 * own))))
        else:
            run.failed(f"plate, {PLATES[name]}", "no mass of the ball gives the kick of the beam")
    return found


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
        orbit, end = born_and_lowered(strobed, scene.scan.born_excess, max(scene.scan.settle_cycles, 1))
        return orbit.period, None if end is None else end.excess


def orbit_rows(
    scene: Scene, run: Run, springs: Sequence[Spring], frequencies: Sequence[float]
) -> list[OrbitEnds]:
    """The orbits at each frequency."""
    cells = [Cell(spring, frequency) for frequency in frequencies for spring in springs]
    found, rows = iter(run.attempt(partial(Cell.end, scene=scene), cells, "ends of orbits")), []
    for frequency in frequencies:
        known = {spring.name: one for spring, one in zip(springs, found, strict=False) if one}
        rows.append(
            OrbitEnds(
                frequency_hz=frequency,
                period=known["beam"][0] if "beam" in known else None,
                same_period=len({period for period, _ in known.values()}) == 1,
                **{name: end for name, (_, end) in known.items()},
            )
        )
    return rows
