"""Noise of the drive: scans as an observer makes them, and the formulas for them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oscillators import slow
from scipy.special import gamma

from contact.orbits import strobe_covariance
from studies.measurement.noise import __main__ as program
from studies.measurement.noise.places import Place
from studies.measurement.noise.rates import LAG, in_drift, law_of, mean_time, quantiles
from studies.measurement.noise.scans import Protocol, scans, start_of
from studies.physics.drive_noise import Drift, DriveNoise, watched
from studies.shell.scene import band_of

SIGMA = 2.5e-4
WHITE = Protocol(step=SIGMA, waiting=10_000, stability=SIGMA)
DRIFT = replace(WHITE, correlation_s=100.0)
LONGER = (4, 21.5, WHITE), (5, 22.2, WHITE), (5, 22.2, DRIFT), (6, 22.6, DRIFT)


@pytest.fixture(scope="module")
def place(letter_scene):
    """p_m of Eq. (1) at a frequency."""
    return lambda m, frequency: Place(scene=letter_scene, m=m, frequency_hz=frequency)


def test_noise_is_stationary_remembers_and_goes_on_where_it_stopped():
    memory = DriveNoise(stability=SIGMA, correlation_s=1.0).memory(20.0)
    assert memory == pytest.approx(math.exp(-0.05)) and DriveNoise(stability=SIGMA).memory(20.0) == 0.0
    for correlation in (0.0, memory):
        starts = [Drift(SIGMA, correlation, np.random.default_rng([1, i])).next(1) for i in range(4000)]
        assert np.std(starts) == pytest.approx(SIGMA, rel=0.05)
        long = Drift(SIGMA, correlation, np.random.default_rng(2)).next(200_000)
        assert np.std(long) == pytest.approx(SIGMA, rel=0.06)
        assert np.corrcoef(long[:-1], long[1:])[0, 1] == pytest.approx(correlation, abs=0.01)
    pieces = Drift(SIGMA, memory, np.random.default_rng(3))
    whole = Drift(SIGMA, memory, np.random.default_rng(3)).next(300)
    assert np.concatenate([pieces.next(100), pieces.next(200)]) == pytest.approx(whole, rel=1e-12)


def test_the_period_that_a_row_of_impacts_shows():
    regular = (np.arange(900) % 3 == 1).astype(int)
    assert watched(regular, 3) == (897 / 900, 1.0)  # the last interval is not over
    assert watched(regular, 4) == (0.0, pytest.approx(5 / 900))
    ends = regular.copy()
    ends[300:] = 0  # the last impact at 298
    assert watched(ends, 3) == (297 / 900, 301 / 900)
    assert watched(ends, 0) == (pytest.approx(602 / 900), 1 / 900)
    slips = regular.copy()
    slips[400], slips[401] = 0, 1
    share, passed = watched(slips, 3)
    assert 0.98 < share < 1.0 and passed == 400 / 900
    assert watched(np.zeros(900, dtype=int), 0) == (1.0, 1.0)
    assert watched(np.zeros(900, dtype=int), 3) == (0.0, 0.0)


def test_with_little_noise_orbits_end_within_a_step_of_fold_and_grazing(place):
    quiet = Protocol(step=1e-4, waiting=20_000, stability=5e-6, correlation_s=1e4)
    for m, frequency in ((4, 21.5), (5, 22.2)):
        here = place(m, frequency)
        assert here.stable(here.fold.excess + quiet.reach) is not None
        found = scans(here, quiet, 12, 1)
        # the next step counts if half of the waiting is not enough to pass the bottleneck
        slipped, touched = found["slipped"] - here.fold.excess, found["touched"]
        assert np.all((slipped < 2e-5) & (slipped > -1.7e-4)) and slipped.min() < -5e-5
        assert np.all((touched > -2e-5) & (touched < 1.2e-4)) and touched.max() > 5e-5
        assert np.all(found["lost"] <= found["slipped"]) and np.all(found["left"] >= found["touched"])


def test_scans_depend_on_seed_and_place_alone(place):
    short = Protocol(step=SIGMA, waiting=1000, stability=SIGMA, correlation_s=5.0)
    first, again = (scans(place(4, 21.5), short, 3, 7) for _ in range(2))
    longer, other = scans(place(4, 21.5), short, 5, 7), scans(place(4, 21.5), short, 3, 8)
    for name, values in first.items():
        assert np.array_equal(values, again[name]) and np.array_equal(values, longer[name][:3])
        assert name == "met" or not np.array_equal(values, other[name])


def test_where_there_is_no_fold_or_no_space_above_it_nothing_is_lost(letter_scene, place):
    above = place(3, band_of(letter_scene, 3).upper + 0.05)
    assert above.fold is None and start_of(above, DRIFT) is None
    narrow = place(5, 21.8327)  # p5 touches the stop a second time 6e-4 above its fold
    assert narrow.stable(narrow.fold.excess + 5e-4) and not narrow.stable(narrow.fold.excess + 7e-4)
    assert start_of(narrow, DRIFT) is None and start_of(place(5, 21.9325), DRIFT)
    # chaos above grazing ends in p1 before it comes to p4, which exists from -0.045 to -0.040
    assert not scans(place(4, 21.2475), DRIFT, 3, 1)["met"].any()
    assert scans(place(4, 21.3455), DRIFT, 3, 1)["met"].all()
    found = scans(above, Protocol(step=SIGMA, waiting=1000, stability=SIGMA), 2, 1)
    assert np.isnan(found["lost"]).all() and np.isfinite(found["left"]).all()


def test_the_multiplier_next_to_a_fold_and_how_noise_adds_up(place):
    here = place(4, 21.5)
    distance = 1e-5 * abs(here.fold.excess)
    node = next(o for o in here.family.orbits(here.fold.excess + distance) if o.stable)
    assert (1.0 - node.multipliers.real.max()) ** 2 == pytest.approx(here.steepness * distance, rel=0.02)
    assert 1.0 <= here.unevenness * 2.0 < 1.4


def test_the_mean_time_of_white_noise_in_its_three_limits(place):
    here = place(4, 21.5)
    strength = 0.5 * (0.25 * here.steepness * SIGMA * here.unevenness) ** 2
    at_fold = 2.0 * math.sqrt(math.pi / strength) * (12.0 * strength) ** (1 / 6) * gamma(7 / 6)
    assert mean_time(0.0, here, SIGMA) == pytest.approx(at_fold, rel=1e-6)
    # Kramers' rate far above, the time through the bottleneck far below
    for barrier in (20.0, 80.0):
        mu = (0.75 * barrier * strength) ** (2 / 3)
        found = mean_time(mu / (0.25 * here.steepness), here, SIGMA)
        assert found == pytest.approx(math.exp(barrier) * math.pi / math.sqrt(mu), rel=0.4 / barrier)
    below = math.pi / math.sqrt(0.25 * here.steepness * 1e-2)
    assert mean_time(-1e-2, here, SIGMA) == pytest.approx(below, rel=1e-3)
    assert mean_time(1.0, here, SIGMA) == math.inf


@pytest.mark.slow
def test_the_lag_of_a_fold_that_brownian_motion_carries_away():
    dice, step, count = np.random.default_rng(6), 0.005, 4000
    y, eta, ends = np.full(count, 4.0), np.full(count, 2.0), list[float]()
    while y.size:
        slow = np.abs(eta) < 3.0
        # beyond, the square is solved exactly over a step
        ahead = np.where(slow, eta + step * (y - eta**2), eta / np.maximum(1.0 + step * eta, 1e-9) + step * y)
        out = ~slow & ((1.0 + step * eta <= 0.0) | (ahead < -60.0))
        ends += y[out].tolist()
        y, eta = y[~out], ahead[~out]
        y = y + math.sqrt(2.0 * step) * dice.standard_normal(y.size)
        y = np.where(y > 6.0, 12.0 - y, y)
    assert -np.mean(ends) == pytest.approx(LAG, abs=4.0 * np.std(ends) / math.sqrt(count))


@pytest.mark.parametrize("correlation", [100.0, *slow(3600.0)])
def test_a_drift_that_crosses_an_end_is_that_of_simulated_drifts(correlation):
    protocol, frequency, found = replace(WHITE, correlation_s=correlation), 20.0, []
    for i in range(400):
        dice = np.random.default_rng([9, i])
        drift, part, late = protocol.drift(frequency, dice), dice.random(), False
        for k in range(protocol.steps):
            level = protocol.step * (k + part) - protocol.reach
            past = np.flatnonzero(level + drift.next(protocol.waiting) > 0.0)
            if late or (past.size and past[0] < 5000):
                found.append(level)
                break
            late = past.size > 0
    exact = quantiles(in_drift(0.0, 1.0, protocol, frequency), (0.1, 0.5, 0.9))
    error = np.std(found) / math.sqrt(400) * np.array([1.7, 1.25, 1.7])
    # sampled once a period, a drift crosses 0.58 of its step late
    late = 0.58 * SIGMA * math.sqrt(2.0 / (frequency * correlation))
    assert np.all(np.abs(np.quantile(found, (0.1, 0.5, 0.9)) - late - exact) < 4.0 * error)


INDEPENDENT = {
    # m, Hz: medians in 1e-6 of 3000 scans, slips from the fold and touches, in white noise and in a drift
    (4, 21.5): ((-116.0, -1071.0), (149.0, -280.0)),
    (5, 22.2): ((-94.0, -814.0), (189.0, -276.0)),
    (6, 22.6): ((-51.0, -659.0), (212.0, -275.0)),
}
"""Of a program with its own flights and its own search for impacts, written by somebody who had not seen this
one; standard errors are 2e-6 to 5e-6."""


@pytest.mark.parametrize("m, frequency", INDEPENDENT)
def test_formulas_are_what_an_independent_program_found(place, m, frequency):
    here = place(m, frequency)
    for protocol, found in zip((WHITE, DRIFT), INDEPENDENT[m, frequency], strict=True):
        for end, median, origin in zip(("slipped", "touched"), found, (here.fold.excess, 0.0), strict=True):
            (formula,) = quantiles(law_of(here, protocol, end), (0.5,))
            assert 1e6 * (formula - origin) == pytest.approx(median, abs=16.0)


def test_a_cloud_is_what_an_independent_program_found(place):
    """p3 half way to its fold, 1.2e7 periods: (q, q'/omega) in gaps over sigma, errors 0.13 %."""
    here = place(3, 20.9)
    excess, gap = 0.5 * here.fold.excess, here.strobed.oscillator.stop.gap
    assert here.fold.excess == pytest.approx(-0.001278441, abs=1e-9)
    found = strobe_covariance(here.strobed.at(excess), here.stable(excess), 3, deviation=1.0) / gap**2
    theirs = [[21.942, -25.042, 28.992], [6.050, 13.670, 36.819], [35.710, 3.5590, 1.3426]]
    ours = found[:, [0, 0, 1], [0, 1, 1]]
    shifts = [np.roll(ours, k, axis=0) for k in range(3)]
    assert min(np.max(np.abs(each / theirs - 1.0)) for each in shifts) < 4 * 0.0013


@pytest.mark.parametrize("m, frequency, protocol", [(4, 21.5, DRIFT), (6, 22.6, WHITE), *slow(*LONGER)])
def test_formulas_are_what_scans_find(place, protocol, m, frequency):
    """Even where the noise is as large as the hysteresis, at 22.60 Hz."""
    here = place(m, frequency)
    found = scans(here, protocol, 80, 1996)
    for end in ("slipped", "touched"):
        low, median, high = quantiles(law_of(here, protocol, end), (0.16, 0.5, 0.84))
        error = 1.25 * 0.5 * (high - low) / math.sqrt(80)
        assert abs(np.median(found[end]) - median) < 3.5 * error
        spread = np.subtract(*np.quantile(found[end], (0.84, 0.16)))
        assert spread == pytest.approx(high - low, rel=0.35)


def test_small_form(run_study, monkeypatch):
    """On one band in three, at every second place."""
    monkeypatch.setattr(program, "BANDS", (4, 6))
    monkeypatch.setattr(program, "SPACING", ((1.0, 1), (1.0, 1)))
    options = ("--set", "drive.frequencies_hz=[21.5, 22.6]", "--waiting", "2000")
    ran = run_study("noise", "--quick", *options)
    assert ran.code == 0 and ran.summary["hidden"] == ["p6 at 22.60 Hz"]
    assert ("lowers" in ran.summary["findings"][0]) == (ran.summary["change"] < 0.0)
    shown = {(row["frequency_hz"], row["noise"]): row for row in ran.rows("observed_at_letter")}
    deep = shown["21.5", "drift of 100 s"]
    assert deep["seen"] == "True" and float(deep["median"]) == pytest.approx(float(deep["fold"]), rel=0.1)
    assert shown["22.6", "drift of 100 s"]["seen"] == "False"
    by_formula = [row for row in ran.rows("escape") if row["off"]]
    assert {row["end"] for row in by_formula} == {"slipped", "touched"} and len(by_formula) > 8
    assert np.median([abs(float(row["off"])) for row in by_formula]) < 1.5
