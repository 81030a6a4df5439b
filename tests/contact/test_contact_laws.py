"""Laws of the contact: their constants, one contact at a time, and what they refuse."""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from dataclasses import dataclass

import numpy as np
import pytest
from oscillators import FREQUENCY, GAP, PHI, heights, spring
from scipy.integrate import solve_ivp

from beam import ModalModel, SuspiciousValue
from contact.drive import HarmonicDrive
from contact.errors import ContactTooStiff, UnresolvedCrossing
from contact.laws import (
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State

PERIOD = 1 / FREQUENCY
FREE, IN_CONTACT, WAITING = 0, 1, 4

HERTZ = HertzContact(stiffness=3e7)
SOFTER = HertzContact(stiffness=1e6)
LOSSY = HuntCrossley(stiffness=3e7, dissipation=1.2)
SPRING = LinearContact(stiffness=3e5)
DASHPOT = LinearContact(stiffness=3e5, damping=15.0)


@dataclass
class Contact:
    """One contact, integrated."""

    end: float
    displacement: np.ndarray
    velocity: np.ndarray
    loss: float
    samples: np.ndarray


def integrate_contact(
    oscillator: ImpactOscillator,
    start: float,
    displacement: np.ndarray,
    velocity: np.ndarray,
    times: np.ndarray,
) -> Contact:
    """The modal equations under the law's force by DOP853, from a touch to the release."""
    model, law, gap = oscillator.model, oscillator.stop.law, oscillator.stop.gap
    n = model.omega.size
    load = np.zeros(n) if oscillator.load is None else oscillator.load
    w = oscillator.drive.angular_frequency if oscillator.drive else 0.0
    push = model.participation * (oscillator.drive.amplitude if oscillator.drive else 0.0) * w**2

    def force(y):
        d, rate = model.phi @ y[:n] - gap, model.phi @ y[n : 2 * n]
        if isinstance(law, LinearContact):
            return max(0.0, law.stiffness * d + law.damping * rate)
        chi = law.dissipation if isinstance(law, HuntCrossley) else 0.0
        return law.stiffness * max(d, 0.0) ** 1.5 * (1 + chi * rate)

    def right(t, y):
        pushed = force(y)
        free = load + push * math.sin(w * t) - model.decay_rate * y[n : 2 * n] - model.omega**2 * y[:n]
        return np.concatenate(
            [y[n : 2 * n], free - model.phi * pushed, [pushed * (model.phi @ y[n : 2 * n])]]
        )

    def height(t, y):
        return model.phi @ y[:n] - gap

    height.terminal, height.direction = True, -1
    y = np.concatenate([displacement, velocity, [0.0]])
    settings = dict(method="DOP853", rtol=1e-13, atol=1e-19, dense_output=True)
    # d^(3/2) has no third derivative at the touch: a short first stretch keeps its order out of the rest
    first = solve_ivp(right, (start, start + 1e-7), y, max_step=5e-9, **settings)
    rest = solve_ivp(
        right, (start + 1e-7, start + 0.1), first.y[:, -1], max_step=1e-5, events=height, **settings
    )
    assert rest.status == 1, "it was never let go"
    at = np.array([(first if t < first.t[-1] else rest).sol(t)[: 2 * n] for t in times]).reshape(-1, 2 * n)
    return Contact(rest.t[-1], rest.y[:n, -1], rest.y[n : 2 * n, -1], rest.y[-1, -1], at)


# ------------------------------------------------------------------------------------------ Hertz's constant


def test_hertz_stiffness_is_that_of_the_contact_circle():
    """The textbook's way: a circle of radius a with a^2 = R d, 1/E* of both bodies, N = (4/3) E* a^3 / R."""
    radius, ball, plate = 2.5e-3, (370e9, 0.22), (210e9, 0.30)
    law = HertzContact.of_bodies(
        radius=radius,
        youngs_modulus=ball[0],
        poissons_ratio=ball[1],
        other_modulus=plate[0],
        other_ratio=plate[1],
    )
    plane_strain = 1 / sum((1 - nu**2) / modulus for modulus, nu in (ball, plate))
    for depth in (1e-8, 3e-6):
        circle = math.sqrt(radius * depth)
        force = 4 * plane_strain * circle**3 / (3 * radius)
        assert law.stiffness * depth**1.5 == pytest.approx(force, rel=1e-14)
        # the largest pressure of the half ellipsoid, and the approach that the circle's own integral gives
        pressure = 1.5 * force / (math.pi * circle**2)
        assert math.pi * circle * pressure / (2 * plane_strain) == pytest.approx(depth, rel=1e-14)
    assert law.stiffness == pytest.approx(9.65e9, rel=1e-3)


def test_hertz_stiffness_of_two_bodies_is_symmetric_and_adds_compliances():
    numbers = dict(
        radius=1e-3, youngs_modulus=70e9, poissons_ratio=0.33, other_modulus=400e9, other_ratio=0.2
    )
    swapped = dict(
        radius=1e-3, youngs_modulus=400e9, poissons_ratio=0.2, other_modulus=70e9, other_ratio=0.33
    )
    mixed = HertzContact.of_bodies(**numbers).stiffness
    assert mixed == pytest.approx(HertzContact.of_bodies(**swapped).stiffness, rel=1e-15)
    pure = [
        HertzContact.of_bodies(
            radius=1e-3, youngs_modulus=e, poissons_ratio=nu, other_modulus=e, other_ratio=nu
        )
        for e, nu in ((70e9, 0.33), (400e9, 0.2))
    ]
    assert 2 / mixed == pytest.approx(1 / pure[0].stiffness + 1 / pure[1].stiffness, rel=1e-14)
    assert mixed < pure[1].stiffness
    bigger = HertzContact.of_bodies(**numbers | dict(radius=4e-3))
    assert bigger.stiffness == pytest.approx(2 * mixed, rel=1e-15)
    with pytest.warns(SuspiciousValue, match="other_modulus"):
        rigid = HertzContact.of_bodies(**numbers | dict(other_modulus=1e25)).stiffness
    assert rigid == pytest.approx(4 / 3 * math.sqrt(1e-3) * 70e9 / (1 - 0.33**2), rel=1e-13)


# --------------------------------------------------------------------------------- one contact at a time



def name_of(value: object) -> str:
    """A test's name for a parameter: its text without addresses, which differ between processes."""
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:80]


