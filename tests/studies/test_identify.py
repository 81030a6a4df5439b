"""Records and their fits: what was put in comes out within its errors, or a sentence."""

import re
from dataclasses import replace

import numpy as np
import pytest
from oscillators import slow
from page_judge import in_both_styles

from beam import InvalidValue
from contact import DelayedRestitution, HuntCrossley, LinearContact, Stop, simulate
from contact.orbits import MaximalFamily
from studies.measurement.identify import __main__ as program
from studies.measurement.identify import figure
from studies.measurement.identify.fit.profiles import rows_of
from studies.measurement.identify.fit.search import fit
from studies.measurement.identify.motion.readings import SENSOR, UNITS
from studies.measurement.identify.motion.starts import predictions_of, strobe_period
from studies.measurement.identify.record.reading import read_record
from studies.measurement.identify.record.records import NoAnswer, synthetic
from studies.measurement.identify.report import Estimate, notes_of
from studies.measurement.next_measurement import model as design
from studies.physics.parameters import ALIASES, fitted_scene, parameters_of, with_values
from studies.shell.digits import written
from studies.shell.scene import beam_at, read_scene, single_mode_at

NAMES = ("free_period", "decay_rate", "gap", "restitution")


@pytest.fixture(scope="module")
def made(letter_scene):
    """Oscillators on p5: Eq. (1), the same with a constant delay, eight modes under Hertz contact."""
    one = single_mode_at(letter_scene, 22.2).with_excess(1e-3)
    waiting = DelayedRestitution(restitution=0.18, delay=3e-4)
    beam = beam_at(read_scene("letter", ["modes.count=8"]), 22.2).with_excess(1e-3)
    return {"one_mode": one, "waiting": replace(one, stop=replace(one.stop, law=waiting)), "beam": beam}


def far_from(oscillator):
    """A start that a user might have: a quarter of a per cent off in T, some in the gap, half in the rest."""
    known = parameters_of(oscillator)
    factors = dict(free_period=0.9975, gap=0.97, decay_rate=0.85, restitution=1.5, delay=0.5, tip_mass=1.05)
    return with_values(oscillator, {n: known[n].value * f for n, f in factors.items() if n in known})


def truth(oscillator, names):
    return np.array([parameters_of(oscillator)[name].value for name in names])


CASES = [
    ("one_mode", "strobe", False, NAMES),
    ("one_mode", "strobe", True, (*NAMES, "amplitude")),
    ("one_mode", "motion", False, (*NAMES, "frequency")),
    ("waiting", "strobe", True, ("free_period", "decay_rate", "restitution", "delay")),
    ("waiting", "motion", False, (*NAMES, "delay", "amplitude")),
    ("beam", "strobe", False, ("tip_mass", "gap")),
    ("beam", "motion", False, ("free_period", "decay_rate", "gap", "stiffness", "tip_mass")),
    ("one_mode", "transitions", False, ("free_period", "restitution")),
]


@pytest.mark.parametrize(
    ("name", "kind", "velocity", "names"), [*CASES[:4], CASES[5], CASES[7], *slow(*CASES[4::2])]
)
def test_what_was_put_in_comes_out_from_a_start_far_away(made, name, kind, velocity, names):
    """All within three and a half standard errors: by chance one in some hundred seeds is not."""
    oscillator = made[name]
    record = synthetic(kind, oscillator, seed=7, velocity=velocity, periods=10)
    begun = oscillator if kind == "transitions" else far_from(oscillator)
    others = {n: v.value for n, v in parameters_of(oscillator).items() if n not in names}
    found = fit(record, with_values(begun, others), names)
    off = (found.estimate[: len(names)] - truth(oscillator, names)) / found.errors[: len(names)]
    assert np.max(np.abs(off)) < 3.5 and not found.too_small
    noise = 2.5e-4 if kind == "transitions" else 5e-7
    assert found.problem.freedom < 10 or abs(found.noise / noise - 1.0) < 0.4
    low, high = found.intervals().T
    assert np.all((low < found.estimate) & (found.estimate < high))


MOVED = ("free_period", "decay_rate", "amplitude", "frequency", "gap")
CHANNELS = [*((*case, "x_m") for case in CASES), ("one_mode", "motion", False, MOVED, "a_m_per_s2")]
CHANNELS += [("beam", "motion", False, MOVED, column) for column in ("v_m_per_s", "a_m_per_s2")]


