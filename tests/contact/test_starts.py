"""A tip that lies on the stop when the run begins: closed forms, and an outside solver."""

import dataclasses
import math

import numpy as np
import pytest
from oscillators import modes_on_stop, newton
from scipy.integrate import solve_ivp
from whole_motions import accelerations

from beam import InvalidValue
from contact import HertzContact, HuntCrossley, LinearContact, PowerContact, Regime, State, simulate

STIFF = 200.0
LAWS = {
    "linear": (LinearContact(stiffness=STIFF, damping=0.0), 1.0),
    "hertz": (HertzContact(stiffness=STIFF), 1.5),
    "power": (PowerContact(stiffness=STIFF, exponent=1.75), 1.75),
}


def on_stop(law, gap, load, seed=None):
    """A spring of three random modes, or a mass, under a load, its tip at rest on the stop."""
    rng, n = np.random.default_rng(seed), 1 if seed is None else 3
    omega = np.zeros(1) if seed is None else np.sort(rng.uniform(1.0, 8.0, n))
    phi = np.ones(1) if seed is None else rng.uniform(0.5, 1.5, n) * rng.choice([-1, 1], n)
    q, v = (np.zeros(n) if seed is None else rng.uniform(-0.3, 0.3, n) for _ in range(2))
    q, v = q - phi * (phi @ q - gap) / (phi @ phi), v - phi * (phi @ v) / (phi @ phi)
    free = phi @ (-0.1 * omega * v - omega**2 * q)
    load = phi * (load - free) / (phi @ phi)  # the tip has this acceleration
    oscillator = modes_on_stop(omega, 0.1 * omega, phi, law=law, gap=gap, load=load)
    return oscillator, State(displacement=q, velocity=v)


def solved(oscillator, state, power):
    """(q, q') after 0.5 s by DOP853, the force being STIFF d^power."""
    phi, n, free = oscillator.model.phi, oscillator.n_modes, accelerations(oscillator)

    def rates(t, y):
        depth = max(0.0, phi @ y[:n] - oscillator.stop.gap)
        return np.concatenate([y[n:], free(t, y[:n], y[n:]) - phi * STIFF * depth**power])

    start = np.concatenate([state.displacement, state.velocity])
    digits = dict(method="DOP853", rtol=1e-12, atol=1e-15, max_step=2e-2)
    return solve_ivp(rates, (0.0, 0.5), start, **digits).y[:, -1]


@pytest.mark.parametrize("gap", [0.0, 0.3])
@pytest.mark.parametrize("pull", [2.0, -2.0])
@pytest.mark.parametrize("law", LAWS)
def test_a_start_at_rest_agrees_with_an_outside_solver(law, pull, gap):
    for seed in (None, 1, 2, 3):
        oscillator, state = on_stop(LAWS[law][0], gap, pull, seed)
        run = simulate(oscillator, state, duration=0.5)
        found = np.concatenate([run.end.displacement, run.end.velocity])
        np.testing.assert_allclose(found, solved(oscillator, state, LAWS[law][1]), atol=1e-9)
        assert (run.impacts.kind[:1].tolist() == [3]) == (pull > 0)


@pytest.mark.parametrize("gap", [0.0, 0.3])
@pytest.mark.parametrize("seed", [None, 1, 2, 3])
def test_newton_stays_if_pressed_and_leaves_if_pulled(seed, gap):
    oscillator, state = on_stop(newton(0.5), gap, 2.0, seed)
    run = simulate(oscillator, state, duration=1e-3)
    assert run.end.regime == 3 and run.impacts.kind.tolist() == [2] and run.impacts.approach.tolist() == [0.0]
    assert oscillator.tip(run.end.displacement) == pytest.approx(gap, abs=1e-15)
    oscillator, state = on_stop(newton(0.5), gap, -2.0, seed)
    run = simulate(oscillator, state, duration=1e-3)
    assert run.end.regime == 0 and len(run.impacts) == 0
    assert oscillator.tip(run.end.displacement) - gap == pytest.approx(-1e-6, rel=0.05)


@pytest.mark.parametrize("law", LAWS)
def test_a_mass_without_force_stays_at_a_stop_with_a_force_law(law):
    oscillator, state = on_stop(LAWS[law][0], 0.3, 0.0)
    run = simulate(oscillator, state, duration=3.0)
    assert run.end.displacement[0] == 0.3 and run.impacts.peak_force[0] == pytest.approx(0.0, abs=1e-10)


def test_a_start_that_moves_towards_the_stop_is_an_impact_and_one_without_force_a_stay():
    oscillator, state = on_stop(newton(0.5), 0.3, 0.0)
    run = simulate(oscillator, state, duration=1.0)
    assert run.end.regime == 3 and math.isclose(run.end.displacement[0], 0.3, abs_tol=1e-15)
    run = simulate(oscillator, State(displacement=[0.3], velocity=[1.0]), duration=1.0)
    assert run.impacts.start.tolist() == [0.0] and run.impacts.approach.tolist() == [1.0]
    assert run.end.displacement[0] == pytest.approx(-0.2, abs=1e-15)


UNCUT = [*(law for law, _ in LAWS.values()), HuntCrossley(stiffness=STIFF, dissipation=0.5)]


@pytest.mark.parametrize("law", UNCUT)
def test_only_a_force_that_is_cut_leaves_the_tip_free_behind_the_stop(law):
    """Hunt and Crossley's force pulls a tip that moves out fast: such a start is in contact."""
    oscillator, state = on_stop(law, 0.3, 1.0)
    behind = State(displacement=state.displacement + 0.1, velocity=[-5.0])
    assert simulate(oscillator, behind, duration=1e-6).end.regime == Regime.CONTACT
    with pytest.raises(InvalidValue, match="regime"):
        simulate(oscillator, dataclasses.replace(behind, regime=Regime.INSIDE), duration=1e-6)


def test_one_regime_for_each_stop():
    """Of a single stop a tuple of one says the same as a number, and a longer one is refused."""
    oscillator = modes_on_stop(9.0, 0.1, law=LinearContact(stiffness=STIFF))
    start = State(displacement=[0.02], velocity=[0.0], regime=1)
    starts = (dataclasses.replace(start, regime=regime) for regime in (1, (1,)))
    one, other = (simulate(oscillator, begun, duration=1.0) for begun in starts)
    assert one.end.displacement == other.end.displacement
    with pytest.raises(InvalidValue, match=r"regime of the state has 2 entries; it must have one for each"):
        simulate(oscillator, dataclasses.replace(start, regime=(1, 0)), duration=1.0)
