"""Natural modes of a discretized leaf spring.

The eigenvalue problem K x = omega^2 M x, x^T M x = 1, is solved in the shifted and inverted form

    M x = mu (K + sigma M) x,   omega^2 = 1/mu - sigma,   sigma = min over pieces of EI / (m S^4) [1/s^2],

S the length of the strip. With e the drive direction and b the load of a unit base acceleration,

    phi_k = tip displacement of x_k along e [kg^(-1/2)],     Gamma_k = b^T x_k [kg^(1/2)].

A mode with phi = Gamma = 0 is uncoupled, such as the breathing modes of a folded U driven sideways: the legs
move against each other, the ball does not sideways. Derivation: ``docs/theory/beam.md``.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array
from scipy.sparse.linalg import eigsh

from .assembly import Discretization
from .parameters import Array, InvalidValue, record, require_array, require_kind, require_whole
from .pieces import motion_along

#: phi sqrt(m_total) and Gamma/sqrt(m_total) below this count as zero. Rounding in symmetric springs gives
#: about 1e-9; a coupling that matters to a motion is far larger.
COUPLING_TOLERANCE = 1e-6
#: Up to this many degrees of freedom LAPACK solves the full problem in a fraction of a second.
DENSE_LIMIT = 900


@record
class ShapesAlong:
    """Mode shapes as vectors along the centreline.

    Parameters
    ----------
    s : ndarray, shape (n_points,)
        Arc length [m], increasing from 0.
    points, tangent, normal : ndarray, shape (n_points, 3)
        Points at rest [m] and unit vectors of the local frame [1]; its third direction is z, along the width.
    displacement : ndarray, shape (n_modes, n_points, 3)
        Displacement relative to the base [kg^(-1/2)]: times a modal coordinate it is in metres.
    rotation : ndarray, shape (n_modes, n_points)
        Rotation about z [kg^(-1/2) m^(-1)]: times a modal coordinate it is in radians.
    """

    s: Array
    points: Array
    tangent: Array
    normal: Array
    displacement: Array
    rotation: Array


@record
class Modes:
    """Mass-normalised modes of a leaf spring, lowest first.

    The sign of each mode is fixed: phi >= 0, or Gamma >= 0 where phi is zero. An uncoupled mode first moves
    towards the positive normal.

    Parameters
    ----------
    discretization : Discretization
        Finite-element model of the spring.
    omega : ndarray, shape (n_modes,)
        Angular frequencies [rad/s]; exactly 0 for rigid motions.
    shapes : ndarray, shape (n_dofs, n_modes)
        Columns x_k [kg^(-1/2)].
    phi, participation : ndarray, shape (n_modes,)
        Tip values phi_k [kg^(-1/2)] and participations Gamma_k [kg^(1/2)]; exactly 0 in uncoupled modes.
    coupled : ndarray of bool, shape (n_modes,)
        Whether the drive, the tip or a point of the spring can excite the mode.
    readouts : dict of str to ndarray, shape (n_modes,)
        Values at the read-outs and at the points of the spring [kg^(-1/2), rotations kg^(-1/2) m^(-1)].

    Raises
    ------
    ValueError
        If an array is not finite or has the wrong shape.
    TypeError
        If `discretization` is not a Discretization, or an array does not hold real numbers.
    """

    discretization: Discretization
    omega: Array
    shapes: Array
    phi: Array
    participation: Array
    coupled: NDArray[np.bool_]
    readouts: dict[str, Array]

    def __post_init__(self) -> None:
        require_kind("discretization", self.discretization, Discretization, "a Discretization")
        omega = require_array("omega", self.omega, "rad/s", dimensions=1, words="a row of numbers")
        require_array("phi", self.phi, "kg^(-1/2)", shape=omega.shape)
        require_array("participation", self.participation, "kg^(1/2)", shape=omega.shape)
        require_array("shapes", self.shapes, "kg^(-1/2)", shape=(self.discretization.n_dofs, omega.size))

    @property
    def frequencies_hz(self) -> Array:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    def loss_factors(self) -> Array:
        """Return the modal loss factors [1], shape (n_modes,); 0 for rigid motions.

        They are the loss factors of the sections, weighted by their shares of the strain energy of mode k (C.
        D. Johnson and D. A. Kienholz, AIAA J. 20 (1982) 1284).
        """
        x, full = self.shapes, self.discretization
        stored, lost = (np.einsum("ik,ik->k", x, k @ x) for k in (full.stiffness, full.loss_stiffness))
        return np.divide(lost, stored, out=np.zeros_like(lost), where=self.omega > 0.0)

    def displacement_along(self, points_per_element: int = 4) -> ShapesAlong:
        """Return the shapes along the centreline, at `points_per_element` equal steps in each element.

        The result is a `ShapesAlong` with n_points = n_elements points_per_element + 1.
        """
        require_whole("points_per_element", points_per_element, "[1]", low=1)
        line, model = self.discretization.spring.centreline, self.discretization
        s, (d, theta) = motion_along(line, model.pieces, model.ties @ self.shapes, points_per_element)
        t, n, points = *line.frame(s), line.points(s)
        return ShapesAlong(s=s, points=points, tangent=t, normal=n, displacement=d, rotation=theta[..., 2])


def natural_modes(discretization: Discretization, count: int) -> Modes:
    """Return the lowest natural modes of a discretized leaf spring.

    Parameters
    ----------
    discretization : Discretization
        Finite-element model from `assemble`.
    count : int
        Number of modes, from 1 to the number of degrees of freedom. A mode is accurate with four or more
        elements in each half wave.

    Returns
    -------
    Modes
        Frequencies and mass-normalised shapes, lowest first.

    Raises
    ------
    ValueError
        If `count` is out of range, or the lengths of the elements differ so much that rounding hides the
        modes.
    TypeError
        If `discretization` is not a Discretization, or `count` is not a number.

    See Also
    --------
    assemble : The step before, the finite-element model.
    reduce : The next step, the modal model.
    exact_modes : Modes of the uniform straight beam from its frequency equation.

    Examples
    --------
    >>> from beam import STEEL, StripSection, Tip, assemble, cantilever, natural_modes
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip, tip=Tip(mass=2e-3))), count=3)
    >>> [round(f, 1) for f in modes.frequencies_hz.tolist()]
    [12.7, 93.5, 279.2]
    >>> modes.coupled.tolist()
    [True, True, True]
    """
    require_kind("discretization", discretization, Discretization, "a Discretization, from assemble")
    size = discretization.n_dofs
    count = require_whole("count", count, "modes", high=size, why=", the degrees of freedom")
    spring, length = discretization.spring, discretization.spring.centreline.length
    stiffness, mass = discretization.stiffness, discretization.mass
    shift = min(sec.bending_stiffness / sec.mass_per_length for sec in spring.sections) / length**4
    try:
        squares, shapes = lowest_modes(stiffness, mass, shift, count, dense_limit=DENSE_LIMIT)
    except np.linalg.LinAlgError as error:
        sizes = [size for piece in discretization.pieces for size in np.diff(piece.nodes)]
        found = f"elements are {min(sizes):.3g} to {max(sizes):.3g} m long"
        raise InvalidValue(f"{found}; with lengths so far apart, rounding hides the modes") from error
    omega = np.sqrt(np.maximum(squares, 0.0))
    omega[: spring.rigid_motions] = 0.0
    shapes = shapes / np.sqrt(np.einsum("ik,ik->k", shapes, mass @ shapes))
    total = np.sqrt(spring.strip_mass + spring.tip.mass)
    phi, participation = discretization.tip @ shapes, discretization.base_load @ shapes
    moves = np.abs(phi) * total > COUPLING_TOLERANCE
    driven = np.abs(participation) / total > COUPLING_TOLERANCE
    readouts = {name: row @ shapes for name, row in discretization.readouts.items()}
    pushed = [np.abs(readouts[name]) * total > COUPLING_TOLERANCE for name in spring.points]
    readouts |= {name: readouts[name] * moved for name, moved in zip(spring.points, pushed, strict=True)}
    leading = np.where(moves, phi, np.where(driven, participation, _first_deflection(discretization, shapes)))
    sign = np.where(leading < 0.0, -1.0, 1.0)
    shapes = shapes * sign
    return Modes(
        discretization=discretization,
        omega=omega,
        shapes=shapes,
        phi=np.where(moves, phi * sign, 0.0),
        participation=np.where(driven, participation * sign, 0.0),
        coupled=np.any([moves, driven, *pushed], axis=0),
        readouts={name: row * sign for name, row in readouts.items()},
    )


def lowest_modes(
    stiffness: csr_array, mass: csr_array, shift: float, count: int, *, dense_limit: int
) -> tuple[Array, Array]:
    """Return the `count` lowest omega^2 [1/s^2] of K x = omega^2 M x, rising, and x, (n_dofs, count).

    Full matrices are used up to `dense_limit` unknowns, and where more than half of all modes are wanted.
    """
    size = mass.shape[0]
    if size <= dense_limit or 2 * count > size:
        shifted = (stiffness + shift * mass).toarray()
        mu, x = eigh(mass.toarray(), shifted, subset_by_index=[size - count, size - 1])
        return 1.0 / mu[::-1] - shift, x[:, ::-1]
    start = np.cos(np.arange(size))  # fixed, so that results repeat; orthogonal to no mode
    values, x = eigsh(stiffness.tocsc(), count, M=mass.tocsc(), sigma=-shift, v0=start)
    order = np.argsort(values)
    return values[order], x[:, order]


def _first_deflection(discretization: Discretization, shapes: Array) -> Array:
    """Return w of each shape where |w|, from s = 0 on, first exceeds half its maximum; shape (n_modes,)."""
    line = discretization.spring.centreline
    s, (displacement, _) = motion_along(line, discretization.pieces, discretization.ties @ shapes, 2)
    w = np.einsum("kpc,pc->kp", displacement, line.frame(s)[1])
    first = np.argmax(np.abs(w) > 0.5 * np.abs(w).max(axis=1, keepdims=True), axis=1)
    return w[np.arange(first.size), first]