@pytest.mark.parametrize(("name", "kind", "velocity", "names", "column"), CHANNELS)
def test_the_jacobian_is_that_of_differences(made, name, kind, velocity, names, column):
    """Also of velocities and accelerations by a sensor on the ground, off the stop."""
    oscillator = made[name]
    record = synthetic(kind, oscillator, velocity=velocity, periods=15 if kind == "motion" else 20)
    prediction, at = predictions_of(record, oscillator, names, SENSOR)[0]
    if column != "x_m":
        prediction.record = prediction.whole = replace(record, columns=("time_s", column), ground=True)
        prediction = prediction.cleared(at, prediction.extra)
        assert 0.9 * len(record.rows) < len(prediction.record.rows) < len(record.rows)
    exact, known, n = prediction.jacobian(at, prediction.extra, names), parameters_of(at), len(names)
    begun = np.append([known[name].value for name in names], prediction.extra)

    def rows(values):
        there = with_values(at, dict(zip(names, values[:n].tolist(), strict=True)))
        return prediction.values(there, values[n:]).ravel()

    steps = np.append([1e-7 * known[name].size for name in names], 1e-5 * prediction.sizes)
    for k, step in enumerate(np.diag(steps)):
        column = (rows(begun + step) - rows(begun - step)) / (2.0 * steps[k])
        assert np.max(np.abs(exact[:, k] - column)) < (1e-4 if k < n else 1e-5) * np.max(np.abs(column))


def test_restitution_and_delay_trade_off_and_the_profile_shows_it(made):
    waiting, names = made["waiting"], (*NAMES, "delay")
    found = fit(synthetic("motion", waiting, seed=3), waiting, names)
    assert found.correlations[3, 4] > 0.95
    walk = found.walk("delay")
    sides = [walk.side(way * found.reach) for way in (-1.0, 1.0)]
    rows = rows_of(walk, [point for points, _ in sides for point in points], "restitution")
    depth = np.array([row.depth for row in rows])
    assert depth.min() == 0.0 and depth[[0, -1]] == pytest.approx(found.reach**2, rel=0.35)
    ends = found.estimate[4] + np.array([-1.0, 1.0]) * found.reach * found.errors[4]
    assert [end for _, end in sides] == pytest.approx(ends, rel=0.05)
    slope = np.polyfit([row.value for row in rows], [row.other_value for row in rows], 1)[0]
    assert slope == pytest.approx(found.covariance[3, 4] / found.covariance[4, 4], rel=0.05)


def test_a_given_noise_that_is_far_from_the_residuals_is_said(made):
    """Above the record's own scatter it hides all impacts; ten times too large it makes errors too large."""
    record = synthetic("motion", made["one_mode"], seed=2, periods=10)
    with pytest.raises(InvalidValue, match="noise is 5 mm; it must be well below the scatter"):
        fit(record, made["one_mode"], ("gap",), noise=5e-3)
    found = fit(record, made["one_mode"], ("gap",), noise=5e-6)
    assert re.search(r"are 0\.\d+ µm, the given noise is 5 µm: the errors are too", " ".join(notes_of(found)))


def test_noise_that_is_larger_than_it_is_said_to_be_is_noticed(made):
    record = synthetic("strobe", made["one_mode"], seed=1, noise=1e-6)
    for noise in (0.5e-6, 1e-6):
        assert fit(record, made["one_mode"], NAMES, noise=noise).too_small == (noise < 1e-6)


@pytest.mark.parametrize(
    ("name", "kind", "names", "said", "noise"),
    [
        ("one_mode", "strobe", NAMES, r"cannot determine (\w+): the standard error of \1 is above", 1e-3),
        ("waiting", "strobe", ("gap", "restitution", "delay"), "cannot separate", None),
        ("one_mode", "transitions", ("free_period", "gap"), "gap", None),
        ("one_mode", "transitions", (*NAMES, "frequency", "amplitude"), "too short", None),
        ("one_mode", "strobe", ("gapp",), "nearest is gap", None),
        ("one_mode", "strobe", ("delay",), "NewtonRestitution with 1 mode does not have", None),
        ("one_mode", "strobe", ("gap", "gap"), "once", None),
    ],
)
def test_what_a_record_cannot_determine_is_refused_in_a_sentence(made, name, kind, names, said, noise):
    with pytest.raises((InvalidValue, NoAnswer), match=said) as refusal:
        fit(synthetic(kind, made[name], seed=1), made[name], names, noise=noise)
    assert "\n" not in str(refusal.value)


def test_an_orbit_that_ends_inside_the_confidence_region_is_refused(made):
    fold = -1.4773e-3  # of p5, as the main table has it
    orbit = MaximalFamily(oscillator=made["one_mode"], m=5).orbits(fold + 2e-7)[-1]
    rows = orbit.oscillator.tip(simulate(orbit.oscillator, orbit.state(), periods=40).strobe_displacement)
    record = replace(synthetic("strobe", made["one_mode"]), rows=rows[:, None], amplitude=orbit.amplitude)
    with pytest.raises(NoAnswer, match=r"changes its impacts|no p5"):
        fit(record.noisy(1, 2e-5), orbit.oscillator, ("free_period", "restitution"))


