"""Sheet of a reading at rest and in one mode, as a net of points for drawing.

Across the sheet run points of its middle line, c = y n + z e_z from the centroid; sections move as wholes,

    x = r(s) + c,      x + d + theta x c      [m],

d and theta of the mode scaled so that no point of the net moves farther than a given part of the length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beam.space import SpatialModes, channel_centroid
from studies.instruments.spring_shape.readings import Shape

POINTS_ACROSS = 5


def middle_line(shape: Shape) -> NDArray[np.float64]:
    """Points (y, z) across the sheet [m], shape (n_across, 2)."""
    half = 0.5 * shape.width
    if shape.reading == "channel":
        sizes = {"width": shape.width, "flange": shape.flange, "thickness": shape.thickness}
        web = -channel_centroid(**sizes)
        edge = web + 0.5 * shape.thickness + shape.flange
        z = np.linspace(-half, half, POINTS_ACROSS)
        inner = np.stack([np.full_like(z, web), z], axis=1)
        return np.concatenate(([[edge, -half]], inner, [[edge, half]]))
    across = np.linspace(-half, half, POINTS_ACROSS)
    still = np.zeros_like(across)
    return np.stack([across, still] if shape.reading == "side_by_side" else [still, across], axis=1)


def net_of(
    shape: Shape, modes: SpatialModes, mode: int, largest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Net at rest and moved [m], each (n_along, n_across, 3), the largest step `largest` times the length."""
    s, points, displacement, rotation = modes.along(1)
    _, n = shape.centreline.frame(s)
    across = middle_line(shape)
    arm = across[None, :, :1] * n[:, None, :] + across[None, :, 1:] * np.array([0.0, 0.0, 1.0])
    step = displacement[mode][:, None, :] + np.cross(rotation[mode][:, None, :], arm)
    step *= largest * shape.length / np.linalg.norm(step, axis=2).max()
    rest = points[:, None, :] + arm
    return rest, rest + step
