r"""Crossings that a method does not see: change of sign at its steps against certified search.

A crossing of known depth (``studies.methods.crossings``) is put at every phase of a method's looks, h apart;
it sees the crossing with probability (duration)/h:

    share missed = max(0, 1 - 2 sqrt(2 delta gap/a)/h),   one half at   delta = a h^2/(32 gap).            (a)

With delta < 0 the tip stays
away, and any touch is invented. A method by percussions (``contact.integrators.moreau_jean``) strikes in the
step from a grid point if d + (h/2) U >= 0 and U* + e U > 0 there. On the parabola, s steps before the peak,
these are delta gap >= (a h^2/2) s (s - 1) and s > 1/(1 + e); so, with x (1 + x) = 2 delta gap/(a h^2),

    share missed = max(0, 1/(1 + e) - x),                                                                  (b)
    touches invented down to   delta = -(a h^2/(2 gap)) e/(1 + e)^2.                                       (c)

That knows of the looks alone. A motion that is not exact puts the peak a little too high or too low: by
(h omega)^2/8 for central difference, by its tolerance with an error control. Samples of exact flights look at
the turning points as well, and miss a crossing only where the tip turns twice between two samples: they have
no formula. Tried on the lowest mode of the scene; fixed steps are a hundredth of its period.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cache, partial

import numpy as np
from matplotlib.figure import Figure

from contact import LinearContact, NewtonRestitution, Stop
from contact.integrators import INTEGRATORS, CentralDifference, Integrator, MoreauJean, SampledFlight
from studies.methods.crossings import Crossing
from studies.methods.peers import OutsideSolver
from studies.methods.stability.model import Findings, Limit, threshold
from studies.shell import plotting
from studies.shell.digits import written
from studies.shell.scene import Scene, model_of

OVERSHOOTS = 10.0 ** -np.arange(1, 13)
FINE = np.geomspace(1e-12, 1e-1, 276)  # where the formulas are drawn, 25 points a decade
PHASES = 64
"""Runs for each overshoot. A share is good to 0.5/sqrt(runs) for a solver whose steps do not keep to a grid,
and the overshoot at which it is one half to a factor exp(2/sqrt(runs)): 1.3."""
RESTITUTION = 0.5  # of the stops with Newton's law [1]

entry = partial(Limit, family="missed_crossings")


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A method to try."""

    crossing: Crossing
    method: Integrator
    label: str
    kind: str  # "exact", "step" (and samples) or "control" of the error
    step: float | None = None
    """Between its looks [s]; None for a method that searches between its steps, or chooses them itself."""

    @property
    def percussions(self) -> bool:
        """Whether it strikes."""
        return isinstance(self.crossing.oscillator.stop.law, NewtonRestitution)


def share_missed(
    overshoot: float | np.ndarray, step: float, rate: float, percussions: bool = False
) -> np.ndarray:
    """Share of crossings missed, (a) or (b), for overshoots over gap [1]."""
    if percussions:
        x = 0.5 * (np.sqrt(1.0 + 8.0 * overshoot / (rate * step) ** 2) - 1.0)
        return np.maximum(0.0, 1.0 / (1.0 + RESTITUTION) - x)
    duration = 2.0 * np.sqrt(2.0 * overshoot) / rate
    return np.maximum(0.0, 1.0 - duration / step)


def invented(trial: Trial) -> float | None:
    """Theory of the undershoot over gap down to which a method invents touches: (c), and what central
    difference rises too high [1]."""
    if trial.step is None:
        return None
    if trial.percussions:
        part = 0.5 * RESTITUTION / (1.0 + RESTITUTION) ** 2
    elif isinstance(trial.method, CentralDifference):
        part = 0.125
    else:
        return None
    return part * float(trial.crossing.rate * trial.step) ** 2


def share_wrong(trial: Trial, overshoot: float, runs: int) -> float:
    """Share of the runs that miss the crossing, or invent one if the overshoot is negative [1].

    A first touch is the crossing if the tip is beyond the stop within two looks of it; where a solver chooses
    its looks, if it lies next to the peak.
    """
    crossing, wrong = trial.crossing, 0
    slack = 2.0 * trial.step if trial.step else (1.0 if trial.kind == "control" else 1e-6) / crossing.rate
    for lead in crossing.leads(runs).tolist():
        at = crossing.touch(trial.method, overshoot, lead)
        near = np.array([at - slack, at + slack, 0.0 if abs(at) <= slack else at])
        seen = overshoot < 0.0 or bool(np.any(crossing.height_at(overshoot, near) > 0.0))
        wrong += (math.isfinite(at) and seen) == (overshoot < 0.0)
    return wrong / runs


def crossing_of(scene: Scene, method: Integrator | None = None) -> Crossing:
    """The lowest mode of the scene before a stop with a law that `method` knows, soft enough for any step."""
    model = model_of(scene).truncated(1)
    soft = LinearContact(stiffness=0.01 * float((model.omega[0] / model.phi[0]) ** 2))
    hard = NewtonRestitution(local_restitution=RESTITUTION)
    law = soft if method is None or method.accepts(soft.code) else hard
    return Crossing.of(model, Stop(gap=scene.stop.gap_m, law=law), 0.0)


