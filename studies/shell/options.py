"""The options of a study: those that all share, and its own, made of the keyword-only arguments of its
function."""

from __future__ import annotations

import argparse
import contextlib
import inspect
import os
import re
import sys
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from difflib import get_close_matches
from functools import partial
from typing import Annotated, Literal, NoReturn, TextIO, Union, get_args, get_origin

from beam import InvalidValue
from studies.shell.executors import require_place
from studies.shell.files import SCHEMA
from studies.shell.programs import DONE, by_own_name, perform, print_answer

Answer = Mapping[str, object]

POSITIONAL = "positional"
"""Beside the words of an argument: it needs no name on the command line."""

STYLES = ("paper", "slide")
style: ContextVar[str] = ContextVar("style", default=STYLES[0])
"""Form of the figures: for a journal, or in 16:9 with larger letters (`studies.shell.plotting`)."""


@contextlib.contextmanager
def style_of(name: str) -> Iterator[None]:
    """Context in which figures are drawn in this form."""
    token = style.set(name)
    try:
        yield
    finally:
        style.reset(token)


MOST_CELLS = 1_000_000
"""Bound on the cells of a study, and on a count on the command line. At 1 ms a cell, a million take a quarter
of an hour, and their numbers fit into memory."""


@dataclass(frozen=True)
class Within:
    """Beside the words of an argument: its numbers are `low` or more, or above it if `open`, to `high`."""

    low: float = -sys.float_info.max
    high: float = sys.float_info.max
    unit: str = ""
    open: bool = False

    def __str__(self) -> str:
        if self.high == sys.float_info.max:
            return "finite"
        first = f"above {self.low:g} and at most" if self.open else f"from {self.low:g} to"
        return f"{first} {self.high:.7g} {self.unit}".rstrip()

    def read(self, kind: type[int] | type[float], text: str) -> float:
        """The number in a text, of this kind and within these bounds."""
        with contextlib.suppress(ValueError, OverflowError):
            number = kind(text if text.isascii() and "_" not in text else "")
            if self.low < number <= self.high or (number == self.low and not self.open):
                return number
        words = "a whole number" if kind is int else "a number"
        raise argparse.ArgumentTypeError(f"must be {words} {self}, not {text[:40]!r}")


HERTZ = Within(0, 1e7, "Hz", open=True)
BOUNDS = {int: Within(1, MOST_CELLS), float: Within()}
"""Of a drive frequency; of numbers that are not marked."""


class Parser(argparse.ArgumentParser):
    """A parser that refuses in a sentence and names the nearest option to an unknown one."""

    def __init__(self, command: str, account: str) -> None:
        form, usage = argparse.RawDescriptionHelpFormatter, f"{command} [options]"
        super().__init__(command, usage, by_own_name(account), formatter_class=form, allow_abbrev=False)
        self._negative_number_matcher = re.compile(r"-\.?\d")  # -1e-3 is a number, too
        self.add_argument("--json", action="store_true", help="print the summary as one JSON object")

    def error(self, message: str) -> NoReturn:
        """Refuse."""
        raise InvalidValue(f"{message} (--help lists the options)")

    def read(self, argv: Sequence[str], output: TextIO) -> argparse.Namespace:
        """The arguments; help goes to `output`."""
        with contextlib.redirect_stdout(output):
            arguments, rest = self.parse_known_intermixed_args(argv)
        for word in rest:
            nearest = get_close_matches(word.partition("=")[0], self._option_string_actions, n=1)
            self.error(f"there is no option {word}" + (f"; did you mean {nearest[0]}?" if nearest else ""))
        require_place(vars(arguments).get("executor", ""))
        return arguments


def add_scene(parser: Parser) -> Callable[..., object]:
    """Add the options that name and change the scene; returns what adds another one to them."""
    scene = parser.add_argument_group("the scene").add_argument
    words = "a file, or the name of one in studies/scenes"
    scene("--scene", default="letter", metavar="FILE.toml", help=words)
    words = "change one key of the scene; may be repeated"
    scene("--set", action="append", default=[], metavar="section.key=value", dest="overrides", help=words)
    return scene


