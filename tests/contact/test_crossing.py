"""The search for the first touch: planted over- and undershoots, none missed and none invented.

The judge works in extended precision (64-bit mantissa), with real exponentials and phases in place of the
recurrences of the package: it samples the flight at 40 points per period of its fastest mode, polishes every
maximum of the samples, and takes the first one above the stop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from beam import ModalModel
from contact.drive import HarmonicDrive
from contact.flight.crossing import CROSSES, FREE, GRAZE_TOLERANCE, GRAZES, UNRESOLVED, first_crossing
from contact.flight.elementary import EPS
from contact.flight.modal_flow import propagate, tip_rounding, tip_state
from contact.flight.motion import Motion
from contact.flight.polynomial_root import first_polynomial_root
from contact.laws import NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.touch.newton import newton_impact

Real = np.longdouble
pytestmark = pytest.mark.skipif(
    np.finfo(Real).eps > 2e-19, reason="the judge needs a long double of at least 64 bits"
)

DECADES = [10.0**-k for k in range(1, 13)]
PLANTED = [sign * h for h in DECADES for sign in (1.0, -1.0)]


# -------------------------------------------------------------------------------------------------- the judge


class Signal:
    """Tip displacement x(s) = y(s) + gap of a free flight, and its derivatives, in double or long double."""

    def __init__(self, motion: Motion, base: float, u: np.ndarray, v: np.ndarray) -> None:
        self.motion, self.base = motion, base
        terms: list[tuple[complex, complex]] = []  # rates and coefficients of exp(rate s)
        polynomial = np.zeros(3, dtype=Real)
        for k in range(motion.size):
            o, c = Real(motion.omega[k]), Real(motion.decay[k])
            a, b, phi = Real(u[k]), Real(v[k]), Real(motion.phi[k])
            square = (o - c / 2) * (o + c / 2)
            if o == 0 and c == 0:
                polynomial += phi * np.array([a, b, Real(motion.load[k]) / 2])
            elif square > 0:
                d = np.sqrt(square)
                terms.append((np.clongdouble(-c / 2 + 1j * d), phi * (a - 1j * (b + c / 2 * a) / d)))
            else:
                d = np.sqrt(-square)
                fast, slow = -c / 2 - d, -o * o / (c / 2 + d)
                if o == 0:  # constant load against a drag: terminal velocity g/c
                    g = Real(motion.load[k])
                    polynomial += phi * np.array([a + (b - g / c) / c, g / c, Real(0)])
                    terms.append((np.clongdouble(-c), np.clongdouble(-phi * (b - g / c) / c)))
                else:
                    terms.append((np.clongdouble(slow), np.clongdouble(phi * (b - fast * a) / (slow - fast))))
                    terms.append((np.clongdouble(fast), np.clongdouble(phi * (slow * a - b) / (slow - fast))))
        if motion.drive > 0:
            w = Real(motion.drive)
            turn = np.cos(w * Real(base)) + 1j * np.sin(w * Real(base))
            amplitude = (Real(motion.tip_cosine) - 1j * Real(motion.tip_sine)) * turn
            terms.append((np.clongdouble(1j * w), np.clongdouble(amplitude)))
        self.rates = np.array([r for r, _ in terms], dtype=np.clongdouble)
        self.terms = np.array([t for _, t in terms], dtype=np.clongdouble)
        self.polynomial = polynomial
        self.shift = Real(motion.level) + Real(motion.gap)

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
    first = above[0]
    s = signal.samples(end).astype(Real)
    s = s[(s > start) & (s < places[first])]
    below = s[signal(s.astype(float)) < gap]
    low = below[-1] if below.size else Real(start)
    # the last sample below the stop before the first peak above it
    time = signal.root(low, places[first], Real(gap))
    return Verdict(time, heights[first], signal(time, 1))


def search(motion: Motion, base: float, u: np.ndarray, v: np.ndarray, duration: float, order: int = 0):
    return first_crossing(motion, base, u, v, duration, order)


# --------------------------------------------------------------------------------------------- random flights


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
    drive = HarmonicDrive(frequency=float(generator.uniform(14, 19)), amplitude=2e-3) if driven else None
    model = ModalModel(
        omega=omega, decay_rate=decay, phi=generator.normal(size=n_modes) * 5 + 2,
        participation=generator.normal(size=n_modes) * 0.1,
    )  # fmt: skip
    stop = Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.5))
    return ImpactOscillator(model=model, stop=stop, drive=drive)


def random_deviation(generator: np.random.Generator, motion: Motion, *, ringing: float) -> tuple:
    """Deviations of random phase; tip amplitudes fall with the mode number, more slowly when ringing."""
    n = motion.size
    amplitude = 0.01 * generator.uniform(0.1, 1, n) / (1 + np.arange(n)) ** (1.0 if ringing else 2.0)
    phase = generator.uniform(0, 2 * np.pi, n)
    u = amplitude * np.cos(phase) / np.abs(motion.phi)
    v = amplitude * np.sin(phase) * motion.omega / np.abs(motion.phi)
    return u, v


def with_gap(motion: Motion, gap: float) -> Motion:
    """The same oscillator with the stop elsewhere (no constant load, so that level = -gap)."""
    return motion._replace(gap=gap, level=-gap)


def records(heights: np.ndarray) -> np.ndarray:
    """Indices of the peaks that are higher than all before them."""
    before = np.concatenate([[-np.inf], np.maximum.accumulate(heights.astype(float))[:-1]])
    return np.flatnonzero(heights > before)


def assert_agrees(
    result: tuple, verdict: Verdict, motion: Motion, u: np.ndarray, v: np.ndarray, base: float
) -> str:
    """Compare an outcome with the judge's; only a peak within twice the rounding bound may be a graze."""
    outcome, s = result
    bound = tip_rounding(motion, u, v)
    if abs(verdict.peak) <= 2.0 * bound:
        assert outcome in (CROSSES, FREE, GRAZES) or bound > GRAZE_TOLERANCE * motion.gap
        return "within rounding"
    if verdict.peak < 0:
        assert outcome == FREE, f"invented a touch {float(verdict.peak / motion.gap):.2e} of the gap below it"
        return "free"
    assert outcome == CROSSES, f"missed an overshoot of {float(verdict.peak / motion.gap):.2e} of the gap"
    allowed = bound / verdict.slope + 4 * EPS * (base + verdict.time)
    assert abs(s - verdict.time) <= allowed, (
        f"time off by {float(abs(s - verdict.time)):.2e}, allowed {allowed:.2e}"
    )
    return "crosses"


