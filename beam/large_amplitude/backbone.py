"""Backbone coefficient of a leaf spring: the dependence of its frequency on the amplitude.

Free vibration of mode 1, the first that moves the tip, at the tip amplitude A [m] has the frequency

    f = f_0 (1 + kappa (A/L)^2 + ...),                                                            [Hz]

L [m] the length of the first straight run from s = 0, or of the whole centreline if none is straight. With
y_1 of unit tip displacement, V_4 the quartic part of the energy of `finite_rotation` there and g = dV_3/dy,

    K y_0 = -g/2,     (K - 4 W^2 M) y_2 = -g/2,     m = y_1^T M y_1,     W = 2 pi f_0,
    V = (3/8) V_4 + g^T (y_0/2 + y_2/4) + (y_0^T K y_0 + y_2^T K y_2/2)/2,     T = W^2 y_2^T M y_2,
    kappa/L^2 = 4 V/(m W^2)  [elastic]  - 4 T/(m W^2)  [inertial].

One mode with (1 + a x^2) x'' + a x x'^2 + W^2 (x + b x^3) = 0 has kappa/L^2 = (3/8) b - a/4: its two parts
are equal for b = (8/3) elastic/L^2 and a = -4 inertial/L^2. Derivation: ``docs/theory/beam.md``.
"""

from collections.abc import Sequence
from itertools import dropwhile, takewhile

from scipy.sparse.linalg import splu

from ..centreline import Centreline
from ..record import record
from ..spring import LeafSpring
from .finite_rotation import FiniteRotation


@record(eq=True)
class Backbone:
    """The dependence of the frequency of mode 1 on its amplitude.

    Parameters
    ----------
    elastic, inertial : float
        Parts of the coefficient kappa from strain energy and from kinetic energy [1].
    length : float
        Length L of the first straight run [m], or of the whole centreline if none is straight.
    """

    elastic: float
    inertial: float
    length: float

    @property
    def kappa(self) -> float:
        """Coefficient kappa = (f/f_0 - 1) (L/A)^2 for small A [1], the sum of both parts."""
        return self.elastic + self.inertial

    @property
    def stiffness(self) -> float:
        """Coefficient b of the equivalent single mode [1/m^2]."""
        return 8.0 / 3.0 * self.elastic / self.length**2

    @property
    def inertia(self) -> float:
        """Coefficient a of the equivalent single mode [1/m^2]."""
        return -4.0 * self.inertial / self.length**2


def backbone_coefficient(spring: LeafSpring, elements: int | Sequence[int] | None = None) -> Backbone:
    """Return the backbone coefficient of a leaf spring.

    Parameters
    ----------
    spring : LeafSpring
        The spring that vibrates.
    elements : int or sequence of int, optional
        Elements on every piece, or one number for each, as for `beam.assemble`.

    Returns
    -------
    Backbone
        The coefficient kappa [1] in f = f_0 (1 + kappa (A/L)^2), in two parts, and the length L [m].

    Raises
    ------
    ValueError
        If the supports leave a rigid motion, none of the first modes moves the tip, or `elements` is wrong.
    TypeError
        If `spring` is not a LeafSpring.
    """
    model = FiniteRotation.of(spring, elements)
    stiffness, mass = model.linear.stiffness, model.linear.mass
    omega, y = model.first_mode
    kinetic = omega**2 * (y @ (mass @ y))
    a, b, change = (strain @ y for strain in model.strains)
    axial, bending = model.axial, model.bending
    second = model.strains[0].T @ (0.5 * axial * b**2) + model.strains[1].T @ (axial * a * b)
    rest, double = (
        -0.5 * splu((stiffness - factor * omega**2 * mass).tocsc()).solve(second) for factor in (0.0, 4.0)
    )
    fourth = axial @ (b**4 / 8.0 - 0.5 * (a * b) ** 2) + 0.5 * bending @ (b * change) ** 2
    strained = 0.375 * fourth + second @ (0.5 * rest + 0.25 * double)
    strained += 0.5 * rest @ (stiffness @ rest) + 0.25 * double @ (stiffness @ double)
    moving = omega**2 * double @ (mass @ double)
    length = first_straight(spring.centreline)
    scale = 4.0 * length**2 / kinetic
    return Backbone(elastic=float(scale * strained), inertial=float(-scale * moving), length=length)


def first_straight(line: Centreline) -> float:
    """Return the length of the first straight run, of one or more pieces, or else of the whole curve [m]."""
    onwards = dropwhile(lambda piece: piece.curvature, line.pieces)
    return sum(piece.length for piece in takewhile(lambda piece: not piece.curvature, onwards)) or line.length
