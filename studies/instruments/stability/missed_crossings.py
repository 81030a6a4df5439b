"""Crossings that a method does not see: detection by change of sign against certified search.

A method that learns of a touch only where it looks, at its steps or samples, misses a tip that goes beyond
the stop and comes back between two looks.  ``planted_crossings`` lets modes swing to a peak of known
overshoot delta gap, at every phase of the looks; counted are the crossings missed, decade by decade of
delta, and, with the peak below the gap, the touches invented.  Theory, for looks h apart and a deceleration a
of the tip at its peak: missed with probability max(0, 1 - 2 sqrt(2 delta gap/a)/h), one half at
a h^2/(32 gap).  Methods that act by percussions have a rule of their own, and so another formula.

The formula knows of the looks alone.  A method whose motion is not exact puts the peak a little too high or
too low as well, by about (h omega)^2 for a fixed step and by its tolerance with an error control, and then
misses or invents crossings below that whatever it looks at.

Tried on the lowest mode of the scene and on its first six, with a fifth of the peak in modes 2 to 6: the fast
modes make the crossing short.  Fixed steps are a hundredth of the period for one mode and 0.5/omega_max for
six; solvers with an error control have the same tolerance; the spacing of their looks is measured.
Samples of exact flights look at the turning points that the velocities betray as well: they miss a crossing
only where the tip turns twice between two samples, so the formula is not theirs.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

from studies.instruments.figures import NOTE, PAGE, in_house_style, label, new_figure, panel, series
from studies.instruments.record import Record
from studies.instruments.scene import Scene
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.crossing_trials import MODES, TOLERANCE, Trial, swings, trials
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.planted_crossings import Swing

__all__ = ["draw", "measure"]

OVERSHOOTS = 10.0 ** -np.arange(1, 13)
FINE = np.geomspace(1e-12, 1e-1, 276)
"""Where the formula is drawn, 25 points a decade."""

PHASES = {"one": 64, "many": 32}
"""Runs for each overshoot.  A share is good to 0.5/sqrt(runs) for a solver whose steps do not keep to a grid,
and the overshoot at which it is one half to a factor exp(2/sqrt(runs)): 1.3 and 1.4."""

PHASES_QUICK = 8

KNOB = "overshoot / gap [1]"
BELOW = "undershoot / gap [1]"
WORDS = {"one": "one mode", "many": f"{MODES} modes"}

SLOW = "scipy Radau"
"""Takes 0.4 s for a run of six modes, and gets a quarter of the runs."""


def _try(trial: Trial, swing: Swing, case: str, runs: int) -> tuple[list[Limit], dict[str, Any]]:
    """Rows and numbers of one method on one motion."""
    runs = runs // 4 if trial.label == SLOW and case == "many" else runs
    few = max(4, runs // 4)
    below = few if trial.panel in ("control", "") else runs
    samples = trial.spacings.size > 0
    slack = 2.0 * float(trial.spacings.max()) if samples else 1e-6 / swing.pace

    def share(overshoot: float, count: int) -> float:
        verdict = swing.verdict(trial.method, overshoot, runs=count, slack=slack)
        failed.append(verdict.failed)
        return verdict.share

    failed: list[int] = []
    missed: list[float] = []
    for overshoot in OVERSHOOTS:
        # once nothing is seen any more, fewer runs go on showing it
        settled = missed[-2:] == [1.0, 1.0]
        missed.append(share(overshoot, few if settled else runs))
    invented = [share(-overshoot, below) for overshoot in OVERSHOOTS]

    half = _first(np.array(missed) > 0.5, lambda overshoot: share(overshoot, runs) > 0.5)
    wrong = _first(np.array(invented) > 0.0, lambda undershoot: share(-undershoot, below) > 0.0)
    note = f"{runs} phases; at most {100 * np.nanmax(missed):.0f} % missed down to {OVERSHOOTS[-1]:.0e}"
    if samples:
        note += f"; looks {trial.spacings.mean():.3g} s apart"
    if missed[0] > 0.5:
        note += "; already at the largest overshoot tried"
    if sum(failed):
        note += f"; {sum(failed)} runs ended in an error"
    exact = trial.panel == "exact"
    limits = [
        Limit(
            method=trial.label, case=f"half of the crossings missed, {WORDS[case]}", knob=KNOB,
            theory=trial.half(swing.pace), measured=half, refused=None if exact else False, note=note,
        )
    ]  # fmt: skip
    if exact or wrong is not None or trial.invented(swing.pace) is not None:
        limits.append(
            Limit(
                method=trial.label, case=f"touches invented, {WORDS[case]}", knob=BELOW,
                theory=trial.invented(swing.pace), measured=wrong, refused=None if exact else False,
                note=f"{below} phases; at most {100 * np.nanmax(invented):.0f} % touch, "
                f"tried from {OVERSHOOTS[0]:g} down to {OVERSHOOTS[-1]:.0e}",
            )
        )  # fmt: skip
    return limits, {"share": missed, "invented": invented, "theory": trial.share(FINE, swing.pace)}


def _first(fails: np.ndarray, at: Callable[[float], bool]) -> float | None:
    """The overshoot below which it fails, by bisection from the decades; None if it never does.

    The largest overshoot tried if it fails there already.
    """
    found = np.flatnonzero(fails)
    if not found.size or found[0] == 0:
        return float(OVERSHOOTS[0]) if found.size else None
    return bisect(at, float(OVERSHOOTS[found[0] - 1]), float(OVERSHOOTS[found[0]]), relative=0.05)


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Crossings missed and touches invented by every method, on one mode and on six."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"overshoot": OVERSHOOTS, "fine": FINE}
    for case, swing in swings(scene).items():
        tried = trials(swing, quick=quick)
        numbers = []
        for trial in tried:
            rows, found = _try(trial, swing, case, PHASES_QUICK if quick else PHASES[case])
            limits += rows
            numbers.append(found)
        arrays |= {
            f"label_{case}": np.array([trial.label for trial in tried]),
            f"panel_{case}": np.array([trial.panel for trial in tried]),
            f"spacing_{case}": np.array([t.spacings.mean() if t.spacings.size else np.nan for t in tried]),
            f"percussions_{case}": np.array([trial.percussions for trial in tried]),
            f"theory_{case}": np.array([found["theory"] for found in numbers]),
            f"share_{case}": np.array([found["share"] for found in numbers]),
            f"invented_{case}": np.array([found["invented"] for found in numbers]),
        }
    return Findings(limits=limits, arrays=arrays)


@in_house_style
def draw(findings: Findings, record: Record) -> None:
    """Share missed over overshoot: one mode above, six below; error control left, fixed steps right."""
    arrays = findings.arrays
    figure, axes = new_figure(2, 2, width=PAGE, height=0.160, sharex=True, sharey=True)
    overshoot, fine = arrays["overshoot"], arrays["fine"]
    places = itertools.count()
    for row, case in zip(axes, WORDS, strict=True):
        labels, panels = arrays[f"label_{case}"], arrays[f"panel_{case}"]
        acts = arrays[f"percussions_{case}"]
        theory, share = 100.0 * arrays[f"theory_{case}"], 100.0 * arrays[f"share_{case}"]
        for axis, kind, words in zip(
            row, ("control", "step"), ("error control", "fixed steps and samples"), strict=True
        ):
            chosen = np.flatnonzero(panels == kind)
            families: list[str] = []
            for i in chosen:
                # settings of one method share a colour; the second has filled markers
                family = str(labels[i]).split(",")[0]
                first = family not in families
                families += [family] * first
                number = families.index(family) + (kind == "step")
                style = {**series(number % 8), "linestyle": "none"}
                axis.plot(overshoot, share[i], **style, label=str(labels[i]),
                          markerfacecolor="none" if first else style["color"])
                if kind == "control":
                    axis.plot(fine, theory[i], color=style["color"], linewidth=0.7,
                              gid=f"{labels[i]}, theory")
            if kind == "step":
                for percussions, words_of in ((False, "looks a step apart"), (True, "percussions")):
                    known = [i for i in chosen if np.isfinite(theory[i, 0]) and acts[i] == percussions]
                    if known:
                        axis.plot(fine, theory[known[0]], color="0.4", linewidth=0.7, label=words_of,
                                  linestyle="--" if percussions else "-")
                exact = np.flatnonzero(panels == "exact")
                axis.plot(overshoot, share[exact].max(axis=0), **series(0), label="exact methods")
            panel(axis, next(places), f"{WORDS[case]}, {words}")
            axis.set_xscale("log")
            axis.set_ylim(-4.0, 104.0)
    for axis in axes[:, 0]:
        label(axis.yaxis, "crossings missed", "%")
    common = f"tolerance 10$^{{{np.log10(TOLERANCE):.0f}}}$ if none is given"
    for axis, title in zip(axes[1], (common, None), strict=True):
        label(axis.xaxis, "overshoot / gap")
        axis.legend(loc="upper left", bbox_to_anchor=(0.0, -0.22), ncols=2, title=title,
                    title_fontsize=NOTE, alignment="left")
    record.write_figure(figure, "missed_crossings")
