"""States and motions as named arrays.

All arrays are in physical modal coordinates (not deviations): displacement q_k [m kg^0.5], velocity q_k'
[m kg^0.5 / s]; the tip displacement relative to the base is ``ImpactOscillator.tip`` of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from beam.parameters import InvalidValue, final, is_number, require_whole, require_within, shown
from contact.oscillator import ImpactOscillator


class Regime(IntEnum):
    """How the stop acts on the tip."""

    OUTSIDE = 0
    """Off the wall."""
    CONTACT = 1
    """Pushed by the wall."""
    INSIDE = 2
    """Behind the wall's rest position, without force."""
    SUSTAINED = 3
    """Held on the wall by the motion."""
    WAITING = 4
    """On the wall, waiting for a delayed rebound."""


class ImpactKind(IntEnum):
    """What a touch of the tip is."""

    IMPACT = 0
    """One that acts on the motion."""
    GRAZE = 1
    """One without effect, within rounding."""
    STAY = 2
    """A stay on the wall after accumulated impacts."""
    UNDER_WAY = 3
    """A contact that had begun before the run."""


OUTSIDE, CONTACT, INSIDE, SUSTAINED, WAITING = map(int, Regime)
IMPACT, GRAZE, STAY, UNDER_WAY = map(int, ImpactKind)
"""The same as plain integers, for the kernels."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Where a spring is: modal displacement and velocity at a time.

    Parameters
    ----------
    displacement, velocity : ndarray, shape (n_modes,)
        Modal coordinates [m kg^0.5] and their rates [m kg^0.5 / s].
    time : float
        Time since the start of the drive, base at z = Z sin(2 pi f time) [s].
    regime : Regime
        A number from 0 to 4 is taken too.
    wait, rebound : float
        While waiting, the time still to wait [s] and the tip velocity with which it then leaves [m/s].
    """

    displacement: np.ndarray
    velocity: np.ndarray
    time: float = 0.0
    regime: Regime | int = Regime.OUTSIDE
    wait: float = 0.0
    rebound: float = 0.0

    def __post_init__(self) -> None:
        for name in ("displacement", "velocity"):
            given = getattr(self, name)
            try:
                array = np.array(given, dtype=float)
            except (TypeError, ValueError):
                array = np.full(1, np.nan)
            if array.ndim != 1 or not array.size or not np.all(np.isfinite(array)):
                raise InvalidValue(
                    f"{name} of the state must be a finite array of shape (n_modes,), not {shown(given)}"
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if type(self.regime) is not Regime:
            if not (is_number(self.regime) and self.regime in (0, 1, 2, 3, 4)):
                raise InvalidValue(f"regime of the state is {shown(self.regime)}; it must be 0, 1, 2, 3 or 4")
            object.__setattr__(self, "regime", Regime(self.regime))
        for name, unit in (("time", "s"), ("wait", "s"), ("rebound", "m/s")):
            value = getattr(self, name)
            if type(value) is not float or not math.isfinite(value):  # the usual case without a call
                require_within(f"{name} of the state", value, unit)
        if self.displacement.shape != self.velocity.shape:
            raise InvalidValue(
                f"velocity of the state has shape {self.velocity.shape}; it must be that of the "
                f"displacement, {self.displacement.shape}"
            )

    @staticmethod
    def rest(n_modes: int) -> State:
        """The straight spring at rest, at time zero."""
        size = require_whole("n_modes", n_modes, "modes")
        return State(displacement=np.zeros(size), velocity=np.zeros(size))


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """From where to where, and what is wanted on the way.

    Parameters
    ----------
    start : State
    length : float
        Duration [s].
    first, last : int
        Numbers of the drive periods in which the run starts and ends.
    clock, clock_end : float
        Times since the strobes that begin them [s].
    times : ndarray, shape (n_times,)
        Times at which the state is wanted [s].
    sample_period, sample_clock : ndarray, shape (n_times,)
        The same as number of the drive period and time since its strobe [s].
    """

    start: State
    length: float
    first: int
    last: int
    clock: float
    clock_end: float
    times: np.ndarray
    sample_period: np.ndarray
    sample_clock: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class Impacts:
    """The touches of the tip, in the order in which they began.

    Arrays have shape (n_impacts,) or (n_impacts, n_modes).

    Parameters
    ----------
    start, end : ndarray
        First touch and release [s]; equal for an impact law, NaN for a contact that had not ended.
    period, clock, end_clock : ndarray
        Number of the drive period in which a touch begins, and both times since its strobe, to rounding
        however long the run [s].
    approach, rebound : ndarray
        Tip velocity at both, positive towards the wall [m/s]; an approach before the run is NaN.
    loss : ndarray
        Energy lost in the contact itself [J].
    kind : ndarray of int
        Values of `ImpactKind`.
    displacement_start, velocity_start, displacement_end, velocity_end : ndarray, shape (n_impacts, n_modes)
        Modal states just before the touch and just after the release.
    """

    start: np.ndarray
    end: np.ndarray
    period: np.ndarray
    clock: np.ndarray
    end_clock: np.ndarray
    approach: np.ndarray
    rebound: np.ndarray
    loss: np.ndarray
    kind: np.ndarray
    displacement_start: np.ndarray
    velocity_start: np.ndarray
    displacement_end: np.ndarray
    velocity_end: np.ndarray

    def __len__(self) -> int:
        return int(self.start.size)


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory:
    """A motion: strobed states, sampled states, and every impact.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The one that moves.
    end : State
        The state at the end of the run.
    strobe_time : ndarray, shape (n_strobes,)
        Times of the strobes passed, the start excluded [s].
    strobe_displacement, strobe_velocity : ndarray, shape (n_strobes, n_modes)
        Modal states there.
    strobe_impacts : ndarray of int, shape (n_strobes,)
        Impacts that began since the strobe before (or the start).
    time, displacement, velocity : ndarray, shapes (n_times,) and (n_times, n_modes)
        The states at the times that were asked for.
    impacts : Impacts
        Every touch.
    evaluations : int
        Steps, or flights and sampled positions, that the method has made.
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
