"""The small form of every study leaves a summary, a table and a figure."""

import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import get_type_hints

import numpy as np
import pytest
from conftest import study_of, verdicts_on
from oscillators import slow

from studies.__main__ import main
from studies.experiment.hysteresis.__main__ import Accuracy, Causes, judge
from studies.experiment.hysteresis.model import CAUSES, DESCRIPTIONS
from studies.experiment.soft_wall.model import loss_of_stability
from studies.measurement.next_measurement import model as next_measurement
from studies.methods.work_precision.problems import problems_of
from studies.shell import plotting
from studies.shell.executors import progress
from studies.shell.programs import COMMAND, account_of, module_of, names, run_times, studies
from studies.shell.run import Run
from studies.shell.study import Study

ON_THE_FRAME = studies()

#: Studies whose small form a test looks at, with these checks of what it leaves.
LOOKED_AT = {
    name
    for path in Path(__file__).parent.glob("test_*.py")
    for name in re.findall(r'= run_study\(\s*"(\w+)", "--quick"', path.read_text())
}

#: Options that keep a small form small.
SMALLER = {
    "stability": ["--families", "false_restitution,accumulation"],
    "shape": "--set drive.frequencies_hz=[22.2] --set scan.settle_cycles=400 --set modes.count=4 "
    "--set spring.elements_per_leg=12 --set spring.elements_on_arc=8".split(),
    "claims": ["--positions", "3", "--set", "modes.count=4"],
}


#: Names in a study's modules that give a small form less to do, and what stands in for them; the letter's
#: spring is calibrated as it stands.
FEWER = {
    "work_precision": {
        "__main__.problems_of": lambda scene, modes: problems_of(scene, 2)[:2],
        "model.LONG_ENOUGH": 1e-3,
        "model.PATIENCE": 0.02,
    },
    "calibrate": {"calibrate_all": lambda scene, _: scene},
    "shape": {"__main__.COARSE": (1, 1)},
    "claims": {"__main__.QUICK_PLANE": (12, 3)},
}

#: Studies of driven motions, and those that change the dimensions of a spring.
DRIVEN = "adequacy breakdown chart claims effective_impact hysteresis last_period noise soft_wall".split()
DRIVEN += ["lecture", "sweep", "time_trace", "transitions", "work_precision"]
ON_A_SPRING = ("breakdown", "calibrate", "effective_impact", "last_period", "shape")

#: Plates take long; the verdict on their readings is tested beside these.
SLOW = ("shape",)

OTHERS = [name for name in ON_THE_FRAME if name not in (*LOOKED_AT, *SLOW)]


@pytest.mark.parametrize("name", [*OTHERS, *slow(*SLOW)])
def test_the_small_form_runs_and_leaves_a_table_a_figure_and_a_summary(run_study, monkeypatch, name):
    for what, fewer in FEWER.get(name, {}).items():
        monkeypatch.setattr(f"{module_of(name).removesuffix('.__main__')}.{what}", fewer)
    ran = run_study(name, "--quick", "--json", *SMALLER.get(name, ()))
    assert ran.code == 0, ran.err
    assert json.loads(ran.out)["study"] == ran.summary["study"] == name
    assert ran.verdicts == verdicts_on(name)


#: Options and keys that a study does not take, and what its sentence names.
REFUSED = [
    *((name, "--set drive.kind=none", "drive.kind") for name in DRIVEN),
    *((name, "--set spring.kind=modal_data", "modal_data") for name in ON_A_SPRING),
    ("breakdown", "--set single_mode.free_period_s=0.06", "free_period_s"),
    ("chart", "--points 1 9", "points"),
    ("breakdown", "--points 900000", "from 2 to 200000, not '900000'"),
    ("modes", "--frames 11", "frames is 11; it must be an even number"),
    ("time_trace", "--frames 1000000", "--frames: must be a whole number from 1 to 10000"),
    ("identify", "--drive 22.2 2", "drive is 22.2 Hz, 2 mm; it needs a record"),
    ("modes", "--executor moon", "executor is 'moon'; it must be threads"),
    ("time_trace", "--set stop.gap_m=1e-300", "stop.gap_m must be at least 1e-12"),
    ("time_trace", "--set single_mode.free_period_s=1e-300", "single_mode.free_period_s"),
    ("time_trace", "--set spring.young_modulus_pa=1e300", "at most 1e+15 (unit Pa)"),
    ("chart", "--points 90000 90000", "points is 90000 90000, which makes 8.1e+09 cells"),
    ("hysteresis", "--step 1e-9", "--step: must be a number from 0.0001 to 4.2 Hz"),
    ("hysteresis", "--set drive.frequencies_hz=[2000]", "2000 Hz"),
    ("noise", "--amplitude-step 1e-6", "amplitude_step is 1e-06 [1]; with a stability of"),
    ("noise", "--waiting 10", "--waiting: must be a whole number from 1000"),
    ("soft_wall", "--decades 5 3", "decades"),
    ("stability", "--families none", "families"),
    ("time_trace", "--frequency 1e6", "1e+06 Hz"),
]


@pytest.mark.parametrize(("name", "argv", "named"), REFUSED)
def test_what_a_study_cannot_use_is_refused_in_one_sentence(run_study, name, argv, named):
    ran = run_study(name, "--set", "modes.count=4", *argv.split())
    assert ran.code == 2 and ran.summary == {}
    sentence = ran.err.splitlines()[-1]
    assert sentence.startswith(f"python -m studies {name}: ") and named in sentence, ran.err
    assert "Traceback" not in ran.err and not ran.folder.exists()


