"""The page: what is stored is on it, what is missing or broken is named, nothing is loaded from elsewhere."""

import json
import re
import shutil
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import draw_quickly
from page_judge import assert_balanced, assert_fit, seen

from studies import letter, report
from studies.shell import plotting
from studies.shell.page import judged_points, page_sentence, write_page
from studies.shell.page.words import prose, quantity
from studies.shell.programs import studies
from studies.shell.run import Run
from studies.shell.scene import Scene, read_scene


@dataclass(frozen=True)
class Sample:
    """A row with what a page must not show as it is."""

    two_words: str
    value_m: float | None
    good: bool = True
    empty: str = ""


def stored(results: Path, scene: Scene, study: str = "transitions") -> Run:
    """Results of a study with a table, two figures, a film, verdicts, findings and a failed cell."""
    run = Run(study=study, folder=results / study, scene=scene, command=f"python -m studies {study} --quick")
    run.table("rows", [Sample("<b>bold</b>", -0.123456789)], "A caption & more.", of=Sample, show=())
    run.table("long", [Sample("x", float(n)) for n in range(100)], "A long table.", of=Sample, show=())
    for name in ("zebra", "ape"):
        figure, axes = plotting.new_figure()
        axes.plot([0.0, 1.0], **plotting.series(0))
        run.figure(name, figure, f"What {name} shows +- 2e-3.")
    if study == "transitions":
        run.verdict("p3", "agrees", found="p3", figure="ape")
        run.verdict("p10", "differs", found="p11", note="the edge lies where f T = 20/21")
    run.finding("The fold lies at -0.25.")
    run.failed("cell 1", "<script>no</script>")
    run.close("done", {"rows": []})
    return run


@pytest.fixture(scope="module", autouse=True)
def coarse_figures():
    """Figures of few dots: the page shows what is in them all the same."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plotting, "save", draw_quickly)
        yield


@pytest.fixture(scope="module")
def results(tmp_path_factory, letter_scene):
    return stored(tmp_path_factory.mktemp("results"), letter_scene).folder.parent


def test_the_page_holds_what_is_stored_and_loads_nothing(tmp_path, letter_scene):
    for study in ("chart", "hysteresis", "transitions"):
        stored(tmp_path, letter_scene, study)
    path, found, missing = write_page(tmp_path)
    text = path.read_text()
    assert path == tmp_path / "report" / "index.html"
    assert [one.study for one in found] == ["transitions", "hysteresis", "chart"]  # the order of the argument
    assert "claims" in missing and "tour" not in missing
    assert_fit(path)
    places = ["figure-1", "figure-2", "figure-6", "study-hysteresis", "letter", "point-p3", "ground"]
    assert [text.index(f'id="{place}"') for place in places]
    assert text.index("What zebra shows ± 0.002.") < text.index("What ape shows")  # as the study drew them
    assert "transitions/zebra.pdf" in text
    sources = re.findall(r'(?:\bsrc|<link[^>]*\bhref)="([^"]*)"', text)
    assert sources and all(source.startswith("data:") for source in sources)
    assert "default-src 'none'" in text
    for words in (
        "A caption &amp; more.",
        "<th>two words</th><th>value (m)</th><th>good</th></tr>",
        "<td>&lt;b&gt;bold&lt;/b&gt;</td><td>−0.1235</td><td>yes</td></tr>",
        "The fold lies at −0.25.",
        "&lt;script&gt;no",
        "python -m studies transitions --quick",
        "f T = 20/21",
        '<a href="#figure-2" title="At 20.90 Hz p1 goes over into p3.">p<sub>3</sub></a>',
    ):
        assert words in text, words
    assert "<b>bold" not in text and "<script>no" not in text
    assert text.count("<td>x</td>") == 0  # a table of a hundred rows is left to its file
    assert text.index("<img") < text.index("<h2")  # a picture stands on top


def test_the_page_counts_the_points_and_names_one_command_for_the_rest(results):
    path, found, missing = write_page(results)
    text, points = path.read_text(), judged_points(found)
    assert all(str(prose(point.says)) in text for point in letter.POINTS.values())
    assert Counter(one.verdict for one in points) == {"agrees": 1, "differs": 1, "open": len(points) - 2}
    places = {one.key: one.place for one in points}
    assert (places["p3"], places["p10"], places["bands"]) == ("figure-2", "figure-1", "point-bands")
    assert text.count("python -m studies --all --quick</code>") == 1
    assert missing and not any(f"python -m studies {name}" in text for name in missing)
    assert page_sentence(results).endswith("python -m studies --all --quick makes the rest")


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_the_page_of_another_spring_is_its_own(tmp_path):
    """Its title names the ruler, and no point of the letter is judged."""
    stored(tmp_path, read_scene("steel_ruler"))
    path, _, _ = write_page(tmp_path)
    text = path.read_text()
    assert_fit(path)
    assert "<h1>Grazing impacts of a steel cantilever</h1>" in text and "180 × 13 × 0.5 mm" in text
    assert "letter" not in seen(text) and "brass" not in seen(text) and 'class="verdict' not in text
    same = read_scene("letter", ["modes.count=3"])  # judged by its numbers
    stored(tmp_path, same)
    assert 'class="verdict agrees"' in write_page(tmp_path)[0].read_text()


def test_the_page_of_every_study_names_no_command_for_the_rest(tmp_path, letter_scene):
    for study in studies():
        run = Run(study=study, folder=tmp_path / study, scene=letter_scene, command="")
        run.close("done", {"rows": []})
    assert "studies --all" not in write_page(tmp_path)[0].read_text().partition("<h2")[0]
    assert "makes the rest" not in page_sentence(tmp_path)


def test_numbers_have_the_units_that_a_person_would_choose():
    given = [[0.0105, 2.0], 2e-6, 5.15e-3, 2.1e11, -3e4, 0.0, 22.2]
    units = ["m", "s", "kg", "Pa", "N/m", "m", "Hz"]
    found = ["10.5 mm, 2 m", "2 µs", "5.15 g", "210 GPa", "−30 kN/m", "0 m", "22.2 Hz"]
    assert [quantity(value, unit) for value, unit in zip(given, units, strict=True)] == found


@pytest.mark.parametrize("damage", [b"", b"[1]", b"\xff\xfe", b'{"verdicts": 3, "findings": 1}'])
def test_a_damaged_file_is_no_reason_to_fail(tmp_path, results, damage):
    for name in ("summary.json", "manifest.json", "rows.csv", "zebra.png"):
        shutil.copytree(results, tmp_path, dirs_exist_ok=True)
        (tmp_path / "transitions" / name).write_bytes(damage)
        assert_balanced(write_page(tmp_path)[0].read_text())


def test_the_command_writes_the_page_or_says_why_not(tmp_path, results, capsys):
    assert report.main(["--out", str(tmp_path), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["status"] == "refused"
    assert report.main(["--out", str(results), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["studies"] == ["transitions"] and Path(answer["page"]).exists()
    assert report.main(["--nonsense"]) == 2
