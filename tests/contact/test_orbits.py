"""Periodic orbits by kicks, by shooting and along branches, against the simulated map and the closed
forms."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from oscillators import apart, equation_1

from beam import ModalModel, single_mode
from contact.drive import HarmonicDrive
from contact.errors import ContactError, NotPeriodic
from contact.laws import (
    ContactLaw,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.maximal_orbits import fold
from contact.nordmark import NordmarkMap
from contact.orbits import (
    KickFamily,
    MaximalFamily,
    PeriodicOrbit,
    Settled,
    Shooting,
    SingleImpactOrbit,
    born,
    fold_along_frequency,
    fold_of,
    folds_of,
    follow,
    lowest_of,
    orbit_end,
    settle,
)
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.strobed_nordmark import StrobedNordmarkMap
from contact.stroboscope import StrobedOrbit, StroboscopicMap
from contact.trajectory import State
from studies.scene import beam_at, hertz_of, model_of, read_scene

T, MU, TAU = 40.80e-3, 3.56, 0.1
HERTZ = HertzContact(stiffness=9.6154e9)
LAWS = {
    "hertz": HERTZ,
    "hunt-crossley": HuntCrossley(stiffness=9.6154e9, dissipation=0.3),
    "linear": LinearContact(stiffness=1.887e7),
    "dashpot": LinearContact(stiffness=1.887e7, damping=68.0),
    "newton": NewtonRestitution(local_restitution=0.3),
}
# f [Hz], m, F_m/F_g - 1, and F/F_g - 1 at which the orbit gains a second impact (its rounding: last digit)
EQUATION_1 = [
    (20.90, 3, -1.2784409283e-3, 0.0891, 1e-4),
    (21.50, 4, -1.32105924246e-2, 0.0101, 1e-4),
    (22.20, 5, -1.4773426733e-3, 0.0273, 1e-4),
    (22.60, 6, -1.6810390565e-4, 0.0250, 1e-4),
    (23.05, 8, -1.2823017008e-4, 0.0133, 1e-4),
    (23.40, 11, -1.0196700981e-3, 0.002274, 1e-6),
]


@pytest.fixture(scope="module")
def spring() -> ModalModel:
    """The letter's spring with all modes of its scene."""
    return model_of(read_scene("letter", []))


def beam(spring: ModalModel, frequency: float, law: ContactLaw, modes: int = 6, ratio: float | None = None):
    """The spring cut to `modes` modes; with `ratio`, that damping ratio in all modes but the first."""
    decay = spring.decay_rate[:modes].copy()
    if ratio is not None:
        decay[1:] = 2.0 * ratio * spring.omega[1:modes]
    model = ModalModel(
        omega=spring.omega[:modes], decay_rate=decay, phi=spring.phi[:modes],
        participation=spring.participation[:modes],
    )
    return ImpactOscillator(
        model=model, stop=Stop(gap=0.0107, law=law), drive=HarmonicDrive(frequency=frequency)
    )


def unit_speed(oscillator: ImpactOscillator) -> float:
    """2 pi f gap [m/s]."""
    return oscillator.drive.angular_frequency * oscillator.stop.gap


def sizes(oscillator: ImpactOscillator) -> np.ndarray:
    """Scales of (q, q') of all modes."""
    model, size = oscillator.model, oscillator.stop.gap / np.abs(oscillator.model.phi).max()
    return np.concatenate([np.full(model.omega.size, size), size * model.omega])


def differences(orbit: PeriodicOrbit) -> tuple[np.ndarray, float]:
    """Multipliers by central differences of the simulated map over m periods, and how well the orbit
    closes."""
    oscillator, n = orbit.oscillator, orbit.oscillator.n_modes
    strobed, scale = StroboscopicMap(oscillator=oscillator), sizes(oscillator)

    def after(point: np.ndarray) -> np.ndarray:
        end = strobed.orbit(State(displacement=point[:n], velocity=point[n:]), orbit.period).end
        return np.concatenate([end.displacement, end.velocity])

    state = orbit.strobe_state()
    point = np.concatenate([state.displacement, state.velocity])
    step = 1e-7 * np.diag(scale)
    columns = [(after(point + h) - after(point - h)) / 2e-7 / scale for h in step]
    return np.linalg.eigvals(np.column_stack(columns)), float(np.max(np.abs(after(point) - point) / scale))


