"""The site: pages of this folder, the gallery, the docstrings, and the page of stored results.

Build: make site.  GALLERY=0 make site does not run the examples.
"""

import importlib
import importlib.util
import os
import re
import subprocess
import sys
import textwrap
from functools import cached_property
from pathlib import Path
from types import FunctionType

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")  # before vtk is imported
sys.path[:0] = [str(HERE), str(ROOT)]

import pyvista

import beam

pyvista.OFF_SCREEN = pyvista.BUILDING_GALLERY = True
MATHJAX = Path(importlib.util.find_spec("sphinx-mathjax-offline").origin).parent / "static/mathjax/tex-svg.js"

project = html_title = "grazing-spring"
version = release = beam.__version__
extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "numpydoc",
    "myst_parser",
    "sphinx_gallery.gen_gallery",
    "sphinx_copybutton",
]
exclude_patterns = ["gallery", "examples/*.py", "made"]
templates_path, html_static_path, html_css_files = ["_templates"], ["_static", str(MATHJAX)], ["house.css"]
suppress_warnings = ["config.cache"]  # a function stands among the settings

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
mathjax_path, mathjax3_config = "tex-svg.js", {"options": {"enableMenu": False}}
copybutton_prompt_text, copybutton_prompt_is_regexp = r">>> |\.\.\. ", True

autosummary_generate, autodoc_typehints, add_module_names = True, "none", False
numpydoc_show_class_members, toc_object_entries_show_parents = False, "hide"

html_theme, html_copy_source, html_show_sourcelink = "pydata_sphinx_theme", False, False
html_sidebars = {"start": [], "glossary": []}
html_theme_options = {
    "show_prev_next": False,
    "navigation_with_keys": False,
    "navbar_end": ["theme-switcher"],
    "header_links_before_dropdown": 9,
    "footer_start": [],
    "footer_end": [],
}

sphinx_gallery_conf = {
    "examples_dirs": ["gallery"],
    "gallery_dirs": ["examples"],
    "filename_pattern": r"\.py$",
    "image_scrapers": ("films", "matplotlib", "pyvista"),
    "within_subsection_order": "films.ReadingOrder",
    "abort_on_example_error": True,
    "image_srcset": ["2x"],
    "show_signature": False,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "plot_gallery": os.environ.get("GALLERY", "1") == "1",
    "doc_module": ("beam", "contact"),
    "reference_url": {"beam": None, "contact": None},
    "backreferences_dir": "examples/backreferences",
}

# what the pages take from the programs: pictures, and the page of all stored results
MADE, REPORT = HERE / "made", ROOT / "results" / "report" / "index.html"
MADE.mkdir(exist_ok=True)
FIGURES = {
    "transitions": "orbit_diagram",
    "hysteresis": "hysteresis",
    "time_trace": "time_trace",
    "breakdown": "breakdown",
}
for study, figure in {"tour": "", **FIGURES}.items():
    picture = MADE / "results" / study / f"{figure}.png"
    if figure and picture.exists() and not sphinx_gallery_conf["plot_gallery"]:
        continue  # a quick build, without the examples, keeps the pictures of an earlier one
    call = [sys.executable, "-m", "studies", study, *(["--quick"] if figure else [])]
    subprocess.run(
        call, cwd=MADE, env=os.environ | {"PYTHONPATH": str(ROOT)}, check=True, capture_output=True
    )
inside = """<p>Nothing is stored yet. <code>make study</code> runs the main study,
<code>python -m studies --all</code> every study. Then <code>make site</code> fills this page.</p>"""
if REPORT.exists():
    page = REPORT.read_text(encoding="utf-8")
    style, body = (re.search(rf"<{tag}>(.*?)</{tag}>", page, re.DOTALL)[1] for tag in ("style", "main"))
    inside = f"<style>.report {{ {style} }}</style>\n<div class='report'>{body}</div>"
(MADE / "results.html").write_text(inside, encoding="utf-8")

SET_OUT = r"((?:^(?:    .*|.*\S {3,}\S.*)\n(?: *\n)*)+)"
"""Lines that are indented or have columns, and blank lines between them."""


def formulas_as_they_stand(app, what, name, obj, options, lines):
    """Formulas and columns of a module's docstring keep their shape; ``|x|`` elsewhere is no markup."""
    lines[:] = [re.sub(r"``docs/([\w/]+)\.md``", r":doc:`/\1`", line) for line in lines]
    if what == "module":
        parts = re.split(SET_OUT, "".join(f"{line}\n" for line in lines), flags=re.MULTILINE)
        parts[::2] = [re.sub(r"\|(?![^\n]*``)", r"\|", part) for part in parts[::2]]
        blocks = [textwrap.indent(textwrap.dedent(part), "    ") for part in parts[1::2]]
        parts[1::2] = [f"\n.. code-block:: text\n\n{block}\n" for block in blocks]
        lines[:] = "".join(parts).splitlines()


def members_of(module, name):
    """The public properties and methods of a class, its own and the ones of its parents in the packages."""
    parents = getattr(importlib.import_module(module), name).__mro__
    ours = [vars(one) for one in parents if one.__module__.partition(".")[0] in ("beam", "contact")]
    public = {key: one for own in reversed(ours) for key, one in own.items() if not key.startswith("_")}
    properties = [key for key, one in public.items() if isinstance(one, property | cached_property)]
    kinds = FunctionType | classmethod | staticmethod
    return properties, [key for key, one in public.items() if isinstance(one, kinds)]


autosummary_context = {"members_of": members_of}


def setup(app):
    early = 400  # before numpydoc, at 500, adds its mark
    app.connect("autodoc-process-docstring", formulas_as_they_stand, priority=early)
