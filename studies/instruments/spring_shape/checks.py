"""Strip theory against solid elements: the error of Euler-Bernoulli theory itself, mode by mode.

Both models have the same sizes, E, nu, density and ball. The error is

    f_strip/f_solid - 1,       f_solid on the finer of two meshes,

beside how far f_solid still moved from the coarser mesh to the finer. Modes of the plane of symmetry and
modes out of it are numbered apart, lowest first, and compared number by number.

Where it comes from: strip theory leaves sections free to curl across the width when they bend. A clamp
forbids that over a length of about the width b, and within it the strip has the stiffness of a plate,
EI/(1 - nu^2) instead of EI. And a bend of radius r, if b^2/(r t) is large, cannot curl either: fibres along
it would then run at different radii and be stretched. Both make the true spring stiffer. `as_plate` gives the
bend EI/(1 - nu^2) and leaves the clamp's share.

    C_solid = mean displacement of the free end under a unit force spread over it,   C = L^3/(3 EI):
    C/C_solid - 1 goes from 0 (narrow) to nu^2/(1 - nu^2) (wide).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from beam.space import SpatialModes, spatial_modes
from studies.instruments.spring_shape.readings import Shape, kinds_of
from studies.spring_shape_solids import end_compliance, solid_modes
from studies.spring_shape_solids.elasticity import Parity


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Elements on a leg, on the bend, across half of the width, and halvings at a clamp."""

    legs: int
    bend: int
    across: int
    halvings: int


#: From coarse to fine: each pair halves the length of the elements.
FINE = (Mesh(legs=60, bend=24, across=2, halvings=4), Mesh(legs=120, bend=48, across=2, halvings=5))
COARSE = (Mesh(legs=20, bend=24, across=1, halvings=3), Mesh(legs=40, bend=32, across=1, halvings=4))

PLANE_MODES, SPACE_MODES = 10, 5
"""Modes compared, in the plane of symmetry and out of it."""

WIDTHS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Widths of the clamped strip over the scene's."""


def error_rows(shape: Shape, meshes: tuple[Mesh, Mesh]) -> list[dict[str, Any]]:
    """The error of strip theory in each mode of a strip whose width is out of its plane."""
    strip = spatial_modes(shape.spring(), 3 * (PLANE_MODES + SPACE_MODES))
    plates = spatial_modes(as_plate(shape), 3 * (PLANE_MODES + SPACE_MODES)) if shape.bent else strip
    solids = [_solid(shape, mesh) for mesh in meshes]
    rows: list[dict[str, Any]] = []
    families: tuple[tuple[Literal["in plane", "out of plane"], Parity, int], ...] = (
        ("in plane", "symmetric", PLANE_MODES),
        ("out of plane", "antisymmetric", SPACE_MODES),
    )
    for family, parity, count in families:
        coarse, fine = (solid_modes(solid, parity, count) for solid in solids)
        places, plate_places = (_family(modes, parity)[:count] for modes in (strip, plates))
        kinds = kinds_of(shape, strip.displacement[places], strip.rotation[places])
        for number in range(count):
            place, solid = places[number], fine.frequencies_hz[number]
            moves = strip.phi[place] > 1e-3 * strip.phi.max()
            rows.append({
                "reading": shape.reading,
                "family": family,
                "number": number + 1,
                "kind": kinds[number],
                "strip_hz": strip.frequencies_hz[place],
                "solid_hz": solid,
                "error": strip.frequencies_hz[place] / solid - 1.0,
                "mesh_change": coarse.frequencies_hz[number] / solid - 1.0,
                "error_bend_as_plate": plates.frequencies_hz[plate_places[number]] / solid - 1.0,
                "tip_value_error": strip.phi[place] / fine.phi[number] - 1.0 if moves else np.nan,
            })
    return rows


def solid_row(shape: Shape, meshes: tuple[Mesh, Mesh]) -> dict[str, Any]:
    """First bending and first twist frequency of a reading as a solid [Hz], and errors of strip theory."""
    modes = spatial_modes(shape.spring(), 14)
    kinds = kinds_of(shape, modes.displacement, modes.rotation)
    solids = [_solid(shape, mesh) for mesh in meshes]
    found: dict[str, Any] = {"reading": shape.reading}
    for kind in ("bending", "twist"):
        place = kinds.index(kind)
        parity: Parity = "symmetric" if modes.out_of_plane[place] < 0.5 else "antisymmetric"
        number = int(np.flatnonzero(_family(modes, parity) == place)[0])
        values = [
            float(solid_modes(solid, parity, number + 2).frequencies_hz[number]) for solid in solids
        ]
        found |= {
            f"first_{kind}_solid_hz": values[1],
            f"error_{kind}": modes.frequencies_hz[place] / values[1] - 1.0,
            f"mesh_change_{kind}": values[0] / values[1] - 1.0,
        }
    return found


def width_rows(shape: Shape, factors: Iterable[float], mesh: Mesh) -> list[dict[str, Any]]:
    """Stiffness of the clamped straight strip over that of strip theory, for several widths."""
    rows = []
    for factor in factors:
        wide = dataclasses.replace(shape, reading="plain", flange=0.0, width=factor * shape.width)
        cells = max(mesh.across, round(mesh.across * factor))
        solid = _solid(wide, dataclasses.replace(mesh, across=cells))
        free = wide.length**3 / (3.0 * wide.section.in_plane_stiffness)
        rows.append({
            "width_m": wide.width,
            "width_over_length": wide.width / wide.length,
            "stiffness_excess": free / end_compliance(solid, "symmetric") - 1.0,
        })
    return rows


def plate_excess(shape: Shape) -> float:
    """nu^2/(1 - nu^2): how much stiffer than a strip a plate is [1]."""
    nu = shape.material.poissons_ratio
    return nu**2 / (1.0 - nu**2)


def as_plate(shape: Shape) -> Any:
    """The strip in space with EI/(1 - nu^2) in its bend."""
    spring, stiffer = shape.spring(), 1.0 + plate_excess(shape)
    leg, bend, far = spring.sections
    bend = dataclasses.replace(bend, in_plane_stiffness=stiffer * bend.in_plane_stiffness)
    return dataclasses.replace(spring, sections=(leg, bend, far))


def _solid(shape: Shape, mesh: Mesh) -> Any:
    return shape.solid(mesh.legs, mesh.bend, mesh.across, mesh.halvings)


def _family(modes: SpatialModes, parity: Parity) -> Any:
    """Numbers of the modes of one parity."""
    return np.flatnonzero((modes.out_of_plane < 0.5) == (parity == "symmetric"))
