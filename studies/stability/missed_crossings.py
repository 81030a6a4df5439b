"""Crossings that a method does not see: change of sign at its steps against certified search.

A crossing of known depth is put at every phase of a method's looks; ``known_crossing`` derives the share that
is missed. That knows of the looks alone. A motion that is not exact puts the peak a little too high or too
low: by (h omega)^2/8 for central difference, by its tolerance with an error control. Samples of exact flights
look at the turning points as well, and miss a crossing only where the tip turns twice between two samples:
they have no formula. Tried on the lowest mode of the scene and on its first six, with a fifth of the peak in
modes 2 to 6. Fixed steps are a hundredth of the period for one mode and 0.5/omega_max for six.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache, partial

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from contact import ImpactKind, NewtonRestitution, simulate
from contact.integrators import INTEGRATORS, CentralDifference, Integrator, SampledFlight
from studies import plotting
from studies.scene import Scene, model_of
from studies.stability import Findings, Limit, threshold
from studies.stability.known_crossing import Swing, Touch, half_missed, invented_by_percussions, share_missed

__all__ = ["draw", "first_depth", "measure", "of_package", "solved", "swings", "tried", "trials"]

OVERSHOOTS = 10.0 ** -np.arange(1, 13)
FINE = np.geomspace(1e-12, 1e-1, 276)
"""Where the formulas are drawn, 25 points a decade."""
PHASES = {"one mode": 64, "six modes": 32}
"""Runs for each overshoot. A share is good to 0.5/sqrt(runs) for a solver whose steps do not keep to a grid,
and the overshoot at which it is one half to a factor exp(2/sqrt(runs)): 1.3 and 1.4."""
RINGING = 0.2
"""Part of the peak that the modes above the first make up [1]."""
LOOKED_AT = 12
"""Flights in which the spacing of a solver's looks around the peak is measured."""

Row = partial(Limit, family="missed_crossings")


def solved(
    swing: Swing, solver: str, tolerance: float, overshoot: float, lead: float
) -> tuple[np.ndarray, float]:
    """Times of the looks of solve_ivp with a terminal event at the stop, as most would use it, and of the
    first touch, from the peak; NaN if there is none [s].

    Absolute tolerances are those of one energy: `tolerance` times the largest velocity, and that over omega.
    """
    n, start, stiffness = swing.omega.size, swing.start(overshoot, lead), swing.omega**2
    speed = max(
        swing.omega[0] * swing.gap / np.linalg.norm(swing.phi), np.linalg.norm(start.velocity),
        np.linalg.norm(swing.omega * start.displacement),
    )  # fmt: skip

    def depth(_t: float, y: np.ndarray) -> float:
        return float(swing.phi @ y[:n] - swing.gap)

    depth.terminal, depth.direction = True, 1  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda _t, y: np.concatenate([y[n:], -stiffness * y[:n]]), (0.0, lead + swing.tail),
        np.concatenate([start.displacement, start.velocity]), method=solver, events=depth, rtol=tolerance,
        atol=tolerance * speed * np.concatenate([1.0 / swing.omega, np.ones(n)]),
    )  # fmt: skip
    touches = found.t_events[0]
    return found.t - lead, float(touches[0]) - lead if touches.size else math.nan


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A method to try."""

    label: str
    kind: str
    """"exact", "step" (and samples) or "control" of the error."""
    touch: Touch
    spacings: np.ndarray = field(default_factory=lambda: np.empty(0))
    """Of its looks [s]; none for a method that searches between its steps."""
    percussions: bool = False
    invents: float | None = None
    """Theory of the undershoot over gap down to which it invents touches [1]."""


def of_package(swing: Swing, kind: type[Integrator], options: Mapping[str, float]) -> Trial:
    """A method of the package with those of the `options` that it knows."""
    known = {entry.name for entry in fields(kind)}  # type: ignore[arg-type]
    method = kind(**{name: value for name, value in options.items() if name in known})
    oscillator, step = swing.oscillator(method), options["step"]

    def touch(overshoot: float, lead: float) -> float:
        start, duration = swing.start(overshoot, lead), lead + swing.tail
        impacts = simulate(oscillator, start, duration=duration, method=method).impacts
        touches = impacts.start[impacts.kind == ImpactKind.IMPACT] - lead
        return float(touches[0]) if touches.size else math.nan

    invents = None
    percussions = "step" in known and isinstance(oscillator.stop.law, NewtonRestitution)
    if percussions:
        invents = invented_by_percussions(step, swing.pace)
    elif kind is CentralDifference:
        invents = (swing.pace * step) ** 2 / 8.0
    return Trial(
        label=f"{kind.name}, {options['points']} points" if "points" in known else kind.name,
        kind="exact" if kind.certified else "step", touch=touch, percussions=percussions, invents=invents,
        spacings=np.array([step]) if "step" in known else np.empty(0),
    )  # fmt: skip


def of_scipy(swing: Swing, solver: str, tolerance: float) -> Trial:
    """A solver with error control; the spacings are those around the peak in flights that meet nothing."""
    spacings = []
    for lead in swing.leads(LOOKED_AT):
        looks, _none = solved(swing, solver, tolerance, -0.01, float(lead))
        after = int(np.searchsorted(looks, 0.0))
        spacings.append(looks[after] - looks[after - 1])
    return Trial(
        label=f"scipy {solver}, {tolerance:g}", kind="control", spacings=np.array(spacings),
        touch=lambda overshoot, lead: solved(swing, solver, tolerance, overshoot, lead)[1],
    )  # fmt: skip


def swings(scene: Scene) -> dict[str, Swing]:
    """The motions with a crossing of known depth: the first mode of the scene, and its first six.

    Six modes are in step at the peak alone: the next highest one is at 0.83 gap.
    """
    model, gap = model_of(scene).truncated(6), scene.stop.gap_m
    period = 2.0 * math.pi / float(model.omega[0])
    height = np.array([1.0 - RINGING, *[RINGING / 5] * 5])
    return {
        "one mode": Swing(
            omega=model.omega[:1], phi=model.phi[:1], height=np.ones(1), gap=gap,
            lead=0.6 * period, spread=0.25 * period, tail=0.4 * period,
        ),
        "six modes": Swing(
            omega=model.omega, phi=model.phi, height=height, gap=gap,
            lead=0.05 * period, spread=0.02 * period, tail=0.02 * period,
        ),
    }  # fmt: skip


def trials(swing: Swing, quick: bool) -> Iterator[Trial]:
    """Every method of the package, and SciPy's solvers."""
    step = min(0.02 * math.pi / float(swing.omega[0]), 0.5 / float(swing.omega.max()))
    options = {"step": 2.0 * step if quick else step, "rho": 0.8, "points": 24}
    yield from (of_package(swing, kind, options) for kind in INTEGRATORS.values())
    yield of_package(swing, SampledFlight, {**options, "points": 96})
    yield of_scipy(swing, "DOP853", 1e-8)
    for name, tolerance in () if quick else (("DOP853", 1e-12), ("RK45", 1e-8), ("LSODA", 1e-8)):
        yield of_scipy(swing, name, tolerance)


