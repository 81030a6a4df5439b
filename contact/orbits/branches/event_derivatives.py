r"""How the period doubling and the graze of a branch move with the numbers of the oscillator.

Along a branch, told by the approach speed s, they lie where g(s, p) = 0, a multiplier plus 1, or the height
of a peak over the stop; hence

    d(excess)/dp = excess_p - excess_s g_p/g_s.

The height changes as the tip does at the time of the peak.  A multiplier changes with the tangents of the
flow: with left and right eigenvectors l, r of the monodromy matrix M by l M. r/(l r), where M. is taken from
central differences of order four of the exact tangents, along the exact change of the orbit.  Their stride is
halved until the derivatives of all multipliers settle, since next to a slow touch M is smooth over short ones
only; the last two give the next order.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require_kind
from contact.errors import NoDerivative
from contact.flight.motion import Motion, motion_of, with_drive
from contact.flight.tip_search import peaks_of_flight, tip_at
from contact.flight.variation import all_tip_changes, variation
from contact.orbits.branches.orbit_derivatives import OrbitDerivatives, drive_of, sizes_of, with_speed
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.sensitivity.change import Change
from contact.sensitivity.replay import Retraced
from contact.sensitivity.touch_flow import FLOWN, flow_from_touch
from contact.simulation import simulate

Array = NDArray[np.float64]

STRIDE, MOST_STRIDES = 4e-3, 16
"""Part of itself by which the orbit or a number of the oscillator is moved for the first differences of
tangents, and how often that is halved at most: then rounding takes half of the digits."""

SETTLED, UNCERTAIN, NOISE = 1e-9, 1e-7, 1e-12
"""Error of the derivatives of multipliers, over the largest, at which no shorter stride is tried; the largest
that is returned; and rounding of each number of a monodromy matrix."""

WEIGHTS = np.array([8.0, -1.0]) / 12.0
"""Of f(h) - f(-h) and f(2h) - f(-2h) in h f'."""

DOUBLES = 1e-5
"""Distance of a multiplier from -1 at a period doubling: located ones are within 1e-6."""

NEAR = 1e-6
"""Part of the approach speed by which an orbit may miss its graze: located ones do by 1e-10."""


def multiplier_derivatives(found: OrbitDerivatives) -> NDArray[np.complex128]:
    """Those of the Floquet multipliers, in the order of the orbit's, shape (2 n_modes, P).

    Each parameter takes six flows over the m periods, and more next to a slow touch.

    Raises
    ------
    NoDerivative
        Where one is not certain to 1e-7: next to a graze, or where multipliers coincide.
    """
    require_kind("found", found, OrbitDerivatives, "OrbitDerivatives of a periodic orbit")
    orbit, matrix = found.orbit, found.orbit.monodromy()
    values, right = np.linalg.eig(matrix)
    order = np.argmin(np.abs(values - orbit.multipliers[:, None]), axis=1)
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:
        left = np.full(right.shape, np.nan)
    apart = np.maximum(np.abs(values[:, None] - values), 1e-300) + np.diag(np.full(values.size, np.inf))
    noise = (NOISE + orbit.residual) * np.abs(left) @ np.abs(matrix) @ np.abs(right)
    moves = np.empty((values.size, found.start.shape[1]), dtype=complex)
    for p in range(found.start.shape[1]):
        before, error = np.full(values.size, np.nan), np.inf
        for change, size in _tangent_changes(found, p):
            rates = left @ change @ right
            moved, coupled = np.diag(rates), np.abs(rates) / apart
            # rounding of the matrix turns each eigenvector towards the others
            turned = float(np.max(np.diag(noise @ coupled + coupled @ noise)))
            scale = float(np.abs(moved).max() + size * np.abs(values).max())
            off = float(np.max(np.abs(moved - before))) / scale
            if off + turned / scale < error:
                error, moves[:, p] = off + turned / scale, (moved + (moved - before) / 15.0)[order]
            if off < SETTLED:
                break
            before = moved
        if not error < UNCERTAIN:
            raise NoDerivative(
                time=orbit.phase,
                gap=0.0,
                velocity=orbit.speed,
                detail=f"derivatives of multipliers are uncertain by {error:.1e} of the largest, as next to "
                "a graze or where two of them coincide",
            )
    return moves


