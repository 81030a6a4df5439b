"""Claim d (letter 1996): born period against f T for several springs and contact laws.

"These phenomena ... are independent of the details of the dynamics in between collisions. They are,
therefore, predicted to be universal": at equal f T, T the damped period of the lowest mode, each spring is to
have just above grazing the period that the Nordmark map has as rho -> 0+.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from beam import ModalModel
from contact.errors import ContactError
from contact.maximal_orbits import band, maximal_period, maximal_periods
from contact.orbits import settling
from contact.stroboscope import StroboscopicMap
from studies.instruments.claims.single_mode_leaf import Leaf
from studies.instruments.claims.verdict import Claim, frequencies_of
from studies.instruments.figures import LETTER_POINTS, NOTE, PAGE, in_house_style, label, new_figure, series
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.tip_mass_family import bare_cantilever, with_mass_ratio
from studies.published import FREE_PERIOD_ERROR_S, FREE_PERIOD_S, PERIODS

__all__ = ["born_period", "springs", "universality_claim"]


def springs(scene: Scene) -> dict[str, tuple[Scene, ModalModel | None]]:
    """Springs and contact laws of the comparison; None for Eq. (1)."""
    middle = frequencies_of(scene)[len(frequencies_of(scene)) // 2]
    bare = bare_cantilever(scene, middle)
    heavy = with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.5, middle)
    u, leaf, loaded = model_of(scene), model_of(bare), model_of(heavy)

    def law(name: str, of: Scene = scene) -> Scene:
        return of.replace({"contact.law": name})

    return {
        "Eq. (1), Newton": (scene, None),
        "folded U, linear": (law("linear"), u),
        "folded U, Hertz": (law("hertz"), u),
        "folded U, Newton": (law("newton"), u),
        "bare cantilever, Hertz": (bare, leaf),
        "heavy-ball cantilever, Hertz": (heavy, loaded),
        "heavy-ball cantilever, Newton": (law("newton", heavy), loaded),
    }


CLOSER = 1.0 / 16.0
"""Part of the born excess at which a disagreement is looked at again: the claim is one about the limit."""


def born_period(
    scene: Scene, model: ModalModel | None, frequency: float, most_cycles: int, part: float = 1.0
) -> int:
    """Period at `part` of the born excess of the scene, 0 for none, -1 if it could not be followed."""
    oscillator = (
        single_mode_oscillator(scene, frequency) if model is None else beam_of(scene, frequency, model)
    )
    strobed = StroboscopicMap(oscillator=oscillator)
    excess = part * scene.scan.born_excess
    try:
        return settling.born_period(strobed, excess, below=-excess, most_cycles=most_cycles)
    except ContactError:
        return -1


@in_house_style
def universality_claim(scene: Scene, quick: bool, workers: int) -> Claim:
    """d: born period against f T."""
    leaf, tau = Leaf.of(scene), scene.single_mode.restitution
    positions = np.linspace(0.802, 0.956, 13 if quick else 55)
    entries = springs(scene)
    jobs = [(name, float(x)) for name in entries for x in positions]

    def job(item: tuple[str, float], part: float = 1.0) -> int:
        name, place = item
        of, model = entries[name]
        period = (
            of.single_mode.free_period_s
            if model is None
            else 2.0
            * math.pi
            / math.sqrt(float(model.omega[0]) ** 2 - 0.25 * float(model.decay_rate[0]) ** 2)
        )
        return born_period(of, model, place / period, 1500 if quick else 3000, part)

    allowed, quarter = {}, {}
    for place in positions.tolist():
        nordmark = leaf.map(place / leaf.free_period, tau)
        m = maximal_period(nordmark)
        allowed[place] = maximal_periods(nordmark)
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        part = (place / leaf.free_period - edge.lower) / (edge.upper - edge.lower)
        quarter[place] = min(3, max(0, math.floor(4.0 * part)))
    with ThreadPoolExecutor(max_workers=workers) as pool:
        found = list(pool.map(job, jobs))
        again = [
            item
            for item, p in zip(jobs, found, strict=True)
            if quarter[item[1]] == 3 and p not in allowed[item[1]]
        ]
        nearer = dict(zip(again, pool.map(lambda item: job(item, CLOSER), again), strict=True))
    figure, axis = new_figure(width=PAGE, height=0.085)
    numbers: dict[str, Any] = {}
    table: dict[str, list[Any]] = {n: [] for n in ("spring", "f_times_T", "period", "map")}
    for number, name in enumerate(entries):
        mine = [(place, period) for (who, place), period in zip(jobs, found, strict=True) if who == name]
        agree = [period in allowed[place] for place, period in mine]
        by_quarter = [
            [ok for ok, (place, _p) in zip(agree, mine, strict=True) if quarter[place] == q] for q in range(4)
        ]
        exceptions = [
            {"f_times_T": place, "period": period, "closer": nearer[name, place], "map": list(allowed[place])}
            for place, period in mine
            if (name, place) in nearer
        ]
        numbers[name] = {
            "agree": float(np.mean(agree)),
            "agree_by_quarter_of_band": [float(np.mean(q)) if q else None for q in by_quarter],
            "exceptions_in_top_quarter": exceptions,
            "without_period": sum(p == 0 for _x, p in mine),
            "failed": sum(p < 0 for _x, p in mine),
        }
        shift = 0.1 * (number - 0.5 * (len(entries) - 1))
        style = series(number)
        shown = [(x, p) for x, p in mine if 1 < p <= 12]
        axis.plot(
            [x for x, _p in shown],
            [p + shift for _x, p in shown],
            linestyle="none",
            marker=style["marker"],
            color=style["color"],
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
            label=name,
        )
        rest = [x for x, p in mine if not 1 < p <= 12]
        axis.plot(
            rest,
            [1.0 + shift] * len(rest),
            linestyle="none",
            marker=style["marker"],
            color=style["color"],
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
            gid=f"{name}, other than 2 to 12",
        )
        table["spring"] += [name] * len(mine)
        table["f_times_T"] += [x for x, _p in mine]
        table["period"] += [p for _x, p in mine]
        table["map"] += [" or ".join(map(str, allowed[x])) for x, _p in mine]
    for m in range(2, 13):
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        left, right = edge.lower * leaf.free_period, edge.upper * leaf.free_period
        axis.fill_between([left, right], m - 0.42, m + 0.42, color="0.88", linewidth=0.0, zorder=0,
                          gid=f"band of the map, m = {m}")
    axis.set_xlim(positions[0] - 0.003, positions[-1] + 0.003)
    axis.set_ylim(0.4, 12.6)
    axis.set_yticks([1, *range(2, 13)], ["other", *(str(m) for m in range(2, 13))])
    axis.errorbar(
        [f * FREE_PERIOD_S for f in PERIODS], list(PERIODS.values()),
        xerr=[f * FREE_PERIOD_ERROR_S for f in PERIODS], **LETTER_POINTS, elinewidth=0.7, ecolor="black",
        label="letter, error of T",
    )  # fmt: skip
    label(axis.xaxis, "$f T$")
    label(axis.yaxis, f"period $m$ born, excess {scene.scan.born_excess:g}")
    figure.legend(
        loc="outside lower center", ncols=3, title="grey: bands of the Nordmark map", title_fontsize=NOTE
    )
    unlike = {name: numbers[name]["exceptions_in_top_quarter"] for name in entries}
    wrong = [name for name, some in unlike.items() if any(e["closer"] not in e["map"] for e in some)]
    some_unlike = ", ".join(name for name, some in unlike.items() if some)
    least = min(float(numbers[name]["agree"]) for name in entries)
    failed = sum(int(numbers[name]["failed"]) for name in entries)
    count = sum(len(some) for some in unlike.values())
    top = sum(quarter[place] == 3 for place in positions.tolist()) * len(entries)
    sentence = (
        f"In the quarter of each band next to its upper edge, {top - count} of {top} pairs of frequency and "
        f"spring have the period of the map at excess {scene.scan.born_excess:g}"
    )
    if count:
        closer = (
            f"at a sixteenth of that excess {'not even then: ' + ', '.join(wrong) if wrong else 'all have'}"
        )
        sentence += f" (exceptions: {some_unlike}; {closer})"
    sentence += (
        f". Over whole bands, where secondary bifurcations come first, it is {100 * least:.0f} % or more."
    )
    return Claim(
        holds=None if failed else not wrong,
        table=table,
        figure=figure,
        numbers={**numbers, "closer_excess": CLOSER * scene.scan.born_excess},
        sentence=sentence,
    )
