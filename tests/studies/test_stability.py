"""Where methods fail: one limit a method, theory against the motion, and where the package refuses."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oscillators import MODES

from beam import ModalModel
from contact import first_collision, simulate
from contact.integrators import Exact, Splitting
from studies.methods.stability import explicit, splitting
from studies.methods.stability.false_restitution import outcomes
from studies.methods.stability.implicit_energy import STIFF_GROWTH, evenly, single_contact, stiff_contacts
from studies.methods.stability.model import energy_after, pressed, threshold
from studies.shell.scene import beam_at

MODEL = ModalModel(**MODES["three modes"])


def test_a_threshold_is_found_over_many_decades_and_only_if_it_was_seen_on_both_sides():
    assert threshold(lambda x: x * x > 2.0, (1e-8, 1e8), 1e-12) == pytest.approx(2**0.5, rel=1e-12)
    assert threshold(lambda x: x < 1e-5, (1.0, 0.1, 1e-9, 1e-12), 1e-6) == pytest.approx(1e-5, rel=1e-6)
    assert threshold(lambda x: True, (1.0, 2.0), 0.1) is None
    assert threshold(lambda x: False, (1.0, 2.0), 0.1) is None


@pytest.mark.parametrize(
    ("lagged", "ratio"), [(False, 0.0), (False, 0.3), (True, 0.0), (True, 0.1), (True, 1.0)]
)
def test_central_difference_in_flight_grows_beyond_its_limit_and_is_refused_there(lagged, ratio):
    row = explicit.flight(ratio, lagged)
    assert row.measured == pytest.approx(row.theory, rel=2e-6) and row.refused is True


@pytest.mark.parametrize(("count", "lagged", "close"), [(1, False, 1e-7), (3, False, 1e-7), (3, True, 1e-6)])
def test_a_lasting_contact_grows_where_the_highest_frequency_of_the_closed_contact_says(count, lagged, close):
    """The largest eigenvalue of h^2 (K + k phi phi^T), with lagged damping plus 2 h C, is 4."""
    model = MODEL.truncated(count)
    model = replace(model, decay_rate=10.0 * model.decay_rate) if lagged else model
    row, step = explicit.lasting(model, lagged), 1.0 / float(model.omega[-1])
    assert row.measured == pytest.approx(row.theory, rel=close) and row.refused is True
    matrix = step**2 * (np.diag(model.omega**2) + row.theory * np.outer(model.phi, model.phi))
    matrix += 2 * step * np.diag(model.decay_rate) * lagged
    assert np.linalg.eigvalsh(matrix)[-1] == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize("x", [0.9, 1.2, 1.8])
def test_energy_of_a_short_contact_is_that_of_the_closed_form_and_can_be_made(x):
    parts = (np.arange(16) + 0.5) / 16
    found = explicit.energies(x, parts)
    assert found == pytest.approx([explicit.rebound_ratio(x, s) ** 2 for s in parts], rel=1e-10)
    bound = 1.0 / (1.0 - 0.25 * x * x)
    assert 1.0 + 0.3 * (bound - 1.0) < np.max(found) <= bound * (1 + 1e-12)
    assert 1.0 / bound * (1 - 1e-12) <= np.min(found) < 0.9
    assert np.abs(energy_after(Exact(), x, parts) - 1.0).max() < 1e-11


@pytest.mark.parametrize(("count", "angle"), [(1, 1.0), (3, 1.0), (3, 2.5)])
def test_order_2_fails_at_its_limit_and_is_refused_there(count, angle):
    """By the motion, and the spectral radius by which the package refuses."""
    model = MODEL.truncated(count)
    row = splitting.limit(model, angle)
    assert row.measured == pytest.approx(row.theory, rel=1e-6) and row.refused is True
    method = Splitting(step=angle / float(model.omega[-1]))
    simulate(*pressed(model, 0.99 * row.theory), duration=40 * method.step, method=method)


def test_an_infinitely_stiff_contact_multiplies_the_speed_as_derived():
    """(3 - 4u) v below u = 2/3, (8u - 5) v above, from a linear complementarity problem solved by hand."""
    places = (np.arange(97) + 0.5) / 97
    after = single_contact("trapezoidal rule", np.full(places.size, 1e5), places)
    speed = np.where(places < 2 / 3, 3 - 4 * places, 8 * places - 5)
    assert np.sqrt(after) == pytest.approx(speed, rel=1e-3)


def test_the_trapezoidal_rule_multiplies_the_energy_of_a_stiff_contact_by_e_to_the_0_7465():
    growing, largest, resolved = stiff_contacts(300)
    assert round(STIFF_GROWTH, 4) == 0.7465
    assert growing.measured == pytest.approx(STIFF_GROWTH, abs=1e-3)
    assert 8.9 < largest.measured < 9.0 and resolved.measured == pytest.approx(resolved.theory, rel=0.05)


def test_a_resolved_contact_gains_nothing_in_the_mean_and_its_places_are_evenly_spread():
    products, places = evenly(0.1, 600)
    relative = single_contact("trapezoidal rule", products, places) - 1.0
    rms = math.sqrt(float(np.mean(relative**2)))
    assert rms == pytest.approx(0.01 / math.sqrt(90), rel=0.02) and abs(float(np.mean(relative))) < 0.05 * rms
    steps = math.pi / products
    covered, _, _ = np.histogram2d(steps % 1.0, places, bins=5, range=[[0, 1], [0, 1]])
    assert covered.min() > 15 and np.ptp(steps) == pytest.approx(1.0, abs=0.01)


def struck(scene, modes, frequency):
    """The spring with Hertz's contact at the excess of Fig. 4, and its first collision."""
    kept = scene.replace({"modes.count": modes, "contact.law": "hertz"})
    driven = beam_at(kept, frequency).with_excess(0.013)
    return driven, first_collision(driven)


def test_a_step_of_one_contact_time_fakes_a_restitution(letter_scene):
    """0.45 where there is 0.24, by the generalised-alpha method with the strongest damping, ten modes."""
    driven, exact = struck(letter_scene, 10, 22.6)
    assert exact.restitution == pytest.approx(0.24, abs=0.005)
    table = outcomes(driven, "gen.-α, ρ = 0", np.array([exact.contact_time]), 4)
    assert table[0, 0] == pytest.approx(0.45, abs=0.02)


def test_the_kick_is_right_at_a_fine_step_and_pretends_a_loss_at_a_coarse_one(letter_scene):
    driven, exact = struck(letter_scene, 4, 22.2)
    assert exact.impacts == 1
    sizes = np.array([1 / 64, 1 / 4]) * exact.contact_time
    fine, coarse = outcomes(driven, "gen.-α, ρ = 0", sizes, 1)[1]
    assert fine == pytest.approx(exact.kick, abs=5e-3) and coarse < exact.kick - 0.05
