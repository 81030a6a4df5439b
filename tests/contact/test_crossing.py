"""The search for the first touch: planted over- and undershoots, none missed and none invented."""

import math

import numpy as np
import pytest
from oscillators import modes_on_stop, newton, slow
from tip_judge import LONG_DOUBLE, PLANTED, Real, Signal, flights, judge, search, with_gap

from contact.flight.crossing import CROSSES, FREE, GRAZE_TOLERANCE, GRAZES, UNRESOLVED
from contact.flight.elementary import EPS
from contact.flight.modal_flow import propagate
from contact.flight.tip import tip_rounding
from contact.orbits import Shooting
from contact.orbits.families.touch_orbit import peaks

pytestmark = LONG_DOUBLE


@pytest.mark.parametrize("n_modes", [1, 2, 3, 5, 10, 20])
@pytest.mark.parametrize("kind", ["at rest", "ringing", "drive off"])
@pytest.mark.parametrize("count", [3, *slow(10)])
def test_planted_overshoots_are_found_and_undershoots_are_not(n_modes, kind, count):
    """Peaks h = 1e-1 ... 1e-12 of the gap above and below the stop, over flights of up to one period."""
    counts = {"free": 0, "crosses": 0, "within rounding": 0}
    for flight in flights([n_modes, len(kind)], n_modes, count, kind, late=0.9):
        for i in flight.chosen[:3]:
            for h in PLANTED:
                gap = float(flight.heights[i] / (1 + Real(h)))
                if gap > flight.start:
                    counts[flight.agrees(gap, flight.numbers.period - flight.base)] += 1
    assert counts["within rounding"] == 0 and min(counts["free"], counts["crosses"]) > 2 * count


@pytest.mark.parametrize("n_modes", [1, 2, 5, 20])
def test_a_peak_on_the_stop_is_a_graze_and_near_it_nothing_is_invented(n_modes):
    """gap = the peak rounded to double is a graze; below the rounding bound CROSSES and FREE stay right."""
    grazes = 0
    for flight in flights([7, n_modes], n_modes, 40):
        for i in flight.chosen[-1:]:
            end = float(flight.places[i] + (flight.numbers.period - flight.places[i]) * 1e-3)
            for h in (0.0, 1e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13):
                for sign in (1, -1):
                    gap = float(flight.heights[i] / (1 + sign * Real(h)))
                    stopped, (outcome, s) = flight.against(gap, end)
                    bound, peak = tip_rounding(stopped, flight.u, flight.v), flight.heights[i] - Real(gap)
                    assert bound < GRAZE_TOLERANCE * gap
                    if outcome == GRAZES:
                        grazes += 1
                        assert abs(peak) <= 2 * bound
                        # a place where the height is within rounding of the peak's
                        assert abs(flight.signal(Real(s)) - flight.heights[i]) <= bound
                    elif outcome == CROSSES:
                        assert peak > 0
                        judged = judge(flight.signal, gap, end, peaks=flight.places[: i + 1])
                        assert abs(s - judged.time) <= bound / judged.slope + 4 * EPS * stopped.period
                    else:
                        assert outcome == FREE and peak < 0
                    if h == 0.0:
                        assert outcome == GRAZES
    assert grazes > 100


def test_a_graze_too_blurred_to_be_called_one_is_unresolved():
    """Two modes that cancel to 1e-3 of their size: the rounding bound exceeds 1e-13 of the gap."""
    numbers = modes_on_stop([100.0, 100.001], phi=[1.0, -1.0], gap=1e-5).numbers()
    u, v = np.array([-0.01, -0.01]), np.array([0.2, 0.2 - 1e-3])
    signal = Signal(numbers, 0.0, u, v)
    places = signal.peaks(numbers.period)
    height = signal(places).max()
    blurred = with_gap(numbers, float(height))
    assert tip_rounding(blurred, u, v) > GRAZE_TOLERANCE * blurred.gap
    outcome, s = search(blurred, 0.0, u, v, numbers.period)
    assert outcome == UNRESOLVED and abs(s - places[np.argmax(signal(places))]) < 1e-6
    # clear of the blur on either side it is decided
    assert search(with_gap(numbers, float(height) * (1 - 1e-10)), 0.0, u, v, numbers.period)[0] == CROSSES
    assert search(with_gap(numbers, float(height) * (1 + 1e-10)), 0.0, u, v, numbers.period)[0] == FREE


