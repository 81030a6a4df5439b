"""Amplitudes that change from period to period, and the cloud of strobe points that noise makes."""

from dataclasses import replace

import numpy as np
import pytest
from letters_spring import HERTZ
from oscillators import GAP, PHI, equation_1, modes_on_stop, newton, spring
from scipy.signal import lfilter
from simulated_orbit import beam

from contact import Chatter, NordmarkMap, NotPeriodic, State, StroboscopicMap, frequency_band
from contact.maps.nordmark_orbits import MapFamily
from contact.orbits import MaximalFamily, PeriodicOrbit, Shooting, orbit_exponents, strobe_covariance

NEWTON = newton(0.1)
PERIOD, SIGMA = 3, 1e-7


def node(oscillator: object, faster: float = 2.0) -> tuple[PeriodicOrbit, float]:
    """p3 beside its fold, and the excess of the fold."""
    family = Shooting(oscillator=oscillator, m=PERIOD)
    fold = family.fold()
    return family.at_speed(faster * fold.speed, fold), fold.excess


def settled(name: str) -> tuple[object, object, float]:
    """A strobed system at its orbit of period 3, a strobe of it, and its excess."""
    if name == "map":
        family = MapFamily(NordmarkMap.from_oscillator(equation_1(20.9, NEWTON)), PERIOD)
        excess = 0.5 * family.fold().excess
        orbit = next(each for each in family.orbits(excess) if each.stable)
        return family.map.at(excess), orbit.states[0], excess
    orbit, _ = node(equation_1(20.9, NEWTON) if name == "Eq. (1)" else beam(20.9, HERTZ, modes=4))
    return StroboscopicMap(oscillator=orbit.oscillator), replace(orbit.strobe_state(), time=0.0), orbit.excess


@pytest.mark.parametrize("name", ["map", "Eq. (1)", "beam"])
def test_a_constant_amplitude_is_no_change_and_a_new_one_leaves_the_state(name: str) -> None:
    strobed, state, excess = settled(name)
    whole = strobed.orbit(state, 12)
    ratio = (1.0 + excess) / (1.0 + 2.0 * excess)
    same = strobed.at(2.0 * excess).orbit(state, 12, factors=np.full(12, ratio))
    assert same.points == pytest.approx(whole.points, rel=1e-11, abs=1e-12 * strobed.scale)
    assert same.impacts.tolist() == whole.impacts.tolist()
    levels = excess + np.repeat([0.0, 1e-3, -1e-4, 5.0], 4)
    here, points = state, []
    for level in levels[::4]:
        part = strobed.at(float(level)).orbit(here, 4)
        points.append(part.points)
        here = replace(part.end, time=0.0) if name != "map" else part.end
    found = strobed.orbit(state, 16, factors=(1.0 + levels) / (1.0 + excess))
    assert found.points == pytest.approx(np.vstack(points), rel=1e-9, abs=1e-11 * strobed.scale)
    assert strobed.coordinates(found.end) == pytest.approx(found.points[-1], rel=1e-12)


def noise(count: int, sigma: float, memory: float) -> np.ndarray:
    """Amplitude factors of `count` periods."""
    steps = np.random.default_rng(1996).standard_normal(count)
    steps[1:] *= np.sqrt(1.0 - memory**2)
    return 1.0 + sigma * lfilter([1.0], [1.0, -memory], steps)


def test_the_loop_of_one_mode_is_the_general_one_at_any_amplitudes() -> None:
    """A second mode without weight at the tip takes the general loop."""
    single = equation_1(20.9, NEWTON).with_excess(1e-3)
    idle = dict(omega=900.0, decay_rate=1.0, phi=0.0, participation=0.0)
    rows = (np.append(getattr(single.model, name), number) for name, number in idle.items())
    double = modes_on_stop(*rows, law=NEWTON, gap=1.0, drive=20.9).with_excess(1e-3)
    factors, found = noise(400, 1e-3, 0.5), []
    for oscillator in (single, double):
        strobed = StroboscopicMap(oscillator=oscillator)
        found.append(strobed.orbit(strobed.steady(), 400, factors=factors))
    assert found[0].impacts.sum() > 100 and np.array_equal(found[0].impacts, found[1].impacts)
    both = found[1].points[:, [0, 2]]
    assert found[0].points == pytest.approx(both, rel=0.0, abs=1e-10 * strobed.scale)


