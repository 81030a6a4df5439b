"""Standard output that carries the answer and nothing else, and may be closed by its reader at any time.

    with kept_clean() as output:
        tell(text, output)             # a reader that has seen enough (head) is no error
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Iterator
from typing import TextIO


def tell(text: str, output: TextIO) -> None:
    """Print `text`; a pipe whose reader is gone takes it without a word."""
    try:
        print(text, file=output, flush=True)
    except BrokenPipeError:
        _forget(output)


def fill_closed() -> None:
    """Open what the process was started without (2>&-): no file of results may get its number."""
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            setattr(sys, name, open(number, "w", encoding="utf-8", closefd=False))


def _forget(output: TextIO) -> None:
    """Let what is still in the buffers of a broken pipe go nowhere, also when they are closed."""
    with contextlib.suppress(AttributeError, OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, output.fileno())
        os.close(nowhere)


@contextlib.contextmanager
def kept_clean() -> Iterator[TextIO]:
    """Yield standard output; whatever else is printed meanwhile, even by a worker, goes to standard error."""
    wanted = sys.stdout
    kept: int | None = None
    with contextlib.suppress(AttributeError, OSError, ValueError, io.UnsupportedOperation):
        wanted.flush()
        if wanted.fileno() == 1 and sys.stderr.fileno() == 2:
            kept = os.dup(1)
            os.dup2(2, 1)
    try:
        if kept is None:
            with contextlib.redirect_stdout(sys.stderr):
                yield wanted
        else:
            with contextlib.redirect_stdout(sys.stderr), open(os.dup(kept), "w", encoding="utf-8") as output:
                yield output
    finally:
        if kept is not None:
            os.dup2(kept, 1)
            os.close(kept)
