"""What a parameter must be, and what is said when it is not.

A parameter that makes no sense is refused where it is given, in one sentence with its name, its value, its
unit and what would be valid:

    InvalidType     a TypeError: a text, a truth value, a complex number, an array for a number
    InvalidValue    a ValueError: a value out of range, not finite, or of the wrong shape

Both are a `Refusal`. Any other ValueError or TypeError is a fault of the program.

One that makes sense but can hardly be meant, such as a gap longer than the spring or a slip of a factor of
1000 in a unit, is taken as it stands, with a warning of the category `SuspiciousValue` that says why.
"""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Iterable
from numbers import Real
from operator import ge, gt, le, lt
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

LONGEST_SHOWN = 60
"""Characters of a value that a sentence quotes."""


Class = TypeVar("Class", bound=type)


class Refusal(Exception):
    """Wrong use; the message is one sentence that says what would be valid."""


class InvalidValue(Refusal, ValueError):
    """A value out of range, not finite, of the wrong shape, or one that does not fit the others."""


class InvalidType(Refusal, TypeError):
    """An argument of the wrong kind."""


class SuspiciousValue(UserWarning):
    """A parameter that is valid and can hardly be meant; the message says why."""


def suspect(sentence: str) -> None:
    """Warn of a suspicious value, at the line outside of `beam` and `contact` that gave it."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and _package(frame.f_globals) in ("beam", "contact"):
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, SuspiciousValue, stacklevel=level)


def _package(names: dict[str, Any]) -> str:
    return str(names.get("__name__", "")).partition(".")[0]


def shown(value: object) -> str:
    """The value as part of a sentence: one line, of at most `LONGEST_SHOWN` characters, texts in quotes."""
    return brief(value) if isinstance(value, Real) else _cut(repr(value))


def brief(value: object) -> str:
    """The same without quotes."""
    try:
        return _cut(str(value))
    except ValueError:  # an integer with more digits than the interpreter is willing to print
        return "a very large number"


def _cut(text: str) -> str:
    line = "".join(c if c.isprintable() else " " for c in text)
    return line if len(line) <= LONGEST_SHOWN else line[: LONGEST_SHOWN - 3] + "..."


def require(condition: bool, sentence: str) -> None:
    """InvalidValue with this sentence, put on one line, unless the condition holds."""
    if not condition:
        raise InvalidValue(" ".join(sentence.split()))


def is_number(value: object) -> bool:
    """Whether the value is a finite real number; a text, a truth value or a list is none."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond the range of floats
        return False


def is_whole(value: object, low: int) -> bool:
    """Whether the value is a whole number, `low` or more; 2.0 is one, True is not."""
    return is_number(value) and value % 1 == 0 and value >= low  # type: ignore[operator]


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
    """The value as a float, if it is a finite number with low <= value <= high, above < value < below."""
    lower = (low, "{} or more", ge), (above, "above {}", gt)
    upper = (high, "at most {}", le), (below, "below {}", lt)
    limits = [(bound, words, holds) for bound, words, holds in lower + upper if bound is not None]
    valid = " and ".join(words.format(f"{bound:g}" if bound else "zero") for bound, words, _ in limits)
    if low is not None and high is not None:
        valid = f"between {low:g} and {high:g}"
    elif len(limits) < 2:
        valid = f"finite and {valid}" if limits else "finite"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidType(f"{name} is {shown(value)}; it must be a number in {unit}, {valid}")
    if not (is_number(value) and all(holds(float(value), bound) for bound, _, holds in limits)):
        raise InvalidValue(f"{name} is {shown(value)} {unit}; it must be {valid}")
    return float(value)


def require_whole(
    name: str, value: object, unit: str, *, low: int = 1, high: int | None = None, why: str = ""
) -> int:
    """The value as an int, if it is a whole number from `low` to `high`; `why` ends the sentence."""
    least = {0: "zero or more", 1: "one or more"}.get(low, f"{low} or more")
    valid = f"a whole number, {least}" if high is None else f"a whole number between {low} and {high}"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidType(f"{name} is {shown(value)}; it must be {valid}{why}")
    if not is_whole(value, low) or (high is not None and float(value) > high):
        raise InvalidValue(f"{name} is {shown(value)} {unit}; it must be {valid}{why}")
    return int(float(value))


def final(kind: Class) -> Class:
    """The class, which from now on refuses subclasses: a motion takes its numbers and calls no method."""

    def refuse(cls: type) -> None:
        why = "a motion takes the numbers of one and would ignore the methods of a subclass"
        raise InvalidType(
            f"{cls.__name__} is a subclass of {kind.__name__}; it must be an instance, as {why}"
        )

    kind.__init_subclass__ = classmethod(refuse)  # type: ignore[assignment]
    return kind


def require_kind(name: str, value: Any, kind: type | tuple[type, ...], words: str) -> Any:
    """The value, or TypeError unless it is of this kind, `words` in a sentence."""
    if not isinstance(value, kind):
        raise InvalidType(f"{name} is {shown(value)}; it must be {words}")
    return value


def require_each(name: str, values: Any, kind: type | tuple[type, ...], words: str) -> tuple[Any, ...]:
    """The values as a tuple, or TypeError unless they are a sequence of this kind."""
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
) -> NDArray[np.float64]:
    """The values as a read-only float copy, if they are finite numbers of these dimensions or this shape."""
    try:
        given = np.asarray(values)
    except (TypeError, ValueError):
        given = np.asarray(None)
    if given.dtype.kind not in "iuf":
        raise InvalidType(f"{name} is {shown(values)}; it must be {words} in {unit}")
    array = np.array(given, dtype=np.float64)
    if (dimensions is not None and array.ndim != dimensions) or (shape is not None and array.shape != shape):
        wanted = f" of shape {shape}" if shape is not None else ""
        raise InvalidValue(f"{name} has shape {array.shape}; it must be {words} in {unit}{wanted}")
    if not np.all(np.isfinite(array)):
        found = f"is {shown(values)}" if shape is not None else f"holds {array[~np.isfinite(array)].flat[0]}"
        raise InvalidValue(f"{name} {found} {unit}; it must be {words}, every entry finite")
    array.setflags(write=False)
    return array
