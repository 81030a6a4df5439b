"""What there is to do in a sweep: columns of cells, cut into batches.

A *cell* is one drive amplitude at one drive frequency.  A *column* is one frequency in one scan direction,
its cells in the order of the scan, each starting from the state in which the one before ended.  The downward
column at a frequency starts where the upward one has ended, so both make one *chain*; chains have nothing to
do with one another.  A *batch* is a few consecutive cells of one column, and what a worker gets.

Column number = 2 * (number of the frequency) + (0 upward, 1 downward); step = 0, 1, ... in scan order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

__all__ = ["DIRECTIONS", "Answer", "Batch", "Cell", "Column", "Grid", "Shard", "Work"]

DIRECTIONS = ("up", "down")


@dataclass(frozen=True, kw_only=True)
class Cell:
    """What was found at one amplitude.

    Parameters
    ----------
    period : int
        Of the settled orbit in drive periods; 0 if none was found.
    impacts : int
        In one such period.
    cycles : int
        Drive periods spent.
    reason : str
        Why the computation failed, in one sentence; empty if it did not.
    state : bytes or None
        The end state, or after a failure the last one reached, as float64 little-endian.
    """

    period: int
    impacts: int
    cycles: int
    reason: str
    state: bytes | None = field(repr=False)


@dataclass(frozen=True, kw_only=True)
class Column:
    """One frequency [Hz] in one direction; `excesses` F/F_g - 1 in the order of the scan."""

    number: int
    frequency: float
    direction: str
    excesses: tuple[float, ...] = field(repr=False)


@dataclass(frozen=True, kw_only=True)
class Batch:
    """Cells `first_step` ... of a column, from `state` (None: from the steady motion)."""

    column: int
    frequency: float
    direction: str
    first_step: int
    excesses: tuple[float, ...]
    state: bytes | None = field(repr=False)


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The cells of a batch in its order, and the time that they took the worker [s]."""

    cells: list[Cell]
    seconds: float


Work = Callable[[Batch], Answer]
"""What a worker does; it and the batch can be pickled."""


@dataclass(frozen=True, kw_only=True)
class Shard:
    """Part `number` of `count`: the chains number - 1, number - 1 + count, ... of a sweep.

    Neighbouring frequencies cost about the same, so that parts made in this way take equally long.
    """

    number: int = 1
    count: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.count:
            raise ValueError(f"shard is {self.number}/{self.count}; it must be k/n with 1 <= k <= n")

    @staticmethod
    def of_text(text: str) -> Shard:
        """From k/n."""
        number, slash, count = text.partition("/")
        if not (slash and number.isdecimal() and count.isdecimal()):
            raise ValueError(f"shard is {text!r}; it must be k/n with whole numbers, for instance 2/8")
        return Shard(number=int(number), count=int(count))

    @property
    def name(self) -> str:
        """For file names; empty for the whole."""
        return "" if self.count == 1 else f"-{self.number}-of-{self.count}"


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Every frequency [Hz] with every excess [1], both in rising order, each scanned up and then down."""

    frequencies: tuple[float, ...] = field(repr=False)
    excesses: tuple[float, ...] = field(repr=False)

    def __post_init__(self) -> None:
        for name in ("frequencies", "excesses"):
            values = getattr(self, name)
            if not values or any(a >= b for a, b in pairwise(values)):
                raise ValueError(f"{name} of a grid must be at least one number, in rising order")

    def chain(self, number: int) -> tuple[Column, ...]:
        """The columns at the frequency with this number, in the order in which they are to be scanned."""
        return tuple(
            Column(
                number=2 * number + k,
                frequency=self.frequencies[number],
                direction=way,
                excesses=self.excesses if way == "up" else self.excesses[::-1],
            )
            for k, way in enumerate(DIRECTIONS)
        )

    def chains(self, shard: Shard) -> Iterator[tuple[Column, ...]]:
        """The chains of a shard, one after the other."""
        for number in range(shard.number - 1, len(self.frequencies), shard.count):
            yield self.chain(number)

    def cells(self, shard: Shard) -> int:
        """How many cells a shard has."""
        chains = len(range(shard.number - 1, len(self.frequencies), shard.count))
        return chains * len(DIRECTIONS) * len(self.excesses)
