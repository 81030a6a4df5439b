"""Lyapunov exponents by two routes: Jacobians of the period map, and two neighbouring motions."""

import math
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
import pytest
from letters_spring import GAP, HERTZ
from oscillators import GAMMA, OMEGA, PHI, equation_1, modes_on_stop, newton
from simulated_orbit import beam

from contact import NordmarkMap, State, StrobedOrbit, StroboscopicMap
from contact.orbits import Shooting, map_exponents, orbit_exponents, settle

FREQUENCY = 21.50
SINGLE = StroboscopicMap(oscillator=equation_1(FREQUENCY, gap=GAP))
BEAM = StroboscopicMap(oscillator=beam(FREQUENCY, HERTZ))


@dataclass(frozen=True, kw_only=True)
class LogisticMap:
    """x' = a x (1 - x), with its derivative: a strobed map."""

    a: float
    scale: float = 1.0
    period: float = 1.0

    def at(self, excess):
        return LogisticMap(a=4.0 * (1.0 + excess))

    def steady(self):
        return np.array([0.3])

    def orbit(self, state, count):
        points, x = np.empty((count, 1)), state[0]
        for n in range(count):
            x = self.a * x * (1.0 - x)
            points[n] = x
        return StrobedOrbit(end=points[-1].copy(), points=points, impacts=np.zeros(count, dtype=np.int64))

    def jacobians(self, state, count):
        points = self.orbit(state, count).points
        before = np.vstack([state, points[:-1]])
        return [(np.array([[self.a * (1.0 - 2.0 * x)]]), 1) for x in before[:, 0]], points[-1].copy()

    def coordinates(self, state):
        return state


def moved(strobed, state, change):
    """The state with its coordinates changed."""
    if isinstance(state, np.ndarray):
        return state + change
    ones = np.ones(state.displacement.size)
    q, v = np.split(change / strobed.coordinates(State(displacement=ones, velocity=ones)), 2)
    return replace(state, displacement=state.displacement + q, velocity=state.velocity + v)


def difference(strobed, state, count, direction, step):
    """The central difference of `count` periods in a direction, where `step` is relative to the scale."""
    change = step * strobed.scale * np.eye(strobed.coordinates(state).size)[direction]
    ends = [strobed.orbit(moved(strobed, state, sign * change), count).end for sign in (1, -1)]
    return (strobed.coordinates(ends[0]) - strobed.coordinates(ends[1])) / (2.0 * step * strobed.scale)


def divergence(strobed, state, count, align=0):
    """The largest exponent per period, and its standard error, from two neighbouring motions whose distance
    is set back at every strobe off the wall (G. Benettin, L. Galgani, J.-M. Strelcyn, Phys. Rev. A 14 (1976)
    2338): no derivative occurs in it."""
    size = 1e-8 * strobed.scale
    start = np.random.default_rng(1996).standard_normal(strobed.coordinates(state).size)
    beside, rates = moved(strobed, state, size * start / np.linalg.norm(start)), []
    while len(rates) < align + count:
        span = 0
        while span == 0 or any(getattr(x, "regime", 0) for x in (state, beside)):
            state, beside, span = *(strobed.orbit(x, 1).end for x in (state, beside)), span + 1
        gap = strobed.coordinates(beside) - strobed.coordinates(state)
        rates += [math.log(np.linalg.norm(gap) / size) / span] * span
        beside = moved(strobed, state, gap * (size / np.linalg.norm(gap)))
    t = np.linspace(0.0, 1.0, count + 2)[1:-1]
    weight = np.exp(-1.0 / (t * (1.0 - t)))  # S. Das et al., Nonlinearity 30 (2017) 4111
    kept = np.array(rates[align : align + count])
    blocks = [block.mean() for block in np.array_split(kept, 20)]
    return float(weight @ kept / weight.sum()), float(np.std(blocks, ddof=1) / math.sqrt(0.51 * 20))


def test_the_logistic_map_has_ln_2_at_4_by_both_routes():
    system = LogisticMap(a=4.0)
    found, _end = map_exponents(system, system.steady(), 20000)
    assert found.largest == pytest.approx(math.log(2.0), abs=4.0 * found.error)
    assert found.error < 5e-3
    rate, error = divergence(system, system.steady(), 5000)
    assert rate == pytest.approx(math.log(2.0), abs=4.0 * error)


class TentMap(LogisticMap):
    """x/a or (1 - x)/(1 - a): in its chaos the slopes are independent, with probabilities a and 1 - a."""

    def jacobians(self, state, count):
        left = np.random.default_rng(int(state[0])).random(count) < self.a
        slopes = np.where(left, 1.0 / self.a, 1.0 / (1.0 - self.a))
        return [(np.array([[slope]]), 1) for slope in slopes], state + 1.0


def test_the_standard_error_is_the_scatter_of_runs_with_independent_slopes():
    a, count, runs = 0.2, 200, 40
    found = [map_exponents(TentMap(a=a), np.array([100.0 * run]), count)[0] for run in range(runs)]
    mean, spread = -a * math.log(a) - (1 - a) * math.log(1 - a), math.sqrt(a * (1 - a)) * math.log(1 / a - 1)
    t = (np.arange(count) + 0.5) / count
    weight = np.exp(-1.0 / (t * (1.0 - t)))
    error = spread * np.linalg.norm(weight) / weight.sum()  # exact: the variance of a weighted mean
    scatter = math.sqrt(np.mean([(each.largest - mean) ** 2 for each in found]))
    given = math.sqrt(np.mean([each.error**2 for each in found]))
    # three standard errors of a standard deviation: of the runs, and of 20 blocks in each run
    assert scatter == pytest.approx(error, rel=3.0 / math.sqrt(2 * runs))
    assert given == pytest.approx(error, rel=3.0 / math.sqrt(2 * 19 * runs))


