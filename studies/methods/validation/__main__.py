"""The package compared with numbers that other authors printed.

Claim: six sources print frequencies, folds, doublings, grazing points or motions. This package has each of
these numbers within the error of its source, or a third route shows which side is right.

Four of them have one mode and a wall, one has two bars, one two beams (`model`). Each source keeps its own
numbers; the scene is not used. A note gives the third route.

Run:     python -m studies validation
Writes:  sources.csv (agreeing and differing numbers of each source), rows.csv, differences.png
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from matplotlib.figure import Figure

from contact import ContactError
from studies.methods.validation.model import (
    Printed,
    aberdeen,
    coco,
    ghosh_simpson,
    sdnd122,
    two_bars,
    two_beams,
)
from studies.shell import plotting
from studies.shell.digits import written
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

FLOOR = 1e-6  # differences below this part of the source's error are drawn there


@dataclass(frozen=True, kw_only=True)
class Tally:
    """How many numbers of a source agree and differ."""

    source: Annotated[str, "source"]
    agrees: Annotated[int, "numbers that agree"]
    differs: Annotated[int, "numbers that differ"]


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
        run.figure("differences", draw(rows), "Differences from published numbers over their error.")
        differs = sum(each.differs for each in sources)
        but = f" but {differs}" if differs else ""
        run.finding(f"All published numbers{but} agree with ours within the error of their source.")
    if Tally(source="SDND122", agrees=0, differs=1) in sources:
        run.finding("The source SDND122 smooths its wall; a closed form without that gives our frequency.")
    return {"sources": sources, "rows": rows}


@plotting.in_house_style
def draw(rows: Sequence[Printed]) -> Figure:
    """Differences over the error of the source, a line for each number; the source of most at the left."""
    figure, axes = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.135)
    names = list(dict.fromkeys(row.source for row in rows))
    most = max(names, key=[row.source for row in rows].count)
    for side, (axis, title) in enumerate(zip(axes, (most, "the other sources"), strict=True)):
        shown = [row for row in rows if (row.source == most) == (side == 0)]
        for place, row in enumerate(shown):
            over, look = abs(row.difference) / row.source_error, plotting.points(names.index(row.source))
            axis.plot(max(over, FLOOR), place, **look, label=row.source)
            if (far := over > 1.0) or over == 0.0:
                words = (
                    f"differs by {written(row.difference, 2)} {row.unit}   " if far else "   no difference"
                )
                look = {"fontsize": plotting.NOTE, "bbox": {"color": "white", "pad": 0.0}, "zorder": 1}
                axis.text(max(over, FLOOR), place, words, ha="right" if far else "left", va="center", **look)
        axis.axvline(1.0, **plotting.GUIDE, label="error of the source")
        axis.set_xscale("log")
        axis.set_yticks(range(len(shown)), [row.quantity.removesuffix(", their F") for row in shown])
        axis.invert_yaxis()
        plotting.panel(axis, side, title)
        plotting.label(axis.xaxis, "difference / error")
    plotting.legend_below(figure, axes, 4)
    return figure
