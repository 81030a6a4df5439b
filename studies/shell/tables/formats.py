"""Instruments whose text files say more than a heading: by what they are recognised, and where it is.

`step`, `start` and `units` are labels: the value is in the cells beside one, or below it in the heading.
"""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Format:
    """One format, recognised if a text begins with its `signature`, a regular expression."""

    name: str
    signature: str
    step: str = "Sample Interval"
    start: str = "X0"
    units: str = "Vertical Units"


FORMATS = (
    Format("LabVIEW measurement file", "LabVIEW Measurement", step="Delta_X", units="Y_Unit_Label"),
    Format("Tektronix TDS", '"?Record Length"?[,;]'),  # words beside the first numbers
    Format("Tektronix", "Model[,;]|.*Firmware Version"),
    Format("Rigol", r"X[,;]CH\d.*Start[,;]Increment", step="Increment", start="Start"),
    Format("Keysight", "x-axis[,;]"),
    Format("Polytec", "Source File Name:"),
    Format("catman", ".*catman"),
    Format("phyphox", r'"Time \(s\)"[,;]"'),
    Format("a table", ""),
)


def format_of(text: str) -> Format:
    """The first format that fits a text; the last one fits all."""
    return next(one for one in FORMATS if re.match(one.signature, text[:2000].lstrip(), re.I))
