"""The package compared with results that other authors published.

Claim: what nine sources print of folds, doublings, exact solutions and measured frequencies is met within the
error of each; where it is not, a third route says which side is right.

    one mode, hard or soft wall    Ghosh and Simpson; COCO 15.2; SDND122; the Aberdeen rig
    two masses                     NLvib 03: folds, doublings and tori of the response
    bars                           bouncing bar; SDNL111; a bar at a wall
    a measured system              two beams of Woiwode and Krack: frequencies, backbone, detached curves

Each keeps its own numbers (the scene is not used).  A row says what is published, what is found and what the
source is good to ("agrees", "differs"); whether words of the source or a second route of ours bear a number
out ("holds", "fails"); or that nothing is printed ("open").  Responses are followed as periodic orbits
through turning points, gained and lost touches, stable or not (``contact.orbits.follow_path``).

Run:     python -m studies validation
Writes:  sources.csv, rows.csv; for each source a table (csv) and a figure (png, pdf)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from contact import ContactError
from studies.methods.validation.bars import bar_at_wall, bouncing_bar, two_bars
from studies.methods.validation.nlvib import nlvib
from studies.methods.validation.one_mode import aberdeen, coco, ghosh_simpson, sdnd122
from studies.methods.validation.rows import Row, Section
from studies.methods.validation.two_beams import two_beams
from studies.shell.scene import Scene
from studies.shell.study import Run, study

SECTIONS: Mapping[str, Callable[[Run], Section]] = {
    "ghosh_simpson": ghosh_simpson,
    "coco": coco,
    "sdnd122": sdnd122,
    "aberdeen": aberdeen,
    "nlvib": nlvib,
    "bouncing_bar": bouncing_bar,
    "two_bars": two_bars,
    "bar_at_wall": bar_at_wall,
    "two_beams": two_beams,
}


@dataclass(frozen=True, kw_only=True)
class Source:
    """How many of its numbers agree or differ, hold or fail by another route, or are open; seconds taken."""

    source: str
    agrees: int
    differs: int
    holds: int
    fails: int
    open: int
    took_s: float


@study()
def validation(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compare, store, draw."""
    from studies.methods.validation.figure import draw  # matplotlib is slow to import

    rows, sources = list[Row](), list[Source]()
    for name, section in SECTIONS.items():
        begun = run.wall_time
        try:
            found = section(run)
        except ContactError as error:
            run.failed(name, error)
            continue
        rows += found.rows
        run.table(name, found.rows, found.caption)
        if found.panels:
            run.figure(name, draw(found.panels), found.caption)
        tally = Counter(row.verdict for row in found.rows)
        sources.append(
            Source(
                source=found.rows[0].source,
                agrees=tally["agrees"],
                differs=tally["differs"],
                holds=tally["holds"],
                fails=tally["fails"],
                open=tally["open"] + tally["not found"],
                took_s=round(run.wall_time - begun, 1),
            )
        )
    run.table("sources", sources, "Verdicts on the numbers of each source.")
    run.table("rows", rows, "Published numbers and ours.", show=())
    return {"sources": sources, "rows": rows}
