"""Rows of the table of the readings of "U shaped": frequencies, tip values and compliance of each shape.

With ball and contact off the plane of symmetry by d [m], a twist mode that turns the ball by theta has

    phi = d theta + what a bending mode close by in frequency lends,

computed with the ball where it is, not to first order. The response of a mode to a slow force at the contact
is its compliance phi^2/omega^2 [m/N].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beam.space import spatial_modes
from studies.spring.shape.shapes import Shape, kinds_of

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
        tip_value_twist_off_line=abs(float(off.phi[moved])),
        compliance_share_off_line=float(compliance[moved] / compliance[first]),
        turn_of_twist=abs(float(modes.rotation[twist, 0])),
    )
