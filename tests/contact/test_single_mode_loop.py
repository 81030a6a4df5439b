"""The loop of one mode under Newton's law against the general loop, and the proofs by which it skips."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from one_mode import DAMPINGS, FREQUENCIES, GAP, Period, at_a_strobe, compared, oscillator
from oscillators import newton, slow, spring
from tip_judge import Signal, highest

from contact import StroboscopicMap
from contact.engine.event_loop import DONE
from contact.flight.crossing import FREE, first_crossing
from contact.flight.tip import tip_rounding, tip_state
from contact.maps.strobed_motion import strobed_motion, strobed_system


@pytest.mark.parametrize("tau", [0.1, *slow(0.0, 0.05, 0.5, 1.0)])
@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_every_period_is_that_of_the_general_loop(frequency, tau):
    assert compared(oscillator(frequency, tau=tau), 400)[0] > 20


@pytest.mark.parametrize("n_modes", [1, 6])
def test_a_deviation_that_has_faded_is_zero_and_no_denormal_number(n_modes):
    """Rounding would keep it at the smallest number above zero, and arithmetic slow, for ever."""
    driven = spring(n_modes, newton(0.5), damping=0.05, drive=(21.5, 0.0)).with_excess(-0.05)
    system, runs = strobed_system(driven), at_a_strobe()
    u, points, counts = np.full((2, n_modes), 1e-9), np.empty((20_000, 2 * n_modes)), np.empty(20_000, int)
    status = strobed_motion(system.table, system, np.empty(0), u[0], u[1], runs, points, counts)
    assert status == DONE and not counts.any() and not u.any()


@pytest.mark.parametrize("excess", [-0.1, 1e-4, 0.1, 0.6, 3.0])
@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("phi, participation", [*slow((1.0, None)), (-1.3, None), (2.7, -0.4)])
def test_so_it_is_with_any_damping_sign_of_the_mode_and_amplitude(damping, excess, phi, participation):
    single = oscillator(21.5, decay=DAMPINGS[damping], excess=excess, phi=phi, participation=participation)
    impacts, left = compared(single, 250)
    assert impacts > 0 or excess < 0 or damping == "over-damped" or excess < 1e-3
    assert left > 0 or excess < 3.0  # amplitudes for which the comparison proves nothing


@pytest.mark.parametrize("tau, excess", [(0.1, 3.0), (0.5, 6.0), (0.0, 1.0)])
def test_stays_on_the_wall_are_those_of_the_general_loop(tau, excess):
    """Low drive frequency and a large amplitude press the tip against the wall."""
    assert min(compared(oscillator(6.0, tau=tau, decay=20.0, excess=excess), 100)) > 50


@pytest.mark.parametrize("frequency", FREQUENCIES)
@pytest.mark.parametrize("power", range(1, 13))
def test_the_steady_motion_touches_at_every_overshoot(frequency, power):
    for side in (1, -1):
        single = oscillator(frequency, excess=side * 10.0**-power)
        orbit = StroboscopicMap(oscillator=single).orbit(StroboscopicMap(oscillator=single).steady(), 1)
        assert orbit.impacts[0] == (1 if side > 0 else 0)


@pytest.mark.parametrize("size", [0.05, 1.5, *slow(0.25, 0.6)])
@pytest.mark.parametrize("damping", DAMPINGS)
def test_planted_overshoots_are_found_and_none_is_invented(damping, size):
    """A period from a random deviation, the stop put next to its peak."""
    rng = np.random.default_rng(7)
    paths = [0, 0]  # settled by the comparison, left
    for _ in range(12):
        single = oscillator(rng.uniform(20.5, 23.8), decay=DAMPINGS[damping], excess=0.02)
        numbers, u = single.numbers(), rng.normal() * size * GAP
        v = rng.normal() * size * GAP * numbers.omega[0]
        tip = Signal(numbers, 0.0, np.array([u]), np.array([v]))
        peak = float(highest(tip, 0.0, 0.0, numbers.period))
        begins = numbers.tip_cosine + u
        if peak < 0.1 * GAP or peak - begins < 0.05 * peak:
            continue
        for power in range(1, 13):
            for side in (1, -1):
                gap = peak * (1.0 - side * 10.0**-power)
                if gap <= begins:
                    continue
                period = Period(replace(single, stop=replace(single.stop, gap=gap)))
                fresh = (np.array([u]), np.array([v]), at_a_strobe())
                status, impacts, left = period.fast(*fresh)
                assert status == DONE and (impacts > 0) == (side > 0), (power, side, gap)
                paths[left] += 1
    assert sum(paths) > 50
    if size == 0.05 and damping != "over-damped":
        assert paths[0] > 2 * paths[1]
    if size == 1.5:
        assert paths[1] > 0


@settings(max_examples=300, deadline=None)
@given(
    frequency=st.floats(6.0, 24.0),
    damping=st.sampled_from(sorted(DAMPINGS)),
    excess=st.one_of(st.floats(-0.5, 0.5), st.sampled_from([1e-12, 1e-9, -1e-12])),
    u=st.floats(-1.5, 1.5),
    v=st.floats(-1.5, 1.5),
    sign=st.sampled_from([1.0, -1.0]),
)
def test_what_is_called_free_is_free(frequency, damping, excess, u, v, sign):
    period = Period(oscillator(frequency, decay=DAMPINGS[damping], excess=excess, participation=sign))
    numbers = period.numbers
    un, vn = np.array([u * GAP]), np.array([v * GAP * numbers.omega[0]])
    height = tip_state(numbers, 0.0, un, vn)[0]
    if height >= -tip_rounding(numbers, un, vn):
        un -= height + 1e-6 * GAP
    outcome, _s = first_crossing(numbers, 0.0, un, vn, numbers.period, 0)
    status, impacts, left = period.fast(un.copy(), vn.copy(), at_a_strobe())
    if status == DONE and not left:
        assert (impacts == 0) == (outcome == FREE)
        tip = Signal(numbers, 0.0, un, vn)
        assert (impacts == 0) == (highest(tip, numbers.gap, 0.0, numbers.period) < 0)


@pytest.mark.parametrize("damping", ["strong", "over-damped"])
def test_a_peak_at_the_strobe_hides_no_crossing_of_the_period_before(damping):
    """A mode of the other sign has its steady peak late in the period; states that rise at its begin."""
    single = oscillator(20.9, decay=DAMPINGS[damping], excess=-0.05, participation=-1.0)
    period = Period(single)
    numbers, rng = period.numbers, np.random.default_rng(5)
    free = touching = 0
    for _ in range(300):
        u = -(numbers.level + numbers.tip_cosine) - 10 ** rng.uniform(-6, -1.5) * GAP
        v = (rng.uniform(-0.3, 0.6)) * GAP * numbers.omega[0]
        arrays = np.array([u]), np.array([v])
        outcome, _s = first_crossing(numbers, 0.0, *arrays, numbers.period, 0)
        status, impacts, _left = period.fast(*arrays, at_a_strobe())
        assert status == DONE and (impacts == 0) == (outcome == FREE)
        free += impacts == 0
        touching += impacts > 0
    assert free > 10 and touching > 10
