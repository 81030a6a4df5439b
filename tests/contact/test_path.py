"""Orbits along a path p -> oscillator, against branches by approach speed and simulated motions."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from letters_spring import HERTZ
from oscillators import apart, equation_1, modes_on_stop, newton, slow, two_masses
from simulated_orbit import DELAYED, beam

from beam.parameters import require
from contact import ImpactOscillator, LinearContact, NotPeriodic, State, simulate
from contact.orbits import Branch, Shooting, follow, follow_path
from contact.orbits.branches.events import is_torus, torus
from contact.sensitivity.change import change_along

pytestmark = pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
PATH = partial(two_masses, force=1.0)

LAWS = {
    "newton": equation_1(20.90),
    "delayed": equation_1(20.90, DELAYED["constant"]),
    "beam with Hertz contact": beam(20.90, HERTZ, modes=4),
}


@pytest.mark.parametrize("name", ["newton", "delayed", *slow("beam with Hertz contact")])
def test_a_path_in_amplitude_is_the_branch_in_approach_speed(name: str) -> None:
    family = Shooting(oscillator=LAWS[name], m=3)
    fold = family.fold()
    node = family.at_speed(1.3 * fold.speed, fold)
    by_speed = follow(family, node, low=0.5 * fold.speed, high=8.0 * fold.speed)
    highest = by_speed.orbits[-1].excess
    found = follow_path(family.oscillator.with_excess, node, node.excess, low=-0.1, high=highest, step=0.2)
    single = [e for e in found.events if e.orbit.impacts == 1 and e.orbit.speed > 0.5 * fold.speed]
    for kind in ("fold", "period doubling", "grazing"):
        expected = [event.orbit for event in by_speed.events if event.kind == kind]
        met = sorted((event for event in single if event.kind == kind), key=lambda e: e.orbit.speed)
        assert len(expected) >= (kind == "fold")
        for event, orbit in zip(met, expected, strict=True):
            digits = {"fold": (2e-12, 1e-6), "period doubling": (2e-12, 1e-9), "grazing": (1e-9, 1e-8)}[kind]
            assert event.parameter == pytest.approx(orbit.excess, abs=digits[0])
            assert event.orbit.speed == pytest.approx(orbit.speed, rel=digits[1])
    for orbit, p in zip(found.orbits, found.parameters, strict=True):
        assert orbit.excess == pytest.approx(p, abs=1e-11)
        # towards grazing multipliers grow as 1/v, and rounding with them; with several touches the speed of
        # the first one turns round along the curve
        if orbit.impacts == 1 and orbit.speed > 1e-3 * fold.speed:
            like = family.at_speed(orbit.speed, orbit)
            assert like.excess == pytest.approx(p, abs=1e-12)
            assert orbit.slope == pytest.approx(like.slope, rel=1e-6, abs=1e-9)
            assert apart(orbit.multipliers[:1] / like.multipliers[0], np.ones(1)) < 1e-7
    assert found.ended_high == "range" and found.parameters[-1] == highest


def followed(w: float, touches: int, low: float, high: float, force: float = 1.0) -> Branch:
    """From the motion that has settled at `w`."""
    path, rest = partial(two_masses, force=force), State(displacement=np.zeros(2), velocity=np.zeros(2))
    settled = replace(simulate(path(w), rest, periods=500).end, time=0.0)
    start = Shooting(oscillator=path(w), m=1, impacts=touches).from_state(settled)
    return follow_path(path, start, w, low=low, high=high, step=0.2)


@pytest.fixture(scope="module", params=[0.29, *slow(0.24)])
def curve(request) -> Branch:
    return followed(0.3, 1, request.param, 0.42)


def test_touches_are_gained_and_lost_along_the_curve(curve: Branch) -> None:
    """Simulated motions repeat the curve."""
    assert len(decided(curve)) > 10
    counts = [orbit.impacts for orbit in curve.orbits]
    assert set(counts) == {1, 2, 3}
    changes = [(a, b) for a, b in pairwise(curve.orbits) if a.impacts != b.impacts]
    assert len(changes) >= 5 and all(abs(a.impacts - b.impacts) == 1 for a, b in changes)
    for a, b in changes:  # the touch that comes or goes is a graze
        more = max(a, b, key=lambda orbit: orbit.impacts)
        assert more.approach.min() < 1e-3 * more.approach.max()
    for orbit in curve.orbits[:: len(curve.orbits) // 40]:
        run = simulate(orbit.oscillator, orbit.state(), periods=orbit.m)
        start = orbit.state()
        assert np.allclose(run.end.displacement, start.displacement, rtol=0.0, atol=1e-9)
        assert np.sum(run.impacts.start <= start.time + 0.999999 * orbit.duration) == orbit.impacts


def decided(branch: Branch) -> list[tuple[str, float]]:
    """Kinds and places of the events; next to a graze the others are undecided."""
    at = np.array([event.parameter for event in branch.events if event.kind == "grazing"])
    return [
        (event.kind, event.parameter)
        for event in branch.events
        if event.kind == "grazing" or np.min(np.abs(at - event.parameter)) > 1e-7
    ]


@pytest.mark.slow
def test_starts_with_one_and_two_touches_lead_along_the_same_curve() -> None:
    places = [decided(followed(w, touches, 0.24, 0.42)) for w, touches in ((0.3, 1), (0.4, 2))]
    assert [kind for kind, _ in places[0]] == [kind for kind, _ in places[1]]
    assert [p for _, p in places[0]] == pytest.approx([p for _, p in places[1]], abs=1e-8)


def test_events_say_what_simulated_motions_do(curve: Branch) -> None:
    """Multipliers from small simulated deviations, without the tangents: 1, -1 or a pair on the circle."""
    expected, checked = {"fold": 0.0, "period doubling": np.pi}, 0
    for event in curve.events:
        if event.kind in ("grazing", "undecided") or event.orbit.approach.min() < 0.01:
            continue
        checked += 1
        start, columns = replace(event.orbit.strobe_state(), time=0.0), []
        for axis in np.eye(4):
            q, v = start.displacement, start.velocity
            begun = [State(displacement=q + h[:2], velocity=v + h[2:]) for h in (1e-6 * axis, -1e-6 * axis)]
            ends = [simulate(event.orbit.oscillator, state, periods=1).end for state in begun]
            plus, minus = (np.concatenate([end.displacement, end.velocity]) for end in ends)
            columns.append((plus - minus) / 2e-6)
        values = np.linalg.eigvals(np.array(columns).T)
        if event.kind == "torus":
            distances = np.abs(np.abs(values) - 1.0) + 10.0 * (values.imag == 0.0)
        else:
            distances = np.abs(values - np.exp(1j * expected[event.kind]))
        assert distances.min() < 1e-5
    assert checked >= 6
    kinds = {event.kind for event in curve.events}
    assert kinds - {"undecided"} == {"fold", "period doubling", "torus", "grazing"}


def test_real_pairs_of_product_one_are_no_torus(curve: Branch) -> None:
    signs = [torus(orbit) for orbit in curve.orbits]
    passed = sum(a * b < 0.0 for a, b in pairwise(signs))
    tori = [event for event in curve.events if event.kind == "torus"]
    assert 0 < len(tori) < passed and all(is_torus(event.orbit) for event in tori)


def test_numbers_of_an_oscillator_along_a_path() -> None:
    """Constant force is Z = f/w^2: dZ/dW = -2 Z/W, at the ends of the range too."""
    for w in (0.3, 0.61, 0.9):
        change = change_along(PATH, w, 0.3, 0.9)
        assert change.amplitude == pytest.approx(-2.0 / w**3, rel=5e-9)
        assert change.frequency == pytest.approx(0.5 / np.pi, rel=1e-11)
        assert np.max(np.abs(change.model.omega)) < 1e-11 and abs(change.gap) < 1e-11


def test_a_fold_in_frequency_is_one_in_amplitude() -> None:
    """At the frequency where the response turns round, the amplitude of its orbits is least just there."""
    branch = followed(0.635, 1, 0.6, 0.8, force=0.1)
    fold = next(event for event in branch.events if event.kind == "fold")
    orbit = fold.orbit
    family = Shooting(oscillator=two_masses(fold.parameter, 0.1), m=1)
    sides = [family.at_speed(orbit.speed * (1.0 + h), orbit).excess - orbit.excess for h in (-1e-3, 1e-3)]
    assert min(sides) > 1e-7 or max(sides) < -1e-7
    assert abs(orbit.slope) * orbit.speed < 1e-7
    assert orbit.excess == pytest.approx(two_masses(fold.parameter, 0.1).excess, abs=1e-11)


def test_no_orbit_next_to_the_start() -> None:
    family = Shooting(oscillator=LAWS["newton"], m=3)
    start = family.at_speed(1.3 * family.fold().speed)
    with pytest.raises(NotPeriodic, match="period 3"):
        follow_path(lambda f: equation_1(f, newton(0.9)), start, 22.0, low=21.0, high=23.0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["fold", "period doubling"])
def test_any_event_is_a_start(kind: str) -> None:
    """At a fold p does not tell an orbit from its neighbours."""
    curve = followed(0.3, 1, 0.24, 0.42)
    start = next(e for e in curve.events if e.kind == kind and e.orbit.approach.min() > 0.01)
    found = follow_path(PATH, start.orbit, start.parameter, low=0.24, high=0.29, step=0.3)
    inside = [e.parameter for e in curve.events if e.parameter < 0.29]
    others = [p for p in inside if abs(p - start.parameter) > 1e-7]
    met = [e.parameter for e in found.events if abs(e.parameter - start.parameter) > 1e-7]
    assert sorted(met) == pytest.approx(sorted(others), abs=1e-8)


def test_an_end_of_the_range_is_a_start(curve: Branch) -> None:
    low = curve.parameters[0]
    at_end = follow_path(PATH, curve.orbits[0], low, low=low, high=low + 0.01, step=0.3)
    assert at_end.parameters[0] == low < at_end.parameters[1] and at_end.ended_low == "range"


def test_the_reason_for_an_end_is_given() -> None:
    """The path refuses a drive above 1 rad/s: no graze; an orbit that pierces the wall is none."""

    def driven(w: float) -> ImpactOscillator:
        require(w <= 1.0, "the drive is too fast")
        law, drive = LinearContact(stiffness=5.0), (w / (2.0 * np.pi), 0.6)
        return modes_on_stop(1.0, 0.02, 1.0, 1.0, law=law, gap=1.0, drive=drive)

    family = Shooting(oscillator=driven(0.9), m=1)
    start = family.at_excess(driven(0.9).excess, family.at_speed(1.0))
    found = follow_path(driven, start, 0.9, low=0.88, high=1.1, step=0.3)
    assert "too fast" in found.ended_high and not found.of_kind("grazing")
    family = Shooting(oscillator=LAWS["newton"], m=3)
    through = family.at_speed(20.0 * family.fold().speed)
    assert not through.admissible
    with pytest.raises(NotPeriodic, match="touches"):
        follow_path(family.oscillator.with_excess, through, through.excess, low=-0.1, high=1.0)
