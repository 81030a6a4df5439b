"""A number that a source prints, beside ours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True)
class Printed:
    """One number of a source, and what is found here."""

    source: Annotated[str, "source"]
    quantity: Annotated[str, "quantity"]
    unit: Annotated[str, "unit; none for a pure number, and in the source's own units"]
    published: Annotated[float, "published"]
    ours: Annotated[float, "found here"]
    difference: Annotated[float, "found here less published"]
    source_error: Annotated[float, "error of the source"]
    verdict: Annotated[str, "verdict; agrees within the error of the source, differs beyond it"]
    note: Annotated[str, "note"] = ""


def compared(
    source: str, quantity: str, published: float, ours: float, error: float, note: str = "", unit: str = ""
) -> Printed:
    """A number in its `unit`, and whether it agrees within the source's error."""
    difference = ours - published
    verdict = "agrees" if abs(difference) <= error else "differs"
    return Printed(source, quantity, unit, published, ours, difference, error, verdict, note)
