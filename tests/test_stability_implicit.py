"""What implicit methods and impact schemes do to the energy of a contact: theory against measurement."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from contact.integrators import Exact
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.moreau_jean import MoreauJean
from contact.laws import LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.oscillators import beam_of
from studies.instruments.scene import Scene
from studies.instruments.scene_file import read_scene
from studies.instruments.stability import (
    contact_energy,
    implicit_contact,
    implicit_limits,
    numerical_restitution,
)
from studies.instruments.stability.contact_energy import (
    conservative,
    evenly,
    history,
    modal_stiffness,
    rigid_contact,
    single_contact,
)
from studies.instruments.stability.elastic_collision import ElasticCollision

#: Masses in units of their own: one metre is what they move in a step.
pytestmark = pytest.mark.filterwarnings("ignore:gap is .* above 1 m:beam.SuspiciousValue")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene("letter", [])


def trapezoidal(step: float) -> GeneralisedAlpha:
    return GeneralisedAlpha.newmark(step=step)


def test_an_infinitely_stiff_contact_multiplies_the_speed_as_derived() -> None:
    """(3 - 4u) v below u = 2/3, (8u - 5) v above, from a linear complementarity problem solved by hand."""
    places = (np.arange(97) + 0.5) / 97
    after = single_contact(trapezoidal, np.full(places.size, 1e10), places)
    speed = np.where(places < 2 / 3, 3 - 4 * places, 8 * places - 5)
    np.testing.assert_allclose(np.sqrt(after), speed, rtol=1e-3)
    growth = float(np.mean(np.log(speed**2)))
    assert growth == pytest.approx(2.5 * math.log(3) - 2, abs=2e-3)
    np.testing.assert_allclose(rigid_contact(trapezoidal(1.0), places), speed**2, rtol=1e-12)


@pytest.mark.parametrize("rho", [0.2, 0.5, 0.8])
def test_a_rigid_stop_is_the_limit_of_a_stiff_one(rho: float) -> None:
    places = (np.arange(50) + 0.5) / 50
    method = GeneralisedAlpha.with_dissipation(step=1.0, rho=rho)
    stiff = single_contact(lambda h: method, np.full(places.size, 1e12), places)
    np.testing.assert_allclose(stiff, rigid_contact(method, places, 12), rtol=1e-3, atol=1e-4)


def test_a_resolved_contact_errs_as_derived() -> None:
    """Equation (A), in the mean over places of touch and release in their steps; no gain in the mean."""
    relative = single_contact(trapezoidal, *evenly(0.1, 600)) - 1.0
    rms = math.sqrt(float(np.mean(relative**2)))
    assert rms == pytest.approx(0.01 / math.sqrt(90), rel=0.02)
    assert abs(float(np.mean(relative))) < 0.05 * rms


def test_pairs_are_evenly_spread() -> None:
    stiffness, places = evenly(0.1, 1000)
    steps = math.pi / np.sqrt(stiffness)
    assert np.ptp(steps) == pytest.approx(1.0, abs=0.01)
    assert np.mean(steps) == pytest.approx(10 * math.pi, rel=0.01)
    covered, _, _ = np.histogram2d(steps % 1.0, places, bins=5, range=[[0, 1], [0, 1]])
    assert covered.min() > 25
    stiff, _ = evenly(1e4, 100)
    assert 0.8e4 < math.sqrt(stiff.min()) < 1e4 < math.sqrt(stiff.max()) < 1.25e4


def test_the_exact_motion_keeps_the_energy_that_the_trapezoidal_rule_raises(scene: Scene) -> None:
    """The beam on a stiff linear stop: growth beyond linear theory is the method's, not the motion's."""
    model = conservative(scene, 3)
    law = LinearContact(stiffness=100 * modal_stiffness(model))
    step = 1.0 / float(model.omega.max())
    beam = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law))
    compliance = float(model.phi @ model.phi)
    start = State(displacement=np.zeros(3), velocity=-1.0 / compliance * model.phi)
    length = math.ceil(60 * math.pi / float(model.omega.min()) / step) * step
    energies = []
    for method in (Exact(), trapezoidal(step)):
        end = simulate(beam, start, duration=length, method=method).end
        depth = float(model.phi @ end.displacement)
        stored = 0.5 * law.stiffness * max(0.0, depth) ** 2
        energies.append(float(beam.energy(end.displacement, end.velocity)) + stored)
    begun = 0.5 / compliance
    assert energies[0] == pytest.approx(begun, rel=1e-9)
    assert energies[1] > 100 * begun
    run = history(model, law, trapezoidal, 1.0, 60)
    assert not run.diverged and run.contacts[-1] > 40
    # the same run 2^332 times smaller, rounded alike
    assert run.log_energy[-1] == pytest.approx(math.log(energies[1] / begun), rel=1e-13)


def test_a_history_ends_where_the_numbers_do(scene: Scene) -> None:
    model = conservative(scene, 3)
    law = LinearContact(stiffness=1e4 * modal_stiffness(model))
    run = history(model, law, trapezoidal, 1.0, 4000)
    assert run.diverged and np.all(np.isfinite(run.log_energy))
    assert 300 < run.log_energy[-1] < 2 * math.log(1e113 / np.sqrt(1e-6))
    assert run.contacts_to(2.0) < 50 and math.isnan(run.contacts_to(1e250))
    assert 0.1 < run.growth < implicit_contact.STIFF_GROWTH


def test_impact_schemes_keep_or_lose(scene: Scene) -> None:
    model, law = conservative(scene, 3), NewtonRestitution(local_restitution=1.0)
    kept = history(model, law, lambda h: MoreauJean(step=h), 1.0, 300)
    assert np.abs(kept.log_energy).max() < 1e-11 and kept.contacts[-1] > 300
    lost = history(model, law, lambda h: MoreauJean(step=h, theta=1.0), 0.1, 300)
    assert lost.log_energy[-1] < -5


def test_limits_of_flight_meet_theory() -> None:
    rows = implicit_limits.flight_limits(quick=True)
    sharp = [row for row in rows if row.theory is not None]
    free = [row for row in rows if row.theory is None]
    assert len(sharp) == 8 and len(free) == 3
    for row in sharp:
        assert row.refused is True and row.measured is not None
        # gamma > 1/2 leaves the unit circle in proportion to the excess: 2e4 steps see 1e-3 of it
        assert row.theory * (1 - 1e-6) < row.measured < row.theory * (1 + 5e-4)
    assert all(row.measured is None for row in free)


def test_false_restitution_of_a_hertz_contact(scene: Scene) -> None:
    """Right about the kick at a fine step and not at a coarse one; exact values by the contact series."""
    kept = scene.replace({"modes.count": 4, "contact.law": "hertz"})
    driven = beam_of(kept, 22.2).with_excess(0.013)
    case = ElasticCollision.of(driven, None)
    assert case.exact.impacts == 1
    unit = case.exact.contact_time
    damped = [GeneralisedAlpha.with_dissipation(step=size * unit, rho=0.0) for size in (1 / 64, 1 / 4)]
    fine, coarse = (case.measured(method) for method in damped)
    assert fine[1] == pytest.approx(case.exact.kick, abs=5e-3) and coarse[1] < case.exact.kick - 0.05
    fine_loss, coarse_loss = (case.lost(m, m.step, 0.5)[0] for m in damped)
    assert 0 < fine_loss < 0.02 and coarse_loss > 0.1
    # order 2: a quarter of the step loses sixteen times less, up to the third order in h
    middle = GeneralisedAlpha.newmark(step=unit / 40)
    assert abs(case.lost(middle, middle.step, 0.5)[0]) < 2e-3


def test_where_an_error_passes_a_bound() -> None:
    sizes = np.array([0.1, 1.0, 10.0, 100.0])
    reached = numerical_restitution._reached
    assert reached(sizes, sizes**2, 4.0) == pytest.approx(2.0)
    assert reached(sizes, np.array([0.0, 0.0, math.nan, math.nan]), 1.0) == 10.0
    assert reached(sizes, np.zeros(4), 1.0) is None and reached(sizes, np.ones(4), 0.5) is None


@pytest.mark.slow
@pytest.mark.parametrize("family", [implicit_contact, numerical_restitution])
def test_the_quick_form_measures_and_draws(family: Any, scene: Scene, tmp_path: Path) -> None:
    findings = family.measure(quick=True, scene=scene)
    for row in findings.limits:
        assert row.method and row.case and row.knob and row.note
        if row.theory is not None and row.measured is not None and row.theory > 0:
            assert row.measured <= row.theory * 1.03
    drawn: list[str] = []
    family.draw(findings, SimpleNamespace(write_figure=lambda figure, name: drawn.append(name)))
    assert len(drawn) == {implicit_contact: 3, numerical_restitution: 2}[family]
    assert contact_energy.SMALL**2 > 0
