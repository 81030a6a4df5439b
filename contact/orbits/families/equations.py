r"""The equations of a periodic orbit, and Newton's method for them.

An orbit of m drive periods starts at its first touch from z = (u, v, S, C).  Here u and v are the deviations
of all N modes from the steady motion, and S = Z sin(w t), C = Z cos(w t) give the amplitude and the phase of
the drive.  F is the flow over m/f from touch to touch (``contact.sensitivity.touch_flow``).  With y the tip
displacement relative to the stop, y' its velocity, and p the numbers of the oscillator, the orbit obeys

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0.                                                         (1)

One more equation picks an orbit of the family,

    y'(z, p) = s  (given approach speed)      or      S^2 + C^2 = Z^2  (given amplitude).

All functions are smooth in z and p, through a fold and down to grazing.  The strobe map has a square root
there: see also arXiv:2510.16218.  The derivatives are the exact tangents of the flow, so that Newton's method
converges quadratically.  The Floquet multipliers are the eigenvalues of dF_(u,v)/d(u, v) at fixed drive.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from beam.parameters import Array
from contact.errors import NotPeriodic
from contact.flight.variation import all_tip_changes
from contact.orbits.families.family import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Sensitivities
from contact.sensitivity.replay import deviation_rates
from contact.sensitivity.touch_flow import FLOWN, flow_error, flow_from_touch
from contact.touch.passage import new_touches

CONVERGED = 1e-12  # largest residual over the sizes; rounding of the flow over m periods is about 1e-14

ROUNDED = 1e-9
"""Residual below which iterates that no longer improve count as an orbit.  The rest is rounding, 1e-16, times
the largest multiplier, which grows as 1/v towards grazing."""

MOST_ITERATIONS = 25  # bound of Newton's method: from the orbit of a kick it takes three to six iterations
LONGEST_STEP = 0.3  # longest change of an unknown in one iteration, over its size: larger ones are shortened


def sizes_of(oscillator: ImpactOscillator) -> Array:
    """Sizes of the deviations (u, v) of all modes, by which unknowns and residuals are scaled."""
    model, size = oscillator.model, oscillator.stop.gap / np.abs(oscillator.model.phi).max()
    speed = np.maximum(model.omega, oscillator.driven.angular_frequency)
    return np.concatenate([np.full(oscillator.n_modes, size), size * speed])


def drive_of(orbit: PeriodicOrbit) -> Array:
    """The drive (S, C) at the first touch of an orbit [m]."""
    return orbit.oscillator.driven.components(orbit.phase)


def driven_at(oscillator: ImpactOscillator, drive: Array) -> tuple[ImpactOscillator, float]:
    """The oscillator with the amplitude of `drive` = (S, C), and the drive time of the touch [s]."""
    time = math.atan2(*drive) % (2.0 * math.pi) / oscillator.driven.angular_frequency
    return oscillator.with_amplitude(math.hypot(*drive)), time


def shoot(
    changes: Sensitivities, phase: float, start: Array, period: int, impacts: int, speed: float | None = None
) -> tuple[PeriodicOrbit, Array, Array]:
    """The motion over m = `period` drive periods from a touch, as an orbit that need not close.

    It starts at drive time `phase` [s] with deviations `start`, shape (2 n_modes,); `speed` is its approach
    speed [m/s], if it is known more exactly.  Returned are also (u, v) at the end less `start`, and the
    derivatives of (u, v) at the end with respect to z and P parameters, the `changes`, shape (2 n_modes,
    2 n_modes + 2 + P).

    NotPeriodic is raised if the motion has fewer touches than `impacts` or a contact does not end, and
    ContactTooStiff if a contact needs more than ``touch_flow.MOST_STEPS``.
    """
    oscillator, vary, n, (u, v) = changes.oscillator, changes.variation, start.size, start.reshape(2, -1)
    flow, end = np.eye(n + 2, n + 2 + len(vary.scalars)), np.array([u, v])
    record = new_touches(impacts, u.size)
    outcome = flow_from_touch(vary, phase, end[0], end[1], period * oscillator.period, flow, record)
    if outcome != FLOWN:
        words = f"an orbit of period {period} with {impacts} touches was lost"
        raise flow_error(outcome, phase, float(record.log[0]["approach"]), words)
    if changes.changes:
        rates = deviation_rates(oscillator.motion(), u, v)
        flow[:n, n + 2 :] += np.multiply.outer(rates, period * changes.period)
    orbit = PeriodicOrbit(
        oscillator=oscillator,
        period=period,
        excess=oscillator.excess,
        speed=float(record.log[0]["approach"]) if speed is None else speed,
        phase=phase,
        displacement=u,
        velocity=v,
        record=record,
        tangent=flow[:n, :n],
        slope=math.nan,
        residual=math.nan,
    )
    return orbit, end.ravel() - start, flow[:n]


def tip_slopes(orbit: PeriodicOrbit, changes: Sensitivities) -> tuple[Array, Array]:
    """Derivatives of y and y' at the first touch with respect to z and the parameters."""
    size = orbit.deviations.size + 2
    unit, vary = np.eye(size, size + len(changes.changes)), changes.variation
    found: tuple[Array, Array] = all_tip_changes(vary, unit, orbit.displacement, orbit.velocity, orbit.phase)
    return found


