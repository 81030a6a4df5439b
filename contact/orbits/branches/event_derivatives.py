r"""Derivatives of the period doubling and the graze of a branch with respect to the oscillator's numbers.

On a branch over the approach speed s, they lie where g(s, p) = 0.  Here g is a multiplier plus 1, or the
height of a peak over the stop.  Hence

    d(excess)/dp = excess_p - excess_s g_p/g_s.

The height changes as the tip does at the time of the peak.  The derivative of a multiplier is l M. r/(l r),
with left and right eigenvectors l, r of the monodromy matrix M.  M. is taken from central differences of
order four of the exact tangents, along the exact change of the orbit.  Next to a slow touch M is smooth over
short strides only.  The stride is therefore halved until the derivatives of all multipliers settle; the last
two results give the next order.
"""

from collections.abc import Iterator, Sequence
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from beam.parameters import Array, require_kind
from contact.errors import NoDerivative
from contact.flight.motion import Motion, motion_of, with_drive
from contact.flight.tip_search import peaks_of_flight, tip_at
from contact.flight.variation import all_tip_changes, variation
from contact.orbits.branches.orbit_derivatives import OrbitDerivatives, with_speed
from contact.orbits.families.equations import amplitude_and_time, drive_of, sizes_of
from contact.orbits.families.family import PeriodicOrbit
from contact.oscillator import dynamic_stiffness
from contact.sensitivity.change import Change
from contact.sensitivity.replay import Replay
from contact.sensitivity.touch_flow import FLOWN, flow_from_touch
from contact.simulation import simulate

STRIDE, MOST_STRIDES = 4e-3, 16
"""Part of itself by which the orbit or a number of the oscillator is moved for the first differences of
tangents; and bound of halvings, after which rounding takes half of the digits."""

SETTLED, UNCERTAIN, NOISE = 1e-9, 1e-7, 1e-12
"""Error of the derivatives of multipliers, over the largest, at which no shorter stride is tried; largest
error of a result; and rounding of each number of a monodromy matrix."""

WEIGHTS = np.array([8.0, -1.0]) / 12.0  # weights of f(h) - f(-h) and f(2h) - f(-2h) in the difference h f'
DOUBLES = 1e-5  # distance of a multiplier from -1 at a period doubling: located ones are within 1e-6
NEAR = 1e-6  # part of the approach speed by which an orbit may miss its graze: located ones do by 1e-10


def multiplier_derivatives(found: OrbitDerivatives) -> NDArray[np.complex128]:
    """Derivatives of the Floquet multipliers, in the order of `multipliers`, shape (2 n_modes, P).

    Each parameter takes six flows over the m periods, and more next to a slow touch.  NoDerivative is raised
    where a derivative is not certain to 1e-7: next to a graze, or where multipliers coincide.
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
            rounding = float(np.max(np.diag(noise @ coupled + coupled @ noise)))
            scale = float(np.abs(moved).max() + size * np.abs(values).max())
            off = float(np.max(np.abs(moved - before))) / scale
            if off + rounding / scale < error:
                error, moves[:, p] = off + rounding / scale, (moved + (moved - before) / 15.0)[order]
            if off < SETTLED:
                break
            before = moved
        if not error < UNCERTAIN:
            words = f"derivatives of multipliers are uncertain by {error:.1e} of the largest, as next to "
            raise orbit.failure(NoDerivative, words + "a graze or where two of them coincide")
    return moves


def doubling_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp of the period doubling at which `orbit` lies, shape (P,).

    NoDerivative is raised if no multiplier of the orbit is -1.
    """
    found, apart = with_speed(orbit, changes), np.abs(orbit.multipliers + 1.0)
    if not apart.min() <= DOUBLES:
        words = f"no multiplier of the orbit is -1, the nearest is {apart.min():.3g} off"
        raise orbit.failure(NoDerivative, words)
    nearest = multiplier_derivatives(found)[np.argmin(apart)].real
    return np.asarray(found.excess[:-1] - found.excess[-1] * nearest[:-1] / nearest[-1])


