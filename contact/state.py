"""States of a motion, and the kinds of contact as named numbers.

A modal state is a displacement q_k [kg^(1/2) m] and a velocity q_k' [kg^(1/2) m/s] of each mode.
``ImpactOscillator.tip`` gives the displacement of the tip relative to the base.
"""

from __future__ import annotations

import math
from enum import IntEnum

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
