"""The study `sweep`: its cells against motions followed by hand, its axes, and what it stores."""

import numpy as np
import pytest

from contact import ImpactKind, State, simulate
from studies.experiment.sweep.model import axis_of, column_of, oscillator_at, settled_cell
from studies.shell.scene import read_scene

HERE = {"frequency": 21.5, "excess": 0.012}
NEWTON = {"modes.count": 1, "contact.law": "newton", "contact.local_restitution": 0.1}
LINEAR = {"modes.count": 2, "contact.law": "linear"}
ONE_MODE = [word for key, value in NEWTON.items() for word in ("--set", f"{key}={value}")]
CROSSED = ["--over", "excess=-0.02:0.008:15", *ONE_MODE]  # fold of p4 at -0.0132, grazing at 0


def compared(changes, cell, *, settled=1000):
    """The oscillator of a cell, its numbers, and m drive periods after many from rest, followed by hand."""
    scene = read_scene().replace(changes)
    found = {name: values.item() for name, values in column_of([cell], scene, "rest", {}).items()}
    oscillator = oscillator_at(scene, cell)
    end = simulate(oscillator, State.rest(oscillator.n_modes), periods=settled).end
    times = end.time + np.linspace(0.0, found["m"] * oscillator.period, 40_000 * found["m"] + 1)
    return oscillator, found, simulate(oscillator, end, periods=found["m"], times=times)


def test_under_newtons_law_the_energy_lost_is_that_of_the_speeds():
    oscillator, found, run = compared(NEWTON, HERE)
    touches, mass = run.impacts, 1.0 / oscillator.model.phi[0] ** 2
    assert found["impacts"] == len(touches) > 0 and np.isnan(found["peak_force"])
    lost = 0.5 * mass * np.sum(touches.approach**2 - touches.rebound**2)
    assert found["m"] * found["energy_lost"] == pytest.approx(lost, rel=1e-6) and lost > 0.0
    assert found["approach"] == pytest.approx(touches.approach.max(), rel=1e-6)
    assert found["amplitude_m"] == pytest.approx(1.012 * oscillator.grazing_amplitude())


def test_the_energy_lost_is_the_work_of_the_base_without_that_of_the_modal_damping():
    changes = {**LINEAR, "contact.stiffness_n_per_m": 2e4, "contact.damping_ns_per_m": 3.0}
    oscillator, found, run = compared(changes, HERE)
    model, drive, rate = oscillator.model, oscillator.driven, run.velocity
    w = drive.angular_frequency
    inertia = drive.amplitude * w**2 * np.sin(w * run.time)  # -z''
    power = inertia * (rate @ model.participation) - rate**2 @ model.decay_rate
    assert found["m"] * found["energy_lost"] == pytest.approx(np.trapezoid(power, run.time), rel=1e-4)
    depth = oscillator.tip(run.displacement) - oscillator.stop.gap
    force = (depth > 0.0) * (2e4 * depth + 3.0 * oscillator.tip(rate))
    assert found["peak_force"] == pytest.approx(force.max(), rel=1e-3)


def test_a_contact_that_is_closed_at_a_strobe_counts_once():
    changes = {**LINEAR, "contact.stiffness_n_per_m": 300.0, "contact.damping_ns_per_m": 0.2}
    stops = {"stop.gap_m": 2e-4, "stops": [{"gap_m": 1e-4, "side": -1}]}
    _, found, run = compared(changes | stops, {"frequency": 28.0, "excess": 5.0})
    assert np.isnan(run.impacts.approach).tolist() == [True, False, False]
    assert (found["m"], found["impacts"]) == (1, 2) and run.strobe_impacts.sum() == 2


def test_touches_of_all_stops_count_and_each_key_is_a_column(run_study, tmp_path):
    file = tmp_path / "between.toml"
    file.write_text("[modes]\ncount = 2\n[[stops]]\ngap_m = 0.0118\n")
    row = run_study("sweep", "--scene", str(file), "--over", "stop.gap_m=0.0116:0.0117:2").rows("sweep")[0]
    gaps = {"stop.gap_m": float(row["swept_stop.gap_m"]), "stops": [{"gap_m": 0.0118}], "modes.count": 2}
    _, found, run = compared(gaps, {"frequency": float(row["frequency_hz"]), "excess": 0.013})
    assert set(run.impacts.stop) == {0, 1} and gaps["stop.gap_m"] == 0.0116 and int(row["m"]) == found["m"]
    assert int(row["impacts"]) == np.sum(run.impacts.kind == ImpactKind.IMPACT)
    assert float(row["peak_force_newton"]) == pytest.approx(run.impacts.peak_force.max(), rel=1e-5)


