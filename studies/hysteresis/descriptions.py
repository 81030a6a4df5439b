"""One p_m orbit at one frequency in nine descriptions, from the map to the beam.

Each description differs from the one before in one thing, so that the difference between the letter's map and
the beam splits into causes (F_m/F_g - 1 is where the p_m orbit ends in a downward scan):

    map                     Eqs. (2), (3), corrected, tau of the letter
    single_mode             Eq. (1): the map's own truncation removed
    measured_kick           one mode, kick of the beam's collision at the fold, the same at every velocity
    kick_of_velocity        one mode, kick against velocity
    two_parameters          one mode, kick and shift against velocity: the letter's energy loss and time delay
    all_mode_kick           all modes, the collision entered from rest
    beam                    all modes, the collision entered with the ringing that the last one left

Beside them: map_printed (the letter's y-line as stored) and map_measured_kick (the beam's kick for 1 + tau).
All are families of orbits with a `fold()`, whose excess is F_m/F_g - 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from beam import ModalModel
from contact import ContactError, MaximalFamily, NordmarkMap, fold
from contact.orbits import Kick, KickFamily, PeriodicOrbit, Shooting, SingleImpactOrbit, fold_of
from studies.scene import Scene, beam_at, nordmark_at, single_mode_at

CHAIN = (
    "map", "single_mode", "measured_kick", "kick_of_velocity", "two_parameters", "all_mode_kick", "beam",
)  # fmt: skip
DESCRIPTIONS = ("map_printed", "map_measured_kick", *CHAIN)

CAUSES = {
    "truncation_of_the_map": ("map", "single_mode"),
    "size_of_the_kick": ("single_mode", "measured_kick"),
    "kick_against_velocity": ("measured_kick", "kick_of_velocity"),
    "delay": ("kick_of_velocity", "two_parameters"),
    "higher_modes_in_the_flight": ("two_parameters", "all_mode_kick"),
    "ringing_met_by_the_next_collision": ("all_mode_kick", "beam"),
}
"""Cause -> the two neighbours in the chain between which it lies."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """F_m/F_g - 1 at the fold of p_m in all descriptions; None where there is none.

    `beam_scan` is where a downward scan of the simulated beam ends; `coexisting` are the other periods whose
    orbits live on below grazing at this frequency. A fold of the beam that is not admissible is one of the
    equations alone: its orbit would touch the stop elsewhere too.
    """

    frequency_hz: float
    m: int
    map_printed: float | None
    map_measured_kick: float | None
    map: float | None
    single_mode: float | None
    measured_kick: float | None
    kick_of_velocity: float | None
    two_parameters: float | None
    all_mode_kick: float | None
    beam: float | None
    beam_scan: float | None = None
    estimated_error_of_kick: float | None
    beam_impacts: int | None
    beam_admissible: bool | None
    beam_speed_m_s: float | None
    coexisting: tuple[int, ...] = ()

    def excess(self, description: str) -> float | None:
        """F_m/F_g - 1 in one of `DESCRIPTIONS`."""
        value: float | None = getattr(self, description)
        return value

    def ratio(self, description: str, reference: str = "beam") -> float | None:
        """Its hysteresis over that of the reference; None unless both end on the same side of grazing."""
        a, b = self.excess(description), self.excess(reference)
        return None if a is None or b is None or a * b <= 0.0 else a / b

    def factor(self, cause: str) -> float | None:
        """What a cause multiplies the hysteresis by; the product of all leads from the map to the beam."""
        before, after = CAUSES[cause]
        return self.ratio(after, before)


class Ended(Protocol):
    """An orbit at its fold."""

    @property
    def excess(self) -> float:
        """F_m/F_g - 1."""


class Family(Protocol):
    """The p_m orbits in one description."""

    def fold(self) -> Ended | None:
        """The orbit of smallest amplitude."""


@dataclass(frozen=True, kw_only=True)
class MapFold:
    """The fold of the map, at F_m/F_g - 1 = `excess`."""

    excess: float


@dataclass(frozen=True, kw_only=True)
class MapFamily:
    """p_m of the map; `kick` stands for 1 + tau in the scale of rho."""

    nordmark: NordmarkMap
    period: int
    kick: float | None = None

    def fold(self) -> MapFold | None:
        """The fold, where it lies below grazing."""
        found = fold(self.nordmark, self.period)
        if found is None or found.rho >= 0.0:
            return None
        scale = 1.0 if self.kick is None else (self.kick / (1.0 + self.nordmark.restitution)) ** 2
        return MapFold(excess=scale * self.nordmark.excess(found.rho))


@dataclass(frozen=True, kw_only=True, eq=False)
class OneMode:
    """p_m of mode 1 alone; `jump` is that of its displacement and velocity, by approach velocity [m/s]."""

    kicks: KickFamily
    jump: Callable[[float], tuple[float, float]]

    def kick(self, speed: float) -> Kick:
        """A kick that leaves the other modes in peace."""
        jump = np.zeros((self.kicks.oscillator.n_modes, 2))
        jump[0] = self.jump(speed)
        return Kick(speed=speed, jump=jump)

    def fold(self) -> SingleImpactOrbit | None:
        """The fold."""
        return replace(self.kicks, collision=self.kick).fold()


@dataclass(frozen=True, kw_only=True, eq=False)
class Exact:
    """p_m of the beam itself, by shooting from the fold `near`, or from that of the kicks."""

    shooting: Shooting
    near: PeriodicOrbit | None

    def fold(self) -> PeriodicOrbit | None:
        """The fold; None also where the search from kicks fails."""
        for start in dict.fromkeys((self.near, None)):
            try:
                found = fold_of(self.shooting, start)
            except ContactError:
                continue
            if found is not None:
                return found
        return None


def folds_at(
    scene: Scene, frequency: float, period: int, model: ModalModel, near: PeriodicOrbit | None = None
) -> tuple[Row, PeriodicOrbit | None]:
    """All descriptions of the end of p_m at `frequency` [Hz], and the beam's orbit at its fold.

    `near` is that at a neighbouring frequency, if known.
    """
    nordmark, oscillator = nordmark_at(scene, frequency), beam_at(scene, frequency, model)
    kicks = KickFamily(oscillator=oscillator, period=period)
    families: dict[str, Family] = {
        "map": MapFamily(nordmark=nordmark, period=period),
        "map_printed": MapFamily(nordmark=replace(nordmark, y_line="printed"), period=period),
        "single_mode": MaximalFamily.from_oscillator(single_mode_at(scene, frequency), period=period),
    }
    whole, orbit = kicks.fold(), None
    found: dict[str, Ended | None] = {"all_mode_kick": whole}
    if whole is not None:
        slope = float(whole.kick.jump[0, 1]) / whole.kick.speed
        relative = -float(model.phi[0]) * slope

        def jump(speed: float) -> tuple[float, float]:
            shift, velocity = kicks.kick(speed).jump[0]
            return float(shift), float(velocity)

        families |= {
            "map_measured_kick": MapFamily(nordmark=nordmark, period=period, kick=relative),
            "measured_kick": OneMode(kicks=kicks, jump=lambda speed: (0.0, slope * speed)),
            "kick_of_velocity": OneMode(kicks=kicks, jump=lambda speed: (0.0, jump(speed)[1])),
            "two_parameters": OneMode(kicks=kicks, jump=jump),
        }
        shooting = Shooting(oscillator=oscillator, period=period, impacts=whole.kick.touches)
        found["beam"] = orbit = Exact(shooting=shooting, near=near).fold()
    found |= {name: family.fold() for name, family in families.items()}
    excess = {name: None if (end := found.get(name)) is None else float(end.excess) for name in DESCRIPTIONS}
    row = Row(
        frequency_hz=frequency, m=period, **excess,  # type: ignore[arg-type]
        estimated_error_of_kick=None if whole is None else kicks.error(whole),
        beam_impacts=None if orbit is None else orbit.impacts,
        beam_admissible=None if orbit is None else orbit.admissible,
        beam_speed_m_s=None if orbit is None else orbit.speed,
    )  # fmt: skip
    return row, orbit
