"""Plane curves made of straight pieces and circular arcs.

A centreline lies in the x-y plane, with arc length s [m]. theta(s) is the angle of its tangent to the x axis
[rad], k(s) = theta'(s) its curvature [1/m], positive where it turns left:

    t = (cos theta, sin theta, 0),   n = (-sin theta, cos theta, 0),   t x n = (0, 0, 1),
    r' = t,   t' = k n,   n' = -k t.

Each piece has constant curvature. Pieces join with a common tangent: k may jump, t may not. The width of the
strip lies along z.
"""

import math
from dataclasses import field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .parameters import Array, InvalidValue, record, require, require_array, require_each, require_within


@record(eq=True)
class Straight:
    """A straight piece of a centreline.

    Parameters
    ----------
    length : float
        Length [m], positive.

    Attributes
    ----------
    curvature : float
        Always 0 [1/m].

    Raises
    ------
    ValueError
        If `length` is not finite and positive.
    TypeError
        If `length` is not a number.
    """

    length: float
    curvature: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        require_within("length", self.length, "m", above=0)


@record(eq=True)
class Arc:
    """A circular arc of a centreline.

    Parameters
    ----------
    radius : float
        Radius [m], positive.
    angle : float
        Rotation of the tangent [rad], positive to the left, negative to the right, not zero.

    Raises
    ------
    ValueError
        If `radius` is not finite and positive, or `angle` is not finite or is zero.
    TypeError
        If a value is not a number.
    """

    radius: float
    angle: float

    def __post_init__(self) -> None:
        require_within("radius", self.radius, "m", above=0)
        angle = require_within("angle", self.angle, "rad")
        require(angle != 0.0, "angle", f"is {self.angle} rad; it must be finite and not zero")

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return self.radius * abs(self.angle)

    @property
    def curvature(self) -> float:
        """Signed curvature [1/m]."""
        return math.copysign(1.0 / self.radius, self.angle)


@record(eq=True)
class Centreline:
    """A plane curve of pieces that are joined end to end with a common tangent.

    Parameters
    ----------
    pieces : sequence of Straight and Arc
        Pieces in their order, at least one; stored as a tuple.
    start : tuple of two floats
        Point (x, y) at s = 0 [m].
    heading : float
        Angle of the tangent to the x axis at s = 0 [rad].

    Raises
    ------
    ValueError
        If there is no piece, or `start` or `heading` is not finite.
    TypeError
        If `pieces` holds something else than Straight and Arc, or a value is not a number.
    """

    pieces: tuple[Straight | Arc, ...]
    start: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0

    def __post_init__(self) -> None:
        pieces = require_each("pieces", self.pieces, (Straight, Arc), "a sequence of Straight and Arc")
        object.__setattr__(self, "pieces", pieces)
        require(bool(pieces), "pieces", "is empty [no unit]; a centreline needs at least one Straight or Arc")
        require_array("start", self.start, "m", shape=(2,), words="a point (x, y), two finite numbers")
        require_within("heading", self.heading, "rad")

    @property
    def joints(self) -> Array:
        """Arc lengths of the ends of the pieces [m], shape (n_pieces + 1,), from 0 to `length`."""
        return np.concatenate(([0.0], np.cumsum([piece.length for piece in self.pieces])))

    @property
    def length(self) -> float:
        """Total arc length [m]."""
        return float(self.joints[-1])

    @property
    def curvatures(self) -> Array:
        """Signed curvature of each piece [1/m], shape (n_pieces,)."""
        return np.array([piece.curvature for piece in self.pieces])

    @property
    def is_straight(self) -> bool:
        """Whether no piece is curved."""
        return not np.any(self.curvatures)

    def piece_at(self, s: ArrayLike) -> NDArray[np.intp]:
        """Return the index of the piece at each arc length s [m]; at a joint, of the piece that starts there.

        An arc length off the curve by more than rounding raises ValueError.
        """
        s = require_array("s", s, "m", words="arc lengths")
        outside = (s < -1e-12 * self.length) | (s > (1.0 + 1e-12) * self.length)
        if np.any(outside):
            raise InvalidValue("s", f"is {s[outside].flat[0]} m; it must lie between 0 and {self.length} m")
        inside = np.searchsorted(self.joints, s, side="right") - 1
        return np.clip(inside, 0, len(self.pieces) - 1)

    def angle(self, s: ArrayLike) -> Array:
        """Return the angle of the tangent to the x axis [rad], same shape as s."""
        at, s = self.piece_at(s), np.asarray(s, dtype=np.float64)
        turns = self.heading + np.concatenate(([0.0], np.cumsum(self.curvatures * np.diff(self.joints))))
        return turns[at] + self.curvatures[at] * (s - self.joints[at])

    def frame(self, s: ArrayLike) -> tuple[Array, Array]:
        """Return tangents and normals [1], each of shape (..., 3)."""
        theta = self.angle(s)
        cos, sin, zero = np.cos(theta), np.sin(theta), np.zeros_like(theta)
        return np.stack([cos, sin, zero], axis=-1), np.stack([-sin, cos, zero], axis=-1)

    def axes(self, s: ArrayLike) -> Array:
        """Return the rows t, n and e_z of the frame [1], shape (..., 3, 3)."""
        t, n = self.frame(s)
        return np.stack([t, n, np.broadcast_to([0.0, 0.0, 1.0], t.shape)], axis=-2)

    def points(self, s: ArrayLike) -> Array:
        """Return the points r(s) in space [m], shape (..., 3).

        The chord over d = s - s_i of a piece is parallel to the tangent at its middle:
        r = r_i + d sinc(k d / 2) t(s_i + d / 2).
        """
        at, ends, s = self.piece_at(s), self.joints, np.asarray(s, dtype=np.float64)
        chords = _chord(np.diff(ends), self.curvatures, self.angle(ends[:-1]))
        corners = np.array([*self.start, 0.0]) + np.concatenate((np.zeros((1, 3)), np.cumsum(chords, axis=0)))
        return corners[at] + _chord(s - ends[at], self.curvatures[at], self.angle(ends[:-1])[at])

    def nearest(self, point: ArrayLike) -> tuple[float, float]:
        """Return the arc length [m] of the place nearest to a `point` (x, y) [m], and its distance [m].

        A piece of curvature k reaches the direction of the point from its centre after the angle k d.
        """
        given = require_array("point", point, "m", shape=(2,), words="a point (x, y), two finite numbers")
        places = [*self.joints.tolist()]
        for piece, start in zip(self.pieces, self.joints[:-1].tolist(), strict=True):
            t, n = (vector[:2] for vector in self.frame(start))
            offset, k = given - self.points(start)[:2], piece.curvature
            d = t @ offset if k == 0.0 else np.arctan2(k * (t @ offset), 1.0 - k * (n @ offset)) / k
            d = d % (2.0 * np.pi / abs(k)) if k != 0.0 else d
            places += [start + float(d)] if 0.0 < d < piece.length else []
        away = np.hypot(*(self.points(np.array(places))[:, :2] - given).T)
        return places[int(np.argmin(away))], float(away.min())


def _chord(d: Array, curvature: Array, heading: Array) -> Array:
    """Return the chord [m], shape (..., 3), of an arc of length d that starts at the angle `heading`."""
    half = 0.5 * curvature * d
    angle = heading + half
    direction = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    return (d * np.sinc(half / np.pi))[..., None] * direction
