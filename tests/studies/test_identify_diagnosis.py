"""What is wrong with a record: each fault that is put in is named, and a sound record has none."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from oscillators import slow
from record_simulators import Beam, draw, follow, settle, tip

from beam import InvalidValue
from studies.measurement.identify import figure
from studies.measurement.identify.__main__ import answered
from studies.measurement.identify.fit.descent import Found
from studies.measurement.identify.fit.diagnosis import contradictions
from studies.measurement.identify.fit.problem import chance_of
from studies.measurement.identify.fit.profiles import Profile
from studies.measurement.identify.fit.result import TOO_SMALL
from studies.measurement.identify.fit.search import best, fit
from studies.measurement.identify.record.records import NoAnswer, Record
from studies.measurement.identify.record.soundness import defects, drive_found, unit_of
from studies.measurement.identify.record.spectrum import harmonics, peaks
from studies.physics.parameters import with_values
from studies.shell.digits import minus
from studies.shell.scene import single_mode_at

SEED, PERIOD, LINES = 66, 4, np.arange(61)
"""A settled record that repeats after four of its 34 drive periods; orders of its lines that are taken."""
SPIKES = [17, 311, 512, 700, 987, 1400, 1777, 1901]


@pytest.fixture(scope="module")
def lab():
    """A record, the motion of its lines at any times, and noise of its size."""
    record = draw("equation_1", SEED)
    t, x, f, gap = record.time, record.value, record.beam.frequency, record.beam.gap
    lines = harmonics(t, x, f / PERIOD, LINES[-1])[0] * np.where(LINES, 2.0, 1.0)
    pitch = f / PERIOD * LINES

    def motion(times, corner=math.inf):
        passed = lines / (1.0 + 1j * pitch / corner)
        return (np.exp(2j * math.pi * np.outer(times, pitch)) @ passed).real

    noise = record.noise_sd * np.random.default_rng(1).standard_normal(t.size)
    return SimpleNamespace(t=t, x=x, f=f, gap=gap, motion=motion, noise=noise)


def test_what_is_wrong_with_a_record_is_said_before_any_fit(lab):
    t, x, f, late = lab.t, lab.x, lab.f, np.arange(300) / (0.7 * lab.f)
    decay = lab.gap * np.exp(-0.1 * f * t) * np.cos(2.2 * math.pi * f * t) + lab.noise
    few, low, spiked = t < 2.2 / f, 0.9 * x.min(), x.copy()
    spiked[SPIKES] += 0.5 * lab.gap
    stuck = f"{minus(f'{1e3 * low:.4g}')} mm in {np.sum(x <= low)} of {t.size} rows"
    table = {
        "the record is constant": (t, 0.0 * x + 1e-3),
        rf"the record has {few.sum()} rows of 2\.2 drive periods; it must have at least 3": (t[few], x[few]),
        r"there are 0\.7 rows a drive period: .*: aliasing": (late, lab.motion(late) + lab.noise[:300]),
        "the record is a free decay": (t, decay),
        f"readings stick at {stuck}: the sensor or the recorder saturates": (t, np.maximum(x, low)),
        rf"8 of {t.size} rows are outliers, the first in row 18 at": (t, spiked),
    }
    for sentence, (times, values) in table.items():
        said = defects(times, values, f)
        assert len(said) == 1 and re.match(sentence, said[0]), (sentence, said)


def test_residuals_say_what_contradicts_the_model(lab):
    t, f, gap, clean = lab.t, lab.f, lab.gap, lab.motion(lab.t)
    part, sound, hum, spikes = t / t[-1], clean + lab.noise, 2.31 * f, np.zeros(t.size)
    spikes[SPIKES] = 0.2 * gap
    table = {
        rf"a line at {hum:.3g}.* Hz of .*: hum": sound + 0.02 * gap * np.sin(2.0 * math.pi * hum * t),
        "a drift of 20 µm/s": sound + 2.0e-5 * t,
        rf"8 of {t.size} rows are outliers, the first in row 18": sound + spikes,
        "readings stick at .* saturates": np.minimum(sound, 0.95 * gap),
        rf"lines fall .* low-pass near {8.0 * f / 10:.0f}\d Hz": lab.motion(t, 8.0 * f) + lab.noise,
        rf".*: the drive is at {1.0005 * f:.5g}\d* Hz, not {f:.5g}": lab.motion(1.0005 * t) + lab.noise,
        "the residuals fade within .*: a transient": sound
        + 0.1 * gap * np.exp(-20.0 * part) * np.cos(6.5 * f * t),
        "the model is too small for the record": sound + 0.02 * gap * np.cos(2.0 * math.pi * f * t),
    }
    for row, (sentence, values) in enumerate(table.items()):
        said = contradictions(t, values, values - clean, f, PERIOD if row else 0)
        assert len(said) == 1 and re.match(sentence, said[0]), (sentence, said)


SOUND = [("equation_1", (9, 19, 51, 52, 61)), *slow(("equation_1", range(60)), ("two_modes", range(20)))]


@pytest.mark.parametrize(("kind", "seeds"), SOUND)
def test_a_sound_record_has_no_defect_and_shows_its_drive(kind, seeds):
    """No defect with 8 bits, 12 bits or lost rows; the drive is right within 1e-3, and else found."""
    for seed in seeds:
        record = draw(kind, seed)
        t, x, f = record.time, record.value, record.beam.frequency
        kept, steps = np.random.default_rng(seed).random(t.size) < 0.9, np.ptp(x) / 2.0 ** np.array([8, 12])
        for given in (f, 1.001 * f, 0.999 * f, None):
            assert all(defects(t, step * np.round(x / step), given) == [] for step in steps)
            assert defects(t, x, given) == [] and defects(t[kept], x[kept], given) == []
            assert given is None or drive_found(t, x, given) is None
        for factor in (1.0135, 0.9, 1.1, 2.0, 1e-3, 2.0 * math.pi):
            assert drive_found(t, x, factor * f)[0] == pytest.approx(f, rel=3e-3)


def test_a_sentence_names_the_unit_or_the_factor(lab):
    for factor, words in {2.0: "2 f", 0.5: "f/2", 1e-3: "kHz", 6.28: "rad/s", 1.1: "off by +10 %"}.items():
        assert f"{words}: the record's is f = {lab.f:.4g}" in drive_found(lab.t, lab.x, factor * lab.f)[1]
    kept = np.random.default_rng(1).random(lab.t.size) < 0.5
    assert peaks(lab.t[kept], lab.x[kept])[0][0] == pytest.approx(lab.f, abs=0.01 / lab.t[-1])
    for given, words in {
        (10.1, 0.0100, "gap"): "1000, so one of the two is in millimetres",
        (0.0022, 2.2, "amplitude"): "1000, so one of the two is in millimetres",
        (40.8, 0.0408, "free_period"): "1000, so one of the two is in milliseconds",
        (0.0022, 0.021582, "amplitude"): "9.81, so one of the two is in units of g",
        (0.1, 0.0022, "amplitude"): "45: one of the two has a wrong unit",
    }.items():
        assert unit_of(*given) == f"a factor of {words}"
    assert "2 pi" in str(unit_of(22.2, 139.5, "frequency"))
    assert unit_of(0.010, 0.0119, "gap") is None and unit_of(0.0022, 0.022, "amplitude") is None


F, ALL = 22.2, ("free_period", "decay_rate", "gap", "amplitude", "restitution", "frequency")
TRUTH = {"free_period": 40.8e-3, "decay_rate": 3.56, "gap": 0.01, "restitution": 0.15, "frequency": F}


def measured(excess, rows=2000, rate=1000.0, *, rest=False, begin=0.0, frequency=F):
    """A record of Eq. (1), settled or from rest on, and its amplitude of the base."""
    omega, mu = math.hypot(2.0 * math.pi / TRUTH["free_period"], 0.5 * TRUTH["decay_rate"]), np.array([3.56])
    at = Beam(np.array([omega]), mu, np.ones(1), np.ones(1), 0.01, frequency, excess, TRUTH["restitution"])
    times, (period, state, _) = np.arange(rows) / rate, (0, np.zeros(2), 0) if rest else settle(at)
    clock = times % (period / F) if period else begin + times
    clean, noise = tip(at, follow(at, state, 0, clock.max() + 1e-3)[2], clock)[0], np.random.default_rng(3)
    x = clean + 1e-5 * noise.standard_normal(rows)
    record = Record(columns=("time_s", "x_m"), rows=np.column_stack([times, x]), frequency=frequency)
    return record, float(at.amplitude)


@pytest.fixture(scope="module")
def scene_of_eq1(letter_scene):
    return single_mode_at(letter_scene, F)


@pytest.fixture(scope="module")
def settled():
    return measured(1e-3)


@pytest.fixture(scope="module")
def fitted(scene_of_eq1, settled):
    return fit(settled[0], scene_of_eq1, ALL)


def right(found, amplitude):
    """All fitted parameters are within four standard errors, and the residuals are noise."""
    assert not found.too_small
    true = TRUTH | {"amplitude": amplitude, "frequency": round(found.record.frequency or F, 1)}
    rows = zip(found.names, found.estimate, found.errors, strict=True)
    assert {n: (at, true[n]) for n, at, error in rows if n in true and abs(at - true[n]) > 4.0 * error} == {}


CHAOS = {"excess": 0.2, "rows": 1200, "rate": 2000.0, "begin": 5.0, "frequency": 22.4}
MOTIONS = [(CHAOS, "does not repeat"), *slow(({"excess": 0.02}, "transient"))]


@pytest.mark.parametrize(("motion", "note"), MOTIONS)
def test_a_motion_that_does_not_repeat_is_fitted_as_such(scene_of_eq1, motion, note):
    """The fit of chaos begins next to an unstable orbit."""
    record, amplitude = measured(**motion, rest=True)
    found = fit(record, scene_of_eq1, ALL)
    right(found, amplitude)
    assert found.problem.prediction.m == 0 and note in found.record.notes[-1]


def test_without_impacts_the_linear_motion_is_the_answer(scene_of_eq1):
    """From rest on all of it is fitted; the steady motion gives one of three numbers."""
    record, amplitude = measured(-0.6, rest=True)
    found = fit(record, scene_of_eq1, ALL)
    right(found, amplitude)
    assert found.names[:4] == ("free_period", "decay_rate", "amplitude", "frequency")
    assert found.record.notes == ("no impact in the record: not fitted: gap, restitution",)
    assert found.oscillator.stop.gap == scene_of_eq1.stop.gap
    record, amplitude = measured(-0.02, rest=True, begin=20.0)
    sentence = r"steady motion without impacts at 22\.2 Hz of amplitude 9\.8 mm: it cannot separate"
    with pytest.raises(NoAnswer, match=sentence):
        fit(record, scene_of_eq1, ALL)
    held = with_values(scene_of_eq1, {"amplitude": amplitude, "decay_rate": 3.56})
    right(fit(record, held, ("free_period", "gap")), amplitude)


def test_a_hum_beside_a_steady_motion_is_no_free_mode(scene_of_eq1):
    """Nor an impact where it is 9/4 of the drive: no start, or a fit that its residuals contradict."""
    time, noise = np.arange(2000) / 2000.0, 1e-6 * np.random.default_rng(0).standard_normal(2000)
    for frequency, sentence in {
        23.7: "a line at 50 Hz of .* does not decay: hum|cannot determine decay_rate",
        22.2: "repeats, but not as|no motion like|best values found, of unknown error",
    }.items():
        x = 1e-3 * np.sin(2.0 * np.pi * frequency * time) + 2e-4 * np.sin(2.0 * np.pi * 50.0 * time)
        record = Record(columns=("time_s", "x_m"), rows=np.column_stack([time, x + noise]))
        with pytest.raises(NoAnswer, match=sentence):
            answered(fit(record, scene_of_eq1, ALL))


def test_a_search_needs_a_start_and_does_not_run_away_to_endless_oscillations(fitted):
    """Free period and drive frequency stay within a factor of e^2 of where it begins."""
    with pytest.raises(NoAnswer, match="no motion like"):
        best([], known=False)
    problem = fitted.problem
    for name in ("free_period", "frequency"):
        step = np.eye(problem.start.size)[problem.names.index(name)]
        assert np.all(np.isnan(problem.residuals(problem.start - 2.1 * step)))


def test_residuals_that_repeat_with_the_orbit_contradict_a_fit(fitted):
    """Many weak lines that no autocorrelation shows; noise alone is as likely as it says."""
    base = fitted.oscillator.driven.frequency / fitted.problem.prediction.m
    random, times, lines = np.random.default_rng(3), fitted.record.rows[:, 0], np.arange(9, 80)
    noise = random.standard_normal(times.size)
    phases = 2.0 * np.pi * (np.outer(base * lines, times) + random.random((lines.size, 1)))
    for part, likely in ((0.0, True), (0.05, False)):
        fun = np.append(noise + part * np.cos(phases).sum(axis=0), np.zeros(fitted.unknowns.size))
        solved = Found(fitted.unknowns, fun, np.eye(1), 0.0)
        assert (chance_of(fitted.problem, solved, False) > TOO_SMALL) == likely


def test_units_and_a_drive_that_contradict_the_record_are_wrong_use(scene_of_eq1, settled):
    record, amplitude = settled
    table = {
        "amplitude is 2.* by the record .* given: a factor of 1000, .* millimetres": (
            [1.0, 1e3],
            F,
            amplitude,
        ),
        "amplitude is .* as given: a factor of 1000, .* millimetres": ([1.0, 1.0], F, 1e3 * amplitude),
        "gap is .* m in the scene: a factor of 1000, .* in millimetres": ([1.0, 1e3], F, None),
        "free_period is .* one of the two is in milliseconds": ([1e3, 1.0], None, None),
        "right if time_s is in ms: divide it by 1e3": ([1e3, 1.0], F, amplitude),
        "is off by .1.35 %: the record's is f = 22.2": ([1.0, 1.0], 1.0135 * F, amplitude),
        "is in kHz": ([1.0, 1.0], 1e-3 * F, amplitude),
    }
    for sentence, (scales, frequency, height) in table.items():
        one = replace(record, rows=record.rows * scales, frequency=frequency, amplitude=height)
        with pytest.raises(InvalidValue, match=sentence):
            fit(one, with_values(scene_of_eq1, {"gap": 0.0105, "amplitude": height or amplitude}), ALL)
    right(found := fit(replace(record, frequency=1.005 * F), scene_of_eq1, ALL), amplitude)
    assert "the given drive of 22.311 Hz is off by +0.5" in found.record.notes[0]
    sentence = r"the model is too small .*; the best values found, of unknown error, are free_period 40\.8"
    with pytest.raises(NoAnswer, match=sentence):
        answered(replace(found, chance=0.0))


def test_strobe_points_in_another_unit_are_wrong_use(scene_of_eq1):
    known = scene_of_eq1.with_excess(1e-3)
    record = Record(columns=("x_m",), rows=np.tile([[0.003], [0.008]], (9, 1)), frequency=F)
    for factor, words in ((1e3, "millimetres: divide by 1000"), (1e6, "micrometres: divide by 1e6")):
        with pytest.raises(InvalidValue, match=f"x_m reaches .* the record looks like {words}"):
            fit(replace(record, rows=factor * record.rows), known, ("gap",))
    amplitude = 1e3 * known.driven.amplitude
    with pytest.raises(InvalidValue, match=r"the given amplitude is 2\.\d+ m, .*: --drive takes Hz and mm"):
        fit(replace(record, amplitude=amplitude), known.with_amplitude(amplitude), ("gap",))


def test_a_scale_is_found_where_the_gap_or_the_amplitude_is_held(scene_of_eq1, settled):
    record, amplitude = settled
    record = replace(record, rows=record.rows * [1.0, -0.85])
    for held, value in (("gap", 0.01), ("amplitude", amplitude)):
        names = tuple(name for name in ALL if name != held)
        at = with_values(scene_of_eq1, {held: value})
        found = fit(record, at, names, free=("phase", "offset", "scale"))
        right(found, amplitude)
        assert found.estimate[-1] == pytest.approx(-0.85, abs=4.0 * found.errors[-1])
    rows = [Profile("gap", value, "decay_rate", value, value) for value in (1.0, 2.0)]
    drawn = figure.draw(found, rows, {name: "1(1)" for name in found.names})
    assert drawn.legends[0].get_texts()[-1].get_text() == "decay rate, fitted again"
    run, _ = found.problem.prediction.run(*found.problem.at(found.unknowns))
    assert sum(line.get_label()[:6] == "impact" for line in drawn.axes[0].lines) == 2 * len(run.impacts)
    for side in drawn.axes[-2:]:  # an axis has the colour of its curve
        assert side.yaxis.label.get_color() == side.lines[0].get_color()


def test_a_long_record_is_thinned_and_an_amplitude_ten_times_off_is_said(run_study, tmp_path, monkeypatch):
    """A stuck reading ends with a sentence and exit code 3.  Profiles are left out: they take time."""
    monkeypatch.setattr("studies.measurement.identify.report.traded", lambda found, quick: [])
    record, amplitude = measured(1e-3, rows=48_000, rate=4000.0)
    (tmp_path / "a.csv").write_text(replace(record, amplitude=10.0 * amplitude).text())
    ran = run_study("identify", "--quick", str(tmp_path / "a.csv"))
    assert ran.code == 0, ran.err
    assert "1 row in 3 of 48000 is fitted" in ran.err and ran.rows("quality")[0]["rows"] == "16000"
    assert re.search("fitted amplitude of 2.2.* mm contradicts the given 22", ran.err)
    stuck = np.maximum(record.rows[:2000], [-np.inf, -0.008])
    (tmp_path / "b.csv").write_text(replace(record, rows=stuck).text())
    ran = run_study("identify", str(tmp_path / "b.csv"))
    assert ran.code == 3 and "readings stick at \u22128 mm" in ran.err
    ran = run_study("identify", str(tmp_path / "b.csv"), "--fit", "gap", "amplitude", "scale")
    assert ran.code == 2 and "scale, gap and amplitude: give one of the three" in ran.err
