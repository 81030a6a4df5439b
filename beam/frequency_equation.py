"""Exact frequencies and shapes of the uniform straight beam, with a mass and a rotary inertia at its end.

Euler-Bernoulli: EI w'''' = m omega^2 w, omega^2 = EI beta^4 / m, 0 <= s <= L, in the scaled basis

    w = a_1 cos(beta s) + a_2 sin(beta s) + a_3 exp(-beta s) + a_4 exp(-beta (L - s)).

The supports at s = 0 and at s = L give two rows each:

    clamped  w = w' = 0        pinned  w = w'' = 0        guided  w' = w''' = 0        free  w'' = w''' = 0

and a free end with tip mass M [kg] and rotary inertia J [kg m^2]

    EI w'' = J omega^2 w',     EI w''' = -M omega^2 w     at s = L.

Each derivative is divided by beta, and these two rows by 1 + J beta^3/m and 1 + M beta/m. The zeros of the
determinant are bracketed on a grid of step `SCAN_STEP` and refined by Brent's method. The shape is the null
vector, mass-normalised, m int w^2 ds + M w(L)^2 + J w'(L)^2 = 1, with w(L) >= 0. Derivation, and the sums
over all modes: ``docs/theory/beam.md``.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from .parameters import Array, record, require, require_array, require_kind, require_whole, require_within
from .spring import HELD, Support, two_supports

#: Grid of beta L. Zeros lie about pi apart. Where the rotation of the tip resonates with a bending mode, two
#: come closer, to 0.077 at the least for M up to 1e6 m L and J up to 1e4 m L^3.
SCAN_STEP = 0.02
#: Start of the scan; below it the basis is nearly dependent. Tips of up to 1e6 beam masses lie above it.
SCAN_START = 0.04
#: Points of the Gauss rule for each half wave: shapes are entire functions, so that few points suffice.
POINTS_PER_HALF_WAVE = 12
#: Largest number of modes: the scan over beta L then takes some 50 MB.
MOST_MODES = 2000


@record(eq=True)
class UniformBeam:
    """A straight beam of constant section.

    Parameters
    ----------
    length, bending_stiffness, mass_per_length : float
        Length L [m], bending stiffness EI [N m^2] and mass per length m [kg/m], above zero.
    supports : tuple of two Support
        Supports at s = 0 and s = L: "clamped", "pinned", "guided" or "free".
    tip_mass, tip_rotary_inertia : float
        Mass M [kg] and rotary inertia J [kg m^2] at s = L, zero unless that end is free.

    Raises
    ------
    ValueError
        If a number is out of range, a support is unknown, or a tip sits at an end that is not free.
    TypeError
        If a value is not a number.
    """

    length: float
    bending_stiffness: float
    mass_per_length: float
    supports: tuple[Support, Support] = ("clamped", "free")
    tip_mass: float = 0.0
    tip_rotary_inertia: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("length", "m"), ("bending_stiffness", "N m^2"), ("mass_per_length", "kg/m")):
            require_within(name, getattr(self, name), unit, above=0)
        object.__setattr__(self, "supports", two_supports(self.supports))
        for name, unit in (("tip_mass", "kg"), ("tip_rotary_inertia", "kg m^2")):
            value = require_within(name, getattr(self, name), unit, low=0)
            free, words = self.supports[1] == "free", f"at an end that is {self.supports[1]} it must be 0"
            require(free or not value, name, f"is {value} {unit}; {words}")


@record
class ExactModes:
    """Exact modes of a `UniformBeam`, lowest first; rigid motions are not among them.

    Parameters
    ----------
    beam : UniformBeam
        The beam that vibrates.
    wave_numbers : ndarray, shape (n_modes,)
        Wave numbers beta [1/m].
    coefficients : ndarray, shape (n_modes, 4)
        Coefficients in the scaled basis, mass-normalised [kg^(-1/2)].
    """

    beam: UniformBeam
    wave_numbers: Array
    coefficients: Array

    @property
    def omega(self) -> Array:
        """Angular frequencies [rad/s], shape (n_modes,)."""
        return self.wave_numbers**2 * math.sqrt(self.beam.bending_stiffness / self.beam.mass_per_length)

    @property
    def phi(self) -> Array:
        """Values phi of the shapes at s = L [kg^(-1/2)], shape (n_modes,)."""
        return self.shapes(self.beam.length)[:, 0]

    @property
    def participation(self) -> Array:
        """Participations m int w ds + M w(L) [kg^(1/2)], shape (n_modes,), from the antiderivative of w."""
        beam, a = self.beam, self.coefficients
        bl = self.wave_numbers * beam.length
        decay = -np.expm1(-bl)
        integrals = np.stack([np.sin(bl), 2.0 * np.sin(0.5 * bl) ** 2, decay, decay], axis=1)
        integral = np.sum(a * integrals, axis=1)
        return beam.mass_per_length * integral / self.wave_numbers + beam.tip_mass * self.phi

    def shapes(self, s: ArrayLike, derivative: int = 0) -> Array:
        """Return the shapes, or a derivative of them, at arc lengths s [m]; shape (n_modes, n_points)."""
        s = np.atleast_1d(require_array("s", s, "m", words="arc lengths"))
        values = [
            beta**derivative * _basis(beta * s, beta * self.beam.length, derivative) @ a
            for beta, a in zip(self.wave_numbers, self.coefficients, strict=True)
        ]
        return np.array(values)


def frequency_function(beam: UniformBeam, beta_length: ArrayLike) -> Array:
    """Return the scaled determinant [1] of a `beam`, of order one and zero at each frequency.

    `beta_length` are positive values of beta L [1], of any shape; the result has the same shape.
    """
    require_kind("beam", beam, UniformBeam, "a UniformBeam")
    values = require_array("beta_length", beta_length, "[1]", words="positive numbers")
    least = values.min(initial=np.inf)
    require(least > 0.0, "beta_length", f"holds {least:g} [1]; every entry must be positive")
    return np.linalg.det(_rows(beam, values))


def exact_modes(beam: UniformBeam, count: int) -> ExactModes:
    """Return the lowest modes that bend a uniform beam, from its frequency equation.

    Parameters
    ----------
    beam : UniformBeam
        The beam that vibrates.
    count : int
        Number of modes, from 1 to 2000.

    Returns
    -------
    ExactModes
        Wave numbers and mass-normalised shapes, lowest first.

    Raises
    ------
    ValueError
        If `count` is not a whole number from 1 to 2000.
    TypeError
        If `beam` is not a UniformBeam, or `count` is not a number.
    """
    require_kind("beam", beam, UniformBeam, "a UniformBeam")
    count = require_whole("count", count, "modes", high=MOST_MODES)
    grid = np.arange(SCAN_START, (count + 3) * math.pi, SCAN_STEP)
    values = frequency_function(beam, grid)
    left = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0.0)[:count]
    roots = np.array([brentq(partial(frequency_function, beam), *grid[i : i + 2], xtol=1e-14) for i in left])
    nulls = np.array([np.linalg.svd(_rows(beam, root))[2][-1] for root in roots])
    raw = ExactModes(beam=beam, wave_numbers=roots / beam.length, coefficients=nulls)
    x, weight = np.polynomial.legendre.leggauss(POINTS_PER_HALF_WAVE)
    panel = beam.length / (count + 1)
    s = panel * (np.arange(count + 1)[:, None] + 0.5 * (1.0 + x))
    mass = beam.mass_per_length * 0.5 * panel * raw.shapes(s.ravel()) ** 2 @ np.tile(weight, count + 1)
    mass = mass + beam.tip_mass * raw.phi**2
    mass = mass + beam.tip_rotary_inertia * raw.shapes(beam.length, derivative=1)[:, 0] ** 2
    scale = np.where(raw.phi < 0.0, -1.0, 1.0) / np.sqrt(mass)
    return replace(raw, coefficients=nulls * scale[:, None])


def _basis(x: Array, end: float | Array, derivative: int) -> Array:
    """Return a derivative of the four functions in x = beta s, shape (..., 4); end = beta L."""
    turn = x + 0.5 * math.pi * derivative
    decay, growth = np.exp(-x), np.exp(x - end)
    return np.stack([np.cos(turn), np.sin(turn), (-1.0) ** derivative * decay, growth], axis=-1)


def _rows(beam: UniformBeam, bl: Array) -> Array:
    """Return the four boundary rows at beta L = bl, each scaled to order one; shape (..., 4, 4)."""
    rows = [_basis(0.0 * bl, bl, order) for order in _vanishing(beam.supports[0])]
    if beam.supports[1] == "free":
        inertia = (beam.tip_rotary_inertia / (beam.mass_per_length * beam.length**3) * bl**3)[..., None]
        mass = (beam.tip_mass / (beam.mass_per_length * beam.length) * bl)[..., None]
        w, slope, moment, force = (_basis(bl, bl, order) for order in range(4))
        rows.append((moment - inertia * slope) / (1.0 + inertia))
        rows.append((force + mass * w) / (1.0 + mass))
    else:
        rows += [_basis(bl, bl, order) for order in _vanishing(beam.supports[1])]
    return np.stack(rows, axis=-2)


def _vanishing(support: Support) -> list[int]:
    """Return the orders of the derivatives of w that vanish: w or the force, the slope or the moment."""
    _, w, slope, *_ = HELD[support]
    return sorted((0 if w else 3, 1 if slope else 2))
