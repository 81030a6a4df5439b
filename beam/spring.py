"""A leaf spring on a moving base: centreline, sections, supports, tip, drive direction and points by name.

Supports join the ends of the centreline, and places between them, to the base. u, w [m] are the displacements
relative to the base along the tangent and the normal, theta [rad] is the rotation of the strip about z. Out
of the plane, in `space`, v [m] is the displacement along z and phi [rad] the rotation about the tangent. A
support holds

    clamped   u = w = theta = 0        and out of the plane   v = v' = phi = phi' = 0
    pinned    u = w = 0                                       v = phi = 0
    guided    u = theta = 0                                   v' = phi' = 0
    free      nothing

A guided end lies on a plane of symmetry across the strip and slides along the normal. On a straight
centreline small motions along and across do not couple; only w and theta are kept there.

The base moves by z [m] along the unit vector `drive`. The displacement of the tip, the force on it and every
displacement read-out are components along that vector. A light beam reflected off the strip measures theta.
"""

import math
from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from .centreline import Centreline
from .parameters import require, require_array, require_each, require_kind, require_within, shown, suspect
from .record import record
from .section import BeamSection, StripSection

Support = Literal["clamped", "pinned", "guided", "free"]

#: Whether a support holds u, w, theta in the plane and v, v', phi, phi' out of it.
HELD: dict[str, tuple[bool, ...]] = {
    "clamped": (True, True, True, True, True, True, True),
    "pinned": (True, True, False, True, False, True, False),
    "guided": (True, False, True, False, True, False, True),
    "free": (False, False, False, False, False, False, False),
}

THICKEST = 0.2
"""Largest thickness over width of a strip without a warning. Beyond it the strip is less than 25 times as
stiff edgewise as flat, and bending edgewise can no longer be neglected."""
STOUTEST = 0.1
"""Largest thickness over the length of the whole strip without a warning. Euler-Bernoulli's beam leaves out
shear, a part 3 (t/L)^2 of the frequency of mode 1 and twenty times that of mode 3."""
SLENDEREST = 5000.0
"""Largest length from support to tip over the thickness without a warning. Beyond it the strip hangs under
its own weight, as a brass strip of 0.7 mm and 3.5 m does."""


def two_supports(supports: object) -> tuple[Support, Support]:
    """Return the supports at both ends, or raise ValueError unless they are two of the four known."""
    pair = tuple(supports) if isinstance(supports, tuple | list) else ()
    known = len(pair) == 2 and all(isinstance(end, str) and end in HELD for end in pair)
    require(known, "supports", f"is {shown(supports)} [no unit]; it must be two of {', '.join(HELD)}")
    return pair[0], pair[1]


def check_strip(spring: Any, section: type | tuple[type, ...], axes: int) -> None:
    """Refuse wrong fields of a strip in the plane (`axes` 2) or in space (3), and normalise the others."""
    line = require_kind("centreline", spring.centreline, Centreline, "a Centreline")
    kind = section if isinstance(section, type) else section[0]
    sections = require_each("sections", spring.sections, section, f"one {kind.__name__} for each piece")
    count, words = len(line.pieces), f"it needs one for each of {len(line.pieces)} pieces"
    require(len(sections) == count, "sections", f"has {len(sections)} entries [no unit]; {words}")
    supports = two_supports(spring.supports)
    require_kind("tip", spring.tip, Tip, "a Tip")
    require_within("tip_at", spring.tip_at, "m", low=0, high=line.length * (1.0 + 1e-12))
    for support, end in zip(supports, (0.0, line.length), strict=True):
        held = HELD[support][0] and HELD[support][1] and abs(spring.tip_at - end) <= 1e-9 * line.length
        words = f"is {spring.tip_at} m, where the strip is {support}; the tip must be able to move"
        require(not held, "tip_at", words)
    require_array("drive", spring.drive, "[1]", shape=(axes,), words=f"a direction of {axes} numbers")
    size = math.hypot(*spring.drive)
    require(size > 0.0, "drive", f"is {spring.drive} [1]; it must be finite and of positive length")
    vars(spring).update(sections=sections, supports=supports)
    vars(spring).update(drive=tuple(part / size for part in spring.drive))


