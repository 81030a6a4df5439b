r"""What to measure next: where in the plane of drive frequency and excess an orbit tells most of parameters p.

N strobes of a settled p_m see the tip at its m strobe points y_j(p), each N/m times. With read-out noise s,
J_j = dy_j/dp (``contact.orbits.orbit_derivatives``) and standard errors s_0 of what is known before,

    information M = (N/m) sum_j J_j^T J_j/s^2 + sum g g^T/s_0^2,     covariance C = M^-1,

g = dA_g/dp for the amplitude at grazing, which is measured too. A parameter's error is C_ii^(1/2), and
M_ii^(-1/2) with all others known; that of n together is det(C_n)^(1/2n) in units of their values, the geometric
mean of the half axes of the ellipsoid of errors (D-criterion).

**What one orbit cannot tell.** Between touches the points obey T, mu and the drive; the touch joins the flight
that comes and the one that goes: wherever the two meet a level, that gap with a delay and a restitution gives
the same strobe points. So gap, restitution and delay follow from one p_m only as far as the gap is known, here
from A_g, or from two orbits of different speeds.

**Where it ends.** Towards a fold, D away in excess, y_j - y_fold ~ D^(1/2): J grows without bound. Linear
theory holds while the orbit outlives the errors: D has the standard error (d^T C d)^(1/2), d = dD/dp, and a
place counts where p_m is there, stable, with the excess that much lower and higher. That leaves out places as
close to a second impact or a doubling, where J stays finite, too. Without a fold p_m ends at grazing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq

from beam import ModalChange
from contact import (
    ContactError,
    DelayedRestitution,
    ImpactOscillator,
    NewtonRestitution,
    NordmarkMap,
    maximal_period,
)
from contact.orbits import (
    Change,
    KickFamily,
    MaximalFamily,
    PeriodicOrbit,
    Shooting,
    excess_derivatives,
    orbit_derivatives,
)
from studies import letter, plotting

Array = NDArray[np.float64]

FREQUENCIES_HZ = np.linspace(20.5, 23.6, 63).tolist()
MARKS = (0.0, *(letter.AMPLITUDE_STABILITY * 4.0**k for k in range(4)))
EXCESSES = sorted({0.0, *(way * MARKS[1] * 2.0 ** (0.5 * k) for k in range(13) for way in (-1, 1))})
"""The plane: drive frequencies, excesses, and those that are written on its axis."""

UNSEEN = 1e-11
"""Ratio of singular values below which a direction of the parameters is not seen."""

SPEEDS = (1e-4, 1.0)
"""Approach speeds over 2 pi f gap among which nodes are looked for."""

APART_HZ, ALIKE = 0.3, 0.1
"""Least distance of two of the best places; by which approach speeds may differ and count as one."""

SHOWN = {
    "free_period": ("error of $T$ (ms)", 1e3), "decay_rate": ("error of $\\mu$ (1/s)", 1.0),
    "gap": ("error of the gap (mm)", 1e3), "restitution": ("error of $\\tau$", 1.0),
    "delay": ("error of the delay (ms)", 1e3),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Wanted `names`; standard errors `before` of what else is unknown, in its unit (inf: nothing known), and
    of any drive amplitude [m]; number of `strobes`; `noise` of the read-out [m]; whether velocity is read too,
    to 2 pi f `noise`."""

    names: tuple[str, ...] = ("free_period", "restitution", "delay")
    before: Mapping[str, float] = field(
        default_factory=lambda: {"decay_rate": letter.BREAKDOWN["decay_rate_error_per_s"], "gap": math.inf}
    )
    amplitude_error: float = letter.AMPLITUDE_STABILITY_M
    strobes: int = 1000
    noise: float = 0.5e-6
    velocity: bool = False

    @property
    def unknown(self) -> tuple[str, ...]:
        """All that is unknown, the wanted first and the amplitude last."""
        return *self.names, *self.before, "amplitude"


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """Standard errors by an orbit p_m, in the order of the plan's names: with all else unknown, and alone.

    `together`: the D-criterion [1]; `correlation`: the largest of two wanted ones; `distance` of the excess
    from the fold, and its standard error; `kept`: whether the orbit outlives that.
    """

    frequency_hz: float
    excess: float
    period: int
    errors: tuple[float, ...]
    alone: tuple[float, ...]
    together: float
    correlation: float
    distance: float
    distance_error: float
    kept: bool


