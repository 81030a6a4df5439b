"""Rows of the tables: what each reading does, the error of strip theory mode by mode and by width.

With ball and contact off the plane of symmetry by d [m], a twist mode that turns the ball by theta has

    phi = d theta + what a bending mode close by in frequency lends,

computed with the ball where it is, not to first order. What a slow force at the contact sees of a mode is its
compliance phi^2/omega^2 [m/N].

    C_solid = mean displacement of the free end under a unit force spread over it,   C = L^3/(3 EI):
    C/C_solid - 1 goes from 0 (narrow) to nu^2/(1 - nu^2) (wide: a clamp forbids the curl of a bent strip).

A bend of radius r cannot curl either if b^2/(r t) is large: `bend_as_plate` gives it EI/(1 - nu^2).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from beam.space import SpatialModes, SpatialSpring, spatial_modes
from studies.spring_shape.elasticity import Parity, end_compliance, solid_modes
from studies.spring_shape.shapes import Mesh, Shape, first_bending, kinds_of

MODES = 14
"""Modes looked through for the first of each kind."""


@dataclass(frozen=True, kw_only=True)
class ReadingRow:
    """A reading of "U shaped", brought to the free period of the scene."""

    variation: str
    reading: str
    thickness_m: float
    flange_m: float
    first_bending_hz: float
    first_twist_hz: float
    first_sideways_hz: float | None
    """None: not among the first `MODES` modes."""
    ratio_twist: float
    """First twist over first bending frequency."""
    ratio: float
    """First twist or sideways, whichever is lower, over first bending frequency."""
    tip_value_bending: float
    """phi at the ball along the stop [kg^(-1/2)], as the next two."""
    tip_value_twist: float
    off_line_m: float
    tip_value_twist_off_line: float
    """With ball and contact off the plane of symmetry by `off_line_m`."""
    compliance_share_off_line: float
    """Compliance of the twist mode there over that of the first bending mode."""
    turn_of_twist: float
    """theta of the ball in the twist mode [kg^(-1/2) m^(-1)]."""
    bending_mode_nearest_to_twist_hz: float


@dataclass(frozen=True, kw_only=True)
class ErrorRow:
    """One mode by strip theory and as a solid; numbered in its family, lowest first."""

    reading: str
    family: str
    number: int
    kind: str
    strip_hz: float
    solid_hz: float
    """On the finer of two meshes."""
    error: float
    """f_strip/f_solid - 1"""
    mesh_change: float
    """Of f_solid, coarse over fine - 1."""
    error_bend_as_plate: float
    tip_value_error: float | None
    """None: the mode does not move the ball along the stop."""


@dataclass(frozen=True, kw_only=True)
class WidthRow:
    """Stiffness of a clamped straight strip as a solid, over 3 EI/L^3."""

    width_m: float
    width_over_length: float
    stiffness_excess: float


def reading_row(shape: Shape, off_line: float, variation: str = "none") -> ReadingRow:
    """The row of a shape that has been brought to its period, the ball off the line by `off_line` [m]."""
    modes = spatial_modes(shape.spring(), MODES)
    kinds, f = kinds_of(shape, modes.displacement, modes.rotation), modes.frequencies_hz
    bending, twist = first_bending(modes), kinds.index("twist")
    sideways = float(f[kinds.index("sideways")]) if "sideways" in kinds else None
    off = spatial_modes(shape.spring(off_line), MODES)
    near = np.abs(off.frequencies_hz / f[twist] - 1.0) < 0.1
    moved, first = int(np.argmax(np.abs(off.rotation[:, 0]) * near)), first_bending(off)
    compliance = (off.phi / off.omega) ** 2
    return ReadingRow(
        variation=variation,
        reading=shape.reading,
        thickness_m=shape.thickness,
        flange_m=shape.flange,
        first_bending_hz=float(f[bending]),
        first_twist_hz=float(f[twist]),
        first_sideways_hz=sideways,
        ratio_twist=float(f[twist] / f[bending]),
        ratio=float((f[twist] if sideways is None else min(f[twist], sideways)) / f[bending]),
        tip_value_bending=abs(float(modes.phi[bending])),
        tip_value_twist=abs(float(modes.phi[twist])),
        off_line_m=off_line,
        tip_value_twist_off_line=abs(float(off.phi[moved])),
        compliance_share_off_line=float(compliance[moved] / compliance[first]),
        turn_of_twist=abs(float(modes.rotation[twist, 0])),
        bending_mode_nearest_to_twist_hz=nearest_bending(f, kinds, float(f[twist])),
    )


def nearest_bending(frequencies: NDArray[np.float64], kinds: list[str], twist: float) -> float:
    """Frequency of the bending mode next to a twist mode [Hz]."""
    bending = frequencies[[kind == "bending" for kind in kinds]]
    return float(bending[np.argmin(np.abs(bending / twist - 1.0))])


def error_rows(shape: Shape, meshes: tuple[Mesh, Mesh], counts: tuple[int, int]) -> list[ErrorRow]:
    """The error of strip theory in the first modes in the plane of symmetry and out of it."""
    strip = spatial_modes(shape.spring(), 3 * sum(counts))
    plates = spatial_modes(bend_as_plate(shape), 3 * sum(counts)) if shape.reading == "folded" else strip
    solids = [shape.solid(mesh) for mesh in meshes]
    rows: list[ErrorRow] = []
    parities: tuple[Parity, Parity] = ("symmetric", "antisymmetric")
    for family, parity, count in zip(("in plane", "out of plane"), parities, counts, strict=True):
        coarse, fine = (solid_modes(solid, parity, count) for solid in solids)
        places, plate_places = (_of_parity(modes, parity)[:count] for modes in (strip, plates))
        kinds = kinds_of(shape, strip.displacement[places], strip.rotation[places])
        f, solid_hz = strip.frequencies_hz[places], fine.frequencies_hz
        plate_hz = plates.frequencies_hz[plate_places]
        for k, place in enumerate(places):
            moves = strip.phi[place] > 1e-3 * strip.phi.max()
            rows.append(
                ErrorRow(
                    reading=shape.reading,
                    family=family,
                    number=k + 1,
                    kind=kinds[k],
                    strip_hz=float(f[k]),
                    solid_hz=float(solid_hz[k]),
                    error=float(f[k] / solid_hz[k] - 1.0),
                    mesh_change=float(coarse.frequencies_hz[k] / solid_hz[k] - 1.0),
                    error_bend_as_plate=float(plate_hz[k] / solid_hz[k] - 1.0),
                    tip_value_error=float(strip.phi[place] / fine.phi[k] - 1.0) if moves else None,
                )
            )
    return rows


def width_rows(shape: Shape, factors: Iterable[float], mesh: Mesh) -> list[WidthRow]:
    """Stiffness of the clamped straight strip over that of strip theory, for so many times its width."""
    rows = []
    for factor in factors:
        wide = replace(shape, reading="plain", flange=0.0, width=factor * shape.width)
        solid = wide.solid(replace(mesh, across=max(mesh.across, round(mesh.across * factor))))
        free = wide.length**3 / (3.0 * wide.section.in_plane_stiffness)
        rows.append(
            WidthRow(
                width_m=wide.width,
                width_over_length=wide.width / wide.length,
                stiffness_excess=free / end_compliance(solid, "symmetric") - 1.0,
            )
        )
    return rows


def plate_excess(shape: Shape) -> float:
    """nu^2/(1 - nu^2): how much stiffer than a strip a plate is [1]."""
    nu = shape.material.poissons_ratio
    return nu**2 / (1.0 - nu**2)


def bend_as_plate(shape: Shape) -> SpatialSpring:
    """The strip in space with EI/(1 - nu^2) in its bend."""
    spring = shape.spring()
    leg, bend, far = spring.sections
    stiff = (1.0 + plate_excess(shape)) * bend.in_plane_stiffness
    return replace(spring, sections=(leg, replace(bend, in_plane_stiffness=stiff), far))


def _of_parity(modes: SpatialModes, parity: Parity) -> NDArray[np.intp]:
    """Numbers of the modes of one parity."""
    return np.flatnonzero((modes.out_of_plane < 0.5) == (parity == "symmetric"))
