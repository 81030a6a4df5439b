"""The extended reference: closed forms, its two routes, and the package's own exact methods."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp

from beam import ModalModel
from contact.collision import before_collision, first_collision
from contact.drive import HarmonicDrive
from contact.laws import ContactLaw, HertzContact, HuntCrossley, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.work_precision.errors import yardstick_of
from studies.instruments.work_precision.extended_flight import NoReference
from studies.instruments.work_precision.extended_reference import (
    DIGITS,
    extended_motion,
    reference_of,
)
from studies.instruments.work_precision.problems import driven_problem

ROUTES = tuple(zip(DIGITS, (False, True), strict=True))


def free_mass(mass: float, law: ContactLaw) -> ImpactOscillator:
    phi = np.array([1 / math.sqrt(mass)])
    model = ModalModel(omega=np.zeros(1), decay_rate=np.zeros(1), phi=phi, participation=np.zeros(1))
    return ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law))


def leaf(law: ContactLaw, excess: float = 0.013) -> ImpactOscillator:
    """Three modes near those of the letter's spring."""
    model = ModalModel(
        omega=2 * np.pi * np.array([24.5, 152.0, 390.0]), decay_rate=np.array([3.56, 21.0, 55.0]),
        phi=np.array([8.1, 4.7, 3.6]), participation=np.array([0.1, 0.03, 0.02]),
    )  # fmt: skip
    drive = HarmonicDrive(frequency=21.5)
    return ImpactOscillator(model=model, stop=Stop(gap=0.0107, law=law), drive=drive).with_excess(excess)


@pytest.mark.parametrize("digits, second", ROUTES)
def test_contact_of_a_free_mass_with_a_spring(digits: int, second: bool) -> None:
    """Half a period of the mass on the spring, and the speed reversed, to the digits set."""
    mass, stiffness, speed = 0.75, 3.0e4, 0.5
    start = State(displacement=[0.0], velocity=[speed * math.sqrt(mass)])
    oscillator = free_mass(mass, LinearContact(stiffness=stiffness))
    motion = extended_motion(oscillator, start, [0.05], digits=digits, second=second)
    (touch,) = motion.touches
    with mp.workdps(digits):
        square = mp.mpf(stiffness) * mp.mpf(float(oscillator.model.phi[0])) ** 2
        assert abs(touch.end / (mp.pi / mp.sqrt(square)) - 1) < mp.mpf(10) ** (4 - digits)
        assert abs(touch.after[1][0] / touch.before[1][0] + 1) < mp.mpf(10) ** (4 - digits)


@pytest.mark.parametrize("digits, second", ROUTES)
def test_contact_of_a_free_mass_under_hertz(digits: int, second: bool) -> None:
    """2 int dx/sqrt(1 - x^(5/2)) = (4/5) B(2/5, 1/2) times greatest approach over speed."""
    mass, stiffness, speed = 0.006, 9.6e9, 0.25
    start = State(displacement=[0.0], velocity=[speed * math.sqrt(mass)])
    oscillator = free_mass(mass, HertzContact(stiffness=stiffness))
    motion = extended_motion(oscillator, start, [1e-3], digits=digits, second=second)
    (touch,) = motion.touches
    with mp.workdps(digits):
        phi = mp.mpf(float(oscillator.model.phi[0]))
        v = phi * mp.mpf(float(start.velocity[0]))
        greatest = (mp.mpf(5) / 4 * v**2 / (mp.mpf(stiffness) * phi**2)) ** mp.mpf("0.4")
        expected = mp.mpf(4) / 5 * mp.beta(mp.mpf(2) / 5, mp.mpf(1) / 2) * greatest / v
        # the first route leaves out 1e-25 of the impulse, the second nothing
        assert abs(touch.end / expected - 1) < mp.mpf(10) ** (5 - digits)
        assert abs(touch.after[1][0] / touch.before[1][0] + 1) < mp.mpf(10) ** (5 - digits)