def test_a_state_that_is_carried_keeps_its_orbit_between_fold_and_grazing(run_study):
    periods = {}
    for start in ("rest", "up", "down"):
        ran = run_study("sweep", *CROSSED, "--over", "frequency=21.4:21.5:2", "--start", start)
        rows, arrays = ran.rows("sweep"), ran.arrays("sweep")
        assert ran.code == 0 and [int(row["m"]) for row in rows] == arrays["m"].ravel().tolist()
        assert [float(row["frequency_hz"]) for row in rows] == [21.4] * 15 + [21.5] * 15
        periods[start], (_, excess) = arrays["m"][1], arrays["excess"]
    between, outside = (excess > -0.011) & (excess < -0.003), (excess < -0.015) | (excess > 0.001)
    assert np.all(periods["up"][between] == 1) and np.all(periods["down"][between] > 1)
    assert np.array_equal(periods["up"][outside], periods["down"][outside]) and periods["up"][-1] > 1


def test_a_state_behind_the_stop_or_of_other_modes_begins_from_rest():
    scene = read_scene().replace(NEWTON)
    oscillator = oscillator_at(scene, HERE)
    at_gap = np.array([oscillator.stop.gap]) / oscillator.model.phi
    for part in (0.99, 1.01):
        state = State(displacement=part * at_gap, velocity=0.0 * at_gap)
        assert settled_cell(oscillator, state, 1)[0]["carried"] == (part < 1.0)
    more = [{"modes.count": count} for count in (1, 1, 2)]
    assert column_of(more, scene, "up", HERE)["carried"].tolist() == [False, True, False]


def test_a_sweep_goes_on_with_the_same_numbers(run_study):
    before = run_study("sweep", *CROSSED)
    table, store = before.folder / "sweep.csv", before.folder / "rest-excess-15"
    kept, column = table.read_bytes(), store / "00003.npz"
    age = (store / "00002.npz").stat().st_mtime_ns
    column.unlink()
    assert run_study("sweep", *CROSSED).code == 0 and column.exists()
    assert table.read_bytes() == kept and (store / "00002.npz").stat().st_mtime_ns == age
    other = run_study("sweep", *CROSSED, "--set", "stop.gap_m=0.01")
    assert other.code == 2 and "--fresh" in other.err


def test_a_failed_cell_has_a_reason_and_no_number_and_a_key_without_effect_is_named(run_study):
    stiffness = ["--over", "contact.stiffness_n_per_m=1e5:1e4:2:log"]  # of no use under Newton's law
    ran = run_study("sweep", "--over", "frequency=21.5:5000:3", *stiffness, *ONE_MODE)
    assert ran.code == 3 and len(ran.summary["failures"]) == 4 and ran.summary["rows"][3]["m"] > 1
    assert "contact.stiffness_n_per_m changes no number" in ran.err and "frequency changes" not in ran.err
    for number, row in enumerate(ran.rows("sweep")):
        known = {row[name] != "" for name in ("m", "impacts", "approach_m_per_s", "energy_lost_j")}
        assert known == {number % 3 == 0} and ("modes.count" in row["reason"]) == (number % 3 > 0)


def test_axes():
    assert axis_of("stop.gap_m = 0.02:0.01:3").values == pytest.approx((0.01, 0.015, 0.02))
    assert axis_of("contact.stiffness_n_per_m=1e3:1e5:3:log").values == pytest.approx((1e3, 1e4, 1e5))


REFUSED = {
    "stop.gpa_m=1:2:3": "nearest valid key is stop.gap_m",
    "frequncy=20:22:3": "frequency or excess or amplitude",
    "modes.count=1:4:6": "modes.count must be a whole number",
    "spring.kind=1:2:2": "spring.kind cannot be swept",
    "stop.gap_m=0.01:0.01:3": "FROM and TO different",
    "stop.gap_m=0.01:0.02:0": "N a whole number",
    "excess=-0.1:0.1:3:log": "above 0",
    "stop.gap_m=0.01:0.02:2000 excess=0:1:2000": "4000000 cells",
    "stop.gap_m=0.01:0.02:2 stop.gap_m=0.01:0.02:2": "stop.gap_m is swept or given twice",
    "frequency=20:22:3 --frequency 21": "frequency is swept or given twice",
    "excess=0:0.1:3 --amplitude 1e-3": "excess and amplitude",
}


@pytest.mark.parametrize("over", REFUSED)
def test_what_cannot_be_swept_is_refused_before_anything_is_computed(run_study, over):
    ran = run_study("sweep", "--over", *over.split())
    (sentence,) = ran.err.splitlines()
    assert ran.code == 2 and REFUSED[over] in sentence and not ran.folder.exists()
