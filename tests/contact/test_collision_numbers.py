"""Each number of a collision by its definition, and the relations between them."""

import dataclasses
import math

import numpy as np
import pytest
from letters_spring import HERTZ, KICK_MODES
from oscillators import GAP, OMEGA, light_tip, modes_on_stop, newton, slow, steady
from scipy.optimize import brentq
from simulated_orbit import beam

import contact
from beam import InvalidValue
from contact import ContactLaw, ImpactOscillator, before_collision, collisions, first_collision, simulate

CASES = [(6, newton(0.3), 21.5), (6, contact.HertzContact(stiffness=3e7), 21.5), (2, newton(1.0), 12.0)]
CASES += [(4, contact.HuntCrossley(stiffness=3e7, dissipation=2.0), 21.5), (6, newton(0.3), 24.525)]
CASES += slow((6, contact.LinearContact(stiffness=3e4), 21.5))


def flow(oscillator: ImpactOscillator, u: float, v: float, span: float, k: int = 0) -> tuple[float, float]:
    """Free displacement and velocity of under-damped mode k after `span`, by its complex eigenvalue."""
    half = 0.5 * float(oscillator.model.decay_rate[k])
    pole = complex(-half, math.sqrt(float(oscillator.model.omega[k]) ** 2 - half**2))
    c = (v - pole.conjugate() * u) / (2j * pole.imag)  # u = 2 Re(c), v = 2 Re(pole c)
    turned = c * np.exp(pole * span)
    return 2 * turned.real, 2 * (pole * turned).real


@pytest.mark.parametrize("n_modes, law, frequency", CASES, ids=repr)
def test_every_number_is_what_its_definition_says(n_modes: int, law: ContactLaw, frequency: float) -> None:
    """The virtual motions by complex exponentials on a fine grid, collision by collision of a long run.

    At 12 Hz, near half the frequency of mode 1, they have two humps in a drive period.  At 24.525 Hz, in
    resonance, some collisions begin before a strobe and end after it.
    """
    excess, late = 0.05 if frequency > 20 else 0.8, frequency > 24.0
    oscillator = light_tip(n_modes, law, damping=0.01, frequency=frequency, excess=excess, turned=late)
    run = simulate(oscillator, before_collision(oscillator), periods=60)
    found = collisions(run, unfinished="drop")
    impacts, period = run.impacts, oscillator.period
    assert len(found) > 20
    starts = impacts.start[impacts.kind == 0]  # each belongs to one collision
    edges = np.searchsorted(starts, [c.first_touch for c in found])
    np.testing.assert_array_equal(np.diff(edges), [c.impacts for c in found[:-1]])
    returned = refused = over = 0
    for c in found:
        rows = np.flatnonzero((impacts.start >= c.first_touch) & (impacts.end <= c.end) & (impacts.kind != 1))
        first, last = rows[0], rows[-1]
        over += impacts.stretch[first] < impacts.stretch[last]

        def virtual(time, at, displacement, velocity, oscillator=oscillator):
            q, rate = steady(oscillator, at)
            u, v = flow(oscillator, displacement[0] - q[0], velocity[0] - rate[0], time - at)
            w, tip = oscillator.drive.angular_frequency, oscillator.model.phi
            size = oscillator.drive.amplitude * (tip @ oscillator.steady_response())
            turning = size * np.exp(1j * w * time)
            return turning.imag + tip[0] * u - GAP, (1j * w * turning).imag + tip[0] * v

        def incoming(time, virtual=virtual, i=first):
            return virtual(time, impacts.start[i], impacts.displacement_start[i], impacts.velocity_start[i])

        def outgoing(time, virtual=virtual, i=last):
            return virtual(time, impacts.end[i], impacts.displacement_end[i], impacts.velocity_end[i])

        def hump(motion, near):
            grid = near + np.linspace(-0.6, 0.6, 241) * period
            speed = motion(grid)[1]
            turns = np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))
            tops = [brentq(lambda t: motion(t)[1], grid[i], grid[i + 1], xtol=1e-16) for i in turns]
            return min(tops, key=lambda t: abs(t - near))

        def sides(motion, near):
            top = hump(motion, near)
            if motion(top)[0] <= 0:
                return None
            out = []
            for side in (-1, 1):
                far = top
                while motion(far)[0] > 0:
                    far += side * 0.002 * period
                ends = sorted((far, top))
                out.append(brentq(lambda t: motion(t)[0], *ends, xtol=1e-17, rtol=1e-15))
            return out

        touched = sides(incoming, c.first_touch)
        assert c.forced_by_ringing == (touched is None)
        t_in = c.first_touch if touched is None else touched[0]
        assert c.time == pytest.approx(t_in, abs=1e-12)
        v_in = incoming(t_in)[1]
        jump = np.subtract(outgoing(t_in), incoming(t_in))
        assert c.shift == pytest.approx(jump[0], abs=1e-13)
        assert c.kick_velocity == pytest.approx(-jump[1], abs=1e-11)
        left = sides(outgoing, t_in)
        assert c.returns == (left is not None)
        if c.forced_by_ringing:
            assert math.isnan(c.approach) and math.isnan(c.kick)
        else:
            assert c.approach == pytest.approx(v_in, rel=1e-10)
            assert c.kick == pytest.approx(-jump[1] / v_in, abs=1e-8)
        if touched is None or left is None:
            refused += 1
            assert math.isnan(c.restitution) and math.isnan(c.delay)
        else:
            returned += 1
            # rounding moves the sides of a low hump: times and speeds there lose up to half their digits
            height = min(incoming(hump(incoming, c.first_touch))[0], outgoing(hump(outgoing, t_in))[0])
            slack = 1e-15 * math.sqrt(GAP / height)
            assert c.delay == pytest.approx(left[1] - t_in, abs=20 * slack)
            assert c.restitution == pytest.approx(-outgoing(left[1])[1] / v_in, abs=1e4 * slack)
        gain = 0.0
        before, after = steady(oscillator, impacts.start[first]), steady(oscillator, impacts.end[last])
        for k in range(1, n_modes):
            u, v = impacts.displacement_start[first, k], impacts.velocity_start[first, k]
            u, v = flow(oscillator, u - before[0][k], v - before[1][k], c.end - c.first_touch, k)
            q = impacts.displacement_end[last, k] - after[0][k]
            rate = impacts.velocity_end[last, k] - after[1][k]
            gain += 0.5 * (rate**2 - v**2 + OMEGA[k] ** 2 * (q**2 - u**2))
        assert c.energy_to_higher_modes == pytest.approx(gain, abs=1e-11 * (OMEGA[0] * GAP) ** 2)
        assert c.real_approach == impacts.approach[first]
        assert c.energy_lost == pytest.approx(float(np.sum(impacts.loss[rows])), rel=1e-12, abs=1e-18)
        assert c.contact_time == pytest.approx(float(np.sum((impacts.end - impacts.start)[rows])), abs=1e-15)
        slopes = [incoming(t_in + h)[1] for h in (-1e-6, 1e-6)]
        assert c.deceleration == pytest.approx(-(slopes[1] - slopes[0]) / 2e-6, rel=1e-5)
    assert returned > 3 and returned + refused == len(found) and (over > 0) == late


