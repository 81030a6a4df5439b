"""One p_m orbit at one frequency in nine descriptions, from the map to the beam; and the bands of p_m.

Each description differs from the one before in one thing:

    map                     Eqs. (2), (3), corrected, tau of the letter
    single_mode             Eq. (1): the map's own truncation removed
    measured_kick           one mode, kick of the beam's collision at the fold, the same at every velocity
    kick_of_velocity        one mode, kick against velocity
    two_parameters          one mode, kick and shift against velocity: the letter's energy loss and time delay
    all_mode_kick           all modes, the collision entered from rest
    beam                    all modes, the collision entered with the ringing that the last one left

Beside them: map_printed (the letter's y-line as stored) and map_measured_kick (the beam's kick for 1 + tau).

With alpha = 2 sqrt(gamma) cos(theta) and gamma = exp(-mu/f) the edges of ``contact.frequency_band`` are
curves in the plane of alpha and gamma, with mu as parameter. The experiment crosses them along its own mu.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated

import numpy as np

from beam import ModalModel
from contact import NordmarkMap
from contact.orbits import KickFamily, PeriodicOrbit, Shooting, fold_along_frequency, fold_excess, follow
from studies.physics.descriptions import fold_at
from studies.physics.two_parameters import fold_of_kicks, one_mode_fold
from studies.shell.scene import Scene, band_of, beam_at, corresponding, nordmark_at, periods_of

CHAIN = ("map", "single_mode", "measured_kick", "kick_of_velocity", "two_parameters", "all_mode_kick", "beam")
DESCRIPTIONS = ("map_printed", "map_measured_kick", *CHAIN)

NAMES = "truncation_of_the_map size_of_the_kick kick_against_velocity delay higher_modes_in_the_flight"
CAUSES = dict(zip(f"{NAMES} ringing_met_by_the_next_collision".split(), pairwise(CHAIN), strict=True))
"""Cause -> the two neighbours in the chain between which it lies."""

FREQUENCIES_HZ = (19.6, 23.8)  # of the letter's spring; others at the same f T

EDGE = 1e-7  # distance of the last frequency in a band from its upper edge, relative to the band

BELOW_BAND = 0.5
"""How far below its band in the map a period is looked for, in widths of the band: there it coexists."""


@dataclass(frozen=True, kw_only=True)
class Folds:
    """F_m/F_g - 1 at the fold of p_m in all descriptions; None where there is none."""

    frequency_hz: float
    m: int
    map_printed: Annotated[float | None, "map as printed"] = None
    map_measured_kick: Annotated[float | None, "map with the beam's kick for 1 + τ"] = None
    map: float | None = None
    single_mode: Annotated[float | None, "Eq. (1)"] = None
    measured_kick: Annotated[float | None, "one mode, the beam's kick"] = None
    kick_of_velocity: Annotated[float | None, "one mode, kick against velocity"] = None
    two_parameters: Annotated[float | None, "one mode, restitution and delay"] = None
    all_mode_kick: Annotated[float | None, "kick of all modes"] = None
    beam: float | None = None
    beam_admissible: Annotated[
        bool | None, "the beam's orbit exists; it would touch a second time otherwise"
    ] = None

    def ratio(self, description: str, reference: str = "beam") -> float | None:
        """Its hysteresis over that of the reference; None unless both end on the same side of grazing."""
        a, b = getattr(self, description), getattr(self, reference)
        return None if a is None or b is None or a * b <= 0.0 else a / b

    def factor(self, cause: str) -> float | None:
        """What a cause multiplies the hysteresis by; the product of all leads from the map to the beam."""
        before, after = CAUSES[cause]
        return self.ratio(after, before)


def map_fold(nordmark: NordmarkMap, m: int, kick: float | None = None) -> float | None:
    """The fold of the map where it lies below grazing; `kick` replaces 1 + tau in the scale of rho."""
    found = fold_excess(nordmark, m)
    scale = 1.0 if kick is None else (kick / (1.0 + nordmark.restitution)) ** 2
    return None if found is None or found >= 0.0 else scale * found


def folds_at(
    scene: Scene, frequency: float, m: int, model: ModalModel, near: PeriodicOrbit | None = None
) -> tuple[Folds, PeriodicOrbit | None]:
    """All descriptions of the end of p_m at `frequency` [Hz], and the beam's orbit at its fold.

    `near` is that at a neighbouring frequency, if known.
    """
    nordmark, oscillator = nordmark_at(scene, frequency), beam_at(scene, frequency, model)
    row = Folds(
        frequency_hz=frequency,
        m=m,
        map=map_fold(nordmark, m),
        map_printed=map_fold(replace(nordmark, y_line="printed"), m),
        single_mode=fold_at("single_mode", scene, frequency, m),
    )
    kicks = KickFamily(oscillator=oscillator, m=m)
    whole = kicks.fold()
    if whole is None:
        return row, None
    slope = float(whole.kick.jump[0, 1]) / whole.kick.speed

    shooting = Shooting(oscillator=oscillator, m=m, impacts=whole.kick.impacts)
    fold = fold_along_frequency(shooting, np.array([frequency]), near)[0]
    orbit = fold if isinstance(fold, PeriodicOrbit) else None
    row = replace(
        row,
        map_measured_kick=map_fold(nordmark, m, -float(model.phi[0]) * slope),
        measured_kick=one_mode_fold(kicks, lambda speed: (0.0, slope * speed)),
        kick_of_velocity=one_mode_fold(kicks, lambda speed: (0.0, float(kicks.kick(speed).jump[0, 1]))),
        two_parameters=fold_of_kicks(kicks),
        all_mode_kick=whole.excess,
        beam=None if orbit is None else orbit.excess,
        beam_admissible=None if orbit is None else orbit.admissible,
    )
    return row, orbit


def column(scene: Scene, model: ModalModel, step: float, m: int) -> list[Folds]:
    """The folds of p_m over the frequencies where it can exist, each started from its neighbour."""
    edges = band_of(scene, m)
    below = edges.lower - BELOW_BAND * (edges.upper - edges.lower)
    low = max(corresponding(scene, FREQUENCIES_HZ[0]), below)
    grid = np.arange(FREQUENCIES_HZ[0], FREQUENCIES_HZ[1] + 1e-9, step)
    values = {round(corresponding(scene, float(f)), 6) for f in grid}
    values |= {f for f, seen in periods_of(scene).items() if seen == m}
    rows, near = list[Folds](), None
    for frequency in sorted((f for f in values if low <= f < edges.upper), reverse=True):
        row, near = folds_at(scene, frequency, m, model, near)
        rows.append(row)
    return rows[::-1]


@dataclass(frozen=True, kw_only=True)
class Inside:
    """Hysteresis 1 - F_m/F_g at a frequency of the band of p_m, map and Eq. (1); 0 without a fold."""

    m: int
    frequency_hz: float
    map: Annotated[float, "hysteresis 1 − F_m/F_g of the map"]
    eq1: Annotated[float, "hysteresis 1 − F_m/F_g of Eq. (1)"]


def inside_band(scene: Scene, count: int, m: int) -> list[Inside]:
    """The hysteresis from the lower edge of a band to just below its upper one."""
    edges = band_of(scene, m)
    places = np.linspace(edges.lower, edges.upper, count)
    places[-1] = edges.upper - EDGE * (edges.upper - edges.lower)
    return [
        Inside(
            m=m,
            frequency_hz=frequency,
            map=0.0 - (fold_at("map", scene, frequency, m) or 0.0),
            eq1=0.0 - (fold_at("single_mode", scene, frequency, m) or 0.0),
        )
        for frequency in places.tolist()
    ]


@dataclass(frozen=True)
class OnBranch:
    """An orbit p_m of the beam on its branch."""

    excess: float
    speed: Annotated[float, "approach speed [m/s]"]
    stable: bool
    admissible: Annotated[bool, "touches the stop nowhere else"]
    event: Annotated[str, "event of the branch; empty between events"]


def branch_of(scene: Scene, frequency: float, m: int, model: ModalModel) -> list[OnBranch]:
    """The orbits p_m of the beam at `frequency` [Hz] by their speed; empty where the branch has no fold."""
    family = Shooting(oscillator=beam_at(scene, frequency, model), m=m)
    fold = family.fold()
    if fold is None:
        return []
    family = replace(family, impacts=fold.impacts)
    branch = follow(family, fold, low=2e-3 * fold.speed, high=4.0 * fold.speed, step=0.05)
    found = [*((orbit, "") for orbit in branch.orbits), *((one.orbit, one.kind) for one in branch.events)]
    rows = [OnBranch(one.excess, one.speed, one.stable, one.admissible, kind) for one, kind in found]
    return sorted(rows, key=lambda row: row.speed)


def path_of(scene: Scene) -> list[NordmarkMap]:
    """The maps along the frequencies of the experiment."""
    low, high = (corresponding(scene, f) for f in FREQUENCIES_HZ)
    return [nordmark_at(scene, f) for f in np.linspace(low, high, 200).tolist()]
