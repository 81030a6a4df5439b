"""Periodic orbits by shooting, against the simulated map and the closed forms."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from letters_spring import FOLDED_GAP, HERTZ, folded_strip, straight_leaf
from oscillators import equation_1, modes_on_stop
from simulated_orbit import EQUATION_1, LAWS, beam, on_stop, sizes, touches

from contact import HuntCrossley, NotPeriodic, StroboscopicMap
from contact.orbits import KickFamily, Shooting, fold_of, follow, settle
from contact.orbits.branches.amplitude_curve import whole_branch
from contact.orbits.families.equations import driven_at, shoot
from contact.sensitivity.change import Sensitivities


@pytest.mark.parametrize(("frequency", "period", "excess", "second", "digit"), EQUATION_1)
def test_fold_and_second_impact_of_equation_1(frequency, period, excess, second, digit):
    oscillator = equation_1(frequency)
    family, unit = Shooting(oscillator=oscillator, m=period), oscillator.unit_speed
    fold = fold_of(family)
    assert fold.excess == pytest.approx(excess, abs=1e-11 * abs(excess) + 6e-14)
    branch = follow(family, fold, low=0.01 * unit, high=1.5 * unit)
    assert [branch.ended_low, branch.ended_high] == ["range", "range"]
    assert [event.kind for event in branch.events][:2] == ["fold", "grazing"]
    again, graze = (event.orbit for event in branch.events[:2])
    assert again.excess == pytest.approx(excess, abs=1e-13)
    assert abs(graze.excess - second) <= 0.6 * digit and graze.admissible
    for factor, expected in ((1 - 1e-6, 1), (1 + 1e-6, 2)):
        beside = family.at_speed(graze.speed * factor, graze)
        assert touches(beside) == expected and beside.admissible == (expected == 1)


def test_where_contact_is_soft_a_branch_has_several_folds() -> None:
    """A folded spring with 12 modes at 23.05 Hz: a pair of folds close together, found from no kick fold
    and from any orbit; below them the branch goes on to the graze of a second touch."""
    oscillator = on_stop(folded_strip(12), 23.05, gap=FOLDED_GAP)
    family = Shooting(oscillator=oscillator, m=8)
    whole = whole_branch(family, None)[2]
    upper, lower = whole.of_kind("fold")
    assert (upper.excess, lower.excess) == pytest.approx((8.944e-6, 8.913e-6), rel=1e-3)
    assert 1.0 - lower.excess / upper.excess == pytest.approx(3.5e-3, rel=0.1)
    for orbit in (upper, lower):
        assert orbit.admissible and np.min(np.abs(orbit.multipliers - 1)) < 1e-6
        # one solution of the equations on either side of the fold in speed, at amplitudes on one side only
        beside = [family.at_speed(orbit.speed * factor, orbit).excess for factor in (0.99, 1.01)]
        assert (beside[0] - orbit.excess) * (beside[1] - orbit.excess) > 0
    assert KickFamily(oscillator=oscillator, m=8).fold() is None
    assert fold_of(family).excess == pytest.approx(lower.excess, abs=1e-14)
    far = family.at_speed(0.3 * oscillator.unit_speed)
    assert fold_of(family, far).excess == pytest.approx(lower.excess, abs=1e-14)
    # however long the steps of the branch
    for step in (0.21, 0.47):
        branch = follow(family, far, low=1e-3 * oscillator.unit_speed, high=2 * far.speed, step=step)
        folds = [orbit.excess for orbit in branch.of_kind("fold")]
        assert folds == pytest.approx([upper.excess, lower.excess], abs=1e-14)
    lowest = min(whole.events, key=lambda event: event.orbit.excess)
    assert lowest.kind == "grazing" and lowest.orbit.excess == pytest.approx(1.309e-6, rel=1e-2)
    assert [touches(family.at_speed(lowest.orbit.speed * x, lowest.orbit)) for x in (1.001, 0.999)] == [1, 2]


def test_below_its_lowest_fold_a_branch_can_go_on_to_a_graze() -> None:
    """A straight leaf with a ball of 2 g, 20 modes, 23.05 Hz: p8 folds at 1.17e-6, turns at 2.99e-6 and goes
    on, stable, to 4.6e-7; there settled motions say so, too."""
    oscillator = on_stop(straight_leaf(20), 23.05, gap=FOLDED_GAP)
    family = Shooting(oscillator=oscillator, m=8)
    whole = whole_branch(family, None)[2]
    upper, lower = whole.of_kind("fold")
    assert upper.speed < lower.speed and lower.excess < upper.excess
    assert (upper.excess, lower.excess) == pytest.approx((2.987e-6, 1.174e-6), rel=1e-2)
    assert fold_of(family).excess == pytest.approx(lower.excess, abs=1e-14)
    lowest = min(whole.events, key=lambda event: event.orbit.excess)
    assert lowest.kind == "grazing" and lowest.orbit.excess == pytest.approx(4.63e-7, rel=1e-2)
    start = family.at_speed(1.02 * lowest.orbit.speed, lowest.orbit)
    assert start.stable and lowest.orbit.excess < start.excess < lower.excess
    strobed = StroboscopicMap(oscillator=oscillator)
    for part, impacts in ((1.2, 1), (1.01, 1), (0.99, 2)):
        excess = part * lowest.orbit.excess
        limits = dict(most_cycles=4000, tolerance=1e-3 * excess)
        run = settle(strobed.at(excess), start.strobe_state(), prove=False, **limits)
        assert (run.m, run.impacts) == (8, impacts)


def test_the_slope_is_the_derivative_of_the_excess() -> None:
    oscillator = beam(22.20, HERTZ)
    family, v = Shooting(oscillator=oscillator, m=5), 0.08 * oscillator.unit_speed
    middle = family.at_speed(v)
    ends = [family.at_speed(v * factor, middle).excess for factor in (1 - 1e-4, 1 + 1e-4)]
    assert middle.slope == pytest.approx((ends[1] - ends[0]) / (2e-4 * v), rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_orbits_are_found_down_to_grazing(name: str) -> None:
    oscillator = beam(22.20, LAWS[name])
    family, unit = Shooting(oscillator=oscillator, m=5), oscillator.unit_speed
    excesses, orbit = [], family.at_speed(1e-2 * unit)
    for part in (1e-3, 1e-4, 1e-5, 1e-6):
        orbit = family.at_speed(part * unit, orbit)
        assert orbit.residual < 1e-9
        assert orbit.speed == pytest.approx(part * unit, rel=1e-15 / part + 1e-12)
        excesses.append(orbit.excess)
    # a square root of the excess under Newton's law; forces that set in from zero or with a dashpot leave
    # v^2/2
    if name == "newton":
        assert excesses[3] / excesses[2] == pytest.approx(0.1, rel=1e-3)
    else:
        assert excesses[3] == pytest.approx(0.5e-12, rel=1e-2 if name != "dashpot" else 0.8)


def test_a_neighbour_near_grazing_is_not_taken_for_the_orbit() -> None:
    """Speeds that differ by less than the tolerance of the residual are different orbits all the same."""
    oscillator = equation_1(21.50)
    family, unit = Shooting(oscillator=oscillator, m=4), oscillator.unit_speed
    start = family.at_speed(1.68e-6 * unit)
    near = family.at_speed(1.68e-6 * unit * (1 + 1e-7), start)
    assert near.speed / start.speed - 1 == pytest.approx(1e-7, rel=1e-2)
    branch = follow(family, family.at_speed(1e-5 * unit), low=1e-6 * unit, high=1e-4 * unit)
    assert branch.events == () and branch.ended_low == branch.ended_high == "range"


@pytest.mark.parametrize("modes", [1, 3])
def test_tangents_follow_a_contact_that_relaxes_fast(modes: int) -> None:
    """At chi v = 3000 a disturbance fades 2000 times faster than the contact ends: the tangents are
    differences of the flow nevertheless, here over the velocities at the touch."""
    law = HuntCrossley(stiffness=9.6154e9, dissipation=1e4)
    family = Shooting(oscillator=beam(22.20, law, modes=modes), m=5)
    orbit, scale = family.at_speed(0.2 * family.oscillator.unit_speed), sizes(family.oscillator)
    angle = 2.0 * np.pi * 22.20 * orbit.phase
    start = np.append(orbit.deviations, orbit.amplitude * np.array([np.sin(angle), np.cos(angle)]))

    def flow(start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        driven, phase = driven_at(family.oscillator, start[-2:])
        _orbit, miss, tangent = shoot(Sensitivities(oscillator=driven), phase, start[:-2], 5, 1)
        return start[:-2] + miss, tangent

    for k, step in zip(range(modes, 2 * modes), 1e-6 * np.eye(2 * modes + 2)[modes:], strict=False):
        ahead, behind = (flow(start + sign * step * scale[k])[0] for sign in (1, -1))
        exact = flow(start)[1][:, k]
        assert (ahead - behind) / 2e-6 / scale == pytest.approx(exact * scale[k] / scale, abs=1e-7)


@pytest.mark.parametrize("name", ["hertz", "linear", "newton"])
def test_the_determinant_is_the_decay_of_area_and_the_law(name: str) -> None:
    """Divergence -sum c_k everywhere, contact forces that depend on place alone add none; Newton's law
    reflects: its saltation matrix [[P, 0], [X, P]] has det P = -e."""
    oscillator = beam(20.90, LAWS[name], modes=3)
    orbit = Shooting(oscillator=oscillator, m=3).at_speed(0.1 * oscillator.unit_speed)
    expected = math.exp(-oscillator.model.decay_rate.sum() * 3 * oscillator.period)
    if name == "newton":
        expected *= LAWS["newton"].local_restitution ** 2
    assert np.prod(orbit.multipliers) == pytest.approx(expected, rel=1e-9)


def test_orbits_repeat_bit_for_bit_beside_other_threads() -> None:
    """Compiled code owns the memory it works in: one of a hundred orbits once differed in its digits."""
    oscillator = beam(20.90, HERTZ, modes=12)
    start = Shooting(oscillator=oscillator, m=3).at_speed(0.1 * oscillator.unit_speed)

    def again(_number: int) -> tuple[float, float, bytes]:
        orbit = Shooting(oscillator=oscillator, m=3).at_speed(1.001 * start.speed, start)
        return orbit.excess, orbit.phase, orbit.multipliers.tobytes()

    with ThreadPoolExecutor(3) as pool:
        assert set(pool.map(again, range(300))) == {again(0)}


def test_a_motion_without_impacts_starts_no_search() -> None:
    oscillator = equation_1(20.90).with_excess(-0.01)
    with pytest.raises(NotPeriodic, match="no impact"):
        Shooting(oscillator=oscillator, m=3).from_state(StroboscopicMap(oscillator=oscillator).steady())


def test_orbits_that_all_have_one_approach_velocity_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """There the approach velocity does not tell an orbit from its neighbours, and the curve has no slope."""
    # twice the drive frequency: the rows of both equations are the same to the last bit
    oscillator = modes_on_stop(4.0 * np.pi * 20.0, 3.56, 1.0, 1.0, law=LAWS["newton"], gap=1.0, drive=20.0)
    plain = Shooting(oscillator=oscillator, m=1)
    near = plain.at_speed(0.3 * oscillator.unit_speed)
    first: list[np.ndarray] = []

    def shot(known: Sensitivities, phase: float, start: np.ndarray, *_: int) -> tuple:
        at = known.oscillator
        first.append(unknown := np.append(start, at.driven.components(phase)))
        w, response = at.driven.angular_frequency, at.tip_response()
        rows = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 2.0, -2 * w * response.imag, 2 * w * response.real]])
        orbit = replace(near, oscillator=at, excess=at.excess)
        return orbit, rows @ (unknown - first[0]), rows + np.eye(4)[:2]

    monkeypatch.setattr("contact.orbits.families.newton_family.shoot", shot)
    with pytest.raises(NotPeriodic, match="approach velocity"):
        plain.at_excess(near.excess + 1e-3, near)