FORCES = [HERTZ, SOFTER, LOSSY, SPRING]
"""Laws that let go at the wall only: the integration above ends at the first fall through it."""


@pytest.mark.parametrize("law", FORCES, ids=repr)
@pytest.mark.parametrize("n_modes", [1, 6])
def test_contacts_are_those_of_an_independent_integration(n_modes, law):
    """Contacts of a driven, damped, loaded motion: state at the release, duration, loss, samples inside."""
    oscillator = spring(n_modes, law, drive=(FREQUENCY, 2.2e-3), load=np.full(n_modes, 30.0))
    run = simulate(oscillator, periods=12)
    impacts = run.impacts
    count = 8
    assert len(impacts) > count
    inside = [
        start + share * (end - start)
        for start, end in zip(impacts.start[:count], impacts.end[:count], strict=True)
        for share in (1e-3, 0.2, 0.5, 0.9, 0.999)
    ]
    sampled = simulate(oscillator, periods=12, times=inside)
    np.testing.assert_array_equal(sampled.impacts.start, impacts.start)
    np.testing.assert_array_equal(sampled.end.displacement, run.end.displacement)
    tip_speeds = sampled.velocity @ oscillator.model.phi
    for i in range(count):
        touch = impacts.start[i], impacts.displacement_start[i], impacts.velocity_start[i]
        these = slice(5 * i, 5 * i + 5)
        contact = integrate_contact(oscillator, *touch, np.array(inside[these]))
        span = contact.end - impacts.start[i]
        speed = impacts.approach[i]
        assert impacts.end[i] - impacts.start[i] == pytest.approx(span, rel=2e-10)
        scale_q, scale_v = np.max(np.abs(touch[1])), np.max(np.abs(touch[2]))
        np.testing.assert_allclose(
            impacts.displacement_end[i], contact.displacement, rtol=0, atol=1e-11 * scale_q
        )
        np.testing.assert_allclose(impacts.velocity_end[i], contact.velocity, rtol=0, atol=1e-10 * scale_v)
        assert impacts.loss[i] == pytest.approx(contact.loss, abs=1e-11 * speed**2)
        mine = np.hstack([sampled.displacement[these], sampled.velocity[these]])
        scale = np.repeat([scale_q, scale_v], n_modes)
        assert np.max(np.abs(mine - contact.samples) / scale) < 1e-10
        assert tip_speeds[these][0] > 0.9 * speed and tip_speeds[these][-1] < 0


