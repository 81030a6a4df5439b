"""Newton's method for a point of a curve of periodic orbits.

A curve has n equations for n + 1 unknowns.  One more equation picks a point: a given approach speed, a given
amplitude, or a plane across the curve.  The null vector of the n rows of derivatives is the direction of the
curve there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from beam.parameters import Array, record
from contact.errors import NotPeriodic
from contact.orbits.families.touch_orbit import PeriodicOrbit

CONVERGED = 1e-12  # largest residual over the sizes; rounding of the flow over m periods is about 1e-14

ROUNDED = 1e-9
"""Residual below which iterates that no longer improve count as an orbit.  The rest is rounding, 1e-16, times
the largest multiplier, which grows as 1/v towards grazing."""

MOST_ITERATIONS = 25  # bound of Newton's method: from the orbit of a kick it takes three to six iterations
LONGEST_STEP = 0.3  # longest change of an unknown in one iteration, over its size: larger ones are shortened
LARGEST = 700.0  # larger determinants are cut off at the exponential of this number


class Iterate(NamedTuple):
    """The equations of a curve of orbits at n + 1 unknowns x; the `orbit` from there need not close.

    `residual` is scaled, shape (n,), and `rows` are its derivatives with respect to x, (n, n + 1).
    `parameter_slope` and `speed_slope`, (n + 1,), are the derivatives of parameter and approach speed.
    `start_slope` is the derivative of (u, v, S, C) and the parameters with respect to x.
    """

    orbit: PeriodicOrbit
    residual: Array
    rows: Array
    parameter_slope: Array
    speed_slope: Array
    start_slope: Array


Equations = Callable[[Array], Iterate]


@record
class CurvePoint:
    """A point of a curve of orbits: unknowns `x` and unit vector `direction` along the curve, both (n + 1,).

    `rate` is the derivative of the parameter with respect to the arc length.  `touches`, (2, impacts), has
    the same derivatives of times and approach velocities of the touches.  `determinant` belongs to the rows
    of derivatives with the direction below them.  `last` marks the end of the range.
    """

    x: Array
    direction: Array
    orbit: PeriodicOrbit
    rate: float
    touches: Array
    determinant: float
    last: bool = False

    def oriented(self, other: Array) -> CurvePoint:
        """The same point, its direction turned to the side of the vector `other`."""
        if self.direction @ other >= 0.0:
            return self
        point = replace(self, direction=-self.direction, rate=-self.rate, touches=-self.touches)
        return replace(point, determinant=-self.determinant)


def newton(
    equations: Equations, x: Array, pick: Callable[[Array, Iterate], tuple[float, Array]]
) -> CurvePoint:
    """The solution next to `x` of the equations and of one more, ``pick(x, iterate)``: value and gradient.

    One step is made in any case, since near grazing another orbit can lie within the tolerance.  Raises
    NotPeriodic if the method does not converge.
    """
    found, best, error = None, math.inf, math.inf
    for iteration in range(MOST_ITERATIONS):
        here = equations(x)
        value, gradient = pick(x, here)
        error = max(float(np.max(np.abs(here.residual))), abs(value))
        matrix = np.vstack([here.rows, gradient])
        try:
            inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
        except np.linalg.LinAlgError:
            break
        if iteration > 0:
            if error < best:
                found, best = (x, here, matrix, inverse[:, -1]), error
            if best < CONVERGED or (best < ROUNDED and not error <= best):
                break
        change = inverse @ np.append(here.residual, value)
        x = x - change * min(1.0, LONGEST_STEP / max(float(np.max(np.abs(change))), 1e-300))
        if not np.all(np.isfinite(x)):
            break
    if found is None or not best < ROUNDED:
        words = f"Newton's method found no orbit of period {here.orbit.m} (residual {error:.1e})"
        raise NotPeriodic(detail=words)
    x, here, matrix, across = found
    length = float(np.linalg.norm(across))
    direction = across / length
    rate, speed_rate = float(here.parameter_slope @ direction), float(here.speed_slope @ direction)
    orbit = replace(here.orbit, residual=best, slope=rate / speed_rate if speed_rate else math.inf)
    touches = (orbit.record.slopes @ (here.start_slope @ direction)).T
    # with the direction in place of the last row of the matrix, its determinant grows by the factor `length`
    sign, size = np.linalg.slogdet(matrix)
    determinant = float(sign * math.exp(min(size + math.log(length), LARGEST)))
    return CurvePoint(
        x=x, direction=direction, orbit=orbit, rate=rate, touches=touches, determinant=determinant
    )
