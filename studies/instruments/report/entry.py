"""What the report says about a study: title, claim, captions, tables, points of the letter.

A declaration (``report.declared``) is an `Entry`. Its functions take what was stored and return tables,
sentences and findings; a summary that lacks what they ask for (another version of the study, a small form, a
failed run) makes one sentence, not an error: `asked` turns it into None.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from studies.instruments.report.markup import Table
from studies.instruments.report.stored import Stored

AGREES, IN_PART, DIFFERS = "agrees", "in part", "differs"
FITTED, NOT_PRINTED, NOT_RUN, UNREADABLE = "fitted", "not printed", "not run", "not stored"
"""Fitted: the scene was calibrated to that number. Not printed: the letter gives none to compare."""

VERDICTS = (AGREES, IN_PART, DIFFERS, FITTED, NOT_PRINTED, NOT_RUN, UNREADABLE)

Result = TypeVar("Result")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What was found on one point; map, Eq. (1) and beam are markup, `why` is prose."""

    verdict: str
    map: str = ""
    single_mode: str = ""
    beam: str = ""
    why: str = ""


@dataclass(frozen=True, kw_only=True)
class Point:
    """One thing that the letter says: where, in its words or close to them, and its number (markup)."""

    order: float
    where: str
    says: str
    letter: str
    find: Callable[[Stored], Finding]


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A study in the report; captions by the stem of the figure's file, in the order of display.

    A film goes by its full name; a pattern (mode_*.gif) makes a gallery under one caption.
    """

    study: str
    title: str
    claim: str
    captions: Mapping[str, str] = field(default_factory=dict)
    tables: Callable[[Mapping[str, Any]], Sequence[Table]] = lambda summary: ()
    findings: Callable[[Mapping[str, Any]], Sequence[str]] = lambda summary: ()
    points: Sequence[Point] = ()


def asked(question: Callable[[], Result]) -> Result | None:
    """The answer, or None where the stored summary has not the shape that the question expects."""
    try:
        return question()
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError):
        return None


def found_on(point: Point, stored: Stored | None, study: str) -> Finding:
    """The finding on a point of the letter, whatever there is to find it in."""
    if stored is None:
        return Finding(verdict=NOT_RUN, why=f"python -m studies.{study}")
    return asked(lambda: point.find(stored)) or Finding(
        verdict=UNREADABLE, why=f"the stored summary of {study} does not hold it"
    )
