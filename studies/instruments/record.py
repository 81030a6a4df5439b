"""The results of one run of a study, and where they come from.

    results/NAME/summary.json     what was found; NaN and infinity are null
                 *.npz, *.csv     arrays and tables
                 *.png, *.pdf     figures, drawn from what was stored; what each shows as NAME_drawn.csv
                 manifest.json    versions, parameters with provenance, command, commit, wall time

Every file is complete or absent (`atomic_file`). What an interrupted study has stored until then stays.
"""

from __future__ import annotations

import csv
import io
import json
import math
import platform
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, cast

import numpy as np

from studies import ROOT
from studies.instruments.atomic_file import make_folder, write_atomically
from studies.instruments.scene import Scene

SCHEMA = 1
"""Number of the layout of summary.json, manifest.json and the JSON on standard output."""

OPTIONAL = ("heyoka", "scikit-sundae", "distributed", "imageio", "imageio-ffmpeg", "trame")
"""Packages that add something when they are there; told only then."""

PACKAGES = (
    "grazing-spring",
    "numpy",
    "scipy",
    "scikit-fem",
    "meshio",
    "pyvista",
    "numba",
    "matplotlib",
    "mpmath",
    "rich",
)


def plain(value: Any) -> Any:
    """The value in terms of JSON: numbers, texts, lists and objects; what is not finite becomes None."""
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, Path):
        return str(value)
    kind = type(value).__name__
    raise TypeError(f"a {kind} has no place in a summary: give numbers, texts, lists or mappings")


def json_text(value: Any, *, indent: int | None = 2) -> str:
    return json.dumps(plain(value), indent=indent, allow_nan=False, ensure_ascii=False)


def versions() -> dict[str, str | None]:
    """Versions of Python and of the packages that results depend on, None for one that is not installed, and
    of the optional ones that are."""
    found: dict[str, str | None] = {"python": platform.python_version()}
    for name in (*PACKAGES, *OPTIONAL):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            if name in PACKAGES:
                found[name] = None
    return found


def git_state(root: Path = ROOT) -> dict[str, Any]:
    """Commit and dirty flag if `root` is the top of a git checkout, else both None."""

    def git(*words: str) -> str | None:
        try:
            answer = subprocess.run(
                ["git", "-C", str(root), *words], capture_output=True, text=True, timeout=10, check=False
            )
        except (OSError, subprocess.SubprocessError):
            return None
        return answer.stdout.strip() if answer.returncode == 0 else None

    top = git("rev-parse", "--show-toplevel")
    if top is None or Path(top).resolve() != root.resolve():
        return {"commit": None, "dirty": None}
    status = git("status", "--porcelain")
    return {"commit": git("rev-parse", "--verify", "HEAD"), "dirty": None if status is None else status != ""}


RESERVED = ("schema", "study", "status", "settings", "provenance", "warnings", "folder", "wall_time_s")
"""Keys of a summary that a study does not name its results by."""


@dataclass(kw_only=True)
class Record:
    """Writer of one results folder; `files` lists what has been written."""

    study: str
    folder: Path
    scene: Scene
    command: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    warnings: Sequence[str] = ()
    files: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        make_folder(self.folder)
        self._begun = time.perf_counter()
        self._date = datetime.now(UTC)

    def _write(self, name: str, content: bytes) -> Path:
        if Path(name).name != name:
            raise ValueError(f"a result needs a plain file name, not {name!r}")
        path = write_atomically(self.folder / name, content)
        self._note(path)
        return path

    def _note(self, path: Path) -> None:
        if path.name not in self.files:
            self.files.append(path.name)

    @property
    def wall_time(self) -> float:
        """Seconds since the record was opened."""
        return time.perf_counter() - self._begun

    def write_json(self, name: str, value: Any) -> Path:
        """NAME.json."""
        return self._write(f"{name}.json", (json_text(value) + "\n").encode())

    def write_text(self, name: str, text: str) -> Path:
        """A text file under its full name."""
        return self._write(name, text.encode())

    def write_arrays(self, name: str, **arrays: Any) -> Path:
        """NAME.npz with these named arrays of numbers or texts."""
        numeric = {key: np.asarray(value) for key, value in arrays.items()}
        for key, array in numeric.items():
            if array.dtype.hasobject:
                raise TypeError(f"{key} in {name}.npz must be an array of numbers or texts, not of objects")
        stream = io.BytesIO()
        np.savez_compressed(stream, **cast("dict[str, Any]", numeric))
        return self._write(f"{name}.npz", stream.getvalue())

    def write_table(self, name: str, columns: Mapping[str, Sequence[Any]]) -> Path:
        """NAME.csv; the headings carry the units, the columns have equal lengths."""
        rows = {key: np.asarray(column).tolist() for key, column in columns.items()}
        if len({len(column) for column in rows.values()}) > 1:
            lengths = ", ".join(f"{key} {len(column)}" for key, column in rows.items())
            raise ValueError(f"the columns of {name}.csv must have equal lengths, not {lengths}")
        stream = io.StringIO(newline="")
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(rows)
        writer.writerows(zip(*rows.values(), strict=True))
        return self._write(f"{name}.csv", stream.getvalue().encode())

    def write_figure(self, figure: Any, name: str) -> None:
        """NAME.png, NAME.pdf and what they show: NAME_drawn.csv, for a map in panel a NAME_drawn_a.csv."""
        # matplotlib is slow to import and not always needed
        from studies.instruments.drawn_points import drawn_maps, drawn_points
        from studies.instruments.figures import save

        for path in save(figure, self.folder, name):
            self._note(path)
        points = drawn_points(figure)
        if any(points.values()):  # a rendered body has none
            self.write_table(f"{name}_drawn", points)
        for panel, columns in drawn_maps(figure).items():
            self.write_table(f"{name}_drawn_{panel[:2] or 'map'}", columns)

    def close(self, status: str, results: Mapping[str, Any]) -> dict[str, Any]:
        """Write summary.json and manifest.json; returns the summary."""
        wall_time = round(self.wall_time, 3)
        summary = {
            "schema": SCHEMA,
            "study": self.study,
            "status": status,
            "settings": self.settings,
            "provenance": self.scene.provenance(),
            "warnings": list(self.warnings),
            **{key: value for key, value in results.items() if key not in RESERVED},
        }
        self.write_json("summary", summary)
        manifest = {
            "schema": SCHEMA,
            "study": self.study,
            "status": status,
            "command": self.command,
            "settings": self.settings,
            "parameters": self.scene.as_dict(),
            "provenance": self.scene.provenance(),
            "warnings": list(self.warnings),
            "fingerprint": self.scene.fingerprint(),
            "versions": versions(),
            "git": git_state(),
            "begun": self._date.isoformat(timespec="seconds"),
            "wall_time_s": wall_time,
            "files": sorted({*self.files, "manifest.json"}),
        }
        self.write_json("manifest", manifest)
        return {**plain(summary), "folder": str(self.folder), "wall_time_s": wall_time}
