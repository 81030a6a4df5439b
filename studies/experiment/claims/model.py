"""The p_m orbits against the energy lost in a collision, and the period born on other springs.

**Loss.** The free period T and the decay rate mu fix the map (Eqs. (2), (3)) at a drive frequency, with it
the band m, and the family of p_m orbits of Eq. (1) itself, by its approach speed v. The secondary bifurcation
of the node p_m is where it first has a second impact, or a multiplier -1, above its fold. Either happens once
along the family: between two impacts x - gap is linear in v, and the trace of the multipliers is p + q/v. The
fold counts where its orbit has no second impact. The hysteresis 1 - F_m/F_g in the drive amplitude falls with
the loss; |rho_m| itself rises in the map, because rho per F falls faster.

**Universality.** At equal f T, T the damped period of the lowest mode, each spring is to have just above
grazing the period that the map has as rho -> 0+.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from scipy.optimize import bisect

from beam import ModalModel
from contact import MapFamily, MaximalFamily, NordmarkMap, maximal_m
from contact.orbits import Orbit, onset_m
from studies.physics.calibration import bare_cantilever, with_mass_ratio
from studies.physics.descriptions import falls, strobed_at
from studies.shell.scene import Scene, model_of, nordmark_at, single_mode_at, single_mode_of

SPAN = (0.802, 0.956)  # f T from the band of p3 to that of p11

RESTITUTIONS = tuple(np.round(np.linspace(0.0, 0.9, 19), 3).tolist())  # tau of the curves

ABOVE, FASTEST, EXACT = 1e-6, 10.0, 1e-14
"""The bifurcation is looked for from next to the fold (relative) to this approach speed over 2 pi f gap, far
beyond the letter's amplitudes, to a relative accuracy."""

MOST_CYCLES = 3000  # bound of a transient [drive periods]


@dataclass(frozen=True, kw_only=True)
class Node:
    """The node p_m at one frequency and restitution, by the map and by Eq. (1); NaN without a fold."""

    frequency_hz: float
    m: int
    restitution: float
    rho: Annotated[float, "ρ_m of the map"]
    fold_of_map: Annotated[float, "fold of the map, F/F_g − 1"]
    secondary_of_map: Annotated[float, "first bifurcation of the map, F/F_g − 1; none where there is none"]
    fold: Annotated[float, "fold of Eq. (1), F/F_g − 1"]
    secondary: Annotated[float, "first bifurcation of Eq. (1), F/F_g − 1; none where there is none"]
    admissible: Annotated[bool, "one impact at the fold of Eq. (1)"]


def has_one_impact(orbit: Orbit) -> bool:
    """Whether an orbit is stable and touches once in its period."""
    return orbit.admissible and orbit.stable


def family_at(scene: Scene, frequency: float, m: int) -> MaximalFamily:
    """The orbits p_m of Eq. (1), `m` drive periods, at a drive frequency [Hz]."""
    return MaximalFamily(oscillator=single_mode_at(scene, frequency), m=m)


def end_speed(family: MaximalFamily, fold: Orbit) -> float:
    """Approach speed [m/s] of the first bifurcation of the node above its fold, infinity if there is none."""
    low, high = (1.0 + ABOVE) * fold.speed, FASTEST * family.oscillator.unit_speed
    if not has_one_impact(family.orbit(low)):
        return low
    if has_one_impact(family.orbit(high)):
        return math.inf
    return float(
        bisect(lambda v: has_one_impact(family.orbit(v)) - 0.5, low, high, xtol=EXACT * low, rtol=EXACT)
    )


def end_of_map(nordmark: NordmarkMap, m: int) -> float:
    """The excess of that of the map; NaN where p_m is not stable."""
    top = (MapFamily(nordmark, m).stable_range() or (math.nan, math.nan))[1]
    return nordmark.excess(top) if math.isfinite(top) else top


def node_at(scene: Scene, frequency: float) -> Node:
    """The node of the period that belongs to this frequency."""
    nordmark = nordmark_at(scene, frequency)
    m = maximal_m(nordmark)
    family, of_map = family_at(scene, frequency, m), MapFamily(nordmark, m).fold()
    least, end = family.fold(), math.nan
    if least is not None and least.admissible:
        end = end_speed(family, least)
    return Node(
        frequency_hz=frequency,
        m=m,
        restitution=nordmark.restitution,
        rho=math.nan if of_map is None else of_map.rho,
        fold_of_map=math.nan if of_map is None else of_map.excess,
        secondary_of_map=end_of_map(nordmark, m),
        fold=math.nan if least is None else least.excess,
        secondary=family.excess(end) if math.isfinite(end) else end,
        admissible=not math.isnan(end),
    )


