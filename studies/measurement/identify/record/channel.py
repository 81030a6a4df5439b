"""What a sensor reads of a motion: the displacement of the tip, its velocity or its acceleration.

With the modal displacements q, off the stop and over the base z(t) = Z sin(w t), the modes have

    q'' = -Gamma z'' - c q' - omega^2 q + load,

and a sensor of the order k = 0, 1 or 2 reads the k-th derivative in time of

    phi q + ground z,   ground = 1 for a sensor that stands on the ground, 0 for one on the base.

A blow changes the velocity at once, and the force of a contact is no part of the acceleration above.  So
rows next to an impact are left out (`Displacement.apart`); no reading is integrated or differentiated.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contact import ImpactOscillator
from contact.orbits import Change
from studies.measurement.identify.record.records import Array, Record

BESIDE = 1.5  # rows on either side of an impact that are left out


def base_motion(oscillator: ImpactOscillator, times: Array, order: int) -> Array:
    """The derivative of this order of sin(w t) in time."""
    w = oscillator.driven.angular_frequency
    return np.asarray(w**order * np.sin(w * times + 0.5 * np.pi * order))


def rates(oscillator: ImpactOscillator, times: Array, q: Array, v: Array) -> list[Array]:
    """q and its first three derivatives in time, shape (times, modes) each."""
    model, height = oscillator.model, oscillator.driven.amplitude
    found, load = [q, v], 0.0 if oscillator.load is None else oscillator.load
    for order in (2, 3):
        base = np.multiply.outer(height * base_motion(oscillator, times, order), model.participation)
        found.append(load - base - model.decay_rate * found[-1] - model.omega**2 * found[-2])
        load = 0.0
    return found


def response(oscillator: ImpactOscillator, record: Record) -> complex:
    """Reading per displacement of the base, of the steady motion without impacts."""
    way = (1j * oscillator.driven.angular_frequency) ** record.order
    return complex(way * (oscillator.tip_response() + record.ground))


def readings(record: Record, oscillator: ImpactOscillator, times: Array, found: Sequence[Array]) -> Array:
    """The readings, and how they change in time, from the `rates` there; shape (2, times)."""
    height, orders = record.ground * oscillator.driven.amplitude, (record.order, record.order + 1)
    own = [oscillator.tip(found[k]) + height * base_motion(oscillator, times, k) for k in orders]
    return np.array(own)


def readings_changed(
    record: Record,
    oscillator: ImpactOscillator,
    changes: Sequence[Change],
    times: Array,
    found: Sequence[Array],
    states: Array,
) -> Array:
    """Derivatives of the readings by the start and the changes, shape (times, 2 modes + changes).

    `states` are derivatives of the states, shape (times, 2 modes, 2 modes + changes).
    """
    model, order, n = oscillator.model, record.order, oscillator.n_modes
    numbers = ("omega", "decay_rate", "phi", "participation")
    shapes = [[getattr(one.model, name, np.zeros(n)) for one in changes] for name in numbers]
    omega, rate, phi, gamma = (np.array(rows).reshape(-1, n).T for rows in shapes)
    drive, w = oscillator.driven, oscillator.driven.angular_frequency
    faster = 2.0 * np.pi * drive.amplitude * np.array([one.frequency for one in changes])
    higher = np.array([one.amplitude for one in changes])

    def base(k: int) -> Array:
        """Of the derivative of order k of the base motion, by the changes."""
        sine, later = base_motion(oscillator, times, k), base_motion(oscillator, times, k + 1)
        return np.outer(sine, higher) + np.outer((k * sine + times * later) / w, faster)

    q, v = (one[:, :, None] for one in found[:2])
    parts = [states[:, :n], states[:, n:]]
    if order == 2:
        parts.append(-model.decay_rate[:, None] * parts[1] - model.omega[:, None] ** 2 * parts[0])
        parts[2][:, :, 2 * n :] -= v * rate + q * (2.0 * model.omega[:, None] * omega)
        parts[2][:, :, 2 * n :] -= model.participation[:, None] * base(2)[:, None, :]
        parts[2][:, :, 2 * n :] -= drive.amplitude * base_motion(oscillator, times, 2)[:, None, None] * gamma
    moved = np.tensordot(parts[order], model.phi, (1, 0))
    moved[:, 2 * n :] += found[order] @ phi + record.ground * base(order)
    return np.asarray(moved)


def clear_of(record: Record, begin: Array, end: Array, lasting: float, width: float) -> Record:
    """The record without rows next to touches that repeat, if it is no displacement.

    Touches `begin` and `end` at these times and come again after `lasting`; rows so close to them are left
    out, and not fewer than `BESIDE` on either side [s].
    """
    if not record.order:
        return record
    times = record.rows[:, 0]
    width = max(width, BESIDE * float(np.median(np.diff(times))))
    since = (times[:, None] - begin + width) % lasting
    near = np.any(since < end - begin + 2.0 * width, axis=1)
    return replace(record, rows=record.rows[~near])
