"""Restitution that a method fakes: energy it takes from, or gives to, an elastic collision.

The spring of the scene with `MODES` modes meets the plate once, at the excess of the letter's Fig. 4, under
Hertz's law, which is elastic. The exact motion has an effective restitution tau and a kick
(``contact.collision``) because energy goes into the higher modes; a method with a step h has others. The kick
of a single short contact is nearly in proportion to 1 + e of the contact itself, so that

    2 kick(h)/kick - 1

is about the local restitution that it pretends to have, where there is 1.

Steps are given in contact times; each value is a mean over places of the touch in its step. Theory in the
table is the exact collision. What the methods for Newton's law make of a step is in
`studies.methods.work_precision`.
"""

import math
from collections.abc import Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from contact import ImpactOscillator, before_collision, collisions, first_collision, simulate
from contact.integrators import GeneralisedAlpha, Integrator
from studies import letter
from studies.methods.stability.model import IMPLICIT, Findings, Limit
from studies.shell import plotting
from studies.shell.scene import Scene, beam_at

MODES = 10

entry = partial(Limit, family="false_restitution", method=GeneralisedAlpha.name, refused=False)


def outcome(driven: ImpactOscillator, method: Integrator) -> tuple[float, float]:
    """Restitution and kick of the first collision by `method`; NaN if its damping keeps the tip off the
    stop."""
    motion = simulate(driven, before_collision(driven), periods=2, method=method)
    found = collisions(motion, unfinished="drop")
    return (found[0].restitution, found[0].kick) if found else (math.nan, math.nan)


def outcomes(driven: ImpactOscillator, label: str, steps: np.ndarray, places: int) -> np.ndarray:
    """Mean restitution and kick by a method of `IMPLICIT` as rows; a column for every step [s].

    One place without a collision, or with a kick but no return, and the whole step has none (NaN).
    """
    # steps of nearly the same size put the touch at different places of theirs
    spread = 1.0 + 0.03 * (np.arange(places) / places - 0.5)
    found = [[outcome(driven, IMPLICIT[label](h)) for h in (step * spread).tolist()] for step in steps]
    return np.array(found).mean(axis=1).T


def measure(scene: Scene, quick: bool) -> Findings:
    """Every method over the step; the rows are of a step of about one contact time, the largest up to there
    at which there is a restitution at all."""
    middle = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2]
    kept = scene.replace({"modes.count": MODES, "contact.law": "hertz"})
    driven = beam_at(kept, middle).with_excess(letter.TIME_TRACE_EXCESS)
    exact = first_collision(driven)
    sizes = np.geomspace(1 / 16, 2.0, 6) if quick else np.geomspace(1 / 64, 4.0, 13)
    limits: list[Limit] = []
    arrays = {"step": sizes, "exact": np.array([exact.restitution, exact.kick])}
    for label in IMPLICIT:
        table = arrays[label] = outcomes(driven, label, sizes * exact.contact_time, 3 if quick else 12)
        last = int(np.flatnonzero(np.isfinite(table[0]) & (sizes < 1.1))[-1])
        row = partial(entry, case=f"{label}, elastic Hertz, h / contact time = {sizes[last]:.3g}")
        limits += [
            row(parameter="restitution τ", theory=exact.restitution, measured=float(table[0, last])),
            row(
                parameter="local restitution 2 kick(h)/kick − 1",
                theory=1.0,
                measured=float(2.0 * table[1, last] / exact.kick - 1.0),
            ),
        ]
    return limits, arrays


HOLDS = "step: over contact time [1]; exact, and each method: restitution, then kick, at each step [1]."


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Restitution and kick against the step."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.065)
    titles = {"effective restitution": "restitution τ", "kick of mode 1": "kick"}
    for column, (axis, (title, quantity)) in enumerate(zip(axes, titles.items(), strict=True)):
        for number, label in enumerate(IMPLICIT):
            axis.plot(arrays["step"], arrays[label][column], **plotting.series(number), label=label)
        axis.set_xscale("log")
        axis.axhline(arrays["exact"][column], color="0.5", linewidth=0.8, linestyle=":", label="exact motion")
        plotting.panel(axis, column, title)
        plotting.label(axis.xaxis, "step / contact time")
        plotting.label(axis.yaxis, quantity)
    plotting.legend_below(figure, axes, 3)
    return figure, (
        "Restitution and kick of an elastic collision against the step. Each is a mean over places of the "
        "touch in its step."
    )
