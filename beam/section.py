"""Cross-section of a sheet strip, bare or with glued layers.

Plies i of width b, thickness t_i, moduli E_i and G_i, density rho_i and loss factor eta_i are stacked along
the normal coordinate y [m]. They are bonded: plane sections stay plane. With y_i the middle of a ply and

    ybar = sum E_i t_i y_i / sum E_i t_i                          (neutral axis [m])
    EA = b sum E_i t_i                                            [N]
    EI = b sum E_i (t_i^3/12 + t_i (y_i - ybar)^2)                [N m^2]
    m  = b sum rho_i t_i                                          [kg/m]
    GJ = 4 b kappa sum G_i (t_i^3/12 + t_i (y_i - yhat)^2)        [N m^2],   yhat as ybar with G_i for E_i

GJ is that of a thin laminate; kappa = 1 - (192 t / pi^5 b) sum_{n odd} tanh(n pi b / 2t)/n^5 is
Saint-Venant's factor for the two edges, exact for one ply (S. P. Timoshenko and J. N. Goodier, Theory of
Elasticity, art. 109). The loss factor is the mean of eta_i, weighted by strain energy (H. Oberst, Akust.
Beihefte 4 (1952) 181):

    eta_bending = b sum eta_i E_i (t_i^3/12 + t_i (y_i - ybar)^2) / EI,
    eta_axial   = b sum eta_i E_i t_i / EA.

The modulus is E, not E/(1 - nu^2): the strip is free to curl across its width. See ``docs/theory/beam.md``.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from .material import Material
from .parameters import Array, record, require, require_kind, require_within

#: Terms of Saint-Venant's series; the remainder is below 1/(4 * 59^4) = 2e-8 of kappa.
TORSION_TERMS = 30


@record(eq=True)
class Layer:
    """A damping layer glued to a strip over its whole width.

    Parameters
    ----------
    material : Material
        The damping material, such as `beam.DAMPING_TAPE`.
    thickness : float
        Thickness of one layer [m], positive.
    both_sides : bool
        Whether each face has such a layer, or only the upper one.

    Raises
    ------
    ValueError
        If `thickness` is not finite and positive.
    TypeError
        If `material` is not a Material, `thickness` is not a number, or `both_sides` is not True or False.
    """

    material: Material
    thickness: float
    both_sides: bool = True

    def __post_init__(self) -> None:
        require_kind("material", self.material, Material, "a Material, such as DAMPING_TAPE")
        require_kind("both_sides", self.both_sides, bool, "True or False")
        require_within("thickness", self.thickness, "m", above=0)


@record(eq=True)
class StripSection:
    """A flat strip that bends about its width, bare or with a glued layer.

    Parameters
    ----------
    material : Material
        Material of the bare strip.
    width : float
        Width b [m], positive.
    thickness : float
        Thickness of the bare strip [m], positive and at most the width.
    layer : Layer, optional
        A glued damping layer.
    slot : float
        Free space in the middle of the width [m], not counted in b. It leaves two legs of width b/2, which
        bend as one strip and twist each by itself.

    Raises
    ------
    ValueError
        If a length is out of range, or the thickness exceeds the width.
    TypeError
        If `material` is not a Material, `layer` is not a Layer, or a length is not a number.

    See Also
    --------
    BeamSection : A section by its stiffness and mass, such as a rod or a tube.
    Layer : A damping layer glued to the strip.
    cantilever : A straight strip with such a section.

    Examples
    --------
    >>> from beam import BRASS, DAMPING_TAPE, Layer, StripSection
    >>> bare = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
    >>> round(1e3 * bare.bending_stiffness, 2), round(1e3 * bare.mass_per_length, 2)  # [mN m^2], [g/m]
    (28.84, 66.3)
    >>> tape = Layer(material=DAMPING_TAPE, thickness=0.5e-3)
    >>> damped = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3, layer=tape)
    >>> round(damped.bending_loss_factor, 3)
    0.052
    """

    material: Material
    width: float
    thickness: float
    layer: Layer | None = None
    slot: float = 0.0

    def __post_init__(self) -> None:
        require_kind("material", self.material, Material, "a Material, such as BRASS")
        require_within("slot", self.slot, "m", low=0)
        require_kind("layer", self.layer, (Layer, type(None)), "a Layer or None")
        require_within("width", self.width, "m", above=0)
        require_within("thickness", self.thickness, "m", above=0)
        words = f"is {self.thickness} m; it must not exceed the"
        require(self.thickness <= self.width, "thickness", words, "width", f"{self.width} m")

    @property
    def bands(self) -> tuple[tuple[float, float], ...]:
        """Intervals across the width that the strip fills [m]: one, or two beside a slot."""
        half, free = 0.5 * (self.width + self.slot), 0.5 * self.slot
        return ((-half, -free), (free, half)) if free else ((-half, half),)

    @property
    def total_thickness(self) -> float:
        """Thickness of strip and layers [m]."""
        return float(self._plies()[1].sum())

    @property
    def axial_stiffness(self) -> float:
        """Axial stiffness EA [N]."""
        return float(self._energies()[0].sum())

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness EI about the neutral axis [N m^2]."""
        return float(self._energies()[1].sum())

    @property
    def torsional_stiffness(self) -> float:
        """Torsional stiffness GJ [N m^2]."""
        plies, t, y = self._plies()
        shear = np.array([ply.shear_modulus for ply in plies])
        slender = self.width / len(self.bands) / t.sum()
        n = np.arange(1, 2 * TORSION_TERMS, 2)
        edges = 1.0 - 192.0 / (np.pi**5 * slender) * np.sum(np.tanh(0.5 * n * np.pi * slender) / n**5)
        return float(4.0 * self.width * edges * _second_moments(shear, t, y).sum())

    @property
    def mass_per_length(self) -> float:
        """Mass per length m [kg/m]."""
        plies, t, _ = self._plies()
        return float(self.width * sum(ply.density * ti for ply, ti in zip(plies, t, strict=True)))

    @property
    def axial_loss_factor(self) -> float:
        """Loss factor of stretching [1]."""
        return self._loss(self._energies()[0])

    @property
    def bending_loss_factor(self) -> float:
        """Loss factor of bending [1]."""
        return self._loss(self._energies()[1])

    def _plies(self) -> tuple[tuple[Material, ...], Array, Array]:
        """Return materials, thicknesses [m] and mid-heights [m] of the plies, from the lower face up."""
        stack = [(self.material, self.thickness)]
        if self.layer is not None:
            glued = (self.layer.material, self.layer.thickness)
            stack = [glued, *stack, glued] if self.layer.both_sides else [*stack, glued]
        t = np.array([thickness for _, thickness in stack])
        return tuple(material for material, _ in stack), t, np.cumsum(t) - 0.5 * t

    def _energies(self) -> tuple[Array, Array]:
        """Return the terms of each ply in EA [N] and in EI [N m^2]."""
        plies, t, y = self._plies()
        modulus = np.array([ply.youngs_modulus for ply in plies])
        return self.width * modulus * t, self.width * _second_moments(modulus, t, y)

    def _loss(self, energies: Array) -> float:
        eta = np.array([ply.loss_factor for ply in self._plies()[0]])
        return float(eta @ energies / energies.sum())