def line_of(scene: Scene, frequencies: Sequence[float], restitution: float) -> list[Node]:
    """The nodes of one restitution."""
    changed = scene.replace({"single_mode.restitution": restitution})
    return [node_at(changed, frequency) for frequency in frequencies]


def below_grazing(scene: Scene, frequencies: Sequence[float], restitution: float) -> tuple[float, float]:
    """At which part of the frequencies the node of Eq. (1) has gone, by a secondary bifurcation, before
    grazing; and the lowest excess at which that of the map goes."""
    changed, gone, ends = scene.replace({"single_mode.restitution": restitution}), [], []
    for frequency in frequencies:
        nordmark = nordmark_at(changed, frequency)
        m = maximal_m(nordmark)
        at_grazing = family_at(changed, frequency, m).orbits(0.0)  # it has moved past its fold, if it has one
        gone.append(bool(at_grazing) and not has_one_impact(at_grazing[-1]))
        ends.append(end_of_map(nordmark, m))
    return float(np.mean(gone)), float(np.nanmin(ends))


def trends(rows: Sequence[Node]) -> dict[str, bool]:
    """Whether the size of each quantity falls with the energy lost, at every frequency."""
    good = {"map": True, "eq1": True, "rho": True}
    for frequency in {row.frequency_hz for row in rows}:
        mine = sorted((r for r in rows if r.frequency_hz == frequency), key=lambda row: -row.restitution)
        good["map"] &= falls([-row.fold_of_map for row in mine])
        good["rho"] &= falls([-row.rho for row in mine])
        good["eq1"] &= falls([-row.fold for row in mine if row.admissible])
    return good


@dataclass(frozen=True, kw_only=True)
class Born:
    """The period that one spring is born with at one f T; None where it could not be followed."""

    spring: str
    f_times_t: Annotated[float, "f T"]
    m: Annotated[int | None, "born period; 0 where the motion did not settle"]
    map: Annotated[int, "period of the map as ρ goes to 0; 0 for none"]
    also: Annotated[int | None, "second period of the map, where bands overlap"]
    next_to_edge: Annotated[bool, "in the upper quarter of the band"]
    closer: Annotated[int | None, "born period at a sixteenth of the excess; where looked at"] = None

    @property
    def agrees(self) -> bool:
        """Whether the map has this period."""
        return self.has(self.m)

    def has(self, m: int | None) -> bool:
        """Whether this is a period of the map."""
        return bool(m) and m in (self.map, self.also)


class Job(NamedTuple):
    """A spring, by its modes and the scene that has its contact law, at f T and an excess [1]."""

    spring: str
    scene: Scene
    model: ModalModel
    f_times_t: float
    excess: float

    def __str__(self) -> str:
        return f"{self.spring}, f T = {self.f_times_t:.4g}"


def springs(scene: Scene) -> list[tuple[str, Scene, ModalModel]]:
    """Springs and contact laws of the comparison; Eq. (1) first."""
    drives = sorted(scene.drive.frequencies_hz)
    middle = drives[len(drives) // 2]
    bare = bare_cantilever(scene, middle)
    heavy = with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.5, middle)
    u, loaded, tau = model_of(scene), model_of(heavy), scene.single_mode.restitution
    linear, hertz, newton = (scene.replace({"contact.law": law}) for law in ("linear", "hertz", "newton"))
    return [
        ("Eq. (1), Newton", newton.replace({"contact.local_restitution": tau}), single_mode_of(scene)),
        ("the spring, linear", linear, u),
        ("the spring, Hertz", hertz, u),
        ("the spring, Newton", newton, u),
        ("bare cantilever, Hertz", bare, model_of(bare)),
        ("heavy-ball cantilever, Hertz", heavy, loaded),
        ("heavy-ball cantilever, Newton", heavy.replace({"contact.law": "newton"}), loaded),
    ]


def born_at(job: Job) -> int:
    """Period that is born; 0 for none."""
    strobed = strobed_at("beam", job.scene, job.f_times_t / job.model.free_period, job.model)
    return onset_m(strobed, job.excess, most_cycles=MOST_CYCLES)
