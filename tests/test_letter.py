"""The verdict on each of the letter's points, one test a point, from the small form of its study."""

import json
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from studies.letter import POINTS

ROOT = Path(__file__).resolve().parent.parent

VERDICTS = {
    "agrees": "p3 p4 p5 p6 p8 period_adding coexistence chaos last_period bands neighbour_band time_trace "
    "many_modes restitution_on_orbit secondary universality soft_wall sampled",
    "in part": "torsion hysteresis restitution loss breakdown breakdown_p3 island smoothing two_parameters "
    "two_parameters_born",
    "differs": "p10",
    "fitted": "free_period drive_amplitude",
    "not printed": "delay",
}
EXPECTED = {key: verdict for verdict, keys in VERDICTS.items() for key in keys.split()}


@cache
def summary_of(study: str, folder: Path) -> dict:
    """The summary of the small form of a study, run once for all its points."""
    command = [sys.executable, "-m", "studies", study, "--quick", "--workers=1", f"--out={folder}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads((folder / study / "summary.json").read_text())


@pytest.fixture(scope="session")
def results(tmp_path_factory) -> Path:
    """The folder of the results."""
    return tmp_path_factory.mktemp("results")


def test_every_point_has_its_verdict_on_the_page():
    page = (ROOT / "docs" / "letter" / "verdicts.md").read_text("utf-8")
    rows = re.findall(r"^\| (.*\.) \| (.*) \| .* \| (.*) \|$", page, flags=re.MULTILINE)
    assert EXPECTED.keys() == POINTS.keys()
    for (says, verdict, study), (key, point) in zip(rows, POINTS.items(), strict=True):
        assert says.startswith(point.says[:-1]) and (verdict, study) == (EXPECTED[key], point.study)


@pytest.mark.slow
@pytest.mark.parametrize(
    "key", [pytest.param(key, marks=pytest.mark.xdist_group(point.study)) for key, point in POINTS.items()]
)
def test_the_verdict_on_a_point(key, results):
    verdicts = summary_of(POINTS[key].study, results)["verdicts"]
    assert verdicts[key]["verdict"] == EXPECTED[key], verdicts[key]
