"""The touches of a motion as named arrays."""

from __future__ import annotations

import math
from dataclasses import field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from beam.parameters import require
from beam.record import record, rows_in_html
from contact.flight.clock import split_time
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import Numbers
from contact.oscillator import ImpactOscillator
from contact.state import ImpactKind
from contact.tables import dataframe, write_csv

if TYPE_CHECKING:
    from pandas import DataFrame

CSV = dict(stop="1", kind="1", together="1", start="s", end="s", approach="m/s", rebound="m/s", loss="J")
CSV |= dict(impulse="N s", peak_force="N")
"""Columns of a table of touches and their units."""


@record
class Impacts:
    """The touches of the tip, in the order in which they began.

    `Trajectory.impacts` holds them.  Times in seconds (`start`, `end`, `duration`) and modal states are made
    on demand from the parameters below.

    Parameters
    ----------
    oscillator : ImpactOscillator
        The oscillator that moved.
    stretch : ndarray of int, shape (n_impacts,)
        Number of the stretch, from strobe to strobe, in which a touch begins.
    clock, end_clock : ndarray, shape (n_impacts,)
        Times of first touch and release since the strobe that begins this stretch [s].  They are equal for
        an impact law; the second is NaN for a contact that had not ended.
    approach, rebound : ndarray, shape (n_impacts,)
        Velocities of the tip at first touch and at release, positive towards the stop [m/s].  The approach
        is NaN for a contact that had begun before the run.
    loss : ndarray, shape (n_impacts,)
        Energy that the tip has given to the stop [J].  In a contact that is still closed it includes the
        energy stored in the stop.  A stay has the energy of the hops before it.
    impulse : ndarray, shape (n_impacts,)
        Integral of the contact force over the touch, to the end of the run if it is still closed [N s].  A
        stay includes the impulse of the hops before it.
    peak_force : ndarray, shape (n_impacts,)
        Largest contact force in the touch, so far if it is still closed [N].  NaN if the law acts at once,
        without a force: an impact under Newton's law or a delayed rebound.  A stay has the largest force that
        holds the tip.  A method with a time step gives the largest force at its grid points.
    kind : ndarray of int, shape (n_impacts,)
        Values of `ImpactKind`.
    stop : ndarray of int, shape (n_impacts,)
        Numbers of the stops, from 0 on.
    together : ndarray of bool, shape (n_impacts,)
        Whether Newton's law gave this impulse for several stops together.  Other stops were then hit at the
        same instant, within rounding, or held a point at rest.
    deviations_start, deviations_end : ndarray, shape (n_impacts, 2, n_modes)
        Deviations (u, v) from the steady motion, just before the touch and just after the release.

    See Also
    --------
    Trajectory : The motion with these touches.
    collisions : Touches grouped by the approach of mode 1.
    ImpactKind : The kinds of touches.

    Notes
    -----
    A time is kept as the number of a stretch, from one strobe to the next, and the time since its strobe.  A
    state is kept as deviations u = q - q_s and v = q' - q_s' from the steady motion q_s of the oscillator.
    Both are right to rounding however long the run.

    Examples
    --------
    The first impact of the letter's spring, driven at 1 % above grazing from its steady motion:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop
    >>> from contact import before_collision, simulate
    >>> law = NewtonRestitution(local_restitution=0.1)
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=law),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... ).with_excess(0.01)
    >>> impacts = simulate(oscillator, before_collision(oscillator), periods=3).impacts
    >>> print(impacts.start.round(4), impacts.approach.round(3), impacts.rebound.round(4))
    [0.0561] [0.235] [-0.0235]
    """

    oscillator: ImpactOscillator = field(repr=False)
    stretch: np.ndarray
    clock: np.ndarray
    end_clock: np.ndarray
    approach: np.ndarray
    rebound: np.ndarray
    loss: np.ndarray
    impulse: np.ndarray
    peak_force: np.ndarray
    kind: np.ndarray
    stop: np.ndarray
    together: np.ndarray
    deviations_start: np.ndarray
    deviations_end: np.ndarray

    def __len__(self) -> int:
        return int(self.clock.size)

    @staticmethod
    def of_states(
        oscillator: ImpactOscillator, *, times: np.ndarray, states: np.ndarray, **columns: np.ndarray
    ) -> Impacts:
        """Return the touches that another program has found.

        `times` [s] has the shape (2, n_impacts), and the modal states (q, q') have (2, n_impacts, 2,
        n_modes): first the touches, then the releases.  `columns` are the arrays from approach to together
        of the list above.  By default impulse and peak force are NaN, `stop` is 0 and `together` false.
        """
        count = times.shape[1]
        unknown = dict.fromkeys(("impulse", "peak_force"), np.full(count, np.nan))
        unknown |= {"stop": np.zeros(count, dtype=np.int64), "together": np.zeros(count, dtype=bool)}
        given, valid = ", ".join(sorted(columns.keys() - unknown.keys())), "approach, kind, loss, rebound"
        require(given == valid, f"columns has {given or 'no entries'}; it must have {valid}")
        stretch, clock = split_time(times[0], oscillator.period)
        end_clock, numbers = times[1] - stretch * oscillator.period, oscillator.stacked()
        before, after = states - steady_states(numbers, np.array([clock, end_clock]) % numbers.period)
        return Impacts(
            oscillator=oscillator,
            stretch=stretch,
            clock=clock,
            end_clock=end_clock,
            deviations_start=before,
            deviations_end=after,
            **(unknown | columns),
        )

    def __repr__(self) -> str:
        """The number of touches, and their largest speed and force."""
        words = f"Impacts(touches={len(self)}"
        words += f", start={self.start[0]:.6g} to {self.start[-1]:.6g} s" if len(self) else ""
        for name, values in (("approach", self.approach), ("peak_force", self.peak_force)):
            known = values[np.isfinite(values)]
            words += f", {name}<={known.max():.6g} {CSV[name]}" if known.size else ""
        return f"{words})"

    def _repr_html_(self) -> str:
        """The first touches, a row each."""
        return rows_in_html(self._columns, CSV)

    @property
    def _columns(self) -> dict[str, np.ndarray]:
        """The columns of a table of touches."""
        kinds = np.array([kind.name for kind in ImpactKind])[self.kind]
        return {name: kinds if name == "kind" else getattr(self, name) for name in CSV}

    def to_csv(self, path: str | Path) -> None:
        """Write one line a touch; the first line names the columns and their units."""
        write_csv(path, self._columns, CSV)

    def to_dataframe(self) -> DataFrame:
        """Return a pandas.DataFrame with one row a touch, and the units in its ``attrs["units"]``.

        ImportError is raised if pandas is not installed.
        """
        return dataframe(self._columns, CSV)

    @cached_property
    def start(self) -> np.ndarray:
        """Times of the first touch [s], shape (n_impacts,)."""
        return self.stretch * self.oscillator.period + self.clock

    @cached_property
    def end(self) -> np.ndarray:
        """Times of the release [s], shape (n_impacts,)."""
        return self.stretch * self.oscillator.period + self.end_clock

    @cached_property
    def duration(self) -> np.ndarray:
        """Lengths of the touches [s], shape (n_impacts,): 0 under Newton's law, NaN for one still closed."""
        return self.end_clock - self.clock

    @cached_property
    def _steady(self) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
        """Steady displacements and velocities at `start`, and at `end`."""
        numbers, clocks = self.oscillator.stacked(), (self.clock, self.end_clock)
        return tuple(steady_motion(numbers, np.fmod(at, numbers.period)) for at in clocks)

    @cached_property
    def displacement_start(self) -> np.ndarray:
        """Modal displacements just before the touch [kg^(1/2) m], shape (n_impacts, n_modes)."""
        return self._steady[0][0] + self.deviations_start[:, 0]

    @cached_property
    def velocity_start(self) -> np.ndarray:
        """Modal velocities just before the touch [kg^(1/2) m/s], shape (n_impacts, n_modes)."""
        return self._steady[0][1] + self.deviations_start[:, 1]

    @cached_property
    def displacement_end(self) -> np.ndarray:
        """Modal displacements just after the release [kg^(1/2) m], shape (n_impacts, n_modes)."""
        return self._steady[1][0] + self.deviations_end[:, 0]

    @cached_property
    def velocity_end(self) -> np.ndarray:
        """Modal velocities just after the release [kg^(1/2) m/s], shape (n_impacts, n_modes)."""
        return self._steady[1][1] + self.deviations_end[:, 1]


def steady_states(numbers: Numbers, clock: float | np.ndarray) -> np.ndarray:
    """States (q_s, q_s') of the steady motion at times `clock` since a strobe, shape (..., 2, n_modes)."""
    return np.stack(steady_motion(numbers, clock), axis=-2)


def deviations(numbers: Numbers, time: float, q: np.ndarray, q_rate: np.ndarray) -> np.ndarray:
    """Deviations (u, v) of the modal state (q, q') from the steady motion at a time, shape (2, n_modes)."""
    return np.array([q, q_rate]) - steady_states(numbers, math.fmod(time, numbers.period))