def parameters(oscillator: ImpactOscillator) -> dict[str, tuple[float, Change]]:
    """Values of the parameters of one mode under a law of restitution, and the changes with them, per unit."""
    law, drive, model = oscillator.stop.law, oscillator.driven, oscillator.model
    first, delay = law.table[[1, 3], 0].tolist() if isinstance(law, DelayedRestitution) else (*law.numbers[:1], 0.0)
    omega, rate = float(model.omega[0]), float(model.decay_rate[0])
    period = 2.0 * math.pi / math.sqrt(omega**2 - 0.25 * rate**2)

    def moved(pace: float, decay: float) -> Change:
        return Change(model=ModalChange(omega=[pace], decay_rate=[decay], phi=[0.0], participation=[0.0]))

    return {
        "free_period": (period, moved(-(2.0 * math.pi / period) ** 2 / (period * omega), 0.0)),
        "decay_rate": (rate, moved(0.25 * rate / omega, 1.0)),
        "gap": (oscillator.stop.gap, Change(gap=1.0)),
        "restitution": (first, Change(law=(1.0, 0.0))),
        "delay": (delay, Change(law=(0.0, 1.0))),
        "frequency": (drive.frequency, Change(frequency=1.0)),
        "amplitude": (drive.amplitude, Change(amplitude=1.0)),
    }


def values_of(orbit: PeriodicOrbit, plan: Plan) -> Array:
    """Of all that is unknown."""
    known = parameters(orbit.oscillator)
    return np.array([known[name][0] for name in plan.unknown])


def changed(orbit: PeriodicOrbit, plan: Plan) -> tuple[Array, Array]:
    """Changes of what is measured, over its noise, and of the excess, by relative changes of the unknown."""
    known, values = parameters(orbit.oscillator), values_of(orbit, plan)
    found = orbit_derivatives(orbit, [known[name][1] for name in plan.unknown])
    phi, weight = orbit.oscillator.model.phi, math.sqrt(plan.strobes / orbit.period) / plan.noise
    rows = [weight * np.einsum("i,jip->jp", phi, found.strobes_changed[:, : phi.size])]
    if plan.velocity:
        rates = np.einsum("i,jip->jp", phi, found.strobes_changed[:, phi.size :])
        rows.append(weight * rates / orbit.oscillator.driven.angular_frequency)
    grazing = found.changes.grazing_amplitude / plan.amplitude_error
    return np.vstack([*rows, grazing]) * values, found.excess * values


def covariance(orbits: Sequence[PeriodicOrbit], plan: Plan) -> Array:
    """C of relative changes of what is unknown, with an amplitude for each orbit; infinite where the orbits do
    not tell all of it."""
    own, values = len(plan.unknown) - 1, values_of(orbits[0], plan)
    before = values[len(plan.names) : own] / list(plan.before.values())
    rows = [np.diag([*np.zeros(len(plan.names)), *before, *(o.amplitude / plan.amplitude_error for o in orbits)])]
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


def errors_of(orbits: Sequence[PeriodicOrbit], plan: Plan) -> tuple[tuple[float, ...], float]:
    """Standard errors of the wanted by several orbits together, and their D-criterion [1]."""
    n, cov = len(plan.names), covariance(orbits, plan)
    errors = np.sqrt(np.diag(cov)[:n]) * values_of(orbits[0], plan)[:n]
    told = bool(np.isfinite(cov[0, 0]))
    return tuple(errors.tolist()), float(np.linalg.det(cov[:n, :n]) ** (0.5 / n)) if told else math.inf


class Nodes:
    """The stable, admissible orbits p_m, m = `period`, at approach speeds above that of the fold."""

    def __init__(self, oscillator: ImpactOscillator, period: int) -> None:
        newton = isinstance(oscillator.stop.law, NewtonRestitution)
        self.family = (MaximalFamily if newton else KickFamily)(oscillator=oscillator, period=period)
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
    n, values, cov = len(plan.names), values_of(orbit, plan), covariance([orbit], plan)
    (errors, together), (rows, away) = errors_of([orbit], plan), changed(orbit, plan)
    if nodes.fold is not None:
        known = parameters(orbit.oscillator)
        away = away - excess_derivatives(nodes.fold, [known[name][1] for name in plan.unknown]) * values
    told = math.isfinite(together)
    off = math.sqrt(away @ cov @ away) if told else math.inf
    sizes = np.array(errors) / values[:n]
    return Measurement(
        frequency_hz=orbit.oscillator.driven.frequency, excess=orbit.excess, period=orbit.period, errors=errors,
        alone=tuple((values / np.linalg.norm(rows, axis=0))[:n].tolist()), together=together,
        correlation=float(np.max(np.abs(cov[:n, :n] / np.outer(sizes, sizes) - np.eye(n)))) if told else 1.0,
        distance=orbit.excess - (nodes.fold.excess if nodes.fold else 0.0), distance_error=off,
        kept=told and all(nodes.at(orbit.excess + way * off) is not None for way in (-1.0, 1.0)),
    )  # fmt: skip


