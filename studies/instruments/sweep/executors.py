"""Where a sweep is computed: every place is a `concurrent.futures.Executor`.

    ""  or  threads      threads of this process, one a core: the kernels release the interpreter lock
    processes            processes of this machine, started afresh (never forked)
    dask://host:port     the workers of a dask.distributed scheduler, which must have the same program and
                         packages; they may come and go (extra `cluster`)
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Pool", "pool_of"]

PLACES = "threads, processes or dask://host:port"

PATIENCE = 20.0
"""Seconds to wait for a scheduler to answer."""

REFRESH = 10.0
"""Seconds after which the workers of a cluster are counted again."""


@dataclass(kw_only=True)
class Pool:
    """An executor, how many batches it computes at a time, what it raises when its workers are lost."""

    executor: Executor
    name: str
    count: Callable[[], int]
    losses: tuple[type[BaseException], ...] = (BrokenExecutor, CancelledError)
    _known: int = field(default=1, init=False)
    _counted: float = field(default=float("-inf"), init=False)

    def size(self) -> int:
        """Workers there at the moment, at least 1."""
        if time.monotonic() - self._counted >= REFRESH:
            self._known, self._counted = max(1, self.count()), time.monotonic()
        return self._known


@contextmanager
def pool_of(place: str, workers: int) -> Iterator[Pool]:
    """The executor at `place`, with `workers` threads or processes (a cluster has its own number).

    Raises
    ------
    ValueError
        For a place that is not known, a cluster that does not answer, or a package that is missing.
    """
    kind, colon, address = place.partition("://")
    if kind in ("", "threads") and not colon:
        executor: Executor = ThreadPoolExecutor(max_workers=workers, thread_name_prefix="sweep")
        with _ended(Pool(executor=executor, name=f"{workers} threads", count=lambda: workers)) as pool:
            yield pool
    elif kind == "processes" and not colon:
        executor = ProcessPoolExecutor(
            max_workers=workers, mp_context=multiprocessing.get_context("spawn")
        )
        with _ended(Pool(executor=executor, name=f"{workers} processes", count=lambda: workers)) as pool:
            yield pool
    elif kind in ("dask", "tcp", "tls") and address:
        with _cluster(f"{'tcp' if kind == 'dask' else kind}://{address}") as pool:
            yield pool
    else:
        raise ValueError(f"executor is {place!r}; it must be {PLACES}")


@contextmanager
def _ended(pool: Pool) -> Iterator[Pool]:
    try:
        yield pool
    finally:
        pool.executor.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _cluster(address: str) -> Iterator[Pool]:
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise ValueError(
            "a cluster needs the package distributed: install it by "
            "`python -m pip install 'grazing-spring[cluster]'`"
        ) from error
    client: Any
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise ValueError(f"no scheduler answers at {address} within {PATIENCE:g} s") from error
    with client:
        if not client.nthreads():
            raise ValueError(f"the scheduler at {address} has no workers: start some, for instance by "
                             f"`dask worker {address}` in the folder of the project")  # fmt: skip
        executor = client.get_executor(pure=False)
        yield Pool(
            executor=executor,
            name=f"cluster at {address}",
            count=lambda: sum(client.nthreads().values()),
            losses=(CancelledError, KilledWorker, OSError),
        )
