"""The site is whole: links lead somewhere, nothing is fetched, every example has a picture and a notebook."""

import re
import subprocess
import sys
import textwrap
from html import unescape
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).resolve().parent.parent
NAMED = re.compile(r"<(a|link|img|script|source|iframe)\b[^>]*?\b(?:href|src)=\"([^\"]*)\"")
"""An element that names another file, and the name."""


def test_formulas_of_module_docstrings_keep_their_shape():
    """The function of the settings that does it, on its own: the settings load much else."""
    text = (ROOT / "docs" / "conf.py").read_text("utf-8")
    (source,) = re.findall(r"^SET_OUT.*?splitlines\(\)$", text, re.DOTALL | re.MULTILINE)
    exec(source, made := {"re": re, "textwrap": textwrap})
    lines = "With |x| small,\n    a   b\n\n    |c|\nthen ``|y|``.\n\n`p`    one\n       and".split("\n")
    made["formulas_as_they_stand"](None, "module", "", None, None, lines)
    block, shown = [".. code-block:: text"], [line for line in lines if line]
    formula, words = ["    a   b", "    |c|"], ["    `p`    one", "           and"]
    assert shown == [r"With \|x\| small,", *block, *formula, "then ``|y|``.", *block, *words]


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_every_link_leads_somewhere(tmp_path):
    site = tmp_path.resolve() / "site"
    call = [sys.executable, *"-m sphinx -W --keep-going -q -j 2 -b html".split()]
    call += ["-d", str(tmp_path / "doctrees"), "docs", str(site)]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    pages = {path: path.read_text("utf-8") for path in site.rglob("*.html") if "_static" not in path.parts}
    places = {path: set(re.findall(r"\b(?:id|name)=\"([^\"]*)\"", text)) for path, text in pages.items()}
    broken = []
    for path, text in pages.items():
        for element, link in NAMED.findall(text):
            parts = urlsplit(unescape(link))
            if parts.scheme:
                assert element == "a" or parts.scheme == "data", f"{path.name} fetches {link}"
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.parent.parent == site.parent and target.parent != site:  # of the results, beside a site
                target = ROOT / "results" / target.parent.name / target.name
            if not target.is_file() or (parts.fragment and unquote(parts.fragment) not in places[target]):
                broken.append(f"{path.relative_to(site)}: {link}")
    assert len(pages) > 150 and broken == []
    assert not [
        path for path in site.rglob("*.css") if re.search(r"url\(['\"]?https?:", path.read_text("utf-8"))
    ]
    index = pages[site / "examples" / "index.html"]
    for name in (path.stem for path in (ROOT / "docs" / "gallery").glob("*.py")):
        text = pages[site / "examples" / f"{name}.html"]
        assert f"sphx_glr_{name}_001" in text and f"{name}.ipynb" in text and f"{name}.html" in index
