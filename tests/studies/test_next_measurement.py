"""The next measurement: information, its limits and its answer, each by a second route."""

import math

import numpy as np
import pytest
from oscillators import equation_1
from page_judge import in_both_styles
from scipy.optimize import least_squares

from contact import DelayedRestitution, simulate
from contact.orbits import Shooting
from studies.measurement.identify.record.records import synthetic
from studies.measurement.next_measurement import figure
from studies.measurement.next_measurement import model as design
from studies.measurement.next_measurement.model import Nodes, Plan, covariance, errors_of, measurement
from studies.physics.parameters import with_values
from studies.shell.run import Run
from studies.shell.scene import single_mode_at

PLAN = Plan()


def of(frequency):
    """Eq. (1) with two parameters."""
    return equation_1(frequency, DelayedRestitution(restitution=0.1, delay=2e-4), gap=11.9e-3)


def node(frequency, period, excess):
    nodes = Nodes(of(frequency), period)
    return nodes.at(excess), nodes


def predicted(near, values):
    """What is measured at other values of the unknown, by shooting at that amplitude and simulation."""
    there = with_values(near.oscillator, dict(zip(PLAN.unknown, values.tolist(), strict=True)))
    orbit = Shooting(oscillator=there, m=near.m).at_excess(there.excess, near)
    run = simulate(orbit.oscillator, orbit.state(), periods=orbit.m)
    return np.append(run.strobe_displacement[:, 0], there.grazing_amplitude()), orbit


def scale(orbit):
    """Standard errors of what is measured."""
    return np.append(np.full(orbit.m, 0.5e-6 * math.sqrt(orbit.m / 1000)), 0.5e-6)


@pytest.mark.parametrize(("f", "m", "excess"), [(21.50, 4, 4e-3), (22.20, 5, 5e-4)])
def test_the_rows_are_finite_differences_of_the_orbit(f, m, excess):
    orbit, _ = node(f, m, excess)
    rows, away = design.changed(orbit, PLAN)
    values = design.sizes_of(orbit, PLAN)
    for k in range(len(values)):
        step = 1e-6 * np.eye(len(values))[k]
        (high, a), (low, b) = (predicted(orbit, values * (1.0 + way * step)) for way in (1, -1))
        slope = (high - low) / 2e-6 / scale(orbit)
        assert rows[:, k] == pytest.approx(slope, rel=1e-4, abs=1e-6 * np.abs(rows[:, k]).max())
        assert away[k] == pytest.approx((a.excess - b.excess) / 2e-6, rel=1e-4, abs=1e-8)


@pytest.mark.parametrize("records", [15, pytest.param(60, marks=pytest.mark.slow)])
def test_the_errors_are_the_spread_of_fits(records):
    """Records with the noise of the plan, fitted by shooting; a spread of n of them is good to 1/sqrt(2n)."""
    random, orbit = np.random.default_rng(1996), node(22.00, 5, -5.66e-3)[0]
    values, sizes = design.sizes_of(orbit, PLAN), scale(orbit)
    clean, root = predicted(orbit, values)[0], np.linalg.cholesky(covariance([orbit], PLAN))
    before = np.array([PLAN.before["decay_rate"], PLAN.amplitude_error]) / values[[3, 5]]
    held, found = np.eye(6)[[3, 5]] / before[:, None], []

    def slopes(part):
        there = predicted(orbit, values * (1.0 + root @ part))[1]
        rows = design.changed(there, PLAN)[0] * (values / design.sizes_of(there, PLAN))
        return np.vstack([rows, held]) @ root

    for _ in range(records):
        seen, known = clean + sizes * random.standard_normal(6), before * random.standard_normal(2)

        def off(part, seen=seen, known=known):
            there = predicted(orbit, values * (1.0 + root @ part))[0]
            return np.append((there - seen) / sizes, ((root @ part)[[3, 5]] - known) / before)

        found.append(root @ least_squares(off, np.zeros(6), slopes).x)
    errors = np.sqrt(np.diag(root @ root.T))
    assert np.std(found, axis=0) == pytest.approx(errors, rel=3.0 / math.sqrt(2 * records))
    assert np.abs(np.mean(found, axis=0) / errors).max() < 3.0 / math.sqrt(records)


def test_one_orbit_does_not_separate_gap_restitution_and_delay():
    """However much is read; with the gap from the amplitude at grazing, or with a second orbit, it does."""
    three = Plan(names=("gap", "restitution", "delay"), before={})
    for f, m in ((20.90, 3), (21.50, 4), (22.60, 6)):
        rows = design.changed(node(f, m, 1e-3)[0], three)[0][:-1, :3]
        values = np.linalg.svd(rows / np.linalg.norm(rows, axis=0), compute_uv=False)
        assert values[2] < 1e-8 < 1e-4 < values[1]
    blind = Plan(amplitude_error=1e3)
    first, second = node(20.90, 3, 1e-3)[0], node(22.20, 5, 1e-3)[0]
    assert errors_of([second], blind)[1] > 1e3 > 1e-2 > errors_of([second, first], blind)[1]


