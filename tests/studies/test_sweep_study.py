"""The study `sweep`: its cells against motions followed by hand, its axes, and what it stores."""

import numpy as np
import pytest

from contact import ImpactKind, State, simulate
from studies.experiment.sweep.model import axis_of, can_start, column_of, oscillator_at
from studies.shell.scene import read_scene

HERE = {"frequency": 21.5, "excess": 0.012}
ONE_MODE = ["--set", "modes.count=1", "--set", "contact.law=newton", "--set", "contact.local_restitution=0.1"]
CROSSED = ["--over", "excess=-0.02:0.008:15", *ONE_MODE]  # fold of p4 at -0.0132, grazing at 0


def one_cell(scene, cell) -> dict:
    return {name: values.item() for name, values in column_of([cell], scene, "rest").items()}


def followed(scene, cell, m: int):
    """`m` drive periods of the motion from rest, after 1000 of them, and samples in them."""
    oscillator = oscillator_at(scene, cell)
    end = simulate(oscillator, State.rest(oscillator.n_modes), periods=1000).end
    times = end.time + np.linspace(0.0, m * oscillator.period, 40_000 * m + 1)
    return oscillator, simulate(oscillator, end, periods=m, times=times)


def test_under_newtons_law_the_energy_lost_is_that_of_the_speeds():
    scene = read_scene("letter", [word for word in ONE_MODE if "=" in word])
    found = one_cell(scene, HERE)
    oscillator, run = followed(scene, HERE, found["m"])
    touches, mass = run.impacts, 1.0 / oscillator.model.phi[0] ** 2
    assert found["impacts"] == len(touches) > 0 and np.isnan(found["peak_force"])
    lost = 0.5 * mass * np.sum(touches.approach**2 - touches.rebound**2)
    assert found["m"] * found["energy_lost"] == pytest.approx(lost, rel=1e-6) and lost > 0.0
    assert found["approach"] == pytest.approx(touches.approach.max(), rel=1e-6)
    assert found["amplitude_m"] == pytest.approx(1.012 * oscillator.grazing_amplitude())


def test_the_energy_lost_is_the_work_of_the_base_without_that_of_the_modal_damping():
    changes = {"modes.count": 2, "contact.law": "linear", "contact.stiffness_n_per_m": 2e4}
    scene = read_scene().replace({**changes, "contact.damping_ns_per_m": 3.0})
    found = one_cell(scene, HERE)
    oscillator, run = followed(scene, HERE, found["m"])
    model, drive, rate = oscillator.model, oscillator.driven, run.velocity
    w = drive.angular_frequency
    inertia = drive.amplitude * w**2 * np.sin(w * run.time)  # -z''
    power = inertia * (rate @ model.participation) - rate**2 @ model.decay_rate
    assert found["m"] * found["energy_lost"] == pytest.approx(np.trapezoid(power, run.time), rel=1e-4)
    depth = oscillator.tip(run.displacement) - oscillator.stop.gap
    force = (depth > 0.0) * (2e4 * depth + 3.0 * oscillator.tip(rate))
    assert found["peak_force"] == pytest.approx(force.max(), rel=1e-3)


def test_a_state_that_is_carried_keeps_its_orbit_between_fold_and_grazing(run_study):
    periods = {}
    for start in ("rest", "up", "down"):
        ran = run_study("sweep", *CROSSED, "--over", "frequency=21.4:21.5:2", "--start", start)
        rows, arrays = ran.rows("sweep"), ran.arrays("sweep")
        assert ran.code == 0 and arrays["m"].shape == (2, 15)
        assert [int(row["m"]) for row in rows] == arrays["m"].ravel().tolist()
        assert [float(row["frequency_hz"]) for row in rows] == [21.4] * 15 + [21.5] * 15
        periods[start], (_, excess) = arrays["m"][1], arrays["excess"]
    between, outside = (excess > -0.011) & (excess < -0.003), (excess < -0.015) | (excess > 0.001)
    assert np.all(periods["up"][between] == 1) and np.all(periods["down"][between] > 1)
    assert np.array_equal(periods["up"][outside], periods["down"][outside]) and periods["up"][-1] > 1


def test_a_state_behind_the_stop_or_of_other_modes_begins_from_rest():
    scene = read_scene().replace({"contact.law": "newton", "modes.count": 1})
    oscillator = oscillator_at(scene, HERE)
    at_gap = np.array([oscillator.stop.gap]) / oscillator.model.phi
    starts = {1.01: False, 0.99: True}
    for part, starting in starts.items():
        assert can_start(oscillator, State(displacement=part * at_gap, velocity=0.0 * at_gap)) == starting
    more = [{**HERE, "modes.count": count} for count in (1, 1, 2)]
    assert column_of(more, scene, "up")["carried"].tolist() == [False, True, False]