@pytest.mark.parametrize("law", [HERTZ, LOSSY, SPRING], ids=repr)
def test_contacts_of_a_body_pressed_by_its_weight(law):
    """A rigid motion under a constant load beside one that bends: the load acts during the contact too."""
    omega = np.array([0.0, 2 * np.pi * 60.0])
    model = ModalModel(omega=omega, decay_rate=[0.3, 2.0], phi=[5.0, 4.0], participation=[0.0, 0.0])
    load = np.array([60.0, 20.0])
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.001, law=law), load=load)
    impacts = simulate(oscillator, duration=0.06).impacts
    count = np.count_nonzero(np.isfinite(impacts.end))
    assert count >= 2
    weightless = dataclasses.replace(oscillator, load=None)
    for i in range(min(count, 4)):
        touch = impacts.start[i], impacts.displacement_start[i], impacts.velocity_start[i]
        contact = integrate_contact(oscillator, *touch, np.zeros(0))
        assert impacts.end[i] - impacts.start[i] == pytest.approx(contact.end - impacts.start[i], rel=1e-9)
        scale = np.max(np.abs(touch[2]))
        np.testing.assert_allclose(impacts.velocity_end[i], contact.velocity, rtol=0, atol=1e-10 * scale)
        other = integrate_contact(weightless, *touch, np.zeros(0))
        assert abs(other.end - contact.end) > 1e-4 * (contact.end - impacts.start[i])


@pytest.mark.parametrize("law", [*FORCES, DASHPOT], ids=repr)
def test_touch_and_release_lie_on_the_wall_to_rounding(law):
    """Heights there are a few rounding errors of the sum over modes; signs are right on either side."""
    oscillator = spring(6, law, drive=(FREQUENCY, 2.2e-3))
    run = simulate(oscillator, periods=60)
    impacts = run.impacts
    finished = np.isfinite(impacts.end)
    assert finished.sum() > 35
    touch = heights(oscillator, impacts.displacement_start)
    release = heights(oscillator, impacts.displacement_end[finished])
    rounding = 2.2e-16 * 4 * (GAP + np.max(np.abs(impacts.displacement_start) @ PHI))
    assert np.max(np.abs(touch)) < 2 * rounding
    assert np.max(np.abs(release)) < 20 * rounding
    np.testing.assert_allclose(impacts.velocity_start @ PHI, impacts.approach, rtol=1e-12)
    np.testing.assert_allclose(impacts.velocity_end[finished] @ PHI, impacts.rebound[finished], rtol=1e-10)
    assert np.all(impacts.approach > 0) and np.all(impacts.rebound[finished] < 0)
    near = 1e-3 * (impacts.end[finished] - impacts.start[finished])
    around = np.stack([impacts.start[finished] - near, impacts.start[finished] + near,
                       impacts.end[finished] - near, impacts.end[finished] + near])  # fmt: skip
    sampled = simulate(oscillator, periods=60, times=np.sort(around.ravel()))
    signs = np.sign(heights(oscillator, sampled.displacement)).reshape(-1, 4)
    assert np.all(signs == [-1, 1, 1, -1])


