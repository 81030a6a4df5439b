"""Pieces of the page: escaped text, prose with subscripts and powers, tables.

Prose is what studies and declarations write: plain text in which `F_m`, `rho_m`, `h^(3/2)`, `K^-1/2`,
`-5.6e-02` and a minus before a number are set as mathematics. Everything else is escaped. A table is read
from its columns; numbers stand right, so that equal places are below one another.
"""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

MINUS = "\N{MINUS SIGN}"
TIMES = "\N{NO-BREAK SPACE}\N{MULTIPLICATION SIGN}\N{NO-BREAK SPACE}"
GREEK = {
    "rho": "ρ",
    "tau": "τ",
    "alpha": "α",
    "gamma": "γ",
    "omega": "ω",
    "Omega": "Ω",
    "mu": "μ",
    "phi": "φ",
}

_SCIENTIFIC = re.compile(r"(?<![\w.])([+-]?\d+(?:\.\d+)?)e([+-]?)0*(\d+)(?![\w.]*\w)")
_POWER = re.compile(r"\^\(([^()]{1,12})\)|\^(-?[0-9]+(?:/[0-9]+)?)")
_ORBIT = re.compile(r"(?<![\w/.-])p(\d{1,2})(?!\w)")
_INDEX = re.compile(r"(?<!\w)([A-Za-z]|rho|tau|alpha|gamma|omega|Omega|phi)_([A-Za-z]|\d+)(?![\w])")
_GREEK = re.compile(r"(?<![\w/.-])(" + "|".join(GREEK) + r")(?![\w.])")
ARROWS = {" -&gt; ": " \N{RIGHTWARDS ARROW} ", " x ": " \N{MULTIPLICATION SIGN} "}
_ARROWS = re.compile(r" -&gt; | x (?=\d)")
_MICRO = re.compile(r"(?:(?<=\d )|(?<=\())u(?=[sm]\b)")
_MINUS = re.compile(r"(?<![\w)>])-(?=\d)|(?<= )-(?= )")


def escaped(value: Any) -> str:
    return html.escape(str(value), quote=True)


def code(value: Any) -> str:
    """A name of the program."""
    return f"<code>{escaped(value)}</code>"


def _scientific(match: re.Match[str]) -> str:
    mantissa, sign, exponent = match.groups()
    times = "" if mantissa in ("1", "1.0") else f"{mantissa}{TIMES}"
    return f"{times}10<sup>{MINUS if sign == '-' else ''}{exponent}</sup>"


def prose(words: str) -> str:
    """Plain text as markup, its mathematics set."""
    line = _ARROWS.sub(
        lambda m: ARROWS[m[0]], html.escape(words, quote=False).replace("&lt;=", "\N{LESS-THAN OR EQUAL TO}")
    )
    line = _MICRO.sub("µ", line)
    line = _SCIENTIFIC.sub(_scientific, line)
    line = _POWER.sub(lambda m: f"<sup>{(m[1] or m[2]).replace('-', MINUS)}</sup>", line)
    line = _ORBIT.sub(lambda m: f"<i>p</i><sub>{m[1]}</sub>" if m[1] != "0" else "no period", line)
    line = _INDEX.sub(lambda m: f"<i>{GREEK.get(m[1], m[1])}</i><sub>{m[2]}</sub>", line)
    line = _GREEK.sub(lambda m: GREEK[m[1]], line)
    line = _MINUS.sub(MINUS, line)
    return re.sub(r"(?<=\d) (?=(?:Hz|kHz|ms|mm|µs|µm|nm|g|m/s|%|N)\b|%)", "\N{NO-BREAK SPACE}", line)


@dataclass(frozen=True, kw_only=True)
class Column:
    """Heading (prose, unit in brackets), what is in it, and how it is written."""

    head: str
    values: Sequence[Any]
    write: Callable[[Any], str]
    numeric: bool = True


@dataclass(frozen=True, kw_only=True)
class Table:
    """Columns of equal length under one sentence that says what they are."""

    caption: str
    columns: Sequence[Column]

    def html(self) -> str:
        if len({len(column.values) for column in self.columns}) > 1:
            raise ValueError(f"the columns of the table {self.caption!r} must have equal lengths")
        heads = "".join(
            f'<th scope="col"{_right(column)}>{prose(column.head)}</th>' for column in self.columns
        )
        rows = "".join(
            "<tr>"
            + "".join(
                _cell(column, value, first=number == 0)
                for number, (column, value) in enumerate(zip(self.columns, values, strict=True))
            )
            + "</tr>"
            for values in zip(*(column.values for column in self.columns), strict=True)
        )
        return scrolling(f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>", self.caption)


def _right(column: Column) -> str:
    return ' class="n"' if column.numeric else ""


def _cell(column: Column, value: Any, *, first: bool) -> str:
    if first:
        return f'<th scope="row"{_right(column)}>{column.write(value)}</th>'
    return f"<td{_right(column)}>{column.write(value)}</td>"


def scrolling(table: str, caption: str) -> str:
    """A table under its caption, which scrolls sideways by itself where the window is narrow."""
    return (
        f'<div class="table"><p class="caption">{prose(caption)}</p>'
        f'<div class="wide" role="region" tabindex="0" aria-label="{escaped(caption)}">{table}</div></div>'
    )


def sentence(words: str) -> str:
    """A clause in prose as a sentence: capital first, full stop last."""
    text = words.strip()
    if not text:
        return ""
    first = text[0] if re.match(r"[a-z]_?\d|[a-z]_", text) else text[0].upper()
    return prose(first + text[1:] + ("" if text[-1] in ".?!" else "."))


def items(lines: Sequence[str], kind: str = "") -> str:
    """A list of sentences."""
    mark = f' class="{kind}"' if kind else ""
    return f"<ul{mark}>" + "".join(f"<li>{sentence(line)}</li>" for line in lines) + "</ul>" if lines else ""
