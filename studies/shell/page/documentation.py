"""The site: what the packages say of themselves (pdoc, from the docstrings), beside the page of all results.

results/site/index.html       README, every module, and a search through them
             results.html     the page; its links lead to the other files of results
             beam/..., contact/..., studies/...
"""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Sequence
from pathlib import Path

from jinja2 import ChoiceLoader, DictLoader

from beam import InvalidValue
from studies import ROOT
from studies.shell.files import explained
from studies.shell.programs import needs

INDEX = """{% set root_module_name = false %}{% extends "default/index.html.jinja2" %}
{% block title %}grazing-spring{% endblock %}{% block logo %}{% endblock %}
{% block nav %}<h2><a href="results.html">Results</a></h2>{{ super() }}{% endblock %}
{% block content %}{% set main = '<main class="pdoc">' | safe %}
{{ super() | replace(main, main ~ (readme | to_html | safe)) }}{% endblock %}"""
"""Template of the first page, on top of that of pdoc."""


def module_names() -> list[str]:
    """The modules of beam and contact, and what the studies share; each study is on the page of results."""
    files = [*(ROOT / "beam").rglob("*.py"), *(ROOT / "contact").rglob("*.py")]
    files += [path for part in ("physics", "shell") for path in (ROOT / "studies" / part).rglob("*.py")]
    files.append(ROOT / "studies" / "letter.py")
    dotted = (".".join(path.relative_to(ROOT).with_suffix("").parts) for path in files)
    return sorted(name.removesuffix(".__init__") for name in dotted)


def write_site(results: Path, page: Path, modules: Sequence[str]) -> Path:
    """Write results/site, what these modules say of themselves beside the page; returns its first file."""
    try:
        from pdoc import doc, render
    except ImportError as error:
        raise InvalidValue(needs("a site", "pdoc")) from error
    readme, folder = ROOT / "README.md", results / "site"
    render.configure(docformat="numpy", show_source=False)
    usual = [render.env.loader] if render.env.loader else []
    render.env.loader = ChoiceLoader([DictLoader({"index.html.jinja2": INDEX}), *usual])
    render.env.globals["readme"] = readme.read_text(encoding="utf-8") if readme.exists() else ""
    with warnings.catch_warnings(), explained(f"the site cannot be written to {folder}"):
        # types of inherited fields and of named tuples, when of another module: shown as they are written
        warnings.filterwarnings("ignore", r"Error parsing type annotation .*\.__init__\. Import of")
        known = {name: doc.Module.from_name(name) for name in modules}
        texts = {f"{name.replace('.', '/')}.html": render.html_module(known[name], known) for name in known}
        texts |= {"index.html": render.html_index(known), "search.js": render.search_index(known)}
        for name, text in texts.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        shutil.copyfile(page, folder / "results.html")
        if (docs := ROOT / "docs").exists():  # what the README shows and names
            shutil.copytree(docs, folder / "docs", dirs_exist_ok=True)
    return folder / "index.html"
