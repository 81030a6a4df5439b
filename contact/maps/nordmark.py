"""Nordmark's map: the strobed motion of an impact oscillator close to grazing.

    x' = alpha x + y + rho,          y' = -gamma x          for x <= 0   (no impact)        letter Eq. (2)
    x' = -sqrt(x) + d + y + rho,     y' = -gamma_impact x   for x > 0    (one impact)       letter Eq. (3)

One step is one drive period 1/f. All quantities of the map are pure numbers:

    x       height h of the virtual peak above the wall, h = scale * x; an impact occurs when x > 0
    y       contribution of the previous peak to the next one
    rho     distance of the drive from grazing, the control parameter
    alpha, gamma    trace and determinant of the free flow M over one drive period
    gamma_impact    gamma tau^2 with `y_line="corrected"`, gamma with `y_line="printed"` as in the letter
    tau     restitution: speed after the impact / speed before it
    d       constant delay at the wall, zero in the letter

Sources: letter of 1996, Eqs. (2), (3); A. B. Nordmark, J. Sound Vib. 145 (1991) 279; W. Chin, E. Ott,
H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.  Derivation: ``docs/theory/map.md``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import Array, record, require, require_array, require_whole, require_within
from contact.machine.compiled import kernel
from contact.maps.nordmark_coefficients import coefficients
from contact.maps.protocol import Jacobians, StrobedOrbit, amplitude_factors
from contact.oscillator import ImpactOscillator, require_one_stop

YLine = Literal["corrected", "printed"]


@kernel
def iterate_map(x, y, alpha, gamma, gamma_impact, rho, delay_term, out):
    """Fill `out`, shape (count, 2), with the states that follow (x, y), each by its `rho`, shape (count,)."""
    for n in range(out.shape[0]):
        if x > 0.0:
            x, y = -math.sqrt(x) + delay_term + y + rho[n], -gamma_impact * x
        else:
            x, y = alpha * x + y + rho[n], -gamma * x
        out[n, 0] = x
        out[n, 1] = y


@record(eq=True)
class NordmarkMap:
    """Nordmark's map, the letter's equations (2) and (3); one step is one drive period.

    It has the methods of `StrobedMap`.  A state is the array (x, y), which is also its point.  An impact
    occurs in a step that starts from x > 0.

    Parameters
    ----------
    alpha, gamma : float
        Trace and determinant of the free flow over one drive period [1]; ``abs(alpha) < 1 + gamma`` and
        ``0 <= gamma <= 1``.
    restitution : float
        Restitution tau, from 0 to 1 [1].
    y_line : {"corrected", "printed"}, optional
        After an impact y' = -gamma tau^2 x, or -gamma x as the letter's single line has it.
    delay_term : float, optional
        Term d of a constant delay at the wall, zero or more [1].
    whole_turns : int, optional
        Integer part of 1/(f T), 1 in the letter; it relates rho and excess of an oscillating mode [1].
    control : float, optional
        The rho at which `steady`, `orbit` and `jacobians` work [1]; `at` sets it from the excess.

    Raises
    ------
    TypeError
        If a field is no number.
    ValueError
        If a field is out of its range.

    See Also
    --------
    MapFamily : The periodic orbits of the map.
    StroboscopicMap : The exact map of an oscillator.
    contact.orbits.settle : Follow a motion until it is periodic.

    Examples
    --------
    >>> from contact import NordmarkMap
    >>> nordmark = NordmarkMap.from_frequencies(
    ...     drive_frequency=22.2, free_period=40.80e-3, decay_rate=3.56, restitution=0.1
    ... )
    >>> nordmark.at(1e-3).orbit(nordmark.at(-1e-3).steady(), 500).impacts[-10:]
    array([0, 0, 1, 0, 0, 0, 0, 1, 0, 0])
    """

    alpha: float
    gamma: float
    restitution: float
    y_line: YLine = "corrected"
    delay_term: float = 0.0
    whole_turns: int = 1
    control: float = 0.0

    scale: ClassVar[float] = 1e-3
    """Size of the states of an orbit with impacts, from the slope of the root at ``abs(rho) = 1e-3`` [1]."""
    period: ClassVar[float] = 1.0
    """The time of one step: the map has no clock."""

    def __post_init__(self) -> None:
        alpha, line = self.alpha, self.y_line
        require_within("gamma", self.gamma, "[1]", low=0, high=1)
        require_within("restitution", self.restitution, "[1]", low=0, high=1)
        require_within("delay_term", self.delay_term, "(a pure number)", low=0)
        require_within("alpha", alpha, "[1]")
        require_within("control", self.control, "[1]")
        require(abs(alpha) < 1.0 + self.gamma, f"alpha is {alpha}; its size must be below 1 + gamma")
        require(line in ("corrected", "printed"), f'y_line is {line!r}; it must be "corrected" or "printed"')
        require_whole("whole_turns", self.whole_turns, "turns", low=0)

    @classmethod
    def from_mode(
        cls,
        *,
        omega: float,
        decay_rate: float,
        drive_frequency: float,
        restitution: float,
        y_line: YLine = "corrected",
        delay: float = 0.0,
    ) -> NordmarkMap:
        """The map of x'' + decay_rate x' + omega^2 x = F sin(2 pi drive_frequency t), at any damping.

        Units: `omega` [rad/s], `decay_rate` [1/s], `drive_frequency` [Hz], `delay` at the wall [s].
        Raises ValueError where M12 <= 0: a kick away from the wall would then raise the next peak, and the
        square root of Eq. (3) would have the other sign.
        """
        alpha, gamma, d, turns = coefficients(omega, decay_rate, drive_frequency, restitution, delay)
        return cls(
            alpha=alpha, gamma=gamma, restitution=restitution, y_line=y_line, delay_term=d, whole_turns=turns
        )

    @classmethod
    def from_frequencies(
        cls,
        *,
        drive_frequency: float,
        free_period: float,
        decay_rate: float,
        restitution: float,
        y_line: YLine = "corrected",
        delay: float = 0.0,
    ) -> NordmarkMap:
        """The map of an underdamped mode from the letter's f [Hz], T [s], mu [1/s] and tau [1].

        `free_period` belongs to the damped free motion.  `delay` [s] and errors are as in `from_mode`.
        """
        require_within("free_period", free_period, "s", above=0)
        require_within("decay_rate", decay_rate, "1/s", low=0)
        return cls.from_mode(
            omega=math.hypot(2.0 * math.pi / free_period, 0.5 * decay_rate),
            decay_rate=decay_rate,
            drive_frequency=drive_frequency,
            restitution=restitution,
            y_line=y_line,
            delay=delay,
        )

    @classmethod
    def from_oscillator(
        cls,
        oscillator: ImpactOscillator,
        *,
        restitution: float | None = None,
        y_line: YLine = "corrected",
        delay: float = 0.0,
    ) -> NordmarkMap:
        """The map of mode 1 of an `ImpactOscillator` (``ModalModel.leading_mode``), all others ignored.

        `restitution` is the effective one; left out, it is the `local_restitution` of the oscillator, at the
        lowest speed if it depends on the speed, and a law without one (a force law) raises TypeError.
        """
        require_one_stop(oscillator, "Nordmark's map")
        restitution = oscillator.local_restitution if restitution is None else restitution
        model, k = oscillator.model, oscillator.model.leading_mode
        return cls.from_mode(
            omega=float(model.omega[k]),
            decay_rate=float(model.decay_rate[k]),
            drive_frequency=float(oscillator.driven.frequency),
            restitution=restitution,
            y_line=y_line,
            delay=delay,
        )

    @property
    def gamma_impact(self) -> float:
        """Determinant of the impacting branch: gamma tau^2, or gamma with the printed y-line."""
        return self.gamma * self.restitution**2 if self.y_line == "corrected" else self.gamma

    @property
    def angle(self) -> float:
        """The angle theta = 2 pi/(f T) less its whole turns, in (0, pi) [rad]; 0 without oscillation."""
        return math.atan2(math.sqrt(max(4.0 * self.gamma - self.alpha**2, 0.0)), self.alpha)

    @property
    def rho_per_excess(self) -> float:
        """(1 - alpha + gamma) / (2 (2 pi f M12)^2 (1 + tau)^2): rho at unit excess.

        It follows from the fields alone. Raises ValueError if gamma = 0 or alpha <= -2 sqrt(gamma).
        """
        root = math.sqrt(self.gamma)
        words = f"alpha is {self.alpha}, gamma {self.gamma}; alpha > -2 sqrt(gamma) and gamma > 0 must hold"
        require(self.gamma > 0.0 and self.alpha > -2.0 * root, words)
        if 4.0 * self.gamma > self.alpha**2:
            ratio = math.sin(self.angle) / (2.0 * math.pi * self.whole_turns + self.angle)
        else:
            z = math.acosh(max(1.0, 0.5 * self.alpha / root))
            ratio = math.sinh(z) / z if z > 0.0 else 1.0
        response = 2.0 * math.pi * root * ratio
        return (1.0 - self.alpha + self.gamma) / (2.0 * (response * (1.0 + self.restitution)) ** 2)

    @property
    def rho_per_factor(self) -> float:
        """Derivative of rho with respect to a factor of the amplitude, at `control` [1]."""
        return self.rho_per_excess + self.control

    def rho(self, excess: float) -> float:
        """rho at the excess F/F_g - 1 [1]."""
        return self.rho_per_excess * require_within("excess", excess, "[1]")

    def excess(self, rho: float) -> float:
        """The excess F/F_g - 1 [1] at `rho`."""
        return require_within("rho", rho, "[1]") / self.rho_per_excess

    def iterate(self, state: ArrayLike, rho: ArrayLike, count: int) -> Array:
        """The `count` states that follow `state`, shape (count, 2); row 0 is one period later.

        `rho` is one number, or one for each step, shape (count,).
        """
        out = np.empty((require_whole("count", count, "periods", low=0), 2))
        if isinstance(rho, list | tuple | np.ndarray):
            words = "a number, or one for each step"
            rho = require_array("rho", rho, "[1]", shape=(count,), words=words)
        else:
            rho = require_within("rho", rho, "[1]")
        each = np.full(count, rho)
        iterate_map(*pair_of(state), self.alpha, self.gamma, self.gamma_impact, each, self.delay_term, out)
        return out

    def jacobian(self, state: ArrayLike) -> Array:
        """Derivative of one step with respect to (x, y), shape (2, 2); unbounded as x -> 0+."""
        x, _ = pair_of(state)
        if x > 0.0:
            return np.array([[-0.5 / math.sqrt(x), 1.0], [-self.gamma_impact, 0.0]])
        return np.array([[self.alpha, 1.0], [-self.gamma, 0.0]])

    def at(self, excess: float) -> NordmarkMap:
        """This map at F/F_g - 1 = `excess` [1]."""
        return replace(self, control=self.rho(excess))

    def steady(self) -> Array:
        """The fixed point of the branch without impact: x = rho / (1 - alpha + gamma), y = -gamma x."""
        x = self.control / (1.0 - self.alpha + self.gamma)
        return np.array([x, -self.gamma * x])

    def orbit(self, state: ArrayLike, count: int, *, factors: ArrayLike | None = None) -> StrobedOrbit[Array]:
        """`count` steps from `state` at rho = `control`; the points are (x, y), shape (count, 2).

        With `factors`, one for each step, the amplitude is that of the map times the factor of the step.
        """
        changing = amplitude_factors(factors, require_whole("count", count, "periods", low=0))
        rho = self.control + self.rho_per_factor * (changing - 1.0) if changing.size else self.control
        points = np.vstack([pair_of(state), self.iterate(state, rho, count)])
        impacts = (points[:-1, 0] > 0).astype(np.int64)
        return StrobedOrbit(end=points[-1].copy(), points=points[1:], impacts=impacts)

    def jacobians(self, state: ArrayLike, count: int) -> Jacobians[Array]:
        """Derivatives of the `count` steps from `state`, and the state at their end."""
        points = np.vstack([pair_of(state), self.iterate(state, self.control, count)])
        return [(self.jacobian(row), 1) for row in points[:-1]], points[-1].copy()

    def coordinates(self, state: Array) -> Array:
        """The state itself."""
        return state


def pair_of(state: ArrayLike) -> tuple[float, float]:
    """(x, y) of a state; ValueError if it is no pair of numbers."""
    pair = require_array("state", state, "[1]", shape=(2,), words="the pair (x, y)")
    return float(pair[0]), float(pair[1])