def measurements_at(
    of: Callable[[float], ImpactOscillator], plan: Plan, excesses: Sequence[float], frequency: float
) -> list[Measurement]:
    """All that can be measured at a drive frequency [Hz]: p_m of the map there, and of its neighbours."""
    oscillator, found = of(frequency), list[Measurement]()
    plastic = replace(oscillator.stop, law=NewtonRestitution(local_restitution=0.0))
    m = maximal_period(NordmarkMap.from_oscillator(replace(oscillator, stop=plastic)))
    for period in range(max(m - 1, 2), m + 2):
        nodes = Nodes(oscillator, period)
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


def letters_orbits(of: Callable[[float], ImpactOscillator], excess: float = 1e-3) -> list[PeriodicOrbit]:
    """The orbits of the letter's pairs at an excess, of the period next to it where p_m is not there."""
    found = list[PeriodicOrbit]()
    for f, m in letter.PERIODS.items():
        there = [Nodes(of(f), period).at(excess) for period in (m, m + 1)]
        found += [orbit for orbit in there if orbit is not None][:1]
    return found


def answer(of: Callable[[float], ImpactOscillator], plan: Plan, found: Sequence[Measurement]) -> str:
    """What the letter's points and the best one tell, for the page; `plan` wants T, restitution and delay."""
    def told(orbits: Sequence[PeriodicOrbit]) -> str:
        period, restitution, delay = errors_of(orbits, plan)[0]
        return f"T to {1e3 * period:.1g} ms, tau to {restitution:.1g}, the delay to {1e6 * delay:.2g} us"

    six, first = letters_orbits(of), best(found, 1)[0]
    names = [f"p{orbit.period}" for orbit in six]
    one = Nodes(of(first.frequency_hz), first.period).at(first.excess)
    assert one is not None
    pairs = [(a, b) for k, a in enumerate(six) for b in six[k + 1 :] if abs(a.speed / b.speed - 1.0) < ALIKE]
    a, b = min(pairs, key=lambda pair: errors_of(pair, plan)[1])
    return (
        f"With {plan.strobes} strobes read to {1e6 * plan.noise:g} um at an excess of 1e-3, and amplitudes to "
        f"{1e6 * plan.amplitude_error:g} um: " + "; ".join(f"{name} tells {told([o])}" for name, o in zip(names, six, strict=True))
        + f". The best one, p{one.period} at {first.frequency_hz:.2f} Hz and {first.excess:.1e}, {told([one])}; tau and "
        f"delay stay correlated ({first.correlation:.3f}) through the gap. p{a.period} and p{b.period}, which meet the stop at {a.speed:.2f} "
        f"and {b.speed:.2f} m/s, {told([a, b])} whatever these do at other speeds; all six, if they are constant, {told(six)}."
    )


@plotting.in_house_style
def draw(found: Sequence[Measurement], plan: Plan) -> Figure:
    """The error of each wanted parameter over frequency and excess, by the orbit that tells most there."""
    places = [(round(one.frequency_hz, 6), round(one.excess, 9)) for one in found]
    across, up = (sorted({place[i] for place in places}) for i in (0, 1))
    figure, axes = plotting.new_figure(
        1, len(plan.names), width=plotting.PAGE, height=0.082, sharey=True, squeeze=False
    )
    shown = dict(sorted(zip(places, found, strict=True), key=lambda pair: (pair[1].kept, -pair[1].together)))
    heights = {excess: i for i, excess in enumerate(up)}
    for k, (axis, name) in enumerate(zip(axes.flat, plan.names, strict=True)):
        told, lost = np.full((2, len(up), len(across)), np.nan)
        for (f, excess), one in shown.items():
            (told if one.kept else lost)[heights[excess], across.index(f)] = one.errors[k] * SHOWN[name][1]
        axis.pcolormesh(across, range(len(up)), 0.0 * lost, cmap="Greys", vmin=-1.0, vmax=3.0, rasterized=True)
        mesh = axis.pcolormesh(across, range(len(up)), told, cmap="viridis_r", norm=LogNorm(), rasterized=True)
        figure.colorbar(mesh, ax=axis, location="top", label=SHOWN[name][0])
        born = np.interp(1e-3, up, range(len(up)))
        axis.plot(list(letter.PERIODS), [born] * len(letter.PERIODS), **plotting.LETTER_POINTS)
        for number, one in enumerate(best(found), 1):
            axis.annotate(str(number), (one.frequency_hz, heights[round(one.excess, 9)]), ha="center", va="center",
                          fontsize=plotting.NOTE, bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "lw": 0.5})  # fmt: skip
        ticks = [excess for excess in up if any(abs(abs(excess) - mark) < 1e-9 for mark in MARKS)]
        axis.set_yticks([heights[excess] for excess in ticks], [f"{1e3 * excess:g}" for excess in ticks])
        plotting.label(axis.xaxis, "drive frequency", "Hz")
    plotting.label(axes[0, 0].yaxis, plotting.EXCESS, "10$^{-3}$")
    return figure
