"""Collisions account for their energy and do not depend on where the motion is started."""

import numpy as np
import pytest
from oscillators import GAP, LIGHT, equation_1, light_tip, newton, steady

import contact


def change_of_mode_1(c: contact.Collision, oscillator: contact.ImpactOscillator) -> float:
    """Energy gained by the free motion of mode 1, from the collision's own numbers at t_in [J]."""
    phi, omega = float(oscillator.model.phi[0]), float(oscillator.model.omega[0])
    q, rate = steady(oscillator, c.time)
    x = oscillator.stop.gap - float(oscillator.model.phi @ q)
    v = c.approach - float(oscillator.model.phi @ rate)
    after = (v - c.kick_velocity) ** 2 + omega**2 * (x + c.shift) ** 2
    return 0.5 * (after - v**2 - (omega * x) ** 2) / phi**2


HERTZ, DASHPOT = contact.HertzContact(stiffness=3e7), contact.LinearContact(stiffness=3e5, damping=10.0)
LOSSLESS = newton(1.0), HERTZ, contact.LinearContact(stiffness=3e4)
LOSSY = newton(0.0), newton(0.5), DASHPOT, contact.HuntCrossley(stiffness=3e7, dissipation=2.0)


@pytest.mark.parametrize("law", [*LOSSLESS, *LOSSY], ids=repr)
@pytest.mark.parametrize("n_modes", [1, 2, 6])
def test_energy_of_an_undriven_collision_is_all_accounted_for(n_modes: int, law: contact.ContactLaw) -> None:
    """Without drive and damping: gain of mode 1 + gain of the higher modes + loss = 0, time and again."""
    oscillator = light_tip(n_modes, law, excess=None, damping=0.0)
    state = contact.State(displacement=-0.0009 * np.eye(n_modes)[0], velocity=np.zeros(n_modes))
    first = float(oscillator.energy(state.displacement, state.velocity))
    found = contact.collisions(contact.simulate(oscillator, state, duration=0.4), unfinished="drop")
    used = [c for c in found if not c.forced_by_ringing]
    plastic = n_modes == 1 and law == newton(0.0)  # nothing is left that could reach the wall again
    assert len(used) >= (1 if plastic else 3)
    for c in used:
        total = change_of_mode_1(c, oscillator) + c.energy_to_higher_modes + c.energy_lost
        assert abs(total) < 1e-11 * first
    assert (abs(used[0].energy_lost) < 1e-13 * first) == (law in LOSSLESS)
    assert (used[0].energy_to_higher_modes > 0.01 * first) == (n_modes > 1)
    assert used[0].ringing < 1e-12 and (used[-1].ringing > 3e-5) == (n_modes > 1)


SAME = {name: 1.0 for name in ("approach", "restitution", "kick", "kick_velocity", "deceleration")}
SAME |= {"real_approach": 1.0, "delay": 1e-2, "contact_time": 1e-2, "ringing": GAP, "shift": 1e-3}
SAME |= {"energy_to_higher_modes": 1e-3, "energy_lost": 1e-3}
"""Numbers of a collision, and sizes on which their rounding is measured."""


@pytest.mark.parametrize("law", [HERTZ, DASHPOT, newton(0.4)], ids=repr)
def test_collision_does_not_depend_on_where_the_motion_is_started(law: contact.ContactLaw) -> None:
    """Started anywhere along the same motion, or whole drive periods later."""
    oscillator = light_tip(6, law)
    start = contact.before_collision(oscillator)
    run = contact.simulate(oscillator, start, periods=40)
    found = contact.collisions(run, unfinished="drop")
    chosen, before = found[4], found[3].end
    times = before + np.array([0.05, 0.3, 0.6, 0.95, 0.9999]) * (chosen.first_touch - before)
    along = contact.simulate(oscillator, start, periods=40, times=times)
    for i, later in ((0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (2, 1), (2, 1000), (4, 100_000)):
        shift = later * oscillator.period
        here = dict(displacement=along.displacement[i], velocity=along.velocity[i])
        again = contact.first_collision(oscillator, contact.State(**here, time=times[i] + shift))
        assert again.impacts == chosen.impacts and again.returns == chosen.returns
        loose = 1 + 3e3 * shift  # rounding of the time, 1e-12 s after 1e5 periods
        assert again.time - shift == pytest.approx(chosen.time, abs=1e-12 * loose)
        # rounding grows with the ratio of the higher modes' velocities to what mode 1 takes up
        for name, size in SAME.items():
            digits = dict(rel=1e-9 * loose, abs=1e-9 * loose * size, nan_ok=True)
            assert getattr(again, name) == pytest.approx(getattr(chosen, name), **digits), name


def test_first_collision_looks_for_one_long_enough_or_says_so() -> None:
    resting = equation_1(23.4, newton(0.3), excess=-0.02)
    from_rest = contact.first_collision(resting, contact.State.rest(1))
    run = contact.simulate(resting, periods=64)
    assert from_rest == contact.collisions(run, unfinished="drop")[0]
    assert from_rest.first_touch > 3 / 23.4  # not within the first try of three periods
    below = equation_1(22.2, newton(0.3), excess=-0.01)
    with pytest.raises(ValueError, match="periods is 64"):
        contact.first_collision(below)
    with pytest.raises(ValueError, match="periods is 2"):
        contact.first_collision(resting, contact.State.rest(1), periods=2)
    with pytest.raises(ValueError, match="drive"):
        contact.first_collision(light_tip(2, newton(0.3), excess=None))


def test_before_collision_is_the_lowest_point_of_the_steady_motion() -> None:
    oscillator = light_tip(6, newton(0.3))
    state = contact.before_collision(oscillator)
    assert 0 <= state.time < oscillator.period
    q, rate = steady(oscillator, state.time)
    np.testing.assert_allclose(state.displacement, q, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(state.velocity, rate, rtol=1e-10, atol=1e-12)
    assert float(LIGHT @ state.displacement) == pytest.approx(-1.05 * GAP, rel=1e-12)
    assert abs(float(LIGHT @ state.velocity)) < 1e-12