def deviations(orbit: PeriodicOrbit | SingleImpactOrbit) -> np.ndarray:
    return np.concatenate([orbit.displacement, orbit.velocity])


def touches(orbit: PeriodicOrbit) -> int:
    """Touches of the simulated motion from just before the first one to just before it comes again."""
    duration = orbit.period * orbit.oscillator.period * (1 - 1e-6)
    run = simulate(orbit.oscillator, orbit.state(), duration=duration)
    return int(np.count_nonzero(run.impacts.kind == 0))


def settled(oscillator: ImpactOscillator, excess: float, cycles: int = 4000) -> Settled[State]:
    strobed = StroboscopicMap(oscillator=oscillator)
    return settle(strobed.at(excess), strobed.at(-1e-3).steady(), most_cycles=cycles)


# ------------------------------------------------------------------------------------------------- shooting


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("part", [0.02, 0.15])
def test_multipliers_are_those_of_the_simulated_map(spring: ModalModel, name: str, part: float) -> None:
    oscillator = beam(spring, 22.20, LAWS[name])
    orbit = Shooting(oscillator=oscillator, period=5).at_speed(part * unit_speed(oscillator))
    assert orbit.speed == pytest.approx(part * unit_speed(oscillator), rel=1e-12)
    found, open_by = differences(orbit)
    assert open_by < 1e-12
    assert orbit.admissible and touches(orbit) == 1
    assert apart(found, orbit.multipliers) < 1e-6 * max(1.0, abs(orbit.multipliers[0]))
    assert orbit.stable == (np.abs(found).max() < 1) == (part == 0.15)


@pytest.mark.parametrize("modes", [1, 6])
@pytest.mark.parametrize("part", [1e-3, 0.05, 0.2, 0.5])
def test_under_newtons_law_shooting_is_the_closed_form(spring: ModalModel, modes: int, part: float) -> None:
    oscillator = beam(spring, 20.90, LAWS["newton"], modes)
    speed = part * unit_speed(oscillator)
    closed = MaximalFamily.from_oscillator(oscillator, period=3).orbit(speed)
    orbit = Shooting(oscillator=oscillator, period=3).at_speed(speed)
    assert orbit.excess == pytest.approx(closed.excess, abs=1e-14)
    assert orbit.speed == pytest.approx(closed.speed, rel=1e-12)
    assert apart(orbit.multipliers, closed.multipliers) < 1e-11 * max(1.0, abs(orbit.multipliers[0]))
    place = deviations(orbit) - deviations(closed)
    assert np.max(np.abs(place) / sizes(oscillator)) < 1e-16 * max(10.0, 1 / part)
    wave = np.exp(2j * np.pi * oscillator.drive.frequency * np.array([orbit.phase, closed.phase]))
    assert abs(wave[0] - wave[1]) < 1e-12


@pytest.mark.parametrize("modes", [1, 6])
def test_folds_under_newtons_law_are_those_of_the_closed_form(spring: ModalModel, modes: int) -> None:
    oscillator = beam(spring, 20.90, LAWS["newton"], modes)
    closed = MaximalFamily.from_oscillator(oscillator, period=3).fold()
    fold = fold_of(Shooting(oscillator=oscillator, period=3))
    assert fold.excess == pytest.approx(closed.excess, abs=1e-14)
    assert fold.speed == pytest.approx(closed.speed, rel=1e-9)
    assert apart(fold.multipliers, closed.multipliers) < 1e-8


@pytest.mark.parametrize(("frequency", "period", "excess", "second", "digit"), EQUATION_1)
def test_fold_and_second_impact_of_equation_1(
    frequency: float, period: int, excess: float, second: float, digit: float
) -> None:
    oscillator = equation_1(frequency)
    family, unit = Shooting(oscillator=oscillator, period=period), unit_speed(oscillator)
    fold = fold_of(family)
    assert fold.excess == pytest.approx(excess, abs=1e-11 * abs(excess) + 6e-14)
    branch = follow(family, fold, low=0.01 * unit, high=1.5 * unit)
    assert [branch.ended_low, branch.ended_high] == ["range", "range"]
    assert [event.kind for event in branch.events][:2] == ["fold", "grazing"]
    again, graze = (event.orbit for event in branch.events[:2])
    assert again.excess == pytest.approx(excess, abs=1e-13)
    assert abs(graze.excess - second) <= 0.6 * digit
    assert graze.admissible
    for factor, expected in ((1 - 1e-6, 1), (1 + 1e-6, 2)):
        beside = family.at_speed(graze.speed * factor, graze)
        assert touches(beside) == expected
        assert beside.admissible == (expected == 1)


