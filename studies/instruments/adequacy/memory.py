"""Choices kept with the scenes that they were made for.

A choice depends on the keys of a scene that describe spring, contact and single mode, on the question and
on what may be chosen. A hash of these names it; the choices of the letter's scene are delivered beside it
(``studies/scenes/choices.json``, made by ``python -m studies.adequacy --remember``), others are kept in
the user's cache. `VERSION` belongs to the hash: it is raised when models, ladder or search change, and
all is found anew.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studies.instruments.adequacy.asked import Asked
from studies.instruments.adequacy.model_choice import ModelChoice, Models
from studies.instruments.adequacy.needed import Needed, Search, needed
from studies.instruments.atomic_file import write_atomically
from studies.instruments.scene import Scene

__all__ = ["DELIVERED", "VERSION", "key_of", "remember", "remembered"]

VERSION = 1
DELIVERED = Path(__file__).parents[2] / "scenes" / "choices.json"
SECTIONS = ("spring", "tip", "damping", "contact", "stop", "single_mode", "modal_data")


def _own() -> Path:
    """Where the user's choices are kept."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return cache / "grazing-spring" / "choices.json"


def key_of(
    scene: Scene,
    asked: Asked,
    tolerance: float,
    rungs: Sequence[str] | None,
    laws: Sequence[str] | None,
    residual: bool,
) -> str:
    """The name of a choice."""
    values = scene.as_dict()
    spring = {k: v for k, v in values["spring"].items() if k not in ("elements_per_leg", "elements_on_arc")}
    text = json.dumps(
        [VERSION, {name: spring if name == "spring" else values[name] for name in SECTIONS}, asdict(asked),
         tolerance, rungs, laws, residual],
        sort_keys=True,
    )  # fmt: skip
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _read(path: Path) -> dict[str, Any]:
    try:
        known = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return known if isinstance(known, dict) else {}


def as_record(found: Needed) -> dict[str, Any]:
    """In terms of JSON."""
    return {
        "choice": asdict(found.choice), "reached": found.reached, "error": found.error,
        "sources": dict(found.sources), "cost": found.cost,
    }  # fmt: skip


def _from_record(asked: Asked, tolerance: float, record: Mapping[str, Any]) -> Needed:
    return Needed(
        asked=asked, tolerance=tolerance, choice=ModelChoice(**record["choice"]), reached=record["reached"],
        error=record["error"], sources=record["sources"], cost=record["cost"],
    )  # fmt: skip


def remember(path: Path, key: str, found: Needed) -> None:
    """Keep a choice in the file at `path`; a folder that cannot be written to is no reason to fail."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        known = _read(path) | {key: as_record(found)}
        write_atomically(path, (json.dumps(known, indent=1, sort_keys=True) + "\n").encode())
    except OSError:
        return


def remembered(
    scene: Scene,
    asked: Asked,
    tolerance: float,
    *,
    rungs: Sequence[str] | None = None,
    laws: Sequence[str] | None = None,
    residual: bool = True,
    models: Models | None = None,
    tell: Callable[[str], None] | None = None,
) -> Needed:
    """As ``needed.needed``, from memory if it was found before."""
    key = key_of(scene, asked, tolerance, rungs, laws, residual)
    for path in (DELIVERED, _own()):
        record = _read(path).get(key)
        if record is not None:
            return _from_record(asked, tolerance, record)
    if tell is not None:
        tell(f"choosing modes and mesh for {asked.quantity} at {asked.frequency:g} Hz (once for this scene)")
    search = Search(scene, asked, models=models, law=laws[-1] if laws else None)
    found = needed(scene, asked, tolerance, rungs=rungs, laws=laws, residual=residual, search=search)
    remember(_own(), key, found)
    return found
