"""Numbers as a person writes them: few digits, a minus sign, a power of ten, a unit with a prefix."""

from __future__ import annotations

import math
import re

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def written(value: float, digits: int = 4) -> str:
    """A number for a person, on a page or in a figure: 0.0119, −6.27 × 10⁻⁴; whole ones in all digits."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else "∞" if value > 0.0 else "−∞"
    if value == 0.0 or (float(value).is_integer() and abs(value) < 1e6):
        return minus(f"{value + 0.0:.0f}")
    size = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if -4 < size < 5:
        plain = f"{value:.{max(digits - 1 - size, 0)}f}"
        return minus(plain.rstrip("0").rstrip(".") if "." in plain else plain)
    mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
    return f"{minus(mantissa.rstrip('0').rstrip('.'))} × 10{str(int(power)).translate(SUPERSCRIPTS)}"


def prefixed(size: float, unit: str) -> tuple[float, str]:
    """Scale and unit that a person would choose for a number of this size."""
    powers = (9, 6, 3, 0) if unit[0] in "NP" else (0, -3, -6) if unit in ("s", "m", "kg") else (0,)
    power = next((power for power in powers if size >= 10.0**power), powers[-1] if size else 0)
    found = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "\u00b5"}[power] + unit
    return 10.0**power, {"mkg": "g", "\u00b5kg": "mg"}.get(found, found)


def in_unit(value: float, unit: str, digits: int = 4) -> str:
    """A number with its unit, as a person writes them: 0.02 mm."""
    scale, words = prefixed(abs(value), unit)
    return f"{written(value / scale, digits)} {words}"


def minus(text: str) -> str:
    """The text of a number with a minus sign in place of a hyphen."""
    return text.replace("-", "−")


NAMES = re.compile(r"\bp\d+|Eqs?\. \(\d\)|Figs?\. \d|[Mm]odes? \d+|\[\d+\]")
"""Words with digits that are no numbers."""


def numbers_in(sentence: str) -> list[str]:
    """The numbers of a sentence; p10, Eq. (1), Fig. 2, mode 1 and note [11] are names."""
    return re.findall(r"\d[\d.,]*(?:e[-+]?\d+| × 10)?", NAMES.sub("", sentence))