# -------------------------------------------------------------------------------------------- planted heights


@pytest.mark.parametrize("n_modes", [1, 2, 3, 5, 10, 20])
@pytest.mark.parametrize("kind", ["at rest", "ringing", "drive off"])
def test_planted_overshoots_are_found_and_undershoots_are_not(n_modes, kind):
    """Peaks h = 1e-1 ... 1e-12 of the gap above and below the stop, over flights of up to one period."""
    generator = np.random.default_rng([n_modes, len(kind)])
    told = {"free": 0, "crosses": 0, "within rounding": 0}
    for _ in range(10 if n_modes < 10 else 4):
        motion = random_oscillator(generator, n_modes, driven=kind != "drive off").motion()
        u, v = random_deviation(generator, motion, ringing=kind == "ringing")
        base = float(generator.uniform(0, 0.9) * motion.period * generator.integers(0, 2))
        duration = motion.period - base
        signal = Signal(motion, base, u, v)
        places = signal.peaks(duration)
        heights = signal(places)
        start = max(float(signal(Real(0))), 0.0)
        candidates = [i for i in records(heights) if heights[i] > 1.2 * start + 1e-4]
        for i in candidates[:3]:
            for h in PLANTED:
                gap = float(heights[i] / (1 + Real(h)))
                if gap <= start:
                    continue
                stopped = with_gap(motion, gap)
                verdict = judge(signal, gap, duration, peaks=places)
                result = search(stopped, base, u, v, duration)
                told[assert_agrees(result, verdict, stopped, u, v, base)] += 1
    assert told["within rounding"] == 0
    assert min(told["free"], told["crosses"]) > 20


