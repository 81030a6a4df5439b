"""The costs as the README has them, the ratios, and the figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from studies.benchmarks.cases import BELOW, FLOOR, HEYOKA, OURS, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["EXCESS", "HEADING", "PEER_TOLERANCE", "SHOWN", "Ratio", "cost_table", "draw_costs", "ratios_of",
           "seconds"]  # fmt: skip

EXCESS, PEER_TOLERANCE = 0.013, 1e-7
"""F/F_g - 1 of the letter's Fig. 4; the coarsest of heyoka's decades whose error is below 1e-8."""

HEADING = "| case | modes | per drive period | per collision | floor | heyoka | its error |"
RULE = "|---|---|---|---|---|---|---|"

SHOWN = (
    ("single mode", "Eq. (1), hard wall, excess 0.02", (1,)),
    ("batch on two cores", "the same, 32 orbits on two cores", (1,)),
    ("beam, hertz contact", "beam, p4 at 0.013, Hertz contact", (8, 20, 40)),
    ("beam, linear contact", "the same, linear contact", (8, 20, 40)),
    ("beam, hertz contact, no touch", "the same without a touch, at -0.02", (8, 20, 40)),
)
"""Case, its title, numbers of modes."""

UNITS = ((1e6, "s"), (1e3, "ms"), (1.0, "us"), (1e-3, "ns"))
"""In microseconds."""

DRAWN = (
    ("beam, hertz contact", OURS, "Hertz contact"),
    ("beam, linear contact", OURS, "linear contact"),
    ("beam, hertz contact, no touch", OURS, "no touch"),
    ("beam, hertz contact", FLOOR, "floor: carrying the modes"),
    ("beam, hertz contact", HEYOKA, "heyoka, Hertz contact"),
)


@dataclass(frozen=True, kw_only=True)
class Ratio:
    """One ratio of costs, or exponent of their growth, and what it should reach."""

    name: str
    ratio: float
    goal: float | None = None


def rows_at(rows: Sequence[Row], case: str, tool: str, modes: int | None = None) -> list[Row]:
    """The rows of a case and tool, the beam's at the excess and heyoka's at the tolerance of the table."""
    beam = case.startswith("beam")
    excess = BELOW if case.endswith("no touch") else EXCESS
    return [
        row for row in rows
        if (row.case, row.tool) == (case, tool) and modes in (None, row.modes)
        and (not beam or row.excess == excess) and row.tolerance in (None, PEER_TOLERANCE)
    ]  # fmt: skip


def seconds(microseconds: float | None) -> str:
    """Two digits with the unit in which they read well."""
    if microseconds is None:
        return "-"
    size, unit = next((pair for pair in UNITS if microseconds >= pair[0]), UNITS[-1])
    return f"{float(f'{microseconds / size:.2g}'):g} {unit}"


def cost_table(rows: Sequence[Row]) -> list[str]:
    """The lines of the table in Markdown; times of Eq. (1) are medians over the letter's frequencies."""

    def middle(found: Sequence[Row], key: str) -> float | None:
        values = [getattr(row, key) for row in found if getattr(row, key) is not None]
        return median(values) if values else None

    lines = [HEADING, RULE]
    for case, title, counts in SHOWN:
        for modes in counts:
            ours, theirs = rows_at(rows, case, OURS, modes), rows_at(rows, case, HEYOKA, modes)
            bottom = rows_at(rows, case.removesuffix(", no touch"), FLOOR, modes)
            error = middle(theirs, "error")
            if ours:
                times = [middle(found, "us_per_period") for found in (ours, bottom, theirs)]
                cells = (
                    title, str(modes), seconds(times[0]), seconds(middle(ours, "us_per_collision")),
                    seconds(times[1]), seconds(times[2]), "-" if error is None else f"{error:.0e}",
                )  # fmt: skip
                lines.append("| " + " | ".join(cells) + " |")
    return lines


def ratios_of(rows: Sequence[Row]) -> list[Ratio]:
    """heyoka's time over ours, ours over the floor, and the growth with the modes."""

    def over(case: str, above: str, below: str, modes: int) -> list[float]:
        found = {tool: {row.frequency_hz: row.us_per_period for row in rows_at(rows, case, tool, modes)}
                 for tool in (above, below)}  # fmt: skip
        return [found[above][f] / found[below][f] for f in found[above] if f in found[below]]

    ratios = []
    single, batch = (over(case, HEYOKA, OURS, 1) for case in ("single mode", "batch on two cores"))
    if single:
        ratios += [Ratio(name="single_mode_median", ratio=median(single), goal=50.0),
                   Ratio(name="single_mode_least", ratio=min(single), goal=20.0)]  # fmt: skip
    ratios.append(Ratio(name="single_mode_over_floor", ratio=median(over("single mode", OURS, FLOOR, 1))))
    if batch:
        ratios.append(Ratio(name="batch", ratio=median(batch), goal=50.0))
    for law in ("hertz", "linear"):
        case = f"beam, {law} contact"
        cost = {row.modes: row.us_per_period for row in rows_at(rows, case, OURS)}
        for few, many in list(zip(sorted(cost)[:-1], sorted(cost)[1:], strict=True))[-1:]:
            growth = math.log(cost[many] / cost[few]) / math.log(many / few)
            ratios.append(Ratio(name=f"{law}_growth_with_modes", ratio=growth, goal=1.0))
        for modes in sorted(cost):
            ratios.append(
                Ratio(name=f"{law}_{modes}_modes_over_floor", ratio=over(case, OURS, FLOOR, modes)[0])
            )
            goal = 20.0 if (law, modes) == ("hertz", 8) else None
            ratios += [Ratio(name=f"{law}_{modes}_modes", ratio=one, goal=goal)
                       for one in over(case, HEYOKA, OURS, modes)]  # fmt: skip
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