@pytest.mark.parametrize("kind", program.EXAMPLES)
def test_a_record_is_what_its_file_says(made, tmp_path, kind):
    record = synthetic(kind, made["one_mode"], seed=1)
    (tmp_path / "a.csv").write_text(record.text())
    again = read_record(tmp_path / "a.csv")
    assert np.allclose(again.rows, record.rows, rtol=1e-9)
    assert all(getattr(again, name) == getattr(record, name) for name in ("kind", "frequency", "amplitude"))
    assert kind != "strobe" or strobe_period(again) == 5


def test_an_example_that_cannot_be_fitted_is_a_failed_cell(run_study, monkeypatch):
    """The study has made the record itself; a gap of 20 um hides every impact in the read-out noise."""
    monkeypatch.setattr(program, "EXAMPLES", {"strobe": "one_mode"})
    ran = run_study("identify", "--quick", "--set", "stop.gap_m=2e-5")
    assert ran.code == 3 and ran.summary["rows"] == [] and "strobe" in ran.err


def test_the_command_line_takes_a_record_and_leaves_a_scene(run_study, tmp_path, made):
    """Symbols, a number of the sensor, and stamps from 1.7e9 s on: times then count from the first row."""
    record = synthetic("motion", made["one_mode"], seed=2, noise=5e-6, periods=20)
    rows = "\n".join(f"{1.7e9 + t:.7f},{x:.9g}" for t, x in record.rows)
    (tmp_path / "a.csv").write_text(f"# frequency_hz = 22.2\ntime_s,x_m\n{rows}")
    ran = run_study("identify", "--quick", str(tmp_path / "a.csv"), "--fit", "T", "gap", "tau", "offset")
    assert ran.code == 0 and "begin at 1700000000 s: 0 is the first row" in ran.err, ran.err
    found = {row["parameter"]: float(row["estimate"]) for row in ran.rows("parameters")}
    assert list(found) == ["free_period", "gap", "restitution", "offset"]
    errors = np.array([float(row["standard_error"]) for row in ran.rows("parameters")])
    off = np.array([*found.values()]) - [*truth(made["one_mode"], list(found)[:3]), 0.0]
    assert np.all(np.abs(off) < 4.0 * errors)
    sizes = [abs(float(row["correlation"])) for row in ran.rows("correlations")]
    assert sizes == sorted(sizes, reverse=True) and sizes[-1] > 0.5
    scene = read_scene(ran.folder / "fitted.toml")
    beam, stop = beam_at(scene, 22.2).model, single_mode_at(scene, 22.2).stop
    assert "fitted.toml keeps the beam of the scene: a sheet of 1.17" in ran.err
    assert beam.n_modes > 1 and beam.free_period == pytest.approx(found["free_period"], rel=1e-8)
    assert (stop.gap, stop.law.local_restitution) == (found["gap"], found["restitution"])


def test_a_gap_that_no_scene_has_is_refused_before_any_table(run_study, tmp_path, made):
    """Micrometres below x_m, where the gap of the scene is near the true one or far from it."""
    record = synthetic("motion", made["one_mode"], seed=2, periods=10)
    (tmp_path / "a.csv").write_text(replace(record, rows=record.rows * [1.0, 1e6], amplitude=None).text())
    for more in ((), ("--set", "stop.gap_m=0.009")):
        ran = run_study("identify", str(tmp_path / "a.csv"), "--fit", "gap", "tau", "amplitude", *more)
        assert ran.code == 2 and not ran.folder.exists(), ran.err
        assert re.fullmatch(".*a factor of 1e6, so one of the two is in micrometres\n", ran.err), ran.err


def test_a_wrong_name_is_refused_before_the_fit(run_study, tmp_path):
    (tmp_path / "a.csv").write_text("# frequency_hz = 22.2\nx_m\n" + "1e-3\n2e-3\n" * 9)
    table = {"T free_period": "each one once", "phasee": "nearest is phase", "phase gap": "only a motion"}
    for names, said in table.items():
        ran = run_study("identify", str(tmp_path / "a.csv"), "--fit", *names.split())
        assert ran.code == 2 and said in ran.err
    ran = run_study("identify", "--fit", "gap", "a.csv")
    assert ran.code == 2 and "before --fit" in ran.err