@pytest.mark.parametrize("n_modes", [1, 2, 5, 20])
def test_a_peak_on_the_stop_is_a_graze_and_near_it_nothing_is_invented(n_modes):
    """gap = the peak rounded to double is a graze; below the rounding bound CROSSES and FREE stay right."""
    generator = np.random.default_rng([7, n_modes])
    grazes = 0
    for _ in range(40):
        motion = random_oscillator(generator, n_modes).motion()
        u, v = random_deviation(generator, motion, ringing=True)
        signal = Signal(motion, 0.0, u, v)
        places = signal.peaks(motion.period)
        heights = signal(places)
        start = max(float(signal(Real(0))), 0.0)
        chosen = [i for i in records(heights) if heights[i] > 1.2 * start + 1e-4]
        for i in chosen[-1:]:
            end = float(places[i] + (motion.period - places[i]) * 1e-3)
            for h in (0.0, 1e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13):
                for sign in (1, -1):
                    gap = float(heights[i] / (1 + sign * Real(h)))
                    stopped = with_gap(motion, gap)
                    peak = heights[i] - Real(gap)
                    bound = tip_rounding(stopped, u, v)
                    assert bound < GRAZE_TOLERANCE * gap
                    outcome, s = search(stopped, 0.0, u, v, end)
                    if outcome == GRAZES:
                        grazes += 1
                        assert abs(peak) <= 2 * bound
                        # a place where the height is within rounding of the peak's
                        assert abs(signal(Real(s)) - heights[i]) <= bound
                    elif outcome == CROSSES:
                        assert peak > 0
                        judged = judge(signal, gap, end, peaks=places[: i + 1])
                        assert abs(s - judged.time) <= bound / judged.slope + 4 * EPS * motion.period
                    else:
                        assert outcome == FREE
                        assert peak < 0
                    if h == 0.0:
                        assert outcome == GRAZES
    assert grazes > 100


def test_a_graze_too_blurred_to_be_called_one_is_unresolved():
    """Two modes that cancel to 1e-3 of their size: the rounding bound exceeds 1e-13 of the gap."""
    model = ModalModel(
        omega=[100.0, 100.001], decay_rate=[0.0, 0.0], phi=[1.0, -1.0], participation=[0.0, 0.0]
    )
    stop = Stop(gap=1e-5, law=NewtonRestitution(local_restitution=0.5))
    motion = ImpactOscillator(model=model, stop=stop).motion()
    u, v = np.array([-0.01, -0.01]), np.array([0.2, 0.2 - 1e-3])
    signal = Signal(motion, 0.0, u, v)
    places = signal.peaks(motion.period)
    height = signal(places).max()
    blurred = with_gap(motion, float(height))
    assert tip_rounding(blurred, u, v) > GRAZE_TOLERANCE * blurred.gap
    outcome, s = search(blurred, 0.0, u, v, motion.period)
    assert outcome == UNRESOLVED
    assert abs(s - places[np.argmax(signal(places))]) < 1e-6
    # clear of the blur on either side it is decided
    assert search(with_gap(motion, float(height) * (1 - 1e-10)), 0.0, u, v, motion.period)[0] == CROSSES
    assert search(with_gap(motion, float(height) * (1 + 1e-10)), 0.0, u, v, motion.period)[0] == FREE


@pytest.mark.parametrize("n_modes", [1, 3, 10])
def test_flight_that_ends_near_the_peak(n_modes):
    """The flight ends 1e-3 ... 1e-12 of a period before or after a peak near the stop."""
    generator = np.random.default_rng([8, n_modes])
    told = {"free": 0, "crosses": 0, "within rounding": 0}
    for _ in range(12):
        motion = random_oscillator(generator, n_modes).motion()
        u, v = random_deviation(generator, motion, ringing=True)
        signal = Signal(motion, 0.0, u, v)
        places = signal.peaks(motion.period)
        heights = signal(places)
        start = max(float(signal(Real(0))), 0.0)
        chosen = [i for i in records(heights) if heights[i] > 1.2 * start + 1e-4]
        for i in chosen[-1:]:
            for h in (1e-2, 1e-4, 1e-6, 1e-8, -1e-8, -1e-4):
                for part in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, -1e-12, -1e-9, -1e-7, -1e-5, -1e-3):
                    gap = float(heights[i] / (1 + Real(h)))
                    if gap <= start:
                        continue
                    end = float(places[i]) + part * motion.period
                    stopped = with_gap(motion, gap)
                    verdict = judge(signal, gap, end, peaks=places[places < end])
                    told[assert_agrees(search(stopped, 0.0, u, v, end), verdict, stopped, u, v, 0.0)] += 1
    assert min(told["free"], told["crosses"]) > 100


