"""Fig. 3 of the letter: hysteresis of the p_m orbits against frequency.

Claim (letter 1996): "All experimental resonances are found in place, but the measured hysteresis differs from
the prediction", which the letter puts down to higher modes; and: "The energy loss and time delay at impact
are two parameters to effectively represent higher-order modes in a single-mode description." The transitions
occur in "bands in the (alpha, gamma) parameter plane ... crossed approximately transversely. At the upper
boundary ... there is no hysteresis", which grows "towards ... the lower-lying m - 1".

Computed for m = 3 ... 10 from 19.6 to 23.8 Hz: F_m/F_g - 1, where the p_m orbit ends in a downward scan, in
the nine descriptions of studies.experiment.hysteresis.model. Neighbours in their chain differ in one thing,
so that the beam's hysteresis over the map's is a product of causes:

    F_beam/F_map = truncation of the map * size of the kick * its change with velocity * delay
                   * higher modes in the flight * ringing met by the next collision

Medians are taken over the folds that lie more than the letter's amplitude stability, 2.5e-4, below grazing.
The bands belong to the map.

Run:     python -m studies hysteresis [--step HZ] [--inside N]
Writes:  hysteresis.csv (a row a frequency and period), causes.csv (factors at the letter's frequencies and
         over all folds), accuracy.csv (how far each description is off), branch.csv (a row an orbit),
         bands.csv (a row a frequency of each band), and the figures hysteresis (as Fig. 3), branch and bands
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from contact import maximal_m
from studies import letter
from studies.experiment.hysteresis.model import (
    CAUSES,
    DESCRIPTIONS,
    Folds,
    Inside,
    OnBranch,
    branch_of,
    column,
    inside_band,
    path_of,
)
from studies.physics.descriptions import falls, or_none
from studies.physics.least_model import at_letters_drives
from studies.shell.digits import written
from studies.shell.options import Within
from studies.shell.run import Verdict
from studies.shell.scene import (
    Scene,
    corresponding,
    harmonic,
    model_of,
    nordmark_at,
    periods_of,
    require_drive_below,
)
from studies.shell.study import Run, study

PERIODS, BANDS = range(3, 11), range(3, 12)
"""Periods whose folds are followed, and whose bands are looked through."""

NEARLY = 1.1  # a factor up to this counts as none, and a description that is off by no more as enough


@dataclass(frozen=True, kw_only=True)
class Causes:
    """What each cause multiplies the hysteresis by; the product is the beam's hysteresis over the map's."""

    at: Annotated[str, "place, or median over all"]
    truncation_of_the_map: float | None
    size_of_the_kick: float | None
    kick_against_velocity: float | None
    delay: float | None
    higher_modes_in_the_flight: float | None
    ringing_met_by_the_next_collision: float | None


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """By what factor a description is off the beam, up or down."""

    description: str
    folds: Annotated[int, "number of orbits"]
    median: Annotated[float, "factor, median"]
    worst: Annotated[float, "factor, largest"]

    def __str__(self) -> str:
        return f"{self.median:.2f} (median; worst {self.worst:.1f})"


@study(needs={"fold": 0.05}, quick={"step": 0.3, "inside": 26}, at=at_letters_drives)
def hysteresis(
    scene: Scene,
    run: Run,
    *,
    step: Annotated[float, "of the drive frequency (Hz)", Within(1e-4, 4.2, "Hz")] = 0.05,
    inside: Annotated[int, "frequencies inside each band"] = 101,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    model, seen = model_of(harmonic(scene)), periods_of(scene)
    require_drive_below(scene, model)
    columns = run.map(partial(column, scene, model, step), PERIODS, "periods")
    rows = [row for found in columns for row in found]
    run.table(
        "hysteresis",
        rows,
        "End of the orbits p_m when the amplitude is lowered, F_m/F_g − 1, in nine descriptions.",
        of=Folds,
        show=("frequency_hz", "m", *DESCRIPTIONS) if run.quick else (),
    )
    at_letter = [row for row in rows if seen.get(row.frequency_hz) == row.m]
    kept = resolved(rows)
    causes = [causes_over([row], f"{row.frequency_hz:.2f} Hz, p{row.m}") for row in at_letter]
    causes.append(causes_over(kept, f"median of {len(kept)} folds"))
    run.table("causes", causes, "Factor of each cause, from the map to the beam.", of=Causes)
    off = [accuracy(name, kept) for name in DESCRIPTIONS if name != "beam"]
    run.table("accuracy", off, "Hysteresis of a description against the beam's, as a factor.", of=Accuracy)
    from studies.experiment.hysteresis import figure  # matplotlib is slow to import

    run.figure("hysteresis", figure.draw_curves(scene, rows, letters=run.letters), figure.CURVES)
    frequency = corresponding(scene, letter.TIME_TRACE_HZ)
    m = maximal_m(nordmark_at(scene, frequency))
    if branch := or_none(branch_of, scene, frequency, m, model) or []:
        run.figure("branch", figure.draw_branch(branch, frequency, m), figure.BRANCH)
    run.table("branch", branch, "The orbits of one branch of the beam.", of=OnBranch, show=())
    judge(run, rows, {found.description: found for found in off}, causes[-1], higher=model.n_modes > 1)
    within = [row for found in run.map(partial(inside_band, scene, inside), BANDS, "bands") for row in found]
    run.table("bands", within, "Hysteresis 1 − F_m/F_g across the bands of p_m.", of=Inside, show=())
    run.figure("bands", figure.draw_bands(scene, path_of(scene), letters=run.letters), figure.BANDS)
    return {
        "rows": rows,
        "causes": causes,
        "accuracy": off,
        "bands": judge_bands(run, scene, within),
        "modes": model.n_modes,
    }


def resolved(rows: Sequence[Folds]) -> list[Folds]:
    """The rows that enter the statistics: the beam's hysteresis above the amplitude stability, and a fold in
    the map."""
    return [row for row in rows if (row.beam or 0.0) < -letter.AMPLITUDE_STABILITY and row.map is not None]


def causes_over(rows: Sequence[Folds], at: str) -> Causes:
    """Median factor of each cause."""
    logs = {name: [math.log(f) for row in rows if (f := row.factor(name)) is not None] for name in CAUSES}
    return Causes(at=at, **{n: math.exp(float(np.median(of))) if of else None for n, of in logs.items()})


def accuracy(description: str, rows: Sequence[Folds]) -> Accuracy:
    """How far a description is off the beam; nothing where it has no fold."""
    ratios = (row.ratio(description) for row in rows)
    logs = [abs(math.log(ratio)) for ratio in ratios if ratio is not None]
    return Accuracy(
        description=description,
        folds=len(logs),
        median=math.exp(float(np.median(logs))) if logs else math.nan,
        worst=math.exp(max(logs)) if logs else math.nan,
    )


def judge(
    run: Run, rows: Sequence[Folds], off: Mapping[str, Accuracy], median: Causes, *, higher: bool = True
) -> None:
    """The findings, and the verdicts on Fig. 3 and, if there are `higher` modes, on the two parameters."""
    factors = {name: value for name in CAUSES if (value := getattr(median, name)) is not None}
    if "truncation_of_the_map" not in factors:
        run.say("no p_m has a fold in the map, Eq. (1) and the beam: there is nothing to compare")
        return
    own, two = factors["truncation_of_the_map"], off["two_parameters"]
    size, most = written(off["map"].median, 3), max(factors, key=lambda name: abs(math.log(factors[name])))
    run.finding(f"The map's hysteresis differs from the beam's by a factor of {size} in the median.")
    if abs(math.log(factors[most])) > math.log(NEARLY):
        words = f"Its causes partly cancel; the largest, {most.replace('_', ' ')}, multiplies"
        run.finding(f"{words} the hysteresis by {written(factors[most], 3)}.")
    if higher:
        words = "Restitution and time delay instead of the higher modes give the beam's hysteresis"
        run.finding(f"{words} to a factor of {written(two.median, 3)} in the median.")
    run.verdict(
        "hysteresis",
        "in part" if max(own, 1.0 / own) > NEARLY else "agrees",
        found=f"map off by {off['map'].median:.2f}, Eq. (1) by {off['single_mode'].median:.2f}",
        note=f"the letter prints curves, no values; a factor of {own:.2f} (median) is the map's own "
        "truncation, with no higher mode in it",
    )
    present = {(row.m, row.frequency_hz) for row in rows if row.beam_admissible and (row.beam or 0.0) < 0.0}
    beside = [f"p{m} at {f:.2f} Hz" for m, f in sorted(present) if (m - 1, f) in present]
    if beside or not run.quick:  # few frequencies can miss them all
        run.verdict(
            "neighbour_band",
            "agrees" if beside else "differs",
            found=f"{len(beside)} orbits beside one of a period shorter by one",
            note=", ".join(beside),
        )
    if not higher:
        return
    verdict: Verdict = "in part" if two.median <= 2.0 * NEARLY else "differs"
    run.verdict(
        "two_parameters",
        "agrees" if two.worst <= NEARLY else verdict,
        found=f"off by {two}; kick of all modes {off['all_mode_kick'].median:.4f}",
        note="what is missing is the ringing of the higher modes that the next collision meets",
    )


def judge_bands(run: Run, scene: Scene, rows: Sequence[Inside]) -> Mapping[str, object]:
    """The verdict on the bands: no hysteresis at their upper edges, and growth towards the lower."""
    of_band = [[row for row in rows if row.m == m] for m in BANDS]
    grows = all(falls([row.map for row in own]) and falls([row.eq1 for row in own]) for own in of_band)
    zero = max(max(own[-1].map, own[-1].eq1) for own in of_band)
    path = path_of(scene)
    crossed = sorted({maximal_m(place) for place in path})
    run.verdict(
        "bands",
        "agrees" if zero < 1e-9 and grows else "differs",
        found=f"m = {crossed[0]} to {crossed[-1]} in the range of Figs. 3 and 5; hysteresis at the upper "
        f"edges at most {written(zero, 1)}, growing towards the lower: {'yes' if grows else 'no'}",
        note=f"α from {written(path[0].alpha, 2)} to {path[-1].alpha:.2f}, γ from {path[0].gamma:.3f} to "
        f"{path[-1].gamma:.3f}: the bands are crossed at almost constant γ",
        figure="bands",
    )
    return {"largest_at_upper_edge": zero, "crossed": crossed}