def test_where_contact_is_soft_a_branch_has_several_folds() -> None:
    """The letter's spring with 12 modes at 23.05 Hz: a pair of folds close together, found from no kick fold
    and from any orbit; below them the branch goes on to the graze of a second touch."""
    scene = read_scene("letter", ["modes.count=12"])
    oscillator = beam_at(scene, 23.05, model_of(scene))
    family = Shooting(oscillator=oscillator, period=8)
    upper, lower = folds_of(family)
    assert (upper.excess, lower.excess) == pytest.approx((8.944156e-6, 8.913082e-6), rel=1e-6)
    for orbit in (upper, lower):
        assert orbit.admissible and np.min(np.abs(orbit.multipliers - 1)) < 1e-6
        # one solution of the equations on either side of the fold in speed, at amplitudes on one side only
        beside = [family.at_speed(orbit.speed * factor, orbit).excess for factor in (0.99, 1.01)]
        assert (beside[0] - orbit.excess) * (beside[1] - orbit.excess) > 0
    assert KickFamily(oscillator=oscillator, period=8).fold() is None
    assert fold_of(family).excess == pytest.approx(lower.excess, abs=1e-14)
    far = family.at_speed(0.3 * unit_speed(oscillator))
    assert fold_of(family, far).excess == pytest.approx(lower.excess, abs=1e-14)
    # however long the steps of the branch
    for step in (0.05, 0.21, 0.47):
        branch = follow(family, far, low=1e-3 * unit_speed(oscillator), high=2 * far.speed, step=step)
        assert [orbit.excess for orbit in branch.of_kind("fold")] == pytest.approx(
            [upper.excess, lower.excess], abs=1e-14
        )
    lowest = lowest_of(family)
    assert lowest.kind == "grazing" and lowest.orbit.excess == pytest.approx(1.308624e-6, rel=1e-6)
    assert [touches(family.at_speed(lowest.orbit.speed * x, lowest.orbit)) for x in (1.001, 0.999)] == [1, 2]


def test_below_its_lowest_fold_a_branch_can_go_on_to_a_graze() -> None:
    """A straight leaf with a ball of 2 g, 20 modes, 23.05 Hz: p8 folds at 1.17e-6, turns at 2.99e-6 and lives
    on, stable, to 4.6e-7; there settled motions say so, too."""
    thickness = "spring.thickness_m=0.9439314446e-3"  # the period of the letter, 40.80 ms
    scene = read_scene(
        "letter", ["modes.count=20", "spring.kind=cantilever", "tip.mass_kg=0.002", thickness]
    )
    oscillator = beam_at(scene, 23.05, model_of(scene))
    family = Shooting(oscillator=oscillator, period=8)
    upper, lower = folds_of(family)
    assert upper.speed < lower.speed and lower.excess < upper.excess
    assert (upper.excess, lower.excess) == pytest.approx((2.98682e-6, 1.17366e-6), rel=1e-4)
    assert fold_of(family).excess == pytest.approx(lower.excess, abs=1e-14)
    lowest = lowest_of(family)
    assert lowest.kind == "grazing" and lowest.orbit.excess == pytest.approx(4.6325e-7, rel=1e-4)
    start = family.at_speed(1.02 * lowest.orbit.speed, lowest.orbit)
    assert start.stable and lowest.orbit.excess < start.excess < lower.excess
    strobed = StroboscopicMap(oscillator=oscillator)
    for part, impacts in ((1.2, 1), (1.01, 1), (0.99, 2)):
        excess = part * lowest.orbit.excess
        run = settle(
            strobed.at(excess), start.strobe_state(), most_cycles=4000, tolerance=1e-3 * excess, prove=False
        )
        assert (run.period, run.impacts) == (8, impacts)


