"""How detailed the model must be for each question.

Question: what is the least model for the period that is born at grazing, a collision, or the hysteresis?

For each quantity the cheapest model within the tolerance is found: Eq. (1) or the beam; with how many modes,
with or without a residual one for those left out; with how many elements; with Newton's, a linear or Hertz's
contact. An error is the distance from a reference of 40 modes and 96 elements on a leg, or what one
coarseness alone changes there if that is more: errors that happen to cancel get no credit; that of the
reference itself is added.

Run:     python -m studies adequacy [--quick]
Writes:  least.csv (a row a question), least.png (errors over the tolerance)
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from studies.methods.adequacy.model import EQ_1, LeastModel, Models, Search
from studies.physics.least_model import middle_of
from studies.shell.scene import Scene, harmonic
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@study()
def adequacy(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    models, rows = Models(harmonic(scene)), list[LeastModel]()
    for quantity, frequency in run.track(questions(scene, run.quick), "questions"):
        search = Search(models, quantity, frequency)
        row = search.least(search.tolerance)
        rows.append(row)
        if not row.reached:
            left = f" to {row.tolerance:g}: {row.error:.1e} is left" if math.isfinite(row.error) else ""
            run.say(f"none of the models gives the {row.quantity} at {frequency:g} Hz{left}")
    shown = ("quantity", "frequency_hz", "tolerance", "error", "error_one_less", "least")
    run.table("least", rows, "The least model for each question.", of=LeastModel, show=shown)
    run.figure(
        "least",
        draw(rows),
        "Errors of the least model and of the best model a step smaller in one thing, over the tolerance.",
    )
    for sentence in sentences(rows):
        run.finding(sentence)
    return {"rows": rows}


def sentences(rows: Sequence[LeastModel]) -> Iterator[str]:
    """What the questions on impacts need, where some model answers them."""
    for name, what in {"restitution": "restitution of a collision", "fold": "hysteresis"}.items():
        found = [row for row in rows if row.quantity == name and row.reached]
        if modes := max((row.modes for row in found if row.level != EQ_1.level), default=0):
            yield f"The {what} needs {modes} mode{'s' * (modes > 1)} of the beam."
    born = [row for row in rows if row.quantity == "born period"]
    beyond = [f" except at {row.frequency_hz:g} Hz" for row in born if row.level != EQ_1.level]
    if len(beyond) < min(2, len(born)):
        yield f"Eq. (1) gives the period that is born at grazing{''.join(beyond)}."


def questions(scene: Scene, quick: bool) -> list[tuple[str, float]]:
    """Quantities and drive frequencies [Hz]."""
    middle, drives = middle_of(scene), sorted(scene.drive.frequencies_hz)
    found = [(f"frequency {number}", middle) for number in ((1, 3) if quick else (1, 3, 5, 10))]
    found += [(name, middle) for name in ("restitution", "delay", "kick")]
    found += [("born_period", f) for f in ([middle] if quick else drives)]
    found += [("fold", f) for f in ([middle] if quick else drives[:3])]
    return found if quick else [*found, ("tip_trace", middle)]


def draw(rows: Sequence[LeastModel]) -> Figure:
    """Errors over the tolerance, a line for each question that has an answer; its model on the right."""
    from studies.shell import plotting

    shown, widest = [row for row in rows if row.least != "none"][::-1], 2.0
    with plotting.house_style():
        figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.12)
        for place, row in enumerate(shown):
            smaller = math.nan if row.error_one_less is None else row.error_one_less + row.parts["reference"]
            errors = {"the least model": row.error, "the best model a step smaller": smaller}
            for number, (words, error) in enumerate(errors.items(), start=1):
                over = error / row.tolerance if row.tolerance else math.inf if error > 0.0 else error
                look = plotting.points(number) | {"clip_on": False, "label": words}
                if over > widest:
                    look |= {"marker": ">", "color": "0.4", "label": "beyond the axis"}
                axis.plot(min(over, widest), place, **look)
            across = axis.get_yaxis_transform()
            words = row.least.removeprefix("beam, ").removesuffix(" contact")
            beside = {"va": "center", "fontsize": plotting.NOTE}
            axis.annotate(words, (1.0, place), (10.0, 0.0), across, "offset points", **beside)
        axis.set_title("least model, contact law", x=1.12, loc="left")
        axis.axvline(1.0, **plotting.GUIDE, label="tolerance")
        axis.set_xlim(0.0, widest)
        axis.set_yticks(range(len(shown)), [f"{row.quantity}, {row.frequency_hz:.2f} Hz" for row in shown])
        plotting.label(axis.xaxis, "error / tolerance")
        plotting.legend_below(figure, [axis], 2)
    return figure
