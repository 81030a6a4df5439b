"""Files of results: complete or absent, JSON without NaN, and where a result comes from.

The bytes go into a hidden file of the same folder, reach the disk, and then take the final name in one step:
a reader, a crash or an interruption never sees half a file.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import platform
import re
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from uuid import uuid4

import numpy as np

from studies import ROOT, __version__

SCHEMA = 3
"""Number of the layout of summary.json, manifest.json and the JSON on standard output."""


def make_folder(folder: Path) -> Path:
    """The folder, made if need be."""
    with explained(f"results cannot be written to the folder {folder}"):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def require_writable(folder: Path) -> None:
    """Refuse a folder that takes no files or cannot be made, before a computation; nothing is left there."""
    with explained(f"results cannot be written to the folder {folder}"):
        there = next(path for path in (folder, *folder.parents) if path.exists())
        with tempfile.TemporaryFile(dir=there):
            pass


def write_atomically(path: Path, content: bytes) -> Path:
    """Write or replace the file at `path`."""
    temporary = path.with_name(f".{path.name}.{uuid4().hex}")
    with explained(f"{path} cannot be written"):
        try:
            with temporary.open("xb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink()
    return path


@contextmanager
def explained(what: str) -> Iterator[None]:
    """Put `what` in front of an OSError's reason."""
    try:
        yield
    except OSError as error:
        raise OSError(f"{what}: {error.strerror or 'the system gives no reason'}") from error


def plain(value: object) -> object:
    """The value in terms of JSON: numbers, texts, lists and objects; what is not finite becomes None."""
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if dataclasses.is_dataclass(value):
        return {entry.name: plain(getattr(value, entry.name)) for entry in dataclasses.fields(value)}
    remedy = "give numbers, texts, lists, mappings or rows"
    raise TypeError(f"a {type(value).__name__} has no place in a summary: {remedy}")


def json_text(value: object) -> str:
    """The value as JSON."""
    return json.dumps(plain(value), indent=2, allow_nan=False, ensure_ascii=False)


@cache
def source() -> str:
    """A hash of all modules of the three packages, in a checkout or not."""
    files = sorted(path for name in ("beam", "contact", "studies") for path in (ROOT / name).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def fingerprint(scene: object, settings: Mapping[str, object]) -> str:
    """Equal for runs of a study whose numbers are the same: one source, scene and settings."""
    matters = {key: value for key, value in settings.items() if key != "fresh"}  # begins anew, ends the same
    return hashlib.sha256(json_text([source(), scene, matters]).encode()).hexdigest()


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that this one declares and that are installed."""
    own = "grazing-spring"
    found = {"python": platform.python_version(), own: __version__}
    with suppress(PackageNotFoundError):
        for name in (re.split(r"[^\w.-]", each)[0] for each in requires(own) or ()):
            with suppress(PackageNotFoundError):
                found[name] = version(name)
    return found


def git_state(root: Path = ROOT) -> dict[str, object]:
    """Commit and dirty flag if `root` is the top of a git checkout, else both None."""
    command = ["git", "-C", str(root), "status", "--porcelain=v2", "--branch"]
    lines = list[str]()
    with suppress(OSError, subprocess.SubprocessError):
        if (root / ".git").exists():
            done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
            lines = done.stdout.splitlines()
    commit = next((line.split()[2] for line in lines if line.startswith("# branch.oid")), None)
    return {"commit": commit, "dirty": any(line[0] != "#" for line in lines) if lines else None}