def slopes_of(orbit: PeriodicOrbit, flow: Array, changes: Sensitivities) -> Array:
    """Derivatives of the equations with respect to z and the parameters, shape (2 n_modes + 3, .).

    The rows belong to (u, v), y, the amplitude and the approach speed; `orbit` and `flow` are from `shoot`.
    """
    height, rate = tip_slopes(orbit, changes)
    amplitude = np.concatenate([np.zeros(len(flow)), drive_of(orbit) / orbit.amplitude, -changes.amplitude])
    return np.vstack([flow - np.eye(*flow.shape), height, amplitude, rate])


class Iterate(NamedTuple):
    """The equations of a curve of orbits at n + 1 unknowns x; the `orbit` from there need not close.

    `residual` is scaled, shape (n,), and `rows` are its derivatives with respect to x, (n, n + 1).
    `parameter_slope` and `speed_slope`, (n + 1,), are the derivatives of parameter and approach speed.
    """

    orbit: PeriodicOrbit
    residual: Array
    rows: Array
    parameter_slope: Array
    speed_slope: Array


Equations = Callable[[Array], Iterate]


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A point of a curve of orbits: unknowns `x` and unit vector `direction` along the curve, both (n + 1,).

    `rate` is the derivative of the parameter with respect to the arc length, and `determinant` belongs to the
    rows of derivatives with the direction below them.  `last` marks the end of the range.
    """

    x: Array
    direction: Array
    orbit: PeriodicOrbit
    rate: float
    determinant: float
    last: bool = False

    def oriented(self, other: Array) -> Point:
        """The same point, its direction turned to the side of the vector `other`."""
        if self.direction @ other >= 0.0:
            return self
        return replace(self, direction=-self.direction, rate=-self.rate, determinant=-self.determinant)


def newton(equations: Equations, x: Array, pick: Callable[[Array, Iterate], tuple[float, Array]]) -> Point:
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
        words = f"Newton's method found no orbit of period {here.orbit.period} (residual {error:.1e})"
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=words)
    x, here, matrix, across = found
    length = float(np.linalg.norm(across))
    direction = across / length
    rate, speed_rate = float(here.parameter_slope @ direction), float(here.speed_slope @ direction)
    orbit = replace(here.orbit, residual=best, slope=rate / speed_rate if speed_rate else math.inf)
    # with the direction in place of the last row of the matrix, its determinant grows by the factor `length`
    determinant = float(np.linalg.det(matrix)) * length
    return Point(x=x, direction=direction, orbit=orbit, rate=rate, determinant=determinant)
