"""Orbits by kicks, the ends of orbits and the events of their branches, against simulation and theory."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from letters_spring import HERTZ, steel_leaf
from oscillators import apart, equation_1, modes_on_stop, newton, slow
from simulated_orbit import DELAYED, EQUATION_1, beam, on_stop, settled, touches

import contact
from contact import HertzContact, ImpactOscillator, LinearContact, NordmarkMap, StroboscopicMap, orbits
from contact.orbits.branches.events import passes

HARD = equation_1(20.90, newton(0.7))


def waits(frequency: float, name: str) -> ImpactOscillator:
    return equation_1(frequency, DELAYED[name], gap=0.0107)


@pytest.mark.parametrize("ratio", [None, 1e-3], ids=["the letter's strips", "ringing"])
@pytest.mark.parametrize(("frequency", "period"), [(20.90, 3), (21.50, 4), (22.20, 5)])
def test_the_error_of_kicks_grows_with_the_speed(ratio: float | None, frequency: float, period: int) -> None:
    oscillator = beam(frequency, HERTZ, ratio=ratio)
    family = orbits.Shooting(oscillator=oscillator, m=period)
    speeds = np.array([0.05, 0.1, 0.3]) * oscillator.unit_speed
    errors = [abs(family.at_speed(v).excess - family.kicks.orbit(v).excess) for v in speeds]
    assert errors[0] < errors[1] < errors[2]
    assert errors[2] > 3e-6  # the ringing that is left matters


SCANS = [(beam(22.20, HERTZ, modes=4), 5, 0.015), (waits(21.50, "constant"), 4, 1e-8)]
SCANS += [(waits(21.50, "falling"), 4, 1e-8), *slow((beam(20.90, HERTZ, modes=4), 3, 0.015))]
SCANS += slow((waits(20.90, "falling"), 3, 1e-8), (waits(22.20, "constant"), 5, 1e-8))


@pytest.mark.parametrize(("oscillator", "period", "digits"), SCANS)
def test_folds_against_a_downward_scan(oscillator: ImpactOscillator, period: int, digits: float) -> None:
    """And against the fold of the kicks, which are exact where one mode waits."""
    family = orbits.Shooting(oscillator=oscillator, m=period)
    fold = orbits.fold_of(family)
    assert fold.admissible and apart(fold.multipliers[:1], np.ones(1)) < 1e-7
    node = family.at_speed(1.3 * fold.speed)
    assert node.stable and node.admissible and node.excess > fold.excess
    strobed, start = StroboscopicMap(oscillator=oscillator), replace(node.strobe_state(), time=0.0)
    end = orbits.orbit_end(strobed, start, node.excess, most_cycles=10_000, relative=1e-2)
    assert end.lost < fold.excess < end.held
    assert end.kind == "fold" and end.excess == pytest.approx(fold.excess, abs=1e-13)
    kick = family.kicks.fold()
    assert kick.excess == pytest.approx(fold.excess, rel=digits)
    assert kick.kick.speed == pytest.approx(fold.speed, rel=0.05)


def test_an_end_by_period_doubling_is_named_and_exact() -> None:
    """p1 of a hard wall of restitution 0.7: the scan downwards ends where a multiplier passes -1."""
    family, unit = orbits.Shooting(oscillator=HARD, m=1), HARD.unit_speed
    branch = orbits.follow(family, family.at_speed(1.0 * unit), low=0.5 * unit, high=1.5 * unit)
    (doubled,) = branch.of_kind("period doubling")
    start = family.at_speed(1.1 * doubled.speed, doubled)
    strobed = StroboscopicMap(oscillator=HARD)
    end = orbits.orbit_end(strobed, start.strobe_state(), start.excess, most_cycles=4000)
    assert end.kind == "period doubling" and end.lost < end.excess < end.held
    assert end.excess == pytest.approx(doubled.excess, rel=1e-9)


def test_an_orbit_doubles_its_period_before_a_hard_touch_is_lost() -> None:
    """Eq. (1), 20.90 Hz: p3 has a second touch above 0.0891 and would lose it there on the way down, but next
    to the graze its derivative has no bound, and it doubles its period just before."""
    oscillator = equation_1(20.90)
    single = orbits.Shooting(oscillator=oscillator, m=3)
    (graze,) = orbits.follow(single, single.at_speed(100.0), low=90.0, high=140.0).of_kind("grazing")
    strobed = StroboscopicMap(oscillator=oscillator)
    end = orbits.orbit_end(strobed, settled(oscillator, 0.1).end, 0.1, most_cycles=4000)
    assert (end.impacts, end.kind) == (2, "period doubling") and end.lost < end.excess < end.held
    assert 0.0 < end.excess / graze.excess - 1.0 < 0.02


@pytest.mark.parametrize(("first_step", "relative"), [(5e-2, 0.03), *slow((1e-6, 0.03), (2e-4, 1e-3))])
def test_no_bracket_closes_because_a_long_step_fell_off(first_step: float, relative: float) -> None:
    """The exact end lies in the bracket, which one last step has made, however the scan came there."""
    for frequency, period, excess, _second, _digit in EQUATION_1:
        oscillator = equation_1(frequency)
        nordmark = NordmarkMap.from_oscillator(oscillator)
        for strobed, exact in (
            (StroboscopicMap(oscillator=oscillator), excess),
            (nordmark, nordmark.excess(contact.MapFamily(nordmark, period).fold().rho)),
        ):
            steps = dict(relative=relative, first_step=first_step)
            end = orbits.orbit_end(strobed, orbits.onset_orbit(strobed).end, 1e-3, most_cycles=1000, **steps)
            assert (end.m, end.impacts, end.kind) == (period, 1, "fold")
            assert end.lost <= exact <= end.held
            assert end.held - end.lost <= 1.0001 * max(relative * abs(end.held), 1e-7)
            assert end.excess == pytest.approx(exact, rel=2e-10)


def test_an_end_that_nothing_can_make_exact_is_a_bracket() -> None:
    """x -> x^2 + c loses its fixed point with c = -3/4 (1 - excess) by a doubling, at excess 0."""

    class Square:
        scale = 1.0

        def __init__(self, c: float) -> None:
            self.c = c

        def at(self, excess: float) -> Square:
            return Square(-0.75 * (1.0 - excess))

        def steady(self) -> float:
            return -0.4

        def orbit(self, state: float, count: int) -> contact.StrobedOrbit[float]:
            points = np.empty((count, 1))
            for i in range(count):
                state = state * state + self.c
                points[i] = state
            return contact.StrobedOrbit(end=state, points=points, impacts=np.ones(count, dtype=int))

    end = orbits.orbit_end(Square(0.0), -0.4, 0.3, most_cycles=20_000, absolute=1e-2)
    assert (end.m, end.kind) == (1, "bracket")
    assert end.lost < 0.0 < end.held and end.held - end.lost < 1.01e-2


def test_one_mode_of_the_kick_is_not_the_whole_of_it() -> None:
    """With modes that ring on, the letter's two parameters are off where the kick of all modes is not."""
    oscillator = beam(20.90, HERTZ, ratio=1e-3)
    family, speed = orbits.Shooting(oscillator=oscillator, m=3), 0.1 * oscillator.unit_speed
    exact = family.at_speed(speed).excess
    kicks, mask = family.kicks, np.eye(oscillator.n_modes)[:1].T
    first = replace(kicks, collision=lambda v: replace(kicks.kick(v), jump=mask * kicks.kick(v).jump))
    assert np.all(first.kick(speed).jump[1:] == 0.0)
    assert abs(first.orbit(speed).excess - exact) > 5 * abs(family.kicks.orbit(speed).excess - exact)


