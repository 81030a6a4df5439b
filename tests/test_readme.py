"""The README is true: its code runs, its studies exist, its table is what is computed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from studies.experiment.transitions.__main__ import transitions
from studies.experiment.transitions.model import rows_at
from studies.physics.least_model import least_modes
from studies.shell.programs import MAIN, in_words, run_times
from studies.shell.programs import names as programs
from studies.shell.scene import model_of, read_scene

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_code_block_runs_and_says_what_its_comments_promise(capsys):
    (block,) = re.findall(r"```python\n(.*?)```", TEXT, flags=re.DOTALL)
    names: dict[str, object] = {}
    exec(compile(block, "README.md", "exec"), names)
    said = capsys.readouterr().out.splitlines()
    frequencies = [float(word) for word in re.findall(r"[\d.]+", said[0])]
    assert frequencies == pytest.approx([24.6, 174, 513, 1038], rel=2e-3)
    assert said[1] == "5 1"
    restitution, delay, kick = map(float, said[2].split())
    assert 0 < restitution < 0.6 and 0 < delay < 1e-3 and 0.5 < kick < 1.2
    assert names["fold"].excess < 0
    assert abs(names["fold"].multipliers[0] - 1.0) < 1e-5


def test_every_study_named_exists_and_every_study_is_named():
    named = set(re.findall(r"python -m studies ([a-z_]+)", TEXT))
    there = set(programs())
    assert named == there - {"transitions"}


def test_the_run_times_are_those_of_the_table():
    """`python -m studies --all` has measured it."""
    row = r"^\| `python -m studies(?: ([a-z_]+))?` \|.*\| ([\d.]+ (?:s|min)) \|$"
    written = {name or MAIN: words for name, words in re.findall(row, TEXT, flags=re.MULTILINE)}
    assert written == {name: in_words(full) for name, (full, _) in run_times().items()}
    (whole,) = re.findall(r"--all` runs every study \(([\d.]+ min)\)", TEXT)
    assert whole == in_words(sum(full for full, _ in run_times().values()))


@pytest.mark.parametrize("frequency", [pytest.param(21.50, marks=pytest.mark.slow), 22.20])
def test_the_rows_of_the_first_table_are_computed_values(frequency):
    (line,) = re.findall(rf"^\| {frequency:.2f} \|(.*)\|$", TEXT, flags=re.MULTILINE)
    cells = [cell.strip() for cell in line.split("|")]
    scene, _ = least_modes(read_scene("letter"), transitions.needs)
    rows = rows_at(scene, frequency, model_of(scene)).rows
    assert cells[0] == f"p{rows[0].letter}"
    for row, period, end in zip(rows, cells[1:5], cells[5:], strict=True):
        assert period == f"p{row.period}"
        assert float(end) == pytest.approx(row.excess_down, rel=1e-4)
