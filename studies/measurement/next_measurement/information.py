r"""What to measure next: where in the plane of frequency and excess an orbit tells most of parameters p.

N strobes of a settled p_m see the tip at its m strobe points y_j(p), each N/m times. With read-out noise s
and standard errors s_0 of what is known before, A_g the amplitude at grazing, which is measured too,

    information  M = (N/m) sum_j J_j^T J_j/s^2 + g g^T/s_0^2 + 1/s_0^2,    J_j = dy_j/dp,   g = dA_g/dp.

With C = M^-1 a parameter's error is C_ii^(1/2), or M_ii^(-1/2) with all others known; that of n together
is det(C_n)^(1/2n) in units of their values, the geometric mean of the half axes of their ellipsoid
(D-criterion).

**What one orbit cannot tell.** Between touches the points obey T, mu and the drive; the touch joins the
flight that comes to the one that goes. Where these meet any level tells a gap with a delay and a restitution
that give the same points: the three follow from one p_m as far as the gap is known, or from two unlike ones.

**Where it ends.** Towards a fold, D away in excess, y_j - y_fold ~ D^(1/2) and J grows without bound. Linear
theory holds while the orbit outlives the errors: D has the standard error (d^T C d)^(1/2), d = dD/dp, and a
place counts where p_m is there and stable with the excess that much lower and higher. So it leaves out as
well what is as close to a second impact or a doubling, where J stays finite. Without a fold D is the excess.
An error beyond the value itself says no more than that the parameter is not told.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

from contact import ContactError, ImpactOscillator, NewtonRestitution, NordmarkMap, maximal_period
from contact.orbits import KickFamily, PeriodicOrbit, Shooting, excess_derivatives, orbit_derivatives
from studies import letter
from studies.physics.parameters import changes_of, parameters_of
from studies.shell import plotting

Array = NDArray[np.float64]
Of = Callable[[float], ImpactOscillator]
"""Drive frequency [Hz] to oscillator."""

STABLE = letter.AMPLITUDE_STABILITY
FREQUENCIES_HZ = np.linspace(20.5, 23.6, 63).tolist()
EXCESSES = sorted({0.0, *(way * STABLE * 2.0 ** (0.5 * k) for k in range(13) for way in (-1, 1))})
"""The plane of the map."""

UNSEEN, SPEEDS = 1e-11, (1e-4, 1.0)
"""Ratio of singular values below which a direction of the parameters is not seen; approach speeds over
2 pi f gap among which nodes are looked for."""

APART_HZ, ALIKE = 0.3, 0.1
"""Least distance of two of the best places; by which approach speeds may differ and count as one."""

SHOWN = {
    "free_period": ("error of $T$ (ms)", 1e3),
    "decay_rate": ("error of $\\mu$ (1/s)", 1.0),
    "gap": ("error of the gap (mm)", 1e3),
    "restitution": ("error of $\\tau$", 1.0),
    "delay": ("error of the delay (\u00b5s)", 1e6),
}


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Wanted `names`; standard errors `before` of what else is unknown, in its unit (inf: nothing known), and
    of any drive amplitude [m]; number of `strobes`; `noise` of the read-out [m]."""

    names: tuple[str, ...] = ("free_period", "restitution", "delay")
    before: Mapping[str, float] = field(
        default_factory=lambda: {"decay_rate": letter.BREAKDOWN["decay_rate_error_per_s"], "gap": math.inf}
    )
    amplitude_error: float = letter.AMPLITUDE_STABILITY_M
    strobes: int = 1000
    noise: float = 0.5e-6

    @property
    def unknown(self) -> tuple[str, ...]:
        """All that is unknown, the wanted first and the amplitude last."""
        return *self.names, *self.before, "amplitude"


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """Standard errors by an orbit p_m, in the order of the plan's names: with all else unknown, and alone.

    `together`: the D-criterion [1]; `distance` of the excess from the fold, and its standard error; `kept`:
    whether the orbit outlives that.
    """

    frequency_hz: float
    excess: float
    period: int
    errors: tuple[float, ...]
    alone: tuple[float, ...]
    together: float
    distance: float
    distance_error: float
    kept: bool


def sizes_of(orbit: PeriodicOrbit, plan: Plan) -> Array:
    """Of all that is unknown: its values, or what counts as a change of it."""
    known = parameters_of(orbit.oscillator)
    return np.array([known[name].size for name in plan.unknown])


