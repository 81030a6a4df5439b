r"""One column of a chart: the amplitude raised and lowered again at one drive frequency, in a compiled loop.

    column = AmplitudeScan(oscillator=oscillator, most_cycles=1024)(frequency=22.2, excesses=excesses)
    column.m[0], column.m[1]        # upward and downward scan, over the excesses in rising order

At each amplitude the motion starts from the last physical state (q, q') at the amplitude before.  It is
followed in blocks of `BLOCK` drive periods until it has settled
(``contact.orbits.observation.repetition``), at most for `most_cycles`:

- **No impact any more**: period 1 without impacts, and the state is set on the steady motion.
- **A periodic orbit** of period p <= L, to `TOLERANCE` of the gap, for L = 16, 32, 64 as soon as there are
  2 L strobes.  The next state follows from the last one alone, so that one repeated period is enough.
- **Nearly periodic at the bound.**  Next to a fold a motion approaches its orbit arbitrarily slowly.  After
  `most_cycles` a repetition `ROUGH` times as rough is accepted too; such cells have cycles >= most_cycles.
- Otherwise **period 0**: chaos, a period above 64, or a transient longer than `most_cycles`.  Its impacts are
  counted over the last 128 strobes.

The end of the upward scan starts the downward one.  An amplitude that fails is marked with its reason, and
the next one goes on from the last state that was reached.  The amplitude enters the motion linearly, so that
the loop scales the steady motion at grazing.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import InvalidValue, record, require_array, require_whole
from contact.engine.event_loop import DONE
from contact.engine.start import failure
from contact.flight.numbers import Numbers
from contact.flight.tip import tip_rounding, tip_state
from contact.machine.compiled import kernel
from contact.maps.strobed_motion import at_amplitude, strobed_motion, strobed_system
from contact.maps.stroboscope import StroboscopicMap
from contact.orbits.observation.repetition import free_for_good, repetition
from contact.orbits.observation.settling import TOLERANCE
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.state import OUTSIDE
from contact.touch.passage import STATE

LARGEST_M = 64  # longest period that is recognised
SHORTEST = 16  # strobes that have to repeat at least, twice the letter's common periods

ROUGH = 1e4
"""Tolerance at the bound over the usual one, i.e. 1e-5 of the gap.  After 512 drive periods an orbit of
period 3 whose multiplier is 0.97 still changes by 1e-6 per period."""

BLOCK = 32  # drive periods between two comparisons: the fewest that show a period, 2 SHORTEST
BEHIND = -1  # status of a state behind the stop, from the amplitude before, where no flight can start


@kernel
def settled_column(system, amplitudes, reached, most_cycles, tolerance, found, u, v, runs):
    """Settle at each of `amplitudes` in turn, or until one fails; return how many are done, and the status.

    The amplitudes count relative to that of grazing, to which `system` belongs, and `tolerance` of a
    repetition is in the unit of the coordinates [m].  Overwritten are `reached` by the last state that was
    reached, the modal one of shape (2 n_modes,) and its `STATE`; `found`, shape (n, 3), by period, impacts
    and drive periods spent; and `u`, `v` and `runs` (`STATE`) by deviations and run at a failure.
    """
    n, run, capacity, (state, touching) = system.numbers.size, runs[0], 2 * LARGEST_M, reached
    points, impacts = np.empty((capacity, 2 * n)), np.zeros(capacity, dtype=np.int64)
    as_is = np.empty(0)
    for a in range(amplitudes.size):
        local = at_amplitude(system, amplitudes[a])
        here, mean = local.numbers, local.mean.copy()
        local.mean[:] = 0.0  # the points are deviations
        u[:], v[:] = state[:n] - mean[:n], state[n:] - mean[n:]
        runs[0] = touching[0]
        run.contact_order, run.stretch, run.steps, run.clock = 0, 0, 0, 0.0
        run.memory0, run.memory1 = -1.0, -1.0
        rows, cycles, m, status = 0, 0, 0, DONE
        if run.regime == OUTSIDE and tip_state(here, 0.0, u, v)[0] > tip_rounding(here, u, v):
            status = BEHIND
        while status == DONE and m == 0:
            if run.regime == OUTSIDE and free_for_good(here, u, v):
                u[:], v[:] = 0.0, 0.0
                m, rows = 1, 0
            elif cycles >= most_cycles:
                m = repetition(points, impacts, rows, np.int64(LARGEST_M), ROUGH * tolerance)
                break
            else:
                if rows == capacity:
                    rows -= BLOCK
                    points[:rows], impacts[:rows] = points[BLOCK:], impacts[BLOCK:]
                new = slice(rows, rows + BLOCK)
                status = strobed_motion(local.table, local, as_is, u, v, runs, points[new], impacts[new])
                rows, cycles, strobes = rows + BLOCK, cycles + BLOCK, np.int64(SHORTEST)
                while status == DONE and m == 0 and 2 * strobes <= rows:
                    m = repetition(points, impacts, rows, strobes, tolerance)
                    strobes *= 2
        if status != DONE:
            return a, status
        state[:n], state[n:] = u + mean[:n], v + mean[n:]
        touching[0] = runs[0]
        hits = impacts[max(0, rows - m) if m > 0 else 0 : rows].sum()
        found[a, 0], found[a, 1], found[a, 2] = m, hits, cycles
    return amplitudes.size, DONE


@record
class ScannedColumn:
    """The results of a scan, all of shape (2, n_excesses): upward scan first, excesses rising in both.

    Parameters
    ----------
    m : ndarray of int
        Of the settled orbit in drive periods; 0 if none was found, -1 where the computation failed.
    impacts, cycles : ndarray of int
        Impacts in one such period; drive periods spent; -1 where the computation failed.
    reason : ndarray of str
        Why the computation failed; empty if it did not.
    """

    m: NDArray[np.int64]
    impacts: NDArray[np.int64]
    cycles: NDArray[np.int64]
    reason: NDArray[np.str_]


@record
class AmplitudeScan:
    """Upward and downward scans of the drive amplitude in a compiled loop.

    Call a scan with a drive frequency [Hz] and rising excesses F/F_g - 1 [1].  It returns the arrays `m`,
    `impacts`, `cycles` and `reason` of shape (2, n_excesses).  The upward scan comes first, and the excesses
    rise in both.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven oscillator with one stop; its own drive frequency and amplitude do not matter.
    most_cycles : int
        Bound of the drive periods at one amplitude, 128 or more.

    Raises
    ------
    TypeError
        If `oscillator` is no ImpactOscillator, or `most_cycles` is no number.
    ValueError
        If the oscillator has several stops or no drive, or `most_cycles` is no whole number of 128 or more.
    """

    oscillator: ImpactOscillator
    most_cycles: int

    def __post_init__(self) -> None:
        require_one_stop(self.oscillator, "a scan")
        _ = self.oscillator.driven
        why = f", to see a period of up to {LARGEST_M}"
        require_whole("most_cycles", self.most_cycles, "drive periods", low=2 * LARGEST_M, why=why)

    def __call__(self, frequency: float, excesses: ArrayLike) -> ScannedColumn:
        """The column at drive `frequency` [Hz] over rising `excesses` F/F_g - 1 [1]."""
        rising = require_array("excesses", excesses, "[1]", dimensions=1, words="one row of rising numbers")
        if rising.size == 0 or not np.all(np.diff(rising) > 0.0):
            raise InvalidValue("excesses must be at least one number, in rising order")
        drive, n = replace(self.oscillator.driven, frequency=frequency), self.oscillator.n_modes
        oscillator = replace(self.oscillator, drive=drive).with_excess(0.0)
        steady = StroboscopicMap(oscillator=oscillator).at(float(rising[0])).steady()
        reached = np.concatenate([steady.displacement, steady.velocity]), np.zeros(1, STATE)
        system, tolerance = strobed_system(oscillator), TOLERANCE * oscillator.stop.gap
        u, v, runs = np.empty(n), np.empty(n), np.zeros(1, STATE)
        path = np.concatenate([rising, rising[::-1]])
        found, reasons, at = np.full((path.size, 3), -1, dtype=np.int64), [""] * path.size, 0
        while at < path.size:
            done, status = settled_column(
                system, 1.0 + path[at:], reached, self.most_cycles, tolerance, found[at:], u, v, runs
            )
            at += done
            if status != DONE:
                # the next amplitude goes on from the last state that was reached
                numbers = oscillator.with_excess(float(path[at])).numbers()
                reasons[at], at = _reason(status, numbers, runs, u, v), at + 1
        m, impacts, cycles, reason = (
            np.array([every[: rising.size], every[: rising.size - 1 : -1]])
            for every in (*found.T, np.array(reasons))
        )
        return ScannedColumn(m=m, impacts=impacts, cycles=cycles, reason=reason)


def _reason(status: int, numbers: Numbers, runs: np.ndarray, u: np.ndarray, v: np.ndarray) -> str:
    """One sentence for an amplitude that failed."""
    if status == BEHIND:
        return f"the amplitude before left the tip {tip_state(numbers, 0.0, u, v)[0]:.3g} m behind the stop"
    error = failure(status, numbers, runs, u, v)
    return f"{type(error).__name__}: {error}"
