"""Restitution that a method fakes: energy it takes from, or gives to, an elastic collision.

The spring of the scene with `MODES` modes meets the plate once, at the excess of the letter's Fig. 4, under
an elastic law: Hertz's, or Newton's with e = 1. The exact motion has an effective restitution tau and a kick
(``contact.collision``) because energy goes into the higher modes; a method with a step h has others. The kick
of a single short contact is nearly in proportion to 1 + e of the contact itself, so that

    2 kick(h)/kick - 1

is about the local restitution that it pretends to have, where there is 1.

Steps are given in contact times under Hertz's law, as h omega_max under Newton's; each value is a mean over
places of the touch in its step. Theory in the table is the exact collision.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from contact import (
    Collision,
    ImpactOscillator,
    NewtonRestitution,
    State,
    Stop,
    before_collision,
    collisions,
    simulate,
)
from contact.integrators import GeneralisedAlpha, Integrator, MoreauJean, NonsmoothGeneralisedAlpha
from studies import letter, plotting
from studies.scene import Scene, beam_at
from studies.stability import Findings, Limit

__all__ = ["ElasticCollision", "draw", "measure"]

MODES = 10

Maker = Callable[[float], Integrator]
"""A method for a step [s]."""

HERTZ: Mapping[str, Maker] = {
    "trapezoidal rule": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, α = 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "HHT, α = 0.3": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.3),
    "gen.-α, ρ = 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "gen.-α, ρ = 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
NEWTON: Mapping[str, Maker] = {
    "Moreau-Jean, θ = 1/2": lambda h: MoreauJean(step=h),
    "Moreau-Jean, θ = 1": lambda h: MoreauJean(step=h, theta=1.0),
    "nonsmooth, ρ = 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
    "nonsmooth, ρ = 0": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.0),
}

Row = partial(Limit, family="false_restitution")


@dataclass(frozen=True, kw_only=True, eq=False)
class ElasticCollision:
    """One elastic collision: the driven spring before it, its exact outcome, and the unit of the step [s]."""

    driven: ImpactOscillator
    start: State
    exact: Collision
    unit: float

    @staticmethod
    def of(driven: ImpactOscillator, unit: float | None = None) -> ElasticCollision:
        """The first collision of a spring above grazing; `unit` None stands for the contact time."""
        start = before_collision(driven)
        exact = collisions(driven, simulate(driven, start, periods=2), unfinished="drop")[0]
        unit = exact.contact_time if unit is None else unit
        return ElasticCollision(driven=driven, start=start, exact=exact, unit=unit)

    def outcome(self, method: Integrator) -> tuple[float, float]:
        """Restitution and kick by `method`; NaN if its damping keeps the tip off the stop."""
        motion = simulate(self.driven, self.start, periods=2, method=method)
        found = collisions(self.driven, motion, unfinished="drop")
        return (found[0].restitution, found[0].kick) if found else (math.nan, math.nan)


def outcomes(case: ElasticCollision, make: Maker, sizes: np.ndarray, places: int) -> np.ndarray:
    """Restitution and kick, and their spreads, as rows; a column for every step.

    One place without a collision, or with a kick but no return, and the whole step has none (NaN).
    """
    rows = np.empty((4, sizes.size))
    for j, size in enumerate(sizes):
        # steps of nearly the same size that put the touch at different places of theirs
        steps = float(size) * case.unit * (1.0 + 0.03 * (np.arange(places) / places - 0.5))
        found = np.array([case.outcome(make(float(step))) for step in steps])
        rows[:, j] = [*found.mean(axis=0), *found.std(axis=0)]
    return rows


def rows_of(
    case: ElasticCollision, label: str, method: str, sizes: np.ndarray, table: np.ndarray
) -> list[Limit]:
    """What one method makes of the collision at a step of about one unit, the largest up to there at which
    there is a restitution at all."""
    hertz = method == GeneralisedAlpha.name
    law, unit = ("Hertz", "h / contact time") if hertz else ("Newton", "h omega_max")
    last = int(np.flatnonzero(np.isfinite(table[0]) & (sizes < 1.1))[-1])
    row = partial(Row, method=method, refused=False,
                  case=f"{label}, elastic {law}, {unit} = {sizes[last]:.3g}")  # fmt: skip
    return [
        row(parameter="restitution tau [1]", theory=case.exact.restitution, measured=float(table[0, last])),
        row(parameter="local restitution 2 kick(h)/kick - 1 [1]", theory=1.0,
            measured=float(2.0 * table[1, last] / case.exact.kick - 1.0)),
    ]  # fmt: skip


def measure(scene: Scene, quick: bool) -> Findings:
    """Both laws over the step."""
    middle = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2]
    kept = scene.replace({"modes.count": MODES, "contact.law": "hertz"})
    driven = beam_at(kept, middle).with_excess(letter.TIME_TRACE_EXCESS)
    stop = Stop(gap=driven.stop.gap, law=NewtonRestitution(local_restitution=1.0))
    hertz = ElasticCollision.of(driven)
    newton = ElasticCollision.of(replace(driven, stop=stop), 1.0 / float(driven.model.omega.max()))
    places = 3 if quick else 12
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {}
    for law, case, methods, sizes in (
        ("hertz", hertz, HERTZ, np.geomspace(1 / 16, 2.0, 6) if quick else np.geomspace(1 / 64, 4.0, 13)),
        ("newton", newton, NEWTON, np.geomspace(1 / 64, 2.0, 6) if quick else np.geomspace(1 / 256, 4.0, 15)),
    ):
        arrays[f"{law}_step"] = sizes
        arrays[f"{law}_exact"] = np.array([case.exact.restitution, case.exact.kick])
        for label, make in methods.items():
            arrays[f"{law} {label}"] = table = outcomes(case, make, sizes, places)
            limits += rows_of(case, label, make(case.unit).name, sizes, table)
    return Findings(limits=limits, arrays=arrays)


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Restitution and kick against the step for both laws."""
    figure, axes = plotting.new_figure(2, 2, width=plotting.PAGE, height=0.124)
    laws = (("hertz", HERTZ, "Hertz contact", "$h$ / contact time"),
            ("newton", NEWTON, "Newton's law, e = 1", "$h\\,\\omega_\\mathrm{max}$"))  # fmt: skip
    for row, (law, methods, title, unit) in enumerate(laws):
        sizes, exact = arrays[f"{law}_step"], arrays[f"{law}_exact"]
        every = max(1, sizes.size // 6)
        for column, quantity in enumerate(("effective restitution", "kick of mode 1")):
            axis = axes[row, column]
            for number, label in enumerate(methods):
                table = arrays[f"{law} {label}"]
                axis.errorbar(
                    sizes, table[column], yerr=table[2 + column], **plotting.series(number), label=label,
                    elinewidth=0.6, markevery=every, errorevery=every,
                )  # fmt: skip
            axis.set_xscale("log")
            axis.axhline(exact[column], color="0.5", linewidth=0.8, linestyle=":", label="exact")
            plotting.panel(axis, 2 * row + column, title)
            plotting.label(axis.xaxis, unit)
            plotting.label(axis.yaxis, quantity)
        axes[row, 0].legend(loc="upper left")
    return figure, (
        "Restitution and kick of an elastic collision against the step; dotted: exact. Bars: spread over "
        "places of the touch in its step."
    )