def tried(trial: Trial, swing: Swing, words: str, runs: int) -> tuple[list[Limit], np.ndarray]:
    """Rows of one method, and the shares missed over `OVERSHOOTS`; what follows two decades in which nothing
    is seen is not tried."""
    pace, spacings = swing.pace, trial.spacings
    slack = 2.0 * float(spacings.max()) if spacings.size else 1e-6 / pace

    @cache
    def wrong(overshoot: float) -> float:
        return swing.share_wrong(trial.touch, overshoot, runs=runs, slack=slack)

    shares: list[float] = []
    for overshoot in OVERSHOOTS:
        shares.append(1.0 if shares[-2:] == [1.0, 1.0] else wrong(float(overshoot)))
    row = partial(Row, method=trial.label, refused=None if trial.kind == "exact" else False)
    rows = [row(
        case=f"half of the crossings missed, {words}", parameter="overshoot / gap [1]",
        theory=half_missed(spacings, pace, trial.percussions) if spacings.size else None,
        measured=first_depth(lambda depth: wrong(depth) > 0.5),
    )]  # fmt: skip
    if trial.kind != "control":  # an error control errs by less than it misses
        rows.append(row(
            case=f"touches invented, {words}", parameter="undershoot / gap [1]", theory=trial.invents,
            measured=first_depth(lambda depth: wrong(-depth) > 0.0),
        ))  # fmt: skip
    return rows, np.array(shares)


def first_depth(fails: Callable[[float], bool]) -> float | None:
    """The depth below which it fails, between the decades; the largest tried if it fails there already."""
    failed = next((i for i, depth in enumerate(OVERSHOOTS) if fails(float(depth))), None)
    if not failed:
        return None if failed is None else float(OVERSHOOTS[0])
    return threshold(fails, float(OVERSHOOTS[failed - 1]), float(OVERSHOOTS[failed]), relative=0.05)


def measure(scene: Scene, quick: bool) -> Findings:
    """Crossings missed and touches invented by every method, on one mode and on six."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"overshoot": OVERSHOOTS, "fine": FINE}
    for words, swing in swings(scene).items():
        for trial in trials(swing, quick):
            rows, shares = tried(trial, swing, words, 6 if quick else PHASES[words])
            limits += rows
            arrays[f"{words}|{trial.kind}|{trial.label}"] = shares
            if trial.spacings.size:
                theory = share_missed(FINE, trial.spacings, swing.pace, trial.percussions)
                arrays[f"{words}|theory|{trial.label}"] = theory
    return Findings(limits=limits, arrays=arrays)


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Share missed over overshoot: one mode above, six below; error control left, fixed steps right."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.150, sharex=True, sharey=True)
    overshoot, titles = arrays["overshoot"], {"control": "error control", "step": "fixed steps, samples"}
    for row, words in enumerate(PHASES):
        exact = np.max([arrays[key] for key in arrays if f"{words}|exact|" in key], axis=0)
        axes[row, 1].plot(overshoot, 100 * exact, **plotting.series(0), label="exact methods")
        for column, (kind, title) in enumerate(titles.items()):
            axis = axes[row, column]
            labels = [key.split("|")[2] for key in arrays if f"{words}|{kind}|" in key]
            for number, label in enumerate(labels, start=column):
                shares, theory = arrays[f"{words}|{kind}|{label}"], arrays.get(f"{words}|theory|{label}")
                axis.plot(overshoot, 100 * shares, **plotting.points(number), label=label)
                if theory is not None:
                    axis.plot(arrays["fine"], 100 * theory, color=plotting.PALETTE[number], linewidth=0.7)
            plotting.panel(axis, 2 * row + column, f"{words}, {title}")
            axis.set_xscale("log")
            axis.set_ylim(-4.0, 104.0)
    for column in (0, 1):
        plotting.label(axes[column, 0].yaxis, "crossings missed", "%")
        plotting.label(axes[1, column].xaxis, "overshoot / gap")
        axes[1, column].legend(loc="upper center", bbox_to_anchor=(0.5, -0.25), ncols=2)
    return figure, (
        "Share of the crossings missed against their depth; lines: theory, from the spacing of the looks. "
        "The number beside a solver is its tolerance."
    )
