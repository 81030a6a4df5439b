"""A wall or the beam near grazing: kick of a collision, period doubling of p1, loss of its stability."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.optimize import brentq

from contact import Collision, ImpactOscillator, first_collision
from contact.orbits import PeriodicOrbit, Shooting, follow
from studies import letter
from studies.experiment.soft_wall.closed_forms import SoftWall, hertz_doubling, hertz_kick
from studies.shell.scene import Scene, approach_speed, beam_at

SPAN = 3.0
"""The doubling is looked for between a third and three times the approach velocity that the formula gives."""

CERTAIN, UNDECIDED = "period doubling", "undecided"  # events of a branch

RATIO = 1.05  # ratio of two excesses between which a local power is taken


@dataclass(frozen=True, kw_only=True)
class Kick:
    """Kick of the collision that ends the motion without impacts at `excess`, and its laws."""

    case: Annotated[str, "model; lossless is Eq. (1) with an elastic wall"]
    hardness: Annotated[float | None, "K; none for the beam"]
    excess: float
    kick_velocity: Annotated[float, "kick of mode 1 [m/s]"]
    closed_form: Annotated[float | None, "kick in closed form [m/s]; none for the beam"]
    soft_law: Annotated[float, "kick of a soft touch [m/s]"]
    hard_law: Annotated[float, "kick of a hard wall [m/s]"]
    peak_force: Annotated[float, "largest contact force [N]; in Eq. (1) per unit mass of the mode"]


@dataclass(frozen=True, kw_only=True)
class Doubling:
    """Excess of the period doubling of p1: by shooting and in closed form."""

    frequency_hz: float
    hardness: Annotated[float, "K"]
    event: Annotated[str, "event; undecided where rounding of the multipliers hides it"]
    excess: Annotated[float | None, "excess F/F_g − 1 of the period doubling; by shooting"]
    stable_at: Annotated[float | None, "excess F/F_g − 1 at which p1 is stable; where undecided"]
    unstable_at: Annotated[float | None, "excess F/F_g − 1 at which p1 is unstable; where undecided"]
    closed_form: Annotated[float | None, "excess F/F_g − 1 of the period doubling, in closed form"]


@dataclass(frozen=True, kw_only=True)
class Beam:
    """What the beam with Hertz contact does near grazing; excesses are F/F_g - 1.

    `half_excess`: where half of the kick at Fig. 4 is left, in approach speeds; `square_root_from`: where the
    kick rises with the power 0.6; `doubling_excess`, `doubling_theory`: of p1, by shooting and closed form;
    `unstable_excess`: where p1 is stable no more, by that doubling or, below it, by `turns`, a complex pair
    of multipliers that leaves the unit circle (Neimark and Sacker's bifurcation; one mode has none).
    """

    frequency_hz: float
    half_excess: float | None
    square_root_from: float | None
    doubling_excess: float | None
    doubling_theory: float | None
    unstable_excess: float | None
    turns: bool


def kicks_of(wall: SoftWall, excesses: np.ndarray) -> list[Kick]:
    """The simulated kicks of a wall, the closed form and the two power laws."""
    found = [(e, first_collision(wall.struck.with_excess(e))) for e in excesses.tolist()]
    return [
        Kick(
            case="lossless",
            hardness=wall.hardness,
            excess=e,
            kick_velocity=one.kick_velocity,
            closed_form=wall.kick(e),
            soft_law=wall.soft_law(e),
            hard_law=wall.hard_law(e),
            peak_force=one.peak_force,
        )
        for e, one in found
    ]


def doubling_near(oscillator: ImpactOscillator, peak: float, kind: str = CERTAIN) -> PeriodicOrbit | None:
    """The period doubling of p1 by shooting, next to where its peak is `peak` gaps over the wall."""
    family = Shooting(oscillator=oscillator, m=1)
    speed = oscillator.unit_speed * math.sqrt(2.0 * peak)
    low, high = speed / SPAN, SPAN * speed
    branch = follow(family, family.at_speed(speed), low=low, high=high, step=math.log(SPAN))
    return next(iter(branch.of_kind(kind)), None)


FAINTEST = 1e-6
"""Least speed of a touch, over the speed at the period doubling [1], in the search for a stable p1."""


def loss_of_stability(oscillator: ImpactOscillator, doubling: PeriodicOrbit) -> tuple[float | None, bool]:
    """Excess [1] at which p1 loses its stability below its `doubling`, and whether by a complex pair.

    None if p1 is unstable even at the faintest touch, as without damping.
    """
    family, orbit = Shooting(oscillator=oscillator, m=1), doubling

    def largest(speed: float) -> float:
        nonlocal orbit
        orbit = family.at_speed(speed, orbit)
        return float(np.abs(orbit.multipliers).max()) - 1.0

    speeds = (doubling.speed * np.geomspace(1.0 - 1e-4, 0.02, 40)).tolist()
    sizes = [largest(speed) for speed in speeds]
    while sizes[-1] > 0.0:  # with damping the free motion is stable, and so is p1 if its touch is weak enough
        speeds.append(0.5 * speeds[-1])
        sizes.append(largest(speeds[-1]))
        if speeds[-1] < FAINTEST * doubling.speed:
            return None, False
    outside = np.flatnonzero(np.array(sizes) > 0.0)
    if not outside.size:
        return doubling.excess, False
    last = outside[-1]
    largest(float(brentq(largest, speeds[last + 1], speeds[last], rtol=1e-6)))
    return orbit.excess, bool(abs(orbit.multipliers[0].imag) > 1e-6)


def doubling_of(wall: SoftWall) -> Doubling:
    """Period doubling of p1 beside the formula; where that has none it is looked for at z = 1, its last."""
    closed = wall.doubling()
    peak = wall.peak_of(1.0) if closed is None else closed[0]
    orbit = doubling_near(wall.struck, peak)
    unsure = None if orbit else doubling_near(wall.struck, peak, UNDECIDED)
    beside = dict[bool, float]()
    if unsure:
        for ratio in (0.99, 1.01):  # rounding of the multipliers, up to 1e-4, decides nothing there
            one = Shooting(oscillator=wall.struck, m=1).at_speed(unsure.speed * ratio, unsure)
            beside[one.stable] = one.excess
    return Doubling(
        frequency_hz=wall.frequency,
        hardness=wall.hardness,
        event=CERTAIN if orbit else UNDECIDED if unsure else "none",
        excess=orbit.excess if orbit else None,
        stable_at=beside.get(True),
        unstable_at=beside.get(False),
        closed_form=None if closed is None else closed[1],
    )


def zero_of(measure: Callable[[float], float], low: float, high: float) -> float | None:
    """Excess in [low, high] at which `measure` goes through zero, to 0.1 %; None if it does not."""
    if measure(low) * measure(high) > 0.0:
        return None
    return math.exp(brentq(lambda x: measure(math.exp(x)), math.log(low), math.log(high), xtol=1e-3))


def beam_of(scene: Scene, frequency: float, excesses: Sequence[float]) -> tuple[Beam, list[Kick]]:
    """The beam at one frequency, and its kicks."""
    oscillator = beam_at(scene.replace({"contact.law": "hertz"}), frequency)

    def collision(excess: float) -> Collision:
        return first_collision(oscillator.with_excess(excess))

    def power(excess: float) -> float:
        low, high = (collision(excess * RATIO**side).kick_velocity for side in (-0.5, 0.5))
        return math.log(high / low) / math.log(RATIO)

    plateau, closed = collision(letter.TIME_TRACE_EXCESS).kick, hertz_doubling(oscillator)
    doubling = None if closed is None else doubling_near(oscillator, closed[0])
    lost = (None, False) if doubling is None else loss_of_stability(oscillator, doubling)
    half = zero_of(lambda e: collision(e).kick - 0.5 * plateau, 1e-8, 1e-2)
    beam = Beam(
        frequency_hz=frequency,
        half_excess=half,
        square_root_from=zero_of(lambda e: power(e) - 0.6, 1e-5, 1e-1),
        doubling_excess=None if doubling is None else doubling.excess,
        doubling_theory=None if closed is None else closed[1],
        unstable_excess=lost[0],
        turns=lost[1],
    )
    kicks = [
        Kick(
            case="beam",
            hardness=None,
            excess=e,
            kick_velocity=one.kick_velocity,
            closed_form=None,
            soft_law=hertz_kick(oscillator, e),
            hard_law=plateau * approach_speed(frequency, oscillator.stop.gap, e),
            peak_force=one.peak_force,
        )
        for e, one in ((e, collision(e)) for e in excesses)
    ]
    return beam, kicks