@pytest.mark.parametrize("law", [HERTZ, SOFTER], ids=repr)
def test_energy_is_kept_over_1e4_hertz_contacts_of_a_conservative_spring(law):
    """1e-11 in all: each contact is good to rounding, and their errors add up as those of a random walk."""
    oscillator = spring(6, law, damping=0.0)
    state = State(displacement=[-0.002, 0, 0, 0, 0, 0], velocity=np.zeros(6))
    run = simulate(oscillator, state, duration=280.0)
    assert len(run.impacts) > 10_000
    first = oscillator.energy(state.displacement, state.velocity)
    for q, v in (
        (run.impacts.displacement_start, run.impacts.velocity_start),
        (run.impacts.displacement_end[:-1], run.impacts.velocity_end[:-1]),
    ):
        assert np.max(np.abs(oscillator.energy(q, v) / first - 1)) < 1e-11
    finished = np.isfinite(run.impacts.loss)
    assert np.max(np.abs(run.impacts.loss[finished])) < 1e-13 * first


def test_stop_stores_what_the_spring_has_lost_in_the_middle_of_a_contact():
    """Modes plus (2/5) k d^(5/2), or (1/2) k d^2 for a linear law, is the same at every instant."""
    for law, stored in (
        (SOFTER, lambda d: 0.4 * SOFTER.stiffness * d**2.5),
        (SPRING, lambda d: 0.5 * SPRING.stiffness * d**2),
    ):
        oscillator = spring(6, law, damping=0.0)
        state = State(displacement=[-0.002, 0, 0, 0, 0, 0], velocity=np.zeros(6))
        run = simulate(oscillator, state, duration=0.08, times=np.linspace(0, 0.08, 4001))
        depth = np.maximum(heights(oscillator, run.displacement), 0.0)
        energy = oscillator.energy(run.displacement, run.velocity)
        first = energy[0]
        assert np.max(stored(depth)) > 0.05 * first
        assert np.max(np.abs(energy + stored(depth) - first)) < 1e-12 * first
        assert np.min(energy) < 0.95 * first


@pytest.mark.parametrize(
    "law",
    [LOSSY, HuntCrossley(stiffness=1e6, dissipation=0.2), DASHPOT,
     LinearContact(stiffness=1e5, damping=60.0)],
    ids=name_of,
)  # fmt: skip
@pytest.mark.parametrize("n_modes", [1, 6])
def test_losses_reported_are_the_energy_that_is_gone(n_modes, law):
    oscillator = spring(n_modes, law, damping=0.0)
    start = np.zeros(n_modes)
    start[0] = -0.003
    state = State(displacement=start, velocity=np.zeros(n_modes))
    run = simulate(oscillator, state, duration=1.0)
    impacts = run.impacts
    first = oscillator.energy(state.displacement, state.velocity)
    each = oscillator.energy(impacts.displacement_start, impacts.velocity_start) - oscillator.energy(
        impacts.displacement_end, impacts.velocity_end
    )
    finished = np.isfinite(impacts.loss)
    assert finished.sum() > 10 and run.end.regime == FREE
    np.testing.assert_allclose(each[finished], impacts.loss[finished], rtol=0, atol=1e-12 * first)
    gone = first - oscillator.energy(run.end.displacement, run.end.velocity)
    assert gone == pytest.approx(impacts.loss[finished].sum(), rel=1e-11)
    assert gone > 0.02 * first and np.all(impacts.loss[finished] > 0)


def test_hunt_crossley_without_dissipation_is_hertz():
    state = State(displacement=[-0.003, 0, 0, 0], velocity=np.zeros(4))
    elastic = HuntCrossley(stiffness=3e7, dissipation=0.0)
    runs = [simulate(spring(4, law, drive=(FREQUENCY, 2e-3)), state, periods=20) for law in (HERTZ, elastic)]
    np.testing.assert_array_equal(runs[0].impacts.end, runs[1].impacts.end)
    np.testing.assert_array_equal(runs[0].end.velocity, runs[1].end.velocity)
    nearly = HuntCrossley(stiffness=3e7, dissipation=1e-4)
    third = simulate(spring(4, nearly, drive=(FREQUENCY, 2e-3)), state, periods=20)
    assert not np.array_equal(third.impacts.end, runs[0].impacts.end)