def graze_derivatives(orbit: PeriodicOrbit, changes: Sequence[Change]) -> Array:
    """d(F/F_g - 1)/dp of the grazing at which `orbit` lies, shape (P,).

    A peak between its touches reaches the stop there.  NoDerivative is raised if no peak does so at an
    approach speed equal to the orbit's within 1e-6.
    """
    found = with_speed(orbit, changes)
    oscillator, state = orbit.oscillator, orbit.state()
    none = 0, oscillator.period, -np.inf
    last, wait, height = max(peaks(orbit), key=lambda peak: peak[2], default=none)
    released = orbit.record[last, 1]
    run = simulate(oscillator, state, duration=released + 0.5 * wait)
    replay, size = Replay(found.changes, run, state), len(found.start)
    replay.tangent = np.eye(size, size + found.start.shape[1])
    tangent = replay.to(orbit.phase + released + wait)
    moved = np.ascontiguousarray(tangent[:, :size] @ found.start + tangent[:, size:])
    clock = replay.clock % oscillator.period
    heights, _rate = all_tip_changes(found.changes.variation, moved, replay.u, replay.v, clock)
    if not abs(height) <= NEAR * orbit.speed * abs(heights[-1]):
        raise NoDerivative(
            time=orbit.phase + released + wait,
            gap=-height,
            velocity=0.0,
            detail="no peak of the orbit between its touches grazes the stop",
        )
    return np.asarray(found.excess[:-1] - found.excess[-1] * heights[:-1] / heights[-1])


def peaks(orbit: PeriodicOrbit) -> list[tuple[int, float, float]]:
    """All peaks of the flights of an orbit, the wall ignored; none is missed.

    Each is given by the number of the touch before it, the time since its end [s], and the height over the
    stop [m].
    """
    motion, n = orbit.oscillator.motion(), orbit.oscillator.n_modes
    found = list[tuple[int, float, float]]()
    ends = np.append(orbit.record[1:, 0], orbit.duration)
    for i, (row, end) in enumerate(zip(orbit.record, ends, strict=True)):
        base, u, v = float(orbit.phase + row[1]), row[4 : 4 + n].copy(), row[4 + n :].copy()
        times = peaks_of_flight(motion, base, u, v, (0.0, end - row[1]), False).tolist()
        found += [(i, s, float(tip_at(motion, base, u, v, s)[0])) for s in times]
    return found


def _moved(found: OrbitDerivatives, p: int, step: float) -> tuple[Motion, complex]:
    """The numbers of the oscillator at amplitude 1, moved by `step` along parameter `p`; and a + i b."""
    oscillator, change = found.orbit.oscillator, found.changes.changes[p]
    omega, decay, phi, gamma = (
        getattr(oscillator.model, name) + step * rows[p] for name, rows in found.changes.model.items()
    )
    law, w = oscillator.stop.law, oscillator.driven.angular_frequency + step * found.changes.frequency[p]
    response = gamma * w**2 / dynamic_stiffness(omega, decay, w)
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
    """Derivatives of the monodromy matrix with respect to parameter `p`, over shorter and shorter strides.

    The orbit moves with the parameter; strides on which a touch is lost are left out.  The second result is
    the largest relative change of the orbit and of the numbers of its oscillator.
    """
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
        changes.frequency[p] / w,
        changes.level[p] / oscillator.stop.gap,
        np.array(changes.changes[p].law) / np.where(law > 0.0, law, 1.0),
    ]
    size = max(1e-99, *(float(np.max(np.abs(part))) for part in parts))

    def tangent(step: float) -> Array:
        moved, (motion, response) = z + step * start, _moved(found, p, step)
        amplitude, base = amplitude_and_time(moved[-2:], motion.drive)
        motion = with_drive(motion, amplitude)
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
