"""Where methods fail: at the place that theory names, and where the default refuses or is not affected."""

from __future__ import annotations

import inspect
import json
import math
import subprocess
import sys
from decimal import Decimal, localcontext
from pathlib import Path

import mpmath
import numpy as np
import pytest

from beam.reduction import ModalModel
from contact.errors import Chatter, ContactTooStiff, StepTooLarge
from contact.integrators import CentralDifference, Exact
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies import stability
from studies.instruments.scene import Scene
from studies.instruments.scene_file import read_scene
from studies.instruments.stability import accumulation, long_runs, newton_modes, odd_modes, stiff_contact
from studies.instruments.stability.bisection import bisect, bisect_count
from studies.instruments.stability.energy_walk import walk, wander
from studies.instruments.stability.explicit_limits import lagged_stiffness
from studies.instruments.stability.extended_precision import DIGITS, flow, sine_cosine
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.odd_springs import collide, error_of_collision, spring
from studies.instruments.stability.phase_drift import drift, methods
from studies.instruments.stability.pressed_contact import (
    combined_frequency,
    disturbed,
    grows,
    pressed,
    pressed_hertz,
)
from studies.instruments.stability.short_contacts import free_body, rebound_of, rebound_ratio

#: Springs in units of their own: one metre is their amplitude.
pytestmark = pytest.mark.filterwarnings("ignore:gap is .* above 1 m:beam.SuspiciousValue")

EPS = 2.0**-52
ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="module")
def scene() -> Scene:
    return read_scene("letter", [])


# ------------------------------------------------------------------------------------------- the instruments


def test_bisection_finds_a_limit_over_many_decades_and_whole_numbers():
    assert bisect(lambda x: x * x > 2.0, 1e-8, 1e8, relative=1e-12) == pytest.approx(math.sqrt(2), rel=1e-12)
    assert bisect(lambda x: x > -1.0, -3.0, 2.0, relative=1e-9) == pytest.approx(-1.0, rel=1e-8)
    assert bisect(lambda x: x < 1e-5, 1.0, 1e-9, relative=1e-6) == pytest.approx(1e-5, rel=1e-6)
    assert bisect_count(lambda n: n >= 37, 1, 1000) == 37


@pytest.mark.parametrize(("fails", "word"), [(lambda x: True, "already"), (lambda x: False, "still")])
def test_a_limit_that_was_not_seen_on_both_sides_is_none(fails, word):
    with pytest.raises(ValueError, match=word):
        bisect(fails, 1.0, 2.0)
    with pytest.raises(ValueError, match=word):
        bisect_count(fails, 1, 2)


