"""Checks of parameters, and the sentences that refuse a wrong one.

A wrong parameter is refused where it is given, in one sentence with its name, value, unit and what is valid:

    InvalidType     a TypeError: a text, a truth value, a complex number, an array for a number
    InvalidValue    a ValueError: a value out of range, not finite, or of the wrong shape

Both are a `Refusal`. Any other ValueError or TypeError is a fault of the program. A valid parameter that can
hardly be meant, such as one wrong by a factor of 1000, brings a warning `SuspiciousValue` that says why.
"""

import math
import re
import sys
import warnings
from collections.abc import Iterable
from numbers import Real
from operator import ge, gt, le, lt
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .record import record as record  # the decorator of most classes that have parameters

LONGEST_SHOWN = 60
"""Largest number of characters of a value that a sentence quotes."""

Array = NDArray[np.float64]
Class = TypeVar("Class", bound=type)


class Refusal(Exception):
    """Wrong use: the class of both `InvalidValue` and `InvalidType`.

    The message is one sentence that says what is valid. Its parts, the arguments of the constructor, are
    joined to one line. The first part is the wrong argument, perhaps described ("frequency of the drive").
    Words follow, and further arguments and words in turn. A sentence in one part blames no argument.

    Attributes
    ----------
    args : tuple of str
        The parts of the sentence.
    field : str
        Name of the wrong argument, such as "frequency"; "" if the refusal blames none.
    """

    def __str__(self) -> str:
        return " ".join(" ".join(self.args).split())

    @property
    def field(self) -> str:
        """Name of the wrong argument, such as "frequency"; "" if the refusal blames none."""
        return re.split(r"[^\w.]", self.args[0])[0] if len(self.args) > 1 else ""


class InvalidValue(Refusal, ValueError):
    """A value out of range, not finite, of the wrong shape, or in contradiction to another argument.

    It is a ValueError; `Refusal` describes its parts.
    """


class InvalidType(Refusal, TypeError):
    """An argument of the wrong kind.

    It is a TypeError; `Refusal` describes its parts.
    """


class SuspiciousValue(UserWarning):
    """A warning of a parameter that is valid but can hardly be meant; the message says why."""


_said: set[str] = set()


def suspect(sentence: str) -> None:
    """Warn of a suspicious value, at the line outside `beam` and `contact` that gave it.

    Parameters
    ----------
    sentence : str
        Names field, value and unit, and says why. Sentences that differ in their numbers only are of one
        kind, and a process gives each kind once. All are given if the user's filter of warnings is "always",
        "all" or "error".

    Warns
    -----
    SuspiciousValue
        Unless a sentence of this kind was given before.
    """
    filters = (f for f in warnings.filters if issubclass(SuspiciousValue, f[2]))
    action = next((f[0] for f in filters if f[1] is None or f[1].match(sentence)), "default")
    if action in ("default", "module", "once"):
        kind = re.sub(r"\d[\d.]*(e[-+]\d+)?", "", sentence)
        if kind in _said:
            return
        _said.add(kind)
    level, frame = 2, sys._getframe(1)
    while frame.f_back and str(frame.f_globals.get("__name__")).partition(".")[0] in ("beam", "contact"):
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, SuspiciousValue, stacklevel=level)


def shown(value: object) -> str:
    """Return the value for a sentence: one line of at most `LONGEST_SHOWN` characters, texts in quotes."""
    return brief(value if isinstance(value, Real) else repr(value))


def brief(value: object) -> str:
    """Return the value for a sentence like `shown`, but texts without quotes."""
    try:
        line = " ".join("".join(c if c.isprintable() else " " for c in str(value)).split())
    except ValueError:  # an integer with more digits than the interpreter is willing to print
        return "a very large number"
    return line if len(line) <= LONGEST_SHOWN else line[: LONGEST_SHOWN - 3] + "..."


def require(condition: bool, *parts: str) -> None:
    """Raise InvalidValue with these parts (see `Refusal`) unless the condition holds."""
    if not condition:
        raise InvalidValue(*parts)


