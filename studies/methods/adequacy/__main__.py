"""How detailed the model must be for each question.

Question: what is the least model for the period that is born at grazing, a collision, or the hysteresis?

For each quantity the cheapest model within the tolerance is found: Eq. (1) or the beam; with how many modes,
with or without a residual one for those left out; with how many elements; with Newton's, a linear or Hertz's
contact. An error is the distance from a reference of 40 modes and 96 elements on a leg, or what one
coarseness alone changes there if that is more: errors that happen to cancel get no credit; that of the
reference itself is added.

Run:     python -m studies adequacy [--quick]
Writes:  least.csv (a row a question: the least model, its error, that of the best one a step smaller in one
         thing), least.png (both errors over the tolerance)
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from studies.methods.adequacy.models import Models
from studies.methods.adequacy.search import Row, Search
from studies.physics.least_model import middle_of
from studies.shell.scene import Scene, harmonic
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@study()
def adequacy(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    models, rows = Models(harmonic(scene)), list[Row]()
    for quantity, frequency in run.track(questions(scene, run.quick), "questions"):
        search = Search(models, quantity, frequency)
        row = search.least(search.tolerance)
        rows.append(row)
        if not row.reached:
            left = f" to {row.tolerance:g}: {row.error:.1e} is left" if math.isfinite(row.error) else ""
            run.say(f"none of the models gives {quantity} at {frequency:g} Hz{left}")
    shown = ("quantity", "frequency_hz", "tolerance", "error", "error_one_less", "least")
    run.table("least", rows, "The least model for each question.", of=Row, show=shown)
    run.figure(
        "least",
        draw(rows),
        "Error of the least model for each question over its tolerance, and that "
        "of the best one a step smaller in one thing.",
    )
    return {"rows": rows}


def questions(scene: Scene, quick: bool) -> list[tuple[str, float]]:
    """Quantities and drive frequencies [Hz]."""
    middle, drives = middle_of(scene), sorted(scene.drive.frequencies_hz)
    asked = [(f"frequency {number}", middle) for number in ((1, 3) if quick else (1, 3, 5, 10))]
    asked += [(name, middle) for name in ("restitution", "delay", "kick")]
    asked += [("born_period", f) for f in ([middle] if quick else drives)]
    asked += [("fold", f) for f in ([middle] if quick else drives[:3])]
    return asked if quick else [*asked, ("tip_trace", middle)]


def draw(rows: Sequence[Row]) -> Figure:
    """Errors over the tolerance, a line for each question that has one."""
    from studies.shell import plotting

    shown = [row for row in rows if row.tolerance][::-1]
    with plotting.house_style():
        figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.02 + 0.006 * len(shown))
        for place, row in enumerate(shown):
            axis.plot(row.error / row.tolerance, place, **plotting.points(1), label="the least model")
            if row.error_one_less is not None and math.isfinite(row.error_one_less):
                axis.plot(
                    row.error_one_less / row.tolerance,
                    place,
                    **plotting.points(2),
                    label="the best one a step smaller",
                )
        axis.axvline(1.0, **plotting.GUIDE)
        axis.set_xscale("log")
        words = [f"{row.quantity.replace('_', ' ')}, {row.frequency_hz:.2f} Hz: {row.least}" for row in shown]
        axis.set_yticks(range(len(shown)), words)
        plotting.label(axis.xaxis, "error / tolerance")
        plotting.legend_below(figure, [axis], 2)
    return figure
