"""For students: what to set on the bench, and what is seen.

Computed with all modes, at one drive frequency:

    settings    amplitudes of the base at which impacts begin, and end when it is lowered again
    table       impacts in so many shakes, for a rising and a falling amplitude
    slides      what grazing is, and the orbit diagram, in 16:9 whatever the --style
    film        one period of the orbit at --excess, slow at its impacts

An amplitude is the largest displacement of the base.  The setting at which
impacts begin is rounded up, and the one at which they end is rounded down.

Run:     python -m studies lecture --scene steel_ruler [--frequency HZ] [--excess E] [--no-film]
Writes:  lecture.txt, seen.csv, slide_1.png, slide_2.png, motion.gif, motion.pvd; motion.mp4 (extra `video`)
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Annotated

import numpy as np
from scipy.constants import g

from contact import State, StroboscopicMap, plots
from contact.orbits import onset_orbit, settle
from studies import letter
from studies.experiment import film as filming
from studies.experiment.trace import NEEDS, Trace, conditions, repeats, trace_of
from studies.physics.descriptions import BELOW, Diagram, up_and_down
from studies.shell.film import MOST_FRAMES
from studies.shell.options import HERTZ, Within, style_of
from studies.shell.scene import Scene, beam_at, harmonic, model_of, require_drive_below
from studies.shell.scene.spring import spring_in_words
from studies.shell.study import Run, study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STROBES, SHAKES = 64, 8  # shakes in the orbit diagram, and against time
FIRST_STEP, GROWTH, HALVINGS, LOWEST = 1e-4, 0.03, 4, -0.6
"""Of the way down: first step, steps over the way gone, halvings of the last step, and end [excess]."""
COARSE, SHARE = 2, 0.02  # decimals of a shaker in mm; largest step of a setting over the amplitude


@dataclass(frozen=True)
class Seen:
    """What is seen over a range of amplitudes of the base, in the order of a scan."""

    direction: Annotated[str, "direction of the scan"]
    from_mm: Annotated[float, "first amplitude [mm]"]
    to_mm: Annotated[float, "last amplitude [mm]"]
    seen: Annotated[str, "what is seen"]
    m: int
    impacts: Annotated[int | None, "impacts in a period; none for a motion without a period"]


def in_words(m: int, impacts: int) -> str:
    """Describe a settled motion in words for an audience."""
    if not impacts:
        return "the ball does not reach the plate"
    count = "one impact" if impacts == 1 else f"{impacts} impacts"
    return f"{count} in {'each shake' if m == 1 else f'{m} shakes'}" if m else "irregular impacts"


def seen_in(way: str, diagram: Diagram, grazing: float) -> Iterator[Seen]:
    """The rows of a scan: neighbouring amplitudes with the same motion are one; `grazing` is in mm."""
    motions = zip(diagram.excess.tolist(), diagram.m.tolist(), diagram.impacts.tolist(), strict=True)
    known = [motion for motion, kind in zip(motions, diagram.kind, strict=True) if kind != "failed"]
    for words, group in groupby(known, key=lambda motion: in_words(*motion[1:])):
        first, *others = group
        first_mm, last_mm = (grazing * (1.0 + one[0]) for one in (first, [first, *others][-1]))
        yield Seen(way, first_mm, last_mm, words, first[1], first[2] if first[1] else None)


def lowered(strobed: StroboscopicMap, state: State, begins: float, cycles: int) -> float:
    """Lower the amplitude slowly from the excess `begins`; returns about the last excess with impacts.

    Steps grow with the way gone, and the one in which impacts end is halved `HALVINGS` times.  The least that
    is returned is `LOWEST`.
    """
    excess, step, halved = begins, FIRST_STEP, 0
    while halved <= HALVINGS:
        lower = excess - step
        if lower < LOWEST:
            return LOWEST
        after = settle(strobed.at(lower), state, most_cycles=cycles)
        if after.impacts:
            excess, state = lower, after.end
            step = max(step, GROWTH * (begins - excess)) if halved == 0 else step
        if halved or not after.impacts:
            step, halved = 0.5 * step, halved + 1
    return excess


@study(needs=NEEDS, quick={"frames": 20}, at=conditions)
def lecture(
    scene: Scene,
    run: Run,
    *,
    excess: Annotated[
        float, "amplitude of the film over the grazing amplitude, minus 1", Within(-1, 1e6, open=True)
    ] = letter.TIME_TRACE_EXCESS,
    frequency: Annotated[float | None, "drive frequency (Hz); by default one of the scene", HERTZ] = None,
    frames: Annotated[int, "frames of the film", Within(1, MOST_FRAMES)] = 120,
    no_film: Annotated[bool, "draw the slides alone"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    (hz,), _ = conditions(harmonic(scene), {"frequency": frequency, "excess": excess})
    model = model_of(scene)
    require_drive_below(scene, model, hz)
    strobed = StroboscopicMap(oscillator=beam_at(scene, hz, model))
    cycles, grazing = max(scene.scan.settle_cycles, 1), 1e3 * strobed.oscillator.grazing_amplitude()
    places = max(COARSE, -math.floor(math.log10(SHARE * grazing)))
    begins = math.ceil(grazing * 10.0**places) / 10.0**places
    at_excess = {"begins": begins / grazing - 1.0, "filmed": excess}
    orbits = {name: onset_orbit(strobed, e, most_cycles=cycles) for name, e in at_excess.items()}
    lowest = lowered(strobed, orbits["begins"].end, at_excess["begins"], cycles)
    reach = max(scene.scan.narrowest, abs(lowest if lowest > LOWEST else BELOW))
    points = min(scene.scan.points, 21) if run.quick else scene.scan.points
    farthest = 1.05 * max(reach, *at_excess.values())
    near = np.linspace(-1.4 * reach, reach, points)
    far = np.linspace(reach, farthest, points // 4) if farthest > 1.5 * reach else ()
    values = np.unique([*near, *far, *at_excess.values()])
    scans = up_and_down(strobed, values, observe=strobed.tip, settle_cycles=cycles, record_cycles=STROBES)
    for failure in (one for diagram in scans.values() for one in diagram.failures):
        run.failed("scan", failure)
    hits = scans["down"].excess[scans["down"].impacts > 0]
    last = grazing * (1.0 + (hits.min(initial=at_excess["begins"]) if lowest > LOWEST else math.nan))
    ends = last if math.isnan(last) else math.ceil(last * 10.0**places - 1.0) / 10.0**places
    seen = {name: in_words(one.m, one.impacts) + f" (p{one.m})" * (one.m > 1) for name, one in orbits.items()}
    mm = {"grazing": grazing, "begins": begins, "last": last, "ends": ends, "gap": 1e3 * scene.stop.gap_m}
    mm["filmed"] = grazing * (1.0 + excess)
    wait = max(orbit.cycles for orbit in orbits.values()) / hz
    said = sentences(scene, model.free_period, hz, wait, places, mm, seen)
    for sentence in said:
        run.say(sentence)
    run.text("lecture.txt", "\n".join(said) + "\n", "What to set on the bench, and what is seen.")
    rows = [row for way, diagram in scans.items() for row in seen_in(way, diagram, grazing)]
    run.table("seen", rows, "What is seen at which amplitude of the base.", of=Seen)
    below, above = strobed.at(BELOW), strobed.at(at_excess["begins"])
    titles = (
        f"{(1.0 + BELOW) * grazing:.{places + 1}f} mm at the clamp: no impact",
        f"{begins:.{places}f} mm: ▼ {seen['begins']}",
    )
    starts = (below.oscillator, below.steady()), (above.oscillator, orbits["begins"].end)
    traces = {title: trace_of(*start, SHAKES) for title, start in zip(titles, starts, strict=True)}
    draw(run, mm, places, traces, scans)
    if not no_film:
        filmed, oscillator = orbits["filmed"], strobed.at(excess).oscillator
        trace = trace_of(oscillator, filmed.end, filmed.m or filming.APERIODIC)
        words = f"at {hz:g} Hz, amplitude {mm['filmed']:.{places}f} mm: {seen['filmed']}"
        filming.film(scene, run, oscillator, filmed, trace, words, frames=frames, enlarged=1.0)
    run.finding(f"Where the ball begins to hit the plate, {repeats(orbits['begins'].m)}.")
    return {"rows": rows, "frequency_hz": hz, "amplitudes_mm": mm, "seen": seen, "sentences": said}


def sentences(
    scene: Scene,
    period: float,
    hz: float,
    wait: float,
    places: int,
    mm: Mapping[str, float],
    seen: Mapping[str, str],
) -> list[str]:
    """What to set on the bench, and what is seen."""
    free = f" with {1e3 * scene.spring.leg_length_m:.4g} mm free" if scene.spring.kind == "cantilever" else ""
    begins, apart = mm["begins"], mm["grazing"] - mm["last"]
    size = 1e-3 * begins * (2.0 * math.pi * hz) ** 2 / g
    ends = f"Lower it slowly to {mm['ends']:.{places}f} mm: the impacts end."
    exact = f"More exactly, impacts begin at {mm['grazing']:.{places + 2}f} mm"
    exact += f", and end below {mm['last']:.{places + 2}f} mm" if math.isfinite(apart) else ""
    small = f"This hysteresis of {apart:.2g} mm is too small for steps of {10.0**-places:g} mm."
    return [
        f"Clamp the {spring_in_words(scene)}{free}. Plucked, it vibrates at {1.0 / period:.2f} Hz.",
        f"Fix the plate to the clamp, {mm['gap']:.2f} mm from the ball at rest. The shaker moves both.",
        f"Shake the clamp at {hz:g} Hz. Wait about {wait:.0f} s at each amplitude.",
        f"Raise the amplitude slowly to {begins:.{places}f} mm: the ball begins to hit the plate, "
        f"with {seen['begins']}.",
        f"This is {2.0 * begins:.{places}f} mm from peak to peak, with a peak acceleration of {size:.3g} g.",
        ends
        if math.isfinite(apart)
        else f"Lower it slowly to {-100.0 * LOWEST:.0f} % less: the impacts go on.",
        f"{exact}.",
        *([small] if apart < 10.0**-places else []),
        f"At {mm['filmed']:.{places}f} mm, as in the film, the audience sees: {seen['filmed']}.",
    ]


def draw(
    run: Run, mm: Mapping[str, float], places: int, traces: Mapping[str, Trace], scans: Mapping[str, Diagram]
) -> None:
    """The two slides: the motions below and above grazing by their titles, and the scans."""
    from studies.shell import plotting  # matplotlib is slow to import

    with style_of("slide"), plotting.house_style():
        figure, axes = plotting.new_figure(2, 2, width_ratios=[1.0, 1.6], sharex="col", sharey="col")
        axes[1, 0].remove()
        axes[0, 0].set_subplotspec(axes[0, 0].get_gridspec()[:, 0])
        draw_bench(axes[0, 0], f"gap {mm['gap']:.2f} mm")
        for axis, (title, trace), number in zip(axes[:, 1], traces.items(), (1, 2), strict=True):
            axis.plot(1e3 * trace.time, 1e3 * trace.tip, color=plotting.PALETTE[number])
            axis.axhline(mm["gap"], **plotting.GUIDE)
            axis.text(1.01, mm["gap"], "plate", transform=axis.get_yaxis_transform(), va="center")
            hits = 1e3 * trace.impact_times
            axis.plot(hits, np.full(hits.shape, 1.2 * mm["gap"]), "kv", in_layout=False)
            axis.margins(x=0.0)
            axis.set_title(title, loc="left")
            plotting.label(axis.yaxis, "ball", "mm")
        plotting.label(axis.xaxis, "time", "ms")
        figure.suptitle("Grazing: the ball just reaches the plate, with no speed", fontweight="bold")
        run.figure("slide_1", figure, "The bench, and the ball just below and just above grazing.")
        figure, axis = plotting.new_figure()
        for way, name, look in (("up", "raised", plotting.UP), ("down", "lowered", plotting.DOWN)):
            found, named = scans[way], {"label": f"amplitude {name}", "pale": "pale: irregular"}
            amplitude = mm["grazing"] * (1.0 + found.excess)
            plots.strobes(axis, amplitude, 1e3 * found.points, found.m > 0, **named, **look)
        for name, key in (("impacts begin", "grazing"), ("impacts end", "last")):
            if math.isfinite(mm[key]):
                axis.axvline(mm[key], **{**plotting.GUIDE, "color": "black"})
                side = "left" if (key == "grazing") == (mm["grazing"] >= mm["last"]) else "right"
                words, up = f" {name} \n {mm[key]:.{places + 2}f} mm ", axis.get_xaxis_transform()
                axis.text(mm[key], 1.0, words, transform=up, ha=side, va="bottom")
        plotting.label(axis.xaxis, "amplitude of the clamp", "mm")
        plotting.label(axis.yaxis, "ball, once in each shake", "mm")
        figure.suptitle("Once begun, the impacts go on below grazing", fontweight="bold")
        plotting.legend_below(figure, [axis], 3)
        run.figure("slide_2", figure, "The ball once in each shake, the amplitude raised and lowered.")


def draw_bench(axes: Axes, gap: str) -> None:
    """Clamp, spring, ball and plate from the side, not to scale."""
    axes.set(xlim=(-1.5, 10.5), ylim=(-6.5, 7.5))
    axes.axis("off")
    axes.fill([-1, 0.5, 0.5, -1], [-1.6, -1.6, 1.6, 1.6], color="0.3")
    axes.plot([0.5, 9], [0.0, 0.0], color="0.45", linewidth=3)
    axes.plot([8.5], [0.75], "o", markersize=11)
    axes.plot([-0.25, -0.25, 7], [1.6, 5.5, 5.5], color="0.3", linewidth=4)
    axes.fill([6.5, 10.5, 10.5, 6.5], [5, 5, 6, 6], color="0.6")
    for x, low, high in ((8.5, 1.6, 5.0), (-0.25, -5.5, -2.0)):
        axes.annotate("", (x, high), (x, low), arrowprops={"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0})
    names = ((8.1, 3.2, gap), (9.8, 6.6, "plate"), (9.4, -1.6, "ball"), (5.5, -1.6, "spring"))
    for x, y, words in (*names, (7.5, -4.0, "clamp, shaken")):
        axes.text(x, y, words, ha="right", va="center")