@pytest.mark.parametrize(
    "law",
    [NewtonRestitution(local_restitution=0.1), LinearContact(stiffness=2e5), HertzContact(stiffness=1e8)],
    ids=["newton", "linear", "hertz"],
)
def test_two_routes_and_the_exact_method_agree(law: ContactLaw) -> None:
    """The routes to twenty digits, ``simulate`` and ``collisions`` to their rounding."""
    oscillator = leaf(law)
    start, met = before_collision(oscillator), first_collision(oscillator)
    probe = start.time + oscillator.period
    size = oscillator.stop.gap / oscillator.model.phi[0]
    scales = np.full(3, size), np.full(3, size * oscillator.drive.angular_frequency)
    reference = reference_of(
        oscillator, start, [probe], scales=scales, period=oscillator.period,
        near=(met.time, met.time + met.delay),
    )  # fmt: skip
    assert max(reference.error.values()) < 1e-19
    run = simulate(oscillator, start, duration=1.3 * oscillator.period, times=np.array([probe]))
    assert float(reference.start) == pytest.approx(run.impacts.start[0], rel=1e-14)
    assert float(reference.end) == pytest.approx(run.impacts.end[0], rel=1e-14)
    q, v = (np.array([float(x) for x in part]) for part in reference.states[0])
    np.testing.assert_allclose(q, run.displacement[0], atol=1e-13 * size)
    np.testing.assert_allclose(v, run.velocity[0], atol=1e-13 * scales[1][0])
    assert float(reference.restitution) == pytest.approx(met.restitution, abs=1e-12)
    assert float(reference.kick) == pytest.approx(met.kick, abs=1e-12)


def test_the_fold_orbit_of_eq_1_closes() -> None:
    """An orbit from the closed forms returns to itself in extended precision, as far as it is a double."""
    model = ModalModel(
        omega=np.array([math.hypot(2 * math.pi / 0.0408, 1.78)]), decay_rate=np.array([3.56]), phi=np.ones(1),
        participation=np.ones(1),
    )  # fmt: skip
    law = NewtonRestitution(local_restitution=0.1)
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=0.01, law=law), drive=HarmonicDrive(frequency=21.5)
    ).with_excess(0.013)
    problem = driven_problem("single mode", "Eq. (1)", oscillator)
    assert problem.fold is not None
    assert problem.fold.excess == pytest.approx(-1.32105924246e-2, rel=1e-10)
    found = yardstick_of(problem)
    assert found.fold is not None
    q, v = problem.fold.state.displacement[0], problem.fold.state.velocity[0]
    assert abs(found.fold.image[0] - q) < 1e-12 * problem.size
    assert abs(found.fold.image[1] - v) < 1e-12 * problem.speed
    assert found.fold.singular < 1e-7


def test_what_it_cannot_follow_is_refused() -> None:
    chi = HuntCrossley(stiffness=1e8, dissipation=0.5)
    with pytest.raises(ValueError, match="HertzContact"):
        extended_motion(leaf(chi), before_collision(leaf(chi)), [0.1], digits=20)
    shallow = leaf(HertzContact(stiffness=1e8), excess=-1e-9)
    start = before_collision(shallow)
    with pytest.raises(NoReference, match="too near a graze"):
        extended_motion(shallow, start, [start.time + shallow.period], digits=20)
    deep = leaf(HertzContact(stiffness=1e8))
    start = before_collision(deep)
    touch = simulate(deep, start, periods=1).impacts
    with pytest.raises(NoReference, match="contact"):
        extended_motion(deep, start, [0.5 * (touch.start[0] + touch.end[0])], digits=20)


def test_it_is_the_law_that_is_followed() -> None:
    """A stiffer stop shortens the contact as k^(-2/5), whichever route: the numbers are not the default's."""
    times = []
    for factor in (1.0, 32.0):
        oscillator = free_mass(0.006, HertzContact(stiffness=1e9 * factor))
        start = replace(State.rest(1), velocity=np.array([0.02]))
        times.append(extended_motion(oscillator, start, [5e-3], digits=20, second=True).touches[0].end)
    assert float(times[0] / times[1]) == pytest.approx(4.0, rel=1e-14)
