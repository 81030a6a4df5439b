"""Which program computed a sweep: a hash of the sources that its numbers come from.

Sources of `beam`, `contact` and of the compiled scan, and the versions of the packages that turn them into
numbers.  Results of two programs never meet in one store: a change as small as one rounding would show as a
seam in the chart wherever the motion is chaotic.
"""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

from studies import ROOT

__all__ = ["program"]

PACKAGES = ("numpy", "scipy", "numba")


def _sources() -> list[Path]:
    packages = [source for name in ("beam", "contact") for source in sorted((ROOT / name).rglob("*.py"))]
    scan = [Path(__file__).with_name(name) for name in ("column_scan.py", "settled_column.py")]
    return [*packages, *scan]


@cache
def program() -> str:
    """Sixteen hexadecimal digits, the same in every process on every machine."""
    digest = hashlib.sha256()
    for name in PACKAGES:
        digest.update(f"{name} {version(name)}\n".encode())
    for source in _sources():
        digest.update(source.relative_to(ROOT).as_posix().encode() + b"\n" + source.read_bytes())
    return digest.hexdigest()[:16]
