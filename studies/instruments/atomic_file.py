"""Files that are either complete or not there.

The bytes go into a hidden file in the same folder, reach the disk, and then take the final name in one step.
A reader, a crash or an interruption never sees half a file.
"""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path


class RecordError(OSError):
    """Results cannot be written; the message is one sentence."""


def reason_of(error: OSError) -> str:
    return error.strerror or "the system gives no reason"


def make_folder(folder: Path) -> Path:
    """The folder, made if need be and seen to accept files; better told before a computation than after."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise RecordError(f"results cannot be written to the folder {folder}: {reason_of(error)}") from error
    return folder


def write_atomically(path: Path, content: bytes) -> Path:
    """Write or replace the file at `path`."""
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except BaseException as error:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError):
            raise RecordError(f"{path} cannot be written: {reason_of(error)}") from error
        raise
    return path


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
