"""What `help` and the site show: complete sections, and examples that run; ruff finds a missing docstring."""

import ast
import doctest
import importlib
import inspect
import re
import textwrap
from enum import EnumType
from operator import attrgetter
from pathlib import Path

import pytest
from numpydoc.docscrape import NumpyDocString
from numpydoc.validate import validate
from public_names import DOORS, public

import beam

ROOT = Path(__file__).parent.parent
NOT_PLAIN = r"(?i)\b(told|asked|swing|swings|pace|those of|stands for)\b"


MAIN = {
    "beam": """Material StripSection Tip cantilever flat_u straight_strip assemble natural_modes reduce
        MeasuredDecay ConstantRatio ModalModel single_mode write_modes write_mode_motion""",
    "contact": """HarmonicDrive Stop NewtonRestitution HertzContact LinearContact HuntCrossley
        ImpactOscillator simulate State Trajectory Impacts collisions Collision restitution_from_bounces
        StroboscopicMap NordmarkMap MapFamily""",
    "contact.orbits": "MaximalFamily Shooting fold_of follow settle onset_orbit orbit_diagram orbit_end",
}
"""The forty names that users meet first, by the place that they are imported from."""

CODES = {"PR01", "PR02", "PR03", "PR04", "PR07", "PR10", "RT01", "RT03", "SS03", "GL03"}
"""Findings of numpydoc: parameters left out, out of order, without type or description; no Returns."""


def refuses(thing: object) -> bool:
    """Whether a function, or a constructor, raises an error or gives a value to a check."""
    makers = ("__init__", "__post_init__")
    bodies = (
        [vars(thing)[name] for name in makers if name in vars(thing)] if inspect.isclass(thing) else [thing]
    )
    for body in filter(inspect.isfunction, bodies):
        if not inspect.getsourcefile(body).startswith(str(ROOT)):
            continue  # made by `dataclass`
        for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(body)))):
            if isinstance(node, ast.Raise) or (isinstance(node, ast.Name) and node.id.startswith("require")):
                return True
    return False


def test_docstrings_of_public_names_are_complete():
    findings = {}
    for name, thing in public().items():
        made_here = not (getattr(thing, "_is_protocol", False) or thing.__class__ is EnumType)
        codes = CODES if made_here else CODES - {"PR01"}
        found = [f"{code}: {words}" for code, words in validate(name)["errors"] if code in codes]
        if refuses(thing) and not NumpyDocString(inspect.getdoc(thing))["Raises"]:
            found.append("no Raises section")
        findings |= {name: found} if found else {}
    assert findings == {}


MAIN_NAMES = [f"{door}.{name}" for door, names in MAIN.items() for name in names.split()]


@pytest.mark.parametrize("name", MAIN_NAMES)
def test_the_main_names_have_examples_that_run(name):
    """Their See Also names other names that exist."""
    door, _, own = name.rpartition(".")
    thing = getattr(importlib.import_module(door), own)
    text = NumpyDocString(inspect.getdoc(thing))
    others = [other for part, _ in text["See Also"] for other, _ in part]
    for other in others:
        package, _, place = (
            other.partition(".") if other.startswith(("beam.", "contact.")) else (door, "", other)
        )
        assert attrgetter(place)(importlib.import_module(package))
    assert others
    assert text["Examples"] and (text["Returns"] or inspect.isclass(thing))
    flags = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    (examples,) = doctest.DocTestFinder(recurse=False).find(thing, name)
    outcome = doctest.DocTestRunner(optionflags=flags).run(examples)
    assert outcome.attempted > 1 and outcome.failed == 0


def test_each_public_name_stands_once_in_the_documentation():
    """Under its place, in the lists of the pages by topic."""
    lists = r"currentmodule:: (\S+)\n\n.. autosummary::\n   :toctree: made\n\n((?:   \w+\n)+)"
    text = "".join(page.read_text("utf-8") for page in (ROOT / "docs" / "api").glob("*.md"))
    listed = [f"{door}.{name}" for door, names in re.findall(lists, text) for name in names.split()]
    listed += re.findall(r"py:data:: (\S+)", text)
    wanted = {f"{door}.{name}" for door in DOORS for name in importlib.import_module(door).__all__}
    assert len(listed) == len(set(listed)) and set(listed) <= wanted
    names = sorted(name.rpartition(".")[2] for name in listed)
    assert names == sorted({name.rpartition(".")[2] for name in wanted})  # some have two places
    values = dict(re.findall(r"py:data:: beam\.(\w+)\n   :value: (.*)", text))
    assert len(values) == 4 and all(
        eval(value, vars(beam)) == getattr(beam, name) for name, value in values.items()
    )


def test_words_are_plain():
    """These words name an instrument or a number as if it were a person, or need a second reading."""
    places = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "gallery").glob("*.py")]
    places += [path for package in ("beam", "contact", "studies") for path in (ROOT / package).rglob("*.py")]
    found = {path.relative_to(ROOT): re.findall(NOT_PLAIN, path.read_text("utf-8")) for path in places}
    assert {path: words for path, words in found.items() if words} == {}
