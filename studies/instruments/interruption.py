"""Ctrl-C and a request to end, from the first import to the last file.

    watch_start()                                       # in studies/__init__, when it runs as a program
    with Interruption(save) as interruption:            # in the command line, around a study
        run(...)                                        # KeyboardInterrupt, once
        with interruption.calm():                       # while results are written

The first SIGINT or SIGTERM raises KeyboardInterrupt, so that every loop ends as it wants to: a sweep stores
the batches that come back.  A study that has not ended `PATIENCE` seconds later, with threads that go on
computing what was handed to them, is ended by `leave`, which stores what the command line knows.  A second
Ctrl-C does so at once.  While a program is still importing, nothing is stored yet, and one line takes the
place of a traceback.
"""

from __future__ import annotations

import contextlib
import multiprocessing.util
import os
import shlex
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType, TracebackType
from typing import Any

INTERRUPTED = 130
"""Exit code."""

PATIENCE = 5.0
"""Seconds between an interruption and the end of the process: a batch of a sweep lasts half a second."""

SHOW_CURSOR = "\x1b[?25h"
"""A progress bar that is cut off has hidden it."""

SIGNALS = (signal.SIGINT, signal.SIGTERM)

_program: dict[str, bool] = {"started": False}


def command_of_process() -> str:
    """What was typed to start this process."""
    return shlex.join(["python", *sys.orig_argv[1:]])


def watch_start() -> None:
    """From here on a Ctrl-C that nobody handles is one line and exit code 130."""
    _program["started"] = True
    before = sys.excepthook

    def told(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if not issubclass(kind, KeyboardInterrupt):
            before(kind, error, trace)
            return
        print(f"interrupted; nothing was stored; go on with: {command_of_process()}", file=sys.stderr)
        end_process(INTERRUPTED)

    sys.excepthook = told


def end_process(code: int) -> None:
    """End at once, without waiting for threads and processes that still compute."""
    for process in multiprocessing.active_children():
        process.terminate()
    with contextlib.suppress(Exception):  # give back the semaphores, or their tracker complains of a leak
        multiprocessing.util._run_finalizers(0)  # type: ignore[attr-defined]
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, OSError, ValueError):
            stream.write(SHOW_CURSOR if stream.isatty() else "")
            stream.flush()
    os._exit(code)


class Interruption:
    """Around a study: what its signals do.

    Parameters
    ----------
    leave : callable
        Stores what there is and tells it; called if the study does not end by itself.
    """

    def __init__(self, leave: Callable[[], None]) -> None:
        self.leave = leave
        self.count = 0
        self._calm = False
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None
        self._before: dict[int, Any] = {}
        self._unraisable: Callable[[Any], object] | None = None

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            for number in SIGNALS:
                if signal.getsignal(number) is not signal.SIG_IGN:  # nohup and background jobs of a shell
                    self._before[number] = signal.signal(number, self._signalled)
            self._unraisable = sys.unraisablehook
            sys.unraisablehook = self._lost
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._timer is not None:
            self._timer.cancel()
        for number, handler in self._before.items():
            signal.signal(number, handler)
        if self._unraisable is not None:
            sys.unraisablehook = self._unraisable

    def _lost(self, told: Any) -> None:
        """An interruption within a callback of the compiler cannot be raised; the timer ends the study."""
        if not issubclass(told.exc_type, KeyboardInterrupt) and self._unraisable is not None:
            self._unraisable(told)

    def _signalled(self, number: int, frame: FrameType | None) -> None:
        self.count += 1
        if self.count > 1:
            self._leave()
        if self._calm:
            return
        if _program["started"]:
            self._timer = threading.Timer(PATIENCE, self._leave)
            self._timer.daemon = True
            self._timer.start()
        raise KeyboardInterrupt

    def _leave(self) -> None:
        if not self._lock.acquire(blocking=False):
            return
        with contextlib.suppress(Exception):
            self.leave()
        end_process(INTERRUPTED)

    @contextlib.contextmanager
    def calm(self) -> Iterator[None]:
        """While inside, the first signal is only counted, and the study not ended from outside."""
        with self._lock:
            self._calm = True
            try:
                yield
            finally:
                self._calm = False

    def end_program(self, code: int) -> None:
        """After an interruption: do not wait for threads that still compute, if this is a program."""
        if self.count and _program["started"]:
            end_process(code)
