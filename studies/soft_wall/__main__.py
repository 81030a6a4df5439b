"""A wall of finite hardness: how the square root is smoothed, and what orbit that adds at grazing.

Claim (letter 1996, last page): a wall "such that at impact the spring constant changes by a factor K >> 1"
affects the bifurcations close to grazing in a characteristic manner, to larger amplitudes the smaller K; the
experiment did not show it.

Computed, for Eq. (1) with a wall of K times the spring constant, without loss and with the dashpot that gives
a hard approach the letter's restitution, at each drive frequency and K = 10 ... 10^6:

    kick       of one collision against the peak h over the wall: J = (4/3) (K - 1) Omega^2 sqrt(2/a) h^(3/2)
               below h = (3/2) a/((K - 1) Omega^2), a = omega^2 gap, and the square root above; with a dashpot
               J = c h below
    doubling   excess at which p1, which survives its first touch, loses stability by a multiplier -1: by
               shooting, against  h_f [1 + (2/3)(1 + gamma + alpha)/(1 - alpha + gamma)],
               h_f = (omega^2/2) [(1 + gamma + alpha)/(2 M12 K Omega^2)]^2 (gap 1) for K -> infinity, and
               against a closed form for finite K; settled motions on both sides
    end        excess at which p_m ends, m as at that frequency in the map: fold by shooting, a downward scan,
               and the hard wall (closed form), from which it lies at a distance K^(-1/2)

and for the beam with Hertz contact the excess at which the kick leaves the square root, the orbit born below
it and whether the letter could have seen it. The equations are derived in `closed_forms` and `beam`.

Run:     python -m studies.soft_wall [--decades 1 6] [--quick]     half a minute; --quick ten seconds
Writes:  kicks.csv, doublings.csv, ends.csv, limits.csv (a row a frequency), beam_kicks.csv,
         beam_born.csv; kick, doubling and beam (png, pdf)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Annotated, Any

import numpy as np

from contact import ContactError
from studies import letter
from studies.run import Run, study
from studies.scene import Scene, SceneError, harmonic, single_mode_at
from studies.soft_wall.beam import Beam, beam_of
from studies.soft_wall.closed_forms import SoftWall, damping_ratio
from studies.soft_wall.limits import attempt, limits_at
from studies.soft_wall.measured import Case, Doubling, doubling_of, end_of, kicks_of

__all__ = ["soft_wall"]

SHOWN_HZ = 22.2
"""Frequency of the curves and of the beam, or the one of the scene nearest to it."""

QUICK_HZ = (22.2, 22.6)
UNSEEN = 1e-9
"""An excess of a period doubling below this is that of a hard wall."""


@study(needs={"kick": 0.005}, quick={"decades": (3, 5), "points": 13})
def soft_wall(
    scene: Scene,
    run: Run,
    *,
    decades: Annotated[tuple[int, int], "powers of ten between which K runs"] = (1, 6),
    points: Annotated[int, "excesses of a curve of the beam"] = 37,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if not decades[0] <= decades[1] <= 7:
        raise SceneError(f"decades is {decades}; K runs upwards, to 10^7 at most")
    zeta = damping_ratio(scene.single_mode.restitution)
    frequencies = sorted(set(harmonic(scene).drive.frequencies_hz))
    shown = min(frequencies, key=lambda f: abs(f - SHOWN_HZ))
    if run.quick:
        frequencies = sorted({min(frequencies, key=lambda f: abs(f - g)) for g in QUICK_HZ})
    cases = [
        Case(scene=scene, frequency_hz=f, hardness=10.0**k, zeta=z)
        for f in frequencies for z in sorted({0.0, zeta}) for k in range(decades[0], decades[1] + 1)
    ]  # fmt: skip
    curves = [case for case in cases if case.frequency_hz == shown]
    excesses = np.geomspace(1e-8, 3e-2, 14 if run.quick else 27)
    beam = computed(run, partial(beam_of, scene, points=points), [shown], "beam")
    kicks = computed(run, partial(kicks_of, excesses=excesses), curves, "kicks")
    doublings = computed(run, doubling_of, cases, "period doublings")
    ends = computed(run, partial(end_of, scan=not run.quick), cases, "ends")
    limits = run.map(partial(limits_at, scene, zeta), frequencies, "limits")
    points_of_kick = [row for rows in kicks for row in rows]
    run.table("kicks", points_of_kick, "Kick velocity of one collision [m/s].", show=())
    run.table("doublings", doublings, "Excess F/F_g - 1 at which p1 doubles its period (0: at once).")
    run.table("ends", ends, "Excess F/F_g - 1 at the fold of p_m.")
    run.table("limits", limits, "What the closed forms say.")
    from studies.soft_wall import figures

    run.figure("kick", figures.draw_kicks(points_of_kick), "Eq. (1), kick of one collision against the "
               "excess for each hardness: points, closed form and, dashed, the power law below. All go over "
               "into the power 1/2 of the hard wall.")  # fmt: skip
    if doublings:
        run.figure("doubling", figures.draw_doublings(doublings, ends, theory_of(scene, frequencies)),
                   "(a) Excess of the period doubling of p1 without dashpot; closed form (line) and K → ∞ "
                   "(dashed). (b) How far both are off (open: closed form); at K = 10^6 that is rounding. "
                   "(c) Distance of the end of p_m from the hard wall's; it falls as K^(-1/2).")  # fmt: skip
    judge_wall(run, doublings)
    if beam:
        ((found, collisions, born),) = beam
        run.table("beam_kicks", collisions, "First collisions of the beam.", show=())
        run.table("beam_born", born, "Period on which the beam settles.")
        run.figure("beam", figures.draw_beam(found, collisions, born), "The beam near grazing: kick of one "
                   "collision, its local power in the excess, and the period that is born, raised gently and "
                   "in one step. Shaded: the range in which the letter's drive was not stable.")  # fmt: skip
        judge_beam(run, found)
    return {
        "damping_ratio": zeta, "limits": limits, "doublings": doublings, "ends": ends,
        "beam": beam[0][0] if beam else None, "resolution": letter.AMPLITUDE_STABILITY,
        "equivalent_hardness": equivalent(scene, beam[0][0]) if beam else None,
    }  # fmt: skip


def computed(run: Run, job: Callable[[Any], Any], arguments: Sequence[Any], label: str) -> list[Any]:
    """What the job gives for each argument; one that fails is told and left out."""
    found = []
    for argument, result in zip(arguments, run.map(partial(attempt, job), arguments, label), strict=True):
        if isinstance(result, ContactError | ValueError):
            run.failed(f"{label}, {argument}", result)
        else:
            found.append(result)
    return found


def theory_of(scene: Scene, frequencies: Sequence[float]) -> dict[float, np.ndarray]:
    """Frequency -> K, closed form and limit of the excess at the doubling, shape (3, 121)."""
    found = {}
    for frequency in frequencies:
        columns = []
        for hardness in np.geomspace(10.0, 1e6, 121):
            wall = SoftWall(oscillator=single_mode_at(scene, frequency), hardness=float(hardness))
            peak = wall.doubling_peak()
            closed = math.nan if peak is None else wall.excess_of(peak)
            columns.append((hardness, closed, wall.leading_doubling()[1]))
        found[frequency] = np.array(columns).T
    return found


def equivalent(scene: Scene, beam: Beam) -> float | None:
    """K of a wall without dashpot that has half of its kick at the same excess as the beam."""
    if beam.half_excess is None:
        return None
    wall = SoftWall(oscillator=single_mode_at(scene, beam.frequency_hz), hardness=2.0)
    return 1.0 + wall.half_peak / beam.half_excess


def judge_wall(run: Run, doublings: Sequence[Doubling]) -> None:
    """Whether the doubling moves to larger amplitudes as K decreases, at every frequency."""
    by_frequency: dict[float, list[Doubling]] = {}
    for row in doublings:
        if row.case == "lossless" and row.excess:
            by_frequency.setdefault(row.frequency_hz, []).append(row)
    if not by_frequency:
        return
    falls = all(
        a.excess > b.excess for rows in by_frequency.values() for a, b in pairwise(rows)  # type: ignore[operator]
    )  # fmt: skip
    first = by_frequency[min(by_frequency)]
    run.verdict("soft_wall", "agrees" if falls else "differs",
                found=f"Eq. (1): doubling at {first[0].excess:.2g} at K = {first[0].hardness:g}, "
                      f"{first[-1].excess:.2g} at K = {first[-1].hardness:g}",
                note=f"excess of the period doubling at {first[0].frequency_hz:.2f} Hz")  # fmt: skip


def judge_beam(run: Run, beam: Beam) -> None:
    """Whether the letter could have seen the doubling of the beam."""
    end, stable = beam.doubling_excess, letter.AMPLITUDE_STABILITY
    if end is None:
        return
    seen = end >= stable
    below = "within what the letter could resolve" if seen else (
        f"{stable / end:.0f} times below the letter's amplitude stability, which is why it was not seen"
    )  # fmt: skip
    run.verdict("smoothing", "differs" if seen else "in part" if end > UNSEEN else "agrees",
                found=f"beam: period doubling at {end:.2g}",
                note=f"the square root is smoothed; its period doubling lies {below}")  # fmt: skip
    if beam.square_root_from is not None and beam.half_excess is not None:
        run.answer("higher_modes", f"The square root holds from an excess of {beam.square_root_from:.1e} on; "
                   f"half of the kick is left at {beam.half_excess:.1e}. Below, the Hertz contact smooths "
                   f"it, and the period doubling that this brings ends at {end:.1e}, {below}.")  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(soft_wall.main())
