"""The soft wall: power laws of the kick, the period doubling at grazing, the hysteresis, and the beam."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from contact.orbits.continuation import follow
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies import soft_wall
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene_file import read_scene
from studies.instruments.soft_wall.contact_orbits import SoftMap, doubling, fold_of
from studies.instruments.soft_wall.hertz_smoothing import (
    HertzSmoothing,
    born_orbits,
    collision_above,
    doubling_excess,
)
from studies.instruments.soft_wall.measures import hysteresis_chain, sides_of
from studies.instruments.soft_wall.soft_impact import (
    SoftImpact,
    damping_ratio,
    hard_contact,
    release,
    soft_contact,
)

SCENE = read_scene("letter")
ZETA = damping_ratio(0.1)


def wall_at(frequency: float, hardness: float, zeta: float = 0.0) -> tuple[SoftImpact, SoftMap]:
    oscillator = single_mode_oscillator(SCENE, frequency)
    wall = SoftImpact.of_mode(oscillator, hardness=hardness, zeta=zeta)
    return wall, SoftMap.of(oscillator, wall)


def measured_kick(soft: SoftMap, excess: float) -> float:
    return collision_above(soft.oscillator, excess).kick_velocity


# one collision


def contact_by_steps(z: float, zeta: float, steps: int = 4000) -> tuple[float, float]:
    """(tau_c, G) by Runge-Kutta steps until the force changes sign, the last one cut by a secant."""

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -1.0 - 2.0 * zeta * y[1] - y[0]])

    def step(y: np.ndarray, h: float) -> np.ndarray:
        a = rate(y)
        b = rate(y + 0.5 * h * a)
        c = rate(y + 0.5 * h * b)
        return y + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(y + h * c))

    y, tau, h = np.array([0.0, z]), 0.0, 4.0 / steps
    while True:
        after = step(y, h)
        if after[0] + 2.0 * zeta * after[1] <= 0.0 and tau > 0.0:
            low, high = 0.0, h
            for _ in range(60):
                middle = 0.5 * (low + high)
                trial = step(y, middle)
                low, high = (middle, high) if trial[0] + 2.0 * zeta * trial[1] > 0.0 else (low, middle)
            return tau + low, z - (tau + low) - step(y, low)[1]
        y, tau = after, tau + h


@pytest.mark.parametrize("zeta", [0.0, 0.2, 0.7, 1.0, 1.2431878510, 2.0])
@pytest.mark.parametrize("z", [0.05, 1.0, 20.0])
def test_one_contact_against_an_integration_of_its_equation(z, zeta):
    duration, kick, slope = soft_contact(z, zeta)
    stepped = contact_by_steps(z, zeta)
    assert duration == pytest.approx(stepped[0], rel=1e-8)
    assert kick == pytest.approx(stepped[1], rel=1e-7)
    step = 1e-4 * z
    rise = (soft_contact(z + step, zeta)[1] - soft_contact(z - step, zeta)[1]) / (2.0 * step)
    assert slope == pytest.approx(rise, rel=1e-6)


@pytest.mark.parametrize("zeta", [0.3, 0.999999, 1.0, 1.000001, 1.5])
def test_series_and_limits_of_one_contact_join(zeta):
    z = 1e-4 * zeta
    below, above = soft_contact(z * (1 - 1e-9), zeta), soft_contact(z * (1 + 1e-9), zeta)
    # the duration of small peaks is z to leading order only, the kick to the next one
    assert below[1] == pytest.approx(above[1], rel=1e-6)
    assert below[2] == pytest.approx(above[2], rel=1e-6)
    # a hard approach is the limit of a large one, at a distance 1/z
    gaps = [abs(soft_contact(z, zeta)[1] / z - 1.0 - hard_contact(zeta)[1]) for z in (1e3, 1e4)]
    assert math.log10(gaps[0] / gaps[1]) == pytest.approx(1.0, abs=0.01)


def test_restitution_of_spring_and_dashpot():
    assert damping_ratio(1.0) == 0.0
    assert hard_contact(1.0)[1] == pytest.approx(math.exp(-2.0))
    for zeta in (0.2, 0.591, 0.9):
        beta = math.asin(zeta)
        assert hard_contact(zeta)[1] == pytest.approx(math.exp(-(math.pi - 2 * beta) * math.tan(beta)))
    for restitution in (0.01, 0.1, 0.1353352832, 0.5, 0.99):
        assert hard_contact(damping_ratio(restitution))[1] == pytest.approx(restitution, rel=1e-12)
    # the wall that may pull, by its half period, is far from the letter's 0.1; the right one is overdamped
    half_period = -math.log(0.1) / math.hypot(math.pi, math.log(0.1))
    assert hard_contact(half_period)[1] == pytest.approx(0.2528, abs=1e-4)
    assert ZETA == pytest.approx(1.24319, abs=1e-5) and ZETA > 1.0
    # and the simulated collision has it, to the order of the contact time
    gaps = []
    for hardness in (1e6, 1e8):
        _wall, soft = wall_at(22.2, hardness, ZETA)
        gaps.append(abs(collision_above(soft.oscillator, 0.01).restitution - 0.1))
    assert gaps[1] < 0.2 * gaps[0] < 0.01


def test_kick_of_small_peaks_and_the_rate_of_its_error():
    for hardness in (1e2, 1e4, 1e6):
        wall, soft = wall_at(22.2, hardness)
        unit = wall.deceleration / (2.0 * wall.stiffness * wall.gap)  # peak of z = 1
        error = []
        for z in (0.05, 0.1):
            peak = unit * z * z
            kick = measured_kick(soft, peak)
            # impulse of the parabola by quadrature, with the stiffness that the wall adds
            span = math.sqrt(2.0 * peak * wall.gap / wall.deceleration)
            nodes, weights = np.polynomial.legendre.leggauss(8)
            depth = peak * wall.gap - 0.5 * wall.deceleration * (span * nodes) ** 2
            impulse = wall.stiffness * span * float(weights @ depth)
            assert wall.soft_law(peak) == pytest.approx(impulse, rel=1e-12)
            error.append(kick / wall.soft_law(peak) - 1.0)
            # the closed form leaves what the parabola leaves out, mu v/a and h
            assert kick == pytest.approx(wall.kick(peak), rel=3.0 * math.sqrt(peak) + 1e-5)
        if hardness > 1e3:
            assert error[0] == pytest.approx(-0.6 * 0.05**2, rel=0.05)
            assert math.log2(error[1] / error[0]) == pytest.approx(2.0, abs=0.05)  # in z: 1 in h


def test_powers_on_both_sides_of_the_crossover():
    wall, soft = wall_at(22.2, 1e6)
    for factor, power in ((1e-3, 1.5), (1e4, 0.5)):
        low, high = (measured_kick(soft, factor * wall.crossover * step) for step in (1.0, 1.1))
        found = math.log(high / low) / math.log(1.1)
        assert found == pytest.approx(power, abs=0.01)
        assert found == pytest.approx(wall.local_power(factor * wall.crossover * math.sqrt(1.1)), abs=5e-3)
    # the crossover is where the two power laws are equal
    assert wall.soft_law(wall.crossover) == pytest.approx(wall.hard_law(wall.crossover))
    assert wall.kick(wall.half_peak) == pytest.approx(0.5 * wall.hard_law(wall.half_peak))


def test_with_a_dashpot_the_kick_of_small_peaks_is_linear():
    wall, soft = wall_at(22.2, 1e4, ZETA)
    error = [measured_kick(soft, peak) / wall.soft_law(peak) - 1.0 for peak in (1e-8, 4e-8)]
    assert abs(error[0]) < 0.05
    assert math.log2(error[1] / error[0]) == pytest.approx(1.0, abs=0.05)  # in z: 1/2 in h
    assert wall.soft_law(wall.crossover) == pytest.approx(wall.hard_law(wall.crossover))


# the period map


@pytest.mark.parametrize("zeta", [0.0, ZETA])
def test_derivative_of_the_simulated_map_against_differences(zeta):
    wall, soft = wall_at(22.2, 1e3, zeta)
    peak = 0.3 * wall.crossover
    excess = wall.excess_of(peak)
    start = soft.guess_at(excess)
    orbit = soft.advance(excess, start)
    assert orbit.touches == 1
    step, columns = 1e-4 * peak, []
    for k in range(2):
        shift = step * np.eye(2)[k]
        ahead, behind = (soft.advance(excess, start + sign * shift).deviation for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * step))
    assert orbit.derivative == pytest.approx(np.array(columns).T, rel=2e-6)
    # between touches areas shrink by mu, in touch by the dashpot as well
    if zeta == 0.0:
        assert np.linalg.det(orbit.derivative) == pytest.approx(wall.gamma, rel=1e-12)
    else:
        assert np.linalg.det(orbit.derivative) < 0.9 * wall.gamma


@pytest.mark.parametrize("frequency", [20.9, 22.2])
def test_period_doubling_against_both_formulas(frequency):
    far, near = [], []
    for hardness in (1e2, 1e3, 1e4):
        wall, soft = wall_at(frequency, hardness)
        leading = wall.leading_doubling()[1]
        found = doubling(soft, 0.3 * leading, 3.0 * leading, 16)
        assert found is not None and found.touches == 1
        assert float(np.min(found.multipliers.real)) == pytest.approx(-1.0, abs=1e-6)
        far.append((found.excess / leading - 1.0) * hardness)
        near.append(abs(found.excess / wall.excess_of(wall.doubling_peak()) - 1.0))
    # K -> infinity: error shortfall/K; closed form: far smaller, of order K^-2
    assert far[-1] == pytest.approx(wall.leading_shortfall, rel=0.02)
    assert abs(far[-1] / wall.leading_shortfall - 1.0) < 0.2 * abs(far[-2] / wall.leading_shortfall - 1.0)
    assert near[1] < 0.02 * near[0] and near[2] < 1e-5


def test_leading_formula_as_it_is_published():
    wall, _soft = wall_at(22.2, 1e4)
    f, gamma = wall.drive_frequency, math.exp(-wall.decay_rate / wall.drive_frequency)
    damped = math.sqrt(wall.omega**2 - 0.25 * wall.decay_rate**2)
    theta = damped / f - 2.0 * math.pi
    alpha, m12 = 2.0 * math.sqrt(gamma) * math.cos(theta), math.sqrt(gamma) * math.sin(theta) / damped
    steepness = (1 + gamma + alpha) / (2 * m12 * wall.hardness * wall.omega**2)
    h_f = 0.5 * (2 * math.pi * f) ** 2 * steepness**2
    excess = h_f * (1 + 2 / 3 * (1 + gamma + alpha) / (1 - alpha + gamma))
    assert wall.leading_doubling() == pytest.approx((h_f, excess), rel=1e-10)


def test_motions_settle_on_p1_below_the_doubling_and_on_p2_above():
    wall, soft = wall_at(20.9, 1e3)
    scale = wall.leading_doubling()[1]
    orbit = doubling(soft, 0.3 * scale, 3.0 * scale, 16)
    assert sides_of(soft, orbit) == {"period_below": 1, "period_above": 2}


def test_a_soft_enough_wall_keeps_p1_stable():
    oscillator = single_mode_oscillator(SCENE, 22.2)
    least = SoftImpact.of_mode(oscillator, hardness=2.0).least_hardness
    assert SoftImpact.of_mode(oscillator, hardness=0.99 * least).doubling_peak() is None
    assert SoftImpact.of_mode(oscillator, hardness=1.01 * least).doubling_peak() > 0.0
    _wall, soft = wall_at(22.2, 10.0)
    assert doubling(soft, 0.01, 0.3, 12) is None


def test_with_the_dashpot_p1_is_unstable_from_its_first_touch():
    distance = []
    for factor in (1e-4, 1e-6):
        wall, soft = wall_at(22.2, 1e3, ZETA)
        excess = wall.excess_of(factor * wall.crossover)
        found = float(np.min(soft.fixed_point(excess, soft.guess_at(excess)).multipliers.real))
        assert found < -1.0
        distance.append(abs(found / wall.grazing_multipliers[0].real - 1.0))
    assert distance[1] == pytest.approx(0.1 * distance[0], rel=0.1)  # of order z, the root of the peak
    assert wall.doubling_peak() == 0.0


# the hysteresis


@pytest.mark.parametrize("frequency, period, restitution", [(22.2, 5, 0.1), (22.6, 6, 1.0)])
def test_the_fold_approaches_that_of_the_hard_wall(frequency, period, restitution):
    oscillator = single_mode_oscillator(SCENE, frequency)
    hard = MaximalFamily.from_oscillator(oscillator, period=period, restitution=restitution).fold()
    q, v = hard.state(1.0 / frequency)
    guess, excess, shift, left = None, hard.excess, [], []
    for hardness in (1e8, 1e7, 1e6):
        wall = SoftImpact.of_mode(oscillator, hardness=hardness, zeta=damping_ratio(restitution))
        soft = SoftMap.of(oscillator, wall, period)
        if guess is None:
            guess = soft.deviation(excess, State(displacement=q, velocity=v))
        orbit = fold_of(soft, excess, guess)
        assert orbit.touches == 1 and abs(orbit.fold_test) < 1e-8
        guess, excess = orbit.deviation, orbit.excess
        shift.append(excess - hard.excess)
        left.append(excess - wall.fold_excess(period))
    assert math.log10(shift[1] / shift[0]) == pytest.approx(0.5, abs=0.01)
    assert math.log10(left[1] / left[0]) == pytest.approx(1.0, abs=0.02)
    assert shift[0] > 0.0  # the soft wall has less hysteresis


def test_hard_limit_of_the_fold_is_that_of_eq_1():
    wall, _soft = wall_at(22.2, 1e12, ZETA)
    assert wall.fold_excess(5) == pytest.approx(-1.4773426733e-3, rel=1e-3)


def test_a_downward_scan_ends_at_the_fold():
    found, exponents = hysteresis_chain(SCENE, 22.2, ZETA, (1e4,), scan=True)
    row = found[1e4]
    assert row["period"] == 5
    assert row["hysteresis_scan"] == pytest.approx(row["hysteresis"], rel=1e-2)
    assert exponents["shift"] == pytest.approx(-0.5, abs=0.01)
    assert exponents["remainder"] == pytest.approx(-1.0, abs=0.02)


# the beam


def test_beam_with_hertz_contact():
    oscillator = beam_of(SCENE.replace({"contact.law": "hertz"}), 22.2)
    theory = HertzSmoothing(oscillator=oscillator)
    kicks = {e: collision_above(oscillator, e).kick_velocity for e in (1e-7, 1e-6)}
    error = [kick / theory.kick_velocity(e) - 1.0 for e, kick in kicks.items()]
    assert abs(error[0]) < 1e-3 and abs(error[1]) > 3.0 * abs(error[0])
    predicted = theory.doubling()
    # the exact place, by shooting: a multiplier of -1 on the branch of the p1 orbit with one impact
    unit = 2.0 * math.pi * 22.2 * oscillator.stop.gap
    family = Shooting(oscillator=oscillator, period=1)
    branch = follow(family, family.at_speed(1e-3 * unit), low=3e-4 * unit, high=1e-2 * unit, step=0.2)
    (exact,) = branch.of_kind("period doubling")
    assert exact.excess == pytest.approx(predicted, rel=0.02)
    # the simulated motion settles ever more slowly towards it, and so leaves p1 early
    measured, beyond = doubling_excess(oscillator, 0.4 * predicted, 1.5 * predicted, 800)
    assert 0.9 * exact.excess < measured < exact.excess
    assert beyond != 1
    below, above = born_orbits(oscillator, np.array([0.3, 2.0]) * predicted, 1000)
    assert (below["period_gently"], below["impacts_gently"]) == (1, 1)
    # raised in one step as by an experiment, there is no p1 to be seen at all
    assert above["period_gently"] == above["period_in_one_step"] == below["period_in_one_step"] == 5
    assert measured < 0.02 * soft_wall.RESOLUTION


def test_beam_formula_is_that_of_one_mode_when_there_is_one():
    scene = SCENE.replace({"contact.law": "hertz", "modes.count": 1})
    oscillator = beam_of(scene, 22.2)
    theory, model = HertzSmoothing(oscillator=oscillator), oscillator.model
    wall = SoftImpact(
        omega=float(model.omega[0]), decay_rate=float(model.decay_rate[0]), drive_frequency=22.2,
        gap=oscillator.stop.gap, hardness=2.0,
    )  # fmt: skip
    peak = wall.critical_slope / (2.0 * model.phi[0] ** 2 * theory.impulse_per_square) / wall.gap
    ratio = (1.0 + wall.gamma + wall.alpha) / (1.0 - wall.alpha + wall.gamma)
    assert theory.doubling() == pytest.approx(peak * (1.0 + 0.5 * ratio), rel=1e-9)


# the study


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("soft_wall")
    walls = ["--hardness", "1e2", "1e5", "--set", "drive.frequencies_hz=[22.2]"]
    code = soft_wall.main(["--quick", "--out", str(folder), *walls])
    return code, folder / "soft_wall"


def test_record_of_the_study(outcome):
    code, folder = outcome
    assert code == 0
    summary = json.loads((folder / "summary.json").read_text())
    assert isinstance(summary["schema"], int) and summary["soft_wall_schema"] == soft_wall.SCHEMA
    assert summary["failures"] == [] and len(summary["rows"]) == 4
    wanted = {
        "frequency_hz", "K", "dashpot", "h_f_theory", "excess_pd_theory", "excess_pd_measured",
        "crossover_excess", "slope_below", "slope_above", "hysteresis",
    }  # fmt: skip
    for row in summary["rows"]:
        assert wanted <= set(row)
        assert row["slope_below"] == pytest.approx(row["slope_below_theory"], abs=5e-3)
        assert (row["excess_pd_measured"] == 0.0) is (row["case"] == "dashpot")
    hard = next(row for row in summary["rows"] if row["case"] == "lossless" and row["K"] == 1e5)
    assert (hard["period_below"], hard["period_above"]) == (1, 2)
    assert hard["slope_above"] == pytest.approx(hard["slope_above_theory"], abs=5e-3)
    assert hard["crossover_measured"] == pytest.approx(hard["crossover_excess"], rel=0.02)
    assert summary["beam"]["half_excess"] < soft_wall.RESOLUTION
    assert summary["answers"]["sentences"]
    names = {file.name for file in folder.iterdir()}
    for name in ("kick", "doubling", "hysteresis", "beam"):
        assert {f"{name}.png", f"{name}.pdf"} <= names
    with open(folder / "rows.csv", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 4


@pytest.mark.parametrize(
    "argv, word",
    [
        (["--hardness", "1.5"], "--hardness"),
        (["--hardness", "stiff"], "--hardness"),
        (["--set", "drive.kind=none"], "drive.kind"),
        (["--set", "single_mode.restitution=0.0"], "single_mode.restitution"),
    ],
)
def test_wrong_input_is_one_sentence(argv, word, tmp_path, capsys):
    assert soft_wall.main(["--out", str(tmp_path), *argv]) == 2
    assert word in capsys.readouterr().err


def test_wrong_walls_are_refused():
    oscillator = single_mode_oscillator(SCENE, 22.2)
    for hardness in (1.0, -3.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="hardness"):
            SoftImpact.of_mode(oscillator, hardness=hardness)
    with pytest.raises(ValueError, match="zeta"):
        SoftImpact.of_mode(oscillator, hardness=10.0, zeta=-0.1)
    with pytest.raises(ValueError, match="zeta"):
        release(-1.0)
    with pytest.raises(ValueError, match="modes"):
        SoftImpact.of_mode(beam_of(SCENE, 22.2), hardness=10.0)
    wall = SoftImpact.of_mode(oscillator, hardness=10.0)
    for name, value in (("omega", 0.0), ("gap", -1.0), ("drive_frequency", math.nan), ("decay_rate", -1.0)):
        with pytest.raises(ValueError, match=name):
            replace(wall, **{name: value})
    for restitution in (0.0, 1.1, math.nan):
        with pytest.raises(ValueError, match="restitution"):
            damping_ratio(restitution)
    with pytest.raises(TypeError, match="HertzContact"):
        HertzSmoothing(oscillator=oscillator)


def test_the_map_is_that_of_the_stroboscope():
    wall, soft = wall_at(22.2, 1e3)
    excess = wall.excess_of(wall.crossover)
    start = soft.guess_at(excess)
    end = StroboscopicMap(oscillator=soft.oscillator.with_excess(excess)).step(soft.state(excess, start))
    assert soft.deviation(excess, end) == pytest.approx(soft.advance(excess, start).deviation, abs=1e-14)