def test_a_narrow_range_or_a_wrong_band_has_no_kick_fold() -> None:
    kicks = orbits.KickFamily(oscillator=equation_1(20.90), m=3)
    at = kicks.fold().kick.speed / kicks.oscillator.unit_speed
    assert kicks.fold(speeds=(1.5 * at, 1.0)) is None
    assert kicks.fold(speeds=(1e-4, 0.7 * at)) is None
    other = orbits.KickFamily(oscillator=equation_1(20.90), m=1)
    assert other.fold() is None


@pytest.mark.parametrize("oscillator, period, middle", [(HARD, 1, 1.0), (waits(22.20, "constant"), 4, 0.37)])
def test_a_doubling_of_the_period_is_seen_by_the_simulation(oscillator, period, middle):
    family, unit = orbits.Shooting(oscillator=oscillator, m=period), oscillator.unit_speed
    low, high = 0.8 * middle * unit, 1.2 * middle * unit
    branch = orbits.follow(family, family.at_speed(middle * unit), low=low, high=high)
    (doubled,) = branch.of_kind("period doubling")
    assert np.min(np.abs(doubled.multipliers + 1)) < 1e-7
    for part, stable in ((0.99, False), (1.01, True)):
        orbit = family.at_speed(part * doubled.speed, doubled)
        assert orbit.stable == stable and orbit.admissible
        # a small change at the strobe alternates in sign from one period to the next, and grows or shrinks
        strobed, start = StroboscopicMap(oscillator=orbit.oscillator), orbit.strobe_state()
        begin = replace(start, displacement=start.displacement + 1e-7 * oscillator.stop.gap, time=0.0)
        ends = [strobed.orbit(begin, period * n).end for n in (3, 4, 23, 24)]
        steps = [float(end.displacement[0] - start.displacement[0]) for end in ends]
        assert steps[0] * steps[1] < 0.0 and (abs(steps[3]) > abs(steps[2])) == (not stable)
        assert steps[3] / steps[2] == pytest.approx(orbit.multipliers[0].real, rel=1e-4)


