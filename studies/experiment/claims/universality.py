"""Born period against f T for several springs and contact laws, beside the bands of the Nordmark map.

At equal f T, T the damped period of the lowest mode, each spring is to have just above grazing the period
that the map has as rho -> 0+. That is a claim about the limit: over whole bands secondary bifurcations come
before the born excess, so that it is judged in the quarter of each band next to its upper edge, where the
hysteresis is small, and where a spring disagrees there, again at a sixteenth of the excess. Cells without a
period count as disagreement; none is drawn as a period.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from beam import ModalModel
from contact import maximal_period, maximal_periods
from contact.orbits import born_period
from studies import letter
from studies.physics.calibration import bare_cantilever, with_mass_ratio
from studies.physics.descriptions import strobed_at
from studies.shell import plotting
from studies.shell.scene import Scene, band_of, model_of, nordmark_at, single_mode_of
from studies.shell.study import Run

SPAN = (0.802, 0.956)
"""f T from the band of p3 to that of p11."""

TOP = 0.75
"""Part of a band above which a frequency is next to its upper edge."""

CLOSER = 1.0 / 16.0
"""Part of the born excess at which a disagreement is looked at again."""


MOST_CYCLES = 3000
"""Bound of a transient [drive periods]."""


@dataclass(frozen=True, kw_only=True)
class Born:
    """One spring at one f T: `period` born (0: not settled; None: could not be followed).

    `map`: periods that the map has there as rho -> 0+; `next_to_edge`: in the upper quarter of the band;
    `closer`: period at a sixteenth of the excess, where it was asked.
    """

    spring: str
    f_times_t: float
    period: int | None
    map: tuple[int, ...]
    next_to_edge: bool
    settled: bool
    closer: int | None = None

    @property
    def agrees(self) -> bool:
        """Whether the map has this period."""
        return self.period in self.map


class Job(NamedTuple):
    """A spring, by its modes and the scene that has its contact law, at f T and an excess [1]."""

    spring: str
    scene: Scene
    model: ModalModel
    f_times_t: float
    excess: float

    def __str__(self) -> str:
        return f"{self.spring}, f T = {self.f_times_t:.4g}"


def springs(scene: Scene) -> list[tuple[str, Scene, ModalModel]]:
    """Springs and contact laws of the comparison; Eq. (1) first."""
    drives = sorted(scene.drive.frequencies_hz)
    middle = drives[len(drives) // 2]
    bare = bare_cantilever(scene, middle)
    heavy = with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.5, middle)
    u, loaded, tau = model_of(scene), model_of(heavy), scene.single_mode.restitution
    linear, hertz, newton = (scene.replace({"contact.law": law}) for law in ("linear", "hertz", "newton"))
    return [
        ("Eq. (1), Newton", newton.replace({"contact.local_restitution": tau}), single_mode_of(scene)),
        ("the spring, linear", linear, u),
        ("the spring, Hertz", hertz, u),
        ("the spring, Newton", newton, u),
        ("bare cantilever, Hertz", bare, model_of(bare)),
        ("heavy-ball cantilever, Hertz", heavy, loaded),
        ("heavy-ball cantilever, Newton", heavy.replace({"contact.law": "newton"}), loaded),
    ]


def born_at(job: Job) -> int:
    """Period that is born; 0 for none."""
    strobed = strobed_at("beam", job.scene, job.f_times_t / job.model.free_period, job.model)
    return born_period(strobed, job.excess, most_cycles=MOST_CYCLES)


def universality(scene: Scene, run: Run, *, positions: int) -> Mapping[str, object]:
    """Compute, store, draw and judge."""
    rows, excess = born_everywhere(scene, run, positions), scene.scan.born_excess
    run.table(
        "universality", rows, "Period born just above grazing, and that of the map as rho -> 0+.", show=()
    )
    run.figure(
        "universality",
        draw(scene, rows),
        "Period born at grazing for seven springs and contact laws"
        "; grey, the bands of the map. Near the upper edge of a band all agree with it.",
    )
    failed = any(row.period is None for row in rows)
    agree = {
        name: float(np.mean([row.agrees for row in rows if row.spring == name]))
        for name in dict.fromkeys(row.spring for row in rows)
    }
    top = [row for row in rows if row.next_to_edge]
    odd = [row for row in top if not row.agrees]
    holds = all(row.closer in row.map for row in odd)
    if top and not failed:
        note = "over whole bands, where secondary bifurcations come first, "
        note += f"{100 * min(agree.values()):.0f} % or more"
        if odd:
            who = ", ".join(dict.fromkeys(row.spring for row in odd))
            note += f"; exceptions: {who}; at a sixteenth of the excess {'none' if holds else 'still some'}"
        run.verdict(
            "universality",
            "agrees" if holds else "in part",
            found=f"next to the upper edges {len(top) - len(odd)} of {len(top)} pairs of frequency and"
            f" spring have the period of the map at excess {excess:g}",
            note=note,
        )
    return {
        "holds": None if failed else holds,
        "agree": agree,
        "exceptions_in_top_quarter": odd,
        "closer_excess": CLOSER * excess,
        "not_settled": sum(not row.settled for row in rows),
    }


def born_everywhere(scene: Scene, run: Run, count: int) -> list[Born]:
    """Every spring at every f T; the disagreements next to an upper edge once more, closer to grazing."""
    excess = scene.scan.born_excess
    places = np.linspace(*SPAN, count).tolist()
    jobs = [Job(*spring, place, excess) for spring in springs(scene) for place in places]
    rows = []
    for job, period in zip(jobs, run.attempt(born_at, jobs, "born periods"), strict=True):
        frequency = job.f_times_t / scene.single_mode.free_period_s
        nordmark = nordmark_at(scene, frequency)
        edges = band_of(scene, maximal_period(nordmark))
        part = (frequency - edges.lower) / (edges.upper - edges.lower)
        rows.append(
            Born(
                spring=job.spring,
                f_times_t=job.f_times_t,
                period=period,
                map=maximal_periods(nordmark),
                next_to_edge=part >= TOP,
                settled=bool(period),
            )
        )
    again = [i for i, row in enumerate(rows) if row.next_to_edge and not row.agrees]
    nearer = [jobs[i]._replace(excess=CLOSER * excess) for i in again]
    for i, period in zip(again, run.attempt(born_at, nearer, "closer to grazing"), strict=True):
        rows[i] = replace(rows[i], closer=period)
    return rows


@plotting.in_house_style
def draw(scene: Scene, rows: Sequence[Born]) -> Figure:
    """Born periods over the bands of the map; what has no period from 2 to 12 lies in the lowest row."""
    figure, axis = plotting.new_figure(width=plotting.PAGE, height=0.085)
    names, period = list(dict.fromkeys(row.spring for row in rows)), scene.single_mode.free_period_s
    for number, name in enumerate(names):
        mine = [row for row in rows if row.spring == name]
        shift, style = 0.1 * (number - 0.5 * (len(names) - 1)), plotting.points(number)
        heights = [row.period if row.period and 1 < row.period <= 12 else 1 for row in mine]
        axis.plot(
            [row.f_times_t for row in mine],
            [height + shift for height in heights],
            **style,
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
            label=name,
        )
    for m in range(2, 13):
        edges = band_of(scene, m)
        axis.fill_between(
            [edges.lower * period, edges.upper * period],
            m - 0.42,
            m + 0.42,
            color="0.88",
            linewidth=0.0,
            zorder=0,
            gid=f"band of the map, m = {m}",
        )
    axis.set_xlim(SPAN[0] - 0.003, SPAN[1] + 0.003)
    axis.set_ylim(0.4, 12.6)
    axis.set_yticks([1, *range(2, 13)], ["other", *(str(m) for m in range(2, 13))])
    axis.errorbar(
        [f * letter.FREE_PERIOD_S for f in letter.PERIODS],
        list(letter.PERIODS.values()),
        xerr=[f * letter.FREE_PERIOD_ERROR_S for f in letter.PERIODS],
        **plotting.LETTER_POINTS,
        elinewidth=0.7,
        ecolor="black",
        label="letter, error of T",
    )
    plotting.label(axis.xaxis, "$f T$")
    plotting.label(axis.yaxis, f"period $m$ born, excess {scene.scan.born_excess:g}")
    figure.legend(
        loc="outside lower center",
        ncols=3,
        title="grey: bands of the Nordmark map",
        title_fontsize=plotting.NOTE,
    )
    return figure
