"""A motion as named arrays: strobed and sampled states, and every touch."""

from __future__ import annotations

from dataclasses import field, fields
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from beam.parameters import InvalidValue, record, require, shown
from contact import plots
from contact.impacts import Impacts
from contact.oscillator import ImpactOscillator
from contact.state import GRAZE, State
from contact.tables import dataframe, write_csv

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame

SAMPLES = {"time": "s", "tip": "m", "tip_velocity": "m/s"}
"""Columns of a table of samples, and their units."""


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
    >>> print((1e3 * trajectory.tip).round(2), "mm,", len(trajectory.impacts), "impacts")
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

    def __repr__(self) -> str:
        """How long it is, and what it holds."""
        counts = f"modes={self.oscillator.n_modes}, strobes={self.strobe_time.size}, samples={self.time.size}"
        return f"Trajectory(end={self.end.time:.6g} s, {counts}\n    impacts={self.impacts})"

    def _repr_html_(self) -> str:
        """The same words, and the first impacts in rows."""
        return f"<p>{self!r}</p><p>Impacts</p>{self.impacts._repr_html_()}"

    @property
    def tip(self) -> np.ndarray:
        """Displacements of the tip relative to the base at the requested times [m], shape (n_times,)."""
        return self.oscillator.tip(self.displacement)

    @property
    def tip_velocity(self) -> np.ndarray:
        """Velocities of the tip relative to the base at the requested times [m/s], shape (n_times,)."""
        return self.oscillator.tip(self.velocity)

    @property
    def _columns(self) -> dict[str, np.ndarray]:
        """The columns of a table of samples; ValueError if there are none."""
        words = "was made without times; give some, for instance simulate(..., times=np.linspace(0, 1, 1000))"
        require(self.time.size > 0, "trajectory", words)
        return {name: getattr(self, name) for name in SAMPLES}

    def plot(self, axes: Axes | None = None, **look: plots.Look) -> Axes:
        """Draw the tip [mm] against time [s], with the stops at the tip and the impacts on them.

        It draws on `axes` of matplotlib, or makes a figure, and returns the axes; `look` are properties
        of the line.  ValueError is raised for a trajectory without samples.
        """
        samples, felt = self._columns, self.impacts.kind != GRAZE
        stops = self.oscillator.stops
        gaps = {number: 1e3 * stop.side * stop.gap for number, stop in enumerate(stops) if stop.at == "tip"}
        marks = zip(self.impacts.start[felt].tolist(), self.impacts.stop[felt].tolist(), strict=True)
        axes = plots.motion(axes, samples["time"], 1e3 * samples["tip"], gaps, list(marks), **look)
        axes.set(xlabel="time (s)", ylabel="tip (mm)")
        return axes

    def to_csv(self, path: str | Path) -> None:
        """Write time, tip displacement and tip velocity at the requested times, with a heading and units.

        ValueError is raised for a trajectory without samples.  `Impacts.to_csv` writes the touches.
        """
        write_csv(path, self._columns, SAMPLES)

    def to_dataframe(self) -> DataFrame:
        """Return the columns of `to_csv` as a pandas.DataFrame; ImportError if pandas is not installed."""
        return dataframe(self._columns, SAMPLES)

    def save(self, path: str | Path) -> None:
        """Write every number of the motion into an ``.npz`` file, for `load`.

        ValueError is raised if the name does not end in ``.npz``; `to_csv` writes a table for other programs.
        """
        words = "it must end with .npz; for a table use to_csv of the trajectory or of its impacts"
        require(str(path).endswith(".npz"), "path", f"is {shown(str(path))}; {words}")
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
        words = "it must be a motion that Trajectory.save has written"
        try:
            opened = np.load(path, allow_pickle=False)
        except ValueError as error:  # no file of numpy
            raise InvalidValue("path", f"is {shown(str(path))}, {words}") from error
        with opened as file:
            known = {"numbers", *_ARRAYS, *(f"impacts_{x}" for x in _COLUMNS), *(f"end_{x}" for x in _STATE)}
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
