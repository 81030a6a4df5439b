"""What a sensor reads of a motion: the displacement of the tip, its velocity or its acceleration.

With the modal displacements q, off the stop and over the base z(t) = Z sin(w t), the modes have

    q'' = -Gamma z'' - c q' - omega^2 q + load,

and a sensor of the order k = 0, 1 or 2 reads the k-th derivative in time of

    phi q + ground z,   ground = 1 for a sensor that stands on the ground, 0 for one on the base.

A blow changes the velocity at once, and the force of a contact is no part of the acceleration above.  So
rows next to an impact are left out (`clear_of`); no reading is integrated or differentiated.
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
    """The readings of each column, and how the last changes in time, by the `rates` there; (columns + 1,
    times)."""
    height, first = record.ground * oscillator.driven.amplitude, record.order
    orders = range(first, first + record.observed.shape[1] + 1)
    return np.array([oscillator.tip(found[k]) + height * base_motion(oscillator, times, k) for k in orders])


def readings_changed(
    record: Record,
    oscillator: ImpactOscillator,
    changes: Sequence[Change],
    times: Array,
    found: Sequence[Array],
    states: Array,
) -> list[Sequence[Array]]:
    """Derivatives of the readings of each column by the start, shape (times, 2 modes), and by the changes.

    `states` are derivatives of the states, shape (times, 2 modes, 2 modes + changes).
    """
    model, n, drive = oscillator.model, oscillator.n_modes, oscillator.driven
    names = ("omega", "decay_rate", "phi", "participation")
    shapes = [[getattr(one.model, name, np.zeros(n)) for one in changes] for name in names]
    omega, rate, phi, gamma = (np.array(rows).reshape(-1, n).T for rows in shapes)
    faster = 2.0 * np.pi * drive.amplitude * np.array([one.frequency for one in changes])
    higher = np.array([one.amplitude for one in changes])

    def base(k: int) -> Array:
        """Of the derivative of order k of the base motion, by the changes."""
        sine, later = base_motion(oscillator, times, k), base_motion(oscillator, times, k + 1)
        w = drive.angular_frequency
        return np.outer(sine, higher) + np.outer((k * sine + times * later) / w, faster)

    parts = [states[:, :n], states[:, n:]]
    if record.order == 2:
        q, v = (one[:, :, None] for one in found[:2])
        parts.append(-model.decay_rate[:, None] * parts[1] - model.omega[:, None] ** 2 * parts[0])
        parts[2][:, :, 2 * n :] -= v * rate + q * (2.0 * model.omega[:, None] * omega)
        parts[2][:, :, 2 * n :] -= model.participation[:, None] * base(2)[:, None, :]
        parts[2][:, :, 2 * n :] -= drive.amplitude * base_motion(oscillator, times, 2)[:, None, None] * gamma
    blocks = list[Sequence[Array]]()
    for k in range(record.order, record.order + record.observed.shape[1]):
        moved = np.tensordot(parts[k], model.phi, (1, 0))
        own = moved[:, 2 * n :] + found[k] @ phi + record.ground * base(k)
        blocks.append((moved[:, : 2 * n], own))
    return blocks


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
    note = f"{np.sum(near)} of {near.size} rows next to impacts or in contact are left out"
    return replace(record, rows=record.rows[~near], notes=(*record.notes, note))
