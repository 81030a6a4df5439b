"""One contract for every family of periodic orbits: closed forms, kicks, shooting and the Nordmark map.

Where several describe the same motion their orbits are one, and each is an orbit of the simulated motion.
"""

import math
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np
import pytest
from letters_spring import FOLDED_GAP, HERTZ, folded_strip
from oscillators import MODES, apart, equation_1, many_modes
from simulated_orbit import DELAYED, LAWS, beam, differences, on_stop, settled, sizes, touches

import contact
from contact.orbits import Family, KickFamily, Orbit, Shooting

UNDELAYED = contact.DelayedRestitution(restitution=0.1, delay=0.0)
PLACES = [(20.90, 3), (21.50, 4), (22.20, 5), (23.40, 11)]
one_mode = partial(equation_1, gap=0.0107)

MAKERS = {
    "closed form": lambda at, m: contact.MaximalFamily.from_oscillator(at, m=m),
    "kicks": lambda at, m: KickFamily(oscillator=at, m=m),
    "shooting": lambda at, m: Shooting(oscillator=at, m=m),
    "map": lambda at, m: contact.MapFamily(contact.NordmarkMap.from_oscillator(at), m),
}
OSCILLATORS = {
    **{f"Newton, {f} Hz": (one_mode(f), m) for f, m in PLACES},
    **{f"no delay, {f} Hz": (one_mode(f, UNDELAYED), m) for f, m in PLACES},
    **{f"{name}, {f} Hz": (one_mode(f, law), m) for name, law in DELAYED.items() for f, m in PLACES[:3]},
    **{name: (many_modes(name), 3) for name in MODES},
    "ten modes": (beam(20.90, LAWS["newton"]), 3),
    **{f"ten modes, {name}": (beam(22.20, law), 5) for name, law in LAWS.items()},
}
CONTRACT = [
    *((name, f"Newton, {f} Hz") for name in MAKERS for f, _ in PLACES[:3]),
    *(("closed form", name) for name in MODES),
    *((name, f"{law}, 21.5 Hz") for name in ("kicks", "shooting") for law in ("constant", "falling")),
    ("shooting", "ten modes, hertz"),
]
ALWAYS = ("closed form", "kicks", "map", ("shooting", "Newton, 21.5 Hz"), ("shooting", "ten modes, hertz"))


def long(cases: Iterable, always: Callable[[Any], bool]) -> list:
    """The cases, of which some always run and the others are slow."""
    return [case if always(case) else pytest.param(case, marks=pytest.mark.slow) for case in cases]


def quick(name: str) -> bool:
    """Each law at one frequency."""
    return "Hz" not in name or "21.5" in name


@pytest.fixture(
    scope="module", params=long(CONTRACT, lambda case: case[0] in ALWAYS or case in ALWAYS), ids=str
)
def found(request) -> tuple[Family, Orbit]:
    """A family and its fold: of Eq. (1) in each description, with a touch that waits; of many modes."""
    name, at = request.param
    family = MAKERS[name](*OSCILLATORS[at])
    return family, family.fold()


def test_an_orbit_has_the_speed_that_was_given(found: tuple[Family, Orbit]) -> None:
    family, fold = found
    for part in (0.5, 1.0, 2.0):
        orbit = family.orbit(part * fold.speed)
        assert orbit.speed == pytest.approx(part * fold.speed, rel=1e-12)
        assert orbit.m == family.m == fold.m


def test_the_fold_has_the_least_excess_and_a_multiplier_one(found: tuple[Family, Orbit]) -> None:
    family, fold = found
    assert fold.excess < min(family.orbit(part * fold.speed).excess for part in (0.99, 1.01))
    assert fold.admissible and np.min(np.abs(fold.multipliers - 1.0)) < 1e-6


def test_above_the_fold_are_a_saddle_and_a_node_and_below_it_nothing(found: tuple[Family, Orbit]) -> None:
    family, fold = found
    assert family.orbits(1.1 * fold.excess) == ()
    saddle, node = family.orbits(0.9 * fold.excess)
    assert saddle.speed < fold.speed < node.speed and len(family.orbits(0.01)) == 1
    for orbit in (saddle, node):
        assert orbit.excess == pytest.approx(0.9 * fold.excess, rel=1e-8)
    assert node.stable and not saddle.stable and node.admissible
    apart = (node.speed - saddle.speed) / math.sqrt(0.1)
    for part in (1e-2, 1e-4, 1e-6):  # between two steps of the branch; speeds part as the square root
        low, high = family.orbits((1.0 - part) * fold.excess)
        assert (high.speed - low.speed) / math.sqrt(part) == pytest.approx(apart, rel=0.1)


def test_multipliers_fall_in_size_and_tell_stability(found: tuple[Family, Orbit]) -> None:
    family, fold = found
    for part in (0.1, 0.7, 1.5):
        orbit = family.orbit(part * fold.speed)
        sizes = np.abs(orbit.multipliers)
        assert np.all(np.diff(sizes) <= 0.0) and orbit.stable == (sizes[0] < 1.0) == (part > 1.0)


def test_past_the_band_there_is_no_fold_and_one_orbit_above_grazing_only() -> None:
    for make in MAKERS.values():
        family = make(one_mode(21.05), 3)  # p3 is born up to 21.008 Hz
        assert family.fold() is None
        assert family.orbits(-1e-4) == () and len(family.orbits(1e-3)) == 1


