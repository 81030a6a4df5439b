"""What is said about stores and sweeps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

__all__ = ["flattened", "not_the_same"]

MOST_NAMED = 6
"""Differences spelt out in one sentence."""


def flattened(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested mappings as dotted keys."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            found |= flattened(value, f"{prefix}{key}.")
        else:
            found[f"{prefix}{key}"] = value
    return found


def not_the_same(path: Path, stored: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    """A sentence that names what differs between the plan of a store and another; empty if nothing does."""
    there, here = flattened(stored), flattened(wanted)
    keys = [key for key in {**there, **here} if there.get(key) != here.get(key)]
    if not keys:
        return ""
    named = [f"{key} was {there.get(key)} and is {here.get(key)}" for key in keys[:MOST_NAMED]]
    more = f", and {len(keys) - MOST_NAMED} more" if len(keys) > MOST_NAMED else ""
    return (
        f"the store {path} belongs to another sweep ({'; '.join(named)}{more}): put the values back to go on "
        "with it, give another folder by --out, or begin anew by --fresh"
    )
