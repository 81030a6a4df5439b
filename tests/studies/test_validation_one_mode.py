"""The sources with one mode by other routes: closed forms in 50 digits, quadrature, simulated motions."""

from __future__ import annotations

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

from contact import LinearContact, NewtonRestitution, State, Stop, StroboscopicMap, orbits, simulate
from studies.methods.validation.one_mode import PUBLISHED, SPEEDS, bifurcation, driven, highest, rig

HARD = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.8))
NARROW = {w: StroboscopicMap(oscillator=rig(w, base=0.7 / 1.26)) for w in (0.8022, 0.804)}


def closed_form(w: mp.mpf, doubling: bool) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """F/F_g, impact speed and determinant of Ghosh and Simpson's p2 at its fold or doubling.

    Before the impact the deviation from steady motion is s v, and the steady velocity b w v; the trace of
    flow times saltation matrix [[-e, 0], [(1 + e) (force - x)/v, -e]] is linear in 1/v.
    """
    c, e, time = mp.mpf("0.04"), mp.mpf("0.9"), 4 * mp.pi / w
    wd, decay = mp.sqrt(1 - c * c / 4), mp.exp(-c * time / 2)
    sine, cosine = decay * mp.sin(wd * time) / wd, decay * mp.cos(wd * time)
    distance = 1 - 2 * cosine + decay**2
    s = -(1 + e) * sine / distance
    b = (1 + (1 + e) * (cosine - c / 2 * sine - decay**2) / distance) / w
    v = s / (s * s + b * b)
    if doubling:
        rest = (1 + (e * decay) ** 2 - 2 * e * cosine) / (sine * (1 + e))
        v = w * w / (rest - (1 - w * w) * s + c * b * w)
    return mp.sqrt((1 - s * v) ** 2 + (b * v) ** 2), v, (e * decay) ** 2


@pytest.mark.parametrize("w", PUBLISHED)
def test_bifurcations_of_ghosh_and_simpson_in_50_digits(w: float) -> None:
    """Place, speed, multipliers and slope over w, located and differentiated, against the closed form."""
    doubling, orbit = w in SPEEDS, bifurcation(w)
    with mp.workdps(50):
        level, speed, determinant = closed_form(mp.mpf(w), doubling)
        slope = mp.diff(lambda x: closed_form(x, doubling)[0], mp.mpf(w))
    rates = orbits.doubling_derivatives if doubling else orbits.excess_derivatives
    assert orbit.excess == pytest.approx(float(level - 1), abs=1e-12 if doubling else 2e-15)
    assert orbit.speed == pytest.approx(float(speed), rel=2e-11)
    assert np.prod(orbit.multipliers).real == pytest.approx(float(determinant), rel=1e-14)
    assert orbit.multipliers[0].real == pytest.approx(-1.0 if doubling else 1.0, abs=1e-11)
    assert rates(orbit, [orbits.Change(frequency=0.5 / math.pi)])[0] == pytest.approx(float(slope), rel=1e-10)


def test_folds_touch_grazing_quadratically() -> None:
    """Distance below grazing over squared distance in w tends to half the closed form's second derivative."""
    with mp.workdps(50):
        resonance = mp.mpf("0.8") * mp.sqrt(1 - mp.mpf("0.02") ** 2)
        constant = float(mp.diff(lambda x: closed_form(x, False)[0], resonance, 2) / 2)
    steps = np.array([4e-4, 2e-4, 1e-4])
    found = np.array([bifurcation(float(resonance) - step).excess for step in steps]) / steps**2
    assert (8 * found[2] - 6 * found[1] + found[0]) / 3 == pytest.approx(constant, rel=1e-6)


@pytest.mark.parametrize("w", [1.0, 0.7, 0.3])
def test_grazing_of_coco_is_where_simulated_motions_begin_to_touch(w: float) -> None:
    """Steady motion 1e-12 below and above."""
    for excess in (-1e-12, 1e-12):
        strobed = StroboscopicMap(oscillator=driven(w, 0.1, HARD)).at(excess)
        assert len(simulate(strobed.oscillator, strobed.steady(), periods=1).impacts) == (excess > 0)


