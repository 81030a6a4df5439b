r"""Where Hertz contact smooths the square root of a grazing beam, and what orbit is born below that.

Small peaks h over the wall press the ball in by the undisturbed parabola h - a t^2/2, a = omega^2 gap, so
that the impulse of the force k d^(3/2) is P = k (3 pi/8) sqrt(2/a) h^2, and the mode-1 tip velocity is kicked
by phi_1^2 P. With P for J in `closed_forms`, the orbit with one touch a period loses its stability where

    1 = S_+ dP/dh,   excess gap = h + S_- P(h).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact import Collision, ContactError, HertzContact, ImpactOscillator, StroboscopicMap, first_collision
from contact.orbits import Settled, Shooting, follow, settle
from studies import letter
from studies.scene import Scene, beam_at, hertz_of, model_of
from studies.soft_wall.closed_forms import survival_sums

__all__ = ["Beam", "BeamKick", "Born", "beam_of", "born_orbits", "doubling_by_shooting", "doubling_of"]

HERTZ_IMPULSE = 3.0 * math.pi / 8.0
"""Integral of (1 - x^2)^(3/2) over (-1, 1)."""

RATIO = 1.05
"""Ratio of two excesses between which a local power is taken."""

CYCLES = 4000
"""Bound of a transient in drive periods."""


@dataclass(frozen=True, kw_only=True)
class BeamKick:
    """The collision that ends the motion without impacts at `excess`, and the power laws of its kick."""

    excess: float
    kick_velocity: float
    kick: float
    slope: float
    soft_law: float
    hard_law: float
    contact_time_s: float
    restitution: float | None


@dataclass(frozen=True, kw_only=True)
class Born:
    """Period (0: not settled, None: failed) and impacts, raised gently and in one step from -1e-3."""

    excess: float
    period_gently: int | None
    impacts_gently: int | None
    period_in_one_step: int | None
    impacts_in_one_step: int | None


@dataclass(frozen=True, kw_only=True)
class Beam:
    """What the beam with Hertz contact does near grazing; excesses are F/F_g - 1."""

    frequency_hz: float
    modes: int
    hertz_stiffness: float
    plateau: float
    half_excess: float | None
    square_root_from: float | None
    square_law_up_to: float | None
    doubling_theory: float | None
    doubling_excess: float | None
    doubling_theory_by_frequency: dict[str, float | None]


def reach_of(measure: Callable[[float], float], low: float, high: float) -> float | None:
    """Excess in [low, high] at which `measure` goes through zero, to 1 %; None if it does not."""
    ends = math.log(low), math.log(high)
    if measure(low) * measure(high) > 0.0:
        return None
    return math.exp(float(brentq(lambda x: measure(math.exp(x)), *ends, xtol=1e-3)))


def impulse_per_square(oscillator: ImpactOscillator) -> float:
    """P/h^2 [N s/m^2]."""
    law, gap = oscillator.stop.law, oscillator.stop.gap
    if not isinstance(law, HertzContact):
        raise TypeError(f"law of the stop is {type(law).__name__}; these formulas are for HertzContact")
    return law.stiffness * HERTZ_IMPULSE * math.sqrt(2.0 / gap) * oscillator.period / (2.0 * math.pi)


def soft_kick(oscillator: ImpactOscillator, excess: float) -> float:
    """phi_1^2 P of the collision that ends the motion without impacts [m/s]."""
    peak = excess * oscillator.stop.gap
    return float(oscillator.model.phi[0]) ** 2 * impulse_per_square(oscillator) * peak**2


def doubling_of(oscillator: ImpactOscillator) -> float | None:
    """F/F_g - 1 at which p1 with one touch loses its stability by the formula; None if it does not."""
    less, more = survival_sums(oscillator)
    if more <= 0.0:
        return None
    per_square = impulse_per_square(oscillator)
    peak = 0.5 / (more * per_square)
    return (peak + per_square * peak**2 * less) / oscillator.stop.gap


def doubling_by_shooting(oscillator: ImpactOscillator) -> float | None:
    """The same on the exact branch, next to the formula's approach velocity; None if there is none."""
    _less, more = survival_sums(oscillator)
    if more <= 0.0:
        return None
    unit = 2.0 * math.pi / oscillator.period * oscillator.stop.gap
    speed = unit * math.sqrt(1.0 / (more * impulse_per_square(oscillator) * oscillator.stop.gap))
    family = Shooting(oscillator=oscillator, period=1)
    branch = follow(family, family.at_speed(speed), low=speed / 3.0, high=3.0 * speed, step=0.5)
    return next((orbit.excess for orbit in branch.of_kind("period doubling")), None)


