"""Finite-element model of a leaf spring: pieces of strip, tied together, with supports and tip.

Each piece of the centreline has elements of its own (`strip_element`), tied together by T (`pieces`):

    K = T^T K_pieces T,     M = T^T M_pieces T + the tip,     b = T^T b_pieces + the tip.

At its place the tip, of mass M_t [kg] and rotary inertia J [kg m^2], adds for test functions (v, z) and the
drive direction e

    M_t (u.. v + w.. z) + J (w' + k u)..(z' + k v)  =  -z_base.. M_t (e_t v + e_n z).
"""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from .parameters import Array, record, require, require_array, require_kind, shown
from .pieces import meshed_pieces, motion_at, shared_elements, tie_matrix, tied_matrices
from .spring import HELD, LeafSpring, Readout, Tip
from .strip_element import PieceMesh


@record
class Discretization:
    """A leaf spring in n_dofs degrees of freedom with its supports: M x'' + K x = -b z'' + tip * force.

    Parameters
    ----------
    spring : LeafSpring
        The spring that is discretized.
    stiffness, mass : sparse array, shape (n_dofs, n_dofs)
        Matrices K [N/m] and M [kg, for displacements], with the mass and the rotary inertia of the tip.
    loss_stiffness : sparse array, shape (n_dofs, n_dofs)
        Matrix K with each stiffness times its loss factor [N/m].
    base_load : ndarray, shape (n_dofs,)
        Load b of a unit acceleration of the base [kg].
    tip : ndarray, shape (n_dofs,)
        Row of the tip [1]: its displacement in the drive direction is ``tip @ x`` [m].
    readouts : dict of str to ndarray, shape (n_dofs,)
        Rows of the read-outs and of the points of the spring: their values are row times x [m or rad].
    pieces : tuple of PieceMesh
        Meshed pieces of the centreline.
    ties : sparse array, shape (unknowns of all pieces, n_dofs)
        Matrix T: the unknowns of all pieces, end to end, are ``ties @ x``.

    Raises
    ------
    ValueError
        If a matrix or a row has another size than `tip`, or a row is not finite.
    TypeError
        If `spring` is not a LeafSpring, or a row does not hold real numbers.
    """

    spring: LeafSpring
    stiffness: csr_array
    mass: csr_array
    loss_stiffness: csr_array
    base_load: Array
    tip: Array
    readouts: dict[str, Array]
    pieces: tuple[PieceMesh, ...]
    ties: csr_array

    def __post_init__(self) -> None:
        require_kind("spring", self.spring, LeafSpring, "a LeafSpring")
        tip = require_array("tip", self.tip, "[1]", dimensions=1, words="a row of numbers")
        require_array("base_load", self.base_load, "kg", shape=tip.shape, words="a row of numbers")
        for name in ("stiffness", "mass", "loss_stiffness"):
            shape = getattr(getattr(self, name), "shape", None)
            square = 2 * tip.shape
            require(shape == square, name, f"has shape {shape}; it must be a matrix of shape {square}")

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom."""
        return self.tip.size

    def static_compliance(self, point: str | None = None) -> float | None:
        """Return the displacement of the tip, or of a named point, per unit static force there [m/N].

        The result is None if the supports leave a rigid motion. An unknown name raises ValueError.
        """
        if self.spring.rigid_motions:
            return None
        known = ", ".join(self.readouts) or "none but the tip"
        require(point is None or point in self.readouts, "point", f"is {shown(point)}; points are {known}")
        row = self.tip if point is None else self.readouts[point]
        return float(row @ splu(self.stiffness.tocsc()).solve(row))

    def strain_energies(self, shapes: Array) -> Array:
        """Return the strain energies of `shapes`, computed from their strains rather than from K.

        Parameters
        ----------
        shapes : ndarray, shape (n_dofs, n)
            Displacements, one motion in each column [m].

        Returns
        -------
        ndarray, shape (2, n_pieces, n)
            Energies of stretching and of bending of each piece [J]. Their sum is x^T K x / 2 with some four
            more digits, which K loses to the stiffness of single elements.
        """
        energies, first, unknowns = [], 0, self.ties @ shapes
        for piece in self.pieces:
            energies.append(piece.strain_energies(unknowns[first : first + piece.size]))
            first += piece.size
        return np.stack(energies, axis=1)


def default_elements(spring: LeafSpring) -> tuple[int, ...]:
    """Return the number of elements on each piece of a spring that `assemble` takes by default.

    The straight pieces share 120 by length: four for each half wave of mode 30. An arc of any size has 48 for
    each half turn: a cubic w follows the rigid motion of an arc element of angle a only to order a^4. The
    spurious bending of this error must stay small beside the small true bending of a tight bend.

    Parameters
    ----------
    spring : LeafSpring
        The spring to discretize.

    Returns
    -------
    tuple of int, length n_pieces
        Number of elements on each piece of the centreline.

    Raises
    ------
    TypeError
        If `spring` is not a LeafSpring.
    """
    require_kind("spring", spring, LeafSpring, "a LeafSpring")
    return shared_elements(spring.centreline, 120, 48)


def assemble(
    spring: LeafSpring, elements: int | Sequence[int] | None = None, *, shortening: bool = False
) -> Discretization:
    """Return the finite-element model of a leaf spring.

    Parameters
    ----------
    spring : LeafSpring
        The spring to discretize.
    elements : int or sequence of int, optional
        Elements on every piece, or one number for each; `default_elements` by default. Inside a piece the
        node nearest to the tip is moved there.
    shortening : bool
        Whether to keep the motion along a straight strip too, which only finite rotations excite.

    Returns
    -------
    Discretization
        Matrices and rows in n_dofs degrees of freedom, with the supports built in.

    Raises
    ------
    ValueError
        If `elements` is not from 1 to 100 000, or does not hold one number for each piece.
    TypeError
        If `spring` is not a LeafSpring, or `elements` holds something else than numbers.

    See Also
    --------
    default_elements : Number of elements on each piece by default.
    natural_modes : The next step, the natural modes.
    FiniteRotation : The same spring at finite rotations.

    Notes
    -----
    Rounding errors grow as the fourth power of the number of elements on the strip. They are 2e-7 of the
    first frequency at 300 elements, and 5e-5 at 1200.

    Examples
    --------
    The static compliance of a cantilever with a force at its end is L^3/(3 EI):

    >>> from beam import STEEL, StripSection, assemble, cantilever
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> model = assemble(cantilever(length=0.15, section=strip), elements=20)
    >>> model.n_dofs
    40
    >>> print(f"{model.static_compliance():.5f}", f"{0.15**3 / (3 * strip.bending_stiffness):.5f}")
    0.04286 0.04286
    """
    require_kind("spring", spring, LeafSpring, "a LeafSpring")
    line, drive = spring.centreline, np.array([*spring.drive, 0.0])
    pieces = meshed_pieces(PieceMesh, spring, default_elements(spring) if elements is None else elements)
    held = np.array([HELD[support][:3] for support in spring.supports])
    between = {s: np.array(HELD[support][:3]) for s, support in spring.between.items()}
    ties = tie_matrix(pieces, held, line.is_straight and not shortening, between)
    stiffness, mass, loss = tied_matrices(pieces, ties)
    motion = motion_at(line, pieces, ties, spring.tip_at)
    tip, matrices = drive @ motion[:3], (stiffness, mass + tip_inertia(spring.tip, motion), loss)
    stiffness, mass, loss = (csr_array(0.5 * (matrix + matrix.T)) for matrix in matrices)
    readouts, points = {}, {name: Readout(at=at) for name, at in spring.point_at.items()}
    for name, readout in {**spring.readouts, **points}.items():
        motion = motion_at(line, pieces, ties, readout.at)
        readouts[name] = motion[5] if readout.quantity == "rotation" else drive @ motion[:3]
    loads = np.concatenate([piece.base_load(line, drive) for piece in pieces])
    return Discretization(
        spring=spring,
        stiffness=stiffness,
        mass=mass,
        loss_stiffness=loss,
        base_load=ties.T @ loads + spring.tip.mass * tip,
        tip=tip,
        readouts=readouts,
        pieces=pieces,
        ties=ties,
    )


def tip_inertia(tip: Tip, motion: Array) -> csr_array:
    """Return the mass matrix of a tip that moves with a cross-section, as `motion_at` gives it."""
    displacement, rotation = csr_array(motion[:3]), csr_array(motion[3:])
    return tip.mass * (displacement.T @ displacement) + tip.rotary_inertia * (rotation.T @ rotation)