def test_in_the_usual_case_the_lowest_orbit_is_the_fold(spring: ModalModel) -> None:
    family = Shooting(oscillator=beam(spring, 22.20, HERTZ), period=5)
    fold, lowest = fold_of(family), lowest_of(family)
    assert lowest.kind == "fold" and lowest.orbit.excess == fold.excess < -1e-4
    assert min(orbit.excess for orbit in folds_of(family)) == pytest.approx(fold.excess, abs=1e-14)


def test_one_amplitude_has_an_orbit_on_each_arm() -> None:
    oscillator = equation_1(21.50)
    family = Shooting(oscillator=oscillator, period=4)
    closed = MaximalFamily.from_oscillator(oscillator, period=4)
    fold = fold_of(family)
    for excess in (0.2 * fold.excess, 0.9 * fold.excess):
        low, high = closed.orbits(excess)
        for arm, near in ((low, 0.99 * low.speed), (high, 1.01 * high.speed)):
            orbit = family.at_excess(excess, family.at_speed(near))
            assert orbit.excess == pytest.approx(excess, abs=1e-12)
            assert orbit.speed == pytest.approx(arm.speed, rel=1e-10)
            assert orbit.stable == (arm is high) == (orbit.slope > 0)
    with pytest.raises(NotPeriodic):
        family.at_excess(1.1 * fold.excess, fold)


