"""A number that a source prints, beside ours."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Printed:
    """One number of a source, what is found here, and whether they agree within the source's error."""

    source: str
    quantity: str
    published: float
    ours: float
    difference: float
    source_error: float
    verdict: str
    note: str = ""


def compared(
    source: str, quantity: str, published: float, ours: float, source_error: float, note: str = ""
) -> Printed:
    """A row: "agrees" within the source's error, "differs" beyond it."""
    difference = ours - published
    verdict = "agrees" if abs(difference) <= source_error else "differs"
    return Printed(source, quantity, published, ours, difference, source_error, verdict, note)
