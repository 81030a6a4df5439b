"""The worker of a sweep: a batch of a column as numbers for ``settled_column``, its answer as cells.

State of a cell: q, q' of all modes, regime, wait and rebound (``contact.trajectory.State``), float64, shape
(2 n_modes + 3,), at a strobe.  An amplitude that fails is a cell with the reason, and the next one goes on
from the last state that was reached.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contact.event_loop import DONE, STATE
from contact.exact_run import failure
from contact.flight.modal_flow import tip_state
from contact.orbits.settling import TOLERANCE
from contact.oscillator import ImpactOscillator
from contact.strobed_motion import strobed_system
from contact.stroboscope import StroboscopicMap
from studies.instruments.sweep.settled_column import (
    BEHIND,
    EXTRA,
    LARGEST_PERIOD,
    settled_column,
)
from studies.instruments.sweep.tasks import Answer, Batch, Cell

__all__ = ["ColumnScan"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ColumnScan:
    """What a worker does with a batch of any column of one oscillator.

    Parameters
    ----------
    oscillator : ImpactOscillator
        A driven one; its own frequency and amplitude do not matter.
    most_cycles : int
        Bound of the drive periods at one amplitude.
    """

    oscillator: ImpactOscillator
    most_cycles: int

    def __post_init__(self) -> None:
        if self.most_cycles < 2 * LARGEST_PERIOD:
            raise ValueError(
                f"most_cycles is {self.most_cycles} drive periods; a period of up to {LARGEST_PERIOD} takes "
                f"at least {2 * LARGEST_PERIOD} to be seen"
            )

    @cached_property
    def _size(self) -> int:
        return 2 * self.oscillator.n_modes

    def at_frequency(self, frequency: float) -> ImpactOscillator:
        """The oscillator at grazing and drive `frequency` [Hz]."""
        assert self.oscillator.drive is not None
        drive = replace(self.oscillator.drive, frequency=frequency)
        return replace(self.oscillator, drive=drive).with_excess(0.0)

    def start(self, oscillator: ImpactOscillator, excess: float) -> np.ndarray:
        """The steady motion at `excess`, as a state."""
        steady = StroboscopicMap(oscillator=oscillator.with_excess(excess)).steady()
        return np.concatenate([steady.displacement, steady.velocity, np.zeros(EXTRA)])

    def __call__(self, batch: Batch) -> Answer:
        """The cells of a batch."""
        began = time.perf_counter()
        oscillator = self.at_frequency(batch.frequency)
        excesses = np.array(batch.excesses, dtype=float)
        system = strobed_system(oscillator)
        if batch.state is None:
            state = self.start(oscillator, float(excesses[0]))
        else:
            state = np.frombuffer(batch.state, dtype="<f8").astype(float)
        cells: list[Cell] = []
        while len(cells) < excesses.size:
            rest = 1.0 + excesses[len(cells) :]
            ends = np.empty((rest.size, self._size + EXTRA))
            found, place = np.zeros((rest.size, 3), dtype=np.int64), np.empty(self._size + 2)
            done, status = settled_column(
                system, rest, state, self.most_cycles, TOLERANCE * oscillator.stop.gap, ends, found, place
            )
            for (period, impacts, cycles), end in zip(
                found[:done].tolist(), ends[:done].astype("<f8"), strict=True
            ):
                cells.append(
                    Cell(period=period, impacts=impacts, cycles=cycles, reason="", state=end.tobytes())
                )
            if status != DONE:
                excess = float(excesses[len(cells)])
                reason = self._reason(oscillator, excess, status, place)
                # the next amplitude goes on from the last state that was reached
                reached = state.astype("<f8").tobytes()
                cells.append(Cell(period=0, impacts=0, cycles=int(place[-2]), reason=reason, state=reached))
        return Answer(cells=cells, seconds=time.perf_counter() - began)

    def _reason(
        self, oscillator: ImpactOscillator, excess: float, status: int, place: np.ndarray
    ) -> str:
        """One sentence for an amplitude that failed."""
        motion = oscillator.with_excess(excess).motion()
        n = oscillator.n_modes
        u, v = place[:n].copy(), place[n : 2 * n].copy()
        if status == BEHIND:
            height = tip_state(motion, 0.0, u, v)[0]
            return f"the amplitude before left the tip {height:.3g} m behind the stop"
        runs = np.zeros(1, dtype=STATE)
        runs["period"], runs["clock"] = place[2 * n], place[2 * n + 1]
        error = failure(status, motion, runs, u, v)
        return f"{type(error).__name__}: {error}"
