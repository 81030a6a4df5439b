"""The six transitions under errors and open assumptions, and the clouds of their strobe points in noise."""

import numpy as np
import pytest
from conftest import verdicts_on

from contact import StroboscopicMap
from contact.orbits import onset_orbit, strobe_covariance
from studies.experiment.last_period.causes import causes_of
from studies.experiment.last_period.changes import changed, changes_of, transitions_at
from studies.experiment.last_period.clouds import apart, clouds_of, frequency_of, separate, since_impact
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S
from studies.physics.calibration import free_period
from studies.physics.drive_noise import DriveNoise
from studies.shell.scene import single_mode_at

NAMES = ("map", "Eq. (1)", "beam")


def change(scene, parameter, sign):
    return next(c for c in changes_of(scene) if (c.parameter, c.sign) == (parameter, sign))


def by_name(rows):
    return {row.description: row for row in rows}


@pytest.fixture(scope="module")
def last(letter_scene, letter_model):
    """23.40 Hz without a change, and with T at both ends of its error."""
    base = transitions_at(letter_scene, letter_model, 23.40)
    found = {0: by_name(base)}
    for way in (-1, 1):
        there, model = changed(letter_scene, change(letter_scene, "free period", way))
        found[way] = by_name(transitions_at(there, model, 23.40, [row.m for row in base]))
    return found


def test_nothing_within_the_error_of_the_free_period_gives_p10_at_grazing(last):
    for rows in last.values():
        assert 10 not in [row.born for row in rows.values()]
        assert rows["map"].born == rows["beam"].born == 11


def test_a_shorter_free_period_deepens_the_hysteresis_in_all_descriptions(last):
    """f T falls: further below the upper edge of the band, where the fold leaves grazing as its square."""
    for name in NAMES:
        shorter, base, longer = (last[sign][name].fold for sign in (-1, 0, 1))
        assert shorter < base < longer < 0
    edge = 22.0 / 23.0
    distance = {sign: edge - 23.40 * (40.80e-3 + sign * FREE_PERIOD_ERROR_S) for sign in (-1, 0, 1)}
    for sign in (-1, 1):
        ratio = last[sign]["map"].fold / last[0]["map"].fold
        assert ratio == pytest.approx((distance[sign] / distance[0]) ** 2, rel=0.05)


def test_a_changed_spring_keeps_its_period_and_the_rate_of_mode_1(letter_scene, letter_model):
    period = free_period(letter_scene)
    for parameter in ("mass of ball and mount", "damping of higher modes"):
        there, modes = changed(letter_scene, change(letter_scene, parameter, 1))
        assert free_period(there) == pytest.approx(period, rel=1e-9)
        assert modes.decay_rate[0] == pytest.approx(letter_model.decay_rate[0], rel=1e-9)
    assert modes.decay_rate[1:] == pytest.approx(2.0 * letter_model.decay_rate[1:], rel=1e-12)
    shorter, _ = changed(letter_scene, change(letter_scene, "free period", -1))
    assert free_period(shorter) == pytest.approx(40.78e-3, rel=1e-9)
    faster, modes = changed(letter_scene, change(letter_scene, "decay rate of mode 1", 1))
    assert modes.decay_rate[0] == pytest.approx(faster.single_mode.decay_rate_per_s, rel=1e-9)