def changed(orbit: PeriodicOrbit, plan: Plan) -> tuple[Array, Array]:
    """Changes of what is measured, over its noise, and of the excess, by what is unknown over its sizes."""
    found = orbit_derivatives(orbit, changes_of(orbit.oscillator, plan.unknown))
    phi, weight = orbit.oscillator.model.phi, math.sqrt(plan.strobes / orbit.period) / plan.noise
    rows = weight * np.einsum("i,jip->jp", phi, found.strobes_changed[:, : phi.size])
    grazing, sizes = found.changes.grazing_amplitude / plan.amplitude_error, sizes_of(orbit, plan)
    return np.vstack([rows, grazing]) * sizes, found.excess * sizes


def covariance(orbits: Sequence[PeriodicOrbit], plan: Plan) -> Array:
    """C in units of sizes, with an amplitude for each orbit; infinite where they do not tell all of it."""
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


def errors_of(orbits: Sequence[PeriodicOrbit], plan: Plan) -> list[float]:
    """Standard errors of the wanted by several orbits together."""
    errors = np.sqrt(np.diag(covariance(orbits, plan))[: len(plan.names)])
    found: list[float] = (errors * sizes_of(orbits[0], plan)[: errors.size]).tolist()
    return found


class Nodes:
    """The stable, admissible orbits p_m, m = `period`, at approach speeds above that of the fold."""

    def __init__(self, oscillator: ImpactOscillator, period: int) -> None:
        self.family = KickFamily(oscillator=oscillator, period=period)
        self.exact, low = Shooting(oscillator=oscillator, period=period), self.family.fold()
        self.fold = self.exact.at_speed(low.speed) if low else None
        slow, fast = (part * oscillator.unit_speed for part in SPEEDS)
        self.speeds = (low.speed if low else slow), fast
        self.excesses = tuple(self.family.excess(speed) for speed in self.speeds)

    def at(self, excess: float) -> PeriodicOrbit | None:
        """The one at F/F_g - 1 = `excess`."""
        if not self.excesses[0] < excess < self.excesses[1]:
            return None
        speed = brentq(lambda v: self.family.excess(v) - excess, *self.speeds, xtol=1e-12)
        try:
            orbit = self.exact.at_speed(speed)
        except ContactError:
            return None
        return orbit if orbit.stable and orbit.admissible else None


def measurement(orbit: PeriodicOrbit, nodes: Nodes, plan: Plan) -> Measurement:
    """What one of the `nodes` tells."""
    n, sizes, cov = len(plan.names), sizes_of(orbit, plan), covariance([orbit], plan)
    (rows, away), told = changed(orbit, plan), bool(np.isfinite(cov[0, 0]))
    if nodes.fold is not None:
        away = away - excess_derivatives(nodes.fold, changes_of(orbit.oscillator, plan.unknown)) * sizes
    off = math.sqrt(away @ cov @ away) if told else math.inf
    return Measurement(
        frequency_hz=orbit.oscillator.driven.frequency,
        excess=orbit.excess,
        period=orbit.period,
        errors=tuple((np.sqrt(np.diag(cov)[:n]) * sizes[:n]).tolist()),
        alone=tuple((sizes / np.linalg.norm(rows, axis=0))[:n].tolist()),
        together=float(np.linalg.det(cov[:n, :n]) ** (0.5 / n)) if told else math.inf,
        distance=orbit.excess - nodes.excesses[0],
        distance_error=off,
        kept=told and None not in [nodes.at(orbit.excess + way * off) for way in (-1, 1)],
    )


def measurements_at(of: Of, plan: Plan, excesses: Sequence[float], frequency: float) -> list[Measurement]:
    """All that can be measured at a drive frequency [Hz]: p_m of the map there, and of its neighbours."""
    oscillator, found = of(frequency), list[Measurement]()
    plastic = replace(oscillator.stop, law=NewtonRestitution(local_restitution=0.0))
    m = maximal_period(NordmarkMap.from_oscillator(replace(oscillator, stop=plastic)))
    for nodes in [Nodes(oscillator, period) for period in range(max(m - 1, 2), m + 2)]:
        orbits = [orbit for orbit in map(nodes.at, excesses) if orbit is not None]
        found += [measurement(orbit, nodes, plan) for orbit in orbits]
    return found


def best(found: Sequence[Measurement], count: int = 5) -> list[Measurement]:
    """The best of those that count, well apart in frequency."""
    chosen = list[Measurement]()
    for one in sorted((one for one in found if one.kept), key=lambda one: one.together):
        if all(abs(one.frequency_hz - other.frequency_hz) >= APART_HZ for other in chosen):
            chosen.append(one)
    return chosen[:count]


