"""The studies as programs: their names, what they say of themselves, the nearest to a misspelt one.

Nothing of this imports a study.
"""

from __future__ import annotations

import ast
from difflib import get_close_matches
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent
MAIN = "transitions"
"""What `python -m studies` runs."""


def names() -> list[str]:
    """Every study that runs as `python -m studies.NAME`."""
    return [
        source.stem
        for source in sorted(FOLDER.glob("*.py"))
        if not source.stem.startswith("_") and "def main(" in source.read_text(encoding="utf-8")
    ]


def first_sentence(name: str) -> str:
    """The first sentence of a study's docstring."""
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    return (ast.get_docstring(ast.parse(text)) or "").split("\n\n")[0].replace("\n", " ")


def unknown(name: str) -> str:
    """What to say of a study that does not exist."""
    known = names()
    nearest = get_close_matches(name[:100], known, n=1, cutoff=0.6)
    if nearest:
        return f"there is no study {name}; did you mean python -m studies.{nearest[0]}?"
    return f"there is no study {name}; the studies are {', '.join(known)}"


def named_by(arguments: list[str]) -> str | None:
    """The name in `-m studies.NAME` among the arguments of the interpreter, if there is no such module."""
    for word, following in zip(arguments, [*arguments[1:], ""], strict=True):
        module = following if word == "-m" else word.removeprefix("-m") if word.startswith("-m") else ""
        if module.startswith("studies."):
            name = module.removeprefix("studies.")
            place = FOLDER / name.split(".")[0]
            return None if place.is_dir() or place.with_suffix(".py").exists() else name
        if module:
            return None
    return None
