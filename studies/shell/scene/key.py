"""One key of a scene: its default, unit, provenance and limits, and the check of a value.

Provenance: `letter` is printed in the letter, `calibrated` was fitted to a number that it prints (thickness
to the free period, loss factor of the tape to the decay rate, ball mass and gap to the impacts and the drive
amplitude), `assumed` is ours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Real
from typing import TypeVar

from beam import InvalidValue

LETTER, CALIBRATED, ASSUMED, GIVEN = "letter", "calibrated", "assumed", "given"

OPEN = -1.0
"""Value of a key that is left open, to be taken from the spring."""


class SceneError(InvalidValue):
    """A scene that cannot be used; the message is one sentence on one line."""


def shown(value: object) -> str:
    """The value as part of a sentence, at most 60 characters."""
    try:
        text = repr(list(value)) if isinstance(value, tuple) else repr(value)
    except ValueError:  # an integer with more digits than the interpreter is willing to print
        text = "a very large number"
    return text if len(text) <= 60 else text[:57] + "..."


Value = float | int | str | tuple[float, ...]
T = TypeVar("T", float, int, bool, str, tuple[float, ...])


@dataclass(frozen=True)
class Key:
    """What is known of a key; `unit` is "" where nothing is measured and "1" for a pure number.

    `printed` is the letter's value where that is not the default.
    """

    default: Value
    unit: str
    provenance: str
    meaning: str
    low: float
    high: float
    choices: tuple[str, ...]
    printed: Value | None

    def valid(self) -> str:
        """What a value must be, as part of a sentence."""
        if self.choices:
            return "one of " + ", ".join(f'"{word}"' for word in self.choices)
        listed = "a list of finite numbers" + (", at least one" if self.default else "")
        kinds = {float: "a finite number", int: "a whole number", bool: "true or false"}
        kinds[str] = "one line of text in quotes"
        words = kinds.get(type(self.default), listed)
        if self.low > -math.inf:
            words += f", at least {self.low:g}"
        if self.high < math.inf:
            words += f" and at most {self.high:g}"
        return words + {"": "", "1": " (dimensionless)"}.get(self.unit, f" (unit {self.unit})")

    def checked(self, name: str, value: object) -> Value:
        """The value as a plain one of the key's type; SceneError with key, value, unit and what is valid."""
        found: Value | None = None
        if isinstance(self.default, bool):
            found = value if isinstance(value, bool) else None
        elif isinstance(self.default, str):
            if isinstance(value, str) and value.isprintable() and value in (self.choices or (value,)):
                found = value
        elif isinstance(self.default, tuple):
            numbers = [self._number(item) for item in value] if isinstance(value, list | tuple) else [None]
            if None not in numbers and (numbers or not self.default):
                found = tuple(number for number in numbers if number is not None)
        else:
            found = self._number(value)
            if isinstance(self.default, int) and found is not None:
                found = int(found) if found % 1 == 0 else None
        if found is None:
            raise SceneError(name, f"must be {self.valid()}, not {shown(value)}")
        return found

    def _number(self, value: object) -> float | None:
        """A finite number within the limits, else None; minus zero becomes zero, so that equal scenes are."""
        if isinstance(value, bool) or not isinstance(value, Real):
            return None
        try:
            number = float(value) + 0.0
        except OverflowError:
            return None
        return number if math.isfinite(number) and self.low <= number <= self.high else None


def key(
    default: T,
    unit: str,
    meaning: str,
    provenance: str = ASSUMED,
    *,
    low: float = -math.inf,
    high: float = math.inf,
    choices: tuple[str, ...] = (),
    printed: T | None = None,
) -> T:
    """The field of a section for one key."""
    high = min(high, HIGHEST.get(unit, math.inf))
    known = Key(default, unit, provenance, meaning, low, high, choices, printed)
    return field(default=default, metadata={"key": known})


HIGHEST = {"m": 1e3, "kg": 1e6, "kg/m^3": 1e6, "kg m^2": 1e6, "Pa": 1e15, "s": 1e6, "Hz": 1e7, "1/s": 1e8}
HIGHEST |= {"N/m": 1e15, "N s/m": 1e12}
"""Unit -> what a key with this unit must not exceed: far beyond any spring, and squares stay finite."""
