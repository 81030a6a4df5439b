"""Rows of the tables: what each reading does, and the error of strip theory mode by mode.

With ball and contact off the plane of symmetry by d [m], a twist mode that turns the ball by theta has

    phi = d theta + what a bending mode close by in frequency lends,

computed with the ball where it is, not to first order. What a slow force at the contact sees of a mode is its
compliance phi^2/omega^2 [m/N].

A bent strip curls across its width. A clamp forbids that, and a bend of radius r does if b^2/(r t) is large:
there EI/(1 - nu^2) halves the error of the folded strip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beam.space import spatial_modes
from studies.spring_shape.elasticity import FAMILIES, solid_modes
from studies.spring_shape.shapes import Mesh, Shape, kinds_of

MODES = 14
"""Modes looked through for the first of each kind."""


@dataclass(frozen=True, kw_only=True)
class ReadingRow:
    """A reading of "U shaped", brought to the free period of the scene."""

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
    tip_value_twist_off_line: float
    """With ball and contact off the plane of symmetry."""
    compliance_share_off_line: float
    """Compliance of the twist mode there over that of the first bending mode."""
    turn_of_twist: float
    """theta of the ball in the twist mode [kg^(-1/2) m^(-1)]."""


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
    tip_value_error: float | None
    """None: the mode does not move the ball along the stop."""


def reading_row(shape: Shape, off_line: float) -> ReadingRow:
    """The row of a shape that has been brought to its period, the ball off the line by `off_line` [m]."""
    modes = spatial_modes(shape.spring(), MODES)
    kinds, f = kinds_of(shape, modes), modes.frequencies_hz
    bending, twist = kinds.index("bending"), kinds.index("twist")
    sideways = float(f[kinds.index("sideways")]) if "sideways" in kinds else None
    off = spatial_modes(shape.spring(off_line), MODES)
    near = np.abs(off.frequencies_hz / f[twist] - 1.0) < 0.1  # mixed, it may be named bending
    moved, first = int(np.argmax(np.abs(off.rotation[:, 0]) * near)), kinds_of(shape, off).index("bending")
    compliance = (off.phi / off.omega) ** 2
    return ReadingRow(
        reading=shape.reading, thickness_m=shape.thickness, flange_m=shape.flange,
        first_bending_hz=float(f[bending]), first_twist_hz=float(f[twist]), first_sideways_hz=sideways,
        ratio_twist=float(f[twist] / f[bending]),
        ratio=float((f[twist] if sideways is None else min(f[twist], sideways)) / f[bending]),
        tip_value_bending=abs(float(modes.phi[bending])), tip_value_twist=abs(float(modes.phi[twist])),
        tip_value_twist_off_line=abs(float(off.phi[moved])),
        compliance_share_off_line=float(compliance[moved] / compliance[first]),
        turn_of_twist=abs(float(modes.rotation[twist, 0])),
    )  # fmt: skip


def error_rows(shape: Shape, meshes: tuple[Mesh, Mesh], counts: tuple[int, int]) -> list[ErrorRow]:
    """The error of strip theory in the first modes in the plane of symmetry and out of it."""
    strip = spatial_modes(shape.spring(), 3 * sum(counts))
    kinds, f = kinds_of(shape, strip), strip.frequencies_hz
    coarser, finer = (solid_modes(shape, shape.swept(mesh), counts) for mesh in meshes)
    rows: list[ErrorRow] = []
    for family, (coarse_hz, _), (fine_hz, phi) in zip(FAMILIES, coarser, finer, strict=True):
        places = np.flatnonzero((strip.out_of_plane < 0.5) == (family == "in plane"))[: phi.size]
        for k, place in enumerate(places):
            moves = strip.phi[place] > 1e-3 * strip.phi.max()
            rows.append(ErrorRow(
                reading=shape.reading, family=family, number=k + 1, kind=kinds[place],
                strip_hz=float(f[place]), solid_hz=float(fine_hz[k]),
                error=float(f[place] / fine_hz[k] - 1.0), mesh_change=float(coarse_hz[k] / fine_hz[k] - 1.0),
                tip_value_error=float(strip.phi[place] / phi[k] - 1.0) if moves else None,
            ))  # fmt: skip
    return rows
