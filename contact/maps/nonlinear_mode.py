"""One mode at finite amplitude against a stop: Eq. (1) of the letter (1996) with cubic terms.

    (1 + a x^2) x'' + a x x'^2 + mu x' + W^2 (x + b x^3) = G cos(2 pi f t),     x <= gap,

x [m] is the displacement of the tip; a and b [1/m^2] follow from the spring's backbone
(``beam.backbone_coefficient``). Impacts obey Newton's law. Free motion of small amplitude A has the frequency
f_0 (1 + (3 b/8 - a/4) A^2). ``contact.maps.nonlinear_taylor`` solves the equation.

Excess counts from the drive at which the *nonlinear* motion grazes. That motion touches the stop at rest and
does so again a drive period later: two equations for the force's amplitude and phase.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import Array, record, require_array, require_whole, require_within
from contact.errors import Chatter, Diverged, NotPeriodic
from contact.maps.nonlinear_taylor import CHATTERED, FLOWN, ORDER, free_flow, periods
from contact.maps.protocol import StrobedOrbit, amplitude_factors

MOST_STEPS = 50  # bound of the steps of Newton's method for the motion without impacts
CLOSE = 1e-12  # relative change at which Newton's method ends
TINY = 1e-30  # imaginary step of a derivative


@record(eq=True)
class NonlinearMode:
    """One mode at finite amplitude with a stop, as a strobed map at one drive amplitude.

    It has the methods of `StrobedMap`.  States are (x, x'/W) [m].  The excess is F/F_g - 1, with F_g the
    drive at which the motion without impacts touches the stop at rest.  Its properties and methods raise
    NotPeriodic where the motion that grazes, or the one without impacts, is not found.

    Parameters
    ----------
    free_period : float
        Damped period of free motion of small amplitude, above zero [s].
    decay_rate : float
        Decay rate mu, zero or more [1/s].
    stiffness : float
        Coefficient b of the cubic restoring force, above -1/(3 gap^2) [1/m^2].
    inertia : float
        Coefficient a of the inertia that grows with the amplitude, above -1/gap^2 [1/m^2].
    gap : float
        Distance from the tip at rest to the stop, above zero [m].
    restitution : float
        Restitution of Newton's law, from 0 to 1 [1].
    frequency : float
        Drive frequency f, above zero [Hz].
    excess : float, optional
        Excess F/F_g - 1, above -1 [1].

    Raises
    ------
    TypeError
        If an argument is no number.
    ValueError
        If an argument is out of its range.  With less stiffness or inertia, the stiffness or the mass would
        turn negative on the way to the gap.
    """

    free_period: float
    decay_rate: float
    stiffness: float
    inertia: float
    gap: float
    restitution: float
    frequency: float
    excess: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("free_period", "s"), ("gap", "m"), ("frequency", "Hz")):
            require_within(name, getattr(self, name), unit, above=0)
        require_within("decay_rate", self.decay_rate, "1/s", low=0)
        require_within("restitution", self.restitution, "[1]", low=0, high=1)
        require_within("excess", self.excess, "[1]", above=-1)
        # with less, the force would fall or the mass vanish on the way to the stop
        for name, least in (("stiffness", -1.0 / 3.0), ("inertia", -1.0)):
            require_within(name, getattr(self, name), "1/m^2", above=least / self.gap**2)

    @cached_property
    def numbers(self) -> tuple[float, float, float, float, float]:
        """W^2, mu, b, a and 2 pi f."""
        square = (2.0 * math.pi / self.free_period) ** 2 + 0.25 * self.decay_rate**2
        given = square, self.decay_rate, self.stiffness, self.inertia, 2.0 * math.pi * self.frequency
        return tuple(map(float, given))  # type: ignore[return-value]

    @property
    def scale(self) -> float:
        """The gap [m]."""
        return self.gap

    @property
    def period(self) -> float:
        """The drive period [s]."""
        return 1.0 / self.frequency

    def at(self, excess: float) -> NonlinearMode:
        """This oscillator at another excess F/F_g - 1 = `excess` [1]."""
        changed = replace(self, excess=excess)
        changed.__dict__["grazing"] = self.grazing  # it does not depend on the excess
        return changed

    def _flow(self, start: float, time: float, given: Sequence[complex]) -> NDArray[np.complex128]:
        """x and x' a `time` after `start` [s] without a stop; `given`: both parts of the force, x and x'."""
        work, (cosine, sine, x, v) = np.zeros((4, ORDER + 1), complex), map(complex, given)
        return np.array(free_flow(self.numbers, cosine, sine, x, v, start, time, float(self.gap), work))

    def _slopes(self, start: float, given: Sequence[float], which: Sequence[int]) -> tuple[Array, Array]:
        """(x, x') a drive period after `start`; its derivatives by two numbers of `given`, shape (2, 2)."""
        shifted = [[part + 1j * TINY * (i == k) for k, part in enumerate(given)] for i in which]
        ends = np.array([self._flow(start, self.period, row) for row in shifted])
        return ends[0].real, ends.imag.T / TINY

    def _solved(self, start: float, given: Sequence[float], which: Sequence[int]) -> list[float]:
        """`given` with two of its numbers changed so that the motion returns after a drive period."""
        found = list(given)
        for _ in range(MOST_STEPS):
            end, slopes = self._slopes(start, found, which)
            wrong = end - found[2:]
            change = np.linalg.solve(slopes - (np.eye(2) if which[0] == 2 else 0.0), wrong)
            for i, part in zip(which, change, strict=True):
                found[i] -= part
            size = np.abs(np.array(found)[list(which)]).max()
            if np.abs(change).max() <= CLOSE * size:
                return found
        detail = "no motion without impacts was found at this drive"
        raise NotPeriodic(time=start, gap=self.gap - found[2], velocity=found[3], detail=detail)

    @cached_property
    def grazing(self) -> tuple[float, float]:
        """Force amplitude of the motion that touches the stop at rest [m/s^2]; the drive's time then [s]."""
        square, decay, b, a, w = self.numbers
        # guess: the linear motion with the stiffness of this amplitude
        stiff = square * (1.0 + 0.75 * b * self.gap**2) - w**2 * (1.0 + 0.5 * a * self.gap**2)
        given = [stiff * self.gap, -decay * w * self.gap, self.gap, 0.0]
        cosine, sine, _, _ = self._solved(0.0, given, (0, 1))
        return math.hypot(cosine, sine), -math.atan2(sine, cosine) / w % self.period

    @cached_property
    def monodromy(self) -> Array:
        """Derivative of (x, x') over a drive period from the touch of the grazing motion, shape (2, 2)."""
        force, touch = self.grazing
        return self._slopes(touch, (force, 0.0, self.gap, 0.0), (2, 3))[1]

    @property
    def effective_period(self) -> float:
        """Free period [s] of the linear mode whose deviations oscillate as fast under this drive.

        It is 1/(f (1 + theta/2 pi)), where the trace of the monodromy is 2 sqrt(det) cos(theta). theta lies
        between 0 and pi where the tip moves with the force, between -pi and 0 where it moves against it: for
        free frequencies between half and one and a half times the drive's. Raises NotPeriodic where
        deviations do not oscillate, next to a turning point of the response.
        """
        half = 0.5 * np.trace(self.monodromy) / math.sqrt(np.linalg.det(self.monodromy))
        if not abs(half) < 1.0:
            detail = f"deviations from the motion that grazes at {self.frequency:g} Hz do not turn"
            raise NotPeriodic(time=self.grazing[1], detail=detail)
        theta = math.copysign(math.acos(half), math.cos(self.numbers[4] * self.grazing[1]))
        return 1.0 / (self.frequency * (1.0 + theta / (2.0 * math.pi)))

    @cached_property
    def _steady(self) -> tuple[float, float]:
        """x and x' of the motion without impacts at the strobe."""
        force, touch = self.grazing
        x, v = self._flow(touch, self.period - touch, (force, 0.0, self.gap, 0.0)).real
        found = self._solved(0.0, [(1.0 + self.excess) * force, 0.0, x, v], (2, 3))
        return found[2], found[3]

    def steady(self) -> Array:
        """The state of the motion without impacts at a strobe, as it would be without the stop."""
        x, v = self._steady
        return np.array([x, v / math.sqrt(self.numbers[0])])

    def orbit(self, state: ArrayLike, count: int, *, factors: ArrayLike | None = None) -> StrobedOrbit[Array]:
        """`count` drive periods from `state`; the points are states, shape (count, 2).

        With `factors`, one for each period, the force is that of the oscillator times the factor.

        Raises Chatter for more impacts in a period than ``nonlinear_taylor.MOST_IMPACTS``, and Diverged where
        the tip goes so far out that its restoring force would fall.
        """
        count = require_whole("count", count, "drive periods", low=0)
        changing = amplitude_factors(factors, count)
        points, impacts = np.empty((count, 2)), np.zeros(count, dtype=np.int64)
        end = require_array("state", state, "m", shape=(2,), words="two numbers")
        x, v = float(end[0]), float(end[1]) * math.sqrt(self.numbers[0])
        forces = np.full(count, (1.0 + self.excess) * self.grazing[0])
        if changing.size:
            forces *= changing
        stop = float(self.gap), float(self.restitution)
        outcome, time = periods(self.numbers, forces, *stop, x, v, points, impacts)
        if outcome != FLOWN:
            gap, velocity = self.gap - points[0, 0], points[0, 1] * math.sqrt(self.numbers[0])
            raise (Chatter if outcome == CHATTERED else Diverged)(time=time, gap=gap, velocity=velocity)
        end = points[-1] if count else end
        return StrobedOrbit(end=end.copy(), points=points, impacts=impacts)
