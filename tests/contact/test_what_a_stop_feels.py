"""Largest force, impulse, duration and loss of a touch, and the time of rest, by other routes."""

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from oscillators import modes_on_stop, newton
from scipy.integrate import simpson

from contact import DelayedRestitution, ImpactKind, ImpactOscillator, Impacts, State, simulate
from contact.hertz import HertzContact, HuntCrossley
from contact.integrators import CentralDifference, Integrator, MoreauJean, Splitting
from contact.laws import ContactLaw, LinearContact

K, G = 1e5, 9.81
HERTZ = HertzContact(stiffness=1e8)
DASHPOT = LinearContact(stiffness=2e5, damping=20.0)
LOSING = [HuntCrossley(stiffness=1e8, dissipation=0.4), DASHPOT, LinearContact(stiffness=2e4, damping=100.0)]


mass = partial(modes_on_stop, 0.0, participation=1.0, gap=1e-3)
"""A free body of 1 kg before a stop."""


def thrown(law: ContactLaw, speed: float = 1.0, **method: Integrator) -> Impacts:
    """The touch of a free body of 1 kg."""
    start = State(displacement=[0.0], velocity=[speed])
    return simulate(mass(law=law), start, duration=0.05, **method).impacts


def spring(law: ContactLaw, *decay: float) -> ImpactOscillator:
    """Three modes driven at 22 Hz."""
    rows = [154.0, 980.0, 2900.0], decay, [10.0, 9.0, 8.0], [0.1, 0.05, 0.02]
    return modes_on_stop(*rows, law=law, drive=22.0)


@pytest.mark.parametrize("damping", [0.0, 3.0, 100.0, 300.0, 330.0, 500.0])
def test_linear_contact_has_its_closed_form(damping):
    """N = -x'' with x = Im(v/w exp(lambda t)); below zeta = 1/2 the force is largest where x''' = 0."""
    touch, w0 = thrown(LinearContact(stiffness=K, damping=damping), 0.7), math.sqrt(K)
    zeta = 0.5 * damping / w0
    w, angle = w0 * math.sqrt(1 - zeta**2), math.pi - math.acos(zeta)
    t = (-3 * angle) % math.pi / w if zeta < 0.5 else 0.0
    peak = -0.7 / w * w0**2 * math.exp(-zeta * w0 * t) * math.sin(w * t + 2 * angle)
    assert touch.peak_force[0] == pytest.approx(peak, rel=2e-14)
    assert touch.impulse[0] == pytest.approx(0.7 - touch.rebound[0], rel=1e-14)
    assert touch.loss[0] == pytest.approx(0.5 * (0.7**2 - touch.rebound[0] ** 2), rel=1e-13, abs=1e-14)


