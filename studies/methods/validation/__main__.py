"""The package compared with numbers that other authors printed.

Claim: six sources print frequencies, folds, doublings, grazing points or motions. This package has each of
these numbers within the error of its source, or a third route shows which side is right.

    one mode, hard or soft wall    Ghosh and Simpson; COCO 15.2; SDND122; the Aberdeen rig
    two bars                       SDNL111: the contact of two uniform bars, tip to tip
    two beams                      Woiwode and Krack: measured frequencies of both beams

Each source keeps its own numbers (the scene is not used). A row holds what is published, what is found and
the error of the source: it "agrees" within that error and "differs" beyond it. The note gives the third
route.

Run:     python -m studies validation
Writes:  sources.csv (agreeing and differing numbers of each source), rows.csv, rows.png and .pdf
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from contact import ContactError
from studies.methods.validation.bars import two_bars
from studies.methods.validation.one_mode import aberdeen, coco, ghosh_simpson, sdnd122
from studies.methods.validation.printed import Printed
from studies.methods.validation.two_beams import two_beams
from studies.shell import plotting
from studies.shell.scene import Scene
from studies.shell.study import Run, study

SOURCES: Mapping[str, Callable[[], list[Printed]]] = {
    "Ghosh and Simpson": ghosh_simpson,
    "COCO 15.2": coco,
    "SDND122": sdnd122,
    "Aberdeen rig": aberdeen,
    "SDNL111": two_bars,
    "Woiwode and Krack 2024": two_beams,
}

FLOOR = 1e-6
"""Differences below this part of the source's error are drawn there."""


@dataclass(frozen=True, kw_only=True)
class Tally:
    """How many numbers of a source agree and differ."""

    source: str
    agrees: int
    differs: int


@study()
def validation(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compare, store, draw."""
    rows, sources = list[Printed](), list[Tally]()
    for name, compare in run.track(SOURCES.items(), "sources"):
        try:
            found = compare()
        except ContactError as error:
            run.failed(name, error)
            continue
        agrees = sum(row.verdict == "agrees" for row in found)
        sources.append(Tally(source=name, agrees=agrees, differs=len(found) - agrees))
        rows += found
    run.table("sources", sources, "Numbers of each source that agree and differ.", of=Tally)
    run.table("rows", rows, "Published numbers and ours.", of=Printed)
    if rows:
        run.figure("rows", draw(rows), "Differences from published numbers over the error of their source.")
    return {"sources": sources, "rows": rows}


@plotting.in_house_style
def draw(rows: Sequence[Printed]) -> Figure:
    """Differences over the error of the source, a line for each number."""
    figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.02 + 0.004 * len(rows))
    names = list(dict.fromkeys(row.source for row in rows))
    for place, row in enumerate(rows):
        look = plotting.points(names.index(row.source))
        axis.plot(max(abs(row.difference) / row.source_error, FLOOR), place, **look, label=row.source)
    axis.axvline(1.0, **plotting.GUIDE)
    axis.set_xscale("log")
    axis.set_yticks(range(len(rows)), [row.quantity for row in rows])
    axis.invert_yaxis()
    plotting.label(axis.xaxis, "difference / error of the source")
    plotting.legend_below(figure, [axis], 3)
    return figure
