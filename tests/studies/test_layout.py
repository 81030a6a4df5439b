"""Where things stand: each study folder has the same files, and what is needed twice is written once."""

import ast
import re
from pathlib import Path

import pytest

from studies import ROOT, letter
from studies.shell.programs import CHAPTERS, chapter

FILES = {"__init__", "__main__", "model", "figure"}
FOLDERS = {
    name: path.parent for each in CHAPTERS for name, path in chapter(each).items() if path.stem != name
}
TEXTS = {
    ".".join(path.relative_to(ROOT / "studies").with_suffix("").parts): path.read_text("utf-8")
    for path in sorted((ROOT / "studies").rglob("*.py"))
}

GENERAL = {0.1, 1e-4, 2e-3, 2e-5, 5e-7}  # round numbers that other quantities have as well
NOT_THE_LETTERS = {
    "letter": "the table itself",
    "tour": "a script to be copied and changed: it imports nothing of studies",
    "shell.scene.keys": "defaults of a scene, each with its origin",
}

ONCE = {
    r"MaximalFamily[.(]": {
        "physics.descriptions": "its fold",
        "experiment.claims.model": "the whole family, up to its secondary bifurcation",
        "measurement.noise.places": "the whole family, at every excess of a scan",
        "measurement.identify.motion.predictions": "starts of a fit, with other restitutions",
        "methods.validation.model": "coefficients, in the units of the source",
    },
    r"orbit_diagram\(": {
        "physics.descriptions": "up and down",
        "experiment.breakdown.model": "upwards alone, from the fold of the island",
    },
    r"hy\.sin\(": {"methods.peers.adapters": "Eq. (1) in heyoka"},
}
"""Call -> the files of the chapters that may make it, each with the reason."""


def names_in(folder: Path) -> set[str]:
    """Its files and folders that hold code."""
    return {path.stem for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}


def unnamed(folder: Path, names: set[str]) -> set[str]:
    """The names that the docstring of a folder does not say."""
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8"))) or ""
    return {name for name in names if f"`{name}`" not in text and f"\n{name} " not in text}


@pytest.mark.parametrize("name", FOLDERS)
def test_a_study_has_the_same_files_as_every_other_or_names_them(name):
    assert unnamed(FOLDERS[name], names_in(FOLDERS[name]) - FILES) == set()


@pytest.mark.parametrize("name", [*CHAPTERS, "physics", "shell", "measurement.identify.record"])
def test_a_chapter_names_its_studies_and_files(name):
    folder = ROOT.joinpath("studies", *name.split("."))
    assert unnamed(folder, names_in(folder) - {"__init__"}) == set()


def test_a_file_without_a_name_is_seen(tmp_path):
    (tmp_path / "__init__.py").write_text('"""A study.\n\n`one`   the first\n"""')
    assert unnamed(tmp_path, {"one", "two"}) == {"two"}


def floats(text: str) -> set[float]:
    """The floats that a program types."""
    values = (node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant))
    return {value for value in values if isinstance(value, float)}


def test_numbers_of_the_letter_are_typed_in_its_table_alone():
    printed = (floats(TEXTS["letter"]) | {letter.AMPLITUDE_STABILITY}) - GENERAL
    assert {22.2, 0.013, 40.80e-3, 3.56, 2.5e-4} <= printed
    typed = {name: found for name, text in TEXTS.items() if (found := printed & floats(text))}
    assert {name: found for name, found in typed.items() if name not in NOT_THE_LETTERS} == {}


@pytest.mark.parametrize("call", ONCE)
def test_stands_once(call):
    assert {name for name, text in TEXTS.items() if re.search(call, text)} == ONCE[call].keys()
