"""A leaf spring in space: plane centreline, sections, supports, and a tip off the centroid of its section.

The centreline lies in the x-y plane with frame t, n, z; u, w, v [m] are displacements along these, phi [rad]
is the turn about t and k the curvature. Supports, with theta = w' + k u:

    clamped   u = w = v = theta = v' = phi = 0, and no warping: phi' = 0
    pinned    u = w = v = phi = 0
    guided    u = theta = v' = 0, phi' + k v' = 0         (a plane of symmetry across the strip)
    free      nothing

Without warping stiffness a clamp leaves phi' alone.

The tip is a body of mass M [kg] and rotary inertia J [kg m^2], the same about every axis, fixed to one
section at the point c [m] from its centroid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .centreline import Centreline
from .parameters import require_array, require_kind, require_within
from .spatial_section import SpatialSection
from .spring import Support, Tip, two_supports

#: Unknowns u, w, w', v, v', phi, phi' held by each support.
HOLDS: dict[str, tuple[bool, ...]] = {
    "clamped": (True,) * 7,
    "pinned": (True, True, False, True, False, True, False),
    "guided": (True, False, True, False, True, False, True),
    "free": (False,) * 7,
}

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class SpatialSpring:
    """A strip that follows a plane centreline between two supports.

    Parameters
    ----------
    centreline : Centreline
    sections : tuple of SpatialSection
        One for each piece of the centreline.
    supports : tuple of two supports
    tip : Tip
        Its rotary inertia counts about every axis.
    tip_at : float
        Arc length where the tip sits [m].
    tip_offset : tuple of three floats
        c, from the centroid of the section there to the tip, along x, y and z [m].
    drive : tuple of three floats
        e; stored as a unit vector.

    Raises
    ------
    ValueError
        For a wrong number of sections, a shear offset on an arc, an unknown support, a place off the
        centreline, a vector that is not three finite numbers or a drive of no length.
    """

    centreline: Centreline
    sections: tuple[SpatialSection, ...]
    supports: tuple[Support, Support]
    tip: Tip
    tip_at: float
    tip_offset: Vector = (0.0, 0.0, 0.0)
    drive: Vector = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        require_kind("centreline", self.centreline, Centreline, "a Centreline")
        require_kind("sections", self.sections, (tuple, list), "one SpatialSection for each piece")
        for section in self.sections:
            require_kind("sections", section, SpatialSection, "one SpatialSection for each piece")
        require_kind("tip", self.tip, Tip, "a Tip")
        object.__setattr__(self, "sections", tuple(self.sections))
        line, count = self.centreline, len(self.sections)
        if count != len(line.pieces):
            raise ValueError(
                f"sections has {count} entries [no unit]; it needs one for each of {len(line.pieces)} pieces"
            )
        for section, piece in zip(self.sections, line.pieces, strict=True):
            if section.shear_offset and piece.curvature:
                raise ValueError(f"shear_offset is {section.shear_offset} m; on an arc it must be 0")
        object.__setattr__(self, "supports", two_supports(self.supports))
        require_within("tip_at", self.tip_at, "m", low=0)
        if self.tip_at > line.length * (1.0 + 1e-12):
            raise ValueError(f"tip_at is {self.tip_at} m; it must lie between 0 and {line.length} m")
        for name, unit in (("tip_offset", "m"), ("drive", "1")):
            require_array(name, getattr(self, name), unit, shape=(3,), words="three finite numbers")
        size = math.hypot(*self.drive)
        if not size > 0.0:
            raise ValueError(f"drive is {self.drive} [1]; it must be of positive length")
        x, y, z = self.drive
        object.__setattr__(self, "drive", (x / size, y / size, z / size))