def of_package(scene: Scene, kind: type[Integrator], options: Mapping[str, float]) -> Trial:
    """A method of the package with the `options` that it knows."""
    known = {entry.name for entry in fields(kind)}  # type: ignore[arg-type]
    method = kind(**{name: value for name, value in options.items() if name in known})
    name = "Moreau-Jean" if kind is MoreauJean else kind.name.replace("-", " ")
    return Trial(
        label=f"{name}, {options['points']} points" if "points" in known else name,
        method=method,
        crossing=crossing_of(scene, method),
        kind="exact" if kind.certified else "step",
        step=options["step"] if "step" in known else None,
    )


def of_scipy(scene: Scene, solver: str, tolerance: float) -> Trial:
    """A solver of SciPy, which has no theory here: its looks are as far apart as its error control allows."""
    method = OutsideSolver(solver=f"scipy {solver}", tolerance=tolerance)
    return Trial(
        method=method,
        crossing=crossing_of(scene),
        kind="control",
        label=f"SciPy {solver}, {written(tolerance)}",
    )


def trials(scene: Scene, quick: bool) -> Iterator[Trial]:
    """Every method of the package, and SciPy's solvers."""
    step = 0.02 * math.pi / float(model_of(scene).omega[0])
    options = {"step": 2.0 * step if quick else step, "rho": 0.8, "points": 24}
    for kind in dict.fromkeys(INTEGRATORS.values()):
        yield of_package(scene, kind, options)
    yield of_package(scene, SampledFlight, {**options, "points": 96})
    yield of_scipy(scene, "DOP853", 1e-8)
    for name, tolerance in () if quick else (("DOP853", 1e-12), ("RK45", 1e-8), ("LSODA", 1e-8)):
        yield of_scipy(scene, name, tolerance)


def tried(trial: Trial, runs: int) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """Rows of one method, the shares missed over `OVERSHOOTS` and their theory over `FINE`; what follows two
    decades in which nothing is seen is not tried."""
    ladder, theory = OVERSHOOTS.tolist(), None
    row = partial(entry, method=trial.label, refused=None if trial.kind == "exact" else False)

    @cache
    def wrong(overshoot: float) -> float:
        return share_wrong(trial, overshoot, runs)

    shares: list[float] = []
    for overshoot in ladder:
        shares.append(1.0 if shares[-2:] == [1.0, 1.0] else wrong(overshoot))
    arrays = {f"{trial.kind}|{trial.label}": np.array(shares)}
    if trial.step:
        share = partial(
            share_missed, step=trial.step, rate=trial.crossing.rate, percussions=trial.percussions
        )
        theory = threshold(lambda depth: bool(share(depth) > 0.5), ladder, relative=1e-12)
        arrays[f"theory|{trial.label}"] = share(FINE)
    rows = [
        row(
            case="half of the crossings missed, one mode",
            parameter="overshoot / gap",
            theory=theory,
            measured=threshold(lambda depth: wrong(depth) > 0.5, ladder, relative=0.05),
        )
    ]
    if trial.kind != "control":  # an error control errs by less than it misses
        rows.append(
            row(
                case="touches invented, one mode",
                parameter="undershoot / gap",
                theory=invented(trial),
                measured=threshold(lambda depth: wrong(-depth) > 0.0, ladder, relative=0.05),
            )
        )
    return rows, arrays


def measure(scene: Scene, quick: bool) -> Findings:
    """Crossings missed and touches invented by every method."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"overshoot": OVERSHOOTS, "fine": FINE}
    for trial in trials(scene, quick):
        rows, found = tried(trial, 6 if quick else PHASES)
        limits += rows
        arrays |= found
    return limits, arrays


HOLDS = "overshoot, fine: overshoots over the gap [1]; the others: share missed there, theory at fine [1]."


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Share missed over overshoot; methods that agree are drawn as rings inside one another."""
    figure, axes = plotting.new_figure(1, 3, width=plotting.PAGE, height=0.12, sharey=True)
    trials = [key.split("|") for key in arrays if key.startswith(("exact|", "step|", "control|"))]
    curves = {label: arrays.get(f"theory|{label}") for _, label in trials}
    kinds = {label: 0 if curve is None else 1 if curve[0] > 0.99 else 2 for label, curve in curves.items()}
    titles = "search between steps", "change of sign at steps", "percussions"
    for panel, (axis, title) in enumerate(zip(axes, titles, strict=True)):
        shown = [(kind, label) for kind, label in trials if kinds[label] == panel]
        for curve in [curves[label] for _, label in shown if panel][:1]:
            axis.plot(arrays["fine"], 100.0 * np.asarray(curve), color="0.5", label="theory")
        for number, (kind, label) in enumerate(shown):
            look = {**plotting.points(number), "markerfacecolor": "none", "markersize": 8.0 - number}
            share = 100.0 * arrays[f"{kind}|{label}"]
            axis.plot(arrays["overshoot"], share, **look, clip_on=False, label=label)
        plotting.panel(axis, panel, title)
        axis.set_xscale("log")
        axis.set_ylim(-4.0, 104.0)
        plotting.label(axis.xaxis, "overshoot / gap")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.25))
    plotting.label(axes[0].yaxis, "crossings missed", "%")
    return figure, (
        "Share of the crossings missed against their depth. The number beside a solver is its tolerance."
    )
