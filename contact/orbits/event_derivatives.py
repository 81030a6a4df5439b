r"""How the period doubling and the graze of a branch move with the numbers of the oscillator.

Along a branch, told by the approach speed s, they lie where g(s, p) = 0, a multiplier plus 1, or the height
of a peak over the stop; hence

    d(excess)/dp = excess_p - excess_s g_p/g_s.

The height changes as the tip does at the time of the peak.  A multiplier changes with the tangents of the
flow: with left and right eigenvectors l, r of the monodromy matrix M by l M. r/(l r), where M. is taken from
central differences of order four of the exact tangents, along the exact change of the orbit.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from contact.change import Change
from contact.errors import NoDerivative
from contact.flight.motion import Motion, motion_of, with_drive
from contact.flight.tip_search import tip_at
from contact.orbits.derivatives import OrbitDerivatives, drive_of, sizes_of, with_speed
from contact.orbits.periodic_orbit import PeriodicOrbit
from contact.retraced import Retraced
from contact.simulation import simulate
from contact.touch.tangents import all_tip_changes, variation
from contact.touch_flow import FLOWN, flow_from_touch

__all__ = ["doubling_derivatives", "graze_derivatives", "multiplier_derivatives", "peaks"]

Array = NDArray[np.float64]

STRIDE = 1e-3
"""Part of itself by which the orbit or a number of the oscillator is moved for the differences of tangents:
its fourth power, and rounding divided by it, are 1e-12 to 1e-11."""

WEIGHTS = np.array([8.0, -1.0]) / 12.0
"""Of f(h) - f(-h) and f(2h) - f(-2h) in h f'."""

PEAKS = 400
"""Points a drive period among which the peaks of a flight are looked for."""

NEAR = 1e-6
"""Part of the approach speed by which an orbit may miss its graze: located ones do by 1e-10."""


def multiplier_derivatives(found: OrbitDerivatives) -> NDArray[np.complex128]:
    """Those of the Floquet multipliers, in the order of the orbit's, shape (2 n_modes, P).

    Each parameter takes four flows over the m periods.  Multipliers that coincide have none.
    """
    values, right = np.linalg.eig(found.orbit.monodromy())
    order, left = np.argsort(-np.abs(values)), np.linalg.inv(right)
    moves = [
        np.diag(left @ _tangent_change(found, p) @ right)[order] for p in range(found.start.shape[1])
    ]
    return np.asarray(np.array(moves, dtype=complex).reshape(-1, values.size).T)


def doubling_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp of the period doubling at which `orbit` lies, shape (P,)."""
    found = with_speed(orbit, changes)
    nearest = multiplier_derivatives(found)[np.argmin(np.abs(orbit.multipliers + 1.0))].real
    return np.asarray(found.excess[:-1] - found.excess[-1] * nearest[:-1] / nearest[-1])


def graze_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp of the grazing at which `orbit` lies, a peak between its touches at the stop, (P,).

    Raises
    ------
    NoDerivative
        If none of its peaks grazes at a speed that is the same to 1e-6.
    """
    found = with_speed(orbit, changes)
    oscillator, state = orbit.oscillator, orbit.state()
    none = 0, oscillator.period, -np.inf
    last, wait, height = max(peaks(orbit), key=lambda peak: peak[2], default=none)
    released = orbit.record[last, 1]
    run = simulate(oscillator, state, duration=released + 0.5 * wait)
    traced, size = Retraced(found.changes, run, state), len(found.start)
    traced.tangent = np.eye(size, size + found.start.shape[1])
    tangent = traced.to(orbit.phase + released + wait)
    moved = np.ascontiguousarray(tangent[:, :size] @ found.start + tangent[:, size:])
    clock = traced.clock % oscillator.period
    risen, _rate = all_tip_changes(found.changes.variation, moved, traced.u, traced.v, clock)
    if not abs(height) <= NEAR * orbit.speed * abs(risen[-1]):
        raise NoDerivative(
            time=orbit.phase + released + wait, gap=-height, velocity=0.0,
            detail="no peak of the orbit between its touches grazes the stop",
        )
    return np.asarray(found.excess[:-1] - found.excess[-1] * risen[:-1] / risen[-1])


