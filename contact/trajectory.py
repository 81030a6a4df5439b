"""States and motions as named arrays.

A modal state is a displacement q_k [m kg^0.5] and a velocity q_k' [m kg^0.5 / s] of each mode.
``ImpactOscillator.tip`` gives the displacement of the tip relative to the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
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
from contact.impacts import Impacts
from contact.oscillator import ImpactOscillator


class Regime(IntEnum):
    """How the stop acts on the tip.

    OUTSIDE: off the wall.  CONTACT: pushed by the wall.  INSIDE: behind the wall's rest position, without
    force.  SUSTAINED: held on the wall by the motion.  WAITING: on the wall, until a delayed rebound.
    """

    OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = range(5)


class ImpactKind(IntEnum):
    """Kind of a touch of the tip.

    IMPACT: a touch that acts on the motion.  GRAZE: a touch without effect, within rounding.  STAY: a stay on
    the wall after accumulated impacts, from the end of their last hop on.  UNDER_WAY: a contact that had
    begun before the run.
    """

    IMPACT, GRAZE, STAY, UNDER_WAY = range(4)


OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = map(int, Regime)
IMPACT, GRAZE, STAY, UNDER_WAY = map(int, ImpactKind)
"""The regimes and the kinds as plain integers, for the kernels."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Modal displacement and velocity of a spring at a time, and its contact with the stop.

    Parameters
    ----------
    displacement, velocity : ndarray, shape (n_modes,)
        Modal coordinates [m kg^0.5] and their rates [m kg^0.5 / s].
    time : float
        Time since the start of the drive, base at z = Z sin(2 pi f time) [s].
    regime : Regime, or tuple of Regime
        Of the stop `stop`, or of several stops that act at the same time, one for each.  A number from 0 to 4
        is taken too.
    wait, rebound : float
        While waiting, the time still to wait [s] and the tip velocity with which it then leaves [m/s].
    stop : int
        Number of the stop that acts, unless the regime is OUTSIDE.
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
        """The regime of each stop that is named."""
        return dict(enumerate(self.regime)) if isinstance(self.regime, tuple) else {self.stop: self.regime}

    @staticmethod
    def rest(n_modes: int) -> State:
        """The straight spring at rest, at time zero."""
        size = require_whole("n_modes", n_modes, "modes")
        return State(displacement=np.zeros(size), velocity=np.zeros(size))


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory:
    """A motion of an `oscillator`: strobed states, sampled states, every impact, and the state at the `end`.

    Parameters
    ----------
    strobe_time : ndarray, shape (n_strobes,)
        Times of the strobes passed, the start excluded [s].
    strobe_displacement, strobe_velocity : ndarray, shape (n_strobes, n_modes)
        Modal states at the strobes.
    strobe_impacts : ndarray of int, shape (n_strobes,)
        Impacts that began since the strobe before (or the start).
    time, displacement, velocity : ndarray, shapes (n_times,) and (n_times, n_modes)
        The requested times [s], and the states at them.
    impacts, evaluations : Impacts, int
        Every touch, also grazes and stays; and the steps, or flights and sampled positions, of the method.
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
        """Write the motion into a file of the kind that its name ends with.

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
        """The motion that `save` has written into an ``.npz`` file.

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