@pytest.mark.xfail(strict=True, reason="the force k d^(3/2) (1 + chi d') pulls where d' < -1/chi")
def test_hunt_crossley_never_pulls() -> None:
    """A mass thrown at the wall and drawn back by a load: at the end it leaves faster than 1/chi."""
    law = HuntCrossley(stiffness=1e6, dissipation=4.9)
    mass = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(model=mass, stop=Stop(gap=0.0, law=law), load=np.array([-50.0]))
    state = State(displacement=[-1e-6], velocity=[1.0])
    impacts = simulate(oscillator, state, duration=0.05).impacts
    times = np.linspace(impacts.start[0], impacts.end[0], 1001)
    run = simulate(oscillator, state, duration=0.05, times=times)
    acceleration = np.diff(run.velocity[:, 0]) / np.diff(times)
    assert np.max(acceleration) < -50.0 + 50.0 * 1e-6


# ----------------------------------------------------------------------------- a strobe within a contact


STRADDLERS = [
    (4, HERTZ), (1, SOFTER), (4, LOSSY), (4, SPRING), (4, DASHPOT),
    (1, DelayedRestitution(restitution=0.3, delay=4e-4)),
    (1, DelayedRestitution(restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 4e-4 + 1e-4 * v)),
]  # fmt: skip


@pytest.mark.parametrize("n_modes, law", STRADDLERS, ids=name_of)
@pytest.mark.parametrize("share", [0.02, 0.5, 0.98])
def test_strobe_within_a_contact_changes_nothing(n_modes, law, share):
    """Half a drive period later the same motion has its strobes elsewhere: once in the contact, once not."""

    def approaching(time: float) -> State:
        q, v = np.zeros(n_modes), np.zeros(n_modes)
        q[0], v[0] = (GAP - 1e-9) / PHI[0], 0.4 / PHI[0]
        return State(displacement=q, velocity=v, time=time)

    plain = spring(n_modes, law, drive=(FREQUENCY, 2e-3))
    turned = spring(n_modes, law, drive=(FREQUENCY, 2e-3), turned=True)
    # how long the contact lasts decides how long before the strobe it must begin
    trial = simulate(plain, approaching(0.98 * PERIOD), duration=0.01).impacts
    lead = share * (trial.end[0] - trial.start[0])
    for _ in range(3):
        trial = simulate(plain, approaching(PERIOD - lead), duration=0.01).impacts
        lead = share * (trial.end[0] - trial.start[0]) + 1e-9 / 0.4
    # the same floating-point times on both sides of the shift
    lead = float(np.float32(lead))
    length = 2.7 * PERIOD
    marks = np.sort(np.concatenate([[PERIOD], PERIOD - lead + np.linspace(0, length, 301)]))
    within = simulate(plain, approaching(PERIOD - lead), duration=length, times=marks)
    apart = simulate(
        turned, approaching(0.5 * PERIOD - lead), duration=length,
        times=np.clip(marks - 0.5 * PERIOD, 0.5 * PERIOD - lead, None),
    )  # fmt: skip
    unsampled = simulate(plain, approaching(PERIOD - lead), duration=length)
    assert within.impacts.start[0] < PERIOD < within.impacts.end[0]
    assert not 0 < apart.impacts.start[0] % PERIOD - apart.impacts.end[0] % PERIOD
    assert len(within.impacts) == len(apart.impacts) == len(unsampled.impacts) >= 2
    for name, scale in (("start", 1), ("end", 1), ("approach", 10), ("rebound", 10), ("loss", 1)):
        mine = getattr(within.impacts, name)
        theirs = getattr(apart.impacts, name) + (0.5 * PERIOD if name in ("start", "end") else 0.0)
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=2e-12 * scale)
        np.testing.assert_array_equal(mine, getattr(unsampled.impacts, name))
    assert np.max(np.abs(within.displacement - apart.displacement)) < 1e-12 * np.max(
        np.abs(apart.displacement)
    )
    assert np.max(np.abs(within.velocity - apart.velocity)) < 1e-10 * np.max(np.abs(apart.velocity))
    i = int(np.flatnonzero(marks == PERIOD)[0])
    np.testing.assert_allclose(within.strobe_displacement[0], within.displacement[i], rtol=1e-13, atol=1e-18)
    np.testing.assert_allclose(within.strobe_velocity[0], within.velocity[i], rtol=1e-10, atol=1e-12)
    np.testing.assert_array_equal(unsampled.end.displacement, within.end.displacement)


