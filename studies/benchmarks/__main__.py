"""What a drive period costs: against modes, law, heyoka, and the arithmetic that none can avoid.

Claim: with one mode and the hard wall a drive period takes some tens of nanoseconds, two orders of magnitude
less than the fastest outside solver; with N modes and Hertz contact some microseconds, and no more than in
proportion to the modes.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02, one orbit and 32 on two cores; the beam's p4
at 21.50 Hz and excess 0.013 against the number of modes, with Hertz's and the linear contact, and without a
touch. What the periods of an orbit take beyond those without a touch is the cost of its collisions. With
--peers heyoka runs in turns with it, for Eq. (1) in its own loop, for the beam through the interface of all
methods at the tolerance that gives 1e-8 or better; its error is that of mode 1 past a collision, against the
exact method, which `studies.work_precision` holds to 1e-15. "floor" is the arithmetic of periods without a
touch. Each motion is repeated and the median taken; nothing else of the study runs meanwhile.

Run:     python -m studies.benchmarks [--peers]     1 min, --quick 10 s
Writes:  costs.csv, costs.md (the table of the README), costs.png
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING, Annotated

from studies import letter
from studies.benchmarks.cases import FLOOR, HEYOKA, OURS, Row, batch_rows, beam_rows, single_rows
from studies.peers import missing_solvers
from studies.run import Run, study
from studies.scene import Scene, beam_at, harmonic, model_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["HEADING", "SHOWN", "benchmarks", "cost_table", "ratios_of"]

FREQUENCY = 21.50
"""The letter's Fig. 4 [Hz]."""

COUNTS, COUNTS_QUICK = (1, 2, 4, 8, 15, 20, 40), (1, 8)
"""Numbers of modes."""

HEADING = "| case | modes | per drive period | per collision | floor | heyoka | its error |"
SHOWN = (
    ("single mode", "Eq. (1), hard wall, excess 0.02", (1,)),
    ("batch on two cores", "the same, 32 orbits on two cores", (1,)),
    ("beam, hertz contact", "beam, p4 at 0.013, Hertz contact", (8, 20, 40)),
    ("beam, linear contact", "the same, linear contact", (8, 20, 40)),
    ("beam, hertz contact, no touch", "the same without a touch, at -0.02", (8, 20, 40)),
)
"""Case, its title in the table, numbers of modes."""

DRAWN = (
    ("beam, hertz contact", OURS, "Hertz contact"),
    ("beam, linear contact", OURS, "linear contact"),
    ("beam, hertz contact, no touch", OURS, "no touch"),
    ("beam, hertz contact", FLOOR, "floor: carrying the modes"),
    ("beam, hertz contact", HEYOKA, "heyoka, Hertz contact"),
)
"""Case, tool and title of the lines of the figure."""


@study()
def benchmarks(
    scene: Scene, run: Run, *, peers: Annotated[bool, "run heyoka in turns with the package"] = False
) -> Mapping[str, object]:
    """Time, store and draw."""
    if peers and "heyoka" in missing_solvers():
        raise ValueError('heyoka is not installed; it comes with the extra peers: pip install -e ".[peers]"')
    frequencies = sorted(letter.PERIODS)[: 2 if run.quick else None]
    counts = COUNTS_QUICK if run.quick else COUNTS
    model = model_of(harmonic(scene).replace({"modes.count": max(counts)}))
    rows: list[Row] = []
    for frequency in run.track(frequencies, "Eq. (1)"):
        rows += single_rows(scene, frequency, quick=run.quick, peers=peers)
    rows += batch_rows(scene, frequencies[0], quick=run.quick, peers=peers)
    for law, n in run.track([(law, n) for law in ("hertz", "linear") for n in counts], "beam"):
        beam = beam_at(scene.replace({"contact.law": law}), FREQUENCY, model.truncated(n))
        rows += beam_rows(f"beam, {law} contact", beam, quick=run.quick, peers=peers)
    ratios = ratios_of(rows)
    run.table("costs", rows, "Time per drive period and per collision.")
    run.say(", ".join(f"{name} {ratio:.3g}" for name, ratio in ratios.items()))
    run.text("costs.md", "\n".join(cost_table(rows)) + "\n")
    run.figure("costs", draw_costs(rows), "Time per drive period against the number of modes, with two "
               "contact laws, without a touch, and the arithmetic that none can avoid.")  # fmt: skip
    return {"rows": rows, "ratios": ratios}


