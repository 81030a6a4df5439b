"""Branches of periodic orbits along a path p -> oscillator, such as a response curve in the drive frequency.

The equations of ``contact.orbits.families.equations`` at the given amplitude |(S, C)| = Z(p), with exact
tangents in z and p, are 2 N + 2 equations for the 2 N + 3 unknowns (z, p).  Their curve is followed in its
own arc length (``contact.orbits.branches.branch``), and turns round where p does.
"""

import math
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from beam.parameters import Array, record, require, require_kind, require_within
from contact.errors import NotPeriodic
from contact.flight.modal_flow import steady_motion
from contact.orbits.branches.branch import Branch, branch_of
from contact.orbits.branches.curve import Curve
from contact.orbits.families.equations import drive_of, driven_at, shoot, sizes_of, slopes_of
from contact.orbits.families.newton import CurvePoint, Equations, Iterate
from contact.orbits.families.touch_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Change, Path, Sensitivities, change_along


@record
class PathCurve(Curve):
    """The curve of orbits over a `path` p -> ImpactOscillator with p in [low, high]."""

    path: Path
    low: float
    high: float
    admissible_only = True

    @cached_property
    def scale(self) -> Array:
        """Sizes of (u, v, S, C, p - low)."""
        oscillator, length = self.like.oscillator, 0.1 * (self.high - self.low)
        amplitude = oscillator.grazing_amplitude()
        return np.concatenate([sizes_of(oscillator), [amplitude, amplitude, length]])

    @property
    def ends(self) -> tuple[float, float]:
        """Range of the scaled p."""
        return 0.0, float((self.high - self.low) / self.scale[-1])

    def value(self, x: Array) -> float:
        """p at these unknowns; the ends of the range without rounding."""
        p = self.low + float(x[-1] * self.scale[-1])
        near = 1e-14 * (self.high - self.low)
        return next((end for end in (self.low, self.high) if abs(p - end) <= near), p)

    def parameter(self, point: CurvePoint) -> float:
        """p at a point."""
        return self.value(point.x)

    def start(self, p: float) -> CurvePoint:
        """The point next to the orbit `like`, at this p."""
        x = np.concatenate([self.like.deviations, drive_of(self.like), [p - self.low]]) / self.scale
        return self.at(x, self.like.impacts)

    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """The unknowns of an orbit from one of its touches; the approach velocity is not one of them."""
        z, w = here * self.scale, self.path(self.value(here)).driven.angular_frequency
        phasor = math.hypot(z[-3], z[-2]) * np.exp(1j * w * time)
        return np.concatenate([start, [phasor.imag, phasor.real, z[-1]]]) / self.scale

    def equations(self, x: Array, impacts: int) -> Equations:
        """The equations near `x`; the derivatives of the oscillator's numbers are computed once, at `x`."""
        return partial(self._iterate, impacts, change_along(self.path, self.value(x), self.low, self.high))

    def _iterate(self, impacts: int, change: Change, x: Array) -> Iterate:
        z, n = x * self.scale, x.size - 3
        here = self.path(self.value(x))
        driven, phase = driven_at(here, z[-3:-1])
        several = Sensitivities(oscillator=driven, changes=(change,))
        orbit, miss, flow = shoot(several, phase, z[:n], self.like.m, impacts)
        weight = np.concatenate([self.scale[:n], [here.stop.gap, self.scale[-2]]])
        q = steady_motion(driven.numbers(), phase)[0]
        height = float(here.tip(orbit.displacement + q)) - driven.numbers().gap
        residual = np.concatenate([miss, [height, orbit.amplitude - here.driven.amplitude]]) / weight
        rows = slopes_of(orbit, flow, several) * self.scale
        p_slope = self.scale * np.eye(x.size)[-1]
        return Iterate(orbit, residual, rows[:-1] / weight[:, None], p_slope, rows[-1], np.diag(self.scale))


def follow_path(
    path: Path, start: PeriodicOrbit, at: float, *, low: float, high: float, step: float = 0.05
) -> Branch:
    """Follow the branch of orbits through `start` along a path of oscillators.

    The path is any smooth function of one parameter p, such as the drive frequency.  The branch turns round
    where p does.  It is followed both ways, as long as p is in the range.

    Parameters
    ----------
    path : callable
        Function of p from `low` to `high` that returns an ImpactOscillator.  It must be smooth, and all its
        oscillators must have one law and one number of modes.
    start : PeriodicOrbit
        An orbit of the oscillator ``path(at)``.
    at : float
        Parameter p of the start, from `low` to `high`.
    low, high : float
        Range of the parameter p.
    step : float, optional
        Longest step of arc length, above 0 and at most 1 [1].  Its units are the gap, 2 pi f gap, the grazing
        amplitude and a tenth of the range.

    Returns
    -------
    Branch
        The orbits with their `parameters`, from one end of the branch to the other, and its events.

    Raises
    ------
    TypeError
        If `start` is no PeriodicOrbit, ``path(at)`` is no ImpactOscillator, or another argument is no number.
    ValueError
        If `path` is no function, if a number is out of its range, or if ``path(at)`` and the start differ in
        their number of modes.
    NotPeriodic
        If there is no orbit next to `start`, or if its tip meets the stop at another time than in its
        touches.

    See Also
    --------
    follow : The branch of a family over the drive amplitude.
    Event : The kinds of events, and when one is "undecided".
    Branch : The orbits of a branch, its events, and why it ends.

    Notes
    -----
    The kinds of events are:

    - "fold": the parameter turns round.
    - "period doubling" and "torus": the orbit loses or gains its stability.
    - "branch point": two branches cross.
    - "grazing": the tip gains or loses a touch.
    - "undecided": the event could not be identified.

    A closed curve ends where it began, and both its ends are "closed".  A curve whose orbit becomes one of
    a shorter period, run several times, ends there.

    For a force of constant amplitude f, give the base the amplitude Z = f/w^2 at the angular frequency w
    [rad/s].  For a base acceleration a, give it Z = a/w^2.

    Examples
    --------
    A response curve at constant excess: the orbit of period 4 over the drive frequency.

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop
    >>> from contact.orbits import Shooting, follow_path
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> def at_frequency(f):
    ...     drive = HarmonicDrive(frequency=f)
    ...     return ImpactOscillator(model=spring, stop=stop, drive=drive).with_excess(1e-3)
    >>> start = Shooting(oscillator=at_frequency(21.5), m=4).orbits(1e-3)[-1]
    >>> branch = follow_path(at_frequency, start, 21.5, low=21.48, high=22.0)
    >>> [(event.kind, f"{event.parameter:.2f} Hz") for event in branch.events]
    [('period doubling', '21.84 Hz')]
    """
    require(callable(path), f"path is {path!r}; it must be a function of one number")
    require_kind("start", start, PeriodicOrbit, "a PeriodicOrbit")
    require_within("low", low, "[of p]")
    require_within("high", high, "[of p]", above=low)
    require_within("at", at, "[of p]", low=low, high=high)
    require_within("step", step, "[1]", above=0, high=1)
    modes = require_kind("path(at)", path(at), ImpactOscillator, "an ImpactOscillator").n_modes
    known = start.oscillator.n_modes
    require(modes == known, f"path(at) has {modes} modes; the start has {known}")
    curve = PathCurve(path=path, low=low, high=high, like=start)
    first = curve.start(at)
    if not first.orbit.admissible:
        raise first.orbit.failure(NotPeriodic, "the start meets the stop at another time than its touches")
    branch, points = branch_of(curve, first, step, 0.3 * step)
    return replace(branch, parameters=tuple(curve.parameter(point) for point in points))