def test_the_slope_is_the_derivative_of_the_excess(spring: ModalModel) -> None:
    oscillator = beam(spring, 22.20, HERTZ)
    family, v = Shooting(oscillator=oscillator, period=5), 0.08 * unit_speed(oscillator)
    middle = family.at_speed(v)
    ends = [family.at_speed(v * factor, middle).excess for factor in (1 - 1e-4, 1 + 1e-4)]
    assert middle.slope == pytest.approx((ends[1] - ends[0]) / (2e-4 * v), rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_orbits_are_found_down_to_grazing(spring: ModalModel, name: str) -> None:
    oscillator = beam(spring, 22.20, LAWS[name])
    family, unit = Shooting(oscillator=oscillator, period=5), unit_speed(oscillator)
    excesses = []
    orbit = family.at_speed(1e-2 * unit)
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


def test_a_neighbour_near_grazing_is_not_taken_for_the_orbit_asked_for() -> None:
    """Speeds that differ by less than the tolerance of the residual are different orbits all the same."""
    oscillator = equation_1(21.50)
    family, unit = Shooting(oscillator=oscillator, period=4), unit_speed(oscillator)
    start = family.at_speed(1.68e-6 * unit)
    near = family.at_speed(1.68e-6 * unit * (1 + 1e-7), start)
    assert near.speed / start.speed - 1 == pytest.approx(1e-7, rel=1e-2)
    branch = follow(family, family.at_speed(1e-5 * unit), low=1e-6 * unit, high=1e-4 * unit)
    assert branch.events == () and branch.ended_low == branch.ended_high == "range"


@pytest.mark.parametrize("name", ["hertz", "linear", "newton"])
def test_the_determinant_is_the_decay_of_area_and_the_law(spring: ModalModel, name: str) -> None:
    """Divergence -sum c_k everywhere, contact forces that depend on place alone add none; Newton's law
    reflects: its saltation matrix [[P, 0], [X, P]] has det P = -e."""
    oscillator = beam(spring, 20.90, LAWS[name], modes=3)
    orbit = Shooting(oscillator=oscillator, period=3).at_speed(0.1 * unit_speed(oscillator))
    expected = math.exp(-oscillator.model.decay_rate.sum() * 3 * oscillator.period)
    if name == "newton":
        expected *= LAWS["newton"].local_restitution ** 2
    assert np.prod(orbit.multipliers) == pytest.approx(expected, rel=1e-9)


def test_the_determinant_counts_the_dashpot_while_it_pushes(spring: ModalModel) -> None:
    """The divergence in contact has -c phi.phi more, until the force has come down to zero."""
    oscillator = beam(spring, 20.90, LAWS["dashpot"], modes=3)
    free = oscillator.model.decay_rate.sum() * 3 * oscillator.period
    mass = 1 / float(oscillator.model.phi @ oscillator.model.phi)
    # half a period of that mass on spring and dashpot, less the part in which the force would pull
    natural, half = math.sqrt(LAWS["dashpot"].stiffness / mass), LAWS["dashpot"].damping / (2 * mass)
    damped = math.sqrt(natural**2 - half**2)
    pushes = (math.pi - math.atan2(2 * half * damped, natural**2 - 2 * half**2)) / damped
    missing = []
    for part in (0.25, 0.5, 1.0):
        orbit = Shooting(oscillator=oscillator, period=3).at_speed(part * unit_speed(oscillator))
        decay = -math.log(abs(np.prod(orbit.multipliers)))
        missing.append(1 - (decay - free) * mass / (LAWS["dashpot"].damping * pushes))
    # the spring's own force, 2 a/(w v), shortens the contact
    assert missing[2] < 4e-3
    assert missing[0] / missing[1] == pytest.approx(2, rel=0.1)
    assert missing[1] / missing[2] == pytest.approx(2, rel=0.1)


# ---------------------------------------------------------------------------------------------------- kicks


@pytest.mark.parametrize("modes", [1, 6])
def test_kicks_are_exact_under_newtons_law(spring: ModalModel, modes: int) -> None:
    oscillator = beam(spring, 20.90, LAWS["newton"], modes)
    kicks = KickFamily(oscillator=oscillator, period=3)
    closed = MaximalFamily.from_oscillator(oscillator, period=3)
    for part in (1e-4, 0.05, 0.5):
        speed = part * unit_speed(oscillator)
        found, expected = kicks.orbit(speed), closed.orbit(speed)
        assert found.excess == pytest.approx(expected.excess, abs=1e-14)
        assert found.phase == pytest.approx(expected.phase, abs=1e-13)
        assert np.max(np.abs(deviations(found) - deviations(expected)) / sizes(oscillator)) < 1e-14
        assert abs(kicks.error(found)) < 1e-14
        assert found.kick.touches == 1 and found.kick.duration == 0.0
    assert kicks.fold().excess == pytest.approx(closed.fold().excess, abs=1e-13)


@pytest.mark.parametrize("ratio", [None, 1e-3], ids=["the letter's strips", "ringing"])
@pytest.mark.parametrize(("frequency", "period"), [(20.90, 3), (21.50, 4), (22.20, 5)])
def test_kicks_foretell_their_own_error(
    spring: ModalModel, ratio: float | None, frequency: float, period: int
) -> None:
    oscillator = beam(spring, frequency, hertz_of(read_scene("letter", [])), ratio=ratio)
    family = Shooting(oscillator=oscillator, period=period)
    kicks, unit = family.kicks, unit_speed(oscillator)
    errors = []
    for part in (0.05, 0.1, 0.3):
        guess = kicks.orbit(part * unit)
        true = family.at_speed(part * unit).excess - guess.excess
        assert kicks.error(guess) == pytest.approx(true, rel=0.03)
        errors.append(abs(true))
    assert errors[0] < errors[1] < errors[2]
    assert errors[2] > 3e-6  # there is something to foretell


@pytest.mark.parametrize(("frequency", "period"), [(20.90, 3), (22.20, 5)])
def test_folds_against_a_downward_scan(spring: ModalModel, frequency: float, period: int) -> None:
    oscillator = beam(spring, frequency, HERTZ, modes=4)
    start = settled(oscillator, 1e-3)
    assert (start.period, start.impacts) == (period, 1)
    end = orbit_end(
        StroboscopicMap(oscillator=oscillator), start.end, 1e-3, most_cycles=10000, relative=1e-2
    )
    fold = fold_of(Shooting(oscillator=oscillator, period=period))
    assert end.lost < fold.excess < end.held
    assert end.kind == "fold" and end.excess == pytest.approx(fold.excess, abs=1e-14)
    assert apart(fold.multipliers[:1], np.ones(1)) < 1e-7
    kick = KickFamily(oscillator=oscillator, period=period).fold()
    assert kick.excess == pytest.approx(fold.excess, rel=0.015)
    assert kick.kick.speed == pytest.approx(fold.speed, rel=0.05)


def test_an_end_by_period_doubling_is_named_and_exact() -> None:
    """p1 of a hard wall of restitution 0.7: the scan downwards ends where a multiplier passes -1."""
    oscillator = equation_1(20.90, NewtonRestitution(local_restitution=0.7))
    family, unit = Shooting(oscillator=oscillator, period=1), unit_speed(oscillator)
    branch = follow(family, family.at_speed(1.0 * unit), low=0.5 * unit, high=1.5 * unit)
    (doubled,) = branch.of_kind("period doubling")
    start = family.at_speed(1.1 * doubled.speed, doubled)
    end = orbit_end(
        StroboscopicMap(oscillator=oscillator), start.strobe_state(), start.excess, most_cycles=4000
    )
    assert end.kind == "period doubling" and end.lost < end.excess < end.held
    assert end.excess == pytest.approx(doubled.excess, rel=1e-9)


def test_an_orbit_doubles_its_period_before_a_hard_touch_is_lost() -> None:
    """Eq. (1), 20.90 Hz: p3 has a second touch above 0.0891 and would lose it there on the way down, but next
    to the graze its derivative has no bound, and it doubles its period just before."""
    oscillator = equation_1(20.90)
    single = Shooting(oscillator=oscillator, period=3)
    (graze,) = follow(single, single.at_speed(100.0), low=90.0, high=140.0).of_kind("grazing")
    strobed = StroboscopicMap(oscillator=oscillator)
    end = orbit_end(strobed, settled(oscillator, 0.1).end, 0.1, most_cycles=4000)
    assert (end.impacts, end.kind) == (2, "period doubling") and end.lost < end.excess < end.held
    assert 0.0 < end.excess / graze.excess - 1.0 < 0.02


@pytest.mark.parametrize("first_step", [1e-6, 2e-4, 5e-2])
@pytest.mark.parametrize("relative", [0.03, 1e-3])
def test_no_bracket_closes_because_a_long_step_fell_off(first_step: float, relative: float) -> None:
    """The exact end lies in the bracket, which one last step has made, however the scan came there."""
    for frequency, period, excess, _second, _digit in EQUATION_1:
        oscillator = equation_1(frequency)
        nordmark = NordmarkMap.from_oscillator(oscillator)
        for strobed, exact in (
            (StroboscopicMap(oscillator=oscillator), excess),
            (StrobedNordmarkMap(map=nordmark), nordmark.excess(fold(nordmark, period).rho)),
        ):
            start = born(strobed)
            end = orbit_end(
                strobed, start.end, 1e-3, most_cycles=1000, relative=relative, first_step=first_step
            )
            assert (end.period, end.impacts, end.kind) == (period, 1, "fold")
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

        def orbit(self, state: float, count: int) -> StrobedOrbit[float]:
            points = np.empty((count, 1))
            for i in range(count):
                state = state * state + self.c
                points[i] = state
            return StrobedOrbit(end=state, points=points, impacts=np.ones(count, dtype=int))

    end = orbit_end(Square(0.0), -0.4, 0.3, most_cycles=20_000, absolute=1e-2)
    assert (end.period, end.kind) == (1, "bracket")
    assert end.lost < 0.0 < end.held and end.held - end.lost < 1.01e-2


def test_one_mode_of_the_kick_is_not_the_whole_of_it(spring: ModalModel) -> None:
    """With modes that ring on, the letter's two parameters are off where the kick of all modes is not."""
    oscillator = beam(spring, 20.90, HERTZ, ratio=1e-3)
    family, speed = Shooting(oscillator=oscillator, period=3), 0.1 * unit_speed(oscillator)
    exact = family.at_speed(speed).excess
    kicks, mask = family.kicks, np.eye(oscillator.n_modes)[:1].T
    first = replace(kicks, collision=lambda v: replace(kicks.kick(v), jump=mask * kicks.kick(v).jump))
    assert np.all(first.kick(speed).jump[1:] == 0.0)
    assert abs(first.orbit(speed).excess - exact) > 5 * abs(family.kicks.orbit(speed).excess - exact)


def test_a_narrow_range_or_a_wrong_band_has_no_kick_fold() -> None:
    kicks = KickFamily(oscillator=equation_1(20.90), period=3)
    at = kicks.fold().kick.speed / unit_speed(kicks.oscillator)
    assert kicks.fold(speeds=(1.5 * at, 1.0)) is None
    assert kicks.fold(speeds=(1e-4, 0.7 * at)) is None
    other = KickFamily(oscillator=equation_1(20.90), period=1)
    assert other.fold() is None and fold_of(Shooting(oscillator=equation_1(20.90), period=1)) is None


# ------------------------------------------------------------------------------------------------- branches


def test_soft_wall_doubles_its_period_where_theory_says() -> None:
    """A wall of slope K Omega^2 is smooth at first: p1 lives on above grazing until a multiplier is -1."""
    f, model = 20.90, single_mode(free_period=T, decay_rate=MU)
    w, stiff = 2 * math.pi * f, float(model.omega[0]) ** 2
    gamma = math.exp(-MU / f)
    alpha = 2 * math.sqrt(gamma) * math.cos(2 * math.pi / (f * T))
    flow = math.sqrt(gamma) * math.sin(2 * math.pi / (f * T)) * T / (2 * math.pi)
    errors = []
    for ratio in (1e2, 1e3, 1e4):
        oscillator = equation_1(f, LinearContact(stiffness=(ratio - 1) * stiff))
        family = Shooting(oscillator=oscillator, period=1)
        branch = follow(family, family.at_speed(1e-4 * w), low=1e-5 * w, high=0.1 * w, step=0.2)
        (orbit,) = branch.of_kind("period doubling")
        assert np.min(np.abs(orbit.multipliers + 1)) < 1e-6
        assert orbit.admissible
        height = 0.5 * w**2 * ((1 + gamma + alpha) / (2 * flow * ratio * stiff)) ** 2
        theory = height * (1 + (2 / 3) * (1 + gamma + alpha) / (1 - alpha + gamma))
        errors.append(orbit.excess / theory - 1)
        beside = [family.at_speed(orbit.speed * factor, orbit) for factor in (0.99, 1.01)]
        assert beside[0].stable and not beside[1].stable
        assert branch.of_kind("fold") == []
    assert errors[2] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.15)