def test_flight_that_ends_at_the_touch_finds_it_in_the_next_one():
    """A crossing within rounding of the end belongs to exactly one of two consecutive flights."""
    generator = np.random.default_rng(9)
    for _ in range(40):
        motion = random_oscillator(generator, 3).motion()
        u, v = random_deviation(generator, motion, ringing=False)
        signal = Signal(motion, 0.0, u, v)
        start = max(float(signal(Real(0))), 0.0)
        height = float(signal(signal.peaks(motion.period)).max())
        if height < 1.2 * start + 1e-4:
            continue
        stopped = with_gap(motion, 0.5 * (height + start))
        outcome, root = search(stopped, 0.0, u, v, motion.period)
        assert outcome == CROSSES
        for before in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
            end = root - before * motion.period
            if end > 0:
                assert search(stopped, 0.0, u, v, end) == (FREE, end)
        for end in (root, math.nextafter(root, 0.0), math.nextafter(root, 1.0), root - 1e-16, root + 1e-16):
            first, s = search(stopped, 0.0, u, v, end)
            if first == CROSSES:
                assert abs(s - root) < 1e-15
                continue
            assert first == FREE
            un, vn = np.empty(3), np.empty(3)
            propagate(stopped, u, v, end, un, vn)
            second, s = search(stopped, end, un, vn, motion.period - end)
            assert second == CROSSES
            assert abs(end + s - root) < 1e-14


# ----------------------------------------------------------------------------- flights that start on the wall


def on_the_wall(generator: np.random.Generator, n_modes: int, order: int) -> tuple:
    """A driven oscillator and a state whose height has `order` derivatives zero, the next one negative.

    Returns motion, base, u, v and a direction (du, dv) along which all of this stays so.
    """
    motion = random_oscillator(generator, n_modes).motion()
    base = float(generator.uniform(0, 0.5) * motion.period)
    u, v = random_deviation(generator, motion, ringing=True)
    phi, o2, c = motion.phi, motion.omega**2, motion.decay
    scale = motion.omega.max() ** np.arange(4)
    # derivatives of the height are linear in (u, v): rows of shape (2 n,)
    rows = [np.concatenate([phi, 0 * phi]), np.concatenate([0 * phi, phi])]
    a, b = -o2, -c
    for _ in range(2):
        rows.append(np.concatenate([phi * a, phi * b]))
        a, b = -o2 * b, a - c * b
    rows = np.array(rows[: order + 1]) / scale[: order + 1, None]
    weight = np.concatenate([1 / np.abs(phi), motion.omega / np.abs(phi)])
    steady = np.array(tip_state(motion, base, 0 * u, 0 * v))
    third = -(motion.drive**2) * steady[1]
    wanted = np.zeros(order + 1)
    wanted[order] = -generator.uniform(0.02, 0.3) * 0.01
    wanted -= np.array([*steady, third])[: order + 1] / scale[: order + 1]
    state = np.concatenate([u, v])
    pinned = rows * weight
    for _ in range(3):  # refined, so that the vanishing derivatives vanish to rounding
        state = state + weight * np.linalg.lstsq(pinned, wanted - rows @ state, rcond=None)[0]
    direction = generator.normal(size=2 * n_modes)
    direction = weight * (direction - np.linalg.pinv(pinned) @ (pinned @ direction)) * 0.01
    return (
        motion,
        base,
        state[:n_modes].copy(),
        state[n_modes:].copy(),
        direction[:n_modes],
        direction[n_modes:],
    )


