"""A leaf spring on a moving base: centreline, sections, supports, tip, drive direction and read-out points.

The ends of the centreline are tied to the base. With u, w [m] the displacements relative to the base along
the tangent and the normal, and theta [rad] the rotation of the strip about z, a support holds

    clamped   u = w = theta = 0        and out of the plane   v = v' = phi = phi' = 0
    pinned    u = w = 0                                       v = phi = 0
    guided    u = theta = 0                                   v' = phi' = 0
    free      nothing

(guided: a plane of symmetry across the strip, which slides along the normal; v [m] along z and the turn phi
[rad] about the tangent belong to `space`, the rest of this package lies in the plane.) On a straight
centreline small motions along and across do not couple; only w and theta are kept there.

The base moves by z [m] along the unit vector `drive`; the displacement of the tip, the force on it and every
displacement read-out count along that vector. A light beam reflected off the strip measures theta instead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from .centreline import Centreline
from .parameters import (
    InvalidValue,
    require,
    require_array,
    require_each,
    require_kind,
    require_within,
    shown,
    suspect,
)
from .section import StripSection

Support = Literal["clamped", "pinned", "guided", "free"]

#: Whether a support holds u, w, theta in the plane and v, v', phi, phi' out of it.
HELD: dict[str, tuple[bool, ...]] = {
    "clamped": (True, True, True, True, True, True, True),
    "pinned": (True, True, False, True, False, True, False),
    "guided": (True, False, True, False, True, False, True),
    "free": (False, False, False, False, False, False, False),
}

THICKEST = 0.2
"""Thickness over width of a strip beyond which a warning is given: edgewise it is then less than 25 times as
stiff as flat, and what bends about the width only in theory does so no longer."""

STOUTEST = 0.1
"""Thickness over the length of the whole strip beyond which a warning is given: Euler-Bernoulli's beam leaves
out shear, 3 (t/L)^2 of mode 1 and twenty times that of mode 3."""

SLENDEREST = 5000.0
"""Arm of the tip over the thickness beyond which a warning is given: the strip hangs under its own weight, as
a brass strip of 0.7 mm and 3.5 m does."""


def two_supports(supports: object) -> tuple[Support, Support]:
    """The supports at both ends, if they are two of the four."""
    pair = tuple(supports) if isinstance(supports, tuple | list) else ()
    known = len(pair) == 2 and all(isinstance(end, str) and end in HELD for end in pair)
    require(known, f"supports is {shown(supports)} [no unit]; it must be two of {', '.join(HELD)}")
    return pair[0], pair[1]


def check_strip(spring: Any, section: type, axes: int) -> None:
    """Refuse what is wrong with any strip, in the plane (`axes` 2) or in space (3); put the rest in order."""
    line = require_kind("centreline", spring.centreline, Centreline, "a Centreline")
    sections = require_each("sections", spring.sections, section, f"one {section.__name__} for each piece")
    count, pieces = len(sections), len(line.pieces)
    require(
        count == pieces, f"sections has {count} entries [no unit]; it needs one for each of {pieces} pieces"
    )
    supports = two_supports(spring.supports)
    require_kind("tip", spring.tip, Tip, "a Tip")
    check_place("tip_at", spring.tip_at, line)
    for support, end in zip(supports, (0.0, line.length), strict=True):
        require(
            not (HELD[support][0] and HELD[support][1]) or abs(spring.tip_at - end) > 1e-9 * line.length,
            f"tip_at is {spring.tip_at} m, where the strip is {support}; the tip must be free to move",
        )
    require_array("drive", spring.drive, "[1]", shape=(axes,), words=f"a direction of {axes} numbers")
    size = math.hypot(*spring.drive)
    require(size > 0.0, f"drive is {spring.drive} [1]; it must be finite and of positive length")
    kept = {"sections": sections, "supports": supports, "drive": tuple(part / size for part in spring.drive)}
    for name, value in kept.items():
        object.__setattr__(spring, name, value)


def check_place(name: str, s: float, line: Centreline) -> None:
    """ValueError unless s [m] is an arc length on the line."""
    require_within(name, s, "m", low=0)
    require(s <= line.length * (1.0 + 1e-12), f"{name} is {s} m; it must lie between 0 and {line.length} m")


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
        require_within("mass", self.mass, "kg", low=0)
        require_within("rotary_inertia", self.rotary_inertia, "kg m^2", low=0)


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
        require_within("at", self.at, "m", low=0)
        if self.quantity not in ("displacement", "rotation"):
            raise InvalidValue(f"quantity is {self.quantity!r} [no unit]; valid: 'displacement', 'rotation'")


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
        For a wrong number of sections, an unknown support, a place off the centreline, a tip on a support
        that holds it, a drive of no length, or a bend tighter than half the thickness.

    Warns
    -----
    SuspiciousValue
        For a tip heavier than the strip or with a radius of gyration longer than its arm (the longer way
        from the tip to an end), a strip wider than that, thinner than this over `SLENDEREST`, or thicker than
        `THICKEST` of its width or `STOUTEST` of its length.
    """

    centreline: Centreline
    sections: tuple[StripSection, ...]
    supports: tuple[Support, Support]
    tip: Tip
    tip_at: float
    drive: tuple[float, float] = (0.0, 1.0)
    readouts: Mapping[str, Readout] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_strip(self, StripSection, 2)
        require_kind("readouts", self.readouts, Mapping, "a mapping of names to Readout")
        for name, readout in self.readouts.items():
            require_kind(f"readouts[{name!r}]", readout, Readout, "a Readout")
            check_place(f"readouts[{name!r}]", readout.at, self.centreline)
        object.__setattr__(self, "readouts", dict(self.readouts))
        for section, piece in zip(self.sections, self.centreline.pieces, strict=True):
            half, radius = 0.5 * section.total_thickness, getattr(piece, "radius", math.inf)
            require(radius > half, f"radius is {radius} m; it must be above half the thickness, {half:g} m")
        self._suspect()

    def _suspect(self) -> None:
        """Warn of a tip that no strip carries, and of a strip that is a bar, a plate or a ribbon."""
        mass, length, tip = self.strip_mass, self.centreline.length, self.tip
        thickest = max(self.sections, key=lambda section: section.total_thickness)
        thickness, width = thickest.total_thickness, thickest.width
        size, arm = f"thickness is {thickness:g} m with its layers", max(self.tip_at, length - self.tip_at)
        if tip.mass > mass:
            suspect(f"mass of the tip is {tip.mass:g} kg; it is heavier than the strip, {mass:g} kg")
        reach = math.sqrt(tip.rotary_inertia / tip.mass) if tip.mass > 0.0 else 0.0
        if reach > arm:
            suspect(f"rotary_inertia of the tip is {tip.rotary_inertia:g} kg m^2; its body has {reach:.2g} m")
        if thickness > THICKEST * width:
            suspect(f"{size}; above {THICKEST:g} of the width {width:g} m it is a bar rather than a strip")
        if thickness > STOUTEST * length:
            suspect(f"{size}; above {STOUTEST:g} of the strip's length {length:g} m its shear counts too")
        if arm > SLENDEREST * thickness:
            suspect(f"{size}; with {arm:g} m from support to tip the strip hangs under its own weight")
        if width > arm:
            suspect(f"width is {width:g} m; above the length from support to tip, {arm:g} m, it is a plate")

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
            held = np.array(HELD[support][:3])
            held[0] |= self.centreline.is_straight
            rows.append(at_end[held])
        return 3 - int(np.linalg.matrix_rank(np.concatenate(rows), tol=1e-9))
