"""What is wrong with a record: each fault that is put in is named, and a sound record has none."""

from __future__ import annotations

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
from oscillators import modes_on_stop, newton
from record_simulators import draw

from contact import State, simulate
from studies.measurement.identify import diagnosis
from studies.measurement.identify.diagnosis import contradictions, defects, drive_found, unit_of
from studies.measurement.identify.kicks import harmonics

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
    stuck = f"{1e3 * low:.4g} mm in {np.sum(x <= low)} of {t.size} rows"
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
        r"a drift of 0\.02 mm/s": sound + 2.0e-5 * t,
        rf"8 of {t.size} rows are outliers, the first in row 18": sound + spikes,
        "readings stick at .* saturates": np.minimum(sound, 0.95 * gap),
        rf"lines fall .* low-pass near {8.0 * f / 10:.0f}\d Hz": lab.motion(t, 8.0 * f) + lab.noise,
        rf".*: the drive is at {1.0005 * f:.5g}\d* Hz, not {f:.5g}": lab.motion(1.0005 * t) + lab.noise,
        r"the amplitude changes by (3|2\.9|3\.1) % through the record": sound + 0.03 * (part - 0.5) * clean,
        "the residuals fade within .*: a transient": sound
        + 0.1 * gap * np.exp(-20.0 * part) * np.cos(6.5 * f * t),
        "the model is too small for the record": sound + 0.02 * gap * np.cos(2.0 * math.pi * f * t),
    }
    for row, (sentence, values) in enumerate(table.items()):
        said = contradictions(t, values, values - clean, f, PERIOD if row else 0)
        assert len(said) == 1 and re.match(sentence, said[0]), (sentence, said)


def test_chaos_has_no_defect_and_does_not_repeat():
    oscillator = modes_on_stop(154.0, 3.56, 1.0, 1.0, law=newton(0.15), drive=(22.4, 1e-3)).with_excess(0.2)
    start, t = State(time=0.0, displacement=np.zeros(1), velocity=np.zeros(1)), np.arange(3000) / 2000.0
    values = oscillator.tip(simulate(oscillator, start, periods=120, times=3.0 + t).displacement)
    assert defects(t, values, 22.4) == [] and drive_found(t, values, 22.4) is None
    said = contradictions(t, values, values - values.mean(), 22.4, 0)
    assert said == ["the record does not repeat within 12 drive periods"]


def check_sound(kind, seed):
    """No defect with 8 bits, 12 bits or lost rows; the drive is right within 1e-3, and else found."""
    record = draw(kind, seed)
    t, x, f = record.time, record.value, record.beam.frequency
    kept, steps = np.random.default_rng(seed).random(t.size) < 0.9, np.ptp(x) / 2.0 ** np.array([8, 12])
    for given in (f, 1.001 * f, 0.999 * f, None):
        assert all(defects(t, step * np.round(x / step), given) == [] for step in steps)
        assert defects(t, x, given) == [] and defects(t[kept], x[kept], given) == []
        assert given is None or drive_found(t, x, given) is None
    for factor in (1.0135, 0.9, 1.1, 2.0, 1e-3, 2.0 * math.pi):
        assert drive_found(t, x, factor * f)[0] == pytest.approx(f, rel=3e-3)


@pytest.mark.parametrize("seed", [9, 19, 51, 52, 61])
def test_a_sound_record_has_no_defect_and_shows_its_drive(seed):
    check_sound("equation_1", seed)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seeds"), [("equation_1", 60), ("two_modes", 20)])
def test_many_sound_records_have_no_defect_and_show_their_drive(kind, seeds):
    for seed in range(seeds):
        check_sound(kind, seed)


def test_a_sentence_names_the_unit_or_the_factor(lab):
    for factor, words in {
        2.0: "2 f",
        0.5: "f/2",
        1e-3: "in kHz",
        6.28: "in rad/s",
        1.1: "off by +10 %",
    }.items():
        assert f"is {words}: the record's is f = {lab.f:.4g}" in drive_found(lab.t, lab.x, factor * lab.f)[1]
    kept = np.random.default_rng(1).random(lab.t.size) < 0.5
    assert diagnosis.strongest_line(lab.t[kept], lab.x[kept]) == pytest.approx(lab.f, abs=0.01 / lab.t[-1])
    assert unit_of(10.1, 0.0100, "gap") == "the record looks like millimetres: divide by 1000"
    assert unit_of(0.0022, 2.2, "amplitude") == "the given amplitude looks like millimetres: divide by 1000"
    assert unit_of(40.8, 0.0408, "free_period") == "the record looks like milliseconds: divide by 1000"
    assert unit_of(22.2, 0.0222, "frequency") == "the given frequency looks like kilohertz: multiply by 1000"
    assert unit_of(1.0, 9.9, "amplitude") == "the record looks like g: multiply by 9.81"
    assert unit_of(0.010, 0.0119, "gap") is None