def test_the_help_lists_every_name_with_its_unit_and_symbol(run_study, made):
    text, units, hunt = (
        run_study("identify", "--help").out,
        dict(UNITS),
        HuntCrossley(stiffness=1e8, dissipation=0.1),
    )
    for law in (LinearContact(stiffness=1e5), hunt, made["waiting"].stop.law):
        at = replace(made["one_mode"], stop=Stop(gap=0.01, law=law))
        units |= {name: one.unit for name, one in parameters_of(at).items()}
    rows = re.findall(r"^    (\w+)(?: \((\w+)\))?  +(\S+(?: s/m)?)  +\S", text, re.M)
    known = [row for row in rows if row[0] in units]
    assert {name: unit for name, _, unit in known} == units and "Z sin(2 pi f t + phase)" in text
    assert {symbol: name for name, symbol, _ in known if symbol} == ALIASES


def test_a_model_that_is_too_small_is_no_answer_and_leaves_no_table(run_study, tmp_path):
    """The beam's record by Eq. (1)."""
    beam = beam_at(read_scene("letter", ["modes.count=4"]), 22.2).with_excess(1e-3)
    (tmp_path / "mine.csv").write_text(synthetic("motion", beam, seed=7, periods=20).text())
    ran = run_study("identify", str(tmp_path / "mine.csv"))
    assert ran.code == 3 and re.search(r"too small .* free_period 40\.\d+ ms", ran.err)
    assert {path.name for path in ran.folder.iterdir()} == {"columns.json", "manifest.json", "summary.json"}


@pytest.mark.parametrize(
    ("estimate", "error", "unit", "value", "interval"),
    [
        (0.04079812, 1.1e-5, "s", "40.798(11) ms", "40.787 to 40.809"),
        (772943.0, 46128.0, "N/m", "773(46) kN/m", "727 to 819"),
        (772943.0, 461280.0, "N/m", "770(460) kN/m", "310 to 1230"),
        (0.0123, 0.00451, "m", "12.3(4.5) mm", "7.8 to 16.8"),
        (1.7e-7, 5.8e-7, "m", "0.17(58) \u00b5m", "−0.41 to 0.75"),
        (0.00071, 0.0031, "m", "0.7(3.1) mm", "−2.4 to 3.8"),
        (22.2, 0.0996, "Hz", "22.20(10) Hz", "22.10 to 22.30"),
        (0.18, 0.004, "1", "0.1800(40)", "0.1760 to 0.1840"),
    ],
)
def test_estimates_are_rounded_to_the_second_digit_of_the_error(estimate, error, unit, value, interval):
    ends = estimate - error, estimate + error
    row = Estimate("mine", "gap", unit, estimate, estimate, error, *ends, estimate, {})
    assert (row.value, row.interval) == (value, interval) and row.began == row.in_scene == value.split("(")[0]


def test_the_example_makes_a_record_of_each_kind_and_finds_what_it_put_in(run_study, monkeypatch):
    monkeypatch.setattr(design, "THIN", (12, 12))
    monkeypatch.setattr(figure, "draw", in_both_styles(figure.draw))
    ran = run_study("identify", "--quick")
    assert ran.code == 0 and all((ran.folder / f"identify_{kind}.png").exists() for kind in program.EXAMPLES)
    assert all(read_record(ran.folder / f"{kind}.csv").kind == kind for kind in program.EXAMPLES)
    for row in ran.rows("parameters"):
        assert abs(float(row["estimate"]) - float(row["scene"])) < 4.0 * float(row["standard_error"])
    assert {row["parameter"] for row in ran.rows("profile")} & {"delay", "restitution"}
    assert {row["orbits"] for row in ran.rows("letter_orbits")} > {"p3", "p11"}
    own = [row for row in ran.rows("parameters") if row["parameter"] not in UNITS]
    share = 100.0 * max(abs(float(row["standard_error"]) / float(row["estimate"])) for row in own)
    assert f"is known least: to {written(share, 1)} %" in " ".join(ran.summary["findings"])
    assert "free period" in ran.summary["findings"][1] and "correlation_gap" in ran.rows("parameters")[0]


def test_a_fitted_beam_is_a_scene(made):
    scene = read_scene("letter", ["modes.count=8"])
    changed = with_values(made["beam"], {"gap": 0.0117, "stiffness": 8e9, "free_period": 0.0405})
    again = beam_at(fitted_scene(scene, changed, [22.2]), 22.2)
    names = ("gap", "stiffness", "free_period", "decay_rate")
    assert truth(again, names) == pytest.approx(truth(changed, names), rel=1e-12)
    assert np.allclose(again.steady_response(), changed.steady_response(), rtol=1e-12)
