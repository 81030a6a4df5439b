"""Exact frequencies and shapes of the uniform straight beam, with a mass and a rotary inertia at its end.

Euler-Bernoulli: EI w'''' = m omega^2 w, omega^2 = EI beta^4 / m, 0 <= s <= L. In the scaled basis

    w = a_1 cos(beta s) + a_2 sin(beta s) + a_3 exp(-beta s) + a_4 exp(-beta (L - s))

every term stays of order one, however high the mode (cosh and sinh lose all digits near mode 12). Held at
s = 0 and at s = L, each support gives two rows:

    clamped  w = w' = 0        pinned  w = w'' = 0        guided  w' = w''' = 0        free  w'' = w''' = 0

and a free end with tip mass M [kg] and rotary inertia J [kg m^2]

    EI w'' = J omega^2 w',     EI w''' = -M omega^2 w     at s = L.

With each derivative divided by beta and the rows by 1 + J beta^3/m and 1 + M beta/m, the determinant of the
four rows is a smooth function of beta L of order one; its zeros are the frequencies. They are bracketed on a
grid of step `SCAN_STEP` and refined by Brent's method. The shape is the null vector, mass-normalised,
m int w^2 ds + M w(L)^2 + J w'(L)^2 = 1, with w(L) >= 0.

For the clamped-free beam without tip the zeros satisfy cos(beta L) cosh(beta L) = -1 (R. D. Blevins, Formulas
for Natural Frequency and Mode Shape, table 8-1). Over all modes of a clamped beam with the tip at its end:

    sum phi_k^2/omega_k^2 = L^3/(3 EI),     sum Gamma_k phi_k / omega_k^2 = m L^4/(8 EI) + M L^3/(3 EI),
    sum Gamma_k phi_k = 1,                  sum Gamma_k^2 = m L + M,           sum phi_k^2 = 1/M.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from .parameters import InvalidValue, require, require_array, require_kind, require_whole, require_within
from .spring import HELD, Support, two_supports

#: Grid of beta L. Zeros lie near pi apart; a tip whose own rotation resonates with a bending mode brings two
#: closer, to 0.077 at the least for M up to 1e6 m L and J up to 1e4 m L^3.
SCAN_STEP = 0.02
#: Where the scan starts: below it the basis is nearly dependent. Reached by tips of up to 1e6 beam masses.
SCAN_START = 0.04
#: Points of the Gauss rule for each half wave: shapes are entire functions, so few give all digits.
POINTS_PER_HALF_WAVE = 12

MOST_MODES = 2000
"""Modes at once: the scan over beta L then takes some 50 MB."""


@dataclass(frozen=True, kw_only=True)
class UniformBeam:
    """A straight beam of constant section.

    Parameters
    ----------
    length : float
        L [m], above zero.
    bending_stiffness : float
        EI [N m^2], above zero.
    mass_per_length : float
        m [kg/m], above zero.
    supports : tuple of two supports
        At s = 0 and s = L: "clamped", "pinned", "guided" or "free".
    tip_mass, tip_rotary_inertia : float
        M [kg] and J [kg m^2] at s = L, only where that end is free.
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
            value = getattr(self, name)
            require_within(name, value, unit, low=0)
            free, words = self.supports[1] == "free", f"at an end that is {self.supports[1]} it must be 0"
            require(free or not value, f"{name} is {value} {unit}; {words}")

    @property
    def static_compliance(self) -> float:
        """L^3/(3 EI) [m/N], of a beam clamped at s = 0 and free at s = L."""
        ends = " and ".join(self.supports)
        require(ends == "clamped and free", f"static_compliance is for supports clamped and free, not {ends}")
        return self.length**3 / (3.0 * self.bending_stiffness)


