"""Natural modes of a discretized leaf spring.

K x = omega^2 M x with x^T M x = 1, lowest frequency first, is solved in the shifted and inverted form

    M x = mu (K + sigma M) x,   omega^2 = 1/mu - sigma,   sigma = min over pieces of EI / (m S^4) [1/s^2],

S the length of the strip. K + sigma M is positive definite even when the supports leave a rigid motion, and
the low modes, the ones that matter, are the large mu, so they come out with the smallest errors. (K itself
spans from the bending of the whole strip to the stretching of one element: twelve decades in omega^2.)

With e the drive direction and b the load of a unit base acceleration,

    phi_k = tip displacement of x_k along e [kg^(-1/2)],     Gamma_k = b^T x_k [kg^(1/2)].

A mode with phi = Gamma = 0 is uncoupled: neither the drive nor the stop can excite it. For the folded U
driven sideways these are the breathing modes: the legs move against each other, and the ball not sideways.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh

from .assembly import Discretization
from .parameters import InvalidValue, require_array, require_kind, require_whole
from .pieces import along

#: phi sqrt(m_total) and Gamma/sqrt(m_total) below this count as zero: far above rounding in symmetric springs
#: (about 1e-9), far below any coupling that matters to a motion.
COUPLING_TOLERANCE = 1e-6
#: Up to this many degrees of freedom LAPACK solves the full problem in a fraction of a second.
DENSE_LIMIT = 900


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapesAlong:
    """Mode shapes as vectors along the centreline.

    Parameters
    ----------
    s : ndarray, shape (n_points,)
        Arc length [m], increasing from 0.
    points, tangent, normal : ndarray, shape (n_points, 3)
        Reference points [m] and local frame; the third direction of the frame is z, along the width.
    displacement : ndarray, shape (n_modes, n_points, 3)
        Relative to the base [kg^(-1/2)]: times a modal coordinate it is in metres.
    rotation : ndarray, shape (n_modes, n_points)
        About z [kg^(-1/2) m^(-1)]: times a modal coordinate it is in radians.
    """

    s: NDArray[np.float64]
    points: NDArray[np.float64]
    tangent: NDArray[np.float64]
    normal: NDArray[np.float64]
    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Modes:
    """Mass-normalised modes, lowest first.

    The sign of each is fixed: phi >= 0, or Gamma >= 0 where phi is zero; an uncoupled mode first moves
    towards the positive normal.

    Parameters
    ----------
    discretization : Discretization
    omega : ndarray, shape (n_modes,)
        Angular frequencies [rad/s]; exactly 0 for rigid motions.
    shapes : ndarray, shape (n_dofs, n_modes)
        Columns x_k.
    phi, participation : ndarray, shape (n_modes,)
        [kg^(-1/2)], [kg^(1/2)]; exactly 0 in uncoupled modes.
    coupled : ndarray of bool, shape (n_modes,)
    readouts : dict of str to ndarray, shape (n_modes,)
        Values at the read-outs [kg^(-1/2), rotations kg^(-1/2) m^(-1)].
    """

    discretization: Discretization
    omega: NDArray[np.float64]
    shapes: NDArray[np.float64]
    phi: NDArray[np.float64]
    participation: NDArray[np.float64]
    coupled: NDArray[np.bool_]
    readouts: dict[str, NDArray[np.float64]]

    def __post_init__(self) -> None:
        require_kind("discretization", self.discretization, Discretization, "a Discretization")
        omega = require_array("omega", self.omega, "rad/s", dimensions=1, words="a row of numbers")
        require_array("phi", self.phi, "kg^(-1/2)", shape=omega.shape)
        require_array("participation", self.participation, "kg^(1/2)", shape=omega.shape)
        require_array("shapes", self.shapes, "kg^(-1/2)", shape=(self.discretization.n_dofs, omega.size))

    @property
    def frequencies_hz(self) -> NDArray[np.float64]:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    def loss_factors(self) -> NDArray[np.float64]:
        """Modal loss factors from strain energies [1], shape (n_modes,); 0 for rigid motions.

        The loss factors of the sections, weighted by their shares of the strain energy of mode k (C. D.
        Johnson and D. A. Kienholz, AIAA J. 20 (1982) 1284).
        """
        x, stiffness, loss = self.shapes, self.discretization.stiffness, self.discretization.loss_stiffness
        stored = np.einsum("ik,ik->k", x, stiffness @ x)
        lost = np.einsum("ik,ik->k", x, loss @ x)
        return np.divide(lost, stored, out=np.zeros_like(lost), where=self.omega > 0.0)

    def displacement_along(self, points_per_element: int = 4) -> ShapesAlong:
        """Return the shapes along the centreline, `points_per_element` equal steps to an element."""
        require_whole("points_per_element", points_per_element, "[1]", low=1)
        line, model = self.discretization.spring.centreline, self.discretization
        s, (moved, turned) = along(line, model.pieces, model.ties @ self.shapes, points_per_element)
        t, n = line.frame(s)
        return ShapesAlong(
            s=s, points=line.points(s), tangent=t, normal=n, displacement=moved, rotation=turned[..., 2]
        )


def natural_modes(discretization: Discretization, count: int) -> Modes:
    """Return the `count` lowest modes.

    Parameters
    ----------
    discretization : Discretization
    count : int
        From 1 to the number of degrees of freedom; trust the modes with four or more elements to a half wave.

    Raises
    ------
    ValueError
        Where rounding leaves no modes: lengths of elements that are too far apart.
    """
    require_kind("discretization", discretization, Discretization, "a Discretization, from assemble")
    size = discretization.n_dofs
    count = require_whole("count", count, "modes", high=size, why=", the degrees of freedom")
    spring = discretization.spring
    shift = (
        min(sec.bending_stiffness / sec.mass_per_length for sec in spring.sections)
        / spring.centreline.length**4
    )
    try:
        squares, shapes = lowest(
            discretization.stiffness, discretization.mass, shift, count, dense_limit=DENSE_LIMIT
        )
    except np.linalg.LinAlgError as error:
        sizes = [size for piece in discretization.pieces for size in np.diff(piece.nodes)]
        told = f"elements are {min(sizes):.3g} to {max(sizes):.3g} m long"
        raise InvalidValue(f"{told}; nearer to one another, or no modes are found to rounding") from error
    omega = np.sqrt(np.maximum(squares, 0.0))
    omega[: spring.rigid_motions] = 0.0
    shapes = shapes / np.sqrt(np.einsum("ik,ik->k", shapes, discretization.mass @ shapes))
    total = np.sqrt(spring.strip_mass + spring.tip.mass)
    phi, participation = discretization.tip @ shapes, discretization.base_load @ shapes
    moves, driven = (
        np.abs(phi) * total > COUPLING_TOLERANCE,
        np.abs(participation) / total > COUPLING_TOLERANCE,
    )
    telling = np.where(moves, phi, np.where(driven, participation, _first_swing(discretization, shapes)))
    sign = np.where(telling < 0.0, -1.0, 1.0)
    coupled = moves | driven
    shapes = shapes * sign
    return Modes(
        discretization=discretization,
        omega=omega,
        shapes=shapes,
        phi=np.where(moves, phi * sign, 0.0),
        participation=np.where(driven, participation * sign, 0.0),
        coupled=coupled,
        readouts={name: row @ shapes for name, row in discretization.readouts.items()},
    )


def lowest(
    stiffness: csr_array, mass: csr_array, shift: float, count: int, *, dense_limit: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the `count` lowest omega^2 [1/s^2] of K x = omega^2 M x, rising, and x, (n_dofs, count).

    Up to `dense_limit` unknowns, and for most of all modes, by the full matrices.
    """
    size = mass.shape[0]
    if size <= dense_limit or 2 * count > size:
        shifted = (stiffness + shift * mass).toarray()
        mu, x = eigh(mass.toarray(), shifted, subset_by_index=[size - count, size - 1])
        return 1.0 / mu[::-1] - shift, x[:, ::-1]
    start = np.cos(np.arange(size))  # fixed, so that results repeat, and orthogonal to no mode
    values, x = eigsh(stiffness.tocsc(), count, M=mass.tocsc(), sigma=-shift, v0=start)
    order = np.argsort(values)
    return values[order], x[:, order]


def _first_swing(discretization: Discretization, shapes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Displacement across the strip where, walking from s = 0, it first exceeds half its largest size."""
    line = discretization.spring.centreline
    s, (moved, _) = along(line, discretization.pieces, discretization.ties @ shapes, 2)
    w = np.einsum("kpc,pc->kp", moved, line.frame(s)[1])
    first = np.argmax(np.abs(w) > 0.5 * np.abs(w).max(axis=1, keepdims=True), axis=1)
    return w[np.arange(first.size), first]