@pytest.mark.parametrize("n_modes", [3, 4, 6])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_flights_from_the_wall(order, n_modes):
    """After an impact (1), a plastic one or a graze (2), a release (3): the start is no touch.

    The motion is bent along a direction that leaves the start as it is until its highest later peak stands h
    above or below the stop.
    """
    generator = np.random.default_rng([10, order, n_modes])
    told = {"free": 0, "crosses": 0, "within rounding": 0}
    for _ in range(8):
        motion, base, u, v, du, dv = on_the_wall(generator, n_modes, order)
        duration = motion.period - base
        for h in PLANTED:
            lam, bent = 0.0, None
            for _ in range(8):
                signal = Signal(motion, base, u + lam * du, v + lam * dv)
                x = signal(signal.samples(duration))
                places = signal.peaks(duration, above=max(0.9 * x.max(), 0.8 * motion.gap))
                places = places[places > 1e-3 * motion.period]
                if places.size == 0:
                    break
                top = places[np.argmax(signal(places))]
                excess = float(signal(top) - Real(motion.gap) * (1 + Real(h)))
                if abs(excess) < max(1e-14, 0.05 * abs(h)) * motion.gap:
                    bent = lam
                    break
                slope = float(
                    Signal(motion, base, u + (lam + 1.0) * du, v + (lam + 1.0) * dv)(top) - signal(top)
                )
                if slope == 0.0:
                    break
                lam -= excess / slope
                if abs(lam) > 20:
                    break
            if bent is None:
                continue
            un, vn = u + bent * du, v + bent * dv
            result = search(motion, base, un, vn, duration, order)
            # the height at the start is zero within rounding: leave it out, as the search does
            early = Real(1e-4) * motion.period
            assert signal(early) < motion.gap
            verdict = judge(
                signal,
                motion.gap,
                duration,
                start=early,
                peaks=signal.peaks(duration, above=0.9 * motion.gap),
            )
            told[assert_agrees(result, verdict, motion, un, vn, base)] += 1
    assert min(told["free"], told["crosses"]) > 8


@pytest.mark.parametrize("restitution", [0.0, 1e-6, 1e-3, 0.1, 0.7, 1.0])
def test_overtones_ringing_after_an_impact(restitution):
    """Twenty modes hit the stop together; the next touch, often within a fraction of an overtone's period."""
    generator = np.random.default_rng([11, int(1e6 * restitution)])
    touches, early = 0, 0
    for _ in range(25):
        motion = random_oscillator(generator, 20).motion()
        u, v = random_deviation(generator, motion, ringing=False)
        base = float(generator.uniform(0, 0.5) * motion.period)
        u[0] -= tip_state(motion, base, u, v)[0] / motion.phi[0]
        v[0] += (generator.uniform(0.01, 1.0) - tip_state(motion, base, u, v)[1]) / motion.phi[0]
        newton_impact(motion, v, tip_state(motion, base, u, v)[1], restitution)
        acceleration = tip_state(motion, base, u, v)[2]
        if restitution < 1e-3 and acceleration > 0:
            continue  # the tip stays, or chatters
        duration = motion.period - base
        outcome, s = search(motion, base, u, v, duration, 1 if restitution > 0 else 2)
        assert outcome in (CROSSES, FREE)
        signal = Signal(motion, base, u, v)
        fine = np.linspace(0.0, duration, 12_000)
        heights = signal(fine) - motion.gap
        above = fine[1:][heights[1:] > 1e-12]
        if outcome == FREE:
            assert above.size == 0
            continue
        touches += 1
        early += s < 0.2 * 2 * np.pi / motion.omega[0]
        assert abs(signal(Real(s)) - Real(motion.gap)) <= tip_rounding(motion, u, v)
        assert signal(Real(s), 1) > 0
        assert above.size == 0 or above[0] > s - 1e-12
        assert np.all(heights[(fine > 1e-9) & (fine < s)] < 1e-12)
    assert touches > 5
    assert early > 0


def test_impact_with_next_to_no_speed_is_still_left():
    """Approach speeds down to 1e-13 m/s at a peak: the tip departs, for any restitution."""
    model = ModalModel(omega=[150.0], decay_rate=[3.0], phi=[1.0], participation=[0.0])
    stop = Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.5))
    motion = ImpactOscillator(model=model, stop=stop).motion()
    for speed in 10.0 ** -np.arange(1.0, 14.0):
        outcome, s = search(motion, 0.0, np.array([0.01]), np.array([-speed]), motion.period, 1)
        assert outcome == FREE
        assert s == motion.period


# ----------------------------------------------------------------------------------------- degenerate touches


