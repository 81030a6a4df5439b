"""Quadratic hexahedra swept along a plane centreline.

The profile is a rectangle in the plane of (y, z) [m]; only its half z >= 0 is meshed. With r(s), t and n of
the centreline, a point of the box (s, y, z) goes to

    x(s, y, z) = r(s) + y n(s) + z e_z,      |dx/d(s, y, z)| = 1 - k y,

at all 27 nodes of each element, so that faces follow the arc to third order in the length of an element. The
mapping is one to one while k y < 1: the profile must not reach the centre of the bend.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import skfem as sk
from numpy.typing import NDArray

from beam import Centreline, InvalidValue

Profile = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Half of a cross-section: grid lines y and z [m], rising, z from 0 on, that cut it into rectangles."""


def sweep(
    profile: Profile, line: Centreline, elements: Sequence[int], *, tip_at: float,
    halvings: tuple[int, int] = (0, 0),
) -> sk.MeshHex2:  # fmt: skip
    """Return the half z >= 0 of the profile swept along the line, with so many elements on each of its
    pieces.

    The cross-sections "start", "tip" (at the arc length `tip_at` [m]) and "end" are named faces. The first
    and the last element are halved `halvings` times towards the ends: stresses are singular at the edges of a
    clamp. ValueError if the profile reaches the centre of a bend, or no elements meet at the tip.
    """
    reach = float(np.max(np.outer(line.curvatures, profile[0])))
    if reach >= 1.0:
        raise InvalidValue(f"y reaches {reach:.3g} bend radii [1]; it must stay below 1")
    joints = line.joints
    pieces = zip(joints[:-1], joints[1:], elements, strict=True)
    s = np.concatenate([[0.0], *(np.linspace(start, end, n + 1)[1:] for start, end, n in pieces)])
    first, last = (0.5 ** np.arange(1, count + 1) for count in halvings)
    s = np.sort(np.concatenate((s, s[1] * first, s[-1] - (s[-1] - s[-2]) * last)))
    faces = {
        name: lambda x, at=at: np.abs(x[0] - at) < 1e-9 * line.length
        for name, at in (("start", 0.0), ("tip", tip_at), ("end", line.length))
    }
    box = sk.MeshHex2.from_mesh(sk.MeshHex.init_tensor(s, *profile)).with_boundaries(faces, False)
    if not box.boundaries["tip"].size:
        raise InvalidValue(
            f"tip_at is {tip_at} m; the nearest elements meet {np.abs(s - tip_at).min()} m off"
        )
    s_of, y, z = box.doflocs
    s_of = np.clip(s_of, 0.0, line.length)
    places = line.points(s_of) + y[:, None] * line.frame(s_of)[1]
    places[:, 2] += z
    return replace(box, doflocs=np.ascontiguousarray(places.T))
