"""The package held against published numbers that nobody here wrote.

Claim: folds, doublings, exact solutions and measured frequencies of eight published sources are met within
the error of each source; where they are not, a third route says which side is right.

Each source keeps its own numbers (the scene is not used).  A row says what is published and what is found;
"open" marks what the source describes without a number.

Run:     python -m studies.validation     3 min, --quick 20 s
Writes:  rows.csv; one figure a source with a curve (png, pdf)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict

from studies.run import Run, study
from studies.scene import Scene
from studies.validation.bars import bar_at_wall, bouncing_bar, two_bars
from studies.validation.one_mode import aberdeen, coco, ghosh_simpson, sdnd122
from studies.validation.rows import Row, Section
from studies.validation.two_beams import two_beams
from studies.validation.two_masses import two_masses

__all__ = ["validation"]

SECTIONS: Mapping[str, Callable[[Run], Section]] = {
    "ghosh_simpson": ghosh_simpson,
    "coco": coco,
    "sdnd122": sdnd122,
    "aberdeen": aberdeen,
    "two_masses": two_masses,
    "bouncing_bar": bouncing_bar,
    "two_bars": two_bars,
    "bar_at_wall": bar_at_wall,
    "two_beams": two_beams,
}


@study()
def validation(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compare, store, draw."""
    from studies.validation.figure import draw  # matplotlib is slow to import

    rows: list[Row] = []
    for name, section in SECTIONS.items():
        run.say(name.replace("_", " "))
        found = section(run)
        rows += found.rows
        if found.panels:
            run.figure(name, draw(found.panels), found.caption)
    run.table("rows", rows, "Published numbers and ours.")
    return {"rows": [asdict(row) for row in rows]}


if __name__ == "__main__":
    raise SystemExit(validation.main())