def parser_of(command: str, account: str) -> Parser:
    """The options that all studies share."""
    parser = Parser(command, account)
    scene = add_scene(parser)
    scene("--dump-scene", action="store_true", help="print every key with unit, default and provenance")
    runs = parser.add_argument_group("how it runs, and where the results go").add_argument
    cores = os.cpu_count() or 1
    runs("--quick", action="store_true", help="a small form of the study, for a first look")
    count = partial(BOUNDS[int].read, int)
    words = "figures for a journal, or with larger letters for a slide of 16:9 (default: paper)"
    runs("--style", choices=STYLES, default="paper", help=words)
    runs("--workers", type=count, default=cores, metavar="N", help="threads or processes (default: cores)")
    runs("--executor", default="", metavar="URL", help="threads (default), processes, dask://HOST")
    runs("--out", type=_folder, default="results", metavar="DIR", help="folder of all results")
    return parser


def tool(parser: Parser, argv: Sequence[str] | None, work: Callable[..., tuple[str, Answer]]) -> int:
    """Run a program that is no study: `work` takes the arguments, returns a sentence and --json's answer."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    name = parser.prog.rpartition(" ")[2]

    def answered(output: TextIO) -> int:
        given = parser.read(arguments, output)
        sentence, done = work(given)
        print(f"{parser.prog}: {sentence}", file=sys.stderr)
        if given.json:
            answer = {"schema": SCHEMA, "study": name, "status": "done", **done, "exit_code": DONE}
            print_answer(answer, output)
        return DONE

    return perform(name, parser.prog, arguments, answered)


def add_options(parser: Parser, function: Callable[..., object]) -> dict[str, object]:
    """Make options of the keyword-only arguments of a study; returns their defaults.

    One annotated with `POSITIONAL` as well is given without a name, and one with `Within` has these bounds;
    `tuple[T, ...]` takes one value or more.
    """
    group = parser.add_argument_group("options of this study")
    hints = typing.get_type_hints(function, include_extras=True)
    defaults: dict[str, object] = {}
    for name, entry in inspect.signature(function).parameters.items():
        if entry.kind is not inspect.Parameter.KEYWORD_ONLY:
            continue
        kind, words, marks = hints[name], "", list[object]()
        if get_origin(kind) is Annotated:
            kind, words, *marks = get_args(kind)
        if get_origin(kind) in (Union, types.UnionType):  # T | None
            kind = next(part for part in get_args(kind) if part is not types.NoneType)
        default = defaults[name] = entry.default
        flag, text = f"--{name.replace('_', '-')}", words.replace("%", "%%")  # argparse formats its help
        if default not in (None, ()) and kind is not bool:
            shown = " ".join(map(str, default)) if isinstance(default, tuple) else default
            text += f" (default: {shown})"
        about: dict[str, object] = {"default": argparse.SUPPRESS, "help": text}
        if kind is bool:
            about["action"] = "store_true"
        elif get_origin(kind) is Literal:
            about["choices"] = get_args(kind)
        else:
            if get_origin(kind) is tuple:
                several = Ellipsis in get_args(kind)
                about["nargs"], kind = "+" if several else len(get_args(kind)), get_args(kind)[0]
                about["action"] = "extend" if several else "store"  # the option may be repeated
            bounds = next((mark for mark in marks if isinstance(mark, Within)), BOUNDS.get(kind))
            reader = partial(bounds.read, kind) if bounds else kind
            about |= {"type": reader, "metavar": kind.__name__.upper()}
            about["help"] = f"{text}; {bounds}" if bounds in marks else text
            if POSITIONAL in marks:
                flag, about = name, {**about, "nargs": "?", "metavar": name.upper(), "default": default}
        group.add_argument(flag, **about)  # type: ignore[arg-type]
    return defaults


def _folder(text: str) -> str:
    """A folder that has a name."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"must be a folder, not {text!r}")
    return text
