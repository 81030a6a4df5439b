"""How much model each question needs: level, mesh, modes, residual mode and contact law.

Claim: of the spring of the scene, a frequency needs the straight equivalent or less, the period that is
born at grazing needs Eq. (1) at most frequencies, and only the hysteresis needs the whole ladder.

For each quantity the cheapest model within the tolerance is found: Eq. (1), the straight equivalent of the
U, the arc-length U; with how many modes, with or without a residual one for those left out; with how many
elements; with Newton's, a linear or Hertz's contact. An error is the distance from a reference of 40 modes
and 96 elements on a leg, or what one coarseness alone changes there if that is more: errors that happen to
cancel get no credit; that of the reference itself is added.

Run:     python -m studies.adequacy [--quick]     1 min; --quick 15 s
Writes:  least.csv (a row a question: the least model, its error, that of the best one a step smaller in one
         thing), ladder.csv (every model tried), ladder.png (error against predicted cost)
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from studies.adequacy.models import LAWS, LEVELS, Choice, Models
from studies.adequacy.search import QUANTITIES, Row, Search
from studies.least_model import middle_of
from studies.run import Run, study
from studies.scene import Scene, harmonic

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Tried", "adequacy", "questions"]

SMALLEST = 1e-7
"""Errors below this, exact agreement among them, are drawn here."""


@dataclass(frozen=True, kw_only=True)
class Tried(Choice):
    """A model that was tried for a question, and its distance from the reference."""

    quantity: str
    frequency_hz: float
    cost_us: float
    error: float
    chosen: bool


@study()
def adequacy(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    models, rows, tried = Models(harmonic(scene)), list[Row](), list[Tried]()
    for quantity, frequency in run.track(questions(scene, run.quick), "questions"):
        search = Search(models, quantity, frequency)
        row = search.least(search.tolerance)
        rows.append(row)
        tried += [
            Tried(
                **asdict(one), quantity=quantity, frequency_hz=frequency, cost_us=one.cost,
                error=search.off(one), chosen=one.words == row.least,
            )
            for one in tuple(search.question.answers)
        ]  # fmt: skip
        if not row.reached:
            run.say(
                f"no model gives {quantity} at {frequency:g} Hz to {row.tolerance:g}: {row.error:.1e} is left"
            )
    shown = ("quantity", "frequency_hz", "tolerance", "error", "error_one_less", "least")
    run.table("least", rows, "The least model for each question.", show=shown)
    run.table("ladder", tried, show=())
    run.figure(
        "ladder", draw(rows, tried), "Error against predicted cost of every model tried; ringed: the least."
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


def draw(rows: Sequence[Row], tried: Sequence[Tried]) -> Figure:
    """A panel for each quantity, of several rows that which needs most."""
    from studies import plotting

    colours = dict(zip(LAWS, (plotting.ORANGE, plotting.BLUE, plotting.VERMILION), strict=True))
    marks = dict(zip(LEVELS, ("*", "^", "o", "s"), strict=True))
    of_kind = [[row for row in rows if row.quantity.startswith(kind)] for kind in QUANTITIES]
    shown = [max(group, key=lambda row: row.cost) for group in of_kind if group]
    with plotting.house_style():
        figure, axes = plotting.new_figure(
            math.ceil(len(shown) / 3), 3, width=plotting.PAGE, height=0.16, squeeze=False
        )
        for number, (ax, row) in enumerate(zip(axes.flat, shown, strict=False)):
            place = row.quantity, row.frequency_hz
            for one in (one for one in tried if (one.quantity, one.frequency_hz) == place):
                at = one.cost, max(one.error, SMALLEST if row.tolerance else 0.0)
                face = "none" if one.residual else colours[one.law]
                ax.plot(*at, marks[one.level], color=colours[one.law], mfc=face, ms=3.5, mew=0.7)
                if one.chosen:
                    ax.plot(*at, "o", color="black", mfc="none", ms=9.0)
            if row.tolerance:
                ax.axhline(row.tolerance, **plotting.GUIDE)
                ax.set_yscale("log")
            else:
                ax.set_ylim(bottom=-0.2)
            ax.set(xscale="log", xlim=(1.5, 40.0), xticks=(2, 5, 10, 20), xticklabels=("2", "5", "10", "20"))
            ax.minorticks_off()
            plotting.panel(ax, number, f"{row.quantity}, {row.frequency_hz:.2f} Hz".replace("_", " "))
            plotting.label(ax.xaxis, "predicted cost of a period", "µs")
            plotting.label(ax.yaxis, "error", row.unit)
        for ax in axes.flat[len(shown) :]:
            ax.set_visible(False)
        for name, mark in marks.items():
            if any(one.level == name for one in tried):
                axes[0, 0].plot([], [], mark, color="0.4", ms=3.5, label=LEVELS[name])
        for law, colour in colours.items():
            axes[0, 0].plot([], [], "o", color=colour, ms=3.5, label=f"{law.capitalize()} contact")
        axes[0, 0].plot([], [], "o", color="0.4", mfc="none", ms=3.5, label="with a residual mode")
        figure.legend(loc="outside lower center", ncols=4, fontsize=plotting.NOTE, frameon=False)
    return figure


if __name__ == "__main__":
    raise SystemExit(adequacy.main())