@pytest.mark.parametrize(
    ("omega", "decay", "time"),
    [
        (150.0, 3.0, 1.234), (150.0, 300.0, 0.1), (150.0, float(np.nextafter(300.0, 400.0)), 0.1),
        (150.0, float(np.nextafter(300.0, 0.0)), 0.1), (0.0, 3.0, 2.0), (0.0, 0.0, 2.0),
        (150.0, 4000.0, 0.02),
    ],
)  # fmt: skip
def test_reference_of_60_digits_is_the_matrix_exponential(omega, decay, time):
    with localcontext() as context, mpmath.workdps(70):
        context.prec = DIGITS
        found = flow(omega, decay, Decimal(time))
        matrix = mpmath.matrix([[0, 1], [-mpmath.mpf(omega) ** 2, -mpmath.mpf(decay)]]) * mpmath.mpf(time)
        exact = mpmath.expm(matrix)
        for i, value in enumerate(found):
            wanted = exact[i // 2, i % 2]
            assert abs(mpmath.mpf(str(value)) - wanted) <= mpmath.mpf(10) ** -45 * (abs(wanted) + 1)
        s, c = sine_cosine(Decimal(10) ** 6)
        assert abs(mpmath.mpf(str(s)) - mpmath.sin(10**6)) < mpmath.mpf(10) ** -55
        assert abs(mpmath.mpf(str(c)) - mpmath.cos(10**6)) < mpmath.mpf(10) ** -55


def test_reference_of_a_collision_is_the_closed_form_of_one_undamped_mode():
    """From x = 0 with v: touch at arcsin(gap w/v)/w, contact about the depressed rest position."""
    model = spring(1, ratio=0.0)
    found = collide(model, 1e6)
    with mpmath.workdps(40):
        w, phi, k = mpmath.mpf(float(model.omega[0])), mpmath.mpf(float(model.phi[0])), mpmath.mpf(10) ** 6
        gap, v0 = mpmath.mpf(0.005), mpmath.mpf(float(found.start.velocity[0]))
        touch = mpmath.asin(gap * w / (phi * v0)) / w
        v = v0 * mpmath.cos(w * touch)
        wc = mpmath.sqrt(w**2 + k * phi**2)
        rest = k * phi * gap / wc**2
        u = gap / phi - rest  # deviation from the rest position in contact
        angle = 2 * mpmath.pi - 2 * mpmath.atan2(v / wc, u)
        contact = (2 * mpmath.pi - angle) / wc
        after = mpmath.mpf(found.end) - touch - contact
        q1, v1 = gap / phi, -v
        end = v1 * mpmath.cos(w * after) - w * q1 * mpmath.sin(w * after)
        off = abs(mpmath.mpf(float(found.run.end.velocity[0])) - end) / v0
    assert float(off) == pytest.approx(error_of_collision(found), abs=1e-14)
    assert found.release - found.touch == pytest.approx(float(contact), rel=1e-12)


# ------------------------------------------------------------------------------- limits of central difference


@pytest.mark.parametrize(
    ("lagged", "ratio"), [(False, 0.0), (False, 0.3), (True, 0.0), (True, 0.1), (True, 1.0)]
)
def test_central_difference_in_flight_grows_beyond_its_limit_and_is_refused_there(lagged, ratio):
    limit = 2.0 * (math.sqrt(1.0 + ratio**2) - ratio) if lagged else 2.0
    one = np.ones(1)
    oscillator = ImpactOscillator(
        model=ModalModel(omega=one, decay_rate=2 * ratio * one, phi=one, participation=one),
        stop=Stop(gap=1e3, law=LinearContact(stiffness=1e-12)), load=one,
    )  # fmt: skip
    found = bisect(
        lambda h: grows(oscillator, one, CentralDifference(step=h, lagged=lagged, beyond_limit=True), h),
        0.5 * limit, 2.0 * limit, relative=1e-6,
    )  # fmt: skip
    assert found == pytest.approx(limit, rel=1e-3)
    within, beyond = (CentralDifference(step=part * limit, lagged=lagged) for part in (0.999, 1.001))
    simulate(oscillator, disturbed(one), duration=50, method=within)
    with pytest.raises(StepTooLarge):
        simulate(oscillator, disturbed(one), duration=50, method=beyond)


@pytest.mark.parametrize("count", [1, 3, 6])
def test_lasting_contact_lowers_the_limit_to_the_highest_frequency_of_the_closed_contact(count):
    model = spring(count)
    oscillator, rest = pressed(model, 1e6)
    highest = combined_frequency(model, 1e6)
    assert highest > 1.2 * model.omega[-1] or count > 3

    def unstable(x: float) -> bool:
        h = x / highest
        return grows(oscillator, rest, CentralDifference(step=h, beyond_limit=True), h)

    found = bisect(unstable, 1.0, 3.0, relative=1e-7)
    assert found == pytest.approx(2.0, rel=1e-4)
    with pytest.raises(StepTooLarge):
        simulate(oscillator, disturbed(rest), duration=1e-3, method=CentralDifference(step=2.001 / highest))
    simulate(oscillator, disturbed(rest), duration=1e-3, method=CentralDifference(step=1.999 / highest))
    # the default is not affected: the disturbance stays what it was
    run = simulate(oscillator, disturbed(rest, 1e-6), duration=0.1, times=np.linspace(0, 0.1, 50))
    assert np.abs(run.displacement - rest).max() < 1e-5 * np.abs(rest).max()


def test_lagged_damping_has_a_sharp_limit_in_contact_and_the_package_refuses_at_it():
    model = spring(5, ratio=0.1)
    step = 1.0 / float(model.omega[-1])
    sharp = lagged_stiffness(model, step)
    # the largest eigenvalue of h^2 (K + k phi phi^T) + 2 h C is 4
    matrix = step**2 * (np.diag(model.omega**2) + sharp * np.outer(model.phi, model.phi))
    values = np.linalg.eigvalsh(matrix + 2 * step * np.diag(model.decay_rate))
    assert values[-1] == pytest.approx(4, rel=1e-12)
    for part, expected in ((0.999, False), (1.001, True)):
        oscillator, rest = pressed(model, part * sharp)
        method = CentralDifference(step=step, lagged=True, beyond_limit=True)
        assert grows(oscillator, rest, method, step) is expected
    bound = CentralDifference(step=step, lagged=True).critical_stiffness(oscillator.motion())
    assert bound == pytest.approx(sharp, rel=1e-10)
    with pytest.raises(StepTooLarge):
        simulate(oscillator, disturbed(rest), duration=1e-3, method=CentralDifference(step=step, lagged=True))


def test_hertz_contact_becomes_too_stiff_at_the_depth_of_its_tangent():
    model, stiffness = spring(3), 1e9
    step = 1.0 / float(model.omega[-1])
    critical = CentralDifference(step=step).critical_stiffness(pressed(model, 1.0)[0].motion())
    depth = (critical / (1.5 * stiffness)) ** 2
    for part, expected in ((0.998, False), (1.002, True)):
        oscillator, rest, _force = pressed_hertz(model, stiffness, part * depth)
        assert grows(oscillator, rest, CentralDifference(step=step, beyond_limit=True), step) is expected
    with pytest.raises(StepTooLarge, match="become too stiff"):
        simulate(oscillator, disturbed(rest), duration=1e-2, method=CentralDifference(step=step))
    run = simulate(oscillator, disturbed(rest, 1e-6), duration=0.05, times=np.linspace(0, 0.05, 20))
    assert np.abs(run.displacement - rest).max() < 1e-5 * np.abs(rest).max()


@pytest.mark.parametrize("x", [0.9, 1.2, 1.8])
def test_energy_of_a_short_contact_is_that_of_the_closed_form_and_can_be_made(x):
    speed, omega_c = 0.1, 1000.0
    law = LinearContact(stiffness=0.005 * omega_c**2)
    oscillator = ImpactOscillator(model=free_body(), stop=Stop(gap=1e-3, law=law))
    parts = (np.arange(16) + 0.5) / 16
    found = np.array([rebound_of(oscillator, speed, math.pi / omega_c, x / omega_c, s) for s in parts])
    np.testing.assert_allclose(found, [rebound_ratio(x, s) for s in parts], rtol=1e-10)
    bound = 1.0 / (1.0 - 0.25 * x * x)
    assert 1.0 + 0.3 * (bound - 1.0) < np.max(found**2) <= bound * (1 + 1e-12)
    assert 1.0 / bound * (1 - 1e-12) <= np.min(found**2) < 0.9
    root = math.sqrt(0.005)
    start = State(displacement=np.array([5e-4 * root]), velocity=np.array([speed * root]))
    exact = simulate(oscillator, start, duration=0.05)
    assert abs(exact.end.velocity[0] / (speed * root) + 1.0) < 1e-12


@pytest.mark.parametrize("steps", [3, 8])
def test_commensurate_steps_hide_the_error_of_energy(steps):
    x, omega_c = 2.0 * math.sin(0.5 * math.pi / steps), 1000.0
    oscillator = ImpactOscillator(
        model=free_body(), stop=Stop(gap=1e-3, law=LinearContact(stiffness=0.005 * omega_c**2))
    )
    parts = (np.arange(8) + 0.5) / 8

    def worst(y: float) -> float:
        ratios = [rebound_of(oscillator, 0.1, math.pi / omega_c, y / omega_c, s) for s in parts]
        return float(np.abs(np.array(ratios) - 1.0).max())

    assert worst(x) < 1e-10
    assert worst(2.0 * math.sin(0.5 * math.pi / (steps + 0.5))) > 0.01 / steps


# ----------------------------------------------------------------------------------------------- accumulation


def test_the_ball_rests_when_theory_says_although_its_impacts_have_no_end():
    found, impacts = accumulation.time_of_rest(0.7)
    assert found == pytest.approx(2.55863, abs=5e-6)
    assert found == pytest.approx(accumulation.rest_time(0.7), rel=1e-9)
    assert 30 < impacts < 50


@pytest.mark.parametrize("e", [0.5, 0.9])
def test_a_loop_that_counts_hops_stands_still_where_the_clock_has_no_more_digits(e):
    clock, events, _clocks = accumulation.counting_loop(e)
    theory = math.log(0.25 * math.ulp(clock) / math.sqrt(2.0 / 9.81)) / math.log(e)
    assert abs(events - theory) < 2
    assert clock == pytest.approx(accumulation.rest_time(e), rel=1e-14)


def test_a_loop_over_solver_events_falls_through_the_floor_where_the_default_lies():
    how, times = accumulation.event_loop(0.7, 1e-6)
    assert how == "falls through"
    assert 50 < times.size < 120 and 0 < accumulation.rest_time(0.7) - times[-1] < 1e-9
    run = simulate(accumulation.ball(0.7), duration=1.5 * accumulation.rest_time(0.7))
    assert abs(run.end.displacement[0] - 1.0) < 1e-14 and run.end.regime == 3


def test_too_elastic_a_law_is_refused_as_chatter_and_a_lesser_one_is_not():
    theory = accumulation.most_elastic()
    assert 1e-5 < theory < 1e-3
    oscillator, state = accumulation.last_hops(1.04 * theory)
    run = simulate(oscillator, state, duration=0.9)
    assert run.end.regime == 3 and 0.9e5 < len(run.impacts) < 1e5
    oscillator, state = accumulation.last_hops(0.96 * theory)
    with pytest.raises(Chatter):
        simulate(oscillator, state, duration=0.9)


def test_a_driven_mode_is_let_go_when_the_force_that_holds_it_vanishes(scene):
    (limit,) = accumulation._driven(scene, 20)
    assert limit.measured == pytest.approx(limit.theory, abs=1e-12)


# ------------------------------------------------------------------------------------ Newton's law and modes


@pytest.mark.parametrize(
    ("mass", "shares", "limit"),
    [
        (0.1, (1, 0.634, 0.419, 0.351, 0.320, 0.295), 0.289),
        (0.3, (1, 0.768, 0.634, 0.592, 0.573, 0.557), 0.554),
        (1.0, (1, 0.900, 0.842, 0.824, 0.816, 0.809), 0.8075),
    ],
)
def test_share_of_mode_1_in_the_tip_has_a_limit_with_a_tip_mass(mass, shares, limit):
    found = [newton_modes.mode_share(mass, n) for n in (1, 2, 5, 10, 20, 100)]
    np.testing.assert_allclose(found, shares, atol=6e-4)
    assert mass * newton_modes.cantilever(mass).phi[0] ** 2 == pytest.approx(limit, abs=6e-4)


def test_one_impact_of_a_bare_tip_does_less_the_more_modes_and_the_collision_does_not():
    counts = (1, 4, 16, 40)
    for n in counts:
        assert newton_modes.one_impact(0.0, n, 0.5) == pytest.approx(1.5 / n, rel=1e-9)
    heavy = [newton_modes.one_impact(0.3, n, 0.5) for n in (20, 40)]
    limit = 1.5 * 0.3 * newton_modes.cantilever(0.3).phi[0] ** 2
    assert 2 * heavy[1] - heavy[0] == pytest.approx(limit, rel=1e-3)
    few, many = (newton_modes.whole_collision(0.0, n, 1.0)[0] for n in (10, 40))
    assert many.impacts > 10 * few.impacts
    assert many.kick == pytest.approx(few.kick, rel=0.03)
    plastic = newton_modes.whole_collision(0.0, 40, 0.0)[0]
    assert plastic.kick == pytest.approx(many.kick, rel=0.01)  # e has lost its meaning


# ---------------------------------------------------------------------------------------------- stiff contact


@pytest.mark.parametrize("count", [1, 5])
def test_digits_go_as_the_root_of_the_stiffness_and_stay_below_what_is_stated(count):
    model = spring(count)
    modal = stiff_contact.modal_stiffness(model)
    errors = {}
    for k in (1e4, 1e8, 1e12, 1e16):
        errors[k], found = stiff_contact.worst(model, k * modal, 6)
        theory = stiff_contact.digits_lost(model, k * modal, float(found.run.impacts.approach[0]))
        assert 0.02 * theory < errors[k] < 1.5 * theory
        assert found.run.evaluations <= 8  # however stiff
    assert errors[1e4] < 1e-13 and errors[1e8] < Exact.accuracy < errors[1e16]
    assert errors[1e12] < 1e-10
    slope = math.log10(errors[1e16] / errors[1e8]) / 8
    assert slope == pytest.approx(0.5, abs=0.07)


def test_linear_contact_becomes_newtons_elastic_impact():
    model = spring(5)
    modal = stiff_contact.modal_stiffness(model)
    off = [abs(stiff_contact.first_kick(model, k * modal) - stiff_contact.newton_limit(model))
           for k in (1e8, 1e10, 1e12)]  # fmt: skip
    assert off[2] < 1e-6 and off[0] > off[1] > off[2]
    assert math.log10(off[0] / off[2]) == pytest.approx(2.0, abs=0.2)  # as k^-1/2


def test_lasting_contact_of_too_many_steps_is_refused():
    model = spring(1)
    modal = stiff_contact.modal_stiffness(model)
    oscillator, rest = pressed(model, 4e12 * modal)
    with pytest.raises(ContactTooStiff):
        simulate(oscillator, stiff_contact._state(rest), periods=1)
    oscillator, rest = pressed(model, 1e9 * modal)
    simulate(oscillator, stiff_contact._state(rest), periods=1)


# -------------------------------------------------------------------------------------------------- odd modes


@pytest.mark.parametrize("distance", [0.0, EPS, -EPS, 1e-12, -1e-8, 1e-4])
def test_flow_near_critical_damping_loses_nothing_where_eigenvectors_do(distance):
    decay = 2.0 * odd_modes.OMEGA * (1.0 + distance)
    assert odd_modes.flow_error(odd_modes.package_flow, odd_modes.OMEGA, decay) < 1e-14
    if distance >= 0.0:  # below, the errors of the two conjugate vectors nearly cancel
        lost = odd_modes.flow_error(odd_modes.by_eigenvectors, odd_modes.OMEGA, decay)
        theory = EPS * math.sqrt(2.0 / max(distance, EPS))
        assert 0.02 * theory < lost < 20 * theory


@pytest.mark.parametrize("ratio", [0.0, 1e-15, 1e2, 1e6])
def test_flow_of_hardly_and_of_very_strongly_damped_modes_loses_nothing(ratio):
    decay = 2.0 * odd_modes.OMEGA * ratio
    assert odd_modes.flow_error(odd_modes.package_flow, odd_modes.OMEGA, decay) < 1e-14
    if ratio == 1e6:
        assert odd_modes.flow_error(odd_modes.by_eigenvectors, odd_modes.OMEGA, decay) > 1e-10


@pytest.mark.parametrize(
    "name", ["zeta = 1", "zeta one rounding above 1", "repeated", "repeated to 1e-15", "zero frequency",
             "zeta = 1e-15", "zeta = 1e2"],
)  # fmt: skip
def test_collision_of_a_spring_with_an_odd_mode_keeps_its_digits(name):
    found = collide(odd_modes.cases()[name], odd_modes.STIFFNESS)
    assert error_of_collision(found) < 3e-14 < Exact.accuracy


# -------------------------------------------------------------------------------------------------- long runs


@pytest.mark.parametrize("name", list(methods()))
def test_phase_and_amplitude_of_a_free_mode_drift_as_theory_says(name):
    make, root = methods()[name]
    x = 0.1
    z = root(x)
    phase, growth = drift(make, x, 20)
    assert phase == pytest.approx(math.atan2(z.imag, z.real) / x - 1.0, abs=1e-9)
    assert growth == pytest.approx(math.log(abs(z)) / x, abs=1e-9)
    leading = {"central-difference": 1 / 24, "newmark 1/4, 1/2": -1 / 12, "moreau-jean 1/2": -1 / 12}
    if name in leading:
        assert phase == pytest.approx(leading[name] * x * x, rel=5e-3)
    if name.startswith("splitting"):
        assert abs(phase) < 1e-14


def test_default_flies_on_without_drift():
    limits, arrays = long_runs._flight(100_000)
    assert np.all(arrays["flight_phase"] < 10 * EPS * arrays["flight_periods"])
    assert np.all(arrays["flight_energy"] < 10 * EPS * arrays["flight_periods"])
    assert all(limit.measured < 1e-10 for limit in limits)


def test_periodic_orbit_repeats_to_rounding_and_is_the_closed_form(scene):
    (itself, closed), _arrays = long_runs._orbit(scene, 20_000)
    assert "p5" in itself.case
    assert itself.measured < 10 * EPS and closed.measured < 1e-13


def test_stable_steps_let_the_energy_of_contacts_walk_at_random():
    """The deviation of 64 starts is good to 1/sqrt(128), and three of those are allowed."""
    assert walk(14, 20) == pytest.approx(walk(7, 20) / 3.7, rel=0.1)  # as the square of the step
    assert wander(7, 20, 64) == pytest.approx(walk(7, 20), rel=3 / math.sqrt(128))


# -------------------------------------------------------------------------------------------------- the study


class Fake:
    """A family that finds one limit, or fails where it is told to."""

    def __init__(self, fails: str = "") -> None:
        self.fails = fails

    def measure(self, *, quick: bool, scene: Scene) -> Findings:
        if self.fails == "measure":
            raise RuntimeError("no step was\nstable")
        limit = Limit(method="m", case="c", knob="h [s]", theory=2.0, measured=None, refused=True, note="n")
        return Findings(limits=[limit], arrays={"values": np.arange(3.0)})

    def draw(self, findings: Findings, record: object) -> None:
        if self.fails == "draw":
            raise ValueError("no colours left")


@pytest.mark.parametrize(("fails", "word"), [("measure", "no step was stable"), ("draw", "no colours left")])
def test_a_family_that_fails_is_a_row_and_the_others_go_on(fails, word, tmp_path, capsys, monkeypatch):
    families = {"explicit_limits": Fake(fails), "long_runs": Fake()}
    monkeypatch.setattr(stability, "family", families.__getitem__)
    code = stability.main(
        ["--families", "explicit_limits,long_runs", "--workers", "1", "--json", "--out", str(tmp_path)]
    )
    answer = json.loads(capsys.readouterr().out)
    assert code == 3 and answer["exit_code"] == 3 and len(answer["failures"]) == 1
    assert word in answer["failures"][0]
    bad = [row for row in answer["rows"] if row["method"] == "none"]
    good = [row for row in answer["rows"] if row["family"] == "long_runs"]
    assert len(bad) == 1 and word in bad[0]["note"] and bad[0]["limit_measured"] is None
    assert len(good) == 1 and good[0]["limit_theory"] == 2.0 and good[0]["refused"] is True


def test_quick_run_prints_the_rows_that_were_promised(tmp_path, capsys):
    assert stability.main(["--families", "newton_modes", "--quick", "--json", "--out", str(tmp_path)]) == 0
    answer = json.loads(capsys.readouterr().out)
    keys = {"method", "case", "knob", "limit_theory", "limit_measured", "refused", "note"}
    assert answer["schema"] == 1 and answer["rows"] and all(keys <= row.keys() for row in answer["rows"])
    for name in ("newton_modes.csv", "newton_modes.npz", "newton_modes.png", "summary.json"):
        assert (tmp_path / "stability" / name).stat().st_size > 100
    told = stability.table([Limit(method="a", case="b", knob="c", theory=2.0, measured=None, refused=False)])
    assert told[1].split() == ["a", "b", "c", "2", "-", "no"]


def test_unknown_family_is_told_in_a_sentence(tmp_path, capsys):
    assert stability.main(["--families", "explicit", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1 and "explicit_limits" in said


@pytest.mark.parametrize("name", stability.FAMILIES)
def test_every_family_measures_and_draws(name):
    found = stability.family(name)
    assert set(inspect.signature(found.measure).parameters) == {"quick", "scene"}
    assert len(inspect.signature(found.draw).parameters) == 2
    assert len(inspect.getdoc(found) or "") > 500


@pytest.mark.slow
def test_all_families_in_their_small_form(tmp_path, capsys):
    assert stability.main(["--quick", "--json", "--out", str(tmp_path)]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {row["family"] for row in answer["rows"]} == set(stability.FAMILIES)
    assert answer["failed_cells"] == 0


def test_workers_of_a_study_do_not_warn_of_what_it_varies_on_purpose(tmp_path):
    """Its gaps of 1000 m are meant; a worker is started anew and has to be told."""
    command = [sys.executable, "-m", "studies.stability", "--quick", "--workers", "2", "--out", str(tmp_path)]
    command += ["--families", "accumulation,explicit_limits"]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert answer.returncode == 0 and "SuspiciousValue" not in answer.stderr
