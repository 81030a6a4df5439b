"""What a study stored, as the report reads it: any of it may be missing or broken.

    Stored.study      name of its folder under results
    summary, manifest the two JSON objects, empty where they cannot be read
    faults            one sentence for each thing that is wrong

Reading never fails: a folder with broken contents is a `Stored` with faults.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.instruments.record import SCHEMA

OWN_FOLDER = "report"
PICTURES = (".png", ".gif")


@dataclass(frozen=True, kw_only=True)
class Stored:
    """One folder of results."""

    study: str
    folder: Path
    summary: Mapping[str, Any]
    manifest: Mapping[str, Any]
    faults: tuple[str, ...]

    def part(self, name: str) -> Mapping[str, Any]:
        """A part of the manifest that is itself an object; empty if it is missing or something else."""
        found = self.manifest.get(name)
        return found if isinstance(found, Mapping) else {}

    @property
    def quick(self) -> bool:
        return bool(self.part("settings").get("quick"))

    @property
    def commit(self) -> str | None:
        commit = self.part("git").get("commit")
        return commit if isinstance(commit, str) else None

    @property
    def uncommitted(self) -> bool:
        """Whether the checkout had changes that its commit does not hold."""
        return self.part("git").get("dirty") is True

    def parameters(self) -> dict[str, Any]:
        """Dotted key -> value of the scene."""
        return {
            f"{section}.{key}": value
            for section, entries in self.part("parameters").items()
            if isinstance(entries, Mapping)
            for key, value in entries.items()
        }

    def provenance(self) -> Mapping[str, Any]:
        return self.part("provenance")

    def pictures(self) -> list[Path]:
        """Every picture of the folder, those that the manifest names first and in its order."""
        files = self.manifest.get("files")
        named = [self.folder / str(name) for name in files] if isinstance(files, list) else []
        there = sorted(path for path in self.folder.iterdir() if path.suffix in PICTURES)
        if named:
            there = [path for path in named if path in there]
        return there

    def missing_files(self) -> list[str]:
        """What the manifest names and the folder does not have."""
        files = self.manifest.get("files")
        names = [str(name) for name in files] if isinstance(files, list) else []
        return [name for name in names if not (self.folder / name).exists()]


def _object(path: Path) -> tuple[Mapping[str, Any], list[str]]:
    """The JSON object in a file, and what is wrong with it."""
    shown = f"{path.parent.name}/{path.name}"
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}, [f"{shown} is missing."]
    except (OSError, ValueError, RecursionError) as error:
        reason = getattr(error, "strerror", None) or "it is not JSON"
        return {}, [f"{shown} cannot be read: {reason}."]
    if not isinstance(value, dict):
        return {}, [f"{shown} holds no JSON object."]
    faults = []
    if value.get("schema") != SCHEMA:
        faults.append(f"{shown} has the layout {value.get('schema')!r}, this report knows {SCHEMA}.")
    return value, faults


def read(folder: Path) -> Stored:
    """The results in a folder."""
    summary, wrong = _object(folder / "summary.json")
    manifest, also = _object(folder / "manifest.json")
    stored = Stored(study=folder.name, folder=folder, summary=summary, manifest=manifest, faults=())
    faults = [*wrong, *also]
    lost = stored.missing_files()
    if lost:
        faults.append(f"{folder.name}: the manifest names files that are not there: {', '.join(lost)}.")
    if summary.get("status", "done") != "done":
        failure = summary.get("failure", "")
        faults.append(
            f"{folder.name} did not finish: {summary['status']}" + (f"; {failure}." if failure else ".")
        )
    return Stored(study=folder.name, folder=folder, summary=summary, manifest=manifest, faults=tuple(faults))


def read_all(results: Path) -> dict[str, Stored]:
    """Every folder of results that holds a summary, a manifest or a picture."""
    found = {}
    for folder in sorted(path for path in results.iterdir() if path.is_dir()):
        if folder.name == OWN_FOLDER or folder.name.startswith("."):
            continue
        marks = [folder / "summary.json", folder / "manifest.json"]
        if any(mark.exists() for mark in marks) or any(path.suffix in PICTURES for path in folder.iterdir()):
            found[folder.name] = read(folder)
    return found