def test_separate_clouds_are_distinguished_from_merged_ones():
    n = np.arange(3000)
    impacts = (n % 3 == 0).astype(int)
    dice = np.random.default_rng(0)
    level = np.array([0.0, 1.0, 5.0])[n % 3]
    # 90 % of a normal distribution lie within 3.29 standard deviations
    points = level + 0.1 * dice.standard_normal(n.size)
    assert apart(points, impacts, 3) == pytest.approx(1 / 0.329, rel=0.05)
    assert separate(points, impacts, 3) == 1.0
    slow = level + np.repeat(dice.standard_normal(75), 40)  # a drift moves all points of a record
    assert apart(slow, impacts, 3) < 0.5 and separate(slow, impacts, 3) == 1.0
    wide = level + dice.standard_normal(n.size)
    assert apart(wide, impacts, 3) < 0.5 and separate(wide, impacts, 3) < 0.05
    assert np.isnan(apart(level, impacts, 4))  # no fourth cloud
    missed = impacts.copy()
    missed[1500] = 0
    assert separate(points, missed, 3) == pytest.approx(1.0 - 1 / 74)
    assert since_impact(np.array([0, 0, 1, 0, 0, 2, 1, 0])).tolist() == [-1, -1, 0, 1, 2, 0, 0, 1]


def test_strobe_points_run_together_as_m_grows(letter_scene, monkeypatch):
    monkeypatch.setattr("studies.experiment.last_period.clouds.WAITS", 3)
    sigma, rows = AMPLITUDE_STABILITY, []
    noises = [DriveNoise(stability=sigma, correlation_s=time) for time in (0.0, 100.0)]
    for m in (6, 9, 13):
        strobed = StroboscopicMap(oscillator=single_mode_at(letter_scene, frequency_of(letter_scene, m)))
        row, orbit = clouds_of(noises, ("Eq. (1)", strobed, m)), onset_orbit(strobed).end
        spread = strobe_covariance(strobed.at(1e-3), orbit, m, deviation=sigma)  # second route: covariances
        centre = strobed.tip(strobed.at(1e-3).orbit(orbit, m).points)
        order, width = np.argsort(centre), 3.29 * np.sqrt(spread[:, 0, 0])
        between = 0.5 * (width[order][1:] + width[order][:-1])
        assert row.born == m
        assert row.apart["white"] == pytest.approx(np.min(np.diff(centre[order]) / between), rel=0.1)
        rows.append(row)
    six, nine, thirteen = rows
    white = [row.apart["white"] for row in rows]
    assert white[0] > 2 > white[1] > 1 > 0.5 > white[2] and six.records["white"] == 1.0
    # a drift moves all points of a record together, and throws out what it carries over the fold
    assert nine.apart["drift_of_100_s"] < 0.5 and nine.records["drift_of_100_s"] == 1.0
    assert six.held["drift_of_100_s"] >= thirteen.held["drift_of_100_s"]


def test_small_form(run_study, monkeypatch):
    package = "studies.experiment.last_period"
    monkeypatch.setattr(f"{package}.__main__.causes_of", lambda *given: causes_of(*given)[:5])
    monkeypatch.setattr(f"{package}.__main__.changes_of", lambda *given: changes_of(*given)[1:5:3])
    monkeypatch.setattr(f"{package}.__main__.IN_NOISE", ((), range(9, 11)))
    monkeypatch.setattr(f"{package}.clouds.WAITS", 2)
    monkeypatch.setattr(f"{package}.pairs.GRID", 16)
    monkeypatch.setattr(f"{package}.pairs.HALVINGS", 4)
    given = "--set=drive.frequencies_hz=[23.4]", "--set=modes.count=4"
    ran = run_study("last_period", "--quick", *given)
    assert ran.code == 0 and len(ran.summary["rows"]) == 3 * (1 + 2)
    assert len(ran.rows("p10")) == 5 and ran.rows("p10")[1]["born_at_excess_0.01"] == "10"
    assert ran.summary["p10"][1]["p10_from"] == pytest.approx(4.3e-3, rel=0.1)
    assert {row["excess"] for row in ran.rows("pairs")} == {"0.0", "0.00025"}
    assert ran.summary["first_merged"]["white"] == 10 and ran.verdicts == verdicts_on("last_period")
    assert "from p10 on" in ran.summary["findings"][1]
    (needed,) = [one for one in ran.summary["findings"] if "need a free period" in one]
    assert " ms shorter than" in needed  # by which p10 and not p11 lies at 23.40 Hz
