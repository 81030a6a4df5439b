"""Instruments whose text files say more than a heading: by what they are recognised, and where it stands.

`step`, `start` and `units` are labels: the value stands in the cells beside one, or below it in the heading.
"""

import re
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Format:
    """One format; `beside` if words stand beside the first numbers, whose columns then have these `names`."""

    name: str
    signature: str
    step: str = "Sample Interval"
    start: str = "X0"
    units: str = "Vertical Units"
    names: tuple[str, ...] = ()
    beside: bool = False


FORMATS = (
    Format(
        name="LabVIEW measurement file", signature="LabVIEW Measurement", step="Delta_X", units="Y_Unit_Label"
    ),
    Format(
        name="Tektronix TDS", signature='"?Record Length"?[,;]', names=("Time (s)", "channel"), beside=True
    ),
    Format(name="Tektronix", signature="Model[,;]|.*Firmware Version"),
    Format(name="Rigol", signature=r"X[,;]CH\d.*Start[,;]Increment", step="Increment", start="Start"),
    Format(name="Keysight", signature="x-axis[,;]"),
    Format(name="Polytec", signature="Source File Name:"),
    Format(name="catman", signature=".*catman"),
    Format(name="phyphox", signature='"Time \\(s\\)"[,;]"'),
)
TABLE = Format(name="a table", signature="")


def format_of(text: str) -> Format:
    """The format with whose signature a text begins, or `TABLE`."""
    return next((one for one in FORMATS if re.match(one.signature, text[:2000].lstrip(), re.I)), TABLE)