def test_the_events_of_a_branch_of_the_beam() -> None:
    """Hertz: next to grazing the orbit of period m touches at every period, and has a fold of its own
    there."""
    oscillator = beam(22.20, HERTZ)
    family, unit = orbits.Shooting(oscillator=oscillator, m=5), oscillator.unit_speed
    branch = orbits.follow(family, family.at_speed(0.1 * unit), low=1e-5 * unit, high=1.5 * unit)
    speeds = [orbit.speed for orbit in branch.orbits]
    assert speeds == sorted(speeds)
    assert [event.kind for event in branch.events] == ["grazing", "fold", "fold", "grazing"]
    for orbit in branch.of_kind("fold"):
        assert abs(orbit.slope) * unit < 1e-9 and np.min(np.abs(orbit.multipliers - 1)) < 1e-6
        beside = [family.at_speed(orbit.speed * factor, orbit) for factor in (0.98, 1.02)]
        assert np.prod([np.prod(1 - other.multipliers).real for other in beside]) < 0
    for orbit, inside, outside in zip(branch.of_kind("grazing"), (1.001, 0.999), (0.999, 1.001), strict=True):
        assert touches(family.at_speed(orbit.speed * inside, orbit)) == 1
        assert touches(family.at_speed(orbit.speed * outside, orbit)) > 1


def test_a_branch_that_loses_a_touch_ends_with_its_last_good_orbit() -> None:
    """Two touches become one where the second grazes: the branch says where, and goes to its range
    elsewhere."""
    oscillator = equation_1(20.90)
    run = settled(oscillator, 0.1)
    family = orbits.Shooting(oscillator=oscillator.with_excess(0.1), m=3, impacts=2)
    start = family.from_state(run.end)
    branch = orbits.follow(family, start, low=0.9 * start.speed, high=2.0 * start.speed)
    assert branch.ended_low == "range" and "one of 2 touches is a graze" in branch.ended_high
    last = branch.orbits[-1]
    assert last.residual < 1e-9 and last.approach[1] < 5e-3 * last.approach[0]
    # there the orbit of one impact has its grazing
    single = orbits.Shooting(oscillator=oscillator, m=3)
    (graze,) = orbits.follow(single, single.at_speed(100.0), low=90.0, high=140.0).of_kind("grazing")
    assert last.speed == pytest.approx(graze.speed, rel=1e-5)
    assert last.excess == pytest.approx(graze.excess, rel=1e-5)
    with pytest.raises(contact.ContactError, match="lost"):
        family.at_speed(1.02 * last.speed, last)


def test_folds_along_frequency_are_those_of_each_frequency() -> None:
    oscillator = equation_1(21.40)
    frequencies = np.array([21.40, 21.45, 21.50])
    found = orbits.fold_along_frequency(orbits.Shooting(oscillator=oscillator, m=4), frequencies)
    for frequency, orbit in zip(frequencies, found, strict=True):
        closed = contact.MaximalFamily.from_oscillator(equation_1(frequency), m=4).fold()
        assert orbit.excess == pytest.approx(closed.excess, abs=1e-13)
        assert orbit.oscillator.drive.frequency == frequency
    other = orbits.Shooting(oscillator=oscillator, m=1)
    with pytest.raises(contact.BranchEnded, match="period doubling") as caught:
        orbits.fold_of(other)
    (why,) = orbits.fold_along_frequency(other, np.array([oscillator.drive.frequency]))
    assert isinstance(why, contact.BranchEnded) and str(why) == str(caught.value)
    assert np.min(np.abs(caught.value.orbit.multipliers + 1.0)) < 1e-6


