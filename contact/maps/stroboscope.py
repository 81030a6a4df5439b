"""The period map of an impact oscillator, State -> State; see ``contact.maps.protocol``."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import record, require, require_array, require_whole
from contact.engine.event_loop import DONE
from contact.engine.start import failure, start_of, state_of
from contact.errors import UnresolvedCrossing
from contact.flight.clock import split_time
from contact.maps.protocol import Jacobians, StrobedOrbit, amplitude_factors
from contact.maps.protocol import StrobedMap as StrobedMap
from contact.maps.strobed_motion import StrobedSystem, strobed_motion, strobed_system
from contact.oscillator import ImpactOscillator, require_one_stop
from contact.sensitivity.change import Sensitivities
from contact.sensitivity.replay import Replay
from contact.simulation import require_state, simulate
from contact.state import Regime, State

LONGER = (0, 1, 3, 7, 15, 31, 63)
"""Drive periods by which a motion that ends in contact is prolonged; a contact lasts less than a period."""


@record
class StroboscopicMap:
    """The map of an impact oscillator from one strobe to the next, exact within rounding.

    Strobes are the times n/f of the drive.  States are ``contact.State`` objects at such times.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven oscillator with one stop, at the tip and on its positive side.

    Raises
    ------
    TypeError
        If `oscillator` is no ImpactOscillator.
    ValueError
        If the oscillator has several stops, or one elsewhere.

    See Also
    --------
    NordmarkMap : The letter's two-dimensional map.
    simulate : A motion with every impact.
    contact.orbits.settle : Follow a motion until it is periodic.
    contact.orbits.orbit_diagram : Scan the drive amplitude.

    Examples
    --------
    Just above grazing the motion settles on one impact in five drive periods.

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=22.2))
    >>> strobed = StroboscopicMap(oscillator=oscillator)
    >>> orbit = strobed.at(1e-3).orbit(strobed.at(-1e-3).steady(), 500)
    >>> orbit.impacts[-10:]
    array([0, 0, 1, 0, 0, 0, 0, 1, 0, 0])
    """

    oscillator: ImpactOscillator

    def __post_init__(self) -> None:
        require_one_stop(self.oscillator, "a StroboscopicMap")

    @property
    def scale(self) -> float:
        """The gap [m]."""
        return self.oscillator.stop.gap

    @property
    def period(self) -> float:
        """The drive period [s]; ValueError without a drive."""
        return self.oscillator.driven.period

    def at(self, excess: float) -> StroboscopicMap:
        """The period map of the same oscillator, driven at F/F_g - 1 = `excess` [1]."""
        return StroboscopicMap(oscillator=self.oscillator.with_excess(excess))

    def steady(self) -> State:
        """The state of the steady motion at a strobe; below grazing it is the p1 orbit without impacts."""
        _ = self.oscillator.mean_height  # there is a steady motion
        mean, n = self._system.mean, self.oscillator.n_modes
        return State(displacement=mean[:n], velocity=mean[n:])

    def tip(self, points: np.ndarray) -> np.ndarray:
        """Tip displacement of strobed `points`, shape (n_strobes,) [m]."""
        return self.oscillator.tip(self._displacements(points))

    def readout(self, points: np.ndarray, name: str) -> np.ndarray:
        """The motion of the point `name` of the model at strobed `points`, shape (n_strobes,)."""
        known = self.oscillator.model.points
        require(name in known, "name", f"is {name!r}; the model has the points {sorted(known)}")
        return self._displacements(points) @ known[name].row

    def _displacements(self, points: np.ndarray) -> np.ndarray:
        """The modal displacements of strobed `points`, shape (n_strobes, n_modes)."""
        n, given = self.oscillator.n_modes, require_array("points", points, "m", dimensions=2)
        require(given.shape[1] == 2 * n, f"points has shape {given.shape}; it must have {2 * n} columns")
        return given[:, :n] / self._system.weight[:n]

    def coordinates(self, state: State) -> np.ndarray:
        """phi_k q_k and phi_k q_k'/omega_k of a state, as in the points of an orbit [m]."""
        require_state(self.oscillator, state)
        return self._system.weight * np.concatenate([state.displacement, state.velocity])

    @cached_property
    def _system(self) -> StrobedSystem:
        """The numbers of the oscillator, made once for many short orbits."""
        return strobed_system(self.oscillator)

    def orbit(self, state: State, count: int, *, factors: ArrayLike | None = None) -> StrobedOrbit[State]:
        """`count` drive periods from `state`, which must lie at a strobe.

        With `factors`, one for each period, each period has the amplitude of the oscillator times its factor.
        The amplitude changes at strobes, where the physical state is continuous.

        The points, shape (count, 2 n_modes) [m], are the contributions phi_k q_k and phi_k q_k' / omega_k of
        all modes to the tip motion (``contact.maps.strobed_motion``); `tip` and `readout` give displacements.

        Raises ValueError for a state that is not at a strobe and for factors that are not above zero, and
        ContactError for a motion that could not be followed.
        """
        require_state(self.oscillator, state)
        count = require_whole("count", count, "drive periods", low=0)
        changing = amplitude_factors(factors, count)
        system, numbers, n = self._system, self._system.numbers, self.oscillator.n_modes
        index = round(state.time / numbers.period)
        if index * numbers.period != state.time:  # within rounding it may be a strobe nevertheless
            index, clock = (x.item() for x in split_time(state.time, numbers.period))
            require(clock == 0.0, f"time of the state is {state.time} s; it must be a strobe time n/f")
        u, v, runs = start_of(numbers, state, index, 0.0, steady=(system.mean[:n], system.mean[n:]))
        points, impacts = np.empty((count, 2 * n)), np.empty(count, dtype=np.int64)
        status = strobed_motion(system.table, system, changing, u, v, runs, points, impacts)
        if status != DONE:
            if changing.size:
                amplitude = self.oscillator.driven.amplitude * changing[int(runs[0]["stretch"]) - index]
                numbers = self.oscillator.with_amplitude(float(amplitude)).numbers()
            raise failure(status, numbers, runs, u, v)
        end = state_of(numbers, runs, u + system.mean[:n], v + system.mean[n:])
        return StrobedOrbit(end=end, points=points, impacts=impacts)

    def jacobians(self, state: State, count: int) -> Jacobians[State]:
        """Derivatives of the points along `count` drive periods from `state`, and the state at the end.

        A strobe that falls into a contact is passed over: the next derivative then spans several periods.  If
        the last strobe does, the orbit goes on to the next one off the wall, or ends before it.

        A rest on the stop forgets two directions, and an impact without rebound forgets one.  The derivative
        is then returned as several factors; all but the last one span 0 periods.

        Raises ValueError for a state in contact or not at a strobe, NoDerivative if the motion grazes the
        stop, and UnresolvedCrossing if it ends at rest on the stop or is in contact at every strobe.
        """
        count = require_whole("count", count, "drive periods")
        free = require_state(self.oscillator, state).regime == Regime.OUTSIDE
        require(free, "state is in contact; start from a strobe at which the tip is off the wall")
        self.orbit(state, 0)  # which refuses a state that is not at a strobe
        period, n, weight = self._system.numbers.period, self.oscillator.n_modes, self._system.weight
        for more in LONGER:
            trajectory = simulate(self.oscillator, replace(state, time=0.0), periods=count + more)
            replay = Replay(Sensitivities(oscillator=self.oscillator), trajectory)
            strobes = [j for j in range(1, count + more + 1) if not replay.touching(j * period)]
            if strobes:
                strobes = strobes[: len(strobes) if more == 0 else 1]
                break
        else:
            raise UnresolvedCrossing(time=state.time)
        found, first = [], 0
        for last in strobes:
            replay.tangent, replay.factors = np.vstack([np.diag(1.0 / weight), np.zeros((2, 2 * n))]), []
            tangent = weight[:, None] * replay.to(last * period)[: 2 * n]
            found += [*((factor, 0) for factor in replay.factors), (tangent, last - first)]
            first = last
        q, v = trajectory.strobe_displacement[first - 1], trajectory.strobe_velocity[first - 1]
        return found, State(displacement=q, velocity=v)
