r"""Where to measure next: the information on parameters p in one orbit, over frequency and excess.

N strobes of a settled p_m measure its m strobe points y_j(p), each N/m times. With the noise s of the
read-out, standard errors s_0 of the parameters before, and the measured amplitude A_g at grazing,

    information  M = (N/m) sum_j J_j^T J_j/s^2 + g g^T/s_0^2 + 1/s_0^2,    J_j = dy_j/dp,   g = dA_g/dp.

With C = M^-1 a parameter's error is C_ii^(1/2), or M_ii^(-1/2) with all others known. The error of n
together is det(C_n)^(1/2n) in units of their values, the geometric mean of the half axes of their ellipsoid
(D-criterion).

**Limit of one orbit.** Between touches the points obey T, mu and the drive; the touch joins the incoming
flight to the outgoing one. At any level where these meet there is a gap with a delay and a restitution that
give the same points. So the three follow from one p_m if the gap is known, or from two p_m of unlike speeds.

**Limit of linear theory.** Towards a fold, D away in excess, y_j - y_fold ~ D^(1/2) and J grows without
bound. Linear theory holds while the orbit outlives the errors: D has the standard error (d^T C d)^(1/2),
d = dD/dp. A place counts if p_m exists and is stable with the excess that much lower and higher. This also
leaves out places as close to a second impact or a doubling, where J stays finite. Without a fold D is the
excess. An error beyond the value itself only says that the parameter is not determined.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from contact import ContactError, ImpactOscillator, NewtonRestitution, NordmarkMap, maximal_m
from contact.orbits import KickFamily, PeriodicOrbit, Shooting, excess_derivatives, orbit_derivatives
from studies import letter
from studies.physics.parameters import changes_of, parameters_of
from studies.shell.columns import UNITS

Array = NDArray[np.float64]
Of = Callable[[float], ImpactOscillator]
"""Drive frequency [Hz] to oscillator."""

STABLE = letter.AMPLITUDE_STABILITY
FREQUENCIES_HZ = np.linspace(20.5, 23.6, 63).tolist()
EXCESSES = sorted({0.0, *(way * STABLE * 2.0 ** (0.5 * k) for k in range(13) for way in (-1, 1))})
"""The plane of frequency and excess."""

THIN = 2, 6  # every so many places of the plane, both ways: the full form, the small one
UNSEEN = 1e-11  # ratio of singular values below which a direction of the parameters is not seen
SPEEDS = 1e-4, 1.0  # approach speeds over 2 pi f gap among which nodes are looked for
APART_HZ = 0.3  # least distance of two of the best places
ALIKE = 0.1  # part by which approach speeds may differ and count as one


@dataclass(frozen=True, kw_only=True)
class Plan:
    """The wanted `names`, number of `strobes` and `noise` of the read-out [m].

    ``before`` has the standard errors of the other unknown parameters, in their units (inf: nothing known),
    ``amplitude_error`` that of any drive amplitude [m].
    """

    names: tuple[str, ...] = ("free_period", "restitution", "delay")
    before: Mapping[str, float] = field(
        default_factory=lambda: {"decay_rate": letter.BREAKDOWN["decay_rate_error_per_s"], "gap": math.inf}
    )
    amplitude_error: float = letter.AMPLITUDE_STABILITY_M
    strobes: int = 1000
    noise: float = 0.5e-6

    @property
    def unknown(self) -> tuple[str, ...]:
        """All unknown parameters, the wanted first and the amplitude last."""
        return *self.names, *self.before, "amplitude"


@dataclass(frozen=True)
class Measurement:
    """Standard errors of the wanted parameters by an orbit p_m."""

    frequency_hz: float
    excess: float
    m: int
    errors: Annotated[Mapping[str, float], "standard error with all else unknown"]
    alone: Annotated[Mapping[str, float], "standard error with all else known"]
    together: Annotated[float, "D-criterion; error of all together over their values"]
    distance: Annotated[float, "excess F/F_g − 1 from the fold"]
    distance_error: Annotated[float, "standard error of that distance"]
    kept: Annotated[bool, "whether the orbit outlives its errors"]


def by_name(orbit: PeriodicOrbit, plan: Plan, numbers: Array) -> dict[str, float]:
    """Numbers of the wanted parameters by their names with units."""
    known = parameters_of(orbit.oscillator)
    units = [UNITS.get(known[name].unit) for name in plan.names]
    names = [f"{name}_{unit}" if unit else name for name, unit in zip(plan.names, units, strict=True)]
    return dict(zip(names, numbers.tolist(), strict=True))


def sizes_of(orbit: PeriodicOrbit, plan: Plan) -> Array:
    """The value of each unknown parameter, or the size that a change of it is measured by."""
    known = parameters_of(orbit.oscillator)
    return np.array([known[name].size for name in plan.unknown])


def changed(orbit: PeriodicOrbit, plan: Plan) -> tuple[Array, Array]:
    """Derivatives of the readings over their noise, and of the excess, by the unknowns over their sizes."""
    found = orbit_derivatives(orbit, changes_of(orbit.oscillator, plan.unknown))
    phi, weight = orbit.oscillator.model.phi, math.sqrt(plan.strobes / orbit.m) / plan.noise
    rows = weight * np.einsum("i,jip->jp", phi, found.strobes_changed[:, : phi.size])
    grazing, sizes = found.changes.grazing_amplitude / plan.amplitude_error, sizes_of(orbit, plan)
    return np.vstack([rows, grazing]) * sizes, found.excess * sizes


def covariance(orbits: Sequence[PeriodicOrbit], plan: Plan) -> Array:
    """C in units of sizes, with an amplitude for each orbit; infinite where they do not determine all."""
    n, own, sizes = len(plan.names), len(plan.unknown) - 1, sizes_of(orbits[0], plan)
    before = sizes[n:own] / list(plan.before.values())
    rows = [np.diag([*np.zeros(n), *before, *(one.amplitude / plan.amplitude_error for one in orbits)])]
    for i, orbit in enumerate(orbits):
        found = changed(orbit, plan)[0]
        rows.append(np.zeros((len(found), own + len(orbits))))
        rows[-1][:, [*range(own), own + i]] = found
    whole = np.vstack(rows)
    unit = np.linalg.norm(whole, axis=0)
    _left, singular, right = np.linalg.svd(whole / unit, full_matrices=False)
    if singular[-1] < UNSEEN * singular[0]:
        return np.full(2 * unit.shape, np.inf)
    root = right.T / singular / unit[:, None]
    return np.asarray(root @ root.T)


def errors_of(orbits: Sequence[PeriodicOrbit], plan: Plan) -> Array:
    """Standard errors of the wanted parameters by several orbits together."""
    errors = np.sqrt(np.diag(covariance(orbits, plan))[: len(plan.names)])
    return np.asarray(errors * sizes_of(orbits[0], plan)[: errors.size])


class Nodes:
    """The stable, admissible orbits p_m, `m` drive periods, at approach speeds above that of the fold."""

    def __init__(self, oscillator: ImpactOscillator, m: int) -> None:
        self.family = KickFamily(oscillator=oscillator, m=m)
        self.exact, low = Shooting(oscillator=oscillator, m=m), self.family.fold()
        self.fold = self.exact.at_speed(low.speed) if low else None
        slow, fast = (part * oscillator.unit_speed for part in SPEEDS)
        self.speeds = (low.speed if low else slow), fast
        self.excesses = tuple(self.family.excess(speed) for speed in self.speeds)

    def at(self, excess: float) -> PeriodicOrbit | None:
        """The orbit at F/F_g - 1 = `excess`."""
        if not self.excesses[0] < excess < self.excesses[1]:
            return None
        speed = brentq(lambda v: self.family.excess(v) - excess, *self.speeds, xtol=1e-12)
        try:
            orbit = self.exact.at_speed(speed)
        except ContactError:
            return None
        return orbit if orbit.stable and orbit.admissible else None


def measurement(orbit: PeriodicOrbit, nodes: Nodes, plan: Plan) -> Measurement:
    """The information in one of the `nodes`."""
    n, sizes, cov = len(plan.names), sizes_of(orbit, plan), covariance([orbit], plan)
    (rows, away), seen = changed(orbit, plan), bool(np.isfinite(cov[0, 0]))
    if nodes.fold is not None:
        away = away - excess_derivatives(nodes.fold, changes_of(orbit.oscillator, plan.unknown)) * sizes
    off = math.sqrt(away @ cov @ away) if seen else math.inf
    numbers = np.sqrt(np.diag(cov)[:n]) * sizes[:n], (sizes / np.linalg.norm(rows, axis=0))[:n]
    errors, alone = (by_name(orbit, plan, each) for each in numbers)
    together = float(np.linalg.det(cov[:n, :n]) ** (0.5 / n)) if seen else math.inf
    place, distance = (orbit.oscillator.driven.frequency, orbit.excess), orbit.excess - nodes.excesses[0]
    lasting = seen and None not in [nodes.at(orbit.excess + way * off) for way in (-1, 1)]
    return Measurement(*place, orbit.m, errors, alone, together, distance, off, lasting)


def measurements_at(of: Of, plan: Plan, excesses: Sequence[float], frequency: float) -> list[Measurement]:
    """All orbits at a drive frequency [Hz]: p_m, where m is that of the map there, and its neighbours."""
    oscillator, found = of(frequency), list[Measurement]()
    plastic = replace(oscillator.stop, law=NewtonRestitution(local_restitution=0.0))
    m = maximal_m(NordmarkMap.from_oscillator(replace(oscillator, stop=plastic)))
    for nodes in [Nodes(oscillator, period) for period in range(max(m - 1, 2), m + 2)]:
        orbits = [orbit for orbit in map(nodes.at, excesses) if orbit is not None]
        found += [measurement(orbit, nodes, plan) for orbit in orbits]
    return found


def best(found: Sequence[Measurement], count: int = 5) -> list[Measurement]:
    """The best places that count, well apart in frequency."""
    chosen = list[Measurement]()
    for one in sorted((one for one in found if one.kept), key=lambda one: one.together):
        if all(abs(one.frequency_hz - other.frequency_hz) >= APART_HZ for other in chosen):
            chosen.append(one)
    return chosen[:count]


def letters_orbits(of: Of, excess: float = 1e-3) -> list[PeriodicOrbit]:
    """The orbits of the letter's pairs at an excess; p_(m+1) where p_m is not there."""
    both = [[Nodes(of(f), k).at(excess) for k in (m, m + 1)] for f, m in letter.PERIODS.items()]
    return [orbit for pair in both for orbit in [pair[0] or pair[1]] if orbit is not None]


