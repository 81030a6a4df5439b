"""The letter's six pairs: intervals of the free period, each by a second route."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from contact import band
from studies.identify import pairs
from studies.identify.pairs import KINDS, WAYS, excesses_of_all, intervals_of, is_born, longest
from studies.letter import FREE_PERIOD_S, PERIODS


@pytest.fixture(scope="module")
def rows():
    """All descriptions with tau = 0.1, and 1e-3 with 0.3."""
    kinds = [kind for kind in KINDS if kind[2] == 0.1] + [("settles", 1e-3, 0.3)]
    return [row for kind in kinds for row in intervals_of(kind)]


def of(rows, description, excess, pairs, tau=0.1):
    key = (description, excess, tau, pairs)
    return next(r for r in rows if (r.description, r.excess, r.restitution, r.pairs) == key)


@pytest.mark.parametrize(("f", "m"), PERIODS.items())
def test_the_maps_interval_has_its_ends_in_closed_form(rows, f, m):
    """f T = 2m/(2m+1) above; below, the band with that T begins at f."""
    found = of(rows, "map", 0.0, f"p{m}")
    assert found.highest_s == pytest.approx(2 * m / ((2 * m + 1) * f), abs=1e-8)
    edge = band(m, free_period=found.lowest_s, decay_rate=3.56, restitution=0.1).lower
    assert edge == pytest.approx(f, abs=1e-5)


@pytest.mark.parametrize("m", PERIODS.values())
def test_what_settles_is_where_the_orbit_is_in_closed_form(rows, m):
    """Below an excess of 4e-3; a motion next to its doubling, 0.3 us of T wide, settles too slowly."""
    for excess in (2.5e-4, 1e-3, 4e-3):
        has = next(row for row in intervals_of(("has", excess, 0.1)) if row.pairs == f"p{m}")
        found = of(rows, "settles", excess, f"p{m}")
        assert [found.lowest_s, found.highest_s] == pytest.approx([has.lowest_s, has.highest_s], abs=3e-7)


def test_bisected_ends_are_those_of_a_fine_grid(rows):
    """Every 2 us of the stretch of p4 and p10, on which the six together rest, and 30 us beyond its ends."""
    for f, m in ((21.50, 4), (23.40, 10)):
        found = of(rows, "settles", 1e-3, f"p{m}")
        grid = np.arange(found.lowest_s - 31e-6, found.highest_s + 31e-6, 2e-6)
        held = np.array([is_born(("settles", 1e-3, 0.1), f, period) for period in grid])
        assert np.array_equal(held, (grid >= found.lowest_s) & (grid <= found.highest_s))


def test_the_six_contradict_the_printed_period_in_the_map_by_p10_alone(rows):
    both, wider = of(rows, "map", 0.0, "all"), of(rows, "map", 0.0, "all, f +- 0.005 Hz")
    assert (both.from_m, both.to_m) == (8, 10)
    assert [both.lowest_s, both.highest_s] == pytest.approx([40.490e-3, 40.700e-3], abs=1e-6)
    assert [both.missed_by_s, wider.missed_by_s] == pytest.approx([80e-6, 71.3e-6], abs=0.1e-6)
    less = of(rows, "map", 0.0, "all but p10")
    assert less.missed_by_s == 0.0 and less.lowest_s < FREE_PERIOD_S < less.highest_s
    assert of(rows, "has", 0.0, "all").lowest_s > of(rows, "has", 0.0, "all").highest_s  # p4 against p10


def test_at_an_excess_eq_1_has_them_all_and_from_4e_3_at_the_printed_period(rows):
    """As known: 40.71 to 40.745 ms at 1e-3; p10 from 3.8e-3 at 40.80 ms, 2.5e-3 at 40.78."""
    found = of(rows, "settles", 1e-3, "all")
    assert [found.lowest_s, found.highest_s] == pytest.approx([40.712e-3, 40.7515e-3], abs=1e-6)
    assert (found.from_m, found.to_m) == (4, 10) and found.missed_by_s == pytest.approx(28.5e-6, abs=0.5e-6)
    assert of(rows, "settles", 4e-3, "all").missed_by_s == 0.0
    assert excesses_of_all(FREE_PERIOD_S) == pytest.approx((3.77e-3, 1.01e-2), rel=5e-3)
    assert excesses_of_all(40.78e-3)[0] == pytest.approx(2.42e-3, rel=5e-3)
    contradicted = of(rows, "settles", 1e-3, "all", tau=0.3)  # p4 asks for a tau below 0.18 at 40.80 ms
    assert contradicted.lowest_s > contradicted.highest_s and contradicted.from_m == 4


def test_the_error_of_a_frequency_moves_the_period_as_it_moves_the_edge(rows, monkeypatch):
    """f T counts: an edge bisected at f + 0.005 Hz."""
    monkeypatch.setattr(pairs, "PERIODS", {23.405: 10})
    edge = of(rows, "settles", 1e-3, "p10").highest_s * 23.40 / 23.405
    held = [is_born(("settles", 1e-3, 0.1), 23.405, edge + way) for way in (-1e-8, 1e-8)]
    assert held == [True, False]


def test_stretches_words_and_figure(rows):
    assert longest(lambda x: x < 0.05 or 0.2 < x < 0.7, 0.0, 1.0) == pytest.approx((0.2, 0.7), abs=1e-6)
    assert longest(lambda x: False, 0.0, 1.0) == (np.inf, -np.inf)
    assert "p10 alone disagrees, by 0.046 Hz" in pairs.sentence(rows)
    drawn = pairs.draw(rows)
    assert isinstance(drawn, Figure) and len(drawn.axes[0].containers) == len(WAYS)
