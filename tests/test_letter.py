"""The verdicts on the letter's points: on the page as in the tests, and each tested on a run of its study."""

import re
from pathlib import Path

from conftest import EXPECTED
from test_every_study import OTHERS

from studies.letter import POINTS

ROOT = Path(__file__).resolve().parent.parent


def test_every_point_has_its_verdict_on_the_page():
    page = (ROOT / "docs" / "letter" / "verdicts.md").read_text("utf-8")
    rows = re.findall(r"^\| (.*\.) \| (.*) \| .* \| (.*) \|$", page, flags=re.MULTILINE)
    assert EXPECTED.keys() == POINTS.keys()
    for (says, verdict, study), (key, point) in zip(rows, POINTS.items(), strict=True):
        assert says.startswith(point.says[:-1]) and (verdict, study) == (EXPECTED[key], point.study)


def test_the_verdicts_of_every_study_that_judges_points_are_tested_on_a_run():
    texts = [path.read_text("utf-8") for path in (ROOT / "tests" / "studies").glob("test_*.py")]
    tested = {name for text in texts for name in re.findall(r'== verdicts_on\("(\w+)"\)', text)}
    assert {point.study for point in POINTS.values()} <= tested | set(OTHERS)