def doubling_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp of the period doubling at which `orbit` lies, (P,); NoDerivative where it does not."""
    found, apart = with_speed(orbit, changes), np.abs(orbit.multipliers + 1.0)
    if not apart.min() <= DOUBLES:
        words = f"no multiplier of the orbit is -1, the nearest is {apart.min():.3g} off"
        raise NoDerivative(time=orbit.phase, gap=0.0, velocity=orbit.speed, detail=words)
    nearest = multiplier_derivatives(found)[np.argmin(apart)].real
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
            time=orbit.phase + released + wait,
            gap=-height,
            velocity=0.0,
            detail="no peak of the orbit between its touches grazes the stop",
        )
    return np.asarray(found.excess[:-1] - found.excess[-1] * risen[:-1] / risen[-1])


def peaks(orbit: PeriodicOrbit) -> list[tuple[int, float, float]]:
    """The peaks of all flights, the wall ignored: after which touch, how long after it [s], and height over
    the stop [m].  None is missed."""
    motion, n = orbit.oscillator.motion(), orbit.oscillator.n_modes
    found = list[tuple[int, float, float]]()
    ends = np.append(orbit.record[1:, 0], orbit.duration)
    for i, (row, end) in enumerate(zip(orbit.record, ends, strict=True)):
        base, u, v = float(orbit.phase + row[1]), row[4 : 4 + n].copy(), row[4 + n :].copy()
        times = peaks_of_flight(motion, base, u, v, (0.0, end - row[1]), False).tolist()
        found += [(i, s, float(tip_at(motion, base, u, v, s)[0])) for s in times]
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
        omega,
        decay,
        phi,
        law=SimpleNamespace(code=law.code, numbers=numbers, table=table),
        drive=w,
        gap=oscillator.stop.gap + step * change.gap,
        period=2.0 * np.pi / w,
        response=response,
    )
    return motion, complex(phi @ response)


def _tangent_changes(found: OrbitDerivatives, p: int) -> Iterator[tuple[Array, float]]:
    """Derivatives of the monodromy matrix with parameter `p`, along the orbit's own, over shorter and shorter
    strides on which no touch is lost; and the largest change of the orbit and its numbers over themselves."""
    orbit, changes, start = found.orbit, found.changes, found.start[:, p]
    n, oscillator, z = orbit.deviations.size, orbit.oscillator, np.append(orbit.deviations, drive_of(orbit))
    law, w = np.array(oscillator.stop.law.numbers), oscillator.driven.angular_frequency
    parts = [
        start[:n] / sizes_of(orbit.oscillator),
        start[n:] / orbit.amplitude,
        found.speed[p] / orbit.speed,
        changes.model["omega"][p] / w,
        changes.model["decay_rate"][p] / w,
        changes.model["phi"][p] / np.abs(oscillator.model.phi).max(),
        changes.pace[p] / w,
        changes.level[p] / oscillator.stop.gap,
        np.array(changes.changes[p].law) / np.where(law > 0.0, law, 1.0),
    ]
    size = max(1e-99, *(float(np.max(np.abs(part))) for part in parts))

    def tangent(step: float) -> Array:
        moved, (motion, response) = z + step * start, _moved(found, p, step)
        motion = with_drive(motion, float(np.hypot(*moved[-2:])))
        base = float(np.arctan2(*moved[-2:])) % (2.0 * np.pi) / motion.drive
        (u, v), matrix = moved[:n].reshape(2, -1).copy(), np.eye(n + 2)
        record, duration = np.empty((orbit.impacts, 4 + n)), orbit.period * motion.period
        outcome = flow_from_touch(variation(motion, response), base, u, v, duration, matrix, record)
        return matrix[:n, :n] if outcome == FLOWN else np.full((n, n), np.nan)

    step = STRIDE / size
    far = tangent(2.0 * step) - tangent(-2.0 * step)
    for _ in range(MOST_STRIDES):
        near = tangent(step) - tangent(-step)
        if np.all(np.isfinite(far)):
            yield (WEIGHTS[0] * near + WEIGHTS[1] * far) / step, size
        step, far = 0.5 * step, near
