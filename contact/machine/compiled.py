"""Compiled kernels and where their machine code is kept.

Every numerical kernel of the package is a function of numbers and arrays.  Numba compiles it without
fast-math, so that results agree bit for bit on one type of machine.  It runs without the interpreter lock, so
that threads share the cores.

The machine code is cached between runs.  Numba's own cache checks only the file of a kernel, and would reuse
a kernel whose callee in another file has changed.  Here the name of the cache folder is a hash of the
kernel's file and of all files of ``contact`` on which it rests.  A change of a source thus recompiles all
kernels that rest on it, and no others.  A new folder removes those without use for an hour.  The environment
variable NUMBA_CACHE_DIR names another folder, without these rules.

The first kernel of the package that the main process compiles is announced on standard error.
"""

import contextlib
import hashlib
import inspect
import logging
import multiprocessing
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba.core import cgutils, event, types
from numba.core import config as numba_config
from numba.extending import intrinsic

config: Any = numba_config

PACKAGE = Path(__file__).parent.parent
MODULES = {
    ".".join((PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__"): path
    for path in (*PACKAGE.glob("[!_]*.py"), *PACKAGE.glob("[!_]*/**/*.py"))
}  # the files of ``contact``, but for its own __init__
IMPORT = re.compile(r"^from (contact[\w.]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)

UNUSED = 3600.0  # time without use [s] after which machine code is removed; an older process may need it

Function = TypeVar("Function", bound=Callable[..., object])


def _writable_parent(package: Path) -> Path | None:
    """The folder for cache folders: beside the sources, or the user's cache; None if neither is writable."""
    user_cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "grazing-spring"
    for folder in (package / "__pycache__", user_cache):
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
    return None


@cache
def _imports(path: Path) -> tuple[bytes, frozenset[Path]]:
    """The text of a file of ``contact``, and the files of ``contact`` that it imports."""
    text, found = path.read_bytes(), set[Path]()
    for module, names in IMPORT.findall(text.decode()):
        parts = [module, *(f"{module}.{name}" for name in re.findall(r"\w+", names))]
        found |= {MODULES[part] for part in parts if part in MODULES}
    return text, frozenset(found)


def sources_of(path: Path) -> set[Path]:
    """The file at `path` and all files of ``contact`` on which it rests."""
    known, new = set[Path](), {path}
    while new:
        known |= new
        new = {other for file in new for other in _imports(file)[1]} - known
    return known


def folder_of(digest: str, parent: Path) -> str:
    """The cache folder for this digest, marked as used now; making a new one removes unused ones."""
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
    """The cache folder for the file at `path`; an empty string if no folder is writable."""
    if own := os.environ.get("NUMBA_CACHE_DIR"):
        return own
    if CACHE_PARENT is None:
        return ""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(sources_of(path)):
        digest.update(_imports(source)[0])
    return folder_of(digest.hexdigest(), CACHE_PARENT)


CACHE_PARENT = _writable_parent(PACKAGE)


class _Announcement(event.Listener):  # type: ignore[misc]
    """Announces once per process that a kernel is compiled; cached code brings no event of numba."""

    def on_start(self, event: Any) -> None:
        """A kernel is being compiled."""
        module = event.data["dispatcher"].py_func.__module__ or ""  # None for `touch.by_law`, made from text
        ours = module.startswith("contact.")
        worker = multiprocessing.parent_process() is not None
        if ours and not worker and not self.said:
            self.said = True
            # a warning, so that it is seen where nobody has set up logging
            logging.getLogger("contact").warning("compiling kernels, about 60 s, once")

    def on_end(self, event: Any) -> None:
        """A kernel is ready."""

    said = False


event.register("numba:compile", _Announcement())


def kernel(function: Function) -> Function:
    """Compile `function` on its first call, and keep the machine code for the next run if possible."""
    before, folder = config.CACHE_DIR, _cache_folder(Path(inspect.getfile(function)))
    config.CACHE_DIR = folder
    try:
        compiled = numba.njit(cache=bool(folder), nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = before
    return cast(Function, compiled)


def inlined(function: Function) -> Function:
    """Let LLVM inline a small `function` into its callers, whose loops can then use vector instructions."""
    return cast(Function, numba.njit(forceinline=True, nogil=True, error_model="numpy")(function))


def part(function: Function) -> Function:
    """Let numba insert `function` into its caller before compilation; it is separate only for the reader.

    A part is compiled only inside its callers, never alone.
    """
    return cast(Function, numba.njit(inline="always", nogil=True, error_model="numpy")(function))


LINE = 8  # numbers that the processor fetches at once; rows that begin at multiples of this are read faster


@kernel
def aligned(rows, columns):
    """An array of zeros whose first element lies at a multiple of 64 bytes."""
    buffer = np.zeros(rows * columns + LINE)
    first = (-(buffer.ctypes.data // 8)) % LINE
    return buffer[first : first + rows * columns].reshape(rows, columns)


def _uncounted(context, builder, kind, value):
    """The value with arrays that have no owner."""
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
    """The same arrays, or tuple of arrays, without reference counting.

    Reference counting costs some ten nanoseconds for each array passed to a kernel, as much as two modes.
    Arguments of the caller stay alive.  Any other array stays alive if the caller ends with `held`.
    """

    def build(context, builder, signature, args):
        return _uncounted(context, builder, signature.args[0], args[0])

    return value(value), build


@intrinsic
def held(_context, value):
    """Keep `value` alive up to here."""
    return types.void(value), lambda context, builder, signature, args: context.get_dummy_value()
