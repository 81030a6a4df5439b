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
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from beam import ModalModel
from contact.errors import ContactError
from contact.maximal_orbits import fold as fold_of_map
from contact.nordmark import NordmarkMap
from contact.orbits.continuation import fold_of
from contact.orbits.kick import Kick, KickFamily, KickOrbit
from contact.orbits.shooting import PeriodicOrbit, Shooting
from contact.orbits.single_impact import MaximalFamily
from studies.instruments.oscillators import beam_of, nordmark_of, single_mode_oscillator
from studies.instruments.scene import Scene

__all__ = ["CAUSES", "CHAIN", "DESCRIPTIONS", "Fold", "folds_at", "shares"]

CHAIN = (
    "map", "single_mode", "measured_kick", "kick_of_velocity", "two_parameters", "all_mode_kick", "beam",
)
DESCRIPTIONS = ("map_printed", "map_measured_kick", *CHAIN)

CAUSES = {
    "truncation of the map": ("map", "single_mode"),
    "size of the kick": ("single_mode", "measured_kick"),
    "restitution against velocity": ("measured_kick", "kick_of_velocity"),
    "delay": ("kick_of_velocity", "two_parameters"),
    "higher modes in the flight": ("two_parameters", "all_mode_kick"),
    "ringing met by the next collision": ("all_mode_kick", "beam"),
}
"""Cause -> the two neighbours in the chain between which it lies."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """Where a p_m orbit ends, in all descriptions.

    Parameters
    ----------
    frequency : float
        [Hz]
    period : int
        m.
    excess : mapping
        Description -> F_m/F_g - 1, None where there is no fold.
    estimated_error : float or None
        What the kick description says of its own error [1].
    orbit : PeriodicOrbit or None
        The beam's orbit at its fold.
    kick_orbit : KickOrbit or None
        The same of the all-mode kick.
    """

    frequency: float
    period: int
    excess: Mapping[str, float | None]
    estimated_error: float | None
    orbit: PeriodicOrbit | None
    kick_orbit: KickOrbit | None


def map_fold(nordmark: NordmarkMap, period: int, *, kick: float | None = None) -> float | None:
    """F_m/F_g - 1 of the map; `kick` stands for 1 + tau in the scale of rho."""
    found = fold_of_map(nordmark, period)
    if found is None or found.rho >= 0:
        return None
    scale = 1.0 if kick is None else (kick / (1.0 + nordmark.restitution)) ** 2
    return scale * nordmark.excess(found.rho)


def one_mode(kick: Kick, *, velocity: float, shift: float) -> Kick:
    """A kick of mode 1 alone, with its jump of velocity and of displacement replaced."""
    jump = np.zeros_like(kick.jump)
    jump[0] = shift, velocity
    return Kick(speed=kick.speed, jump=jump, touches=kick.touches, duration=kick.duration)


def folds_at(
    scene: Scene, frequency: float, period: int, model: ModalModel, near: PeriodicOrbit | None = None
) -> Fold:
    """All descriptions of the end of p_m at one frequency.

    Parameters
    ----------
    scene : Scene
    frequency : float
        [Hz]
    period : int
        m.
    model : ModalModel
        Modes of the scene's spring.
    near : PeriodicOrbit, optional
        The beam's fold at a neighbouring frequency.
    """
    excess: dict[str, float | None] = dict.fromkeys(DESCRIPTIONS)
    nordmark = nordmark_of(scene, frequency)
    excess["map"] = map_fold(nordmark, period)
    printed = NordmarkMap.from_oscillator(single_mode_oscillator(scene, frequency), y_line="printed")
    excess["map_printed"] = map_fold(printed, period)
    single = MaximalFamily.from_oscillator(single_mode_oscillator(scene, frequency), period=period).fold()
    excess["single_mode"] = None if single is None else single.excess

    oscillator = beam_of(scene, frequency, model)
    kicks = KickFamily(oscillator=oscillator, period=period)
    whole = kicks.fold()
    if whole is None:
        return Fold(
            frequency=frequency,
            period=period,
            excess=excess,
            estimated_error=None,
            orbit=None,
            kick_orbit=None,
        )
    excess["all_mode_kick"] = whole.excess
    reference = whole.kick
    relative = float(-oscillator.model.phi[0] * reference.jump[0, 1] / reference.speed)
    excess["map_measured_kick"] = map_fold(nordmark, period, kick=relative)
    slope = reference.jump[0, 1] / reference.speed

    def constant(speed: float) -> Kick:
        return one_mode(
            Kick(speed=speed, jump=reference.jump, touches=1, duration=0.0), velocity=slope * speed, shift=0.0
        )

    def of_velocity(speed: float) -> Kick:
        kick = kicks.kick(speed)
        return one_mode(kick, velocity=kick.jump[0, 1], shift=0.0)

    def two(speed: float) -> Kick:
        kick = kicks.kick(speed)
        return one_mode(kick, velocity=kick.jump[0, 1], shift=kick.jump[0, 0])

    for name, kick in (
        ("measured_kick", constant),
        ("kick_of_velocity", of_velocity),
        ("two_parameters", two),
    ):
        found = kicks.fold(kick=kick)
        excess[name] = None if found is None else found.excess
    family = Shooting(oscillator=oscillator, period=period, impacts=whole.kick.touches)
    orbit = None
    for start in (near, None):
        try:
            orbit = fold_of(family, start)
        except ContactError:
            orbit = None
        if orbit is not None or start is None:
            break
    if orbit is not None:
        excess["beam"] = orbit.excess
    return Fold(
        frequency=frequency, period=period, excess=excess, estimated_error=kicks.error(whole), orbit=orbit,
        kick_orbit=whole,
    )


def shares(fold: Fold) -> dict[str, float | None]:
    """The share of each cause in the change of the hysteresis from map to beam, as natural logarithms that
    add up."""
    found: dict[str, float | None] = {}
    for cause, (before, after) in CAUSES.items():
        a, b = fold.excess[before], fold.excess[after]
        found[cause] = None if a is None or b is None or a * b <= 0 else float(np.log(b / a))
    return found


def row_of(fold: Fold, coexisting: list[int]) -> dict[str, Any]:
    """A row of the table."""
    orbit = fold.orbit
    return {
        "frequency_hz": fold.frequency,
        "m": fold.period,
        **fold.excess,
        "estimated_error_of_kick": fold.estimated_error,
        "beam_impacts": None if orbit is None else orbit.impacts,
        "beam_admissible": None if orbit is None else orbit.admissible,
        "beam_speed_m_s": None if orbit is None else orbit.speed,
        "coexisting": coexisting,
        "causes": shares(fold),
    }
