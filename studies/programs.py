"""The studies as programs: their names, what they say of themselves, the nearest to a misspelt one.

A study is a file of this folder, or a folder with a `__main__`, that runs: nothing lists them. Nothing of
this imports a study.
"""

from __future__ import annotations

import ast
import re
from difflib import get_close_matches
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
PROGRAM = re.compile(r'^(if __name__ == "__main__":|# %%)', re.MULTILINE)
"""What a file that runs has: a last paragraph, or the cells of a script."""

MAIN = "transitions"
"""What `python -m studies` runs."""


def source_of(name: str) -> Path:
    """The file that runs as `python -m studies.NAME`."""
    folder = FOLDER / name / "__main__.py"
    return folder if folder.exists() else FOLDER / f"{name}.py"


def names() -> list[str]:
    """Every program that runs as `python -m studies.NAME`."""
    files = [path.stem for path in FOLDER.glob("[a-z]*.py")]
    found = {*files, *(path.parent.name for path in FOLDER.glob("[a-z]*/__main__.py"))}
    return sorted(name for name in found if PROGRAM.search(source_of(name).read_text("utf-8")))


def account_of(name: str) -> str:
    """What a study says of itself: its docstring."""
    return ast.get_docstring(ast.parse(source_of(name).read_text("utf-8"))) or ""


def title_of(name: str) -> str:
    """The first paragraph of it."""
    return " ".join(account_of(name).split("\n\n")[0].split())


def unknown(name: str) -> str:
    """What to say of a study that does not exist."""
    nearest = get_close_matches(name[:100], names(), n=1, cutoff=0.6)
    if nearest:
        return f"there is no study {name}; did you mean python -m studies.{nearest[0]}?"
    return f"there is no study {name}; the studies are {', '.join(names())}"


def wrong_name(arguments: list[str]) -> str | None:
    """The NAME in `-m studies.NAME` among the arguments of the interpreter, if there is no such module."""
    for word, following in zip(arguments, [*arguments[1:], ""], strict=True):
        module = following if word == "-m" else word.removeprefix("-m") if word.startswith("-m") else ""
        if module.startswith("studies."):
            name = module.removeprefix("studies.").split(".")[0]
            there = (FOLDER / name).is_dir() or (FOLDER / f"{name}.py").exists()
            return None if there else name
    return None
