"""A displacement without impacts: the steady motion at the drive frequency f and the decay of a free mode.

    x(t) = offset + Re(Y exp(2 pi i f t)) + Re(A exp(-c t/2 + 2 pi i t/T)),   T, c, f by least squares.

A steady motion has A = 0: it gives the modulus of the response, and so one of T, c and the amplitude.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from contact import ImpactOscillator
from studies.measurement.identify.motion.readings import SENSOR, Readings
from studies.measurement.identify.record.channel import response
from studies.measurement.identify.record.kicks import poles
from studies.measurement.identify.record.records import Array, NoAnswer, Record
from studies.measurement.identify.record.soundness import off_neighbours
from studies.measurement.identify.record.spectrum import peaks, scatter
from studies.physics.parameters import with_values
from studies.shell.digits import in_unit

NAMES = ("free_period", "decay_rate", "amplitude", "frequency")  # all that such a motion depends on
RESPONSE = 3  # how many of the first enter by the response alone
LOGS = -3.0, 3.0  # logarithms by which f, T and c may leave where a search begins
FREE, DECAYS = np.geomspace(0.5, 2.0, 40), (0.03, 0.1, 0.3)  # first T and c, in drive periods and per period
AWAY = 1e3  # gap over the largest reading
SEEN = 40.0  # fall of chi^2 by which a free mode is seen, or this motion is better than an orbit
NOISE = 2.0  # what this motion may leave over the noise between neighbouring rows
LASTS = 0.05  # decay rate times span of a line that does not decay


class Linear:
    """The least-squares motion without impacts of a record; `rest` is what it leaves [m]."""

    def __init__(self, record: Record) -> None:
        (self.times, self.values), self.record = record.rows.T, record
        line = record.frequency or float(peaks(self.times, self.values, record.order)[0][0])
        grid = [np.array([line, at / line, rate * line]) for at in FREE for rate in DECAYS]
        begun = min(grid, key=lambda one: float(np.sum(self.left(*one)[1] ** 2)))

        def off(logs: Array) -> Array:
            return self.left(*begun * np.exp(np.clip(logs, *LOGS)))[1]

        best = begun * np.exp(least_squares(off, np.zeros(3), x_scale="jac", max_nfev=60).x)
        self.frequency, self.free_period, self.decay_rate = best.tolist()
        (self.offset, *real, imag, last), rest = self.left(*best)
        self.steady, self.free = complex(real[0], -imag), complex(real[1], -last)
        self.rest, alone = float(rest.std()), self.left(self.frequency)[1]
        self.decays = rest.size * (alone.var() / max(rest.var(), 1e-300) - 1.0) > SEEN

    def left(self, frequency: float, *mode: float) -> tuple[Array, Array]:
        """Offset, real and minus imaginary parts of Y and A at the first row, and residuals; or without A."""
        rates = [2j * math.pi * frequency, *([2j * math.pi / mode[0] - 0.5 * mode[1]] if mode else [])]
        waves = np.exp(np.outer(rates, self.times - self.times[0]))
        matrix = np.vstack([self.times**0, waves.real, waves.imag])
        found = np.linalg.lstsq(matrix @ matrix.T, matrix @ self.values, rcond=None)[0]
        return found, self.values - found @ matrix

    @property
    def likely(self) -> bool:
        """Whether this leaves noise, and less than any orbit."""
        if not self.decays or self.rest > NOISE * off_neighbours(self.times, self.values)[1]:
            return False
        orbit = scatter(self.times, self.values, self.frequency).min()
        return bool(self.times.size * ((orbit / self.rest) ** 2 - 1.0) > SEEN)

    def require_decay(self, rate: float) -> None:
        """NoAnswer if a free mode with this decay rate [1/s] hardly decays."""
        if self.decays and rate * (self.times[-1] - self.times[0]) < LASTS:
            size = in_unit(abs(self.free), self.record.unit, 3)
            tone = f"a line at {1.0 / self.free_period:.4g} Hz of {size}"
            raise NoAnswer(f"{tone} does not decay: hum, or a free mode that needs a longer record")

    def start(
        self, oscillator: ImpactOscillator, names: Sequence[str], free: Sequence[str]
    ) -> tuple[Readings, ImpactOscillator, tuple[str, ...]]:
        """The start of a fit with the stop far away, and the names that can be fitted."""
        kept, lost = ([n for n in names if (n in NAMES) == own] for own in (True, False))
        alike = [name for name in kept if name in NAMES[:RESPONSE]]
        if not kept or (not self.decays and len(alike) > 1):
            blind = f"separate {' from '.join(alike)}" if kept else f"determine {', '.join(lost)}"
            motion = f"{'a' if self.decays else 'a steady'} motion without impacts at {self.frequency:.4g} Hz"
            height = f"of amplitude {in_unit(abs(self.steady), self.record.unit, 3)}"
            raise NoAnswer(f"{motion} {height}: it cannot {blind}; there is no impact in the record")
        order = self.record.order
        largest = float(np.abs(self.values).max()) / (2.0 * math.pi * self.frequency) ** order
        found = {"frequency": self.frequency, "gap": AWAY * largest}
        own = {"free_period": self.free_period, "decay_rate": self.decay_rate} if self.decays else {}
        at = with_values(oscillator, found | {name: own[name] for name in own if name in kept})
        base = self.steady / response(at, self.record)
        if "amplitude" in kept:
            at = with_values(at, {"amplitude": abs(base)})
        free_of = complex(poles(at)[at.model.leading_mode]) ** order
        state = state_of(at, base, self.free / free_of * self.decays)
        turn = 1j * np.exp(-2j * math.pi * self.frequency * self.times[0])  # a sine from time zero on
        read = {"offset": float(self.offset), "phase": float(np.angle(turn * base))}
        sensor = {name: read.get(name, one) if name in free else one for name, one in SENSOR.items()}
        note = f"no impact in the record: not fitted: {', '.join(lost) or 'nothing else'}"
        record = replace(self.record, notes=(*self.record.notes, note))
        return Readings(record, at, state, sensor, free), at, tuple(kept)


def state_of(oscillator: ImpactOscillator, base: complex, free: complex) -> Array:
    """Modal displacements and velocities where the base is at Re(`base`), moved at the drive frequency, and
    mode 1 moves the tip by Re(`free`) besides."""
    model, w = oscillator.model, oscillator.driven.angular_frequency
    share = oscillator.steady_response() * base
    own = np.eye(model.n_modes)[model.leading_mode] / model.phi * free
    return np.append((share + own).real, (1j * w * share + poles(oscillator) * own).real)
