"""Multipliers of an orbit with one impact: the free flow of all modes after a saltation matrix.

An orbit beside this one meets the wall at another time: to first order its distance (dq, dq') at the impact
is multiplied by a saltation matrix S (under Newton's law that of ``contact.touch.newton``, of determinant e^2
for any number of modes).  The multipliers are the eigenvalues of Phi S, Phi the free flow over m/f; for one
mode det(Phi S) = e^2 G.  Units: SI with mass-normalised modes (q in m kg^0.5).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require_array

__all__ = ["monodromy", "sorted_multipliers"]

Array = NDArray[np.float64]


def monodromy(flow: Array, saltation: Array) -> Array:
    """Phi S, from the flows of the modes, shape (n_modes, 2, 2), and the saltation matrix."""
    flow = require_array("flow", flow, "[1]", dimensions=3, words="a flow (2, 2) for each mode")
    size = 2 * len(flow)
    saltation = require_array("saltation", saltation, "[1]", shape=(size, size), words="a square matrix")
    free = np.block([[np.diag(flow[:, i, j]) for j in range(2)] for i in range(2)])
    return np.asarray(free @ saltation)


def sorted_multipliers(matrix: Array) -> NDArray[np.complex128]:
    """Eigenvalues, largest modulus first."""
    square = require_array("matrix", matrix, "[1]", dimensions=2, words="a square matrix")
    if square.shape[0] != square.shape[1]:
        raise ValueError(f"matrix has shape {square.shape}; it must be a square matrix")
    values = np.linalg.eigvals(square).astype(complex)
    return np.asarray(values[np.argsort(-np.abs(values))])