@pytest.mark.parametrize("memory", [0.0, 0.95])
@pytest.mark.parametrize("name", ["map", "Eq. (1)", "beam"])
def test_covariances_are_those_of_simulated_clouds(name: str, memory: float) -> None:
    """Means over 100 blocks, each far longer than the noise remembers, have a standard error of their own."""
    strobed, state, _ = settled(name)
    sigma, cycles, blocks = 1e-10 if name == "map" else SIGMA, 20_000, 100
    predicted = strobe_covariance(strobed, state, PERIOD, deviation=sigma, memory=memory)
    factors = noise(PERIOD * cycles, sigma, memory)
    points = strobed.orbit(state, factors.size, factors=factors).points.reshape(cycles, PERIOD, -1)
    away = (points - strobed.orbit(state, PERIOD).points)[cycles // 20 :, :, :4]
    parts = away.reshape(blocks, -1, *away.shape[1:])
    products = np.einsum("bnji,bnjk->bjik", parts, parts) / parts.shape[1]
    expected, error = predicted[:, :4, :4], products.std(axis=0, ddof=1) / np.sqrt(blocks)
    assert np.max(np.abs(products.mean(axis=0) - expected) / error) < 4.0
    traces = np.einsum("bjii->b", products) / np.einsum("jii->", expected)
    assert abs(traces.mean() - 1.0) < 4.0 * traces.std(ddof=1) / np.sqrt(blocks) < 0.25


def test_clouds_grow_as_the_inverse_root_of_the_distance_to_the_fold() -> None:
    family = Shooting(oscillator=equation_1(20.9, NEWTON), m=PERIOD)
    fold, sizes = family.fold(), []
    distances = np.array([1e-4, 1e-5, 1e-6]) * abs(fold.excess)
    for distance in distances:
        near = family.at_speed(fold.speed * (1.0 + 2.0 * np.sqrt(distance / abs(fold.excess))), fold)
        orbit = family.at_excess(fold.excess + distance, near)
        strobed = StroboscopicMap(oscillator=orbit.oscillator)
        found = strobe_covariance(strobed, replace(orbit.strobe_state(), time=0.0), PERIOD, deviation=1.0)
        sizes.append(np.trace(found[0]))
    slopes = np.diff(np.log(sizes)) / np.diff(np.log(distances))
    assert slopes == pytest.approx([-0.5, -0.5], abs=0.01)
    saddle = family.at_speed(0.9 * fold.speed, fold)
    with pytest.raises(NotPeriodic, match="unstable"):
        state = replace(saddle.strobe_state(), time=0.0)
        strobe_covariance(StroboscopicMap(oscillator=saddle.oscillator), state, PERIOD, deviation=1.0)
    off = strobed, state, PERIOD  # a state of another amplitude
    for refused in (lambda: strobe_covariance(*off, deviation=1.0), lambda: orbit_exponents(*off)):
        with pytest.raises(NotPeriodic, match="scale"):
            refused()


@pytest.mark.parametrize("name", ["map", "Eq. (1)"])
def test_clouds_grow_towards_grazing_as_the_inverse_root_of_the_excess(name: str) -> None:
    """At the upper edge of a band, where the orbit shrinks with the excess; in noise of a thirtieth of the
    excess as the root of the noise (Simpson, Hogan and Kuske, arXiv:1207.2703)."""
    edge = frequency_band(PERIOD, free_period=40.80e-3, decay_rate=3.56, restitution=0.1).upper
    excesses, weak, clear = np.array([1e-3, 1e-4, 1e-5]), [], []
    for excess in excesses:
        oscillator = equation_1(edge, NEWTON, excess=excess)
        if name == "map":
            family = MapFamily(NordmarkMap.from_oscillator(oscillator), PERIOD)
            strobed = family.map.at(excess)
            state = next(each for each in family.orbits(excess) if each.stable).states[0]
        else:
            strobed = StroboscopicMap(oscillator=oscillator)
            orbits = MaximalFamily(oscillator=oscillator, m=PERIOD).orbits(excess)
            state = next(each for each in orbits if each.stable and each.admissible).strobe_state()
        for sigma, found in ((1e-3 * excess, weak), (excess / 30.0, clear)):
            run = strobed.orbit(state, 99_999, factors=noise(99_999, sigma, 0.0))
            spread = np.sqrt(run.points[9999::PERIOD].var(axis=0).sum())
            found.append(spread / (sigma if found is weak else 1.0))
    slopes = [np.polyfit(np.log(excesses), np.log(found), 1)[0] for found in (weak, clear)]
    assert slopes == pytest.approx([-0.5, 0.5], abs=0.03)


def test_slow_drift_is_a_slow_change_of_amplitude() -> None:
    """With a memory near one the cloud is the orbit's own change with the amplitude, times sigma."""
    orbit, _ = node(equation_1(20.9, NEWTON))
    family = Shooting(oscillator=orbit.oscillator, m=PERIOD)
    strobed, state = StroboscopicMap(oscillator=orbit.oscillator), replace(orbit.strobe_state(), time=0.0)
    found = strobe_covariance(strobed, state, PERIOD, deviation=1.0, memory=1.0 - 1e-9)
    ends = [family.at_excess((1.0 + orbit.excess) * (1.0 + h) - 1.0, orbit) for h in (1e-6, -1e-6)]
    moved = [
        StroboscopicMap(oscillator=end.oscillator).orbit(replace(end.strobe_state(), time=0.0), PERIOD).points
        for end in ends
    ]
    slope = (moved[0] - moved[1]) / 2e-6
    assert found == pytest.approx(np.einsum("ni,nj->nij", slope, slope), rel=1e-5)


@pytest.mark.parametrize("factors", [None, [1.0, 1.2, 0.3]])
def test_no_later_amplitude_hides_that_a_motion_could_not_be_followed(factors):
    """A tip that hops 2e5 times a period under an almost elastic law."""
    law = newton(1.0 - 1e-12)
    oscillator = replace(spring(2, law, drive=(21.0, 0.0)).with_excess(0.01), load=[1000.0 / PHI[0], 0.0])
    start = State(displacement=[GAP / PHI[0], 0.0], velocity=[-1e-4 / PHI[0], 0.0])
    with pytest.raises(Chatter) as caught:
        StroboscopicMap(oscillator=oscillator).orbit(start, 3, factors=factors)
    assert caught.value.time < oscillator.period