@pytest.mark.parametrize("before_minimum", [1e-3, 1e-6, -1e-6, -1e-3])
def test_minimum_of_the_outgoing_motion_ends_a_collision(before_minimum: float) -> None:
    """A second touch, made up to change nothing, counts to the first until the minimum and no longer."""
    oscillator = modes_on_stop(2 * math.pi, gap=0.0)
    # swinging through the wall at t = 1 with velocity 1, out with 1/2: minimum a quarter period later
    real = simulate(oscillator, contact.State(displacement=[0.0], velocity=[-1.0], time=0.5), duration=2.2)
    assert real.impacts.start[0] == pytest.approx(1.0, abs=1e-15)
    second = 1.25 - before_minimum
    angle = 2 * math.pi * (second - 1.0)
    state = [[-math.sin(angle) / (4 * math.pi)], [-0.5 * math.cos(angle)]]
    hit, none = real.impacts, np.zeros(2)
    before = hit.displacement_start[0], hit.velocity_start[0]
    after = hit.displacement_end[0], hit.velocity_end[0]
    times = np.array([[hit.start[0], second], [hit.end[0], second]])
    states = np.array([[before, state], [after, state]])
    numbers = dict(approach=none, rebound=none, loss=none, kind=none.astype(int))
    touches = contact.Impacts.of_states(oscillator, times=times, states=states, **numbers)
    found = collisions(dataclasses.replace(real, impacts=touches), unfinished="drop")
    assert [c.impacts for c in found] == ([2] if before_minimum > 0 else [1, 1])
    assert found[0].kick == pytest.approx(1.5, rel=1e-12)
    assert found[0].restitution == pytest.approx(0.5, rel=1e-12)


def test_touches_of_another_program_need_all_their_numbers() -> None:
    none = dict(times=np.zeros((2, 0)), states=np.zeros((2, 0, 2, 1)))
    with pytest.raises(InvalidValue, match="columns has loss; it must have approach, kind, loss, rebound"):
        contact.Impacts.of_states(beam(22.2, HERTZ, modes=1), **none, loss=[])


@pytest.mark.parametrize("frequency", [20.90, 22.20, 23.40])
def test_two_relations_of_a_single_contact_of_the_letters_spring(frequency: float) -> None:
    """restitution^2 = (1 - kick)^2 + 2 a shift/v^2, delay = (v/a)(1 + restitution - kick), within 3e-3."""
    oscillator = beam(frequency, HERTZ, modes=KICK_MODES)
    kicks, restitutions = [], []
    for excess in (1e-5, 1e-4, 1e-3, 5e-3, 1.3e-2, 3e-2, 5e-2):
        c = first_collision(oscillator.with_excess(excess))
        assert c.impacts == 1 and c.returns and not c.forced_by_ringing
        a, v = c.deceleration, c.approach
        assert a == pytest.approx((2 * math.pi * frequency) ** 2 * oscillator.stop.gap, rel=1e-9)
        assert abs(c.restitution**2 - (1 - c.kick) ** 2 - 2 * a * c.shift / v**2) < 3e-3
        assert abs(c.delay * a / v - (1 + c.restitution - c.kick)) < 3e-3
        # shift = kick v t_c / 2 to the same order: the contact acts at its middle
        square = (1 - c.kick) ** 2 + c.kick * c.contact_time * a / v
        assert c.restitution**2 == pytest.approx(square, abs=6e-3)
        kicks.append(c.kick)
        restitutions.append(c.restitution)
    # slow approaches are not kicked at all, and the kick rises with the speed
    assert kicks[0] < 0.15 and restitutions[0] > 0.98
    assert np.all(np.diff(kicks) > 0) and kicks[-1] > 1 and np.all(np.diff(restitutions) < 0)
