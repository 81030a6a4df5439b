"""From space to the points of a picture: a parallel projection.

With unit vectors r to the right, u upwards and c towards the viewer, a point p appears at

    column = width/2 + s r.(p - p_0),   row = height/2 - s u.(p - p_0),   s in points per metre,

and the larger c.p, the nearer it is. There is no perspective: equal lengths in a plane across c stay equal,
and what VTK draws and what matplotlib draws lie on one another.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["View", "view_of"]

TOWARDS_VIEWER = (0.20, -0.25, 0.95)
"""Shares of the directions along the spring, of the drive and across the strip: from above, a little from
the side on which the plate is not, so that the gap is seen open."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A parallel projection.

    Parameters
    ----------
    centre : ndarray, shape (3,)
        Seen in the middle of the picture [m].
    right, up, towards : ndarray, shape (3,)
        Unit vectors.
    scale : float
        Points of the picture per metre.
    width, height : int
        Of the picture in points.
    """

    centre: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]
    towards: NDArray[np.float64]
    scale: float
    width: int
    height: int

    def places(self, points: ArrayLike) -> NDArray[np.float64]:
        """Column and row of points (..., 3) [m], shape (..., 2)."""
        away = np.asarray(points, dtype=np.float64) - self.centre
        column = 0.5 * self.width + self.scale * (away @ self.right)
        row = 0.5 * self.height - self.scale * (away @ self.up)
        return np.stack([column, row], axis=-1)

    def nearness(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distance towards the viewer of points (..., 3) [m], shape (...)."""
        return (np.asarray(points, dtype=np.float64) - self.centre) @ self.towards


def view_of(
    points: ArrayLike, drive: tuple[float, float], *, width: int, height: int, margin: float = 0.04
) -> View:
    """The view that holds all `points` (n, 3) [m] with `margin` of the picture free on every side.

    The spring runs to the right, and the drive points upwards.
    """
    along, push = np.array([drive[1], -drive[0], 0.0]), np.array([drive[0], drive[1], 0.0])
    towards = TOWARDS_VIEWER[0] * along + TOWARDS_VIEWER[1] * push + TOWARDS_VIEWER[2] * np.array([0.0, 0, 1])
    towards /= np.linalg.norm(towards)
    right = along - (along @ towards) * towards
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    cloud = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    axes = np.stack([right, up, towards])
    low, high = (cloud @ axes.T).min(axis=0), (cloud @ axes.T).max(axis=0)
    extent = np.maximum(high - low, 1e-9)
    scale = (1.0 - 2.0 * margin) * min(width / extent[0], height / extent[1])
    return View(
        centre=0.5 * (low + high) @ axes, right=right, up=up, towards=towards, scale=float(scale),
        width=width, height=height,
    )  # fmt: skip
