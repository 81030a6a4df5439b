"""The equations of a periodic orbit and their derivatives.

An orbit of m drive periods starts at its first touch from z = (u, v, S, C).  Here u and v are the deviations
of all N modes from the steady motion, and S = Z sin(w t), C = Z cos(w t) give the amplitude and the phase of
the drive.  F is the flow over m/f from touch to touch (``contact.sensitivity.touch_flow``).  With y the tip
displacement relative to the stop, y' its velocity, and p the numbers of the oscillator, the orbit obeys

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0,                                                         (1)

and one more equation, y' = s (given approach speed) or S^2 + C^2 = Z^2 (given amplitude).  All functions are
smooth through a fold and down to grazing (see also arXiv:2510.16218).  The Floquet multipliers are
the eigenvalues of dF_(u,v)/d(u, v) at fixed drive.  Derivation: ``docs/theory/orbits.md``.
"""

import math

import numpy as np

from beam.parameters import Array
from contact.flight.variation import all_tip_changes
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Sensitivities
from contact.sensitivity.replay import deviation_rates
from contact.sensitivity.touch_flow import FLOWN, flow_error, flow_from_touch
from contact.touch.passage import new_touches

STEEPEST = 1e10
"""Change of an orbit per change of the amplitude or approach speed that picks it, in units of their sizes,
above which it is rounding.  At a fold the amplitude does not pick an orbit."""


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
    changes: Sensitivities, phase: float, start: Array, m: int, impacts: int, speed: float | None = None
) -> tuple[PeriodicOrbit, Array, Array]:
    """The motion over `m` drive periods from a touch, as an orbit that need not close.

    It starts at drive time `phase` [s] with deviations `start`, shape (2 n_modes,); `speed` is its approach
    speed [m/s], if it is known more exactly.  Returned are also (u, v) at the end less `start`, and the
    derivatives of (u, v) at the end with respect to z and P parameters, the `changes`, shape (2 n_modes,
    2 n_modes + 2 + P).

    NotPeriodic is raised if the motion has fewer touches than `impacts` or a contact does not end, and
    ContactTooStiff if a contact needs more than ``touch_flow.MOST_STEPS``.
    """
    oscillator, vary, n, (u, v) = changes.oscillator, changes.variation, start.size, start.reshape(2, -1)
    flow, end = np.eye(n + 2, n + 2 + len(vary.scalars)), np.array([u, v])
    record = new_touches(impacts, u.size, columns=flow.shape[1])
    outcome = flow_from_touch(vary, phase, end[0], end[1], m * oscillator.period, flow, record)
    if outcome != FLOWN:
        words = f"an orbit of period {m} with {impacts} touches was lost"
        raise flow_error(outcome, phase, float(record.log[0]["approach"]), words)
    if changes.changes:
        rates = deviation_rates(oscillator.numbers(), u, v)
        flow[:n, n + 2 :] += np.multiply.outer(rates, m * changes.period)
    orbit = PeriodicOrbit(
        oscillator=oscillator,
        m=m,
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
