"""Where cells are computed, and how far they have come: executors and progress."""

from __future__ import annotations

import math
import multiprocessing
import re
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from datetime import timedelta
from functools import partial

from beam import InvalidValue
from studies.shell.programs import needs

INTERVAL = 30.0
"""Seconds between two lines of progress where there is no terminal."""

PATIENCE = 20.0
"""Seconds to wait for the scheduler of a cluster."""


def say(sentence: str) -> None:
    """A line for a person, if there is something to say."""
    if sentence:
        print(sentence, file=sys.stderr, flush=True)


def duration(seconds: float) -> str:
    """As hours, minutes and seconds, 0:03:20."""
    return str(timedelta(seconds=round(seconds)))


@contextmanager
def progress(label: str, total: int, unit: str) -> Iterator[Callable[..., None]]:
    """Count steps: a bar with rate and time left on a terminal, a line every half minute elsewhere.

    Yields a function that counts one step, or as many as it is given, from any thread. `unit` names the steps
    in the plural; where it is s, the seconds that the work takes, the total is an estimate.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TimeRemainingColumn

    columns = "{task.description}", BarColumn(), "{task.fields[done]}", TimeRemainingColumn()
    printed, lock, terminal = time.monotonic(), threading.Lock(), sys.stderr.isatty()
    console = Console(file=sys.stderr)
    with Progress(*columns, console=console, disable=not terminal, speed_estimate_period=math.inf) as bar:
        task = bar.add_task(label, total=total, done="")

        def count(steps: int = 1) -> None:
            nonlocal printed
            with lock:
                bar.advance(task, steps)
                now, known = time.monotonic(), bar.tasks[0]
                bar.update(task, done=(done := _done(known.completed, total, unit, known.speed)))
                if not terminal and now - printed >= INTERVAL:
                    printed, left = now, known.time_remaining
                    ahead = "" if left is None else f", {duration(left)} left"
                    say(f"{label}: {done}{ahead}")

        yield count


def _done(completed: float, total: int, unit: str, speed: float | None) -> str:
    """How many of the steps are done, and steps per second or seconds per step, as it reads better."""
    if unit == "s":
        return f"{completed:g} of about {total} s"
    words = f"{completed:g} of {total} {unit}"
    if not speed:
        return words
    return f"{words}, {speed:.3g} per s" if speed >= 1.0 else f"{words}, {1.0 / speed:.3g} s each"


def require_place(place: str) -> str:
    """The name of an executor, or InvalidValue."""
    if not re.fullmatch(r"(threads|processes|dask://.+)?", place):
        raise InvalidValue(f"executor is {place!r}; it must be threads, processes or dask://host:port")
    return place


@contextmanager
def pool_of(place: str, workers: int) -> Iterator[Executor]:
    """The executor at `place`, threads, processes or dask://host:port, with so many threads or processes.

    If the body is left by an exception, what has not begun is dropped, and processes are ended.
    """
    kind, _, address = require_place(place).partition("://")
    if kind == "dask":
        with _cluster(address) as cluster:
            yield cluster
        return
    if kind == "processes":
        context = multiprocessing.get_context("spawn")
        silence = partial(warnings.filterwarnings, "ignore", "", UserWarning, r"(beam|contact|studies)\b")
        # a worker is silent, as its parent has printed the warnings
        executor: Executor = ProcessPoolExecutor(workers, mp_context=context, initializer=silence)
    else:
        executor = ThreadPoolExecutor(workers, thread_name_prefix="study")
    try:
        yield executor
    except BaseException:
        for process in multiprocessing.active_children() if kind == "processes" else ():
            process.terminate()
        executor.shutdown(wait=kind == "processes", cancel_futures=True)
        raise
    executor.shutdown()


@contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    """The workers of a dask scheduler, which must have the same program and packages."""
    try:
        from distributed import Client
    except ImportError as error:
        raise InvalidValue(needs("a cluster", "distributed")) from error
    try:
        client = Client(f"tcp://{address}", timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InvalidValue(f"no scheduler answers at {address} within {PATIENCE:g} s") from error
    with client:
        if not client.nthreads():
            remedy = f"start some with `dask worker {address}`"
            raise InvalidValue(f"the scheduler at {address} has no workers: {remedy}")
        yield client.get_executor(pure=False)
