"""One approach of the tip to the plate, as a row of numbers.

An `Approach` is a spring, a contact law and an excess.  `measure` follows the steady driven motion into its
first collision, or, for `orbit`, lets the motion settle and takes the collision of the settled orbit.  Beside
what `contact.collision` measures, a row holds

    arc_s           v/a, the time in which the arc of the single mode beyond the gap reaches its top [s]
    force_delay_s   mean time of the contact force after t_in: shift / (kick v) [s]
    closed_restitution   sqrt((1 - kick)^2 + 2 a shift / v^2), from kick and shift to leading order [1]
    closed_delay_s  (v/a)(1 + restitution - kick), the delay likewise [s]
    energy_share    energy given to the higher modes over that of the approach, v^2 / (2 phi_1^2) [1]
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.collision import Collision, collisions, first_collision
from contact.errors import ContactError
from contact.orbits.settling import born
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stroboscope import StroboscopicMap

__all__ = ["Approach", "measure", "measure_all", "orbit_collision", "own_contact", "select"]

SETTLE_CYCLES = 4000
"""An orbit with impacts settles within some hundred drive periods; a motion that has not repeated by then is
told as period 0."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Approach:
    """A cell of a curve.

    Parameters
    ----------
    curve, series : str
        What is varied, and which line of that figure this belongs to.
    varied, value : str, float
        Name with unit of the quantity on the axis, and its value here.
    oscillator : ImpactOscillator
        At any amplitude.
    excess : float
        F/F_g - 1 at which it is driven.
    mass_ratio : float
        Tip mass over mass of the leaf [1].
    local_restitution : float
        That of the contact itself, where the curve has one [1].
    orbit : bool
        Measure the settled orbit instead of the first collision.
    """

    curve: str
    series: str
    varied: str
    value: float
    oscillator: ImpactOscillator
    excess: float
    mass_ratio: float = math.nan
    local_restitution: float = math.nan
    orbit: bool = False


def orbit_collision(oscillator: ImpactOscillator) -> tuple[Collision | None, int]:
    """The first collision in the settled orbit and its period; None and 0 if there is no such orbit."""
    settled = born(StroboscopicMap(oscillator=oscillator), oscillator.excess, most_cycles=SETTLE_CYCLES)
    if not settled.period or not settled.impacts:
        return None, settled.period
    trajectory = simulate(oscillator, settled.end, periods=2 * settled.period + 2)
    found = collisions(oscillator, trajectory, unfinished="drop")
    return (found[0] if found else None), settled.period


def measure(approach: Approach) -> dict[str, Any]:
    """The row of an approach; `failure` says why there are no numbers, and is empty otherwise."""
    oscillator = approach.oscillator.with_excess(approach.excess)
    model, law = oscillator.model, oscillator.stop.law
    row: dict[str, Any] = {
        "curve": approach.curve,
        "series": approach.series,
        "varied": approach.varied,
        "value": approach.value,
        "excess": approach.excess,
        "modes": model.n_modes,
        "tip_mass": math.nan if model.tip_mass is None else model.tip_mass,
        "mass_ratio": approach.mass_ratio,
        "law": type(law).__name__,
        "law_value": law.numbers[0],
        "local_restitution": approach.local_restitution,
        "gap_m": oscillator.stop.gap,
        "failure": "",
    }
    found: Collision | None = None
    period = 0
    try:
        if approach.orbit:
            found, period = orbit_collision(oscillator)
        else:
            found = first_collision(oscillator)
    except (ContactError, ValueError) as error:
        row["failure"] = f"{approach.curve}, {approach.series}, {approach.varied} {approach.value:g}: {error}"
    return row | {"orbit_period": period} | _numbers(found, float(model.phi[0]))


def _numbers(found: Collision | None, phi: float) -> dict[str, Any]:
    """What a collision contributes to its row."""
    if found is None:
        return dict.fromkeys(COLUMNS, math.nan) | {"impacts": 0, "forced_by_ringing": False, "returns": False}
    v, a = found.approach, found.deceleration
    square = (1.0 - found.kick) ** 2 + 2.0 * a * found.shift / v**2
    return {
        "approach_velocity": v,
        "restitution": found.restitution,
        "delay_s": found.delay,
        "kick": found.kick,
        "shift_m": found.shift,
        "contact_s": found.contact_time,
        "arc_s": v / a,
        "force_delay_s": found.shift / found.kick_velocity if found.kick_velocity else math.nan,
        "closed_restitution": math.sqrt(square) if square >= 0.0 else math.nan,
        "closed_delay_s": v / a * (1.0 + found.restitution - found.kick),
        "energy_to_higher_modes": found.energy_to_higher_modes,
        "energy_share": found.energy_to_higher_modes * 2.0 * phi**2 / v**2,
        "energy_lost": found.energy_lost,
        "impacts": found.impacts,
        "forced_by_ringing": found.forced_by_ringing,
        "returns": found.returns,
    }


COLUMNS = (
    "approach_velocity", "restitution", "delay_s", "kick", "shift_m", "contact_s", "arc_s", "force_delay_s",
    "closed_restitution", "closed_delay_s", "energy_to_higher_modes", "energy_share", "energy_lost",
)


def measure_all(
    approaches: Sequence[Approach], workers: int, tell: Callable[[], None] = lambda: None
) -> list[dict[str, Any]]:
    """The rows in the order of `approaches`, computed by `workers` threads."""

    def one(approach: Approach) -> dict[str, Any]:
        row = measure(approach)
        tell()
        return row

    with ThreadPoolExecutor(max_workers=workers) as pool:
        return list(pool.map(one, approaches))


def select(rows: Sequence[dict[str, Any]], curve: str, series: str | None = None) -> list[dict[str, Any]]:
    """The rows of a curve, or of one of its series, by rising value; failed cells are left out."""
    kept = [r for r in rows if r["curve"] == curve and series in (None, r["series"]) and not r["failure"]]
    return sorted(kept, key=lambda row: float(np.nan_to_num(row["value"], nan=math.inf)))


def own_contact(rows: Sequence[dict[str, Any]], curve: str) -> list[dict[str, Any]]:
    """The rows of a curve with the contact of the scene, which has no series of its own if it is Hertz's."""
    return select(rows, curve, "scene") or select(rows, curve, "hertz")
