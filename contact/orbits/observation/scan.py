"""Orbit diagrams: strobed points against drive amplitude, the physical state carried along.

The letter (1996) scans the excitation amplitude upwards and downwards in small steps, lets the spring settle
at each and records 40 strobe points.  Because the state is carried along, the scan shows hysteresis: the
spring stays on its orbit until that orbit ends.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from beam.parameters import require, require_array, require_kind, require_whole
from contact.errors import ContactError
from contact.maps.protocol import StrobedMap, require_map
from contact.orbits.observation.repetition import repeats_after
from contact.orbits.observation.settling import TOLERANCE, settle

S = TypeVar("S")


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitDiagram(Generic[S]):
    """A scan of the drive amplitude, in the order in which it was made.

    Parameters
    ----------
    excess : ndarray, shape (n_amplitudes,)
    points : ndarray, shape (n_amplitudes, record_cycles)
        The observed quantity at the strobes; NaN where the computation failed.
    m, impacts, cycles : ndarray of int, shape (n_amplitudes,)
        Period of the settled orbit (0: none), impacts in one such period, drive periods spent settling.
        Without a period, the impacts and the points are a sample of a motion that goes on changing.
    failures : tuple of str
        One sentence for each amplitude that failed.
    end : State
        The state after the last amplitude.
    """

    excess: np.ndarray
    points: np.ndarray
    m: np.ndarray
    impacts: np.ndarray
    cycles: np.ndarray
    failures: tuple[str, ...]
    end: S

    @property
    def kind(self) -> list[str]:
        """The state of each amplitude: "periodic", "not settled" (chaos or a long transient), "failed"."""
        words = np.where(self.m > 0, "periodic", "not settled")
        found: list[str] = np.where(np.isnan(self.points[:, 0]), "failed", words).tolist()
        return found


def orbit_diagram(
    strobed: StrobedMap[S],
    excesses: Sequence[float] | np.ndarray,
    state: S,
    *,
    observe: Callable[[np.ndarray], np.ndarray],
    settle_cycles: int,
    record_cycles: int = 40,
    largest_m: int = 64,
    early: bool = True,
) -> OrbitDiagram[S]:
    """Scan the amplitudes `excesses` in the given order, starting from `state`.

    Parameters
    ----------
    strobed : StrobedMap
        Its own amplitude does not matter.
    excesses : sequence of float
        F/F_g - 1 at each step.
    observe : callable
        Strobed points, shape (n, n_coordinates), to the quantity recorded, shape (n,).
    settle_cycles, record_cycles, largest_m : int
        Bound of the transient at each amplitude, strobe points recorded, and longest period looked for.
    early : bool
        End a transient as soon as the orbit is known (`settle`); otherwise every amplitude gets all
        `settle_cycles`.
    """
    require_map(strobed)
    values = require_array("excesses", excesses, "[1]", dimensions=1, words="a row of numbers")
    require(values.size > 0, "excesses is empty; it must hold one number or more [1]")
    require_whole("settle_cycles", settle_cycles, "drive periods", low=0)
    require_whole("record_cycles", record_cycles, "drive periods")
    require_whole("largest_m", largest_m, "drive periods")
    require_kind("observe", observe, Callable, "a function of strobed points")  # type: ignore[arg-type]
    points = np.full((values.size, record_cycles), np.nan)
    m, impacts, cycles = (np.zeros(values.size, dtype=np.int64) for _ in range(3))
    failures: list[str] = []
    for i, excess in enumerate(values):
        here = strobed.at(float(excess))
        try:
            if early:
                settled = settle(here, state, most_cycles=settle_cycles, largest_m=largest_m)
                state, cycles[i] = settled.end, settled.cycles
                m[i], impacts[i] = settled.m, settled.impacts
                recorded = here.orbit(state, record_cycles)
            else:
                state, cycles[i] = here.orbit(state, settle_cycles).end, settle_cycles
                recorded = here.orbit(state, max(record_cycles, 2 * largest_m))
                rows, hits, close = recorded.points, recorded.impacts, TOLERANCE * here.scale
                m[i] = repeats_after(rows, hits, largest_m=largest_m, tolerance=close)
                impacts[i] = hits[-m[i] :].sum()
            state = recorded.end
            shape, seen = (len(recorded.points),), observe(recorded.points)
            points[i] = require_array("observe(points)", seen, "its unit", shape=shape)[-record_cycles:]
        except ContactError as error:
            # the next amplitude goes on from the last state that was reached
            failures.append(f"excess {excess:.6g}: {error}")
    return OrbitDiagram(
        excess=values, points=points, m=m, impacts=impacts, cycles=cycles, failures=tuple(failures), end=state
    )
