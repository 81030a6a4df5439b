"""The letter's six pairs: intervals of the free period, each by a second route."""

import numpy as np
import pytest

from contact import frequency_band
from contact.orbits import MaximalFamily
from studies.experiment.last_period import pairs
from studies.experiment.last_period.pairs import intervals_of, is_born, longest
from studies.letter import FREE_PERIOD_S, PERIODS
from studies.physics.parameters import with_values
from studies.shell.scene import single_mode_at


@pytest.fixture(scope="module")
def single(letter_scene):
    return single_mode_at(letter_scene, 22.20)


@pytest.fixture(scope="module")
def rows(single):
    """By (excess, pairs), on a fifth of a grid, whose ends are bisected to 1e-8 s, of Eq. (1) to 1e-7 s."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pairs, "GRID", 25)
        for excess, halvings in ((0.0, 16), (1e-3, 9)):
            patch.setattr(pairs, "HALVINGS", halvings)
            found |= {(excess, row.pairs): row for row in intervals_of(single, excess)}
    return found


@pytest.mark.parametrize(("f", "m"), PERIODS.items())
def test_the_maps_interval_has_its_ends_in_closed_form(rows, f, m):
    """f T = 2m/(2m+1) above; below, the band with that T begins at f."""
    found = rows[0.0, f"p{m}"]
    assert found.highest_s == pytest.approx(2 * m / ((2 * m + 1) * f), abs=1e-8)
    edge = frequency_band(m, free_period=found.lowest_s, decay_rate=3.56, restitution=0.1).lower
    assert edge == pytest.approx(f, abs=1e-5)


def exists(single, excess, frequency, period):
    """Whether Eq. (1) has a stable p_m, in closed form."""
    one = with_values(single, {"frequency": frequency, "free_period": period})
    orbits = MaximalFamily(oscillator=one, m=PERIODS[frequency]).orbits(excess)
    return any(orbit.admissible and orbit.stable for orbit in orbits)


def test_what_settles_is_where_the_orbit_is_in_closed_form(single, rows, monkeypatch):
    """Next to its doubling, 0.3 us of T wide, a motion settles too slowly."""
    monkeypatch.setattr(pairs, "is_born", exists)
    monkeypatch.setattr(pairs, "GRID", 25)
    for has in intervals_of(single, 1e-3)[:6]:
        found = rows[1e-3, has.pairs]
        assert found.lowest_s == pytest.approx(has.lowest_s, abs=3e-7)
        assert found.highest_s == pytest.approx(has.highest_s, abs=3e-7)


def test_the_six_contradict_the_printed_period_in_the_map_by_p10_alone(rows):
    both, wider = rows[0.0, "all"], rows[0.0, "all, f ± 0.005 Hz"]
    assert (both.from_m, both.to_m) == (8, 10)
    assert [both.lowest_s, both.highest_s] == pytest.approx([40.490e-3, 40.700e-3], abs=1e-6)
    assert [both.missed_by_s, wider.missed_by_s] == pytest.approx([80e-6, 71.3e-6], abs=0.1e-6)
    less = rows[0.0, "all but p10"]
    assert less.missed_by_s == 0.0 and less.lowest_s < FREE_PERIOD_S < less.highest_s


def test_at_an_excess_eq_1_has_them_all(single, rows):
    """As known: 40.71 to 40.745 ms at 1e-3; p10 from 3.8e-3 at 40.80 ms, 2.5e-3 at 40.78."""
    found = rows[1e-3, "all"]
    assert (found.from_m, found.to_m) == (4, 10)
    assert [found.lowest_s, found.highest_s] == pytest.approx([40.712e-3, 40.751e-3], abs=1e-6)
    assert found.missed_by_s == pytest.approx(28.5e-6, abs=0.5e-6)
    born = [is_born(single, excess, 23.40, FREE_PERIOD_S) for excess in (3.75e-3, 3.79e-3)]
    assert born == [False, True]
    for tau in (0.15, 0.2):  # p4 needs a tau below 0.18 at 40.80 ms
        one = with_values(single, {"restitution": tau})
        assert is_born(one, 4e-3, 21.50, FREE_PERIOD_S) == (tau < 0.18)


def test_the_longest_stretch_is_found_and_bisected():
    assert longest(lambda x: x < 0.05 or 0.2 < x < 0.7, 0.0, 1.0) == pytest.approx((0.2, 0.7), abs=1e-6)
    assert longest(lambda x: False, 0.0, 1.0) == (np.inf, -np.inf)