def test_orbits_that_pierce_the_wall_are_not_motions() -> None:
    """Simulation from the impact returns to it just where the closed form stays below the wall."""
    oscillator = driven(0.3, 0.1, HARD)
    family, found = orbits.MaximalFamily(oscillator=oscillator, period=1), []
    for speed in np.linspace(0.02, 2.5, 40):
        orbit = family.orbit(float(speed))
        run = simulate(orbit.oscillator, orbit.state(), duration=1.5 * orbit.duration)
        alone = len(run.impacts) == 2 and abs(run.impacts.start[1] - orbit.phase - orbit.duration) < 1e-7
        found.append((bool(alone), highest(orbit) <= 1.0, orbit.admissible))
    assert len({*found}) == 2 and all(one == two == three for one, two, three in found)


@pytest.mark.parametrize("e", [0.6, 6.50108, 1e3])
def test_free_oscillation_against_a_spring_by_quadrature(e: float) -> None:
    """Half periods as integrals of dx/speed, x = turning point -+ s^2."""
    free = replace(driven(0.5, 0.0, Stop(gap=1.0, law=LinearContact(stiffness=5.0))), drive=None)
    far, root = mp.sqrt(2 * mp.mpf(e)), mp.sqrt(12 * mp.mpf(e) - 5)  # turning points -far, (5 + root)/6
    off = mp.quad(lambda s: 2 / mp.sqrt(2 * far - s * s), [0, mp.sqrt(far + 1)])
    on = mp.quad(lambda s: 2 / mp.sqrt(2 * root - 6 * s * s), [0, mp.sqrt((root - 1) / 6)])
    start = State(displacement=np.array([-math.sqrt(2 * e)]), velocity=np.zeros(1))
    period = np.diff(simulate(free, start, duration=15.0).impacts.start)[0]
    assert period == pytest.approx(float(2 * (off + on)), rel=1e-14)


def test_motions_of_the_aberdeen_rig_part_at_the_rate_of_its_exponent() -> None:
    """Pairs 1e-10 apart in the band of chaos; the spring loses nothing: the exponents sum to -c T."""
    strobed, rates = NARROW[0.8022], []
    state = replace(orbits.settle(strobed, strobed.steady(), most_cycles=4000).end, time=0.0)
    exponents, _ = orbits.map_exponents(strobed, state, 10000, align=50)
    assert exponents.values.sum() == pytest.approx(-0.02 * 2 * math.pi / 0.8022, rel=1e-12)
    for _ in range(200):
        beside = strobed.orbit(replace(state, displacement=state.displacement + 1e-10), 40)
        here = strobed.orbit(state, 40)
        apart = np.linalg.norm(beside.points - here.points, axis=1)
        rates.append(np.log(apart[39] / apart[9]) / 30)
        state = replace(here.end, time=0.0)
    spread = math.hypot(exponents.error, np.std(rates) / math.sqrt(len(rates)))
    assert 0.0 < 30 * spread < exponents.largest
    assert exponents.largest == pytest.approx(np.mean(rates), abs=3 * spread)


def test_the_orbit_of_three_periods_doubles_where_its_multiplier_is_minus_one() -> None:
    """By shooting along w; simulated motions have period 3 and 6 just above and below."""
    start = State(displacement=np.array([0.5]), velocity=np.zeros(1))
    state = replace(orbits.settle(NARROW[0.804], start, most_cycles=2000).end, time=0.0)
    family = orbits.Shooting(oscillator=NARROW[0.804].oscillator, period=3, impacts=2)
    orbit = family.from_state(state)

    def beyond(w: float) -> float:
        nonlocal orbit
        there = family.of(rig(w, base=0.7 / 1.26))
        orbit = there.at_excess(there.oscillator.excess, orbit)
        return float(orbit.multipliers[0].real) + 1.0

    assert min(beyond(w) for w in np.linspace(0.804, 0.8032, 9)) > 0.0
    doubled = brentq(beyond, 0.8032, 0.8030, xtol=1e-13)
    for w, period in ((doubled + 1e-5, 3), (doubled - 1e-5, 6)):
        strobed, state = StroboscopicMap(oscillator=rig(w, base=0.7 / 1.26)), orbit.strobe_state()
        assert orbits.settle(strobed, replace(state, time=0.0), most_cycles=20000).period == period
