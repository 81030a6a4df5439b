"""The loop of a sweep: hand out batches, store what comes back.

    with Store.begin(path, plan) as store, pool_of("threads", 2) as pool:
        run_sweep(grid=grid, work=work, store=store, pool=pool)

Each chain (the columns of one frequency) has at most one batch under way; its next batch starts from the
state that the last one has stored.  A few chains more than there are workers are open at a time, so that
memory does not grow with the size of the sweep.  Batches last about `TARGET` seconds; where a column is cut
changes nothing in the results, nor does the executor or the order in which batches come back.

A sweep goes on from whatever its store holds.  Ctrl-C, a full disk or lost workers end it with everything
stored that had come back by then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import suppress
from dataclasses import dataclass, field

from studies.instruments.sweep.executors import Pool
from studies.instruments.sweep.program import program
from studies.instruments.sweep.store import Store
from studies.instruments.sweep.tasks import Answer, Batch, Column, Grid, Shard, Work

__all__ = ["WorkersLost", "run_sweep"]

TARGET = 0.5
"""Seconds that a batch should take: what a kill can lose, long against the millisecond of handing over."""

FIRST, MOST = 4, 256
"""Cells in the first batch of a chain, whose pace is not known, and in any: a batch stays below 1 MB."""

AHEAD = 2
"""Batches handed out for each worker: one computed, one waiting."""

GRACE = 10.0
"""Seconds to wait after an interruption for the batches that are being computed."""


class WorkersLost(ConnectionError):
    """Workers ended or are of no use; the message is one sentence."""


@dataclass
class _Chain:
    """How far the columns of one frequency have come."""

    columns: tuple[Column, ...]
    place: int = 0
    step: int = 0
    state: bytes | None = field(default=None, repr=False)
    size: int = FIRST

    def find_place(self, store: Store) -> None:
        """Go to where the store ends."""
        for place, column in enumerate(self.columns):
            self.place = place
            self.step, reached = store.reached(column.number)
            self.state = reached if self.step else self.state
            if self.step < len(column.excesses):
                return

    def batch(self) -> Batch | None:
        """What comes next; None at the end."""
        column = self.columns[self.place]
        if self.step == len(column.excesses):
            if self.place + 1 == len(self.columns):
                return None
            self.place, self.step = self.place + 1, 0
            column = self.columns[self.place]
        return Batch(
            column=column.number,
            frequency=column.frequency,
            direction=column.direction,
            first_step=self.step,
            excesses=column.excesses[self.step : self.step + self.size],
            state=self.state,
        )

    def passed(self, answer: Answer) -> None:
        """The batch is stored."""
        count = len(answer.cells)
        self.step += count
        self.state = answer.cells[-1].state
        pace = answer.seconds / count
        # at most fourfold: the next cells may be chaotic and take a hundred times longer than those at rest
        self.size = max(1, min(MOST, 4 * self.size, int(TARGET / pace) if pace > 0 else MOST))


def _answered(work: Work, batch: Batch) -> tuple[Answer, str]:
    """In the worker: the answer, and which program gave it."""
    return work(batch), program()


def run_sweep(
    *,
    grid: Grid,
    work: Work,
    store: Store,
    pool: Pool,
    shard: Shard | None = None,
    tell: Callable[[int], None] = lambda cells: None,
) -> None:
    """Compute the cells of `shard` (all by default) that `store` does not hold yet.

    Parameters
    ----------
    grid, work, store, pool, shard
    tell : callable
        Called with the number of cells stored after each batch (progress).

    Raises
    ------
    WorkersLost
        If processes or the cluster end, or run another version of the program.
    RecordError
        If the store cannot be written.
    """
    waiting = _open_chains(grid, store, Shard() if shard is None else shard)
    flight: dict[Future[tuple[Answer, str]], tuple[_Chain, Batch]] = {}

    def submit(chain: _Chain) -> bool:
        batch = chain.batch()
        if batch is None:
            return False
        flight[pool.executor.submit(_answered, work, batch)] = (chain, batch)
        return True

    def keep(future: Future[tuple[Answer, str]]) -> _Chain:
        chain, batch = flight[future]
        try:
            answer, theirs = future.result()
        except pool.losses as error:
            raise WorkersLost(
                f"the {pool.name} ended before the sweep did ({type(error).__name__}); what was stored is "
                "kept"
            ) from error
        if theirs != program():
            raise WorkersLost(
                f"a worker of the {pool.name} runs another version of the program ({theirs} instead of "
                f"{program()}): bring it up to date"
            )
        store.add(batch, answer.cells)
        del flight[future]
        chain.passed(answer)
        tell(len(answer.cells))
        return chain

    try:
        while True:
            room = AHEAD * pool.size() - len(flight)
            while room > 0 and (chain := next(waiting, None)) is not None:
                room -= submit(chain)
            if not flight:
                return
            for future in wait(flight, return_when=FIRST_COMPLETED).done:
                submit(keep(future))
    finally:
        for future in flight:
            future.cancel()
        for future in wait(flight, timeout=GRACE).done:
            with suppress(Exception):
                keep(future)


def _open_chains(grid: Grid, store: Store, shard: Shard) -> Iterator[_Chain]:
    """The chains that are not finished."""
    for columns in grid.chains(shard):
        chain = _Chain(columns)
        chain.find_place(store)
        if chain.batch() is not None:
            yield chain
