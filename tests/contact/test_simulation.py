"""Whole motions against closed forms, against DOP853 split at events, and against their own invariants."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oscillators import equation_1, newton, slow, spring
from whole_motions import assert_same_motion, falling_body, integrate

from contact import ContactLaw, LinearContact, State, simulate

PLACES = [(20.90, 0.02), (22.20, 0.05), (23.40, 0.3)]
THROWN = State(displacement=[0.2], velocity=[-11.0])
MODES = [(2, LinearContact(stiffness=2e4)), (2, LinearContact(stiffness=2e4, damping=4.0)), (3, newton(0.6))]
MANY = [(6, LinearContact(stiffness=3e5)), (6, LinearContact(stiffness=3e5, damping=10.0))]
MANY += [(4, LinearContact(stiffness=1e4, damping=60.0))]


def driven(n_modes: int, law: ContactLaw) -> tuple:
    start = State(displacement=np.zeros(n_modes), velocity=np.full(n_modes, 0.02))
    return spring(n_modes, law, drive=(21.5, 1.6e-3)), start, 2.3 if n_modes > 2 else 6.3, 2, 3e-8


@pytest.mark.parametrize(
    ("oscillator", "start", "periods", "fewest", "digits"),
    [
        *((equation_1(f, excess=excess), THROWN, 12.4, 4, 3e-10) for f, excess in PLACES),
        *(driven(*case) for case in MODES),
        *slow(*(driven(*case) for case in MANY)),
    ],
)
def test_a_motion_is_that_of_an_independent_integration(oscillator, start, periods, fewest, digits):
    """Some drive periods with several contacts: states, times of touch and release, speeds, losses."""
    state = replace(start, time=0.3 * oscillator.period)
    times = np.linspace(state.time, state.time + periods * oscillator.period, 200)
    other = integrate(oscillator, state, times)
    run = simulate(oscillator, state, duration=times[-1] - times[0], times=times)
    assert len(other.touch) >= fewest
    assert_same_motion(run, other, digits=digits)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.5, 0.99, 1.0, 1.01, 3.0])
def test_free_mass_on_spring_and_dashpot_rebounds_without_pull(ratio):
    """m d'' = -(k d + c d') lets go where k d + c d' = 0; the rest is free flight.  In closed form."""
    k, speed = 4e4, 0.3
    c = 2 * ratio * math.sqrt(k)
    oscillator = falling_body(0.01, LinearContact(stiffness=k, damping=c), gravity=0.0)
    run = simulate(oscillator, State(displacement=[0.0], velocity=[speed]), duration=0.2)
    w = math.sqrt(k)
    if ratio < 1:
        wd = w * math.sqrt(1 - ratio**2)
        # k d + c d' = 0 at tan(wd t) = -2 r sqrt(1 - r^2)/(1 - 2 r^2)
        t = math.atan2(2 * ratio * math.sqrt(1 - ratio**2), 2 * ratio**2 - 1) / wd if ratio else math.pi / wd
        depth = speed / wd * math.exp(-ratio * w * t) * math.sin(wd * t)
    elif ratio == 1:
        t = 2 / w
        depth = speed * t * math.exp(-w * t)
    else:
        a, b = w * (ratio - math.sqrt(ratio**2 - 1)), w * (ratio + math.sqrt(ratio**2 - 1))
        # k d + c d' with k = a b, c = a + b: a^2 exp(-at) = b^2 exp(-bt)
        t = 2 * math.log(b / a) / (b - a)
        depth = speed * (math.exp(-a * t) - math.exp(-b * t)) / (b - a)
    rebound = k * depth / c if ratio else speed
    assert len(run.impacts) == 1 and run.impacts.start[0] == pytest.approx(0.01 / speed, rel=1e-13)
    assert run.impacts.rebound[0] == pytest.approx(-rebound, rel=1e-10)
    flown = depth / rebound if ratio else 0.0
    assert run.impacts.end[0] == pytest.approx(0.01 / speed + t + flown, rel=1e-10)
    assert run.impacts.loss[0] == pytest.approx(0.5 * (speed**2 - rebound**2), rel=1e-9, abs=1e-14)
    assert run.end.velocity[0] == pytest.approx(-rebound, rel=1e-10)
