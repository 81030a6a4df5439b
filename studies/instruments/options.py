"""The options that all studies share, and how --help reads.

--help says in this order: the study in one sentence, its own account (claim, run time, outputs; the docstring
of its module), and the options in groups.  Paragraphs are filled to the width of the terminal, formulae and
tables stay as they are.
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from typing import Any, NoReturn, TextIO, cast

from studies.instruments.standard_output import tell

WIDEST, NARROWEST = 96, 60
"""Columns of --help: lines longer than 96 are hard to read."""

Options = Callable[[argparse.ArgumentParser], None]


class WrongUse(ValueError):
    """The arguments make no sense; the message is one sentence."""


class Parser(argparse.ArgumentParser):
    """A parser that refuses with `WrongUse` and prints its help where it is told to."""

    output: TextIO | None = None

    def print_help(self, file: Any = None) -> None:
        tell(self.format_help().rstrip(), file or self.output or sys.stdout)

    def error(self, message: str) -> NoReturn:
        raise WrongUse(f"{message} (--help lists the options)")

    def read(self, argv: Sequence[str]) -> argparse.Namespace:
        """The arguments; WrongUse names the nearest option to an unknown one."""
        arguments, rest = self.parse_known_args(argv)
        for word in rest:
            nearest = get_close_matches(word.partition("=")[0], list(self._option_string_actions), n=1)
            if word.startswith("-") and nearest:
                self.error(f"there is no option {word}; did you mean {nearest[0]}?")
            self.error(f"unrecognized argument {word}")
        return arguments


class _Layout(argparse.RawDescriptionHelpFormatter):
    """Help as wide as the terminal, within limits."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=help_width(), max_help_position=30)


def help_width() -> int:
    """Columns that --help fills."""
    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns - 2))


GAP = re.compile(r"(?<=\S) {3,}(?=\S)")
"""Between the columns of a table."""

PROSE = 70
"""Columns from which on lines in a row belong to one paragraph; those of tables and formulae are shorter or
have gaps."""


def filled(account: str, width: int) -> str:
    """The paragraphs of a docstring after the first, filled; formulae and tables as they are if they fit."""
    blocks = []
    for block in textwrap.dedent(account).strip().split("\n\n")[1:]:
        runs = [list(run) for _, run in itertools.groupby(block.split("\n"), key=_indent)]
        blocks.append("\n".join(_filled(run, width) for run in runs))
    return "\n\n".join(blocks)


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip())]


def _filled(lines: list[str], width: int) -> str:
    """Lines of one indent: as one paragraph if they are prose, else one by one."""
    indent = _indent(lines[0])
    if all(len(line) >= PROSE for line in lines[:-1]) and not any(GAP.search(line) for line in lines):
        words = " ".join(line.strip() for line in lines)
        return textwrap.fill(words, width, initial_indent=indent, subsequent_indent=indent)
    return "\n".join(_hanging(line, width) for line in lines)


def _hanging(line: str, width: int) -> str:
    """A line of a table or formula; what does not fit goes below the last column."""
    if len(line) <= width:
        return line
    gaps = [gap.end() for gap in GAP.finditer(line) if gap.end() <= width - 24]
    return textwrap.fill(line, width, subsequent_indent=" " * (max(gaps, default=len(_indent(line)) + 4)))


def positive(text: str) -> int:
    """A whole number of at least 1."""
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number of at least 1, not {text!r}")
    return number


def above(low: float, words: str) -> Callable[[str], float]:
    """The type of an option whose value is a finite number above `low`, `words` in a sentence."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and value > low):
            raise argparse.ArgumentTypeError(f"must be {words}, not {text!r}")
        return value

    return read


def finite(text: str) -> float:
    """A finite number."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"must be a finite number, not {text!r}")
    return number


def parser_of(command: str, description: str, account: str, options: Options | None) -> Parser:
    """The parser of a study.

    Parameters
    ----------
    command : what is typed to run it.
    description : one sentence.
    account : docstring of its module.
    options : adds the study's own options.
    """
    parser = Parser(
        prog=command,
        usage=f"{command} [options]",
        description="\n\n".join(
            part for part in (textwrap.fill(description, help_width()), filled(account, help_width())) if part
        ),
        formatter_class=_Layout,
        allow_abbrev=False,
        add_help=False,
    )
    if options is not None:
        own = parser.add_argument_group("options of this study")
        options(_Grouped(parser, own))
    scene = parser.add_argument_group("the scene")
    scene.add_argument("--scene", default="letter", metavar="FILE.toml",
                       help="a file, or the name of one in studies/scenes (default: letter)")
    scene.add_argument("--set", action="append", default=[], metavar="section.key=value", dest="overrides",
                       help="change one key of the scene; may be repeated")
    scene.add_argument("--dump-scene", action="store_true",
                       help="print every key with unit, default and provenance, and stop")
    running = parser.add_argument_group("how it runs")
    running.add_argument("-h", "--help", action="help", help="this text, and stop")
    running.add_argument("--quick", action="store_true", help="a small form of the study, for a first look")
    running.add_argument("--workers", type=positive, default=os.cpu_count() or 1, metavar="N",
                         help="threads or processes (default: one for each core)")
    running.add_argument("--executor", default="", metavar="URL",
                         help="where a sweep runs: threads, processes or dask://host:port")
    output = parser.add_argument_group("where the results go")
    output.add_argument("--out", default="results", metavar="DIR",
                        help="folder in which the study makes its own (default: results)")
    output.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    return parser


PLAIN: dict[Any, Callable[[str], Any]] = {float: finite, int: positive}
"""How an option of a plain type is read: no study has a use for nan, or for a count below 1."""


class _Grouped(argparse.ArgumentParser):
    """What a study sees as the parser: its options land in their own group, plain numbers are checked."""

    def __init__(self, parser: Parser, group: Any) -> None:
        self._group = group
        self.add_mutually_exclusive_group = group.add_mutually_exclusive_group  # type: ignore[method-assign]
        self.set_defaults = parser.set_defaults  # type: ignore[method-assign]
        self.add_argument_group = parser.add_argument_group  # type: ignore[method-assign]

    def add_argument(self, *names: Any, **given: Any) -> argparse.Action:
        """Add an option of the study."""
        if given.get("type") in PLAIN:
            given["type"] = PLAIN[given["type"]]
        return cast("argparse.Action", self._group.add_argument(*names, **given))
