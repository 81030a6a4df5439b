"""How the frequency of a leaf spring depends on its amplitude: the coefficient of its backbone.

Free vibration of mode 1, the first that moves the tip, at the tip amplitude A [m] has the frequency

    f = f_0 (1 + kappa (A/L)^2 + ...),                                                            [Hz]

L [m] the first straight run from s = 0 (all of a straight strip; the whole length where none is straight).
kappa comes from the least model that gives it: mode 1, A y_1 cos(q) with y_1 of unit tip displacement, and
the response A^2 (y_0 + y_2 cos(2 q)) of the whole strip to it, at rest and at twice the frequency. With V of
``beam.finite_rotation`` to the fourth order, V_4 at y_1 and the second-order force g = dV_3/dy there,

    K y_0 = -g/2,     (K - 4 W^2 M) y_2 = -g/2,     m = y_1^T M y_1,     W = 2 pi f_0,

and with the averages over a period at order A^4

    V = (3/8) V_4 + g^T (y_0/2 + y_2/4) + (y_0^T K y_0 + y_2^T K y_2/2)/2,     T = W^2 y_2^T M y_2,

G. B. Whitham's averaged Lagrangian (Linear and Nonlinear Waves (1974), section 14) gives

    kappa/L^2 = 4 V/(m W^2)  [elastic]  - 4 T/(m W^2)  [inertial].

A mode with (1 + a x^2) x'' + a x x'^2 + W^2 (x + b x^3) = 0 has these two parts with b = (8/3) elastic/L^2
and a = -4 inertial/L^2; (3/8) b - a/4 is its kappa/L^2.

A single leaf stiffens a little, whatever its supports and tip: +0.019 ... +0.026. A folded U softens: its
sway presses one leg and pulls the other, which bow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.sparse.linalg import splu

from .centreline import Centreline
from .finite_rotation import FiniteRotation
from .spring import LeafSpring


@dataclass(frozen=True, kw_only=True)
class Backbone:
    """Amplitude dependence of mode 1.

    Parameters
    ----------
    elastic, inertial : float
        The parts of kappa from strain energy and kinetic energy [1].
    length : float
        L [m].
    """

    elastic: float
    inertial: float
    length: float

    @property
    def kappa(self) -> float:
        """(f/f_0 - 1) (L/A)^2 for small A [1], the sum of both parts."""
        return self.elastic + self.inertial

    @property
    def stiffness(self) -> float:
        """b [1/m^2]."""
        return 8.0 / 3.0 * self.elastic / self.length**2

    @property
    def inertia(self) -> float:
        """a [1/m^2]."""
        return -4.0 * self.inertial / self.length**2


def backbone_coefficient(spring: LeafSpring, elements: int | Sequence[int] | None = None) -> Backbone:
    """Return the backbone coefficient of a leaf spring.

    Parameters
    ----------
    spring : LeafSpring
    elements : int or sequence of int, optional
        On every piece, or on each, as for ``beam.assemble``.

    Raises
    ------
    ValueError
        If the supports leave a rigid motion, or none of the first modes moves the tip.
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
    """Length of the first straight run, of one or more pieces [m]; all of the curve if none is straight."""
    bent = [piece.curvature != 0.0 for piece in line.pieces]
    if all(bent):
        return line.length
    begin = bent.index(False)
    end = [*bent, True].index(True, begin)
    return sum(piece.length for piece in line.pieces[begin:end])