def collision_at(oscillator: ImpactOscillator, excess: float) -> Collision:
    """The collision that ends the motion without impacts at `excess`."""
    return first_collision(oscillator.with_excess(excess))


def power_at(oscillator: ImpactOscillator, excess: float) -> float:
    """d ln(kick velocity)/d ln(excess)."""
    places = excess * RATIO**-0.5, excess * RATIO**0.5
    low, high = (collision_at(oscillator, place).kick_velocity for place in places)
    return math.log(high / low) / math.log(RATIO)


def kicks_of(oscillator: ImpactOscillator, excesses: Sequence[float], plateau: float) -> list[BeamKick]:
    """The kicks, with their limits for small and for large excess."""
    rows, unit = [], 2.0 * math.pi / oscillator.period * oscillator.stop.gap
    for excess in excesses:
        found = collision_at(oscillator, excess)
        rows.append(BeamKick(
            excess=excess, kick_velocity=found.kick_velocity, kick=found.kick,
            slope=power_at(oscillator, excess), soft_law=soft_kick(oscillator, excess),
            hard_law=plateau * unit * math.sqrt(excess * (2.0 + excess)), contact_time_s=found.contact_time,
            restitution=found.restitution,
        ))  # fmt: skip
    return rows


def born_orbits(oscillator: ImpactOscillator, excesses: Sequence[float], cycles: int = CYCLES) -> list[Born]:
    """What the motion settles on at rising excesses.

    Gently: the state is carried along from excess to excess, from the grazing motion on. In one step: from
    the motion without impacts at -1e-3, as by an experiment of finite steps.
    """
    strobed = StroboscopicMap(oscillator=oscillator)
    state, below, rows = strobed.at(0.0).steady(), strobed.at(-1e-3).steady(), []
    for excess in excesses:
        found: dict[str, int | None] = {}
        for name, start in (("gently", state), ("in_one_step", below)):
            try:
                settled = settle_finely(strobed, start, excess, cycles)
            except ContactError:
                found |= {f"period_{name}": None, f"impacts_{name}": None}
                continue
            found |= {f"period_{name}": settled.period, f"impacts_{name}": settled.impacts}
            if name == "gently":
                state = settled.end
        rows.append(Born(excess=excess, **found))
    return rows


def settle_finely(strobed: StroboscopicMap, state: Any, excess: float, cycles: int) -> Settled[Any]:
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


def beam_of(scene: Scene, frequency: float, points: int) -> tuple[Beam, list[BeamKick], list[Born]]:
    """All of it at one frequency, with `points` excesses of the kick."""
    scene = scene.replace({"contact.law": "hertz"}, provenance="Hertz contact")
    model = model_of(scene)
    oscillator = beam_at(scene, frequency, model)
    plateau = collision_at(oscillator, letter.TIME_TRACE_EXCESS).kick
    beam = Beam(
        frequency_hz=frequency, modes=model.n_modes, plateau=plateau,
        hertz_stiffness=hertz_of(scene).stiffness,
        half_excess=reach_of(lambda e: collision_at(oscillator, e).kick - 0.5 * plateau, 1e-8, 1e-2),
        square_root_from=reach_of(lambda e: power_at(oscillator, e) - 0.6, 1e-5, 1e-1),
        square_law_up_to=reach_of(lambda e: power_at(oscillator, e) - 1.9, 1e-7, 1e-3),
        doubling_theory=doubling_of(oscillator), doubling_excess=doubling_by_shooting(oscillator),
        doubling_theory_by_frequency={
            f"{f:g}": doubling_of(beam_at(scene, f, model)) for f in sorted(set(scene.drive.frequencies_hz))
        },
    )  # fmt: skip
    kicks = kicks_of(oscillator, np.geomspace(1e-7, 1e-1, points).tolist(), plateau)
    return beam, kicks, born_orbits(oscillator, np.geomspace(1e-7, 1e-2, max(11, points * 5 // 7)).tolist())