def peaks(orbit: PeriodicOrbit) -> list[tuple[int, float, float]]:
    """The peaks of all flights, the wall ignored: after which touch, how long after it [s], and height over
    the stop [m]."""
    from scipy.optimize import brentq  # slow to import

    motion, n = orbit.oscillator.motion(), orbit.oscillator.n_modes
    found = list[tuple[int, float, float]]()
    ends = np.append(orbit.record[1:, 0], orbit.duration)
    for i, (row, end) in enumerate(zip(orbit.record, ends, strict=True)):
        base, u, v = float(orbit.phase + row[1]), row[4 : 4 + n].copy(), row[4 + n :].copy()
        tip = partial(tip_at, motion, base, u, v)
        grid = np.linspace(0.0, end - row[1], PEAKS * orbit.period + 1)[1:-1]
        rate = np.array([tip(s)[1] for s in grid])
        for j in np.flatnonzero((rate[:-1] > 0.0) & (rate[1:] <= 0.0)):
            s = float(brentq(lambda s, tip=tip: tip(s)[1], grid[j], grid[j + 1], xtol=1e-16))
            found.append((i, s, float(tip(s)[0])))
    return found


def _moved(found: OrbitDerivatives, p: int, step: float) -> tuple[Motion, complex]:
    """The numbers of the oscillator, moved by `step` along parameter `p`, at amplitude 1; and a + i b."""
    oscillator, change = found.orbit.oscillator, found.changes.changes[p]
    omega, decay, phi, gamma = (
        getattr(oscillator.model, name) + step * rows[p] for name, rows in found.changes.model.items()
    )
    law, w = oscillator.stop.law, oscillator.driven.angular_frequency + step * found.changes.pace[p]
    response = gamma * w**2 / ((omega - w) * (omega + w) + 1j * decay * w)
    table = law.table.copy()
    table[[1, 3]] += step * np.array(change.law)[:, None]
    numbers = tuple(a + step * b for a, b in zip(law.numbers, change.law, strict=True))
    motion = motion_of(
        omega, decay, phi, law=SimpleNamespace(code=law.code, numbers=numbers, table=table), drive=w,
        gap=oscillator.stop.gap + step * change.gap, period=2.0 * np.pi / w, response=response,
    )  # fmt: skip
    return motion, complex(phi @ response)


def _tangent_change(found: OrbitDerivatives, p: int) -> Array:
    """Derivative of the monodromy matrix with parameter `p`, along the orbit's own."""
    orbit, changes, start = found.orbit, found.changes, found.start[:, p]
    n, oscillator, z = orbit.deviations.size, orbit.oscillator, np.append(orbit.deviations, drive_of(orbit))
    law, w = np.array(oscillator.stop.law.numbers), oscillator.driven.angular_frequency
    parts = [
        start[:n] / sizes_of(orbit), start[n:] / orbit.amplitude, found.speed[p] / orbit.speed,
        changes.model["omega"][p] / w, changes.model["decay_rate"][p] / w,
        changes.model["phi"][p] / np.abs(oscillator.model.phi).max(), changes.pace[p] / w,
        changes.level[p] / oscillator.stop.gap,
        np.array(changes.changes[p].law) / np.where(law > 0.0, law, 1.0),
    ]  # fmt: skip
    size = max(float(np.max(np.abs(part))) for part in parts)
    if size == 0.0:
        return np.zeros((n, n))

    def tangent(step: float) -> Array:
        moved, (motion, response) = z + step * start, _moved(found, p, step)
        motion = with_drive(motion, float(np.hypot(*moved[-2:])))
        base = float(np.arctan2(*moved[-2:])) % (2.0 * np.pi) / motion.drive
        (u, v), matrix = moved[:n].reshape(2, -1).copy(), np.eye(n + 2)
        record, duration = np.empty((orbit.impacts, 4 + n)), orbit.period * motion.period
        if flow_from_touch(variation(motion, response), base, u, v, duration, matrix, record) != FLOWN:
            raise NoDerivative(
                time=base, gap=0.0, velocity=float(record[0, 2]), detail="a neighbouring orbit loses a touch"
            )
        return matrix[:n, :n]

    step = STRIDE / size
    pairs = [tangent(j * step) - tangent(-j * step) for j in range(1, WEIGHTS.size + 1)]
    return np.asarray(np.tensordot(WEIGHTS, pairs, 1) / step)
