"""One drive period as a map: State -> State.

Sampling a driven oscillator at the strobe times t_n = n/f turns its motion into the iteration of a map; its
periodic orbits are the p_m orbits of the letter (1996, Fig. 2).  ``StroboscopicMap`` is that map for any
impact oscillator; ``contact.strobed_nordmark.StrobedNordmarkMap`` offers the same three methods, so that
everything which scans, settles or classifies orbits takes either.

One mode under Newton's law has a loop of its own (``contact.integrators.single_mode_loop``), which proves
most periods free without a sine, and for many orbits at once ``contact.integrators.orbit_lanes``; their
strobes agree with those of the general loop within rounding.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np

from beam.parameters import require_kind, require_whole
from contact.drive import split_time
from contact.errors import ContactError
from contact.flight import Motion, steady_motion
from contact.impact_log import INTEGERS, LOG_FIELDS, REBOUND, REGIME, WAIT
from contact.integrators.event_loop import DONE, advance
from contact.integrators.exact_run import deviations, failure
from contact.integrators.orbit_batch import Lane, carried_orbits
from contact.integrators.orbit_lanes import LANES
from contact.integrators.single_mode_loop import strobed_motion
from contact.integrators.strobe_nodes import StrobeNodes, nodes_of
from contact.integrators.struck_period import LoopNumbers, loop_numbers
from contact.laws import NEWTON
from contact.oscillator import ImpactOscillator
from contact.series import OUTSIDE
from contact.trajectory import State

__all__ = ["StrobedMap", "StrobedOrbit", "StroboscopicMap", "strobed_orbits"]

S = TypeVar("S")


@dataclass(frozen=True, kw_only=True, eq=False)
class StrobedOrbit(Generic[S]):
    """A stretch of a strobed motion.

    Parameters
    ----------
    end : State
        Where it ended.
    points : ndarray, shape (n_strobes, n_coordinates)
        Coordinates at the strobes, all in the same unit, the start excluded.
    impacts : ndarray of int, shape (n_strobes,)
        Impacts since the strobe before.
    """

    end: S
    points: np.ndarray
    impacts: np.ndarray


class StrobedMap(Protocol[S]):
    """What a scan needs of a strobed or iterated system."""

    @property
    def scale(self) -> float:
        """The size of a coordinate at grazing, in the unit of `points`."""

    def at(self, excess: float) -> StrobedMap[S]:
        """The same system at another excess over grazing [1]."""

    def steady(self) -> S:
        """The orbit without impacts at a strobe; above grazing, what it would be without the stop."""

    def orbit(self, state: S, count: int) -> StrobedOrbit[S]:
        """`count` periods from `state`."""


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
        q, v = steady_motion(self.oscillator.motion(), np.zeros(1))
        return State(displacement=q[0], velocity=v[0])

    def tip(self, points: np.ndarray) -> np.ndarray:
        """Tip displacement of strobed `points`, shape (n_strobes,) [m]."""
        return points[:, : self.oscillator.n_modes] @ (self.oscillator.model.phi / self._weight())

    def readout(self, points: np.ndarray, name: str) -> np.ndarray:
        """The read-out quantity `name` of the model at strobed `points`, shape (n_strobes,)."""
        readouts = self.oscillator.model.readouts
        if name not in readouts:
            raise ValueError(f"name is {name!r}; the model has the read-out points {sorted(readouts)}")
        return points[:, : self.oscillator.n_modes] @ (readouts[name] / self._weight())

    def _weight(self) -> np.ndarray:
        """phi, with its largest value for modes whose node is the tip [kg^-0.5]."""
        phi = self.oscillator.model.phi
        return np.where(phi != 0, phi, np.abs(phi).max())

    @cached_property
    def _motion(self) -> Motion:
        """The numbers of the oscillator, made once for many short orbits."""
        return self.oscillator.motion()

    @cached_property
    def _nodes(self) -> StrobeNodes | None:
        """What the loop of one mode under Newton's law needs; None for everything else."""
        return nodes_of(self._motion) if self._motion.law == NEWTON else None

    @cached_property
    def _numbers(self) -> LoopNumbers:
        """The same as plain numbers, for orbits side by side."""
        found: LoopNumbers = loop_numbers(self._motion, self._nodes)
        return found

    @cached_property
    def _mean(self) -> np.ndarray:
        """Displacement and velocity of the steady motion at a strobe, shape (2 n_modes,)."""
        q, q_rate = steady_motion(self._motion, np.zeros(1))
        return np.concatenate([q[0], q_rate[0]])

    @cached_property
    def _weights(self) -> np.ndarray:
        """What turns displacements and velocities into `points`, shape (2 n_modes,)."""
        motion = self._motion
        speed = np.where(motion.omega > 0, motion.omega, motion.drive)
        return np.concatenate([self._weight(), self._weight() / speed])

    def step(self, state: State) -> State:
        """One drive period."""
        return self.orbit(state, 1).end

    def orbit(self, state: State, count: int) -> StrobedOrbit[State]:
        """`count` drive periods from `state`, which must lie at a strobe.

        Returns
        -------
        StrobedOrbit
            Its points are the contributions phi_k q_k and phi_k q_k' / omega_k of all modes to the tip
            motion, shape (count, 2 n_modes) [m] (a mode of zero frequency counts with phi_k q_k' / (2 pi f),
            one with its node at the tip with the largest phi); `tip` and `readout` turn them into
            displacements.

        Raises
        ------
        ValueError
            If the state is not at a strobe.
        ContactError
            If the motion could not be followed.
        """
        require_kind("state", state, State, "a State")
        count = require_whole("count", count, "drive periods", low=0)
        motion, nodes = self._motion, self._nodes
        first, (u, v, integers, floats) = self._strobe_of(state), self._start(state)
        n = motion.omega.size
        points, counts = np.empty((count, 2 * n)), np.empty(count, dtype=np.int64)
        if nodes is not None:
            status, reached, _searched, _left = strobed_motion(
                motion, nodes, self._numbers, u, v, integers, floats, first, count, self._mean, self._weights,
                points, counts,
            )
        else:
            status, reached = advance(
                motion, u, v, integers, floats, first, count, 0.0, points, counts, np.empty((0, LOG_FIELDS)),
                np.empty((0, 4 * n)), np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 2 * n)),
            )
            points += self._mean
            points *= self._weights
        if status != DONE:
            raise failure(status, motion, reached, floats, u, v)
        return StrobedOrbit(
            end=self._end(first + count, u, v, integers, floats), points=points, impacts=counts
        )

    def _strobe_of(self, state: State) -> int:
        """The number of the strobe at which `state` lies."""
        near = round(state.time / self._motion.period)
        if near * self._motion.period == state.time:
            return near
        index, clock = split_time(np.array([state.time]), self._motion.period)
        if clock[0] != 0.0:
            raise ValueError(f"time of the state is {state.time} s; it must be a strobe time n/f")
        return int(index[0])

    def _start(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Deviations and bookkeeping of a start; see `deviations`."""
        if self._nodes is None or state.regime != OUTSIDE or state.displacement.size != 1:
            return deviations(self._motion, state, 0.0)
        # nothing can be wrong with a single mode before the stop
        u, v = state.displacement - self._mean[:1], state.velocity - self._mean[1:]
        if not self._nodes.level[0] + self._nodes.from_u[0] * u[0] <= 0.0:
            return deviations(self._motion, state, 0.0)
        return u, v, np.zeros(INTEGERS, dtype=np.int64), np.array([0.0, 0.0, 0.0, state.wait, state.rebound])

    def _end(
        self, strobe: int, u: np.ndarray, v: np.ndarray, integers: np.ndarray, floats: np.ndarray
    ) -> State:
        """The state at a strobe."""
        n = u.size
        return State(
            displacement=u + self._mean[:n], velocity=v + self._mean[n:], time=strobe * self._motion.period,
            regime=int(integers[REGIME]), wait=float(floats[WAIT]), rebound=float(floats[REBOUND]),
        )


def strobed_orbits(
    maps: Sequence[StroboscopicMap], states: Sequence[State], count: int, *, workers: int | None = None
) -> list[StrobedOrbit[State]]:
    """`count` drive periods of many orbits, one in each map from its state, on `workers` threads.

    Every orbit is the same, bit for bit, as `orbit` alone makes it.  Orbits of one mode under Newton's law
    are carried side by side (``contact.integrators.orbit_lanes``), the others are a task each; the kernels
    release the interpreter lock, so that threads share the cores.  `workers` is the number of cores unless
    given.

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
    threads = workers or os.cpu_count() or 1
    fast = [i for i, strobed in enumerate(maps) if strobed._nodes is not None]
    size = max(1, min(LANES, -(-len(fast) // threads)))
    groups = [fast[i : i + size] for i in range(0, len(fast), size)]
    groups += [[i] for i, strobed in enumerate(maps) if strobed._nodes is None]
    found: dict[int, StrobedOrbit[State] | ContactError] = {}
    with ThreadPoolExecutor(max_workers=threads) as pool:
        answers = pool.map(lambda group: _together([(maps[i], states[i]) for i in group], count), groups)
        for group, orbits in zip(groups, answers, strict=True):
            found |= dict(zip(group, orbits, strict=True))
    ordered = []
    for i in range(len(maps)):
        orbit = found[i]
        if isinstance(orbit, ContactError):
            raise orbit
        ordered.append(orbit)
    return ordered


def _together(
    pairs: Sequence[tuple[StroboscopicMap, State]], count: int
) -> list[StrobedOrbit[State] | ContactError]:
    """The orbits of one task, or why they failed."""
    if len(pairs) == 1:
        strobed, state = pairs[0]
        try:
            return [strobed.orbit(state, count)]
        except ContactError as error:
            return [error]
    lanes = []
    for strobed, state in pairs:
        assert strobed._nodes is not None
        u, v, integers, floats = strobed._start(state)
        lanes.append(
            Lane(
                motion=strobed._motion, nodes=strobed._nodes, numbers=strobed._numbers, mean=strobed._mean,
                weight=strobed._weights, u=u, v=v, integers=integers, floats=floats,
                first=strobed._strobe_of(state),
            )
        )  # fmt: skip
    points, counts = carried_orbits(lanes, count)
    found: list[StrobedOrbit[State] | ContactError] = []
    for i, ((strobed, _state), lane) in enumerate(zip(pairs, lanes, strict=True)):
        if lane.status != DONE:
            found.append(failure(lane.status, lane.motion, lane.reached, lane.floats, lane.u, lane.v))
            continue
        end = strobed._end(lane.first + count, lane.u, lane.v, lane.integers, lane.floats)
        found.append(StrobedOrbit(end=end, points=points[i], impacts=counts[i]))
    return found