def test_doubling_of_a_hard_orbit_is_seen_by_simulation() -> None:
    oscillator = equation_1(20.90, NewtonRestitution(local_restitution=0.7))
    family, unit = Shooting(oscillator=oscillator, period=1), unit_speed(oscillator)
    branch = follow(family, family.at_speed(1.0 * unit), low=0.5 * unit, high=1.5 * unit)
    (orbit,) = branch.of_kind("period doubling")
    assert np.min(np.abs(orbit.multipliers + 1)) < 1e-9
    for factor, repeats in ((0.98, False), (1.02, True)):
        beside = family.at_speed(factor * orbit.speed, orbit)
        assert beside.stable == repeats
        start = beside.strobe_state()
        pushed = State(displacement=start.displacement * (1 + 1e-6), velocity=start.velocity)
        points = StroboscopicMap(oscillator=beside.oscillator).orbit(pushed, 400).points
        away = np.abs(points[:, 0] - start.displacement[0])
        assert (away[-1] < 1e-8) == repeats
        assert (away[200] > away[100]) == (not repeats)


def test_the_events_of_a_branch_of_the_beam(spring: ModalModel) -> None:
    """Hertz: next to grazing the orbit of period m touches at every period, and has a fold of its own
    there."""
    oscillator = beam(spring, 22.20, HERTZ)
    family, unit = Shooting(oscillator=oscillator, period=5), unit_speed(oscillator)
    branch = follow(family, family.at_speed(0.1 * unit), low=1e-5 * unit, high=1.5 * unit)
    speeds = [orbit.speed for orbit in branch.orbits]
    assert speeds == sorted(speeds)
    assert [event.kind for event in branch.events] == ["grazing", "fold", "fold", "grazing"]
    for orbit in branch.of_kind("fold"):
        assert abs(orbit.slope) * unit < 1e-9
        assert np.min(np.abs(orbit.multipliers - 1)) < 1e-6
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
    family = Shooting(oscillator=oscillator.with_excess(0.1), period=3, impacts=2)
    start = family.from_state(run.end)
    branch = follow(family, start, low=0.9 * start.speed, high=2.0 * start.speed)
    assert branch.ended_low == "range"
    assert "an orbit of period 3 with 2 touches was lost" in branch.ended_high
    last = branch.orbits[-1]
    assert f"{last.speed:.6g} m/s" in branch.ended_high and f"{last.excess:.6g}" in branch.ended_high
    assert last.residual < 1e-9 and last.approach[1] < 5e-3 * last.approach[0]
    # there the orbit of one impact has its grazing
    single = Shooting(oscillator=oscillator, period=3)
    (graze,) = follow(single, single.at_speed(100.0), low=90.0, high=140.0).of_kind("grazing")
    assert last.speed == pytest.approx(graze.speed, rel=1e-5)
    assert last.excess == pytest.approx(graze.excess, rel=1e-5)
    with pytest.raises(ContactError, match="lost"):
        family.at_speed(1.02 * last.speed, last)