@dataclass(frozen=True)
class LetterOrbits:
    """Standard errors of the wanted parameters by one or two of the letter's orbits, at excess 0.001."""

    orbits: str
    speed: Annotated[float, "approach velocity at the stop [m/s]"]
    other_speed: Annotated[float | None, "approach velocity of the second orbit [m/s]"]
    errors: Annotated[Mapping[str, float], "standard error with all else unknown"]


def letter_rows(of: Of, plan: Plan) -> list[LetterOrbits]:
    """Each of the letter's orbits alone, then each two that meet the stop with like speeds."""
    six = letters_orbits(of)
    alike = [pair for pair in combinations(six, 2) if abs(pair[0].speed / pair[1].speed - 1.0) < ALIKE]
    rows = list[LetterOrbits]()
    for orbits in [*((orbit,) for orbit in six), *alike]:
        names, errors = " and ".join(f"p{one.m}" for one in orbits), errors_of(orbits, plan)
        second = orbits[1].speed if len(orbits) > 1 else None
        rows.append(LetterOrbits(names, orbits[0].speed, second, by_name(orbits[0], plan, errors)))
    return rows


def findings(found: Sequence[Measurement], letters: Sequence[LetterOrbits]) -> list[str]:
    """The information in the letter's orbits, where they are there, and at the best place: two sentences."""
    single = [row.errors["free_period_s"] for row in letters if row.other_speed is None]
    two = [row for row in letters if row.other_speed is not None]
    said, chosen = list[str](), best(found, 1)
    if not chosen:
        said.append("With this noise no orbit exists at one standard error from its excess.")
    if single:
        error = f"{1e3 * float(np.median(single)):.1g} ms"
        said.append(f"The strobes of one orbit of the letter determine the free period to {error}.")
    if two:
        first = min(two, key=lambda row: row.errors["restitution"])
        error = f"{first.errors['restitution']:.1g}"
        said.append(f"Two orbits together, {first.orbits}, determine the restitution to {error}.")
    if chosen:
        place = f"p{chosen[0].m} at {chosen[0].frequency_hz:.2f} Hz"
        said.append(f"If the amplitude at grazing gives the gap, {place} is the best next measurement.")
    return said[:2]
