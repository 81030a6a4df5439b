"""States and motions as named arrays.

A modal state is a displacement q_k [kg^(1/2) m] and a velocity q_k' [kg^(1/2) m/s] of each mode.
``ImpactOscillator.tip`` gives the displacement of the tip relative to the base.
"""

from __future__ import annotations

import math
from dataclasses import field, fields
from enum import IntEnum
from pathlib import Path

import numpy as np

from beam.parameters import (
    InvalidValue,
    final,
    is_number,
    require,
    require_array,
    require_whole,
    require_within,
    shown,
)
from beam.record import record
from contact.impacts import Impacts
from contact.oscillator import ImpactOscillator


class Regime(IntEnum):
    """How the stop acts on the tip.

    Attributes
    ----------
    OUTSIDE : Regime
        0: the tip is off the wall.
    CONTACT : Regime
        1: the wall pushes the tip.
    INSIDE : Regime
        2: the tip is behind the wall's rest position, without force.
    SUSTAINED : Regime
        3: the motion holds the tip on the wall.
    WAITING : Regime
        4: the tip is on the wall until a delayed rebound.
    """

    OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = range(5)


class ImpactKind(IntEnum):
    """Kind of a touch of the tip.

    Attributes
    ----------
    IMPACT : ImpactKind
        0: a touch that acts on the motion.
    GRAZE : ImpactKind
        1: a touch without effect, within rounding.
    STAY : ImpactKind
        2: a stay on the wall after accumulated impacts, from the end of their last hop on.
    UNDER_WAY : ImpactKind
        3: a contact that had begun before the run.
    """

    IMPACT, GRAZE, STAY, UNDER_WAY = range(4)


OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = map(int, Regime)
IMPACT, GRAZE, STAY, UNDER_WAY = map(int, ImpactKind)
"""The regimes and the kinds as plain integers, for the kernels."""


@final
@record
class State:
    """Modal displacement and velocity of a spring at a time, and its contact with the stop.

    Parameters
    ----------
    displacement, velocity : array_like, shape (n_modes,)
        Modal coordinates [kg^(1/2) m] and their rates [kg^(1/2) m/s].
    time : float
        Time since the start of the drive, base at z = Z sin(2 pi f time) [s].
    regime : Regime, int or tuple of Regime
        Regime of the stop `stop`, or its number.  If several stops act at the same time, the regime of each
        stop of the oscillator.
    wait, rebound : float
        Time still to wait [s], and velocity with which the tip then leaves [m/s], in the regime WAITING.
    stop : int
        Number of the stop that acts, from 0 on; without a meaning if the regime is OUTSIDE.

    Raises
    ------
    ValueError
        If an array has another shape, a number is not finite, or a regime is unknown.
    TypeError
        If an entry is no number.

    See Also
    --------
    simulate : The motion from a state.
    Trajectory : A motion, with its state at the `end`.
    StroboscopicMap : The map from the state at one strobe to the next.

    Examples
    --------
    Two modes at rest; and a tip that passes its place of rest at 0.3 m/s, moved by mode 1 alone:

    >>> from contact import State
    >>> State.rest(2).displacement
    array([0., 0.])
    >>> phi = [4.0, 5.0]  # tip values of the modes [kg^(-1/2)], in a model `phi`
    >>> state = State(displacement=[0.0, 0.0], velocity=[0.3 / phi[0], 0.0])
    >>> state.velocity @ phi, state.time
    (np.float64(0.3), 0.0)
    """

    displacement: np.ndarray
    velocity: np.ndarray
    time: float = 0.0
    regime: Regime | int | tuple[int, ...] = Regime.OUTSIDE
    wait: float = 0.0
    rebound: float = 0.0
    stop: int = 0

    def __post_init__(self) -> None:
        shape, words = None, "a number for each mode"
        for name, unit in (("displacement", "m kg^0.5"), ("velocity", "m kg^0.5/s")):
            where, given = f"{name} of the state", getattr(self, name)
            array = require_array(where, given, unit, dimensions=1, shape=shape, words=words)
            object.__setattr__(self, name, array)
            require(array.size > 0, where, f"is []; it must be {words}")
            shape = array.shape
        if type(self.regime) is not Regime:
            several = isinstance(self.regime, tuple)
            given = self.regime if isinstance(self.regime, tuple) else (self.regime,)
            if not all(is_number(each) and each in (0, 1, 2, 3, 4) for each in given):
                raise InvalidValue(f"regime of the state is {shown(self.regime)}; it must be 0, 1, 2, 3 or 4")
            regimes = tuple(Regime(each) for each in given)
            object.__setattr__(self, "regime", regimes if several else regimes[0])
        for name, unit in (("time", "s"), ("wait", "s"), ("rebound", "m/s")):
            value = getattr(self, name)
            if type(value) is not float or not math.isfinite(value):  # the usual case without a call
                require_within(f"{name} of the state", value, unit)
        if self.stop != 0:
            require_whole("stop of the state", self.stop, "[1], the number of a stop", low=0)

    @property
    def regimes(self) -> dict[int, int]:
        """Regime of each stop that is named, by the number of the stop."""
        return dict(enumerate(self.regime)) if isinstance(self.regime, tuple) else {self.stop: self.regime}

    @staticmethod
    def rest(n_modes: int) -> State:
        """Return the state of the straight spring at rest, at time zero."""
        size = require_whole("n_modes", n_modes, "modes")
        return State(displacement=np.zeros(size), velocity=np.zeros(size))