@dataclass(frozen=True, kw_only=True, eq=False)
class ExactModes:
    """Exact modes of a `UniformBeam`, lowest first; rigid motions are not among them.

    Parameters
    ----------
    beam : UniformBeam
    wave_numbers : ndarray, shape (n_modes,)
        beta [1/m].
    coefficients : ndarray, shape (n_modes, 4)
        Of the scaled basis, mass-normalised [kg^(-1/2)].
    """

    beam: UniformBeam
    wave_numbers: NDArray[np.float64]
    coefficients: NDArray[np.float64]

    @property
    def omega(self) -> NDArray[np.float64]:
        """Angular frequencies [rad/s], shape (n_modes,)."""
        return self.wave_numbers**2 * math.sqrt(self.beam.bending_stiffness / self.beam.mass_per_length)

    @property
    def phi(self) -> NDArray[np.float64]:
        """Values at s = L [kg^(-1/2)], shape (n_modes,)."""
        return self.shapes(self.beam.length)[:, 0]

    @property
    def participation(self) -> NDArray[np.float64]:
        """m int w ds + M w(L) [kg^(1/2)], shape (n_modes,); the beam's own antiderivative, no quadrature."""
        beam, a = self.beam, self.coefficients
        bl = self.wave_numbers * beam.length
        decay = -np.expm1(-bl)
        integrals = np.stack([np.sin(bl), 2.0 * np.sin(0.5 * bl) ** 2, decay, decay], axis=1)
        return (
            beam.mass_per_length * np.sum(a * integrals, axis=1) / self.wave_numbers
            + beam.tip_mass * self.phi
        )

    def shapes(self, s: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Shapes, or a derivative of them, at arc lengths s [m]; shape (n_modes, n_points)."""
        s = np.atleast_1d(require_array("s", s, "m", words="arc lengths"))
        values = [
            beta**derivative * _basis(beta * s, beta * self.beam.length, derivative) @ a
            for beta, a in zip(self.wave_numbers, self.coefficients, strict=True)
        ]
        return np.array(values)


def frequency_function(beam: UniformBeam, beta_length: ArrayLike) -> NDArray[np.float64]:
    """Return the scaled determinant at values of beta L, of order one; zero at each frequency.

    Parameters
    ----------
    beam : UniformBeam
    beta_length : array_like
        Positive.

    Returns
    -------
    ndarray, same shape
    """
    require_kind("beam", beam, UniformBeam, "a UniformBeam")
    values = require_array("beta_length", beta_length, "[1]", words="positive numbers")
    if np.any(values <= 0.0):
        raise InvalidValue(f"beta_length holds {values.min():g} [1]; every entry must be positive")
    return np.linalg.det(_rows(beam, values))


def exact_modes(beam: UniformBeam, count: int) -> ExactModes:
    """Return the first `count` modes that bend the beam.

    Parameters
    ----------
    beam : UniformBeam
    count : int
        From 1 to `MOST_MODES`.
    """
    require_kind("beam", beam, UniformBeam, "a UniformBeam")
    count = require_whole("count", count, "modes", high=MOST_MODES)
    grid = np.arange(SCAN_START, (count + 3) * math.pi, SCAN_STEP)
    values = frequency_function(beam, grid)
    left = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0.0)[:count]
    roots = [
        brentq(lambda x: float(frequency_function(beam, x)), grid[i], grid[i + 1], xtol=1e-14) for i in left
    ]
    nulls = [np.linalg.svd(_rows(beam, np.asarray(root)))[2][-1] for root in roots]
    raw = ExactModes(
        beam=beam, wave_numbers=np.array(roots) / beam.length, coefficients=np.array(nulls, dtype=np.float64)
    )
    x, weight = np.polynomial.legendre.leggauss(POINTS_PER_HALF_WAVE)
    panel = beam.length / (count + 1)
    s = panel * (np.arange(count + 1)[:, None] + 0.5 * (1.0 + x))
    mass = beam.mass_per_length * 0.5 * panel * raw.shapes(s.ravel()) ** 2 @ np.tile(weight, count + 1)
    mass = mass + beam.tip_mass * raw.phi**2
    mass = mass + beam.tip_rotary_inertia * raw.shapes(beam.length, derivative=1)[:, 0] ** 2
    scale = np.where(raw.phi < 0.0, -1.0, 1.0) / np.sqrt(mass)
    return ExactModes(
        beam=beam, wave_numbers=raw.wave_numbers, coefficients=raw.coefficients * scale[:, None]
    )


def _basis(x: NDArray[np.float64], end: float | NDArray[np.float64], derivative: int) -> NDArray[np.float64]:
    """Derivative of the four functions in beta s, at x = beta s; end = beta L. Shape (..., 4)."""
    turn = x + 0.5 * math.pi * derivative
    decay, growth = np.exp(-x), np.exp(x - end)
    return np.stack([np.cos(turn), np.sin(turn), (-1.0) ** derivative * decay, growth], axis=-1)


def _rows(beam: UniformBeam, bl: NDArray[np.float64]) -> NDArray[np.float64]:
    """The four boundary rows at beta L = bl, each scaled to order one; shape (..., 4, 4)."""
    rows = [_basis(0.0 * bl, bl, order) for order in _vanishing(beam.supports[0])]
    if beam.supports[1] == "free":
        turning = beam.tip_rotary_inertia / (beam.mass_per_length * beam.length**3) * bl**3
        moving = beam.tip_mass / (beam.mass_per_length * beam.length) * bl
        w, slope, moment, force = (_basis(bl, bl, order) for order in range(4))
        rows.append((moment - turning[..., None] * slope) / (1.0 + turning[..., None]))
        rows.append((force + moving[..., None] * w) / (1.0 + moving[..., None]))
    else:
        rows += [_basis(bl, bl, order) for order in _vanishing(beam.supports[1])]
    return np.stack(rows, axis=-2)


def _vanishing(support: Support) -> list[int]:
    """Orders of the derivatives of w that vanish: w or the force, the rotation or the moment."""
    _, w, turn, *_ = HELD[support]
    return sorted((0 if w else 3, 1 if turn else 2))
