r"""Nordmark's map: the strobed motion of an impact oscillator close to grazing.

    x' = alpha x + y + rho,          y' = -gamma x          for x <= 0   (no impact)        letter Eq. (2)
    x' = -sqrt(x) + d + y + rho,     y' = -gamma_impact x   for x > 0    (one impact)       letter Eq. (3)

One step is one drive period 1/f. All quantities of the map are pure numbers:

    x       height h of the virtual peak above the wall, h = scale * x; an impact occurs when x > 0
    y       what the previous peak leaves to the next one
    rho     distance of the drive from grazing
    alpha, gamma    trace and determinant of the free flow M over one drive period
    tau     restitution: speed after the impact / speed before it
    d       constant delay at the wall, zero in the letter

**Coefficients.** The deviation u from the steady motion obeys u'' + c u' + omega_1^2 u = 0, with flow M over
1/f. With the peak phase as strobe phase, an overshoot h meets the wall at speed v = sqrt(2 a h), where
a = (2 pi f)^2 gap, and Newton's law changes the velocity at that phase by -(1 + tau) v to leading order. The
height of the next peak changes by -M12 (1 + tau) v, so the scale at which the root has coefficient one is
2 a M12^2 (1 + tau)^2, and eliminating the velocity from two successive steps gives

    alpha = tr M = exp(-c/2f) 2 cos(omega_d/f),    omega_d^2 = omega_1^2 - c^2/4 > 0  (2 cosh(kappa/f) if < 0)
    gamma = det M = exp(-c/f)
    rho   = (F/F_g - 1) (1 - alpha + gamma) / (2 (2 pi f M12)^2 (1 + tau)^2)

For an underdamped mode of free period T = 2 pi/omega_d, (2 pi f M12)^2 = gamma (f T)^2 sin^2(2 pi/(f T)).
A kick that comes `delay` seconds late is (1 + tau) v - a delay, hence d = delay / (2 M12 (1 + tau)^2).
The sign of the root is that of M12: Eq. (3) is the case M12 > 0, for an underdamped mode a fractional part of
1/(f T) below one half (2/3 < f T < 1 in the letter).

**The letter's text departs from this in two places.**
1. Eqs. (2), (3) print y' = -gamma x once, for both branches. The determinant of the impacting branch must be
   that of one period with an impact, gamma tau^2 (two factors -tau from the saltation at the wall): hence
   gamma_impact = gamma tau^2, `y_line="corrected"`. `y_line="printed"` keeps gamma_impact = gamma.
2. The bracket in rho is broken, "(1 + tau^2 sin^2(2 pi/fT)"; it reads (1 + tau)^2 sin^2(2 pi/(f T)).
Apart from these, "rho = F/F_g - 1" under its Fig. 4 is not this rho: it is called `excess` here.

Sources: letter of 1996, Eqs. (1) to (3); A. B. Nordmark, J. Sound Vib. 145 (1991) 279; W. Chin, E. Ott,
H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beam.parameters import InvalidType, require, require_array, require_kind, require_whole, require_within
from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import damped_frequency
from contact.laws import NewtonRestitution
from contact.machine.compiled import kernel
from contact.oscillator import ImpactOscillator

YLine = Literal["corrected", "printed"]


@kernel
def iterate_map(x, y, alpha, gamma, gamma_impact, rho, delay_term, out):  # type: ignore[no-untyped-def]
    """Fill `out`, shape (count, 2), with the states that follow (x, y), each by its `rho`, shape (count,)."""
    for n in range(out.shape[0]):
        if x > 0.0:
            x, y = -math.sqrt(x) + delay_term + y + rho[n], -gamma_impact * x
        else:
            x, y = alpha * x + y + rho[n], -gamma * x
        out[n, 0] = x
        out[n, 1] = y


def restitution_of(oscillator: ImpactOscillator) -> float:
    """The `local_restitution` of an oscillator's contact law; TypeError if it has none."""
    law = require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator").stop.law
    if not isinstance(law, NewtonRestitution):
        raise InvalidType(f"law of the stop is a {type(law).__name__}; it has no restitution, so give one")
    return law.local_restitution


