"""The descriptions by name, each held to another route to the same orbit."""

import numpy as np
import pytest

from beam import InvalidValue
from contact import NordmarkMap, NotPeriodic, StroboscopicMap
from contact.maps.nordmark_orbits import MapFamily
from contact.orbits import Shooting, fold_of, onset_m, onset_orbit, orbit_end
from studies.physics.descriptions import TITLES, fold_at, or_none, strobed_at, up_and_down, word
from studies.shell.scene import nordmark_at, single_mode_at

FREQUENCY, M = 22.2, 5


@pytest.mark.parametrize("name", TITLES)
def test_the_motion_of_a_description_ends_at_its_fold(letter_scene, letter_model, name):
    """A downward scan of the motion, and the fold that is found without it."""
    strobed = strobed_at(name, letter_scene, FREQUENCY, letter_model)
    settled = onset_orbit(strobed)
    assert (settled.m, settled.impacts) == (M, 1)
    end = orbit_end(strobed, settled.end, 1e-3, most_cycles=2000)
    assert end.kind == "fold" and end.lost <= end.excess <= end.held
    # kick and shift of a first collision leave out how the tip decelerates on the orbit
    rel = 0.01 if name == "two_parameters" else 1e-8
    assert fold_at(name, letter_scene, FREQUENCY, M, letter_model) == pytest.approx(end.excess, rel=rel)


def test_folds_by_other_routes(letter_scene, letter_model):
    """Map: its own closed form; Eq. (1): shooting; beam: continuation; kicks: next to the beam."""
    folds = {name: fold_at(name, letter_scene, FREQUENCY, M, letter_model) for name in (*TITLES, "kicks")}
    closed = MapFamily(nordmark_at(letter_scene, FREQUENCY), M).fold()
    assert folds["map"] == pytest.approx(closed.excess, rel=1e-12)
    shot = Shooting(oscillator=single_mode_at(letter_scene, FREQUENCY), m=M).fold()
    assert folds["single_mode"] == pytest.approx(shot.excess, rel=1e-8)
    beam = strobed_at("beam", letter_scene, FREQUENCY, letter_model).oscillator
    assert folds["beam"] == pytest.approx(fold_of(Shooting(oscillator=beam, m=M)).excess, rel=1e-8)
    assert folds["kicks"] == pytest.approx(folds["beam"], rel=0.02)
    assert folds["kicks"] != folds["beam"]
    assert [fold_at(name, letter_scene, FREQUENCY, 1, letter_model) for name in folds] == [None] * 5


def test_what_has_no_strobed_map_is_refused(letter_scene):
    assert isinstance(strobed_at("map", letter_scene, FREQUENCY), NordmarkMap)
    assert isinstance(strobed_at("single_mode", letter_scene, FREQUENCY), StroboscopicMap)
    with pytest.raises(InvalidValue, match="'kicks'"):
        strobed_at("kicks", letter_scene, FREQUENCY)


def test_the_downward_scan_goes_on_from_the_upward_one(letter_scene):
    strobed = strobed_at("map", letter_scene, FREQUENCY)
    end = fold_at("map", letter_scene, FREQUENCY, M)
    ways = up_and_down(strobed, end * np.linspace(1.5, -0.5, 9), settle_cycles=2000)
    assert ways["up"].m.tolist() == [1] * 6 + [ways["up"].m[6]] + [M] * 2
    assert ways["down"].m.tolist() == [M] * 5 + [1] * 4 or ways["down"].m[4] == M
    below = up_and_down(strobed, np.array([1e-3, 2e-3]), settle_cycles=2000)  # begins above grazing
    assert below["up"].m.tolist() == [onset_m(strobed, e) for e in (1e-3, 2e-3)]


def test_failures_of_the_physics_are_none_and_faults_are_raised():
    def failing(error):
        raise error

    for failure in (NotPeriodic(time=0.0, gap=0.0, velocity=0.0), InvalidValue("")):
        assert or_none(failing, failure) is None
    with pytest.raises(KeyError):
        or_none(failing, KeyError())
    assert or_none(max, 1, 2) == 2
    assert [word(period) for period in (4, 0, None)] == ["p4", "no period up to 64", "-"]