def degenerate(flatness: float, third: float) -> tuple:
    """Four undamped modes with height and velocity zero, acceleration -`flatness`, third derivative `third`.

    Returns motion (gap set to the height there), u, v at s = 0, and the time 0.01 s of all this.
    """
    omega = np.array([100.0, 210.0, 330.0, 470.0])
    model = ModalModel(omega=omega, decay_rate=np.zeros(4), phi=np.ones(4), participation=np.zeros(4))
    stop = Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.5))
    motion = ImpactOscillator(model=model, stop=stop).motion()
    # q cos(omega (s - s0)) + p sin(omega (s - s0)): even derivatives from q, odd ones from p
    q = np.linalg.solve([np.ones(4), -(omega**2), omega**4, [1.0, 0, 0, 0]], [0.01, -flatness, -5e5, 0.008])
    p = np.linalg.solve([omega, -(omega**3), [1.0, 0, 0, 0], [0, 0, 0, 1.0]], [0.0, third, 0.0, 0.0])
    time = 0.01
    u = q * np.cos(omega * time) - p * np.sin(omega * time)
    v = omega * (q * np.sin(omega * time) + p * np.cos(omega * time))
    return motion, u, v, time


@pytest.mark.parametrize("third", [0.0, 1e-3, 1.0, 300.0])
@pytest.mark.parametrize("flatness", [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("h", [0.0, 1e-15, -1e-15, 1e-13, -1e-13, 1e-10, -1e-10, 1e-6, -1e-6])
def test_tangency_with_no_acceleration_is_right_or_refused(third, flatness, h):
    """Height, velocity and acceleration vanish together: CROSSES only if it does, FREE only if not."""
    motion, u, v, time = degenerate(flatness, third)
    signal = Signal(motion, 0.0, u, v)
    duration = 0.016
    # fine samples about the flat top, in long double: it may hold two peaks a few microseconds apart
    fine = np.linspace(-1, 1, 4001)
    fine = Real(time) + Real(2e-3) * fine**3
    places = np.union1d(signal.peaks(duration, samples=fine), signal.peaks(float(fine[0])))
    assert np.all(signal(np.linspace(float(fine[-1]), duration, 500)) < 0.01)
    heights = signal(places)
    top = heights[np.argmin(np.abs(heights - 0.01))]
    gap = float(top / (1 + Real(h)))
    stopped = with_gap(motion, gap)
    verdict = judge(signal, gap, duration, peaks=places)
    outcome, s = search(stopped, 0.0, u, v, duration)
    bound = tip_rounding(stopped, u, v)
    if outcome == UNRESOLVED:
        assert abs(signal(Real(s)) - Real(gap)) <= 4 * bound, "gave up away from the stop"
        assert abs(h) < 1e-11, "gave up on a peak that is clear of rounding"
    elif outcome == GRAZES:
        assert abs(verdict.peak) <= 2 * bound
    elif outcome == FREE:
        assert verdict.peak <= 0
    else:
        assert verdict.peak > 0
        # where the root is blurred, its height is what is certain
        assert abs(signal(Real(s)) - Real(gap)) <= bound
        assert s <= verdict.time + bound / verdict.slope + 1e-15 or abs(h) < 1e-13


def test_rising_inflection_on_the_stop_is_a_crossing_or_refused():
    """y ~ (s - s0)^3 at the stop, and the same lifted or lowered by a little: the motion passes through."""
    for lift in (0.0, 1e-16, -1e-16, 1e-14, -1e-14, 1e-11, -1e-11, 1e-8, -1e-8):
        motion, u, v, time = degenerate(0.0, 5e4)
        omega = motion.omega
        # without the even part beyond the height: a cubic to leading order
        q = np.linalg.solve([np.ones(4), -(omega**2), omega**4, -(omega**6)], [0.01, 0.0, 0.0, 0.0])
        p = np.linalg.solve([omega, -(omega**3), omega**5, -(omega**7)], [0.0, 5e4, 0.0, 0.0])
        u = q * np.cos(omega * time) - p * np.sin(omega * time)
        v = omega * (q * np.sin(omega * time) + p * np.cos(omega * time))
        stopped = with_gap(motion, 0.01 + lift)
        signal = Signal(motion, 0.0, u, v)
        fine = np.linspace(0, 0.014, 20_000)
        assert np.all(signal(fine[fine < 0.009]) < 0.0099999)
        assert np.all(signal(fine[fine > 0.011]) > 0.010001)
        outcome, s = search(stopped, 0.0, u, v, 0.014)
        assert outcome in (CROSSES, UNRESOLVED)
        assert abs(signal(Real(s)) - Real(stopped.gap)) <= 2 * tip_rounding(stopped, u, v)
        if abs(lift) >= 1e-11:
            assert outcome == CROSSES


def test_on_the_wall_and_pressed_is_refused():
    """A leading derivative that leads into the wall cannot begin a flight: UNRESOLVED at the start."""
    generator = np.random.default_rng(12)
    for order in (1, 2, 3):
        motion, base, u, v, _du, _dv = on_the_wall(generator, 5, order)
        assert search(motion, base, u, v, 0.3 * motion.period, order)[0] in (CROSSES, FREE)
        # everything reversed, the stop too: the same derivatives vanish, the next one has the other sign
        mirrored = motion._replace(
            tip_sine=-motion.tip_sine, tip_cosine=-motion.tip_cosine, gap=-motion.gap, level=-motion.level
        )
        assert search(mirrored, base, -u, -v, 0.3 * motion.period, order) == (UNRESOLVED, 0.0)


@pytest.mark.parametrize("speed", [1.0, 1e-3, 1e-6])
def test_tip_on_the_wall_within_rounding_is_told_by_its_velocity(speed):
    model = ModalModel(omega=[150.0, 700.0], decay_rate=[3.0, 9.0], phi=[1.0, 2.0], participation=[0.0, 0.0])
    stop = Stop(gap=0.01, law=NewtonRestitution(local_restitution=0.5))
    motion = ImpactOscillator(model=model, stop=stop).motion()
    for ulps in (-2, -1, 0, 1, 2):
        u = np.array([0.01 * (1 + ulps * EPS), 0.0])
        outcome, s = search(motion, 0.0, u, np.array([speed, 0.0]), 1e-3)
        assert outcome == CROSSES
        assert 0.0 <= s <= 3 * EPS * 0.01 / speed
        assert search(motion, 0.0, u, np.array([-speed, 0.0]), 1e-3) == (FREE, 1e-3)


# ------------------------------------------------------------------------------------- loads, and brute force


@pytest.mark.filterwarnings("ignore:gap is 3 m:beam.SuspiciousValue")
@pytest.mark.parametrize("decay", [0.0, 0.5, 20.0])
def test_falling_body_reaches_the_ground(decay):
    """A mode of zero frequency under a constant load: no bound of its displacement, the search samples it."""
    for height in (1e-3, 0.1, 1.0, 3.0):
        model = ModalModel(
            omega=[0.0, 300.0], decay_rate=[decay, 2.0], phi=[1.0, 1.0], participation=[0.0, 0.0]
        )
        stop = Stop(gap=height, law=NewtonRestitution(local_restitution=0.7))
        motion = ImpactOscillator(model=model, stop=stop, load=np.array([9.81, 0.0])).motion()
        u, v = np.array([0.0, 1e-5]), np.array([-0.2, 0.0])
        signal = Signal(motion, 0.0, u, v)
        outcome, s = search(motion, 0.0, u, v, 3.0)
        verdict = judge(signal, height, 3.0)
        if math.isnan(verdict.time):
            assert outcome == FREE
        else:
            assert outcome == CROSSES
            assert abs(s - verdict.time) < 1e-14 * (1 + s) + 2e-15 / verdict.slope


def test_thrown_body_turns_just_above_or_below_the_stop():
    """x = v s - g s^2/2 turns at v^2/2g: planted heights in closed form, free of the judge."""
    model = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    for h in PLANTED:
        gap = 1.0
        stop = Stop(gap=gap, law=NewtonRestitution(local_restitution=0.7))
        motion = ImpactOscillator(model=model, stop=stop, load=np.array([-8.0])).motion()
        # v^2/16 = gap (1 + h)
        speed = math.sqrt(16 * gap) * (1 + 0.5 * h - 0.125 * h * h + h**3 / 16)
        outcome, s = search(motion, 0.0, np.zeros(1), np.array([speed]), 3.0)
        excess = Real(speed) ** 2 / 16 - gap
        assert outcome == (CROSSES if h > 0 else FREE)
        if h > 0:
            exact = (Real(speed) - np.sqrt(16 * excess)) / 8
            assert abs(s - exact) < 4 * EPS + 20 * EPS * gap / np.sqrt(16 * excess)


@pytest.mark.parametrize("n_modes", [1, 2, 4, 8, 15, 20])
def test_brute_force_finds_nothing_earlier(n_modes):
    """Flights against a stop set at random: 20 000 samples a flight, first one above the stop."""
    generator = np.random.default_rng([13, n_modes])
    found = free = 0
    for trial in range(30):
        motion = random_oscillator(generator, n_modes, driven=trial % 3 > 0).motion()
        u, v = random_deviation(generator, motion, ringing=trial % 2 > 0)
        base = 0.0
        fine = np.linspace(base, motion.period, 20_000)
        signal = Signal(motion, base, u, v)
        x = signal(fine)
        gap = float(generator.uniform(max(x[0], 1e-4), max(1.1 * x.max(), 2e-4)))
        if gap <= max(x[0], 0):
            continue
        stopped = with_gap(motion, gap)
        outcome, s = search(stopped, base, u, v, motion.period)
        above = np.flatnonzero(x > gap)
        if above.size:
            found += 1
            assert outcome == CROSSES
            assert fine[above[0] - 1] - 1e-12 <= s <= fine[above[0]] + 1e-12
        else:
            free += outcome == FREE
            if outcome == CROSSES:  # a peak between two samples
                assert signal(Real(s)) - gap < 1e-15
                assert signal(Real(s), 1) > 0
    assert min(found, free) >= 1


# --------------------------------------------------------------------------------------- roots of polynomials


def polynomial(roots: np.ndarray, sign: float) -> np.ndarray:
    """Coefficients in rising order of sign * prod (s - r), scaled to a largest entry of one."""
    coefficients = np.array([sign])
    for r in roots:
        coefficients = np.convolve(coefficients, [-r, 1.0])
    return coefficients / np.abs(coefficients).max()


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_first_rising_root_of_a_polynomial(degree):
    generator = np.random.default_rng([14, degree])
    none = 0
    for _ in range(200):
        roots = generator.uniform(0.05, 1.3) + np.cumsum(generator.uniform(0.02, 0.3, degree))
        # negative at zero
        coefficients = polynomial(roots, 1.0)
        coefficients *= -np.sign(coefficients[0])
        result = first_polynomial_root(coefficients, 0.0, 1.0, 1e-15)
        if roots[0] > 1.0:
            none += 1
            assert result == -1.0
        else:
            slope = np.polynomial.polynomial.polyval(roots[0], np.polynomial.polynomial.polyder(coefficients))
            assert abs(result - roots[0]) < 1e-14 + 1e-14 / slope
    assert 0 < none < 200


def test_touch_of_zero_within_the_margin_has_no_consequence():
    """-(s - 1/2)^2 only touches zero and has no rising root; the same lifted by 1e-10 has one."""
    touching = np.array([-0.25, 1.0, -1.0])
    assert first_polynomial_root(touching, 0.0, 1.0, 1e-15) == -1.0
    lifted = touching + np.array([1e-10, 0.0, 0.0])
    assert first_polynomial_root(lifted, 0.0, 1.0, 1e-15) == pytest.approx(0.5 - 1e-5, abs=1e-11)
    then_rising = np.convolve(touching, [0.8, -1.0])  # touches at 0.5, rises through zero at 0.8
    assert first_polynomial_root(then_rising, 0.0, 1.0, 1e-15) == pytest.approx(0.8, abs=1e-12)


def test_polynomial_already_above_zero_is_left_in_few_steps():
    """Positive and falling at the start, which no contact should be: an answer all the same, and soon."""
    assert first_polynomial_root(np.array([1.0, -0.5]), 0.0, 1.0, 1e-16) == -1.0
    falling_then_rising = np.array([0.06, -0.5, 1.0])  # zeros at 0.2 and 0.3
    assert first_polynomial_root(falling_then_rising, 0.0, 1.0, 1e-16) == pytest.approx(0.3, abs=1e-14)


def test_polynomial_that_starts_at_zero_and_falls():
    """Entry into a contact: force zero and growing; the next zero is the release, the start is none."""
    for speed in (1.0, 1e-3, 1e-9):
        coefficients = np.array([0.0, -speed, 0.0, speed / 0.36])  # speed s (s^2/0.36 - 1)
        assert first_polynomial_root(coefficients, 0.0, 1.0, 1e-16) == pytest.approx(0.6, rel=1e-6)
        assert first_polynomial_root(coefficients, 0.0, 0.5, 1e-16) == -1.0
