"""Branches of periodic orbits along a path p -> oscillator, such as a response curve in the drive frequency.

An orbit starts at its first touch from z = (u, v, S, C), with the tip y over the stop, and obeys

    F_(u,v)(z, p) - (u, v) = 0,      y(z, p) = 0,      |(S, C)| = Z(p)

(``contact.orbits.branches.orbit_derivatives``, with exact tangents in z and p): 2 N + 2 equations for the 2 N
+ 3 unknowns (z, p).  Their curve is followed in its own arc length (``contact.orbits.branches.branch``), and
turns round where p does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from beam.parameters import require, require_kind, require_within
from contact.errors import NotPeriodic
from contact.flight.modal_flow import steady_motion
from contact.orbits.branches.branch import Branch, branch_of
from contact.orbits.branches.curve import Curve, Equations, Iterate, Point
from contact.orbits.branches.orbit_derivatives import drive_of, equations_of, sizes_of
from contact.orbits.families.periodic_orbit import PeriodicOrbit
from contact.oscillator import ImpactOscillator
from contact.sensitivity.change import Change, Changes, Path, change_along

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class PathCurve(Curve):
    """The curve over a path; the unknowns are scaled by the sizes of the orbit `like`."""

    path: Path
    low: float
    high: float
    whole = True

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

    def parameter(self, point: Point) -> float:
        """p at a point."""
        return self.value(point.x)

    def start(self, p: float) -> Point:
        """The point next to the orbit `like`, at this p."""
        x = np.concatenate([self.like.deviations, drive_of(self.like), [p - self.low]]) / self.scale
        return self.at(x, self.like.impacts)

    def unknowns(self, start: Array, time: float, speed: float, here: Array) -> Array:
        """See `Curve`; the approach velocity is not one of them."""
        z, w = here * self.scale, self.path(self.value(here)).driven.angular_frequency
        turn = math.hypot(z[-3], z[-2]) * np.exp(1j * w * time)
        return np.concatenate([start, [turn.imag, turn.real, z[-1]]]) / self.scale

    def equations(self, x: Array, touches: int) -> Equations:
        """See `Curve`.  How the numbers change with p is computed once for the neighbourhood."""
        return partial(self._iterate, touches, change_along(self.path, self.value(x), self.low, self.high))

    def _iterate(self, touches: int, change: Change, x: Array) -> Iterate:
        z, n, p = x * self.scale, x.size - 3, self.value(x)
        here, (u, v) = self.path(p), z[:n].reshape(2, -1).copy()
        reached, w = math.hypot(z[-3], z[-2]), here.driven.angular_frequency
        driven, phase = here.with_amplitude(reached), math.atan2(z[-3], z[-2]) % (2.0 * math.pi) / w
        q, q_rate = steady_motion(driven.motion(), phase)
        orbit = PeriodicOrbit(
            oscillator=driven,
            period=self.like.period,
            phase=phase,
            displacement=u,
            velocity=v,
            excess=reached / here.grazing_amplitude() - 1.0,
            speed=float(here.tip(v + q_rate)),
            record=np.empty((touches, 4 + n)),
            tangent=np.eye(n),
            slope=math.nan,
            residual=math.nan,
        )
        changes = Changes(oscillator=driven, changes=(change,))
        end, record, tangent, rows = equations_of(orbit, changes)
        weight = np.concatenate([self.scale[:n], [here.stop.gap, self.scale[-2]]])
        reach = float(here.tip(u + q)) - driven.motion().gap
        residual = np.concatenate([end - z[:n], [reach, reached - here.driven.amplitude]]) / weight
        orbit, rows = replace(orbit, record=record, tangent=tangent), rows * self.scale
        rise = self.scale * np.eye(x.size)[-1]
        return Iterate(orbit, residual, rows[:-1] / weight[:, None], rise, rows[-1])


def follow_path(
    path: Path, start: PeriodicOrbit, at: float, *, low: float, high: float, step: float = 0.05
) -> Branch:
    """The branch through `start`, an orbit of ``path(at)``, as long as the parameter is in [low, high].

    Parameters
    ----------
    path : callable
        p -> ImpactOscillator for p from `low` to `high`, smooth, of one law and number of modes.  A constant
        force f is Z = f/w^2 at frequency w [rad/s], a constant base acceleration a is Z = a/w^2.
    start : PeriodicOrbit
    at, low, high : float
        In the unit of the parameter.
    step : float
        Longest step in units of the sizes: the gap, 2 pi f gap, the grazing amplitude, a tenth of the range.

    Returns
    -------
    Branch
        Orbits and their `parameters` from one end to the other, and events with theirs: "fold" (the parameter
        turns round), "period doubling", "torus", "branch point" (two branches cross), "grazing" (a touch is
        gained or lost), or "undecided" (``contact.orbits.Event``).  A closed curve ends where it began,
        "closed"; one that becomes an orbit of a shorter period, run several times, ends there.

    Raises
    ------
    NotPeriodic
        If there is no orbit next to `start`, or its tip meets the stop at other times than its touches.
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
        words = "the start meets the stop at another time than its touches"
        raise NotPeriodic(time=first.orbit.phase, gap=0.0, velocity=first.orbit.speed, detail=words)
    branch, points = branch_of(curve, first, step, 0.3 * step)
    return replace(branch, parameters=tuple(curve.parameter(point) for point in points))
