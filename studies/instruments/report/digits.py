"""Numbers as a reader wants them: few digits, a true minus sign, powers of ten written out.

    significant(3)(-0.00062813)   -6.28 x 10^-4
    fixed(2)(22.6)                22.60
    scaled(1e4, 2)(-0.00062813)   -6.28, for a column whose heading carries the 10^-4

Each returns markup. What is absent (None, NaN) is an en dash.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from studies.instruments.report.markup import MINUS, TIMES, prose

ABSENT = "\N{EN DASH}"
LARGEST_PLAIN, SMALLEST_PLAIN = 1e5, 1e-3
"""Between these a number is written without a power of ten."""

Writer = Callable[[Any], str]


def absent(value: Any) -> bool:
    return value is None or (isinstance(value, float) and not math.isfinite(value))


def _signed(text: str) -> str:
    return text.replace("-", MINUS)


def fixed(places: int, *, sign: bool = False) -> Writer:
    """A number with that many decimal places."""
    return lambda x: ABSENT if absent(x) else _signed(f"{x:{'+' if sign else ''}.{places}f}")


def scaled(factor: float, places: int) -> Writer:
    """`factor` times the number; the heading of the column names the factor."""
    return lambda x: ABSENT if absent(x) else fixed(places)(factor * x)


def significant(digits: int) -> Writer:
    """A number to that many significant digits, with a power of ten where it is very large or small."""

    def write(value: Any) -> str:
        if absent(value):
            return ABSENT
        if value == 0:
            return "0"
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        power = int(exponent)
        if SMALLEST_PLAIN <= abs(float(f"{value:.{digits - 1}e}")) < LARGEST_PLAIN:
            return _signed(f"{value:.{max(digits - 1 - power, 0)}f}")
        times = "" if mantissa in ("1", "-1") else f"{_signed(mantissa)}{TIMES}"
        lead = MINUS if mantissa == "-1" else ""
        return f"{times}{lead}10<sup>{_signed(str(power))}</sup>"

    return write


def trimmed(digits: int) -> Writer:
    """Like `significant`, without the zeros that a round number ends with."""

    def write(value: Any) -> str:
        if absent(value) or value == 0:
            return significant(digits)(value)
        fewest = next(
            n
            for n in range(1, digits + 1)
            if n == digits or float(f"{value:.{n - 1}e}") == float(f"{value:.{digits - 1}e}")
        )
        text = significant(fewest)(value)
        return text if "sup" in text or abs(value) < 1e3 else _signed(f"{value:.{digits}g}")

    return write


def span(low: float, high: float, write: Writer) -> str:
    """Two numbers as a range, one if they read the same."""
    first, last = write(low), write(high)
    return first if first == last else f"{first} to {last}"


def percent(digits: int) -> Writer:
    """A part as a percentage."""
    return lambda x: ABSENT if absent(x) else f"{significant(digits)(100.0 * x)} %"


def period(value: Any) -> str:
    """The period of an orbit: p with its number, "none" where none was found."""
    if value is None:
        return ABSENT
    return f"<i>p</i><sub>{int(value)}</sub>" if value else "none"


def words(value: Any) -> str:
    """Text as prose; "yes" and "no" for truth values."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return ABSENT if absent(value) or value == "" else prose(str(value))