def test_an_orbit_that_ends_by_a_torus_has_no_fold_and_says_so() -> None:
    """A steel cantilever with a light ball: on the way down a complex pair of multipliers of its p3 passes
    the unit circle."""
    oscillator = on_stop(steel_leaf(), 12.21, gap=0.0085).with_excess(1e-3)
    strobed = StroboscopicMap(oscillator=oscillator)
    orbit = orbits.onset_orbit(strobed, 1e-3)
    assert (orbit.m, orbit.impacts) == (3, 1)
    with pytest.raises(contact.BranchEnded, match="torus") as caught:
        orbits.fold_of(orbits.Shooting(oscillator=oscillator, m=3))
    end = orbits.orbit_end(strobed, orbit.end, 1e-3, most_cycles=2000)
    assert end.kind == "torus" and end.lost < end.excess < end.held
    assert caught.value.orbit.excess == pytest.approx(end.excess, rel=1e-9)
    assert abs(caught.value.orbit.multipliers[0]) == pytest.approx(1.0, abs=1e-6)


def test_a_bound_that_is_used_up_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    family = orbits.Shooting(oscillator=equation_1(20.90), m=3)
    start, unit = family.at_speed(10.0), family.oscillator.unit_speed
    monkeypatch.setattr("contact.orbits.branches.branch.MOST_STEPS", 3)
    cut = orbits.follow(family, start, low=1e-3 * unit, high=1.5 * unit)
    assert all("bound of 3 steps is used up" in ended for ended in (cut.ended_low, cut.ended_high))
    fast = family.at_speed(300.0)
    for search in (lambda: orbits.fold_of(family, start), lambda: orbits.first_event(family, fast, -0.9)):
        with pytest.raises(contact.BranchEnded, match="3 steps") as caught:
            search()
        assert isinstance(caught.value.orbit, orbits.PeriodicOrbit)


def test_where_the_approach_velocity_turns_round_a_fold_is_one() -> None:
    """One mode under Hertz's law, two touches: an independent search puts the fold at -0.3838."""
    hertz = HertzContact(stiffness=1e7)
    oscillator = modes_on_stop(150.0, 6.0, 1.0, 1.0, law=hertz, drive=14.0).with_excess(0.1)
    family = orbits.Shooting(oscillator=oscillator, m=1, impacts=2)
    start = family.from_state(replace(settled(oscillator, 0.1).end, time=0.0))
    for found in (orbits.fold_of(family, start), orbits.first_event(family, start, -0.9).orbit):
        assert found.excess == pytest.approx(-0.3838388673, abs=1e-9) and found.admissible
        assert np.min(np.abs(found.multipliers - 1.0)) < 1e-6


def test_orbits_run_twice_cross_at_a_branch_point() -> None:
    """p1 under a linear contact doubles its period at 0.0929: p2 ends there, and p1 run twice passes."""
    linear = LinearContact(stiffness=1e6)
    oscillator = modes_on_stop(150.0, 6.0, 1.0, 1.0, law=linear, drive=22.0).with_excess(0.1)
    single, double = (orbits.Shooting(oscillator=oscillator, m=m, impacts=m) for m in (1, 2))
    near, unit = single.at_speed(0.3 * oscillator.unit_speed), oscillator.unit_speed
    doubling = orbits.follow(single, near, low=1e-2 * unit, high=unit).of_kind("period doubling")[0].excess
    apart = double.from_state(replace(settled(oscillator, 0.1).end, time=0.0))
    once = single.at_excess(0.2, near)
    for start in (apart, double.at_speed(once.speed, once)):
        found = orbits.follow_path(oscillator.with_excess, start, start.excess, low=0.01, high=0.3)
        (crossing,) = (event for event in found.events if event.kind == "branch point")
        assert crossing.parameter == pytest.approx(doubling, abs=2e-8)
        assert not [event for event in found.events if event.kind in ("fold", "undecided")]
        assert ("shorter period" in found.ended_low) == (start is apart)


@pytest.mark.parametrize("slopes", [(-2.0, -1.0, 1.0), (-2.0, 0.0, 1.0), (0.0, 1.0, 2.0)])
def test_a_sign_that_changes_at_an_orbit_changes_once(slopes: tuple[float, ...]) -> None:
    """A branch that starts from a fold may have it to the last bit, with a slope of zero."""
    assert [passes(a, b) for a, b in pairwise(slopes)].count(True) == 1