@record(eq=True)
class BeamSection:
    """A section of a beam by its stiffness and mass, such as a rod, a tube or a profile.

    Parameters
    ----------
    bending_stiffness, mass_per_length : float
        Bending stiffness EI [N m^2] and mass per length m [kg/m], both above zero.
    thickness : float
        Outer size in the plane of bending [m], with which bends are compared and films drawn.
    width : float, optional
        Outer size across that plane [m], for films; 0 means as large as `thickness`.
    axial_stiffness : float, optional
        Stiffness EA [N], which matters on curved centrelines only; 0 means 12 EI/thickness^2, as a strip has.
    loss_factor : float
        Loss factor of stretching and bending [1].

    Raises
    ------
    ValueError
        If a value is out of range or not finite.
    TypeError
        If a value is not a number.
    """

    bending_stiffness: float
    mass_per_length: float
    thickness: float
    width: float = 0.0
    axial_stiffness: float = 0.0
    loss_factor: float = 0.0
    layer: ClassVar[None] = None

    def __post_init__(self) -> None:
        units = {"bending_stiffness": "N m^2", "mass_per_length": "kg/m", "thickness": "m"}
        for name, unit in units.items():
            require_within(name, getattr(self, name), unit, above=0)
        require_within("loss_factor", self.loss_factor, "[1]", low=0)
        for name, unit in {"width": "m", "axial_stiffness": "N"}.items():
            require_within(name, getattr(self, name), unit, low=0)
        strip = 12.0 * self.bending_stiffness / self.thickness**2
        vars(self).update(width=self.width or self.thickness, axial_stiffness=self.axial_stiffness or strip)

    @staticmethod
    def tube(*, material: Material, outer: float, inner: float = 0.0) -> BeamSection:
        """Return the `BeamSection` of a round tube of these diameters [m], or of a solid rod."""
        require_kind("material", material, Material, "a Material, such as STEEL")
        require_within("outer", outer, "m", above=0)
        require_within("inner", inner, "m", low=0, below=outer)
        area, e = 0.25 * np.pi * (outer**2 - inner**2), material.youngs_modulus
        return BeamSection(
            bending_stiffness=e * area * (outer**2 + inner**2) / 16.0,
            mass_per_length=material.density * area,
            thickness=outer,
            axial_stiffness=e * area,
            loss_factor=material.loss_factor,
        )

    @property
    def total_thickness(self) -> float:
        """Outer size in the plane of bending [m]."""
        return self.thickness

    @property
    def bands(self) -> tuple[tuple[float, float], ...]:
        """Interval across the plane of bending that the section fills [m]."""
        return ((-0.5 * self.width, 0.5 * self.width),)

    @property
    def axial_loss_factor(self) -> float:
        """Loss factor of stretching [1]."""
        return self.loss_factor

    @property
    def bending_loss_factor(self) -> float:
        """Loss factor of bending [1]."""
        return self.loss_factor


def _second_moments(modulus: Array, t: Array, y: Array) -> Array:
    """Return the second moment of each ply per width [N m], about the mean height weighted by `modulus`."""
    neutral = (modulus * t) @ y / (modulus @ t)
    return modulus * (t**3 / 12.0 + t * (y - neutral) ** 2)
