"""A wall of finite hardness: how it smooths the square root at grazing.

Claim (letter 1996, last page): a wall "such that at impact the spring constant changes by a factor K >> 1"
affects the bifurcations close to grazing in a characteristic manner, to larger amplitudes the smaller K; the
experiment did not show it.

Computed, for Eq. (1) with an elastic wall of K times the spring constant, at each drive frequency and
K = 10 ... 10^6:

    kick       of one collision against the peak h over the wall: J = (4/3) (K - 1) Omega^2 sqrt(2/a) h^(3/2)
               below h = (3/2) a/((K - 1) Omega^2), a = omega^2 gap, and the square root above
    doubling   excess at which p1, which survives its first touch, loses stability by a multiplier -1: by
               shooting, against a closed form that goes like K^(-2); where rounding of the multipliers leaves
               it "undecided", the excess at which p1 is stable, and at which it is unstable

and for the beam with Hertz contact the excess at which the kick leaves the square root, at which p1 loses its
stability, and at which a multiplier passes -1. The study compares the loss of stability with the letter's
amplitude stability. ``docs/theory/collision.md`` derives the equations.

Run:     python -m studies soft_wall [--decades 1 6] [--quick]
Writes:  kicks.csv, doublings.csv; figure kick
"""

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Annotated

import numpy as np

from studies import letter
from studies.experiment.soft_wall.closed_forms import SoftWall
from studies.experiment.soft_wall.model import Beam, Doubling, Kick, beam_of, doubling_of, kicks_of
from studies.shell.digits import written
from studies.shell.options import Within
from studies.shell.scene import Scene, SceneError, harmonic, single_mode_at
from studies.shell.study import Run, study

SHOWN_HZ = letter.TRANSITION_HZ[5]
"""Frequency of the curves and of the beam, or the one of the scene nearest to it."""

QUICK_HZ = (SHOWN_HZ, letter.TRANSITION_HZ[6])
UNSEEN = 1e-9  # a loss of stability below this excess counts as one at grazing, as at a hard wall


@study(needs={"kick": 0.005}, quick={"decades": (3, 5)})
def soft_wall(
    scene: Scene,
    run: Run,
    *,
    decades: Annotated[tuple[int, int], "powers of ten between which K runs", Within(1, 7)] = (1, 6),
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if decades[0] > decades[1]:
        raise SceneError(f"decades is {decades}; the second power must be the first or more")
    frequencies = sorted(set(harmonic(scene).drive.frequencies_hz))
    shown = min(frequencies, key=lambda f: abs(f - SHOWN_HZ))
    if run.quick:
        frequencies = sorted({min(frequencies, key=lambda f: abs(f - g)) for g in QUICK_HZ})
    hardness = [10.0**k for k in range(decades[0], decades[1] + 1)]
    singles = [single_mode_at(scene, f) for f in frequencies]
    walls = [SoftWall(oscillator=one, hardness=K) for one in singles for K in hardness]
    excesses = np.geomspace(1e-8, 3e-2, 14 if run.quick else 27)
    curves = [wall for wall in walls if wall.frequency == shown]
    found = run.attempt(partial(kicks_of, excesses=excesses), curves, "curves of kicks")
    kicks = [row for rows in found for row in rows or ()]
    doublings = [row for row in run.attempt(doubling_of, walls, "period doublings") if row]
    job = partial(beam_of, scene, excesses=np.geomspace(1e-7, 1e-1, 13 if run.quick else 37).tolist())
    (of_beam,) = run.attempt(job, [shown], "beams")
    beam, more = of_beam or (None, [])
    run.table("kicks", [*kicks, *more], "Kick of one collision.", of=Kick, show=())
    run.table("doublings", doublings, "Excess at which p1 doubles its period.", of=Doubling)
    from studies.experiment.soft_wall import figure  # matplotlib is slow to import

    run.figure("kick", figure.draw_kicks([*kicks, *more], run.letters), figure.KICKS)
    judge_wall(run, doublings)
    if beam and beam.square_root_from is not None:
        end = written(beam.square_root_from, 2)
        run.finding(f"A Hertz contact smooths the square root of the beam's kick below an excess of {end}.")
    if beam and scene.contact.law == "hertz":
        judge_beam(run, beam)
    return {"rows": doublings, "beam": beam}


def judge_wall(run: Run, doublings: Sequence[Doubling]) -> None:
    """Whether the doubling moves to larger amplitudes as K decreases, at every frequency."""
    found = [(row.frequency_hz, row.hardness, row.excess) for row in doublings if row.excess is not None]
    if not found:
        return
    falls = all(a[2] > b[2] for a, b in pairwise(found) if a[0] == b[0])
    first = [row for row in found if row[0] == found[0][0]]
    ends = ", ".join(f"{written(row[2], 2)} at K = {row[1]:g}" for row in (first[0], first[-1]))
    run.verdict(
        "soft_wall",
        "agrees" if falls else "differs",
        found=f"Eq. (1): doubling at {ends}",
        note=f"excess of the period doubling at {first[0][0]:.2f} Hz",
    )
    softer = "The softer the wall, the larger the amplitude at which p1 doubles its period: up to"
    alone, most = "At a soft wall p1 doubles its period at up to", written(max(row[2] for row in found), 2)
    run.finding(f"{softer if len(first) > 1 and falls else alone} an excess of {most}.")


def judge_beam(run: Run, beam: Beam) -> None:
    """Whether the letter could have seen what the beam does at its first touches."""
    end, lost, stable = beam.doubling_excess, beam.unstable_excess, letter.AMPLITUDE_STABILITY
    if end is None or lost is None:
        return
    below, loss = "within what the letter could resolve", f"p1 doubles its period at {written(end, 2)}"
    if lost < stable:
        below = f"{stable / lost:.0f} times below the letter's amplitude stability, which hides it"
    if beam.turns:
        loss = f"p1 loses its stability at {written(lost, 2)} by a complex pair of multipliers; a multiplier "
        loss += f"passes −1 at {written(end, 2)}, where p1 is unstable already"
    run.verdict(
        "smoothing",
        "differs" if lost >= stable else "in part" if lost > UNSEEN else "agrees",
        found=f"beam: {loss}",
        note=f"the square root is smoothed; the loss is {below}",
    )
    hidden = ", too close to grazing for the letter to see" if run.letters and lost < stable else ""
    run.finding(f"The contact keeps p1 of the beam stable up to an excess of {written(lost, 2)}{hidden}.")
