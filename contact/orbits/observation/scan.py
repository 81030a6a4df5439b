"""Orbit diagrams: strobed points against drive amplitude, the physical state carried along.

The letter (1996) scans the excitation amplitude upwards and downwards in small steps, lets the spring settle
at each and records 40 strobe points.  Because the state is carried along, the scan shows hysteresis: the
spring stays on its orbit until that orbit ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from beam.parameters import record, require, require_array, require_kind, require_whole
from contact import plots
from contact.errors import ContactError
from contact.maps.protocol import StrobedMap, require_map
from contact.orbits.observation.repetition import repeats_after
from contact.orbits.observation.settling import TOLERANCE, settle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

S = TypeVar("S")


@record
class OrbitDiagram(Generic[S]):
    """A scan of the drive amplitude, in the order in which it was made.

    `orbit_diagram` returns it.

    Parameters
    ----------
    excess : ndarray, shape (n_amplitudes,)
        F/F_g - 1 at each amplitude [1].
    points : ndarray, shape (n_amplitudes, record_cycles)
        The observed quantity at the strobes; NaN where the computation failed.
    m : ndarray of int, shape (n_amplitudes,)
        Period of the settled orbit in drive periods; 0 if there is none.
    impacts : ndarray of int, shape (n_amplitudes,)
        Impacts in one such period.  Without a period, impacts and points are a sample of a motion that goes
        on changing.
    cycles : ndarray of int, shape (n_amplitudes,)
        Drive periods spent settling.
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

    def plot(self, axes: Axes | None = None, **look: plots.Look) -> Axes:
        """Draw the observed quantity at the strobes against the excess; pale where no orbit was reached.

        It draws on `axes` of matplotlib, or makes a figure, and returns the axes; `look` are properties
        of the points.
        """
        axes = plots.strobes(axes, self.excess, self.points, self.m > 0, **look)
        axes.set(xlabel="excess $F/F_g - 1$", ylabel="observed at the strobes")
        return axes

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
    """Scan the drive amplitude and record strobe points of the settled motion.

    The physical state is carried from one amplitude to the next, so that the scan shows hysteresis.

    Parameters
    ----------
    strobed : StrobedMap
        The oscillator or map; its own amplitude does not matter.
    excesses : sequence of float
        F/F_g - 1 at each amplitude, in the order of the scan [1].
    state : State
        State from which the motion starts at the first amplitude.
    observe : callable
        Function of the strobed points, shape (n, n_coordinates), that returns the recorded quantity, shape
        (n,).  An example is the method ``tip`` of a StroboscopicMap.
    settle_cycles : int
        Bound of the transient at each amplitude, in drive periods.
    record_cycles : int, optional
        Strobe points recorded at each amplitude.
    largest_m : int, optional
        Longest period that is looked for, in drive periods.
    early : bool, optional
        Whether a transient ends as soon as the orbit is known (`settle`).  Otherwise every amplitude gets all
        `settle_cycles`.

    Returns
    -------
    OrbitDiagram
        The recorded points with period and impacts at each amplitude.  An amplitude at which the motion
        cannot be followed has NaN, and a sentence in `failures`.

    Raises
    ------
    TypeError
        If `strobed` is no strobed map, `observe` is no function, or another argument holds no numbers.
    ValueError
        If `excesses` is empty, a number is out of range, or `observe` returns an array of another shape.

    See Also
    --------
    settle : The motion at one amplitude.
    orbit_end : The end of one orbit in a downward scan.
    AmplitudeScan : Periods of an upward and a downward scan, in a compiled loop.

    Examples
    --------
    Raise the drive through grazing and lower it again: the orbit of period 5 persists.

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, StroboscopicMap
    >>> from contact.orbits import orbit_diagram
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> oscillator = ImpactOscillator(model=spring, stop=stop, drive=HarmonicDrive(frequency=22.2))
    >>> strobed = StroboscopicMap(oscillator=oscillator)
    >>> start, excesses = strobed.at(-1e-3).steady(), [-1e-3, 1e-3, -1e-3]
    >>> diagram = orbit_diagram(strobed, excesses, start, observe=strobed.tip, settle_cycles=1000)
    >>> diagram.m
    array([1, 5, 5])
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