#: Number options that take zero.
ZERO = ("excess", "delay_ms", "correlation_times")


@pytest.mark.parametrize("name", ON_THE_FRAME)
def test_an_impossible_number_is_refused_before_anything_is_computed(tmp_path, capsys, monkeypatch, name):
    study = study_of(name)
    monkeypatch.setattr(Study, "_compute", lambda *_: pytest.fail("the study began"))
    for option, kind in get_type_hints(study.function, include_extras=True).items():
        if not (found := re.search(r"\[(int|float)(, \1)?", str(kind))):
            continue
        for number in ("-2e0", "1e300", *["0"] * (option not in ZERO)):
            flag, values = f"--{option.replace('_', '-')}", [number] * (2 if found[2] else 1)
            assert study.main([flag, *values, "--out", str(tmp_path)]) == 2, flag
            (sentence,) = capsys.readouterr().err.splitlines()
            assert re.search(rf"{flag}: must be .* (from|above) [-\d.]+ .*, not '{number}'", sentence)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [["list"], ["--list"], ["--help"]])
def test_help_and_list_show_every_program_in_one_short_line(capsys, words):
    assert main(words) == 0
    printed = capsys.readouterr().out
    lines = [re.findall(rf"^    {name} +(.{{20,74}}\.)$", printed, re.MULTILINE) for name in names()]
    assert [len(found) for found in lines] == [1] * len(names())
    assert (f"{COMMAND} transitions --help" in printed) == (words == ["--help"])


def test_progress_says_what_it_counts(capsys, monkeypatch, tmp_path, letter_scene):
    monkeypatch.setattr("studies.shell.executors.INTERVAL", 0.0)
    run = Run(study="transitions", folder=tmp_path, scene=letter_scene, command="")
    list(run.track(range(3), "frequencies"))
    with progress("all studies", 249, "s") as tick:
        tick(102)
    said = capsys.readouterr().err.splitlines()
    assert re.match(r"transitions: 2 of 3 frequencies, [\d.e+]+ (per s|s each), \d:\d\d:\d\d left$", said[1])
    assert said[3].startswith("all studies: 102 of about 249 s")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["calibrate", "claims", "shape", "stability", "work_precision"])
def test_the_small_form_runs_whole(run_study, name):
    assert run_study(name, "--quick").verdicts == verdicts_on(name)


def test_a_figure_is_kept_as_png_and_as_pdf_without_a_date(tmp_path):
    figure, _axes = plotting.new_figure(1, 1)
    png, pdf = plotting.save(figure, tmp_path, "empty")
    assert png.read_bytes().startswith(b"\x89PNG") and pdf.read_bytes().startswith(b"%PDF")
    assert b"CreationDate" not in pdf.read_bytes()


@pytest.mark.parametrize("name", names())
def test_a_docstring_says_command_and_outputs_the_help_options_and_the_table_the_run_time(name, capsys):
    account = account_of(name)
    title = " ".join(account.partition("\n\n")[0].split())
    assert title.endswith(".") and len(title) < 200
    if name in ON_THE_FRAME:
        assert "\nRun:" in account and "\nWrites:" in account and f"python -m studies {name}" in account
        assert all(1.0 <= seconds <= 600.0 for seconds in run_times()[name])
        assert study_of(name).main(["--help"]) == 0
        words, options = capsys.readouterr().out, study_of(name).defaults(False)
        assert all(f"--{one.replace('_', '-')}" in words or one.upper() in words for one in options)
        assert "Run: " in words


def test_where_nothing_is_found_a_study_says_so(tmp_path, letter_scene, capsys):
    """No orbit within its errors, and no fold in the map."""
    assert "no orbit exists at one standard error" in next_measurement.findings([], [])[0]
    run = Run(study="hysteresis", folder=tmp_path, scene=letter_scene, command="")
    judge(run, [], {}, Causes(at="", **{name: None if "map" in name else 1.0 for name in CAUSES}))
    assert "nothing to compare" in capsys.readouterr().err and not run.close("done", {"rows": []})["verdicts"]
    # nor of higher modes with one mode
    off = {name: Accuracy(description=name, folds=1, median=1.0, worst=1.0) for name in DESCRIPTIONS}
    judge(run, [], off, Causes(at="", **dict.fromkeys(CAUSES, 1.0)), higher=False)
    kept = run.close("done", {"rows": []})
    assert "two_parameters" not in kept["verdicts"] and "higher" not in " ".join(kept["findings"])


def test_a_p1_unstable_down_to_faint_touches_loses_its_stability_there(monkeypatch):
    """p1 is unstable at 2 % of the doubling's speed, where the first speeds end, and stable below 0.3 %."""

    class Orbits:
        def __init__(self, **_):
            pass

        def at_speed(self, speed, near):
            size = 1.0 + (speed - 0.003)
            return SimpleNamespace(speed=speed, excess=speed**2, multipliers=np.array([1j, -1j]) * size)

    monkeypatch.setattr("studies.experiment.soft_wall.model.Shooting", Orbits)
    excess, turns = loss_of_stability(None, SimpleNamespace(speed=1.0, excess=1.0))
    assert turns and excess == pytest.approx(0.003**2, rel=1e-5)
