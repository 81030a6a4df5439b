"""The site is whole: links lead somewhere, nothing is fetched, every example has a picture and a notebook."""

import os
import re
import subprocess
import sys
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).resolve().parent.parent
PLACES = {"a": "href", "link": "href", "img": "src", "script": "src", "source": "src", "iframe": "src"}
"""Elements that name another file, and the attribute that does."""


class Page(HTMLParser):
    """What a page names, by element, and the places in it that can be named."""

    def __init__(self, path: Path):
        super().__init__()
        self.links: list[tuple[str, str]] = []
        self.anchors = set[str]()
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.anchors |= {given[key] for key in ("id", "name") if given.get(key)}
        if given.get(PLACES.get(tag, "")):
            self.links.append((tag, unescape(given[PLACES[tag]])))


def test_formulas_of_module_docstrings_keep_their_shape():
    """The part of the settings that does it, on its own."""
    text = (ROOT / "docs" / "conf.py").read_text("utf-8")
    (source,) = re.findall(
        r"^def formulas_as_they_stand.*?^    lines\[:\] = shown$", text, re.DOTALL | re.MULTILINE
    )
    made: dict = {}
    exec(source, made)
    lines = ["With |x| small,", "    a   b", "    |c|  d", "", "    e", "then ``|y|``."]
    made["formulas_as_they_stand"](None, "module", "", None, None, lines)
    block = [".. code-block:: text", "", "    a   b", "    |c|  d", "", "    e", "", "then ``|y|``."]
    assert lines == [r"With \|x\| small,", "", *block]
    made["formulas_as_they_stand"](None, "function", "", None, None, same := ["    a  |b|"])
    assert same == ["    a  |b|"]


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site, built with warnings as errors."""
    folder = tmp_path_factory.mktemp("site").resolve()
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", "-b", "html"]
    command += ["-d", str(folder / "doctrees"), "docs", str(folder / "site")]
    done = subprocess.run(command, cwd=ROOT, env=os.environ, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    return folder / "site"


@pytest.mark.slow
def test_every_link_of_the_site_leads_somewhere_and_nothing_is_fetched(site):
    pages = {path: Page(path) for path in site.rglob("*.html")}
    results, broken = ROOT / "results", []
    for path, page in pages.items():
        for tag, link in page.links:
            parts = urlsplit(link)
            if parts.scheme in ("http", "https"):
                assert tag == "a", f"{path.name} fetches {link}"
            if parts.scheme:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if (
                target.parent.parent == site.parent
            ):  # a file of the results, beside the site when it is in its place
                target = results / target.parent.name / target.name
            known = target in pages and (
                not parts.fragment or unquote(parts.fragment) in pages[target].anchors
            )
            if not (known or (target not in pages and target.is_file())):
                broken.append(f"{path.relative_to(site)}: {link}")
    assert len(pages) > 150 and broken == []
    for sheet in site.rglob("*.css"):
        assert not re.findall(r"url\(['\"]?https?:|@import ['\"]https?:", sheet.read_text("utf-8")), sheet


@pytest.mark.slow
def test_each_example_has_a_picture_and_a_notebook(site):
    examples = sorted(path.stem for path in (ROOT / "docs" / "gallery").glob("*.py"))
    index = (site / "examples" / "index.html").read_text("utf-8")
    for name in examples:
        text = (site / "examples" / f"{name}.html").read_text("utf-8")
        assert f"sphx_glr_{name}_001" in text and f"{name}.ipynb" in text and f"{name}.html" in index
    assert (site / "tex-svg.js").exists() or (site / "_static" / "tex-svg.js").exists()


@pytest.mark.slow
def test_words_of_the_glossary_and_every_name_are_found_by_the_search(site):
    text = (site / "searchindex.js").read_text("utf-8")
    assert all(word in text for word in ("virtual motion", "StroboscopicMap", "first_graze"))
