"""One contract for every family of periodic orbits: closed forms, kicks, shooting and the Nordmark map."""

from __future__ import annotations

import numpy as np
import pytest
from oscillators import MODES

from beam import ModalModel, single_mode
from contact import (
    HarmonicDrive,
    HuntCrossley,
    ImpactOscillator,
    MapFamily,
    MaximalFamily,
    NewtonRestitution,
    NordmarkMap,
    Stop,
)
from contact.orbits import KickFamily, Shooting
from contact.orbits.continuation import fold_of
from contact.orbits.family import Family

T, MU, TAU, GAP = 0.0408, 3.56, 0.1, 0.0107
PLACES = [(20.90, 3), (21.50, 4), (22.20, 5)]


def oscillator(frequency: float) -> ImpactOscillator:
    return ImpactOscillator(
        model=single_mode(free_period=T, decay_rate=MU),
        stop=Stop(gap=GAP, law=NewtonRestitution(local_restitution=TAU)),
        drive=HarmonicDrive(frequency=frequency),
    )


MAKERS = {
    "closed form": lambda at, period: MaximalFamily.from_oscillator(at, period=period),
    "kicks": lambda at, period: KickFamily(oscillator=at, period=period),
    "shooting": lambda at, period: Shooting(oscillator=at, period=period),
    "map": lambda at, period: MapFamily(NordmarkMap.from_oscillator(at), period),
}


@pytest.fixture(
    scope="module", params=[*((name, *place) for name in MAKERS for place in PLACES), *MODES], ids=str
)
def family(request) -> Family:
    """Of Eq. (1) in each description; of many modes in closed form."""
    if request.param in MODES:
        model = ModalModel(**{key: np.array(value) for key, value in MODES[request.param].items()})
        stop = Stop(gap=0.012, law=NewtonRestitution(local_restitution=0.35))
        many = ImpactOscillator(model=model, stop=stop, drive=HarmonicDrive(frequency=20.5))
        return MaximalFamily(oscillator=many, period=3)
    name, frequency, period = request.param
    return MAKERS[name](oscillator(frequency), period)


def test_an_orbit_has_the_speed_it_was_asked_for(family: Family) -> None:
    fold = family.fold()
    for part in (0.5, 1.0, 2.0):
        orbit = family.orbit(part * fold.speed)
        assert orbit.speed == pytest.approx(part * fold.speed, rel=1e-12)
        assert orbit.period == family.period == fold.period


def test_the_fold_has_the_least_excess_and_a_multiplier_one(family: Family) -> None:
    fold = family.fold()
    assert fold.excess < min(family.orbit(part * fold.speed).excess for part in (0.99, 1.01))
    assert fold.admissible
    assert np.min(np.abs(fold.multipliers - 1.0)) < 1e-6


def test_above_the_fold_are_a_saddle_and_a_node_and_below_it_nothing(family: Family) -> None:
    fold = family.fold()
    assert family.orbits(1.1 * fold.excess) == ()
    saddle, node = family.orbits(0.9 * fold.excess)
    assert saddle.speed < fold.speed < node.speed
    assert len(family.orbits(0.01)) == 1
    for orbit in (saddle, node):
        assert orbit.excess == pytest.approx(0.9 * fold.excess, rel=1e-8)
    assert node.stable and not saddle.stable and node.admissible


def test_multipliers_fall_in_size_and_tell_stability(family: Family) -> None:
    fold = family.fold()
    for part in (0.1, 0.7, 1.5):
        orbit = family.orbit(part * fold.speed)
        sizes = np.abs(orbit.multipliers)
        assert np.all(np.diff(sizes) <= 0.0) and orbit.stable == (sizes[0] < 1.0) == (part > 1.0)


def test_past_the_band_there_is_no_fold_and_one_orbit_above_grazing_only() -> None:
    for make in MAKERS.values():
        family = make(oscillator(21.05), 3)  # p3 is born up to 21.008 Hz
        assert family.fold() is None
        assert family.orbits(-1e-4) == () and len(family.orbits(1e-3)) == 1


@pytest.mark.parametrize(("frequency", "period"), PLACES)
def test_under_newtons_law_three_descriptions_are_one(frequency: float, period: int) -> None:
    at = oscillator(frequency)
    closed, *others = (MAKERS[name](at, period) for name in ("closed form", "kicks", "shooting"))
    for other in others:
        assert other.fold().excess == pytest.approx(closed.fold().excess, abs=1e-12)
        for wanted, found in zip(closed.orbits(1e-3), other.orbits(1e-3), strict=True):
            assert found.speed == pytest.approx(wanted.speed, rel=1e-9)
            assert found.amplitude == pytest.approx(wanted.amplitude, rel=1e-12)
            assert found.phase == pytest.approx(wanted.phase, abs=1e-12)
            assert found.multipliers == pytest.approx(wanted.multipliers, abs=1e-7)
            assert (found.stable, found.admissible) == (wanted.stable, wanted.admissible)


def test_the_fold_of_shooting_is_that_of_the_continuation() -> None:
    family = Shooting(oscillator=oscillator(21.50), period=4)
    assert family.fold().speed == fold_of(family).speed


def test_the_multipliers_of_a_kick_orbit_are_those_of_its_own_touch() -> None:
    """At the fold of the kicks of a soft wall the motion is all but at its own: a multiplier next to one."""
    at = ImpactOscillator(
        model=single_mode(free_period=T, decay_rate=MU), drive=HarmonicDrive(frequency=21.50),
        stop=Stop(gap=GAP, law=HuntCrossley.with_restitution(stiffness=1e9, restitution=TAU, velocity=0.2)),
    )  # fmt: skip
    kick, exact = (make(oscillator=at, period=4).fold() for make in (KickFamily, Shooting))
    assert kick.excess == pytest.approx(exact.excess, rel=0.1)
    assert kick.multipliers[0] == pytest.approx(1.0, abs=0.05) and kick.admissible
