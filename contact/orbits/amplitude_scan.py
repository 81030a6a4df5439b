"""One column of a chart: the amplitude raised and lowered again at one drive frequency, in a compiled loop.

    column = AmplitudeScan(oscillator=oscillator, most_cycles=1024)(frequency=22.2, excesses=excesses)
    column.period[0], column.period[1]        # upward and downward scan, over the excesses in rising order

The physical state is carried from amplitude to amplitude, and from the end of the upward scan into the
downward one (``settled_column`` says when a motion is settled). An amplitude that fails is marked with its
reason, and the next one goes on from the last state that was reached.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import require_array
from contact.event_loop import DONE, STATE
from contact.exact_run import failure
from contact.flight.modal_flow import tip_state
from contact.orbits.settled_column import BEHIND, EXTRA, LARGEST_PERIOD, settled_column
from contact.orbits.settling import TOLERANCE
from contact.oscillator import ImpactOscillator
from contact.strobed_motion import strobed_system
from contact.stroboscope import StroboscopicMap

__all__ = ["AmplitudeScan", "ScannedColumn"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ScannedColumn:
    """What was found, all of shape (2, n_excesses): upward scan first, excesses rising in both.

    Parameters
    ----------
    period : ndarray of int
        Of the settled orbit in drive periods; 0 if none was found, -1 where the computation failed.
    impacts, cycles : ndarray of int
        Impacts in one such period; drive periods spent; -1 where the computation failed.
    reason : ndarray of str
        Why the computation failed; empty if it did not.
    """

    period: NDArray[np.int64]
    impacts: NDArray[np.int64]
    cycles: NDArray[np.int64]
    reason: NDArray[np.str_]


@dataclass(frozen=True, kw_only=True, eq=False)
class AmplitudeScan:
    """Scans of one oscillator, at any drive frequency.

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

    def at_frequency(self, frequency: float) -> ImpactOscillator:
        """The oscillator at grazing and drive `frequency` [Hz]."""
        assert self.oscillator.drive is not None
        drive = replace(self.oscillator.drive, frequency=frequency)
        return replace(self.oscillator, drive=drive).with_excess(0.0)

    def __call__(self, frequency: float, excesses: ArrayLike) -> ScannedColumn:
        """The column at drive `frequency` [Hz] over rising `excesses` F/F_g - 1 [1]."""
        rising = require_array("excesses", excesses, "[1]", dimensions=1, words="one row of rising numbers")
        if rising.size == 0 or not np.all(np.diff(rising) > 0.0):
            raise ValueError("excesses must be at least one number, in rising order")
        oscillator = self.at_frequency(frequency)
        steady = StroboscopicMap(oscillator=oscillator.with_excess(float(rising[0]))).steady()
        state = np.concatenate([steady.displacement, steady.velocity, np.zeros(EXTRA)])
        found = np.full((2, 3, rising.size), -1, dtype=np.int64)
        reasons = [[""] * rising.size, [""] * rising.size]
        for way in (0, 1):
            order = slice(None, None, 1 if way == 0 else -1)
            columns, told = self._scanned(oscillator, rising[order], state)
            found[way, :, order], reasons[way][order] = columns.T, told
        return ScannedColumn(
            period=found[:, 0], impacts=found[:, 1], cycles=found[:, 2], reason=np.array(reasons)
        )

    def _scanned(
        self, oscillator: ImpactOscillator, excesses: NDArray[np.float64], state: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], list[str]]:
        """Period, impacts and cycles, shape (n, 3), and reasons; `state` becomes the last one reached."""
        system, size = strobed_system(oscillator), 2 * oscillator.n_modes
        columns, reasons = np.full((excesses.size, 3), -1, dtype=np.int64), [""] * excesses.size
        at = 0
        while at < excesses.size:
            rest = 1.0 + excesses[at:]
            ends = np.empty((rest.size, size + EXTRA))
            found, place = np.zeros((rest.size, 3), dtype=np.int64), np.empty(size + 2)
            done, status = settled_column(
                system, rest, state, self.most_cycles, TOLERANCE * oscillator.stop.gap, ends, found, place
            )
            columns[at : at + done] = found[:done]
            at += done
            if status != DONE:
                # the next amplitude goes on from the last state that was reached
                reasons[at] = self._reason(oscillator, float(excesses[at]), status, place)
                at += 1
        return columns, reasons

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