@record
class Trajectory:
    """A motion of an oscillator: strobed states, sampled states, every impact, and the state at the end.

    `simulate` returns it.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The oscillator that moved.
    end : State
        State at the end of the run; a further run can start from it.
    strobe_time : ndarray, shape (n_strobes,)
        Times of the strobes passed, the start excluded [s].
    strobe_displacement, strobe_velocity : ndarray, shape (n_strobes, n_modes)
        Modal coordinates [kg^(1/2) m] and their rates [kg^(1/2) m/s] at the strobes.
    strobe_impacts : ndarray of int, shape (n_strobes,)
        Number of impacts that began since the strobe before, or since the start.
    time : ndarray, shape (n_times,)
        Requested times [s].
    displacement, velocity : ndarray, shape (n_times, n_modes)
        Modal coordinates [kg^(1/2) m] and their rates [kg^(1/2) m/s] at these times.
    impacts : Impacts
        All touches, also grazes and stays.
    evaluations : int
        Number of steps of the method, or of its flights and sampled positions.

    See Also
    --------
    simulate : The function that returns a trajectory.
    Impacts : The touches of a motion.
    collisions : The effect of each collision on mode 1.
    ImpactOscillator.tip : The displacement or velocity of the tip.

    Examples
    --------
    The tip displacement of the letter's spring at two times, and the number of its impacts:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate
    >>> law = NewtonRestitution(local_restitution=0.1)
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=law),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... ).with_excess(0.01)
    >>> trajectory = simulate(oscillator, periods=10, times=[0.1, 0.2])
    >>> tip = oscillator.tip(trajectory.displacement)
    >>> print((1e3 * tip).round(2), "mm,", len(trajectory.impacts), "impacts")
    [7.62 4.5 ] mm, 3 impacts
    """

    oscillator: ImpactOscillator
    end: State
    strobe_time: np.ndarray
    strobe_displacement: np.ndarray
    strobe_velocity: np.ndarray
    strobe_impacts: np.ndarray
    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    impacts: Impacts = field(repr=False)
    evaluations: int = 0

    def save(self, path: str | Path) -> None:
        """Write the motion into a file, ``.npz`` or ``.csv`` by the end of its name.

        ``.npz`` keeps every number, for `load`; ``.csv`` has one line a touch, for other programs.
        ValueError is raised for another ending.
        """
        if str(path).endswith(".csv"):
            self.impacts.write_csv(path)
            return
        require(str(path).endswith(".npz"), "path", f"is {shown(str(path))}; it must end with .npz or .csv")
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= {f"impacts_{name}": getattr(self.impacts, name) for name in _COLUMNS}
        arrays |= {f"end_{name}": np.asarray(getattr(self.end, name)) for name in _STATE}
        np.savez_compressed(path, numbers=_fingerprint(self.oscillator), **arrays)

    @staticmethod
    def load(path: str | Path, oscillator: ImpactOscillator) -> Trajectory:
        """Return the motion that `save` has written into an ``.npz`` file.

        The file does not keep the oscillator, since a law may hold functions.  ValueError is raised if
        `oscillator` has other numbers than the one that moved, or if the file holds no such motion.
        """
        with np.load(path, allow_pickle=False) as file:
            known = {"numbers", *_ARRAYS, *(f"impacts_{x}" for x in _COLUMNS), *(f"end_{x}" for x in _STATE)}
            words = "it must be a motion that Trajectory.save has written"
            require(set(file.files) == known, "path", f"is {shown(str(path))}, {words}")
            same = np.array_equal(file["numbers"], _fingerprint(oscillator))
            require(same, "oscillator", f"has other numbers than the one that moved in {shown(str(path))}")
            end = {name: file[f"end_{name}"] for name in _STATE}
            values = {name: value if value.ndim else value.item() for name, value in end.items()}
            values["regime"] = tuple(end["regime"].tolist()) if end["regime"].ndim else values["regime"]
            columns = {name: file[f"impacts_{name}"] for name in _COLUMNS}
            arrays = {name: file[name] if file[name].ndim else file[name].item() for name in _ARRAYS}
        impacts = Impacts(oscillator=oscillator, **columns)
        return Trajectory(oscillator=oscillator, end=State(**values), impacts=impacts, **arrays)


_ARRAYS, _COLUMNS, _STATE = (
    tuple(one.name for one in fields(kind) if one.name not in ("oscillator", "end", "impacts"))
    for kind in (Trajectory, Impacts, State)
)
"""What a file of a motion holds: the arrays of it, of its touches and of its end."""


def _fingerprint(oscillator: ImpactOscillator) -> np.ndarray:
    """All numbers of an oscillator in one row."""
    return np.concatenate([np.ravel(part) for part in oscillator.stacked()]).astype(float)