def descriptions(oscillator: contact.ImpactOscillator, period: int) -> list[Family]:
    """All that hold for this law, the one in closed form first."""
    law, others = oscillator.stop.law, [MAKERS[name](oscillator, period) for name in ("kicks", "shooting")]
    if law is UNDELAYED:
        oscillator = one_mode(oscillator.drive.frequency)
    elif not isinstance(law, contact.NewtonRestitution):
        return others
    return [MAKERS["closed form"](oscillator, period), *others]


@pytest.mark.parametrize("name", long((n for n in OSCILLATORS if not n.startswith("ten modes,")), quick))
def test_where_several_descriptions_hold_they_are_one(name: str) -> None:
    """Under Newton's law, and where the touch of one mode waits."""
    oscillator, period = OSCILLATORS[name]
    closed, *others = descriptions(oscillator, period)
    w, scale = oscillator.drive.angular_frequency, sizes(oscillator)
    for part in (1e-3, 0.03, 0.1, 0.3, 0.5):
        wanted = closed.orbit(part * oscillator.unit_speed)
        for other in others:
            found = other.orbit(part * oscillator.unit_speed)
            if isinstance(other, KickFamily) and found.kick.impacts > 1:
                continue  # the kick is that of the whole collision
            digits = 1e-15 / part + 1e-13
            assert found.excess == pytest.approx(wanted.excess, abs=digits)
            assert abs(np.exp(1j * w * (found.phase - wanted.phase)) - 1.0) < digits
            place = [np.concatenate([one.displacement, one.velocity]) for one in (found, wanted)]
            assert np.max(np.abs(place[0] - place[1]) / scale) < digits
            assert apart(found.multipliers, wanted.multipliers) < 1e-12 / part**2
            assert found.admissible == wanted.admissible
    folds = [one.fold() for one in (closed, *others)]
    for fold in folds if folds[0] else ():
        assert fold.excess == pytest.approx(folds[0].excess, abs=1e-13)
        assert fold.speed == pytest.approx(folds[0].speed, rel=1e-6)
    assert folds[0] or not any(folds)


@pytest.mark.parametrize("name", long(OSCILLATORS, quick))
def test_an_orbit_is_one_of_the_simulated_motion(name: str) -> None:
    """It closes, has the multipliers of the simulated map, and is admissible if it touches once."""
    oscillator, period = OSCILLATORS[name]
    family, seen = Shooting(oscillator=oscillator, m=period), []
    for part in (0.02, 0.1, 0.15, 0.3, 0.5, 1.5):
        orbit = family.orbit(part * oscillator.unit_speed)
        assert orbit.admissible == (touches(orbit) == 1)
        if not orbit.admissible:
            continue
        found, open_by = differences(orbit)
        assert open_by < 1e-11
        assert apart(found, orbit.multipliers) < 1e-6 * max(1.0, abs(orbit.multipliers[0]))
        assert orbit.stable == (np.abs(found).max() < 1)
        seen.append(orbit.stable)
    assert seen


WAITS = one_mode(22.20, contact.DelayedRestitution(restitution=0.1, delay=2e-3))
SEVERAL = [(one_mode(20.90), 0.1, 3, 2), (one_mode(21.50), 0.011, 8, 3), (one_mode(21.50), 0.02, 4, 2)]
SEVERAL += [(on_stop(folded_strip(4), 20.90, gap=FOLDED_GAP), 0.1, 3, 2)]
SEVERAL += [(beam(21.50, HERTZ, modes=4), 0.02, 8, 3), (WAITS, 1e-4, 6, 2), (WAITS, 1e-3, 6, 2)]


@pytest.mark.parametrize(("oscillator", "excess", "period", "impacts"), SEVERAL)
def test_orbits_with_several_touches(oscillator, excess, period, impacts):
    run = settled(oscillator, excess)
    assert (run.m, run.impacts) == (period, impacts)
    family = Shooting(oscillator=oscillator.with_excess(excess), m=period, impacts=impacts)
    orbit = family.from_state(run.end)
    assert orbit.excess == pytest.approx(excess, abs=1e-14)
    assert orbit.residual < 1e-12 and orbit.admissible and orbit.stable
    assert touches(orbit) == impacts == len(orbit.approach)
    last = contact.simulate(orbit.oscillator, orbit.state(), duration=period * oscillator.period * (1 - 1e-6))
    assert np.allclose(last.impacts.approach[last.impacts.kind == 0], orbit.approach, rtol=1e-10)
    found, open_by = differences(orbit)
    assert open_by < 1e-10 and apart(found, orbit.multipliers) < 1e-6
    # the same orbit by its speed
    assert family.at_speed(orbit.speed, orbit).excess == pytest.approx(excess, abs=1e-12)


def test_the_multipliers_of_a_kick_orbit_are_those_of_its_own_touch() -> None:
    """At the fold of the kicks of a soft wall the motion is all but at its own: a multiplier next to one."""
    at = one_mode(21.50, contact.HuntCrossley.with_restitution(stiffness=1e9, restitution=0.1, velocity=0.2))
    kick, exact = (make(oscillator=at, m=4).fold() for make in (KickFamily, Shooting))
    assert kick.excess == pytest.approx(exact.excess, rel=0.1)
    assert kick.multipliers[0] == pytest.approx(1.0, abs=0.05) and kick.admissible