def letters_orbits(of: Of, excess: float = 1e-3) -> list[PeriodicOrbit]:
    """The orbits of the letter's pairs at an excess; p_(m+1) where p_m is not there."""
    both = [[Nodes(of(f), k).at(excess) for k in (m, m + 1)] for f, m in letter.PERIODS.items()]
    return [orbit for pair in both for orbit in [pair[0] or pair[1]] if orbit is not None]


def answer(of: Of, found: Sequence[Measurement], plan: Plan) -> str:
    """What the letter's points and the best place tell, for the page; the plan wants T, tau and the delay."""
    six = letters_orbits(of)
    alone = {orbit.period: errors_of([orbit], plan) for orbit in six}
    pairs = [pair for pair in combinations(six, 2) if abs(pair[0].speed / pair[1].speed - 1.0) < ALIKE]

    def words(errors: Sequence[float]) -> str:
        return f"tau to {errors[1]:.1g} and the delay to {1e6 * errors[2]:.2g} \u00b5s"

    text = (
        f"Of {plan.strobes} strobes read to {1e6 * plan.noise:g} \u00b5m, at an excess of 1e-3: T follows to "
        + ", ".join(f"{1e3 * errors[0]:.1g} ms (p{m})" for m, errors in alone.items())
        + ". No single p_m tells gap, tau and delay apart; "
    )
    if not (chosen := best(found, 1)):
        return f"{text}with this noise no orbit exists at one standard error from its excess."
    first = chosen[0]
    text += (
        f"with the gap from the amplitude at grazing the best place, p{first.period} at "
        f"{first.frequency_hz:.2f} Hz and {first.excess:.1e}, gives {words(first.errors)}."
    )
    if pairs:
        one, other = min(pairs, key=lambda pair: errors_of(pair, plan)[1])
        text += (
            f" p{one.period} and p{other.period}, which meet the stop at {one.speed:.2f} and "
            f"{other.speed:.2f} m/s, give {words(errors_of([one, other], plan))}."
        )
    return text


def edges(centres: Array) -> Array:
    """Borders of cells around rising `centres`, halfway between them."""
    half = 0.5 * np.diff(centres) if centres.size > 1 else np.full(1, 0.5)
    return np.concatenate([centres[:1] - half[:1], centres[:-1] + half, centres[-1:] + half[-1:]])


@plotting.in_house_style
def draw(found: Sequence[Measurement], plan: Plan) -> Figure:
    """The error of each wanted parameter by the orbit that tells most at a place; stars: the letter's pairs
    at an excess of 1e-3; numbers: the best places; grey: the orbit need not outlive the errors."""
    places = [(round(one.frequency_hz, 6), round(one.excess, 9)) for one in found]
    across, up = (sorted({place[i] for place in places}) for i in (0, 1))
    figure, axes = plotting.new_figure(
        1, len(plan.names), width=plotting.PAGE, height=0.082, sharey=True, squeeze=False
    )
    cells = edges(np.array(across)), STABLE * np.sinh(edges(np.arcsinh(np.array(up) / STABLE)))
    shown = dict(sorted(zip(places, found, strict=True), key=lambda pair: (pair[1].kept, -pair[1].together)))
    for k, (axis, name) in enumerate(zip(axes.flat, plan.names, strict=True)):
        told, lost = np.full((2, len(up), len(across)), np.nan)
        for (f, excess), one in shown.items():
            (told if one.kept else lost)[up.index(excess), across.index(f)] = one.errors[k] * SHOWN[name][1]
        axis.pcolormesh(*cells, 0.0 * lost, cmap="Greys", vmin=-1.0, vmax=3.0)
        mesh = axis.pcolormesh(*cells, told, cmap="viridis_r", norm=LogNorm())
        bar = figure.colorbar(mesh, ax=axis, location="top", label=SHOWN[name][0])
        bar.ax.xaxis.set_minor_formatter("")
        axis.plot(list(letter.PERIODS), [1e-3] * 6, **plotting.LETTER_POINTS)
        for number, one in enumerate(best(found), 1):
            axis.annotate(
                str(number),
                (one.frequency_hz, one.excess),
                ha="center",
                va="center",
                fontsize=plotting.NOTE,
                bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "lw": 0.5},
            )
        axis.set_yscale("symlog", linthresh=STABLE)
        plotting.label(axis.xaxis, "drive frequency", "Hz")
    plotting.label(axes[0, 0].yaxis, plotting.EXCESS)
    return figure
