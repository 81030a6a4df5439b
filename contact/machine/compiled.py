"""Compiled kernels and where their machine code is kept.

Every numerical kernel of the package is a pure function of numbers and arrays, compiled by numba without
fast-math (so that results are the same bit for bit on one type of machine) and without the interpreter lock
(so that threads share the cores).

The compiled code is cached between runs.  Numba's own cache looks at the one file in which a kernel stands;
a kernel that calls kernels of other files would then be reused although its callee has changed.  The folder
of a kernel's machine code is therefore named after a hash of its file and of all files that this one imports,
directly or through others: change a source, and what rests on it is compiled anew.  (A source counts if the
word kernel occurs in it, which includes the constants that kernels take from it.)  Folders of other sources
are removed after an hour without use.

The first kernel that a process has to compile is announced on standard error.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import multiprocessing
import os
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import cgutils, event, types
from numba.core import config as numba_config
from numba.extending import intrinsic

config: Any = numba_config

PACKAGE = Path(__file__).parent.parent
IMPORT = re.compile(r"^from (contact[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)

UNUSED = 3600.0
"""Time without use [s] after which a folder of machine code is removed; an older process may need it."""

Function = TypeVar("Function", bound=Callable[..., object])


def _writable(folder: Path) -> bool:
    """Whether files can be made in `folder` (made here if need be)."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _place(package: Path) -> Path | None:
    """The first writable of: beside the sources, the user's cache; None if there is none."""
    user_cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "grazing-spring"
    return next((folder for folder in (package / "__pycache__", user_cache) if _writable(folder)), None)


@cache
def _imports(path: Path) -> tuple[bytes, frozenset[Path]]:
    """The text of a file of ``contact`` and the files of it that it imports."""
    text, found = path.read_bytes(), set[Path]()
    for module, names in IMPORT.findall(text.decode()):
        start = PACKAGE.joinpath(*module.split(".")[1:])
        for part in [start, *(start / name for name in re.findall(r"\w+", names))]:
            if part != PACKAGE:
                found |= {file for file in (part.with_suffix(".py"), part / "__init__.py") if file.is_file()}
    return text, frozenset(found)


def sources_of(path: Path) -> set[Path]:
    """The file at `path` and all files of ``contact`` on which it rests."""
    known, new = set[Path](), {path}
    while new:
        known |= new
        new = {other for file in new for other in _imports(file)[1]} - known
    return known


def folder_of(digest: str, parent: Path) -> str:
    """The folder of machine code for this digest, marked as used now; a new one removes what nobody uses."""
    folder = parent / f"kernels-{digest[:16]}"
    if not folder.exists():
        for old in parent.glob("kernels-*"):
            with contextlib.suppress(OSError):
                if time.time() - old.stat().st_mtime > UNUSED:
                    shutil.rmtree(old)
    folder.mkdir(exist_ok=True)
    os.utime(folder)
    return str(folder)


@cache
def _cache_folder(path: Path) -> str:
    """The folder of the machine code of the file at `path`; an empty string if there can be none."""
    if own := os.environ.get("NUMBA_CACHE_DIR"):
        return own
    if PLACE is None:
        return ""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(sources_of(path)):
        if b"kernel" in (text := _imports(source)[0]):
            digest.update(text)
    return folder_of(digest.hexdigest(), PLACE)


PLACE = _place(PACKAGE)


class _Announcement(event.Listener):  # type: ignore[misc]
    """Prints once in a process that kernels are compiled; numba's event comes only without cached code."""

    def on_start(self, event: Any) -> None:
        """A kernel is being compiled."""
        module = event.data["dispatcher"].py_func.__module__ or ""  # None: made from text, as tables of laws
        ours = module.startswith("contact.")
        worker = multiprocessing.parent_process() is not None
        if ours and not worker and not self.said:
            self.said = True
            print("compiling kernels, about 60 s, once", file=sys.stderr, flush=True)

    def on_end(self, event: Any) -> None:
        """A kernel is ready."""

    said = False


event.register("numba:compile", _Announcement())


def kernel(function: Function) -> Function:
    """Compile `function` on first call; keep the machine code for the next run where a folder allows it."""
    before, folder = config.CACHE_DIR, _cache_folder(Path(inspect.getfile(function)))
    config.CACHE_DIR = folder
    try:
        compiled = numba.njit(cache=bool(folder), nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = before
    return cast(Function, compiled)


def inlined(function: Function) -> Function:
    """Compile a small `function` into the machine code of its callers, whose loops can then use vectors."""
    return cast(Function, numba.njit(forceinline=True, nogil=True, error_model="numpy")(function))


def part(function: Function) -> Function:
    """A part of its caller, told apart for the reader: put into it before either is compiled.

    A kernel is compiled with all that it calls, however deep; parts are not compiled once more for that.
    """
    return cast(Function, numba.njit(inline="always", nogil=True, error_model="numpy")(function))


def _uncounted(context, builder, kind, value):
    """A value whose arrays have no owner."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        items = cgutils.unpack_tuple(builder, value)
        parts = [_uncounted(context, builder, each, item) for each, item in zip(kind, items, strict=True)]
        return context.make_tuple(builder, kind, parts)
    return value


@intrinsic
def borrowed(_context, value):
    """The same arrays, or tuple of arrays, without counting who holds them.

    Each array handed on to a kernel costs some ten nanoseconds for that count, as much as two modes.  The
    lender must hold the arrays meanwhile: it does if they are its arguments, or if it says `held` at its end.
    """

    def build(context, builder, signature, args):
        return _uncounted(context, builder, signature.args[0], args[0])

    return value(value), build


@intrinsic
def held(_context, value):
    """Nothing, but that `value` has been held up to here."""
    return types.void(value), lambda context, builder, signature, args: context.get_dummy_value()
