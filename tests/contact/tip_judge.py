"""The tip of a free flight in extended precision (64-bit mantissa), and random flights for it to judge.

With real exponentials and phases in place of the recurrences of the package: the flight is sampled at 40
points per period of its fastest mode, every maximum is polished, the first one above the stop counts.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from oscillators import modes_on_stop

from contact import ImpactOscillator
from contact.flight.crossing import CROSSES, FREE, GRAZE_TOLERANCE, GRAZES, first_crossing
from contact.flight.elementary import EPS
from contact.flight.numbers import LOAD, Numbers
from contact.flight.tip import tip_rounding

Real = np.longdouble
SHORT = np.finfo(Real).eps > 2e-19
LONG_DOUBLE = pytest.mark.skipif(SHORT, reason="the judge needs a long double of at least 64 bits")
PLANTED = [sign * 10.0**-k for k in range(1, 13) for sign in (1.0, -1.0)]


class Signal:
    """Tip displacement x(s) = y(s) + gap of a free flight, and its derivatives, in double or long double."""

    def __init__(self, numbers: Numbers, base: float, u: np.ndarray, v: np.ndarray) -> None:
        self.numbers, self.base = numbers, base
        terms: list[tuple[complex, complex]] = []  # rates and coefficients of exp(rate s)
        polynomial = np.zeros(3, dtype=Real)
        for k in range(numbers.size):
            o, c = Real(numbers.omega[k]), Real(numbers.decay[k])
            a, b, phi = Real(u[k]), Real(v[k]), Real(numbers.phi[k])
            square = (o - c / 2) * (o + c / 2)
            if o == 0 and c == 0:
                polynomial += phi * np.array([a, b, Real(numbers.row(LOAD)[k]) / 2])
            elif square > 0:
                d = np.sqrt(square)
                terms.append((np.clongdouble(-c / 2 + 1j * d), phi * (a - 1j * (b + c / 2 * a) / d)))
            else:
                d = np.sqrt(-square)
                fast, slow = -c / 2 - d, -o * o / (c / 2 + d)
                if o == 0:  # constant load against a drag: terminal velocity g/c
                    g = Real(numbers.row(LOAD)[k])
                    polynomial += phi * np.array([a + (b - g / c) / c, g / c, Real(0)])
                    terms.append((np.clongdouble(-c), np.clongdouble(-phi * (b - g / c) / c)))
                else:
                    terms.append((np.clongdouble(slow), np.clongdouble(phi * (b - fast * a) / (slow - fast))))
                    terms.append((np.clongdouble(fast), np.clongdouble(phi * (slow * a - b) / (slow - fast))))
        if numbers.drive > 0:
            w = Real(numbers.drive)
            turn = np.cos(w * Real(base)) + 1j * np.sin(w * Real(base))
            amplitude = (Real(numbers.tip_cosine) - 1j * Real(numbers.tip_sine)) * turn
            terms.append((np.clongdouble(1j * w), np.clongdouble(amplitude)))
        self.rates = np.array([r for r, _ in terms], dtype=np.clongdouble)
        self.terms = np.array([t for _, t in terms], dtype=np.clongdouble)
        self.polynomial = polynomial
        self.shift = Real(numbers.level) + Real(numbers.gap)

    def __call__(self, s: np.ndarray, order: int = 0) -> np.ndarray:
        """x or a derivative of it at `s`, in the precision of `s`."""
        s = np.asarray(s)
        rates, terms = self.rates, self.terms
        polynomial, shift = self.polynomial, self.shift
        if s.dtype != Real:
            rates, terms = rates.astype(complex), terms.astype(complex)
            polynomial, shift = polynomial.astype(float), float(shift)
        value = (np.exp(s[..., None] * rates) @ (terms * rates**order)).real
        a, b, c = polynomial
        return value + (shift + a + s * (b + s * c), b + 2 * c * s, 2 * c)[order]

    def samples(self, end: float) -> np.ndarray:
        fastest = float(np.max(np.abs(self.rates.imag), initial=1.0))
        return np.linspace(0.0, end, 3 + int(40 * end * fastest / (2 * np.pi)))

    def peaks(self, end: float, *, above: float = -np.inf, samples: np.ndarray | None = None) -> np.ndarray:
        """Places of the maxima in (0, end) with samples higher than `above`, long double."""
        s = self.samples(end) if samples is None else samples
        x = self(s)
        top = np.flatnonzero((x[1:-1] >= x[:-2]) & (x[1:-1] > x[2:]) & (x[1:-1] > above)) + 1
        low, high = s[top - 1].astype(Real), s[top + 1].astype(Real)
        place = s[top].astype(Real)
        for _ in range(16):
            slope, bend = self(place, 1), self(place, 2)
            low, high = np.where(slope > 0, place, low), np.where(slope > 0, high, place)
            new = place - slope / np.where(bend < 0, bend, -1)
            new = np.where((bend < 0) & (new >= low) & (new <= high), new, (low + high) / 2)
            place, step = new, np.abs(new - place)
            if np.all(step <= 1e-10 * Real(end)):  # its height is then settled to 1e-20 of the curvature
                break
        return place

    def root(self, low: Real, high: Real, gap: Real) -> Real:
        """Where x rises through `gap` in [low, high]."""
        s = (low + high) / 2
        for _ in range(90):
            y, slope = self(s) - gap, self(s, 1)
            low, high = (s, high) if y < 0 else (low, s)
            new = s - y / slope if slope > 0 else low
            new = new if low < new < high else (low + high) / 2
            if new == s:
                break
            s = new
        return s


@dataclass
class Verdict:
    """First touch in (start, end], NaN if there is none, its slope, and height - gap of the decisive peak."""

    time: Real
    peak: Real
    slope: Real


def judge(
    signal: Signal, gap: float, end: float, *, start: float = 0.0, peaks: np.ndarray | None = None
) -> Verdict:
    """The first s in (start, end] where x rises above `gap`; x lies below it just after `start`."""
    places = signal.peaks(end) if peaks is None else peaks
    places = np.concatenate([places[places > start], [Real(end)]])
    heights = signal(places) - Real(gap)
    above = np.flatnonzero(heights > 0)
    if above.size == 0:
        return Verdict(Real("nan"), heights.max(), Real("nan"))
    first, s = above[0], signal.samples(end).astype(Real)
    s = s[(s > start) & (s < places[first])]
    below = s[signal(s.astype(float)) < gap]
    low = below[-1] if below.size else Real(start)
    # the last sample below the stop before the first peak above it
    time = signal.root(low, places[first], Real(gap))
    return Verdict(time, heights[first], signal(time, 1))


def highest(signal: Signal, gap: float, start: float, end: float) -> Real:
    """Greatest tip displacement minus gap in [start, end]."""
    places = signal.peaks(end)
    places = np.append(places[places >= start], np.array([start, end], dtype=Real))
    return (signal(places) - Real(gap)).max()


def search(numbers: Numbers, base: float, u: np.ndarray, v: np.ndarray, duration: float, order: int = 0):
    return first_crossing(numbers, base, u, v, duration, order)


def random_oscillator(
    generator: np.random.Generator, n_modes: int, *, driven: bool = True
) -> ImpactOscillator:
    """Modes from 20 Hz up to 50 times that, decays from none to over-damped, tip values of either sign."""
    omega = 2 * np.pi * 20.0 * np.sort(generator.uniform(1, 1 + 2.5 * n_modes, n_modes))
    decay = omega * np.where(
        generator.random(n_modes) < 0.15,
        generator.uniform(0.5, 3.0, n_modes),
        10 ** generator.uniform(-4, -1, n_modes),
    )
    decay[generator.random(n_modes) < 0.1] = 0.0
    drive = (float(generator.uniform(14, 19)), 2e-3) if driven else None
    phi, participation = generator.normal(size=n_modes) * 5 + 2, generator.normal(size=n_modes) * 0.1
    return modes_on_stop(omega, decay, phi, participation, drive=drive)


def random_deviation(generator: np.random.Generator, numbers: Numbers, *, ringing: float) -> tuple:
    """Deviations of random phase; tip amplitudes fall with the mode number, more slowly when ringing."""
    n = numbers.size
    amplitude = 0.01 * generator.uniform(0.1, 1, n) / (1 + np.arange(n)) ** (1.0 if ringing else 2.0)
    phase = generator.uniform(0, 2 * np.pi, n)
    u = amplitude * np.cos(phase) / np.abs(numbers.phi)
    v = amplitude * np.sin(phase) * numbers.omega / np.abs(numbers.phi)
    return u, v


def with_gap(numbers: Numbers, gap: float) -> Numbers:
    """The same oscillator with the stop elsewhere (no constant load, so that level = -gap)."""
    return numbers._replace(gap=gap, level=-gap)


@dataclass
class Flight:
    """A random flight with its peaks, and those that the tip reaches first and well above its start."""

    numbers: Numbers
    base: float
    u: np.ndarray
    v: np.ndarray
    signal: Signal
    places: np.ndarray
    heights: np.ndarray
    start: float
    chosen: list[int]

    def against(self, gap: float, end: float) -> tuple[Numbers, tuple]:
        """The same oscillator with its stop elsewhere, and what the search finds up to `end`."""
        stopped = with_gap(self.numbers, gap)
        return stopped, first_crossing(stopped, self.base, self.u, self.v, end, 0)

    def agrees(self, gap: float, end: float) -> str:
        """The search against the judge, with the stop at `gap`."""
        stopped, result = self.against(gap, end)
        verdict = judge(self.signal, gap, end, peaks=self.places[self.places < end])
        return assert_agrees(result, verdict, stopped, self.u, self.v, self.base)


def flights(seed: list[int], n_modes: int, count: int, kind: str = "ringing", late: float = 0.0):
    """Random flights, at rest, ringing or without a drive; half of them from up to `late` periods on."""
    generator = np.random.default_rng(seed)
    for _ in range(count):
        numbers = random_oscillator(generator, n_modes, driven=kind != "drive off").numbers()
        u, v = random_deviation(generator, numbers, ringing=kind == "ringing")
        base = float(generator.uniform(0, late) * numbers.period * generator.integers(0, 2))
        signal = Signal(numbers, base, u, v)
        places = signal.peaks(numbers.period - base)
        heights = signal(places)
        start = max(float(signal(Real(0))), 0.0)
        # the peaks that are higher than all before them
        before = np.concatenate([[-np.inf], np.maximum.accumulate(heights.astype(float))[:-1]])
        chosen = [i for i in np.flatnonzero(heights > before) if heights[i] > 1.2 * start + 1e-4]
        yield Flight(numbers, base, u, v, signal, places, heights, start, chosen)


def assert_agrees(
    result: tuple, verdict: Verdict, numbers: Numbers, u: np.ndarray, v: np.ndarray, base: float
) -> str:
    """Compare an outcome with the judge's; only a peak within twice the rounding bound may be a graze."""
    outcome, s = result
    bound = tip_rounding(numbers, u, v)
    if abs(verdict.peak) <= 2.0 * bound:
        assert outcome in (CROSSES, FREE, GRAZES) or bound > GRAZE_TOLERANCE * numbers.gap
        return "within rounding"
    if verdict.peak < 0:
        assert outcome == FREE, (
            f"invented a touch {float(verdict.peak / numbers.gap):.2e} of the gap below it"
        )
        return "free"
    assert outcome == CROSSES, f"missed an overshoot of {float(verdict.peak / numbers.gap):.2e} of the gap"
    allowed = bound / verdict.slope + 4 * EPS * (base + verdict.time)
    assert abs(s - verdict.time) <= allowed, (
        f"time off by {float(abs(s - verdict.time)):.2e}, allowed {allowed:.2e}"
    )
    return "crosses"
