"""The page: what is stored is on it, what is missing or broken is told, nothing is loaded from elsewhere."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from studies import letter, report
from studies.shell import plotting
from studies.shell.page import told_page, write_page
from studies.shell.page.documentation import module_names, write_site
from studies.shell.programs import studies
from studies.shell.run import Run
from studies.shell.scene import Scene


@dataclass(frozen=True)
class Row:
    """A row whose text would be markup."""

    word: str
    value: float


def stored(results: Path, scene: Scene, study: str = "transitions") -> Run:
    """Results of a study with a table, a figure, a verdict and a failed cell."""
    run = Run(study=study, folder=results / study, scene=scene, command=f"python -m studies {study} --quick")
    run.table("rows", [Row("<b>bold</b>", 0.123456789)], "A caption & more", of=Row, show=())
    run.table("long", [Row("x", float(n)) for n in range(100)], of=Row, show=())
    figure, axes = plotting.new_figure()
    axes.plot([0.0, 1.0], **plotting.series(0))
    run.figure("picture", figure, "What is drawn.")
    if study == "transitions":
        run.verdict("p3", "agrees", found="p3")
        run.verdict("p10", "differs", found="p11", note="the edge lies where f T = 20/21")
    if study == "hysteresis":
        run.answer("hysteresis", "A product of causes.")
    run.failed("cell 1", "<script>no</script>")
    run.close("done", {"rows": []})
    return run


@pytest.fixture(scope="module")
def results(tmp_path_factory, letter_scene):
    return stored(tmp_path_factory.mktemp("results"), letter_scene).folder.parent


def assert_balanced(text: str) -> None:
    """Every element that is opened is closed, in order."""
    opened: list[str] = []
    for closing, tag in re.findall(r"<(/?)([a-z]\w*)", text):
        if closing:
            assert opened and opened.pop() == tag, tag
        elif tag not in ("meta", "link", "img", "br"):
            opened.append(tag)
    assert opened == []


def test_the_page_holds_what_is_stored_and_loads_nothing(tmp_path, letter_scene):
    for study in ("transitions", "hysteresis"):
        stored(tmp_path, letter_scene, study)
    path, found, missing = write_page(tmp_path)
    text = path.read_text()
    assert path == tmp_path / "report" / "index.html"
    assert [one.study for one in found] == ["transitions", "hysteresis"]
    assert "chart" in missing and "tour" not in missing
    assert_balanced(text)
    for place in ("study-transitions", "study-hysteresis", "answers", "letter"):
        assert f'id="{place}"' in text
    sources = re.findall(r'(?:\bsrc|<link[^>]*\bhref)="([^"]*)"', text)
    assert sources and all(source.startswith("data:") for source in sources)
    assert "default-src 'none'" in text
    for words in (
        "A caption &amp; more",
        "What is drawn.",
        "&lt;b&gt;bold",
        "0.12346",
        "A product of causes.",
        "&lt;script&gt;no",
        "python -m studies transitions --quick",
        "f T = 20/21",
    ):
        assert words in text, words
    assert "<b>bold" not in text and "<script>no" not in text
    assert text.count("<tr><td>x</td>") == 0  # a table of a hundred rows is left to its file


def test_the_page_of_one_study_shows_its_points_and_one_command_for_the_rest(tmp_path, letter_scene):
    stored(tmp_path, letter_scene)
    path, _, missing = write_page(tmp_path)
    text, own = path.read_text(), [point for point in letter.POINTS.values() if point.study == "transitions"]
    assert len(own) == 7 and all(point.says in text for point in own)
    assert text.count('class="verdict agrees"') == 1 and text.count('class="verdict differs"') == 1
    assert text.count('class="verdict ') == text.count('class="verdict not-stored"') + 2 == 7
    assert text.count("python -m studies --all</code>") == 1 and 'id="answers"' not in text
    assert missing and not any(f"python -m studies {name}" in text for name in missing)
    assert told_page(tmp_path).endswith(" makes the rest") and "\n" not in told_page(tmp_path)


def test_the_page_of_every_study_has_all_points_and_names_no_command(tmp_path, letter_scene):
    for study in studies():
        Run(study=study, folder=tmp_path / study, scene=letter_scene, command="").close("done", {})
    text = write_page(tmp_path)[0].read_text()
    assert all(point.says.replace("'", "&#39;") in text for point in letter.POINTS.values())
    assert "studies --all</code>" not in text and "makes the rest" not in told_page(tmp_path)


@pytest.mark.slow
def test_the_site_shows_what_the_public_modules_say_and_the_results(tmp_path, letter_scene):
    """Warnings are errors: of pdoc, of a type that cannot be read or a module that cannot be imported."""
    stored(tmp_path, letter_scene)
    doors = ["beam", "beam.space", "contact", "contact.orbits", "contact.integrators"]
    assert set(doors) <= set(module_names()) and "studies.tour" not in module_names()
    index = write_site(tmp_path, write_page(tmp_path)[0], doors)
    assert index == tmp_path / "site" / "index.html"
    text, page = index.read_text(), (index.parent / "contact.html").read_text()
    for place in (*(f"{door.replace('.', '/')}.html" for door in doors), "results.html"):
        assert f'href="{place}"' in text and (index.parent / place).exists()
    assert 'id="grazing-spring"' in text and 'id="HertzContact"' in page  # README, and a class
    assert "study-transitions" in (index.parent / "results.html").read_text()


@pytest.mark.parametrize("damage", [b"", b"[1]", b"\xff\xfe", b'{"verdicts": 3, "answers": [1]}'])
def test_a_damaged_file_is_no_reason_to_fail(tmp_path, results, damage):
    for name in ("summary.json", "manifest.json", "rows.csv", "picture.png"):
        shutil.copytree(results, tmp_path, dirs_exist_ok=True)
        (tmp_path / "transitions" / name).write_bytes(damage)
        assert_balanced(write_page(tmp_path)[0].read_text())


def test_the_command_writes_the_page_or_says_why_not(tmp_path, letter_scene, capsys):
    assert report.main(["--out", str(tmp_path), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["status"] == "refused"
    stored(tmp_path, letter_scene)
    assert report.main(["--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["studies"] == ["transitions"] and Path(answer["page"]).exists()
    assert report.main(["--nonsense"]) == 2