def test_folds_along_frequency_are_those_of_each_frequency() -> None:
    oscillator = equation_1(21.40)
    frequencies = np.array([21.40, 21.45, 21.50])
    found = fold_along_frequency(Shooting(oscillator=oscillator, period=4), frequencies)
    for frequency, orbit in zip(frequencies, found, strict=True):
        closed = MaximalFamily.from_oscillator(equation_1(frequency), period=4).fold()
        assert orbit.excess == pytest.approx(closed.excess, abs=1e-13)
        assert orbit.oscillator.drive.frequency == frequency
    nothing = fold_along_frequency(Shooting(oscillator=oscillator, period=1), np.array([20.90]))
    assert nothing == [None]


# ---------------------------------------------------------------------------------------------- two touches


@pytest.mark.parametrize(
    ("name", "frequency", "excess", "period", "impacts"),
    [
        ("equation 1", 20.90, 0.1, 3, 2),
        ("equation 1", 21.50, 0.011, 8, 3),
        ("equation 1", 21.50, 0.02, 4, 2),
        ("beam", 20.90, 0.1, 3, 2),
        ("beam", 21.50, 0.02, 4, 2),
    ],
)
def test_orbits_with_several_touches(
    spring: ModalModel, name: str, frequency: float, excess: float, period: int, impacts: int
) -> None:
    oscillator = equation_1(frequency) if name == "equation 1" else beam(spring, frequency, HERTZ, modes=4)
    run = settled(oscillator, excess)
    assert (run.period, run.impacts) == (period, impacts)
    family = Shooting(oscillator=oscillator.with_excess(excess), period=period, impacts=impacts)
    orbit = family.from_state(run.end)
    assert orbit.excess == pytest.approx(excess, abs=1e-14)
    assert orbit.residual < 1e-12 and orbit.admissible and orbit.stable
    assert touches(orbit) == impacts == len(orbit.approach)
    last = simulate(orbit.oscillator, orbit.state(), duration=period * oscillator.period * (1 - 1e-6))
    assert np.allclose(last.impacts.approach[last.impacts.kind == 0], orbit.approach, rtol=1e-10)
    found, open_by = differences(orbit)
    assert open_by < 1e-10
    assert apart(found, orbit.multipliers) < 1e-6
    # the same orbit by its speed
    assert family.at_speed(orbit.speed, orbit).excess == pytest.approx(excess, abs=1e-12)


# ------------------------------------------------------------------------------------------------ wrong use


def test_orbits_repeat_bit_for_bit_beside_other_threads(spring: ModalModel) -> None:
    """Compiled code owns the memory it works in: eight of a thousand orbits once differed in their digits."""
    oscillator = beam(spring, 20.90, HERTZ, modes=12)
    start = Shooting(oscillator=oscillator, period=3).at_speed(0.1 * unit_speed(oscillator))

    def again(_number: int) -> tuple[float, float, bytes]:
        orbit = Shooting(oscillator=oscillator, period=3).at_speed(1.001 * start.speed, start)
        return orbit.excess, orbit.phase, orbit.multipliers.tobytes()

    with ThreadPoolExecutor(3) as pool:
        assert set(pool.map(again, range(1000))) == {again(0)}


def test_a_motion_without_impacts_starts_no_search() -> None:
    oscillator = equation_1(20.90).with_excess(-0.01)
    with pytest.raises(NotPeriodic, match="no impact"):
        Shooting(oscillator=oscillator, period=3).from_state(StroboscopicMap(oscillator=oscillator).steady())
