"""A settled motion with impacts as one that is kicked: where its impacts are, and what follows from them.

Modes n with frequencies omega_n, decay rates c_n and tip values phi_n, driven at f and kicked J times in an
orbit of m drive periods P = m/f, move the tip by

    x(t) = sum_k Y_k exp(i k w t),   w = 2 pi/P,
    Y_k  = sum_j I_j exp(-i k w t_j) G(k w)   for all k but 0 and m,
    G(v) = (1/P) sum_n phi_n^2/(omega_n^2 - v^2 + i c_n v),

I_j the impulse of the kick at time t_j.  Y_0 has the offset of the sensor besides, Y_m the drive.  A velocity
has i k w Y_k.  An acceleration off the stop has the same sum with -(omega_n^2 + i c_n v) phi_n^2 in place of
phi_n^2.  The Y_k follow from the rows by linear least squares.  The kicks are found one after the other, each
where it explains most of what is left of the Y_k (matching pursuit: Mallat and Zhang, IEEE Trans. Signal
Process. 41 (1993) 3397).  All are then fitted together with the free period and the decay rate.  No row is
differentiated: noise is averaged over the whole record.  A contact that lasts a while counts as a kick in its
middle.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from contact import ImpactOscillator
from studies.measurement.identify.record.channel import response
from studies.measurement.identify.record.records import Array, Record
from studies.measurement.identify.record.spectrum import Complex, count_of, drives, harmonics
from studies.physics.parameters import parameters_of, with_values

MOST_KICKS = 6  # of an orbit
FREE_PERIODS, DECAY_RATES = np.geomspace(0.6, 1.4, 16), np.array([0.03, 0.1, 0.3, 0.7])
"""Where a search begins, in drive periods and per drive period."""
STARTS = 5  # first kicks that are followed
WORTH, LITTLE = 12.0, 0.7  # what a further kick takes off chi^2; the part that it may leave if one follows
APART = 0.04  # drive periods between two kicks
VALLEY, LIKE = 50.0, 4  # chi^2 of other free periods above the best; how many are kept


@dataclass(frozen=True, eq=False)
class Kicked:
    """A kicked motion: the `oscillator` with its free period, decay rate and drive frequency as fitted.

    It repeats after `period` drive periods.  The `kicks` are at these times [s] and have these `impulses`
    [N s].  The base is at the real part of `base` exp(2 pi i f t) [m]; `offset` is that of the sensor.
    `cost` is chi^2 of the harmonics and a charge for each kick, `without` that without kicks.
    """

    oscillator: ImpactOscillator
    m: int
    kicks: Array
    impulses: Array
    base: complex
    offset: float
    cost: float
    without: float

    def state(self, time: float, before: bool = False) -> tuple[Array, Array]:
        """Modal displacements and velocities at a time, by the drive and by the kicks; shape (2, modes) each.

        `before` is the side of a kick that a time at it means.
        """
        one, w = self.oscillator, self.oscillator.driven.angular_frequency
        share = one.steady_response() * self.base * np.exp(1j * w * time)
        lasting = self.m * one.period
        ages = (time - self.kicks) % lasting
        ages = np.where(before & (ages < 1e-9 * lasting), lasting, ages)
        pole = poles(one)
        free = np.exp(np.multiply.outer(ages, pole)) / (1.0 - np.exp(pole * lasting)) * one.model.phi
        kicked = [(self.impulses @ (rate * free / pole.imag)).imag for rate in (1.0, pole)]
        return np.array([share.real, (1j * w * share).real]), np.array(kicked)

    def tip(self, time: float, before: bool = False) -> tuple[float, float]:
        """Displacement from equilibrium and velocity of the tip."""
        x, v = sum(self.state(time, before)) @ self.oscillator.model.phi
        return float(x), float(v)

    def reading(self) -> dict[str, float]:
        """What the strongest kick says: `sign` of the sensor, `gap` and `restitution`."""
        strongest = int(np.argmax(np.abs(self.impulses)))
        sign, at = -float(np.sign(self.impulses[strongest])), float(self.kicks[strongest])
        (x, v_in), (_, v_out) = self.tip(at, True), self.tip(at)
        back = -v_out / v_in if v_in * sign > 0.0 else 0.0
        return {"sign": sign, "gap": sign * x, "restitution": back}

    @property
    def possible(self) -> bool:
        """Whether a stop can do this: the strongest kick at a peak above equilibrium, and not from behind."""
        read = self.reading()
        return read["gap"] > 0.0 and 0.0 < read["restitution"] < 1.0 and self.base != 0.0


def poles(oscillator: ImpactOscillator) -> Complex:
    """-c_n/2 + i (omega_n^2 - c_n^2/4)^(1/2) of each mode; overdamped ones count as hardly oscillating."""
    half = 0.5 * oscillator.model.decay_rate
    turn = np.sqrt(np.maximum(oscillator.model.omega**2 - half**2, 1e-6 * oscillator.model.omega**2))
    return np.asarray(-half + 1j * turn)


class Search:
    """The kicks of a record of `oscillator` at its drive frequency, given that it repeats after `period`."""

    def __init__(self, record: Record, oscillator: ImpactOscillator, m: int, pulses: bool = False) -> None:
        (times, values), self.record = record.rows.T, record
        known, self.leading = parameters_of(oscillator), oscillator.model.leading_mode
        self.given = known["free_period"].value, max(known["decay_rate"].value, 1e-3 / oscillator.period)
        self.oscillator, self.m = with_values(oscillator, {"decay_rate": self.given[1]}), m
        self.pulses = pulses
        self.base = oscillator.driven.frequency / m
        count = count_of(times, self.base)
        self.seen, noise = harmonics(times, values, self.base, count)
        self.error = max(noise, 1e-9 * float(np.ptp(values))) / math.sqrt(2.0 * times.size)
        order = np.arange(count + 1)
        self.used, self.w = (order > 0) & (order != m), 2.0 * math.pi * self.base * order

    def response(self, logs: Sequence[float]) -> Complex:
        """G at the harmonics, of the oscillator with exp(logs) as its free period and decay rate."""
        model, w, (period, rate) = self.oscillator.model, self.w[:, None], np.exp(logs).tolist()
        omega = model.omega * (math.hypot(2.0 * math.pi / period, 0.5 * rate) / model.omega[self.leading])
        rates = model.decay_rate * (rate / model.decay_rate[self.leading])
        own = 1.0, 1j * w, -(w**2) + 0j * omega if self.pulses else -(omega**2) - 1j * rates * w
        shares = own[self.record.order] * model.phi**2 / (omega**2 - w**2 + 1j * rates * w)
        return np.asarray(shares.sum(axis=1) * self.base)

    def waves(self, response: Complex, kicks: Array) -> Complex:
        """The harmonics of unit kicks, shape (harmonics, kicks)."""
        return np.asarray(response[:, None] * np.exp(-1j * np.outer(self.w, kicks)))

    def impulses(self, waves: Complex) -> Array:
        """The impulses that explain most."""
        a, b = (np.concatenate([one.real, one.imag]) for one in (waves[self.used], self.seen[self.used]))
        return np.asarray(np.linalg.lstsq(a, b, rcond=None)[0])

    def left(self, response: Complex, kicks: Array) -> Complex:
        """What kicks leave of the harmonics."""
        waves = self.waves(response, kicks)
        return self.seen - waves @ self.impulses(waves) if kicks.size else self.seen

    def gains(self, response: Complex, kicks: Array) -> tuple[Array, Array]:
        """Times of a further kick, and the projection of what is left on one there."""
        size = 1 << math.ceil(math.log2(6 * self.w.size))
        product = np.zeros(size, complex)
        product[: self.w.size] = np.conj(response) * self.left(response, kicks) * self.used
        length = math.sqrt(float(np.sum(np.abs(response[self.used]) ** 2)))
        return np.arange(size) / (size * self.base), np.fft.ifft(product).real * size / length

    def first(self) -> list[tuple[tuple[float, float], Array]]:
        """Logarithms of free period and decay rate, and a first kick: the best of a grid that differ."""
        beat, found = self.oscillator.period, list[tuple[float, float, float, float]]()
        for period, rate in [self.given, *((a * beat, c / beat) for a in FREE_PERIODS for c in DECAY_RATES)]:
            logs = math.log(period), math.log(rate)
            times, gains = self.gains(self.response(logs), np.empty(0))
            best = int(np.argmax(np.abs(gains)))
            found.append((abs(float(gains[best])), *logs, float(times[best])))
        kept = list[tuple[float, float, float, float]]()
        for one in sorted(found, reverse=True):
            turned = [abs(math.sin(math.pi * (one[3] - other[3]) * self.base)) for other in kept]
            if all(abs(one[1] - o[1]) > 0.06 or t > 0.05 for o, t in zip(kept, turned, strict=True)):
                kept.append(one)
        return [((log_t, log_c), np.array([at])) for _, log_t, log_c, at in kept[:STARTS]]

    def refined(
        self, logs: Sequence[float], kicks: Array, held: bool = False
    ) -> tuple[Sequence[float], Array, float]:
        """Both logarithms and the times of kicks by least squares, and chi^2; the first may be held."""

        def off(unknowns: Array) -> Array:
            rest = self.left(self.response(unknowns[:2].tolist()), unknowns[2:])
            return np.concatenate([rest[self.used].real, rest[self.used].imag]) / self.error

        beat = self.oscillator.period
        middle = np.log([beat, 0.1 / beat])
        low, high = middle + np.log([0.3, 1e-3]), middle + np.log([3.0, 60.0])
        if held:
            low[0], high[0] = logs[0] - 2e-6, logs[0] + 2e-6
        bounds = [np.append(end, np.full(kicks.size, way)) for end, way in ((low, -np.inf), (high, np.inf))]
        begun = np.append(np.clip(logs, low + 1e-6, high - 1e-6), kicks)
        scale = np.append([0.05, 0.5], np.full(kicks.size, 0.02 * beat))
        found = least_squares(off, begun, bounds=bounds, x_scale=scale, max_nfev=40)
        return found.x[:2].tolist(), found.x[2:], 2.0 * float(found.cost)

    def along(self, logs: Sequence[float], kicks: Array) -> tuple[float, Sequence[float], Array]:
        """The best number of kicks from a first one on: cost with its charges, logarithms, times."""
        best, spare = (math.inf, logs, kicks), 2 * int(self.used.sum())
        while kicks.size <= MOST_KICKS:
            logs, kicks, cost = self.refined(logs, kicks)
            charged = cost + WORTH * kicks.size
            if charged >= best[0]:
                break
            little, best = charged > LITTLE * best[0], (charged, logs, kicks)
            if little or cost < 1.2 * spare or spare < 2 * kicks.size + 6:
                break
            response = self.response(logs)
            times, gains = self.gains(response, kicks)
            apart = np.abs(np.sin(math.pi * self.base * (times[:, None] - kicks))).min(axis=1)
            way = math.copysign(1.0, self.impulses(self.waves(response, kicks))[0])
            gains = np.where(apart > math.sin(math.pi * APART / self.m), way * gains, -math.inf)
            kicks = np.append(kicks, times[int(np.argmax(gains))])
        return best

    def found(self) -> list[Kicked]:
        """The kicked motions that are most like the record, the best first, each with another free period.

        With one impact a drive period all free periods near it give nearly the same motion.
        """
        best = min((self.along(*one) for one in self.first()), key=lambda one: one[0])
        ends, beat = [best], self.oscillator.period
        if best[2].size == 1:
            for period in FREE_PERIODS * beat:
                logs, kicks, cost = self.refined((math.log(period), best[1][1]), best[2], held=True)
                ends.append((cost + WORTH, logs, kicks))
        motions = [self.motion(*end) for end in ends]
        able = min((one.cost for one in motions if one.possible), default=math.inf)
        others = [one for one in motions[1:] if one.possible and one.cost < able + VALLEY]
        return [motions[0], *sorted(others, key=lambda one: one.cost)[:LIKE]]

    def motion(self, cost: float, logs: Sequence[float], kicks: Array) -> Kicked:
        """The kicked motion of a search."""
        waves, (period, rate) = self.waves(self.response(logs), kicks), np.exp(logs).tolist()
        impulses = self.impulses(waves)
        rest = self.seen - waves @ impulses
        without = float(np.sum(np.abs(self.seen[self.used]) ** 2)) / self.error**2
        at = with_values(self.oscillator, {"free_period": period, "decay_rate": rate})
        base, offset = complex(2.0 * rest[self.m] / response(at, self.record)), float(rest[0].real)
        kicks = kicks % (1.0 / self.base)
        return Kicked(at, self.m, kicks, impulses, base, offset, cost, without)


def kicked_motions(record: Record, oscillator: ImpactOscillator) -> list[Kicked]:
    """Kicked motions that a record may be, the best first, from its drive frequency where that is known.

    The modes of `oscillator` beyond the first keep their ratios to it.  Without a frequency each harmonic of
    the orbit is tried as that of the drive.
    """
    found = list[Kicked]()
    for frequency, period in drives(record):
        at = with_values(oscillator, {"frequency": frequency})
        for pulses in (False, True) if record.order == 2 else (False,):
            found += Search(record, at, period, pulses).found()
    return sorted(found, key=lambda one: one.cost)
