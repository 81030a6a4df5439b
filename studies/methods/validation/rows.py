"""What a published source says and what this package finds: rows, and panels of a figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from numpy.typing import ArrayLike


@dataclass(frozen=True, kw_only=True)
class Row:
    """One number of a source; without a published one, or without an error of it, nothing is judged."""

    source: str
    quantity: str
    published: float | None
    ours: float | None
    difference: float | None
    source_error: float | None
    verdict: str
    note: str = ""


def compared(
    source: str,
    quantity: str,
    published: float | None,
    ours: float | None,
    source_error: float | None = None,
    note: str = "",
    holds: bool | None = None,
) -> Row:
    """A row: "agrees" within the source's error, "differs" beyond it, "open" where nothing is published,
    "not found" where we have none.

    `holds` says whether what the source tells in words, or a second route of ours, bears the number out:
    "holds" or "fails".
    """
    difference = None if published is None or ours is None else ours - published
    verdict = "open" if ours is not None else "not found"
    if difference is not None and source_error is not None:
        verdict = "agrees" if abs(difference) <= source_error else "differs"
    elif holds is not None:
        verdict = "holds" if holds else "fails"
    return Row(
        source=source,
        quantity=quantity,
        published=published,
        ours=ours,
        difference=difference,
        source_error=source_error,
        verdict=verdict,
        note=note,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """Points (x, y) of one kind; `look` is a number of the house's series, `line` False for markers only,
    `faint` for what is not stable."""

    x: ArrayLike
    y: ArrayLike
    name: str = ""
    look: int = 0
    line: bool = True
    faint: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """A panel of a source's figure; `x` and `y` are quantity and unit of the axes."""

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    curves: Sequence[Curve]


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """What a source comes to: its rows, and the panels of its figure with their caption."""

    rows: Sequence[Row]
    panels: Sequence[Panel] = field(default=())
    caption: str = ""