@pytest.mark.parametrize("n_modes", [1, 3, 10])
def test_flight_that_ends_near_the_peak(n_modes):
    """The flight ends 1e-3 ... 1e-12 of a period before or after a peak near the stop."""
    counts = {"free": 0, "crosses": 0, "within rounding": 0}
    for flight in flights([8, n_modes], n_modes, 12):
        for i in flight.chosen[-1:]:
            for h in (1e-2, 1e-4, 1e-6, 1e-8, -1e-8, -1e-4):
                for part in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, -1e-12, -1e-9, -1e-7, -1e-5, -1e-3):
                    gap = float(flight.heights[i] / (1 + Real(h)))
                    if gap > flight.start:
                        end = float(flight.places[i]) + part * flight.numbers.period
                        counts[flight.agrees(gap, end)] += 1
    assert min(counts["free"], counts["crosses"]) > 100


def test_flight_that_ends_at_the_touch_finds_it_in_the_next_one():
    """A crossing within rounding of the end belongs to exactly one of two consecutive flights."""
    for flight in flights([9], 3, 40, "at rest"):
        if not flight.chosen:
            continue
        numbers, u, v = flight.numbers, flight.u, flight.v
        stopped = with_gap(numbers, 0.5 * (float(flight.heights.max()) + flight.start))
        outcome, root = search(stopped, 0.0, u, v, numbers.period)
        assert outcome == CROSSES
        for before in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
            end = root - before * numbers.period
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
            second, s = search(stopped, end, un, vn, numbers.period - end)
            assert second == CROSSES and abs(end + s - root) < 1e-14


@pytest.mark.filterwarnings("ignore:gap is 3 m:beam.SuspiciousValue")
@pytest.mark.parametrize("decay", [0.0, 0.5, 20.0])
def test_falling_body_reaches_the_ground(decay):
    """A mode of zero frequency under a constant load: no bound of its displacement, the search samples it."""
    for height in (1e-3, 0.1, 1.0, 3.0):
        numbers = modes_on_stop([0.0, 300.0], [decay, 2.0], gap=height, load=[9.81, 0.0]).numbers()
        u, v = np.array([0.0, 1e-5]), np.array([-0.2, 0.0])
        signal = Signal(numbers, 0.0, u, v)
        outcome, s = search(numbers, 0.0, u, v, 3.0)
        verdict = judge(signal, height, 3.0)
        if math.isnan(verdict.time):
            assert outcome == FREE
        else:
            assert outcome == CROSSES
            assert abs(s - verdict.time) < 1e-14 * (1 + s) + 2e-15 / verdict.slope


def test_thrown_body_turns_just_above_or_below_the_stop():
    """x = v s - g s^2/2 turns at v^2/2g: planted heights in closed form, free of the judge."""
    gap = 1.0
    numbers = modes_on_stop(0.0, gap=gap, load=-8.0).numbers()
    for h in PLANTED:  # v^2/16 = gap (1 + h)
        speed = math.sqrt(16 * gap) * (1 + 0.5 * h - 0.125 * h * h + h**3 / 16)
        outcome, s = search(numbers, 0.0, np.zeros(1), np.array([speed]), 3.0)
        excess = Real(speed) ** 2 / 16 - gap
        assert outcome == (CROSSES if h > 0 else FREE)
        if h > 0:
            exact = (Real(speed) - np.sqrt(16 * excess)) / 8
            assert abs(s - exact) < 4 * EPS + 20 * EPS * gap / np.sqrt(16 * excess)


@pytest.mark.parametrize("hertz", [60.0, 900.0, 6000.0])
def test_all_peaks_of_an_orbit_are_found(hertz):
    """As many, and where, as the judge's."""
    omega = 2 * np.pi * np.array([24.5, hertz])
    system = modes_on_stop(omega, [3.0, 20.0], [7.0, 14.0], [0.09, 0.0], law=newton(0.1), drive=21.5)
    orbit = Shooting(oscillator=system, m=3).at_speed(0.3 * system.unit_speed)
    left = float(orbit.record.log["end"][0])
    signal = Signal(orbit.oscillator.numbers(), orbit.phase + left, *orbit.record.states[0, 1])
    tops = signal.peaks(orbit.duration - left)
    found = np.array([(place, height) for _, place, height in peaks(orbit)])
    assert len(found) == tops.size > (40 if hertz > 1000 else 1)
    assert found[:, 0] == pytest.approx(tops.astype(float), abs=1e-9)
    assert found[:, 1] == pytest.approx((signal(tops) - system.stop.gap).astype(float), abs=1e-12)
