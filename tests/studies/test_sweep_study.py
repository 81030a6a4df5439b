"""The study `sweep`: its cells against motions followed by hand, its axes, and what it stores."""

import numpy as np
import pytest

from contact import State, simulate
from studies.experiment.sweep.model import column_of, oscillator_at
from studies.shell.scene import read_scene
from studies.shell.scene.values import scene_from_text

HERE = {"frequency": 21.5, "excess": 0.012}
NEWTON = {"modes.count": 1, "contact.law": "newton", "contact.local_restitution": 0.1}
ONE_MODE = [word for key, value in NEWTON.items() for word in ("--set", f"{key}={value}")]
CROSSED = ["--over", "excess=-0.02:0.008:15", *ONE_MODE]  # fold of p4 at -0.0132, grazing at 0


def followed(scene, cell, m: int):
    """The oscillator of a cell, and `m` drive periods of its motion from rest, after 1000 of them."""
    oscillator = oscillator_at(scene, cell)
    end = simulate(oscillator, State.rest(oscillator.n_modes), periods=1000).end
    times = end.time + np.linspace(0.0, m * oscillator.period, 40_000 * m + 1)
    return oscillator, simulate(oscillator, end, periods=m, times=times)


BETWEEN = """[modes]\ncount = 2\n[[stops]]\ngap_m = 1e-4\nside = -1
[contact]\nlaw = "linear"\nstiffness_n_per_m = 300.0\ndamping_ns_per_m = 0.2"""


def test_between_two_stops_the_energy_lost_is_the_work_of_the_base_without_the_damping(run_study, tmp_path):
    (tmp_path / "between.toml").write_text(BETWEEN)
    given = ["--over", "stop.gap_m=2e-4:3e-4:2", "--frequency", "28", "--excess", "5"]
    row = run_study("sweep", "--scene", str(tmp_path / "between.toml"), *given).rows("sweep")[0]
    scene = scene_from_text(BETWEEN, overrides=[f"stop.gap_m={row['swept_stop.gap_m']}"])
    oscillator, run = followed(scene, {"frequency": 28.0, "excess": 5.0}, int(row["m"]))
    assert scene.stop.gap_m == 2e-4 and set(run.impacts.stop) == {0, 1}
    closed = np.isnan(run.impacts.approach)  # at the strobe
    assert closed.tolist() == [True, False, False]
    assert (row["m"], row["impacts"]) == ("1", "2") and run.strobe_impacts.sum() == 2
    model, drive, rate = oscillator.model, oscillator.driven, run.velocity
    w = drive.angular_frequency
    inertia = drive.amplitude * w**2 * np.sin(w * run.time)  # -z''
    power = inertia * (rate @ model.participation) - rate**2 @ model.decay_rate
    assert float(row["energy_lost_j"]) == pytest.approx(np.trapezoid(power, run.time), rel=1e-4)
    depth = oscillator.heights(run.displacement)
    force = (depth > 0.0) * (300.0 * depth + 0.2 * np.gradient(depth, run.time, axis=0))
    assert float(row["peak_force_newton"]) == pytest.approx(force.max(), rel=1e-3)


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


def test_a_state_that_cannot_start_in_the_next_cell_is_replaced_by_rest():
    scene = read_scene().replace(NEWTON)
    more = [{"modes.count": count} for count in (1, 1, 2)]
    assert column_of(more, scene, "up", HERE)["carried"].tolist() == [False, True, False]


def test_a_sweep_goes_on_with_the_same_numbers(run_study):
    before = run_study("sweep", *CROSSED)
    table, (store,) = before.folder / "sweep.csv", before.folder.glob("rest-excess-15-*")
    kept, column = table.read_bytes(), store / "00003.npz"
    age = (store / "00002.npz").stat().st_mtime_ns
    column.unlink()
    assert run_study("sweep", *CROSSED).code == 0 and column.exists()
    assert table.read_bytes() == kept and (store / "00002.npz").stat().st_mtime_ns == age
    other = run_study("sweep", *CROSSED, "--set", "stop.gap_m=0.01")
    assert other.code == 2 and "--fresh" in other.err


def test_of_newtons_law_the_energy_is_that_of_the_speeds_and_a_failed_cell_has_a_reason(run_study):
    axes = ["--over", "frequency=5000:21.5:2", "--over", "contact.stiffness_n_per_m=1e5:1e3:3:log"]
    ran = run_study("sweep", *axes, *ONE_MODE, "--excess", "0.012")
    rows = ran.rows("sweep")
    assert "contact.stiffness_n_per_m changes no number" in ran.err and "frequency changes" not in ran.err
    swept = [float(row["swept_contact.stiffness_n_per_m"]) for row in rows]
    assert swept == pytest.approx([1e3, 1e3, 1e4, 1e4, 1e5, 1e5])
    for row in rows[1::2]:
        assert "modes.count" in row["reason"] and not (row["m"] + row["impacts"] + row["energy_lost_j"])
    assert ran.code == 3 and len(ran.summary["failures"]) == 3
    found = {name: float(value) for name, value in rows[0].items() if value not in ("", "False")}
    oscillator, run = followed(read_scene().replace(NEWTON), HERE, int(found["m"]))
    touches, mass = run.impacts, 1.0 / oscillator.model.phi[0] ** 2
    assert found["impacts"] == len(touches) > 0 and rows[0]["peak_force_newton"] == ""
    lost = 0.5 * mass * np.sum(touches.approach**2 - touches.rebound**2)
    assert found["m"] * found["energy_lost_j"] == pytest.approx(lost, rel=1e-6) and lost > 0.0
    assert found["approach_m_per_s"] == pytest.approx(touches.approach.max(), rel=1e-6)
    assert found["amplitude_m"] == pytest.approx(1.012 * oscillator.grazing_amplitude())


REFUSED = {
    "stop.gpa_m=1:2:3": "nearest valid key is stop.gap_m",
    "frequncy=20:22:3": "frequency or excess or amplitude",
    "modes.count=1:4:6": "modes.count must be a whole number",
    "spring.kind=1:2:2": "spring.kind cannot be swept",
    "stop.gap_m=0.01:0.01:3": "FROM and TO different",
    "excess=-0.1:0.1:3:log": "above 0",
    "stop.gap_m=0.01:0.02:2000 excess=0:1:2000": "not 4000000",
    "stop.gap_m=0.01:0.02:2 stop.gap_m=0.01:0.02:2": "each number",
    "frequency=20:22:3 --frequency 21": "each number",
    "excess=0:0.1:3 --amplitude 1e-3": "and amplitude exclude",
}


@pytest.mark.parametrize("over", REFUSED)
def test_what_cannot_be_swept_is_refused_before_anything_is_computed(run_study, over):
    ran = run_study("sweep", "--over", *over.split())
    assert ran.code == 2 and REFUSED[over] in ran.err.splitlines()[-1] and not ran.folder.exists()