def is_number(value: object) -> bool:
    """Return whether the value is a finite real number; a text, a truth value or a list is none."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the range of floats
        return False


def require_within(
    name: str,
    value: object,
    unit: str,
    *,
    low: float | None = None,
    high: float | None = None,
    above: float | None = None,
    below: float | None = None,
) -> float:
    """Return the value as a float, or refuse it unless low <= value <= high and above < value < below."""
    ends = (low, "{} or more", ge), (above, "above {}", gt), (high, "at most {}", le), (below, "below {}", lt)
    limits = [(bound, words, holds) for bound, words, holds in ends if bound is not None]
    valid = " and ".join(words.format(f"{bound:g}" if bound else "zero") for bound, words, _ in limits)
    if low is not None and high is not None:
        valid = f"between {low:g} and {high:g}"
    elif len(limits) < 2:
        valid = f"finite and {valid}" if limits else "finite"
    given: float = require_kind(name, value, Real, f"a number in {unit}, {valid}")
    if not (is_number(given) and all(holds(float(given), bound) for bound, _, holds in limits)):
        raise InvalidValue(name, f"is {shown(value)} {unit}; it must be {valid}")
    return float(given)


def require_whole(
    name: str, value: object, unit: str, *, low: int = 1, high: int | None = None, why: str = ""
) -> int:
    """Return the value as an int, if whole and from `low` to `high`; `why` ends the sentence otherwise."""
    least = {0: "zero or more", 1: "one or more"}.get(low, f"{low} or more")
    valid = f"a whole number, {least}" if high is None else f"a whole number between {low} and {high}"
    given: float = require_kind(name, value, Real, f"{valid}{why}")
    if not (is_number(given) and given % 1 == 0 and low <= given <= (math.inf if high is None else high)):
        raise InvalidValue(name, f"is {shown(value)} {unit}; it must be {valid}{why}")
    return int(float(given))


def final(kind: Class) -> Class:
    """Make the class refuse subclasses: compiled code takes its numbers and would ignore their methods."""

    def refuse(cls: type) -> None:
        why = "compiled code reads the numbers of that class and would ignore new methods"
        raise InvalidType(f"{cls.__name__} is a subclass of {kind.__name__}; there must be none, as {why}")

    kind.__init_subclass__ = classmethod(refuse)  # type: ignore[assignment]
    return kind


def require_kind(name: str, value: Any, kind: type | tuple[type, ...], words: str) -> Any:
    """Return the value if it is of this kind (no class, and True is no number), or else raise InvalidType."""
    if not isinstance(value, kind) or isinstance(value, type) or (kind is Real and isinstance(value, bool)):
        raise InvalidType(name, f"is {shown(value)}; it must be {words}")
    return value


def require_each(name: str, values: Any, kind: type | tuple[type, ...], words: str) -> tuple[Any, ...]:
    """Return the values as a tuple, or raise InvalidType unless each is of this kind."""
    require_kind(name, values, Iterable, words)
    return tuple(require_kind(name, value, kind, words) for value in values)


def require_array(
    name: str,
    values: object,
    unit: str,
    *,
    dimensions: int | None = None,
    shape: tuple[int, ...] | None = None,
    words: str = "an array of numbers",
) -> Array:
    """Return a read-only float copy, or refuse the values unless finite, of these dimensions or shape."""
    try:
        given = np.asarray(values)
    except (TypeError, ValueError):
        given = np.asarray(None)
    if given.dtype.kind not in "iuf":
        raise InvalidType(name, f"is {shown(values)}; it must be {words} in {unit}")
    array = np.array(given, dtype=np.float64)
    if (dimensions is not None and array.ndim != dimensions) or (shape is not None and array.shape != shape):
        wanted = f" of shape {shape}" if shape is not None else ""
        raise InvalidValue(name, f"has shape {array.shape}; it must be {words} in {unit}{wanted}")
    if not np.all(np.isfinite(array)):
        found = f"is {shown(values)}" if shape is not None else f"holds {array[~np.isfinite(array)].flat[0]}"
        raise InvalidValue(name, f"{found} {unit}; it must be {words}, every entry finite")
    array.setflags(write=False)
    return array