def test_the_jacobians_are_the_differences_of_the_period_map():
    letters = NordmarkMap.from_oscillator(SINGLE.oscillator)
    for strobed, excess in ((letters, 0.02), (SINGLE, 0.02), (BEAM, 1e-3), (BEAM, 0.02)):
        here = strobed.at(excess)
        state = settle(here, strobed.steady(), most_cycles=2000).end
        found, end = here.jacobians(state, 4)
        there = here.coordinates(here.orbit(state, 4).end)
        assert here.coordinates(end) == pytest.approx(there, rel=1e-9, abs=1e-12 * here.scale)
        matrix = np.linalg.multi_dot([m for m, _span in found][::-1])
        start = here.coordinates(state)
        for direction in (0, start.size // 2):
            # fast modes ring out within a period: their rows are rounding on both sides
            found = difference(here, state, 4, direction, 1e-6)
            assert found == pytest.approx(matrix[:, direction], rel=1e-3, abs=1e-5)


def test_without_impacts_the_exponent_is_minus_half_the_decay_rate():
    for strobed in (SINGLE, BEAM):
        here = strobed.at(-0.02)
        rate = float(here.oscillator.model.decay_rate[0])
        found = orbit_exponents(here, here.steady(), 1)
        assert found.largest * FREQUENCY == pytest.approx(-0.5 * rate, rel=1e-9)
        flow, _error = divergence(here, here.steady(), 200, align=20)
        assert flow * FREQUENCY == pytest.approx(-0.5 * rate, rel=1e-4)


@pytest.mark.parametrize("excess", [-0.004, 1e-3, 0.01, 0.02])
def test_a_settled_orbit_has_the_multipliers_of_shooting(excess):
    for strobed in (SINGLE, BEAM):
        here = strobed.at(excess)
        settled = settle(here, strobed.at(1e-3).steady(), most_cycles=3000)
        period, impacts = settled.m, settled.impacts
        assert period in (4, 8)
        shot = Shooting(oscillator=here.oscillator, m=period, impacts=impacts).from_state(settled.end)
        wanted = math.log(abs(shot.multipliers[0])) / period
        assert orbit_exponents(here, settled.end, period).largest == pytest.approx(wanted, abs=1e-7)
        assert divergence(here, settled.end, 150, align=20)[0] == pytest.approx(wanted, abs=3e-3)


def test_chaos_has_one_exponent_by_both_routes_and_the_sum_of_the_determinants():
    here = SINGLE.at(0.034)
    settled = settle(here, SINGLE.steady(), most_cycles=1500)
    assert settled.m == 0
    found, _end = map_exponents(here, settled.end, 500, align=20)
    flow, error = divergence(here, settled.end, 500, align=20)
    spread = math.hypot(found.error, error)
    assert spread < 0.1 < found.largest and abs(found.largest - flow) < 4.0 * spread
    # determinant of a period: exp(-mu/f) tau^2 for each impact, whatever the motion
    matrices, _end = here.jacobians(settled.end, 64)
    impacts = here.orbit(settled.end, 64).impacts.sum()
    logs = sum(np.linalg.slogdet(m)[1] for m, _span in matrices)
    rate, tau = here.oscillator.model.decay_rate[0], here.oscillator.stop.law.local_restitution
    wanted = -64 * rate / FREQUENCY + 2.0 * impacts * math.log(tau)
    assert logs == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("n, restitution, lost", [(1, 0.5, 2), (3, 0.5, 2), (3, 0.0, 2), (1, 0.0, 1)])
def test_a_rest_forgets_two_directions_and_a_touch_without_rebound_one(n, restitution, lost):
    if lost == 2:  # in each period the tip rests on the stop for a third of the time
        decay, law = np.array([3.56, 19.2, 80.0])[:n], newton(restitution)
        made = modes_on_stop(OMEGA[:n], decay, PHI[:n], GAMMA[:n], law=law, gap=0.005, drive=5.0)
        here = StroboscopicMap(oscillator=made).at(3.0)
    else:
        here = StroboscopicMap(oscillator=equation_1(FREQUENCY, newton(0.0), gap=GAP)).at(0.02)
    settled = settle(here, here.steady(), most_cycles=500)
    m, left = settled.m, 2 * n - lost
    count = 1 if lost == 2 else m
    for shift in (0.0, 1e-3, -1e-3):
        state = moved(here, settled.end, shift * here.scale * np.ones(2 * n))
        steps, _end = here.jacobians(state, count)
        matrix = reduce(lambda product, step: step[0] @ product, steps, np.eye(2 * n))
        # steps of 1e-8 scales: truncation and rounding are some 1e-7 of the largest entry
        columns = np.stack([difference(here, state, count, j, 1e-8) for j in range(2 * n)], axis=1)
        assert columns == pytest.approx(matrix, abs=1e-6 * max(1.0, np.abs(matrix).max()))
        sizes = np.linalg.svd(columns, compute_uv=False)
        assert np.all(sizes[left:] < 1e-6) and np.all(sizes[:left] > 1e-3)
    values = orbit_exponents(here, settled.end, m).values
    assert np.isneginf(values).tolist() == [False] * left + [True] * lost
    along = map_exponents(here, settled.end, 60 * m, align=10 * m)[0]
    assert along.values == pytest.approx(values, abs=0.02) and along.error < 0.2