@pytest.mark.parametrize("n_modes, law", STRADDLERS, ids=name_of)
def test_run_cut_within_a_contact_goes_on_as_the_uncut_one(n_modes, law):
    oscillator = spring(n_modes, law, drive=(FREQUENCY, 2.2e-3))
    whole = simulate(oscillator, periods=12)
    impacts = whole.impacts
    assert len(impacts) >= 3
    for i, share in itertools.product((0, 2), (0.05, 0.6)):
        cut = impacts.start[i] + share * (impacts.end[i] - impacts.start[i])
        head = simulate(oscillator, duration=cut)
        assert head.end.regime in (IN_CONTACT, WAITING)
        assert math.isnan(head.impacts.end[-1]) and math.isnan(head.impacts.loss[-1])
        tail = simulate(oscillator, head.end, duration=12 * PERIOD - cut)
        np.testing.assert_allclose(tail.impacts.end, impacts.end[i:], rtol=0, atol=1e-11)
        assert np.max(np.abs(tail.end.velocity - whole.end.velocity)) < 1e-8 * np.max(
            np.abs(whole.end.velocity)
        )


# ------------------------------------------------------------------------------------- delayed restitution


def test_delayed_restitution_waits_on_the_wall_and_leaves_as_told():
    for law in (
        DelayedRestitution(restitution=0.25, delay=3e-4),
        DelayedRestitution(restitution=0.0, delay=3e-3),
        DelayedRestitution(restitution=1.0, delay=0.0),
        DelayedRestitution(restitution=lambda v: 0.2 + 0.1 * math.sin(v), delay=lambda v: 1e-4 / (1 + v)),
        DelayedRestitution(restitution=0.4, delay=lambda v: 2e-4 * v**0.2),
    ):
        oscillator = spring(1, law, drive=(FREQUENCY, 2.2e-3))
        run = simulate(oscillator, periods=30)
        impacts = run.impacts
        finished = np.isfinite(impacts.end)
        assert finished.sum() > 10
        assert np.ptp(impacts.approach) > 0.02
        approach = impacts.approach[finished]
        tau = [law.restitution(v) if callable(law.restitution) else law.restitution for v in approach]
        delay = [law.delay(v) if callable(law.delay) else law.delay for v in approach]
        np.testing.assert_allclose(impacts.rebound[finished], -np.array(tau) * approach, rtol=0, atol=1e-9)
        waits = impacts.end[finished] - impacts.start[finished]
        np.testing.assert_allclose(waits, delay, rtol=0, atol=1e-12)
        loss = 0.5 * (approach**2 - impacts.rebound[finished] ** 2) / PHI[0] ** 2
        np.testing.assert_allclose(impacts.loss[finished], loss, rtol=1e-12, atol=1e-18)
        for q, v, speed in (
            (impacts.displacement_start[finished], impacts.velocity_start[finished], approach),
            (impacts.displacement_end[finished], impacts.velocity_end[finished], impacts.rebound[finished]),
        ):
            assert np.max(np.abs(heights(oscillator, q))) < 1e-16
            np.testing.assert_allclose(v @ oscillator.model.phi, speed, rtol=0, atol=1e-13)
        if np.max(waits) > 0:
            middles = (impacts.start + 0.5 * (impacts.end - impacts.start))[finished]
            held = simulate(oscillator, periods=30, times=middles)
            assert np.max(np.abs(heights(oscillator, held.displacement))) < 1e-16
            assert np.max(np.abs(held.velocity @ oscillator.model.phi)) < 1e-13


def test_delayed_restitution_without_delay_is_newtons():
    state = State(displacement=[0.0], velocity=[0.0])
    delayed = simulate(
        spring(1, DelayedRestitution(restitution=0.3, delay=0.0), drive=(FREQUENCY, 2.2e-3)),
        state, periods=40,
    )
    newton = simulate(
        spring(1, NewtonRestitution(local_restitution=0.3), drive=(FREQUENCY, 2.2e-3)), state, periods=40
    )
    assert len(newton.impacts) > 10
    np.testing.assert_allclose(delayed.impacts.start, newton.impacts.start, rtol=0, atol=1e-12)
    np.testing.assert_allclose(delayed.impacts.loss, newton.impacts.loss, rtol=0, atol=1e-12)
    np.testing.assert_allclose(delayed.strobe_velocity, newton.strobe_velocity, rtol=0, atol=1e-11)