@record(eq=True)
class Tip:
    """The body on the strip that meets the stop: a ball with its mount.

    Parameters
    ----------
    mass : float
        Mass [kg], not negative.
    rotary_inertia : float
        Moment of inertia about the z axis through the centreline [kg m^2], not negative.  A ball of radius
        r with its centre at a distance a has m (2 r^2/5 + a^2); zero is a point mass.

    Raises
    ------
    ValueError
        If a value is negative or not finite.
    TypeError
        If a value is not a number.

    See Also
    --------
    cantilever : A straight strip with the tip at its free end.
    LeafSpring : A strip of any shape, with its tip at any arc length.
    with_tip_mass : A modal model with another mass at its tip.

    Examples
    --------
    A steel ball of radius 2 mm on a cantilever:

    >>> from math import pi
    >>> from beam import STEEL, StripSection, Tip, cantilever
    >>> ball = Tip(mass=STEEL.density * 4 / 3 * pi * 2e-3**3)
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> spring = cantilever(length=0.15, section=strip, tip=ball)
    >>> round(1e3 * spring.tip.mass, 3), round(1e3 * spring.strip_mass, 3)  # [g]
    (0.262, 7.029)
    """

    mass: float = 0.0
    rotary_inertia: float = 0.0

    def __post_init__(self) -> None:
        require_within("mass", self.mass, "kg", low=0)
        require_within("rotary_inertia", self.rotary_inertia, "kg m^2", low=0)


@record(eq=True)
class Readout:
    """A point of the strip where an instrument measures the motion.

    Parameters
    ----------
    at : float
        Arc length [m], not negative.
    quantity : {"displacement", "rotation"}
        Displacement in the drive direction [m], or rotation of the strip [rad].

    Raises
    ------
    ValueError
        If `at` is negative or not finite, or the quantity is unknown.
    TypeError
        If `at` is not a number.
    """

    at: float
    quantity: Literal["displacement", "rotation"] = "displacement"

    def __post_init__(self) -> None:
        require_within("at", self.at, "m", low=0)
        known = self.quantity in ("displacement", "rotation")
        require(known, "quantity", f"is {self.quantity!r} [no unit]; valid: 'displacement', 'rotation'")


