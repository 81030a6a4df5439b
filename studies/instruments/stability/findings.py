"""What a family of failures reports: rows of limits, and the arrays that its figures are drawn from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

__all__ = ["Findings", "Limit"]


@dataclass(frozen=True, kw_only=True)
class Limit:
    """One failure: where theory puts it, where it was found, and what the package does about it.

    Parameters
    ----------
    method : str
        Name of the method, as in ``INTEGRATORS`` or that of an outside library.
    case : str
        What is tried, in a few words.
    knob : str
        The quantity that is turned, with its unit in brackets: "h omega_max [1]".
    theory : float or None
        The limit that theory gives; None where it gives no sharp one.
    measured : float or None
        The limit found; None where the failure did not appear, which `note` then says.
    refused : bool or None
        Whether asking for it beyond the limit is refused before a number comes out; None if nothing is to be
        refused, because the default method has no such limit or the failure is not one of validity.
    note : str
        How it was measured, and the error or sentence with which it is refused.
    """

    method: str
    case: str
    knob: str
    theory: float | None
    measured: float | None
    refused: bool | None
    note: str = ""

    def row(self) -> dict[str, Any]:
        """As a row of the summary."""
        return {
            "method": self.method,
            "case": self.case,
            "knob": self.knob,
            "limit_theory": self.theory,
            "limit_measured": self.measured,
            "refused": self.refused,
            "note": self.note,
        }


@dataclass(frozen=True, kw_only=True)
class Findings:
    """The rows of a family, and named arrays for its figures and its csv."""

    limits: list[Limit]
    arrays: Mapping[str, np.ndarray] = field(default_factory=dict)
