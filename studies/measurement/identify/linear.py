"""A displacement without impacts: the steady motion at the drive frequency f and the decay of a free mode.

    x(t) = offset + Re(Y exp(2 pi i f t)) + Re(A exp(-c t/2 + 2 pi i t/T)),   T, c, f by least squares.

A steady motion has A = 0: it gives the modulus of the response, and so one of T, c and the amplitude.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from contact import ImpactOscillator
from studies.measurement.identify.diagnosis import off_neighbours, peaks, repetition
from studies.measurement.identify.displacement import SENSOR, Displacement
from studies.measurement.identify.kicks import poles
from studies.measurement.identify.records import NoAnswer, Record
from studies.physics.parameters import with_values

Array = NDArray[np.float64]

NAMES, RESPONSE = ("free_period", "decay_rate", "amplitude", "frequency"), 3
"""Parameters that such a motion hangs on; how many of the first do so by the response alone."""

FREE, DECAYS, AWAY = np.geomspace(0.5, 2.0, 40), (0.03, 0.1, 0.3), 1e3
"""Free periods and decay rates that a search begins with, by the drive period; gap by the largest reading."""

SEEN, NOISE = 40.0, 2.0
"""Fall of chi^2 by which a free mode is seen, or this motion is better than an orbit; what it may leave over
the noise between neighbouring rows."""


class Linear:
    """The least-squares motion without impacts of a record; `rest` is what it leaves [m]."""

    def __init__(self, record: Record) -> None:
        (self.times, self.values), self.record = record.rows.T, record
        line = record.frequency or float(peaks(self.times, self.values)[0][0])
        grid = [np.array([line, at / line, rate * line]) for at in FREE for rate in DECAYS]
        begun = min(grid, key=lambda one: float(np.sum(self.left(one)[1] ** 2)))

        def off(logs: Array) -> Array:
            return self.left(begun * np.exp(logs))[1]

        found = least_squares(off, np.zeros(3), x_scale="jac", max_nfev=60)
        self.frequency, self.free_period, self.decay_rate = begun * np.exp(found.x)
        parts, rest = self.left(begun * np.exp(found.x))
        self.offset, self.steady, self.free = parts[0], parts[1] - 1j * parts[2], parts[3] - 1j * parts[4]
        alone, self.rest = self.left(np.array([self.frequency]))[1], float(rest.std())
        self.decays = rest.size * (alone.var() / max(rest.var(), 1e-300) - 1.0) > SEEN

    def left(self, numbers: Array) -> tuple[Array, Array]:
        """Linear coefficients and residuals, with f, T and c or with f alone."""
        waves = [np.exp(2j * math.pi * numbers[0] * self.times)]
        if numbers.size > 1:
            pole = 2j * math.pi / numbers[1] - 0.5 * numbers[2]
            waves.append(np.exp(pole * (self.times - self.times[0])))
        matrix = np.vstack([self.times**0, *(part for wave in waves for part in (wave.real, wave.imag))])
        found = np.linalg.lstsq(matrix @ matrix.T, matrix @ self.values, rcond=None)[0]
        return found, self.values - found @ matrix

    @property
    def likely(self) -> bool:
        """Whether this leaves noise, and less than any orbit."""
        if not self.decays or self.rest > NOISE * off_neighbours(self.times, self.values)[1]:
            return False
        orbit = repetition(self.times, self.values, float(self.frequency)).min()
        return bool(self.times.size * ((orbit / self.rest) ** 2 - 1.0) > SEEN)

    def start(
        self, oscillator: ImpactOscillator, names: Sequence[str], free: Sequence[str]
    ) -> tuple[Displacement, ImpactOscillator, tuple[str, ...]]:
        """The start of a fit with the stop far away, and the names that can be fitted."""
        kept, lost = ([n for n in names if (n in NAMES) == own] for own in (True, False))
        alike = [name for name in kept if name in NAMES[:RESPONSE]]
        if not kept or (not self.decays and len(alike) > 1):
            blind = f"{', '.join(alike[:-1])} and {alike[-1]} apart" if kept else ", ".join(lost)
            motion = f"{'a' if self.decays else 'a steady'} motion without impacts at {self.frequency:.4g} Hz"
            height = f"of amplitude {1e3 * abs(self.steady):.3g} mm"
            raise NoAnswer(f"{motion} {height}: it cannot tell {blind}; there is no impact in the record")
        found = {"frequency": float(self.frequency), "gap": AWAY * float(np.abs(self.values).max())}
        if self.decays:
            found |= {"free_period": float(self.free_period), "decay_rate": float(self.decay_rate)}
        at = with_values(oscillator, {n: found[n] for n in found if n in kept or n in ("gap", "frequency")})
        drive = 1j * self.steady / at.tip_response()
        if "amplitude" in kept:
            at = with_values(at, {"amplitude": abs(drive)})
        turn = np.exp(1j * at.driven.angular_frequency * self.times[0])
        state = state_of(at, self.steady / at.tip_response() * turn, self.free * self.decays)
        sensor = dict(SENSOR) | {"offset": float(self.offset), "phase": float(np.angle(drive))}
        sensor = {name: sensor[name] if name in free else SENSOR[name] for name in sensor}
        note = f"no impact in the record: not fitted: {', '.join(lost) or 'nothing else'}"
        record = replace(self.record, notes=(*self.record.notes, note))
        return Displacement(record, at, state, sensor, free), at, tuple(kept)


def state_of(oscillator: ImpactOscillator, base: complex, free: complex) -> Array:
    """Modal displacements and velocities where the base is at Re(`base`), moved at the drive frequency, and
    mode 1 moves the tip by Re(`free`) besides."""
    model, w = oscillator.model, oscillator.driven.angular_frequency
    share = oscillator.steady_response() * base
    own = np.eye(model.n_modes)[model.leading_mode] / model.phi * free
    return np.append((share + own).real, (1j * w * share + poles(oscillator) * own).real)
