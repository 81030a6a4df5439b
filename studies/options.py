"""The options of a study: those that all share, and its own, made of the keyword-only arguments of its
function."""

from __future__ import annotations

import argparse
import contextlib
import inspect
import math
import os
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Literal, NoReturn, Union, get_args, get_origin

__all__ = ["Parser", "WrongUse", "add_options", "parser_of"]


class WrongUse(ValueError):
    """The arguments make no sense; the message is one sentence."""


class Parser(argparse.ArgumentParser):
    """A parser that refuses with `WrongUse` and names the nearest option to an unknown one."""

    def error(self, message: str) -> NoReturn:
        """Refuse."""
        raise WrongUse(f"{message} (--help lists the options)")

    def read(self, argv: Sequence[str]) -> argparse.Namespace:
        """The arguments."""
        arguments, rest = self.parse_known_args(argv)
        for word in rest:
            nearest = get_close_matches(word.partition("=")[0], self._option_string_actions, n=1)
            self.error(f"there is no option {word}" + (f"; did you mean {nearest[0]}?" if nearest else ""))
        return arguments


def parser_of(command: str, account: str) -> Parser:
    """The options that all studies share."""
    parser = Parser(
        prog=command, description=account, usage=f"{command} [options]", allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    scene = parser.add_argument_group("the scene")
    scene.add_argument(
        "--scene",
        default="letter",
        metavar="FILE.toml",
        help="a file, or the name of one in studies/scenes (default: letter)",
    )
    scene.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="section.key=value",
        dest="overrides",
        help="change one key of the scene; may be repeated",
    )
    scene.add_argument(
        "--dump-scene",
        action="store_true",
        help="print every key with unit, default and provenance, and stop",
    )
    running = parser.add_argument_group("how it runs, and where the results go")
    running.add_argument("--quick", action="store_true", help="a small form of the study, for a first look")
    running.add_argument(
        "--workers",
        type=_count,
        default=os.cpu_count() or 1,
        metavar="N",
        help="threads or processes (default: one for each core)",
    )
    running.add_argument(
        "--executor",
        default="",
        metavar="URL",
        help="where cells are computed: threads (default), processes or dask://host:port",
    )
    running.add_argument(
        "--out",
        default="results",
        metavar="DIR",
        help="folder in which the study makes its own (default: results)",
    )
    running.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    return parser


def add_options(parser: Parser, function: Callable[..., object]) -> dict[str, object]:
    """Make options of the keyword-only arguments of a study; returns their defaults."""
    group = parser.add_argument_group("options of this study")
    hints = typing.get_type_hints(function, include_extras=True)
    defaults: dict[str, object] = {}
    for name, entry in inspect.signature(function).parameters.items():
        if entry.kind is not inspect.Parameter.KEYWORD_ONLY:
            continue
        kind, words = hints[name], ""
        if get_origin(kind) is Annotated:
            kind, words = get_args(kind)[:2]
        if get_origin(kind) in (Union, types.UnionType):  # T | None
            kind = next(part for part in get_args(kind) if part is not types.NoneType)
        default = defaults[name] = entry.default
        flag, told = (
            f"--{name.replace('_', '-')}",
            f"{words} (default: {default})" if default is not None else words,
        )
        if kind is bool:
            group.add_argument(flag, action="store_true", default=argparse.SUPPRESS, help=words)
        elif get_origin(kind) is Literal:
            group.add_argument(flag, choices=get_args(kind), default=argparse.SUPPRESS, help=told)
        elif get_origin(kind) is tuple:
            first = get_args(kind)[0]
            group.add_argument(
                flag,
                nargs=len(get_args(kind)),
                type=READERS[first],
                default=argparse.SUPPRESS,
                metavar=first.__name__.upper(),
                help=told,
            )
        else:
            group.add_argument(
                flag, type=READERS[kind], default=argparse.SUPPRESS, metavar=kind.__name__.upper(), help=told
            )
    return defaults


def _count(text: str) -> int:
    """A whole number of at least 1."""
    if not (text.isascii() and text.isdigit() and int(text) >= 1):
        raise argparse.ArgumentTypeError(f"must be a whole number of at least 1, not {text!r}")
    return int(text)


def _finite(text: str) -> float:
    """A finite number."""
    with contextlib.suppress(ValueError):
        if math.isfinite(float(text)):
            return float(text)
    raise argparse.ArgumentTypeError(f"must be a finite number, not {text!r}")


READERS: Mapping[type, Callable[[str], object]] = {int: _count, float: _finite, str: str, Path: Path}