def test_a_sweep_goes_on_with_the_same_numbers(run_study):
    before = run_study("sweep", *CROSSED)
    table, store = before.folder / "sweep.csv", before.folder / "rest-excess-15"
    kept, column = table.read_bytes(), store / "00003.npz"
    age = (store / "00002.npz").stat().st_mtime_ns
    column.unlink()
    assert run_study("sweep", *CROSSED).code == 0
    assert table.read_bytes() == kept and column.exists()
    assert (store / "00002.npz").stat().st_mtime_ns == age
    other = run_study("sweep", *CROSSED, "--set", "stop.gap_m=0.01")
    assert other.code == 2 and "--fresh" in other.err


def test_a_failed_cell_has_a_reason_and_no_number_and_the_others_go_on(run_study):
    ran = run_study("sweep", "--over", "frequency=21.5:5000:3", *ONE_MODE)
    assert ran.code == 3 and len(ran.summary["failures"]) == 2 and ran.summary["rows"][0]["m"] > 1
    for row in ran.rows("sweep")[1:]:
        assert "modes.count" in row["reason"]
        assert {row[name] for name in ("m", "impacts", "approach_m_per_s", "energy_lost_j")} == {""}


def test_touches_of_all_stops_count_and_each_key_is_a_column(run_study, tmp_path):
    file = tmp_path / "between.toml"
    file.write_text("[modes]\ncount = 2\n[[stops]]\ngap_m = 0.0118\n")
    ran = run_study("sweep", "--scene", str(file), "--over", "stop.gap_m=0.0116:0.0117:2")
    (row, _), scene = ran.rows("sweep"), read_scene(file)
    cell = {"frequency": float(row["frequency_hz"]), "excess": 0.013}
    _, run = followed(scene.replace({"stop.gap_m": float(row["stop_gap_m"])}), cell, int(row["m"]))
    assert set(run.impacts.stop) == {0, 1} and float(row["stop_gap_m"]) == 0.0116
    assert int(row["impacts"]) == np.sum(run.impacts.kind == ImpactKind.IMPACT)
    assert float(row["peak_force_newton"]) == pytest.approx(run.impacts.peak_force.max(), rel=1e-5)


def test_a_contact_that_is_closed_at_a_strobe_counts_once():
    changes = {"modes.count": 2, "contact.law": "linear", "contact.stiffness_n_per_m": 300.0}
    changes["contact.damping_ns_per_m"] = 0.2
    stops = {"stop.gap_m": 2e-4, "stops": [{"gap_m": 1e-4, "side": -1}]}
    scene, cell = read_scene().replace({**changes, **stops}), {"frequency": 28.0, "excess": 5.0}
    found, (_, run) = one_cell(scene, cell), followed(scene, cell, 1)
    assert np.isnan(run.impacts.approach).tolist() == [True, False, False]
    assert (found["m"], found["impacts"]) == (1, 2) and run.strobe_impacts.sum() == 2


def test_a_key_without_effect_is_named(run_study):
    ran = run_study("sweep", "--over", "contact.stiffness_n_per_m=1e4:1e5:2", "--set", "modes.count=2")
    assert ran.code == 0 and "contact.stiffness_n_per_m changes no number" in ran.err


def test_axes():
    assert axis_of("stop.gap_m = 0.02:0.01:3").values == pytest.approx((0.01, 0.015, 0.02))
    assert axis_of("contact.stiffness_n_per_m=1e3:1e5:3:log").values == pytest.approx((1e3, 1e4, 1e5))


@pytest.mark.parametrize(
    ("argv", "named"),
    [
        ("--over stop.gpa_m=1:2:3", "nearest valid key is stop.gap_m"),
        ("--over frequncy=20:22:3", "frequency or excess or amplitude"),
        ("--over modes.count=1:4:6", "modes.count must be a whole number"),
        ("--over spring.kind=1:2:2", "spring.kind cannot be swept"),
        ("--over stop.gap_m=0.01:0.01:3", "N must be"),
        ("--over stop.gap_m=0.01:0.02:0", "N must be"),
        ("--over excess=-0.1:0.1:3:log", "above 0"),
        ("--over stop.gap_m=0.01:0.02:2000 excess=0:1:2000", "4000000 cells"),
        ("--over stop.gap_m=0.01:0.02:2 --over stop.gap_m=0.01:0.02:2", "two different"),
        ("--over frequency=20:22:3 --frequency 21", "frequency is given and swept"),
        ("--over stop.gap_m=0.01:0.02:2 --excess 0.1 --amplitude 1e-3", "excess and amplitude"),
        ("--over excess=0:0.1:3 --amplitude 1e-3", "excess and amplitude"),
    ],
)
def test_what_cannot_be_swept_is_refused_before_anything_is_computed(run_study, argv, named):
    ran = run_study("sweep", *argv.split())
    (sentence,) = ran.err.splitlines()
    assert ran.code == 2 and named in sentence and not ran.folder.exists()
