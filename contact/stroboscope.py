"""The period map of an impact oscillator, State -> State; see ``contact.strobed_map``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beam.parameters import require_kind, require_whole
from contact.drive import split_time
from contact.event_loop import DONE
from contact.exact_run import failure, start_of, state_of
from contact.oscillator import ImpactOscillator
from contact.strobed_map import StrobedMap, StrobedOrbit
from contact.strobed_motion import StrobedSystem, coordinate_weights, strobed_motion, strobed_system
from contact.trajectory import State

__all__ = ["StrobedMap", "StrobedOrbit", "StroboscopicMap", "strobed_orbits"]


@dataclass(frozen=True, kw_only=True, eq=False)
class StroboscopicMap:
    """The period map of an impact oscillator.

    Parameters
    ----------
    oscillator : ImpactOscillator
        A driven one.
    """

    oscillator: ImpactOscillator

    def __post_init__(self) -> None:
        require_kind("oscillator", self.oscillator, ImpactOscillator, "an ImpactOscillator")

    @property
    def scale(self) -> float:
        """The gap [m]."""
        return self.oscillator.stop.gap

    def at(self, excess: float) -> StroboscopicMap:
        """The period map of the same oscillator driven at F/F_g - 1 = `excess`."""
        return StroboscopicMap(oscillator=self.oscillator.with_excess(excess))

    def steady(self) -> State:
        """The steady motion at a strobe, which below grazing is the p1 orbit without impacts."""
        mean, n = self._system.mean, self.oscillator.n_modes
        return State(displacement=mean[:n], velocity=mean[n:])

    def tip(self, points: np.ndarray) -> np.ndarray:
        """Tip displacement of strobed `points`, shape (n_strobes,) [m]."""
        return self._sum(self.oscillator.model.phi, points)

    def readout(self, points: np.ndarray, name: str) -> np.ndarray:
        """The read-out quantity `name` of the model at strobed `points`, shape (n_strobes,)."""
        readouts = self.oscillator.model.readouts
        if name not in readouts:
            raise ValueError(f"name is {name!r}; the model has the read-out points {sorted(readouts)}")
        return self._sum(readouts[name], points)

    def _sum(self, weights: np.ndarray, points: np.ndarray) -> np.ndarray:
        """The sum of the modal displacements times `weights`."""
        n = self.oscillator.n_modes
        return points[:, :n] @ (weights / coordinate_weights(self.oscillator)[:n])

    @cached_property
    def _system(self) -> StrobedSystem:
        """The numbers of the oscillator, made once for many short orbits."""
        return strobed_system(self.oscillator)

    def step(self, state: State) -> State:
        """One drive period."""
        return self.orbit(state, 1).end

    def orbit(self, state: State, count: int) -> StrobedOrbit[State]:
        """`count` drive periods from `state`, which must lie at a strobe.

        Returns
        -------
        StrobedOrbit
            Its points, shape (count, 2 n_modes) [m], are the contributions phi_k q_k and phi_k q_k' / omega_k
            of all modes to the tip motion (see ``contact.strobed_motion``); `tip` and `readout` turn them
            into displacements.

        Raises
        ------
        ValueError
            If the state is not at a strobe.
        ContactError
            If the motion could not be followed.
        """
        require_kind("state", state, State, "a State")
        count = require_whole("count", count, "drive periods", low=0)
        system, motion, n = self._system, self._system.motion, self.oscillator.n_modes
        index, clock = split_time(np.array([state.time]), motion.period)
        if clock[0] != 0.0:
            raise ValueError(f"time of the state is {state.time} s; it must be a strobe time n/f")
        u, v, runs = start_of(motion, state, int(index[0]), 0.0)
        points, impacts = np.empty((count, 2 * n)), np.empty(count, dtype=np.int64)
        status = strobed_motion(system, u, v, runs, points, impacts)
        if status != DONE:
            raise failure(status, motion, runs, u, v)
        end = state_of(motion, runs, u + system.mean[:n], v + system.mean[n:])
        return StrobedOrbit(end=end, points=points, impacts=impacts)


def strobed_orbits(
    maps: Sequence[StroboscopicMap], states: Sequence[State], count: int, *, workers: int | None = None
) -> list[StrobedOrbit[State]]:
    """`count` drive periods of many orbits, one in each map from its state, on `workers` threads.

    Every orbit is the one that `orbit` makes; the kernels release the interpreter lock, so that threads share
    the cores.  `workers` is the number of cores unless given.

    Raises
    ------
    ValueError
        If there are not as many states as maps, or as `StroboscopicMap.orbit` does.
    ContactError
        Of the first orbit, in their order, that could not be followed.
    """
    if workers is not None:
        require_whole("workers", workers, "threads")
    if len(maps) != len(states):
        raise ValueError(f"states has {len(states)} entries; it must have one for each of {len(maps)} maps")
    with ThreadPoolExecutor(max_workers=workers or os.cpu_count() or 1) as pool:
        return list(pool.map(lambda strobed, state: strobed.orbit(state, count), maps, states))