def rows_at(rows: Sequence[Row], case: str, tool: str, modes: int | None = None) -> list[Row]:
    """The rows of a case and tool."""
    return [row for row in rows if (row.case, row.tool) == (case, tool) and modes in (None, row.modes)]


def seconds(microseconds: float | None) -> str:
    """Two digits with the unit in which they read well."""
    if microseconds is None:
        return "-"
    units = ((1e6, "s"), (1e3, "ms"), (1.0, "us"))
    size, unit = next((pair for pair in units if microseconds >= pair[0]), (1e-3, "ns"))
    return f"{float(f'{microseconds / size:.2g}'):g} {unit}"


def cost_table(rows: Sequence[Row]) -> list[str]:
    """The lines of the table in Markdown; times of Eq. (1) are medians over the letter's frequencies."""

    def middle(found: Sequence[Row], key: str) -> float | None:
        values = [getattr(row, key) for row in found if getattr(row, key) is not None]
        return median(values) if values else None

    lines = [HEADING, "|---|---|---|---|---|---|---|"]
    for case, title, counts in SHOWN:
        for modes in counts:
            ours, theirs = rows_at(rows, case, OURS, modes), rows_at(rows, case, HEYOKA, modes)
            bottom = rows_at(rows, case.removesuffix(", no touch"), FLOOR, modes)
            error = middle(theirs, "error")
            cells = (
                title, str(modes), seconds(middle(ours, "us_per_period")),
                seconds(middle(ours, "us_per_collision")), seconds(middle(bottom, "us_per_period")),
                seconds(middle(theirs, "us_per_period")), "-" if error is None else f"{error:.0e}",
            )  # fmt: skip
            if ours:
                lines.append("| " + " | ".join(cells) + " |")
    return lines


def ratios_of(rows: Sequence[Row]) -> dict[str, float]:
    """heyoka's time over ours for Eq. (1) over the frequencies, and the exponents of the beam's growth
    between the two largest numbers of modes."""
    ours, theirs = (
        {row.frequency_hz: row.us_per_period for row in rows_at(rows, "single mode", tool)}
        for tool in (OURS, HEYOKA)
    )
    over = [theirs[frequency] / cost for frequency, cost in ours.items() if frequency in theirs]
    named = (("least", min), ("median", median), ("largest", max))
    ratios = {f"single_mode_{name}": chosen(over) for name, chosen in named if over}
    for law in ("hertz", "linear"):
        cost = sorted((row.modes, row.us_per_period) for row in rows_at(rows, f"beam, {law} contact", OURS))
        for (few, low), (many, high) in list(pairwise(cost))[-1:]:
            ratios[f"{law}_growth_with_modes"] = math.log(high / low) / math.log(many / few)
    return ratios


def draw_costs(rows: Sequence[Row]) -> Figure:
    """Time per drive period against the number of modes."""
    from studies import plotting  # matplotlib is slow to import

    with plotting.house_style():
        figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.075)
        for number, (case, tool, title) in enumerate(DRAWN):
            cost = sorted((row.modes, row.us_per_period) for row in rows_at(rows, case, tool))
            if cost:
                axes.plot(*zip(*cost, strict=True), **plotting.series(number), label=title)
        ticks = sorted({row.modes for row in rows if row.case.startswith("beam")})
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xticks(ticks, [str(tick) for tick in ticks])
        axes.minorticks_off()
        plotting.label(axes.xaxis, "number of modes")
        plotting.label(axes.yaxis, "time per drive period", "µs")
        figure.legend(loc="outside lower center", ncols=2)
    return figure


if __name__ == "__main__":
    raise SystemExit(benchmarks.main())
