r"""Where Hertz contact smooths the square root of a grazing beam, and what orbit is born below that.

Small peaks h over the wall press the ball in by the undisturbed parabola h - a t^2/2, a = omega^2 gap, so
that the impulse of the force k d^(3/2) is

    P = k (3 pi/8) sqrt(2/a) h^2

and the mode-1 tip velocity is kicked by phi_1^2 P.  With Phi_k the free flow of mode k over one drive
period, alpha_k its trace and gamma_k its determinant, the orbit with one touch a period and its loss of
stability by a multiplier -1 follow from

    excess gap = h + P(h) sum_k phi_k^2 Phi_k12/(1 - alpha_k + gamma_k)
    1 = (dP/dh) sum_k phi_k^2 Phi_k12/(1 + alpha_k + gamma_k)

Both are measured here as well, by settling on the simulated motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact.collision import Collision, first_collision
from contact.errors import ContactError
from contact.laws import HertzContact
from contact.orbits.settling import Settled, settle
from contact.orbits.single_impact import modal_flow
from contact.oscillator import ImpactOscillator
from contact.stroboscope import StroboscopicMap

__all__ = ["HertzSmoothing", "born_orbits", "collision_above", "doubling_excess", "local_slope", "reach_of"]

HERTZ_IMPULSE = 3.0 * math.pi / 8.0
"""Integral of (1 - x^2)^(3/2) over (-1, 1)."""

STEP = 1.05
"""Ratio of two excesses between which a local slope is taken."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HertzSmoothing:
    """The closed forms for one oscillator with Hertz contact."""

    oscillator: ImpactOscillator

    def __post_init__(self) -> None:
        if not isinstance(self.oscillator.stop.law, HertzContact):
            law = type(self.oscillator.stop.law).__name__
            raise TypeError(f"law of the stop is {law}; these formulas are for HertzContact")

    @property
    def impulse_per_square(self) -> float:
        """P/h^2 [N s/m^2]."""
        drive, stop = self.oscillator.drive, self.oscillator.stop
        assert drive is not None and isinstance(stop.law, HertzContact)
        return stop.law.stiffness * HERTZ_IMPULSE * math.sqrt(2.0 / stop.gap) / drive.angular_frequency

    def _sum(self, sign: float) -> float:
        model, period = self.oscillator.model, self.oscillator.period
        flow = modal_flow(model.omega, model.decay_rate, period)
        trace, determinant = flow[:, 0, 0] + flow[:, 1, 1], np.exp(-model.decay_rate * period)
        return float(np.sum(model.phi**2 * flow[:, 0, 1] / (1.0 + sign * trace + determinant)))

    def kick_velocity(self, excess: float) -> float:
        """phi_1^2 P of the collision that ends the motion without impacts [m/s]."""
        peak = excess * self.oscillator.stop.gap
        return float(self.oscillator.model.phi[0]) ** 2 * self.impulse_per_square * peak**2

    def doubling(self) -> float | None:
        """F/F_g - 1 at which the orbit with one touch a period loses its stability; None if it does not."""
        gap, total = self.oscillator.stop.gap, self._sum(1.0)
        if total <= 0.0:
            return None
        peak = 0.5 / (total * self.impulse_per_square)
        return (peak + self.impulse_per_square * peak**2 * self._sum(-1.0)) / gap


def collision_above(oscillator: ImpactOscillator, excess: float) -> Collision:
    """The collision that ends the motion without impacts at `excess`.

    The crossing of the gap and the first touch can coincide to rounding, where the search for the one around
    the other does not end in its bound of steps; an excess larger by 1e-9 of itself then has an answer.
    """
    try:
        return first_collision(oscillator.with_excess(excess))
    except ContactError:
        raise
    except RuntimeError:
        return first_collision(oscillator.with_excess(excess * (1.0 + 1e-9)))


def local_slope(oscillator: ImpactOscillator, excess: float) -> float:
    """d ln(kick velocity)/d ln(excess)."""
    low, high = (
        collision_above(oscillator, excess * factor).kick_velocity for factor in (STEP**-0.5, STEP**0.5)
    )
    return math.log(high / low) / math.log(STEP)


def reach_of(measure: Callable[[float], float], low: float, high: float) -> float | None:
    """Excess in [low, high] at which `measure` goes through zero, to 1 %; None if it does not."""

    def at(log_excess: float) -> float:
        return measure(math.exp(log_excess))

    ends = math.log(low), math.log(high)
    if at(ends[0]) * at(ends[1]) > 0.0:
        return None
    return math.exp(float(brentq(at, *ends, xtol=1e-3)))


def _quietly(strobed: StroboscopicMap, state: Any, excess: float, cycles: int) -> Settled[Any]:
    """Settle with a tolerance well below the height of the peak over the wall.

    p1 with a slowly falling transient can look like a period of a few drive periods with as many impacts; it
    gets `cycles` more to fall further.
    """
    here, tolerance = strobed.at(excess), max(1e-5 * excess, 1e-14)
    settled = settle(here, state, most_cycles=cycles, tolerance=tolerance, prove=False)
    if settled.period > 1 and settled.impacts >= settled.period:
        later = here.orbit(settled.end, cycles).end
        settled = settle(here, later, most_cycles=cycles, tolerance=tolerance, prove=False)
    return settled


def born_orbits(oscillator: ImpactOscillator, excesses: np.ndarray, cycles: int) -> list[dict[str, Any]]:
    """Period and impacts at rising excesses, raised gently and in one step from just below grazing.

    Gently: the state is carried along from excess to excess, from the grazing motion on.  In one step: from
    the motion without impacts at -1e-3, as by an experiment of finite steps.
    """
    strobed = StroboscopicMap(oscillator=oscillator)
    state, below, found = strobed.at(0.0).steady(), strobed.at(-1e-3).steady(), []
    for excess in excesses:
        row: dict[str, Any] = {"excess": float(excess)}
        for name, start in (("gently", state), ("in_one_step", below)):
            try:
                settled = _quietly(strobed, start, float(excess), cycles)
            except ContactError:
                row |= {f"period_{name}": None, f"impacts_{name}": None}
                continue
            row |= {f"period_{name}": settled.period, f"impacts_{name}": settled.impacts}
            if name == "gently":
                state = settled.end
        found.append(row)
    return found


def doubling_excess(
    oscillator: ImpactOscillator, low: float, high: float, cycles: int
) -> tuple[float, int] | None:
    """Excess at which the settled orbit stops being p1, to 0.3 %, and the period beyond.

    None without p1 at `low` or with p1 up to `high`.
    """
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = _quietly(strobed, strobed.at(0.0).steady(), low, cycles)
    if settled.period != 1:
        return None
    state, beyond = settled.end, 0
    step = 1.1
    while step > 1.002:
        if low * step > high:
            return None
        settled = _quietly(strobed, state, low * step, cycles)
        if settled.period == 1:
            low, state = low * step, settled.end
        else:
            beyond = settled.period
            step = math.sqrt(step)
    return low, beyond