@dataclass(frozen=True, kw_only=True)
class NordmarkMap:
    """Eqs. (2), (3) of the letter: one step is one drive period, its state the array (x, y).

    Raises ValueError for a field outside its range.

    Parameters
    ----------
    alpha, gamma : float
        Trace and determinant of the free flow over one drive period, 0 <= gamma <= 1, |alpha| < 1 + gamma.
    restitution : float
        tau, from 0 to 1 [1].
    y_line : "corrected" or "printed"
        After an impact y' = -gamma tau^2 x, or -gamma x as the letter's single line has it.
    delay_term : float
        d, zero or more [1].
    whole_turns : int
        Integer part of 1/(f T), 1 in the letter; only rho <-> excess of an oscillating mode uses it [1].
    """

    alpha: float
    gamma: float
    restitution: float
    y_line: YLine = "corrected"
    delay_term: float = 0.0
    whole_turns: int = 1

    def __post_init__(self) -> None:
        gamma, tau, line, turns = self.gamma, self.restitution, self.y_line, self.whole_turns
        require_within("gamma", gamma, "[1]", low=0, high=1)
        require_within("restitution", tau, "[1]", low=0, high=1)
        require_within("delay_term", self.delay_term, "(a pure number)", low=0)
        require_within("alpha", self.alpha, "[1]")
        require(abs(self.alpha) < 1.0 + gamma, f"alpha is {self.alpha}; its size must be below 1 + gamma")
        require(line in ("corrected", "printed"), f'y_line is {line!r}; it must be "corrected" or "printed"')
        require_whole("whole_turns", turns, "turns", low=0)

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

        `omega` [rad/s], `decay_rate` [1/s], `drive_frequency` [Hz], `restitution`, `delay` at the wall [s].
        Raises ValueError where M12 <= 0: a kick away from the wall would then raise the next peak, and the
        square root of Eq. (3) would have the other sign.
        """
        require_within("omega", omega, "rad/s", above=0)
        require_within("decay_rate", decay_rate, "1/s", low=0)
        require_within("drive_frequency", drive_frequency, "Hz", above=0)
        require_within("delay", delay, "s", low=0)
        require_within("restitution", restitution, "[1]", low=0, high=1)
        damped, damped_low = damped_frequency(omega, decay_rate)
        n11, n12, _, n22 = flow_matrix(omega, decay_rate, damped, damped_low, 1.0 / drive_frequency)
        turns = damped / (2.0 * math.pi * drive_frequency) if omega > 0.5 * decay_rate else 0.0
        require(
            n12 > 0.0,
            f"drive_frequency is {drive_frequency} Hz, where 1/(f T) is {turns:.6g}; the fractional part of "
            "1/(f T) must lie between 0 and 1/2, as it does for 2/3 < f T < 1",
        )
        return cls(
            alpha=n11 + n22,
            gamma=math.exp(-decay_rate / drive_frequency),
            restitution=restitution,
            y_line=y_line,
            delay_term=delay / (2.0 * n12 * (1.0 + restitution) ** 2),
            whole_turns=math.floor(turns),
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

        `free_period` is that of the damped free motion, `delay` [s] as in `from_mode`, as are the errors.
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

        `restitution` is the effective one; left out, it is the `local_restitution` of the oscillator's law,
        and a law without one (a force law) raises TypeError.
        """
        restitution = restitution_of(oscillator) if restitution is None else restitution
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
        """theta = 2 pi/(f T) less its whole turns, in (0, pi) [rad]; 0 for a mode that does not oscillate."""
        return math.atan2(math.sqrt(max(4.0 * self.gamma - self.alpha**2, 0.0)), self.alpha)

    @property
    def rho_per_excess(self) -> float:
        """(1 - alpha + gamma) / (2 (2 pi f M12)^2 (1 + tau)^2): rho at unit excess.

        All of it follows from the fields. ValueError if gamma = 0 or alpha <= -2 sqrt(gamma).
        """
        root = math.sqrt(self.gamma)
        require(
            self.gamma > 0.0 and self.alpha > -2.0 * root,
            f"alpha is {self.alpha}, gamma {self.gamma}; alpha > -2 sqrt(gamma) and gamma > 0 must hold",
        )
        if 4.0 * self.gamma > self.alpha**2:
            ratio = math.sin(self.angle) / (2.0 * math.pi * self.whole_turns + self.angle)
        else:
            z = math.acosh(max(1.0, 0.5 * self.alpha / root))
            ratio = math.sinh(z) / z if z > 0.0 else 1.0
        response = 2.0 * math.pi * root * ratio
        return (1.0 - self.alpha + self.gamma) / (2.0 * (response * (1.0 + self.restitution)) ** 2)

    def rho(self, excess: float) -> float:
        """rho at the excess F/F_g - 1 [1]."""
        return self.rho_per_excess * require_within("excess", excess, "[1]")

    def excess(self, rho: float) -> float:
        """The excess F/F_g - 1 [1] at `rho`."""
        return require_within("rho", rho, "[1]") / self.rho_per_excess

    def step(self, state: ArrayLike, rho: float) -> NDArray[np.float64]:
        """The state (x, y), shape (2,), one drive period later."""
        return self.iterate(state, rho, 1)[0]

    def iterate(self, state: ArrayLike, rho: ArrayLike, count: int) -> NDArray[np.float64]:
        """The `count` states that follow `state`, shape (count, 2); row 0 is one period later.

        `rho` is one number, or one for each step, shape (count,).
        """
        out = np.empty((require_whole("count", count, "periods", low=0), 2))
        single = not isinstance(rho, list | tuple | np.ndarray)
        words = "a number, or one for each step"
        each = np.full(
            count,
            require_within("rho", rho, "[1]")
            if single
            else require_array("rho", rho, "[1]", shape=(count,), words=words),
        )
        iterate_map(*pair_of(state), self.alpha, self.gamma, self.gamma_impact, each, self.delay_term, out)
        return out

    def jacobian(self, state: ArrayLike) -> NDArray[np.float64]:
        """Derivative of one step with respect to (x, y), shape (2, 2); unbounded as x -> 0+."""
        x, _ = pair_of(state)
        if x > 0.0:
            return np.array([[-0.5 / math.sqrt(x), 1.0], [-self.gamma_impact, 0.0]])
        return np.array([[self.alpha, 1.0], [-self.gamma, 0.0]])


def pair_of(state: ArrayLike) -> tuple[float, float]:
    """(x, y) of a state; ValueError if it is no pair of numbers."""
    pair = require_array("state", state, "[1]", shape=(2,), words="the pair (x, y)")
    return float(pair[0]), float(pair[1])
