"""Whole motions against DOP853 split at events."""

from dataclasses import replace

import numpy as np
import pytest
from oscillators import equation_1, newton, slow, spring
from whole_motions import assert_same_motion, integrate

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
