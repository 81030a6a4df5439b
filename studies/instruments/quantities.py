"""What a key of a scene is: unit, provenance, meaning, and which values are valid.

A section of a scene is a frozen dataclass whose annotations carry a `Key`:

    width_m: Annotated[float, Key("m", ASSUMED, "width of the strip", POSITIVE)] = 0.012

That line is the only place where the key exists. Reading, checking, `--set`, `--dump-scene` and the list of
provenances in the results all go through `keys_of(section)`. The annotation says the type: `float` (a finite
number), `int` (a whole number), `str` (one line of text) or `tuple[float, ...]` (a list of finite numbers).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from numbers import Integral, Real
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

LETTER = "letter"
CALIBRATED = "calibrated"
ASSUMED = "assumed"
GIVEN = "given"
"""Provenance: printed in the letter; fitted to a number of the letter; chosen by us; set by the user."""


class SceneError(ValueError):
    """A scene that cannot be used; the message is one sentence on one line."""


def shown(value: object) -> str:
    """The value as part of a sentence: one line, not longer than 60 characters."""
    try:
        text = repr(list(value)) if isinstance(value, tuple) else repr(value)
    except ValueError:  # an integer with more digits than the interpreter is willing to print
        text = "a very large number"
    text = "".join(character if character.isprintable() else "?" for character in text)
    return text if len(text) <= 60 else text[:57] + "..."


@dataclass(frozen=True)
class Interval:
    """Numbers between `low` and `high`; an end is included unless it is said to be open."""

    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False

    def __contains__(self, value: Any) -> bool:
        above = value > self.low if self.low_open else value >= self.low
        below = value < self.high if self.high_open else value <= self.high
        return above and below

    def __str__(self) -> str:
        parts = []
        if self.low > -math.inf:
            parts.append(f"{'greater than' if self.low_open else 'at least'} {self.low:g}")
        if self.high < math.inf:
            parts.append(f"{'less than' if self.high_open else 'at most'} {self.high:g}")
        return " and ".join(parts)


@dataclass(frozen=True)
class OneOf:
    """One of a few words."""

    words: tuple[str, ...]

    def __contains__(self, value: Any) -> bool:
        return value in self.words

    def __str__(self) -> str:
        return "one of " + ", ".join(f'"{word}"' for word in self.words)


ANY = Interval()
POSITIVE = Interval(low=0.0, low_open=True)
NOT_NEGATIVE = Interval(low=0.0)
FRACTION = Interval(low=0.0, high=1.0)
POISSON = Interval(low=-1.0, high=0.5, low_open=True, high_open=True)


def whole(low: int, high: int) -> Interval:
    """Whole numbers from `low` to `high`; the upper end keeps a slip from filling the memory."""
    return Interval(low=low, high=high)


def one_of(*words: str) -> OneOf:
    return OneOf(words)


@dataclass(frozen=True)
class Key:
    """Unit ("" where nothing is measured, "1" for a pure number), provenance of the default, meaning."""

    unit: str
    provenance: str
    meaning: str
    valid: Interval | OneOf = ANY
    may_be_empty: bool = False


class _Unfit(Exception):
    """The value is not of the key's type or not valid."""


def _number(value: object, key: Key) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise _Unfit
    try:
        number = float(value) + 0.0  # turns -0.0 into 0.0: equal scenes have to look equal
    except OverflowError:
        raise _Unfit from None
    if not math.isfinite(number) or number not in key.valid:
        raise _Unfit
    return number


def _whole_number(value: object, key: Key) -> int:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise _Unfit
    if not isinstance(value, Integral) and not float(value).is_integer():
        raise _Unfit
    number = int(float(value)) if not isinstance(value, Integral) else int(value)
    if number not in key.valid:
        raise _Unfit
    return number


def _text(value: object, key: Key) -> str:
    if not isinstance(value, str) or not value.isprintable():
        raise _Unfit
    if isinstance(key.valid, OneOf) and value not in key.valid:
        raise _Unfit
    return value


def _numbers(value: object, key: Key) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or (not value and not key.may_be_empty):
        raise _Unfit
    return tuple(_number(item, key) for item in value)


_READERS: Mapping[type, tuple[Callable[[object, Key], Any], str]] = {
    float: (_number, "a finite number"),
    int: (_whole_number, "a whole number"),
    str: (_text, "one line of text in quotes"),
    tuple: (_numbers, "a list of finite numbers"),
}


_TABLES: dict[type, Mapping[str, tuple[type, Key]]] = {}
"""What `keys_of` has already worked out."""


def keys_of(section: type[Section]) -> Mapping[str, tuple[type, Key]]:
    """Name -> (float, int, str or tuple; its `Key`) for the fields of a section, in their order."""
    if section in _TABLES:
        return _TABLES[section]
    hints = get_type_hints(section, include_extras=True)
    found: dict[str, tuple[type, Key]] = {}
    for entry in fields(section):
        hint = hints[entry.name]
        if get_origin(hint) is not Annotated:
            raise TypeError(f"{section.__name__}.{entry.name} carries no Key")
        plain, key = get_args(hint)
        found[entry.name] = (get_origin(plain) or plain, key)
    return _TABLES.setdefault(section, MappingProxyType(found))


def what_is_valid(kind: type, key: Key) -> str:
    """The valid values of a key as part of a sentence, with the unit."""
    if isinstance(key.valid, OneOf):
        return str(key.valid)
    words = _READERS[kind][1]
    if kind is tuple and not key.may_be_empty:
        words = "a list of at least one finite number"
    if str(key.valid):
        words += f", {'each ' if kind is tuple else ''}{key.valid}"
    return words + {"": "", "1": " (dimensionless)"}.get(key.unit, f" (unit {key.unit})")


def checked(name: str, value: object, kind: type, key: Key) -> Any:
    """The value, plain, or a `SceneError` naming key, value, unit and what is valid."""
    try:
        return _READERS[kind][0](value, key)
    except (_Unfit, OverflowError, ValueError):
        raise SceneError(f"{name} must be {what_is_valid(kind, key)}, not {shown(value)}") from None


@dataclass(frozen=True, kw_only=True)
class Section:
    """A table of a scene. Every field is checked, and turned into plain immutable values, on construction."""

    section: ClassVar[str]

    def __post_init__(self) -> None:
        for name, (kind, key) in keys_of(type(self)).items():
            value = checked(f"{self.section}.{name}", getattr(self, name), kind, key)
            object.__setattr__(self, name, value)