def test_the_limit_is_the_fold():
    """D and its error by moving the parameters; towards the fold the errors alone vanish as D^(1/2)."""
    nodes = Nodes(of(22.20), 5)
    near, far = (measurement(nodes.at(nodes.fold.excess + d), nodes, PLAN) for d in (1e-8, 1e-6))
    assert np.array([*near.alone.values()]) / [*far.alone.values()] == pytest.approx(0.1, rel=0.1)
    assert not near.kept and near.distance == pytest.approx(1e-8, rel=1e-3)


@pytest.fixture(scope="module")
def plane():
    """A coarse map."""
    rows = [design.measurements_at(of, PLAN, (-5.66e-3, 1e-3, 4e-3), f) for f in (21.40, 22.0, 22.20, 23.05)]
    return [one for row in rows for one in row]


def test_the_best_places_outlive_their_errors_and_lie_apart(plane):
    """Moved by one standard error along each axis of the ellipsoid the orbit is there, touching once."""
    best = design.best(plane)
    assert [one.together for one in best] == sorted(one.together for one in best)
    assert min(abs(np.diff(sorted(one.frequency_hz for one in best)))) >= 0.3
    for one in best[:2]:
        orbit, _ = node(one.frequency_hz, one.m, one.excess)
        sizes, (squares, axes) = design.sizes_of(orbit, PLAN), np.linalg.eigh(covariance([orbit], PLAN))
        for way in (-1, 1):
            for axis in axes.T * way * np.sqrt(squares)[:, None]:
                there = predicted(orbit, sizes * (1.0 + axis))[1]
                assert there.stable and there.admissible


def test_the_errors_by_the_letters_orbits(plane):
    """T to 0.02 ms, and far better from p4 on; tau and delay by p4, or by two orbits of the same speed."""
    six = design.letters_orbits(of)
    assert [orbit.m for orbit in six] == [3, 4, 5, 6, 8, 11]
    alone = np.array([errors_of([orbit], PLAN) for orbit in six])
    assert alone[0, 0] > 0.02e-3 > 1.5e-6 > alone[1:, 0].max()
    assert alone[1, 1] == pytest.approx(0.0066, rel=0.05) and np.delete(alone[:, 1], 1).min() > 0.1
    assert errors_of([six[0], six[2]], PLAN)[1:] == pytest.approx((0.003, 3.9e-6), rel=0.05)
    rows = design.letter_rows(of, PLAN)
    best = min((row for row in rows if row.other_speed), key=lambda row: row.errors["restitution"])
    assert best.orbits == "p3 and p5" in design.findings(plane, rows)[1]
    draw = in_both_styles(figure.draw_plane)
    drawn, other = (draw(plane, PLAN, letters) for letters in (True, False))
    assert all(len(bar.get_xticks()) > 2 for bar in drawn.axes[3:]) and len(drawn.axes) == 6
    marked = [[text.get_text() for text in one.legends[0].get_texts()] for one in (drawn, other)]
    assert {*marked[0]} - {*marked[1]} == {"letter, at an excess of 0.001"}


def test_the_oscillator_is_the_fitted_one(run_study, tmp_path, letter_scene, monkeypatch):
    monkeypatch.setattr(design, "THIN", (12, 12))
    record, argv = tmp_path / "mine.csv", ("--fit", "gap", "--next")
    at = single_mode_at(letter_scene, 22.2).with_excess(1e-3)
    record.write_text(synthetic("strobe", at, seed=2).text())
    ran = run_study("identify", "--quick", str(record), *argv, "gap", "tau")
    assert ran.code == 0 and "gap, restitution" in ran.err and "(0." not in ran.err, ran.err
    assert len(ran.summary["next"]) > 2 and len(ran.rows("measurements")) > len(ran.summary["next"])
    for names, said in (("amplitude", "measured with each orbit"), ("gapp", "nearest is gap")):
        ran = run_study("identify", str(record), *argv, names)
        assert ran.code == 2 and said in ran.err.splitlines()[-1]


def test_with_loud_noise_no_place_of_the_next_measurement_is_kept(tmp_path, letter_scene, monkeypatch):
    """No orbit outlives its errors, and the letter has no orbits to compare: tables, and no traceback."""
    monkeypatch.setattr(design, "THIN", (30, 30))
    monkeypatch.setattr(design, "letters_orbits", lambda of: [])
    run = Run(study="identify", folder=tmp_path, scene=letter_scene, command="")
    places = figure.where_to_measure(letter_scene, run, Plan().names, None, 1e-3)
    assert places == [] and "measurements.csv" in run.files
    assert "no orbit exists" in run.close("done", {"rows": []})["findings"][0]
