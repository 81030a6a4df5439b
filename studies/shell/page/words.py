"""What the studies stored, as a page writes it: prose, cells of tables, numbers in units of a person."""

from __future__ import annotations

import re
import shlex
from itertools import pairwise

from markupsafe import Markup, escape

from studies.shell.digits import prefixed, written
from studies.shell.programs import ALL

NUMBER = r"\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?"
SIGNED = re.compile(rf"(?<![\w.)\]−-])-(?={NUMBER})")
"""A hyphen that is the sign of a number; one in a word or a range is none."""

LONG = re.compile(r"(?<![\w.])(?:\d+\.\d{5,}(?:e[-+]?\d+)?|\d+(?:\.\d+)?e[-+]?\d+)(?!\w|\.\d)")
"""A number with many digits, or with an exponent."""

SIGNS = {"kg^(-1/2) m^(-1)": "1/(√kg m)", "kg^(-1/2)": "1/√kg", "kg^(1/2)": "√kg", "^2": "²", "^3": "³"}
SIGNS |= {"+-": "±", "<->": "↔", "->": "→", " x ": " × ", " - ": " − ", ">=": "≥", "<=": "≤"}
"""What is typed, and its printed form; the longer one first."""

CELLS = {"True": "yes", "False": "no", "": "–", "inf": "∞", "single_mode": "Eq. (1)"}
"""What a page writes for these cells."""


def plain(text: str) -> str:
    """Prose with the signs and numbers of print."""
    for typed, printed in SIGNS.items():
        text = text.replace(typed, printed)
    text = re.sub(r"\s+", " ", text).strip()
    return LONG.sub(lambda match: written(float(match[0])), SIGNED.sub("−", text))


def prose(text: str) -> Markup:
    """A sentence as HTML: what stands between backticks is code, and an index stands lower."""
    parts = re.split(r"`+([^`]+)`+", plain(text))
    code = Markup("<code>{}</code>")
    pieces = [code.format(part) if n % 2 else _lowered(str(escape(part))) for n, part in enumerate(parts)]
    return Markup("").join(pieces)


def _lowered(text: str) -> Markup:
    """HTML in which the index of a symbol stands lower, as in F_m and p4."""
    return Markup(re.sub(r"\b(?:([A-Za-zρ])_([A-Za-z0-9])|(p)(\d+))\b", r"\1\3<sub>\2\4</sub>", text))


def cell(text: str) -> str:
    """A cell of a table: a number to four digits, words without underscores, yes or no, a dash."""
    if text in CELLS:
        return CELLS[text]
    try:
        return written(float(text)).replace(" ", "\u00a0")
    except ValueError:
        return plain(re.sub(r"(?<=\w)_(?=\w)", " ", text))


def quantity(value: object, unit: str) -> str:
    """The value of a key of a scene, in a unit that a person would choose."""
    if isinstance(value, list):
        return ", ".join(quantity(one, unit) for one in value) or "none"
    if not isinstance(value, int | float) or isinstance(value, bool):
        return cell(str(value))
    scale, unit = prefixed(abs(value), unit or "1")
    return plain(f"{written(value / scale)} {unit}".removesuffix(" 1"))


KEPT = ("--scene", "--set", "--out", "--style")
"""Options that every study takes with a value."""


def command_for_the_rest(command: str) -> str:
    """The command that runs every study on the scene of this command, in the same form and folder."""
    given, kept = shlex.split(command), list[str]()
    for word, following in pairwise([*given, ""]):
        if word == "--quick" or word.partition("=")[0] in KEPT:
            kept += [word, following] if word in KEPT and following else [word]
    return f"{ALL} {shlex.join(kept)}".rstrip()
