"""Branches never jump, miss no event at their default step, and come back."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from oscillators import equation_1, modes_on_stop, slow
from random_families import ALL, QUICK, STEPS, judged_family
from simulated_orbit import settled

from contact import ContactLaw, HertzContact, HuntCrossley, ImpactOscillator, LinearContact, orbits
from contact.orbits.branches import events

LONG = [(n, QUICK) for n in (3, 5, 6, 7, 12, 62, 80)] + [(n, ALL) for n in range(0, 60, 3)]
LONG += [(n, STEPS) for n in range(60, 100)]
SHORT = [(n, QUICK) for n in (9, 15, 101)] + [(n, STEPS) for n in (6, 28, 53, 58, 147, 150)]


@pytest.mark.parametrize(("number", "names"), [*SHORT, *slow(*LONG)])
def test_random_orbits_with_several_touches(number: int, names: tuple[str, ...]) -> None:
    """No event that is none or is missed, no step to another curve, no orbit that touches the stop more often
    than it says."""
    counts, wrong = judged_family(58 if names == STEPS else 1, number, names)
    assert not wrong and counts


# omega, decay rate, phi and participation of the modes
THIRD = "150 278.072 775.547 2724.42 5.20944 2.78072 7.75547 32.0957 "
THIRD += "1.17266 -.972633 1.86655 -.541275 1.12156 -.808537 -.478661 -.216805"
PAIRS = "150 397.953 842.623 1478.88 3321.28 1.91818 6.7082 208.311 3378.36 33.2128 "
PAIRS += "1.21094 -.681816 .453756 .749322 -1.13642 1.18717 -.545897 .522515 .0898104 2.45186"
OTHER = "150 623.347 2699.39 1.38637 5.10086 85.3083 .683382 -.539198 1.14143 2.37105 .0952109 -.219425"


def of_rows(text: str, law: ContactLaw, frequency: float) -> ImpactOscillator:
    return modes_on_stop(*np.array(text.split(), dtype=float).reshape(4, -1), law=law, drive=frequency)


def test_the_graze_of_a_third_touch_is_not_passed_over() -> None:
    """Behind it another curve comes near."""
    law = HuntCrossley(stiffness=52035542.65, dissipation=1.071468)
    family = orbits.Shooting(oscillator=of_rows(THIRD, law, 14.8344296).with_excess(0.95), m=1, impacts=3)
    start = family.from_state(settled(family.oscillator, 0.95).end)
    (graze,) = orbits.follow(family, start, low=2.2, high=2.8).events
    assert (graze.kind, graze.orbit.approach[2] < 1e-3) == ("grazing", True)
    assert graze.orbit.speed == pytest.approx(2.58603, abs=1e-5)


def test_a_torus_between_other_changes_of_multipliers_is_found() -> None:
    law = HuntCrossley(stiffness=8841799474.0, dissipation=0.921055)
    family = orbits.Shooting(oscillator=of_rows(PAIRS, law, 14.9305707826), m=1, impacts=2)
    branch = orbits.follow(family, family.at_speed(0.65), low=0.54, high=0.75)
    assert [event.kind for event in branch.events] == ["fold", "torus", "fold"]
    assert branch.of_kind("torus")[0].excess == pytest.approx(0.01727, abs=1e-5)


@pytest.mark.parametrize("step", [0.1, 0.05])
def test_only_the_same_orbit_closes_a_branch_of_orbits_that_are_not_admissible(step: float) -> None:
    oscillator = of_rows(OTHER, LinearContact(stiffness=855112976.0), 15.4307)
    family = orbits.Shooting(oscillator=oscillator, m=5, impacts=2)
    branch = orbits.follow(family, family.at_speed(0.5278), low=0.16, high=2.1, step=step)
    assert branch.ended_low == branch.ended_high == "range"
    assert [event.kind for event in branch.events] == ["fold", "period doubling"]


def test_a_search_ends_where_rounding_hides_multipliers_and_after_its_time(monkeypatch) -> None:
    """Twelve modes before the softest wall, some undamped: the largest multiplier reaches 1e29."""
    k = np.arange(12)
    omega, phi = 154.0 * (1.0 + 1.5 * k) ** 2, 7.0 * (-0.8) ** (k % 2)
    wall, decay = HertzContact(stiffness=1e-300), 0.02 * omega * (k % 2 == 0)
    soft = modes_on_stop(omega, decay, phi, 1.0 / (7.0 + 16.1 * k), law=wall, drive=22.2)
    assert orbits.fold_of(orbits.Shooting(oscillator=soft, m=3)) is None
    monkeypatch.setattr("contact.orbits.branches.curve.MOST_SECONDS", 0.1)
    family, used = orbits.Shooting(oscillator=equation_1(21.5), m=4), time.thread_time()
    branch = orbits.follow(family, family.at_speed(60.0), step=1e-3)
    assert "processor time" in branch.ended_high and time.thread_time() - used < 2.0


def test_a_point_between_two_neighbours_is_a_neighbour_of_both(monkeypatch) -> None:
    monkeypatch.setattr(events, "why_no_neighbours", lambda a, b: "far" if abs(a.x[0] - b.x[0]) > 1 else "")
    arc = events.Arc(None, *(SimpleNamespace(x=np.array([x])) for x in (0.0, 1.5)))
    for x, same in ((0.2, False), (0.7, True), (1.2, False)):
        assert arc.on_curve(SimpleNamespace(x=np.array([x]))) == same
