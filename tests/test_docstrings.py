"""What `help` shows: fields and parameters of public names explained; ruff sees that there are docstrings."""

import dataclasses
import inspect
import re
from pathlib import Path

import pytest

import beam
import contact

ROOT = Path(__file__).parent.parent
NOT_PLAIN = r"(?i)\b(told|asked|swing|swings|pace|those of|stands for)\b"


@pytest.mark.parametrize("package", [beam, contact], ids=lambda package: package.__name__)
def test_fields_and_parameters_of_public_names_are_explained(package):
    """Each name stands in the docstring of its class or function, or of the class that it comes from."""
    unexplained = []
    for name in package.__all__:
        thing = getattr(package, name)
        if dataclasses.is_dataclass(thing) and inspect.isclass(thing):
            text = " ".join(inspect.getdoc(k) or "" for k in thing.__mro__)
            wanted = [field.name for field in dataclasses.fields(thing) if not field.name.startswith("_")]
        elif inspect.isfunction(thing):
            text, wanted = inspect.getdoc(thing) or "", list(inspect.signature(thing).parameters)
        else:
            continue
        unexplained += [f"{name}: {part}" for part in wanted if not re.search(rf"\b{part}\b", text)]
    assert not unexplained


def test_words_are_plain():
    """These words name an instrument or a number as if it were a person, or need a second reading."""
    places = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    places += [path for package in ("beam", "contact", "studies") for path in (ROOT / package).rglob("*.py")]
    found = {path.relative_to(ROOT): re.findall(NOT_PLAIN, path.read_text("utf-8")) for path in places}
    assert {path: words for path, words in found.items() if words} == {}
