"""The error of beam theory: the flat U of the scene as a plate beside its beam, by the ends of its orbits.

The plate replaces the beam in the contact problem. It carries the ball on a point of the sheet, or on a rigid
seat of the ball's radius; the real mount was not measured. All frequencies of a plate are multiplied by one
factor, so that mode 1 has the frequency of the beam's. Its decay rates are interpolated in the frequency from
the beam's. Gap, drive and contact law stay. The modes are extrapolated from two meshes, the second with
elements half as long, as their errors fall as h^2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
import skfem as sk

from beam import ModalModel, Point, Tip
from contact import StroboscopicMap
from studies.physics.descriptions import born_and_lowered
from studies.shell.scene import READOUT, Scene, beam_at, sections_of
from studies.shell.study import Run
from studies.spring.shape.plate import PlateModes, half_u, plate_modes

MODES = 30  # symmetric modes computed for a plate, with which the kick has converged

COARSE, FINE = (1, 2), (2, 3)
"""Cells over the radius of the seat and over the rim beside it, in the coarser of two meshes, in pairs."""

WIDEST_SEAT = 0.8  # radius of the seat over half of the width, at most: the rim beside it needs cells

PLATES = ("point", "seat")  # mounts of the ball: on a point of the sheet, and on a rigid seat


@dataclass(frozen=True, kw_only=True)
class OrbitEnds:
    """The orbit just above grazing, and where it ends on the way down."""

    frequency_hz: float
    m: Annotated[int | None, "period of the orbit of the beam"]
    same_period: Annotated[bool, "the plates have the same period"]
    beam: Annotated[float | None, "end of the orbit when the drive is lowered, F/F_g − 1, beam"] = None
    point: Annotated[float | None, "end, plate with the ball on a point"] = None
    seat: Annotated[float | None, "end, plate with the ball on a rigid seat"] = None

    @property
    def factors(self) -> list[float]:
        """Plate end over beam end, for each plate whose end is known."""
        ends = (getattr(self, name) for name in PLATES)
        return [end / self.beam for end in ends if end and self.beam]


def plates_of(scene: Scene, cells: tuple[int, int]) -> dict[str, PlateModes]:
    """Modes by name of the mount, as in `PLATES`; `cells` across seat and rim as in `half_u`."""
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

    return {name: modes(fine, name).extrapolated(modes(coarse, name)) for name in PLATES}


def models_of(plates: Mapping[str, PlateModes], beam: ModalModel) -> dict[str, ModalModel]:
    """The modal models of the beam and of the plates, by name."""
    found = {"beam": beam}
    for name, modes in plates.items():
        omega = modes.omega * (beam.omega[0] / modes.omega[0])
        found[name] = ModalModel(
            omega=omega,
            decay_rate=np.interp(omega, beam.omega, beam.decay_rate),
            phi=modes.phi,
            participation=modes.participation,
            points={READOUT: Point(row=modes.phi)},
        )
    return found


@dataclass(frozen=True)
class Cell:
    """A spring, by its name and modal model, at one drive frequency [Hz]."""

    spring: str
    model: ModalModel
    frequency: float

    def __str__(self) -> str:
        return f"{self.spring}, {self.frequency:g} Hz"

    def end(self, scene: Scene) -> tuple[int, float | None]:
        """The period just above grazing, and the excess at which it ends on the way down."""
        strobed = StroboscopicMap(oscillator=beam_at(scene, self.frequency, self.model))
        orbit, end = born_and_lowered(strobed, scene.scan.born_excess, max(scene.scan.settle_cycles, 1))
        return orbit.m, None if end is None else end.excess


def orbit_rows(
    scene: Scene, run: Run, springs: Mapping[str, ModalModel], frequencies: Sequence[float]
) -> list[OrbitEnds]:
    """The orbits at each frequency."""
    cells = [Cell(*spring, frequency) for frequency in frequencies for spring in springs.items()]
    found, rows = iter(run.attempt(partial(Cell.end, scene=scene), cells, "ends of orbits")), []
    for frequency in frequencies:
        known = {name: one for name, one in zip(springs, found, strict=False) if one}
        rows.append(
            OrbitEnds(
                frequency_hz=frequency,
                m=known["beam"][0] if "beam" in known else None,
                same_period=len({period for period, _ in known.values()}) == 1,
                **{name: end for name, (_, end) in known.items()},
            )
        )
    return rows