@pytest.mark.parametrize("law", [HERTZ, *LOSING[:2]])
def test_peak_of_many_modes_is_that_of_close_samples(law):
    """Three modes with several maxima in a touch; samples next to the largest are a second route."""
    oscillator = spring(law, 3.0, 9.0, 20.0).with_excess(0.4)
    impacts = simulate(oscillator, periods=8).impacts

    def pushed(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
        times = np.linspace(low, high, 2001)
        run = simulate(oscillator, periods=8, times=times)
        depth, rate = oscillator.tip(run.displacement) - oscillator.stop.gap, oscillator.tip(run.velocity)
        deep = np.maximum(depth, 0.0)
        if law is DASHPOT:
            return times, np.where(depth > 0, law.stiffness * deep + law.damping * rate, 0.0)
        return times, law.stiffness * deep**1.5 * (1.0 + getattr(law, "dissipation", 0.0) * rate)

    for i in range(4):
        times, force = pushed(impacts.start[i], impacts.end[i])
        at, width = times[force.argmax()], times[1] - times[0]
        near = force.max()
        for _ in range(2 if impacts.start[i] < at < impacts.end[i] else 0):
            times, force = pushed(at - width, at + width)
            at, width, near = times[force.argmax()], times[1] - times[0], force.max()
        assert impacts.peak_force[i] == pytest.approx(near, rel=1e-10)


@pytest.mark.parametrize("law", [newton(0.7), newton(0.0), HERTZ, LinearContact(stiffness=2e5), *LOSING])
@pytest.mark.parametrize("length", [0.3, 0.40123, 0.9])
def test_losses_close_the_energy_of_a_run_without_drive_and_damping(law, length):
    """Also where a contact or a stay is still closed at the end."""
    load = np.array([40.0, 0.0, 0.0])
    pressed = replace(spring(law, 0.0, 0.0, 0.0), drive=None, load=load)
    start = State(displacement=[-3e-3, 1e-4, 0.0], velocity=[0.3, 0.0, 0.2])
    run = simulate(pressed, start, duration=length)

    def energy(state: State) -> float:
        return float(pressed.energy(state.displacement, state.velocity) - load @ state.displacement)

    assert len(run.impacts) > 3 or law == newton(0.0)
    whole = float(pressed.energy(start.displacement, start.velocity))
    assert abs(energy(start) - energy(run.end) - run.impacts.loss.sum()) < 1e-12 * whole


def test_contact_still_closed_says_so():
    """It has force, impulse and work up to the end of the run, and no duration."""
    law = LinearContact(stiffness=K)
    begin, quarter = 1e-3, 0.5 * math.pi / math.sqrt(K)
    closed = mass(law=law)
    run = simulate(closed, State(displacement=[0.0], velocity=[1.0]), duration=begin + quarter / 3)
    touch = run.impacts
    assert math.isnan(touch.duration[0]) and math.isnan(touch.end[0])
    assert touch.peak_force[0] == pytest.approx(math.sqrt(K) * 0.5, rel=1e-12)
    assert touch.impulse[0] == pytest.approx(1 - math.cos(math.pi / 6), rel=1e-12)
    assert touch.loss[0] == pytest.approx(0.5 * 0.25, rel=1e-12)
    later = simulate(closed, run.end, duration=0.05).impacts
    assert later.kind[0] == ImpactKind.UNDER_WAY
    assert later.peak_force[0] == pytest.approx(math.sqrt(K), rel=1e-12)
    assert later.impulse[0] + touch.impulse[0] == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize("e, f, z", [(0.3, 5.0, 8e-3), (0.6, 5.0, 8e-3)])
def test_ball_on_a_shaken_table_comes_to_rest_at_the_end_of_its_hops(e, f, z):
    """Hops one by one in 40 digits, until they are shorter than 1e-17 s."""
    mpmath.mp.dps = 40
    w, g, height = 2 * mpmath.pi * mpmath.mpf(f), mpmath.mpf(G), mpmath.mpf("0.01")
    t, y, v, hop = mpmath.mpf(0), height, mpmath.mpf(0), mpmath.mpf("0.05")
    restitution, amplitude = mpmath.mpf(e), -mpmath.mpf(z)
    while hop > mpmath.mpf("1e-17"):

        def above(s, t=t, y=y, v=v):
            return y + v * s - g * s**2 / 2 - amplitude * mpmath.sin(w * (t + s))

        hop = mpmath.findroot(above, hop)
        t += hop
        table = amplitude * w * mpmath.cos(w * t)
        y, v = amplitude * mpmath.sin(w * t), table - restitution * (v - g * hop - table)
        hop = 2 * (v - table) / (g - amplitude * w**2 * mpmath.sin(w * t))
    oscillator = mass(law=newton(e), gap=0.01, load=G, drive=(f, z))
    start = State(displacement=[0.0], velocity=[-2 * math.pi * f * z])
    run = simulate(oscillator, start, duration=float(t) + 0.01)
    impacts = run.impacts
    (stay,) = np.flatnonzero(impacts.kind == ImpactKind.STAY)
    assert impacts.start[stay] == pytest.approx(float(t), abs=1e-12)
    assert oscillator.tip(impacts.displacement_start[stay]) == pytest.approx(0.01, abs=1e-17)
    angle = 2 * math.pi * f * np.linspace(impacts.start[stay], run.end.time, 400)
    pressing = G + z * (2 * math.pi * f) ** 2 * np.sin(angle)
    assert impacts.peak_force[stay] == pytest.approx(max(pressing), rel=1e-5)


@pytest.mark.parametrize("delay", [2e-3, 0.03])
def test_impulse_of_a_delayed_rebound_holds_the_tip_against_spring_and_drive(delay):
    """phi I = -(change of q' + c q + omega^2 times the integral of q), with the drive's own part; also of a
    wait over a strobe."""
    law = DelayedRestitution(restitution=0.4, delay=delay)
    oscillator = modes_on_stop([154.0], [30.0], [10.0], [0.1], law=law, drive=22.0).with_excess(0.3)
    whole = simulate(oscillator, periods=3)
    touch, release = whole.impacts.start[0], whole.impacts.end[0]
    assert (touch // oscillator.period < release // oscillator.period) == (delay > 2e-3)
    edges = [touch - 3e-3, touch, release, release + 3e-3]
    model, drive, area = oscillator.model, oscillator.driven, 0.0
    for low, high in pairwise(edges):
        times = np.linspace(low, high, 401)
        area += simpson(simulate(oscillator, periods=3, times=times).displacement[:, 0], x=times)
    ends = simulate(oscillator, periods=3, times=[edges[0], edges[-1]])
    w, (gamma,) = drive.angular_frequency, model.participation
    base = drive.amplitude * w * (math.cos(w * edges[-1]) - math.cos(w * edges[0]))
    left = np.diff(ends.velocity[:, 0])[0] + model.decay_rate[0] * np.diff(ends.displacement[:, 0])[0]
    expected = -(left + model.omega[0] ** 2 * area + gamma * base) / model.phi[0]
    assert whole.impacts.impulse[0] == pytest.approx(expected, rel=1e-8)
    assert math.isnan(whole.impacts.peak_force[0])
    lost = 0.5 * (whole.impacts.approach[0] ** 2 - whole.impacts.rebound[0] ** 2) / model.phi[0] ** 2
    assert whole.impacts.loss[0] == pytest.approx(lost, rel=1e-12)


@pytest.mark.parametrize("method", [Splitting, CentralDifference])
def test_methods_with_a_step_find_force_and_impulse_at_order_2(method):
    law = LinearContact(stiffness=K)
    exact, errors = thrown(law), []
    for step in (4e-6, 1e-6):
        found = thrown(law, method=method(step=step))
        pairs = [(found.peak_force[0], exact.peak_force[0]), (found.impulse[0], exact.impulse[0])]
        errors.append([abs(a / b - 1) for a, b in pairs])
    assert np.all(np.array(errors) < [[1e-5], [1e-6]])


def test_percussions_are_the_impulse():
    found = thrown(newton(0.5), method=MoreauJean(step=1e-5))
    assert found.impulse[0] == pytest.approx(1.5, rel=1e-12) and math.isnan(found.peak_force[0])
