r"""Multipliers of an orbit with one impact under Newton's law: the saltation matrix.

An orbit beside this one meets the wall at another time. To first order its distance
(dq, dq') at the impact is multiplied by the saltation matrix

    S = [[1, 0], [0, P]] + [-(1 + e) phi/sum phi^2; (a+ - P a-)/v] (phi, 0)^T,
    P = 1 - (1 + e) phi phi^T/sum phi^2

with the modal accelerations a-, a+ before and after, which include the drive: the column is the mismatch of
the motions on both sides, in q and in q'. The multipliers are the eigenvalues of Phi S, Phi the free flow of
all modes over m/f. For one mode det(Phi S) = e^2 G. The eigenvalues of P are 1 and
-e, so that det S = e^2 for any number of modes.

Sources: M. A. Aizerman and F. R. Gantmacher, Quart. J. Mech. Appl. Math. 11 (1958) 243; A. B. Nordmark,
J. Sound Vib. 145 (1991) 279. Units: SI with mass-normalised modes (q in m kg^0.5).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require, require_array, require_within

__all__ = ["monodromy", "newton_saltation", "sorted_multipliers"]

Array = NDArray[np.float64]


def newton_saltation(phi: Array, restitution: float, before: Array, after: Array, speed: float) -> Array:
    """S in (q, q') of all modes, shape (2 n_modes, 2 n_modes).

    Parameters
    ----------
    phi : ndarray, shape (n_modes,)
    restitution : float
    before, after : ndarray, shape (n_modes,)
        Modal accelerations just before and just after the impact [m kg^0.5/s^2].
    speed : float
        Approach speed v [m/s].
    """
    phi = require_array("phi", phi, "kg^-0.5", dimensions=1, words="a row of numbers")
    before = require_array("before", before, "m kg^0.5/s^2", shape=phi.shape, words="a row of numbers")
    after = require_array("after", after, "m kg^0.5/s^2", shape=phi.shape, words="a row of numbers")
    require_within("restitution", restitution, "[1]", low=0, high=1)
    require_within("speed", speed, "m/s", above=0)
    require(bool(np.any(phi != 0.0)), "phi is zero in every mode; the tip must move in one of them")
    n = phi.size
    project = np.eye(n) - (1.0 + restitution) / (phi @ phi) * np.outer(phi, phi)
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, :n] = project
    matrix[n:, :n] = np.outer((after - project @ before) / speed, phi)
    matrix[n:, n:] = project
    return matrix


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
