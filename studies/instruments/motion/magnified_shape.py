"""The spring as it is drawn: higher modes enlarged, tip and contact to scale.

The motion is split into the shape of mode 1 that carries the whole tip displacement x = sum_k phi_k q_k, and
the departure from it, which leaves the tip where it is:

    w(p) = (x / phi_1) Phi_1(p) + h(p),    h(p) = sum_{k >= 2} q_k [Phi_k(p) - (phi_k / phi_1) Phi_1(p)].

Drawn is (x / phi_1) Phi_1 + M h. The ball is drawn where the tip is, and does not turn; with any M it meets
the plate when, and only when, the computed tip meets it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam import Modes
from beam.spring_mesh import SpringMesh
from studies.instruments.motion.time_law import round_number

__all__ = ["MagnifiedShape", "magnified_shape"]

LARGEST = 0.07
"""Largest enlarged departure over the greatest extent of the strip."""

MOST = 100.0
"""Enlargement beyond which nothing is drawn: there are no higher modes to be seen then."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MagnifiedShape:
    """Displacements of the points of a mesh.

    Parameters
    ----------
    first : ndarray, shape (n_points, 3)
        Phi_1 / phi_1: the displacement for one metre at the tip [1].
    departures : ndarray, shape (n_modes, n_points, 3)
        Phi_k - (phi_k / phi_1) Phi_1 [kg^(-1/2)].
    phi : ndarray, shape (n_modes,)
        Tip values [kg^(-1/2)].
    magnification : float
        M [1].
    """

    first: NDArray[np.float64]
    departures: NDArray[np.float64]
    phi: NDArray[np.float64]
    magnification: float

    def displacement(
        self, coordinates: NDArray[np.float64], *, magnified: bool = True
    ) -> NDArray[np.float64]:
        """Displacements (n_points, 3) [m] relative to the base for the modal coordinates (n_modes,)."""
        departure = np.tensordot(coordinates, self.departures, axes=1)
        return float(coordinates @ self.phi) * self.first + (
            self.magnification if magnified else 1.0
        ) * departure


def magnified_shape(
    mesh: SpringMesh, modes: Modes, coordinates: NDArray[np.float64], magnification: float | None = None
) -> MagnifiedShape:
    """The drawn shape for a motion with modal coordinates (n_frames, n_modes) of the coupled modes.

    M is the largest round number with which the departures stay below `LARGEST`, unless it is given.
    """
    count = coordinates.shape[1]
    kept = np.flatnonzero(modes.coupled)[:count]
    phi = modes.phi[kept]
    first = mesh.shapes[kept[0]] / phi[0]
    departures = mesh.shapes[kept] - phi[:, None, None] * first
    departures[0] = 0.0
    if magnification is None:
        strip = np.unique(mesh.hexahedra)
        largest = max(
            float(np.linalg.norm(np.tensordot(row, departures[:, strip], axes=1), axis=1).max())
            for row in coordinates
        )
        room = LARGEST * float(np.ptp(mesh.points[strip], axis=0).max())
        magnification = min(MOST, max(1.0, round_number(room / largest, up=False))) if largest > 0.0 else 1.0
    return MagnifiedShape(first=first, departures=departures, phi=phi, magnification=magnification)
