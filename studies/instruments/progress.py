"""How far a long computation has come, told on standard error.

    with Progress("orbit diagram", total=81) as progress:
        for amplitude in amplitudes:
            ...
            progress.advance()

On a terminal this is a bar with rate and time left. Elsewhere (a log file, a job queue) it is one line
every `INTERVAL` seconds, and one at the end.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

INTERVAL = 30.0
"""Seconds between two lines: a day's log stays below 3000 of them."""


def duration(seconds: float) -> str:
    """Seconds in the units in which a person waits: 8 s, 3 min 20 s, 2 h 05 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def rate_of(done: int, seconds: float) -> str:
    """Steps per second, or seconds per step when that reads better."""
    if done == 0 or seconds <= 0.0:
        return "no rate yet"
    return f"{done / seconds:.3g} per s" if done >= seconds else f"{seconds / done:.3g} s each"


class Progress:
    """A count of `total` steps (None where the number is not known beforehand)."""

    def __init__(
        self,
        label: str,
        total: int | None = None,
        *,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.label, self.total, self.done = label, total, 0
        self._stream = sys.stderr if stream is None else stream
        self._clock = clock
        self._bar: Bar | None = None
        self._task: TaskID | None = None
        self._begun = self._told = clock()

    def __enter__(self) -> Progress:
        self._begun = self._told = self._clock()
        if self._stream.isatty():
            self._start_bar()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
        elif kind is None:
            self._tell(f"done in {duration(self._clock() - self._begun)}")

    def advance(self, steps: int = 1) -> None:
        """`steps` more are done."""
        self.done += steps
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, advance=steps, rate=rate_of(self.done, self._clock() - self._begun))
        elif self._clock() - self._told >= INTERVAL:
            self._tell(self._remaining())

    def _remaining(self) -> str:
        seconds = self._clock() - self._begun
        words = rate_of(self.done, seconds)
        if self.total is not None and 0 < self.done < self.total:
            words += f", {duration(seconds * (self.total - self.done) / self.done)} left"
        return words

    def _tell(self, words: str) -> None:
        count = f"{self.done}" if self.total is None else f"{self.done} of {self.total}"
        print(f"{self.label}: {count}, {words}", file=self._stream, flush=True)
        self._told = self._clock()

    def _start_bar(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        self._bar = Bar(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}", markup=False),
            TimeRemainingColumn(),
            console=Console(file=self._stream),
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._task = self._bar.add_task(self.label, total=self.total, rate="")
        self._bar.start()
