"""A leaf spring on a moving base: centreline, sections, supports, tip, drive direction and read-out points.

The ends of the centreline are tied to the base. With u, w [m] the displacements relative to the base along
the tangent and the normal, and theta [rad] the rotation of the strip, a support holds

    clamped   u = w = theta = 0
    pinned    u = w = 0
    guided    u = theta = 0        (slides along the normal)
    free      nothing

On a straight centreline small motions along and across do not couple; only w and theta are kept there.

The base moves by z [m] along the unit vector `drive`; the displacement of the tip, the force on it and every
displacement read-out count along that vector. A light beam reflected off the strip measures theta instead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from .centreline import Centreline
from .material import require_number
from .section import StripSection

Support = Literal["clamped", "pinned", "guided", "free"]

#: Whether a support holds (u, w, theta).
HELD: dict[str, tuple[bool, bool, bool]] = {
    "clamped": (True, True, True),
    "pinned": (True, True, False),
    "guided": (True, False, True),
    "free": (False, False, False),
}


@dataclass(frozen=True, kw_only=True)
class Tip:
    """What sits on the strip where it meets the stop: a ball with its mount.

    Parameters
    ----------
    mass : float
        [kg], not negative.
    rotary_inertia : float
        About the z axis through the centreline [kg m^2], not negative.
    """

    mass: float = 0.0
    rotary_inertia: float = 0.0

    def __post_init__(self) -> None:
        require_number("mass", self.mass, "kg", positive=False)
        require_number("rotary_inertia", self.rotary_inertia, "kg m^2", positive=False)


@dataclass(frozen=True, kw_only=True)
class Readout:
    """A place where the motion is watched.

    Parameters
    ----------
    at : float
        Arc length [m].
    quantity : {"displacement", "rotation"}
        Displacement in the drive direction [m], or rotation of the strip [rad].
    """

    at: float
    quantity: Literal["displacement", "rotation"] = "displacement"

    def __post_init__(self) -> None:
        if self.quantity not in ("displacement", "rotation"):
            raise ValueError(f"quantity is {self.quantity!r} [no unit]; valid: 'displacement', 'rotation'.")


@dataclass(frozen=True, kw_only=True)
class LeafSpring:
    """A strip that follows a centreline between two supports.

    Parameters
    ----------
    centreline : Centreline
    sections : tuple of StripSection
        One for each piece of the centreline.
    supports : tuple of two supports
        At s = 0 and at the far end: "clamped", "pinned", "guided" or "free".
    tip : Tip
    tip_at : float
        Arc length where the tip sits [m].
    drive : tuple of two floats
        Direction (x, y) of the base motion; stored as a unit vector.
    readouts : mapping of str to Readout

    Raises
    ------
    ValueError
        For a wrong number of sections, an unknown support, a place off the centreline, a drive of no length.
    """

    centreline: Centreline
    sections: tuple[StripSection, ...]
    supports: tuple[Support, Support]
    tip: Tip
    tip_at: float
    drive: tuple[float, float] = (0.0, 1.0)
    readouts: Mapping[str, Readout] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "sections", tuple(self.sections))
        count, pieces = len(self.sections), len(self.centreline.pieces)
        if count != pieces:
            raise ValueError(
                f"sections has {count} entries [no unit]; it needs one for each of {pieces} pieces."
            )
        if len(self.supports) != 2 or not set(self.supports) <= set(HELD):
            raise ValueError(f"supports is {self.supports} [no unit]; it must be two of {', '.join(HELD)}.")
        places = {"tip_at": self.tip_at} | {f"readouts[{name!r}]": r.at for name, r in self.readouts.items()}
        for name, s in places.items():
            require_number(name, s, "m", positive=False)
            if s > self.centreline.length * (1.0 + 1e-12):
                raise ValueError(f"{name} is {s} m; it must lie between 0 and {self.centreline.length} m.")
        size = math.hypot(*self.drive)
        if not (math.isfinite(size) and size > 0.0):
            raise ValueError(f"drive is {self.drive} [1]; it must be finite and of positive length.")
        object.__setattr__(self, "drive", (self.drive[0] / size, self.drive[1] / size))
        object.__setattr__(self, "readouts", dict(self.readouts))

    @property
    def strip_mass(self) -> float:
        """Mass of the strip without the tip [kg]."""
        pieces = zip(self.sections, self.centreline.pieces, strict=True)
        return sum(section.mass_per_length * piece.length for section, piece in pieces)

    @property
    def rigid_motions(self) -> int:
        """Number of motions without strain that the supports allow: 0 for a spring that is held."""
        ends = np.array([0.0, self.centreline.length])
        arm = self.centreline.points(ends)[:, :2] / self.centreline.length
        turned = np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        rows = []
        for i, support in enumerate(self.supports):
            t, n = (vectors[i, :2] for vectors in self.centreline.frame(ends))
            at_end = np.array([[*t, t @ turned[i]], [*n, n @ turned[i]], [0.0, 0.0, 1.0]])
            held = np.array(HELD[support])
            held[0] |= self.centreline.is_straight
            rows.append(at_end[held])
        return 3 - int(np.linalg.matrix_rank(np.concatenate(rows), tol=1e-9))
