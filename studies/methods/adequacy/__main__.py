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
from typing import TYPE_CHECKING, Any

from studies.methods.adequacy.models import EQ_1, Models
from studies.methods.adequacy.search import LeastModel, Search
from studies.physics.least_model import middle_of
from studies.shell.columns import written
from studies.shell.scene import Scene, harmonic
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDEST = 2.0
"""End of the axis of the figure: errors over their tolerances [1]."""


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
        "Error of the least model for each question over its tolerance, and that of the best model that is a "
        "step smaller in one thing. Both include the error of the reference.",
    )
    for sentence in sentences(rows):
        run.finding(sentence)
    return {"rows": rows}


def sentences(rows: Sequence[LeastModel]) -> Iterator[str]:
    """What the questions on impacts need."""
    for row in rows:
        if row.quantity == "restitution" and row.reached:
            yield f"The restitution of a collision needs {needs([row])}."
    born = [row for row in rows if row.quantity == "born period"]
    if beyond := [row for row in born if not row.reached or row.level != EQ_1.level]:
        most = f"but {written(beyond[0].frequency_hz)} Hz" if len(beyond) == 1 < len(born) else "but some"
        where = f"at all drive frequencies {most}" if len(beyond) < len(born) else "at no drive frequency"
        yield f"Eq. (1) gives the period that is born at grazing {where}."
    elif born:
        yield "Eq. (1) gives the period that is born at grazing wherever it was tried."
    folds = [row for row in rows if row.quantity == "fold"]
    if folds and all(row.reached for row in folds):
        yield f"The hysteresis of the born orbit needs {needs(folds)}."


def needs(rows: Sequence[LeastModel]) -> str:
    """The largest of the least models, in words."""
    modes = max(0 if row.level == EQ_1.level else row.modes for row in rows)
    return f"{modes} mode{'s' * (modes > 1)} of the beam" if modes else "no more than Eq. (1)"


def questions(scene: Scene, quick: bool) -> list[tuple[str, float]]:
    """Quantities and drive frequencies [Hz]."""
    middle, drives = middle_of(scene), sorted(scene.drive.frequencies_hz)
    asked = [(f"frequency {number}", middle) for number in ((1, 3) if quick else (1, 3, 5, 10))]
    asked += [(name, middle) for name in ("restitution", "delay", "kick")]
    asked += [("born_period", f) for f in ([middle] if quick else drives)]
    asked += [("fold", f) for f in ([middle] if quick else drives[:3])]
    return asked if quick else [*asked, ("tip_trace", middle)]


def draw(rows: Sequence[LeastModel]) -> Figure:
    """Errors over the tolerance, a line for each question that has an answer; its model on the right."""
    from studies.shell import plotting

    shown = [row for row in rows if row.least != "none"][::-1]
    with plotting.house_style():
        figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.022 + 0.0055 * len(shown))
        for place, row in enumerate(shown):
            smaller = None if row.error_one_less is None else row.error_one_less + row.parts["reference"]
            errors = {"the least model": row.error, "the best model a step smaller": smaller}
            for number, (words, error) in enumerate(errors.items(), start=1):
                if error is None:
                    continue
                over = error / row.tolerance if row.tolerance else math.inf if error else 0.0
                look = plotting.points(number) | {"clip_on": False, "label": words}
                if over > WIDEST:
                    look |= {"marker": ">", "color": "0.4", "label": "beyond the axis"}
                axis.plot(min(over, WIDEST), place, **look)
        for place, words in enumerate([*(row.least.removeprefix("beam, ") for row in shown), "least model:"]):
            beside: dict[str, Any] = {"textcoords": "offset points", "va": "center"}
            axis.annotate(
                words, (1.0, place), (9.0, 0.0), axis.get_yaxis_transform(), fontsize=plotting.NOTE, **beside
            )
        axis.axvline(1.0, **plotting.GUIDE, label="tolerance")
        axis.set_xlim(0.0, WIDEST)
        axis.set_yticks(range(len(shown)), [f"{row.quantity}, {row.frequency_hz:.2f} Hz" for row in shown])
        plotting.label(axis.xaxis, "error / tolerance")
        plotting.legend_below(figure, [axis], 4)
    return figure