def test_free_flight_after_the_wait_is_the_closed_form():
    """Undriven and undamped: one quarter swing in, the wait, half a period out with tau times the speed."""
    law = DelayedRestitution(restitution=0.5, delay=0.013)
    oscillator = ImpactOscillator(
        model=ModalModel(omega=[10.0], decay_rate=[0.0], phi=[2.0], participation=[0.0]),
        stop=Stop(gap=0.0, law=law),
    )
    run = simulate(oscillator, State(displacement=[-0.1], velocity=[0.0]), duration=2.0)
    quarter = math.pi / 20
    arrivals = quarter + np.arange(6) * (2 * quarter + 0.013)
    np.testing.assert_allclose(run.impacts.start, arrivals, rtol=1e-14)
    np.testing.assert_allclose(run.impacts.approach, 2.0 * 0.5 ** np.arange(6), rtol=1e-13)


def test_functions_of_the_speed_are_sampled_finely_and_end_level():
    def tau(v: float) -> float:
        return 0.9 * (1 + (v / 0.05) ** 0.2) ** -1.0

    def delay(v: float) -> float:
        return 2e-4 * v**-0.2

    law = DelayedRestitution(restitution=tau, delay=delay, speeds=(1e-3, 2.0))
    mass = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(model=mass, stop=Stop(gap=0.0, law=law))

    def bounce(v: float) -> tuple[float, float]:
        run = simulate(oscillator, State(displacement=[-v], velocity=[v]), duration=1.5)
        return -run.impacts.rebound[0] / v, run.impacts.end[0] - run.impacts.start[0]

    speeds = np.geomspace(1.001e-3, 1.99, 37)
    for v in speeds:
        found = bounce(v)
        assert found[0] == pytest.approx(tau(v), abs=1e-9)
        assert found[1] == pytest.approx(delay(v), abs=1e-12)
    for beyond, end in ((1e-5, 1e-3), (2.0, 2.0), (50.0, 2.0)):
        assert bounce(beyond) == pytest.approx((tau(end), delay(end)), rel=1e-12)


@pytest.mark.parametrize("n_modes", [2, 6])
def test_delayed_restitution_of_several_modes_is_refused(n_modes):
    law = DelayedRestitution(restitution=0.1, delay=1e-4)
    with pytest.raises(TypeError, match="DelayedRestitution"):
        spring(n_modes, law)
    assert spring(1, law).n_modes == 1


def test_the_ends_of_a_range_belong_to_it() -> None:
    assert [NewtonRestitution(local_restitution=e).numbers[0] for e in (0, 1)] == [0, 1]
    pair = dict(radius=2.5e-3, youngs_modulus=370e9, other_modulus=210e9)
    assert HertzContact.of_bodies(**pair, poissons_ratio=0.5, other_ratio=0.5).stiffness > 0


@pytest.mark.parametrize("ratio", [1e24, 1e26, 1e28, 1e40])
def test_a_contact_beyond_the_range_of_doubles_is_refused_and_does_not_hang(ratio: float) -> None:
    """Some 1e24 times the stiffness of the spring the series overflows; below that the impact is Newton's."""
    model = ModalModel(
        omega=[150.0, 900.0], decay_rate=[3.0, 9.0], phi=[10.0, 9.0], participation=[0.1, 0.05]
    )
    modal = float(model.omega[0] ** 2 / model.phi[0] ** 2)
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=0.01, law=LinearContact(stiffness=ratio * modal)),
        drive=HarmonicDrive(frequency=22.0),
    ).with_excess(0.01)  # fmt: skip
    try:
        run = simulate(oscillator, periods=60)
    except (ContactTooStiff, UnresolvedCrossing):
        return
    assert ratio < 1e27 and len(run.impacts) > 0