@record(eq=True)
class LeafSpring:
    """A strip that follows a centreline between two supports.

    Parameters
    ----------
    centreline : Centreline
        Curve of the strip at rest [m].
    sections : tuple of StripSection or BeamSection
        One section for each piece of the centreline.
    supports : tuple of two Support
        Supports at s = 0 and at the far end: "clamped", "pinned", "guided" or "free".
    tip : Tip
        The body that meets the stop.
    tip_at : float
        Arc length of the tip [m].
    drive : tuple of two floats
        Direction (x, y) of the base motion [1]; stored as a unit vector.
    readouts : mapping of str to Readout
        Points where the motion is measured, by name.
    points : mapping of str to a float or a tuple of two floats
        Further places that a stop or a force can act on, by name: their arc lengths, or their coordinates
        (x, y) on the centreline [m]. They move, like the tip, in the drive direction.
    between : mapping of float to Support
        Supports between the ends, by their arc lengths [m].

    Raises
    ------
    ValueError
        If the number of sections is wrong, a support is unknown, or it holds the tip or a point. Also if an
        arc length or a point lies off the centreline, the drive has length 0, or a bend is tighter than half
        the thickness.
    TypeError
        If a value is of another class than stated above.

    Warns
    -----
    SuspiciousValue
        If a strip is thicker than 0.2 of its width or 0.1 of its length, or longer from support to tip than
        5000 thicknesses. Also if the tip is heavier than the strip, or if the width or the tip's radius of
        gyration exceeds the length from support to tip.
    """

    centreline: Centreline
    sections: tuple[StripSection | BeamSection, ...]
    supports: tuple[Support, Support]
    tip: Tip
    tip_at: float
    drive: tuple[float, float] = (0.0, 1.0)
    readouts: Mapping[str, Readout] = field(default_factory=dict)
    points: Mapping[str, float | tuple[float, float]] = field(default_factory=dict)
    between: Mapping[float, Support] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_strip(self, (StripSection, BeamSection), 2)
        require_kind("readouts", self.readouts, Mapping, "a mapping of names to Readout")
        end = self.centreline.length * (1.0 + 1e-12)
        for name, readout in self.readouts.items():
            require_kind(f"readouts[{name!r}]", readout, Readout, "a Readout")
            require_within(f"readouts[{name!r}]", readout.at, "m", low=0, high=end)
        require_kind("between", self.between, Mapping, "a mapping of arc lengths to supports")
        for at, support in self.between.items():
            words, inner = "between", self.centreline.length * (1.0 - 1e-6)
            require_within(words, at, "m", above=1e-6 * inner, below=inner)
            two_supports([support, support])
        require_kind("points", self.points, Mapping, "a mapping of names to places")
        names = dict(readouts=dict(self.readouts), points=dict(self.points), between=dict(self.between))
        vars(self).update(names)
        for name, s in {"tip_at": self.tip_at, **self.point_at}.items():
            for place, support in self.places:
                held = HELD[support][0] and HELD[support][1] and abs(s - place) <= 1e-9 * end
                words = f"is {s} m, where the strip is {support}; it must be able to move"
                require(not held, name if name == "tip_at" else f"points[{name!r}]", words)
        for section, piece in zip(self.sections, self.centreline.pieces, strict=True):
            half, r = 0.5 * section.total_thickness, getattr(piece, "radius", math.inf)
            require(r > half, "radius", f"is {r} m; it must be above half the thickness, {half:g} m")
        self._warn()

    def _warn(self) -> None:
        """Warn of a tip too large for its strip, and of a strip that is rather a bar, a plate or a ribbon."""
        mass, length, tip = self.strip_mass, self.centreline.length, self.tip
        thickest = max(self.sections, key=lambda section: section.total_thickness)
        thickness, width = thickest.total_thickness, thickest.width
        flat = isinstance(thickest, StripSection)
        size, arm = f"thickness is {thickness:g} m with its layers", max(self.tip_at, length - self.tip_at)
        reach = f"the {arm:g} m from support to tip"
        if tip.mass > mass:
            suspect(f"mass of the tip is {tip.mass:g} kg; it is heavier than the strip, {mass:g} kg")
        gyration = math.sqrt(tip.rotary_inertia / tip.mass) if tip.mass > 0.0 else 0.0
        if gyration > arm:
            words = f"its radius of gyration is {gyration:.2g} m, longer than {reach}"
            suspect(f"rotary_inertia of the tip is {tip.rotary_inertia:g} kg m^2; {words}")
        if flat and thickness > THICKEST * width:
            suspect(f"{size}; above {THICKEST:g} of the width {width:g} m it is a bar rather than a strip")
        if thickness > STOUTEST * length:
            words = f"above {STOUTEST:g} of the strip's length {length:g} m shear is no longer negligible"
            suspect(f"{size}; {words}")
        if arm > SLENDEREST * thickness:
            suspect(f"{size}; with {arm:g} m from support to tip the strip hangs under its own weight")
        if width > arm:
            suspect(f"width is {width:g} m, more than {reach}; it is a plate rather than a strip")

    @cached_property
    def point_at(self) -> dict[str, float]:
        """Arc lengths of `points` by name [m]."""
        found, line, length = dict[str, float](), self.centreline, self.centreline.length
        for name, place in self.points.items():
            field, taken = f"points[{name!r}]", name == "tip" or name in self.readouts
            require(not taken, field, "has the name of the tip or of a read-out; it must be another one")
            if not isinstance(place, tuple | list):
                found[name] = require_within(field, place, "m", low=0, high=length * (1.0 + 1e-12))
                continue
            found[name], away = line.nearest(place)
            words = f"is {shown(place)} m, {away:.3g} m from the centreline; it must lie on it"
            require(away <= 1e-6 * length, field, words)
        return found

    @property
    def places(self) -> list[tuple[float, Support]]:
        """Arc lengths of all supports [m], and their kinds."""
        ends = zip((0.0, self.centreline.length), self.supports, strict=True)
        return [*ends, *self.between.items()]

    @property
    def strip_mass(self) -> float:
        """Mass of the strip without the tip [kg]."""
        pieces = zip(self.sections, self.centreline.pieces, strict=True)
        return sum(section.mass_per_length * piece.length for section, piece in pieces)

    @property
    def rigid_motions(self) -> int:
        """Number of motions without strain that the supports allow; 0 if they hold the spring."""
        ends = np.array([s for s, _ in self.places])
        points = self.centreline.points(ends)[:, :2] / self.centreline.length
        by_rotation = np.stack([-points[:, 1], points[:, 0]], axis=1)
        rows = []
        for i, (_, support) in enumerate(self.places):
            t, n = (vectors[i, :2] for vectors in self.centreline.frame(ends))
            at_end = np.array([[*t, t @ by_rotation[i]], [*n, n @ by_rotation[i]], [0.0, 0.0, 1.0]])
            held = np.array(HELD[support][:3])
            held[0] |= self.centreline.is_straight
            rows.append(at_end[held])
        return 3 - int(np.linalg.matrix_rank(np.concatenate(rows), tol=1e-9))
