"""Loss, secondary bifurcations, universality: each with its numbers.

Claims (letter 1996), for the Nordmark map (Eqs. (2), (3)), for Eq. (1) and for springs with many modes:

    loss           "the magnitude of the hysteresis |rho_m| decreases with increasing energy loss"
    secondary      "in the mapping these secondary bifurcations always occur at rho > 0. In Eq. (1) [they]
                   may occur at values rho < 0 that become smaller if collisions become more elastic"
    universality   "independent of the details of the dynamics in between collisions ... universal": at equal
                   f T each spring has just above grazing the period that the map has as rho -> 0+
    period_adding  "an infinite series of period addings for the overdamped oscillator"

Fold of p_m and its first bifurcation are closed forms (contact.maps.nordmark_orbits, MaximalFamily); the born
periods of the beams come from their motion; p_m of the overdamped map from the windows of rho of W. Chin,
E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.

Run:     python -m studies claims [--positions N]
Writes:  loss.csv, universality.csv, and the figure loss
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated

import numpy as np

from contact import MapFamily, NordmarkMap, coexisting_m, maximal_m
from studies import letter
from studies.experiment.claims.model import (
    RESTITUTIONS,
    SPAN,
    Born,
    Job,
    Node,
    below_grazing,
    born_at,
    line_of,
    springs,
    trends,
)
from studies.physics.descriptions import falls
from studies.physics.least_model import at_letters_drives
from studies.shell.digits import written
from studies.shell.scene import Scene, band_of, corresponding, harmonic, nordmark_at
from studies.shell.study import Run, study

SCANNED_HZ = (19.62, 23.75)  # across the bands of p3 to p16, for the letter's spring

PLANE, QUICK_PLANE = (240, 46), (60, 10)
"""Frequencies and restitutions over which secondary bifurcations are counted."""

SLACK = 0.02  # change of a share of the scanned frequencies that is that of one cell or two

TOP = 0.75  # part of a band above which a frequency is next to its upper edge

CLOSER = 1.0 / 16.0  # part of the born excess at which a disagreement is looked at again

EIGENVALUE, ADDED = 0.45, range(4, 21)
"""Of the overdamped map: its eigenvalue, between 1/4 and 2/3 where windows are parted by chaos; periods."""


@study(needs={"fold": 0.05}, quick={"positions": 13}, at=at_letters_drives)
def claims(
    scene: Scene,
    run: Run,
    *,
    positions: Annotated[int, "values of f T at which a period is born (universality)"] = 55,
) -> Mapping[str, object]:
    """Compute, store and draw, one claim after the other."""
    harmonic(scene)
    return {
        **energy_loss(scene, run),
        "universality": universality(scene, run, positions=positions),
        "period_adding": period_adding(run),
    }


def energy_loss(scene: Scene, run: Run) -> Mapping[str, object]:
    """Hysteresis and secondary bifurcations against the energy lost: compute, store, draw and judge."""
    from studies.experiment.claims import figure  # matplotlib is slow to import

    drives = sorted(scene.drive.frequencies_hz)
    lines = run.map(partial(line_of, scene, drives), RESTITUTIONS, "restitutions")
    rows = [node for f in zip(*lines, strict=True) for node in f]
    low, high = (corresponding(scene, f) for f in SCANNED_HZ)
    across, restitutions = QUICK_PLANE if run.quick else PLANE
    frequencies = np.linspace(low, high, across)
    tau = np.linspace(0.0, 0.9, restitutions)
    plane = run.map(partial(below_grazing, scene, frequencies.tolist()), tau.tolist(), "rows of the plane")
    below = np.array([part for part, _ in plane])
    run.table("loss", rows, "Fold and first bifurcation of p_m, by restitution.", of=Node, show=())
    run.figure("loss", figure.draw_loss(rows, tau, below, letters=run.letters), figure.LOSS)
    found = trends(rows)
    both = found["map"] and found["eq1"]
    names = {"map": "hysteresis of the map", "eq1": "of Eq. (1)", "rho": "|ρ_m| of the map"}
    falling, other = (" and ".join(names[n] for n in found if found[n] is good) for good in (True, False))
    but = "" if both else ", but not at every frequency"
    run.finding(f"The more energy an impact takes, the less is the hysteresis of map and Eq. (1){but}.")
    note = "" if found["rho"] else "the hysteresis in F falls; |ρ_m| rises, because ρ per F falls faster"
    run.verdict(
        "loss",
        "differs" if not both else "agrees" if found["rho"] else "in part",
        found=f"falls with the loss: {falling or 'none'}" + f"; not so: {other}" * bool(other),
        note=note,
    )
    lowest = float(np.nanmin([end for _, end in plane]))
    simple = [row for row in rows if row.admissible]
    lower = [f for f in drives if falls([row.secondary for row in simple if row.frequency_hz == f])]
    holds = bool(lowest > 0.0 and below[0] < below[-1] and np.all(np.diff(below) >= -SLACK))
    at = {t: float(np.interp(t, tau, below)) for t in (0.0, letter.RESTITUTION, 0.9)}
    shares = ", ".join(f"{100 * part:.0f} % at τ = {t:g}" for t, part in at.items())
    own = 100.0 * float(np.interp(scene.single_mode.restitution, tau, below))
    if holds and own > 0.0:
        words = "Secondary bifurcations lie above grazing in the map; in Eq. (1) they lie below it"
        run.finding(f"{words} at {own:.0f} % of the frequencies.")
    run.verdict(
        "secondary",
        "agrees" if holds else "differs",
        found=f"map: never below excess {written(lowest, 2)}; Eq. (1): below grazing in {shares}",
        note=f"at one frequency its excess falls throughout as τ grows at {len(lower)} of {len(drives)}",
    )
    return {"rows": rows, "falls": found, "restitution": tau, "part_below_grazing": below}


def universality(scene: Scene, run: Run, *, positions: int) -> Mapping[str, object]:
    """Born periods of several springs beside the bands of the map: compute, store and judge.

    Over whole bands secondary bifurcations come before the born excess. The claim is therefore judged next to
    the upper edges, where the hysteresis is small, and where a spring disagrees again at a sixteenth of it.
    """
    rows, excess = born_everywhere(scene, run, positions), scene.scan.born_excess
    words = "Periods that begin at grazing on several springs, and in the map."
    run.table("universality", rows, words, of=Born, show=())
    failed = any(row.m is None for row in rows)
    agree = {
        name: float(np.mean([row.agrees for row in rows if row.spring == name]))
        for name in dict.fromkeys(row.spring for row in rows)
    }
    top = [row for row in rows if row.next_to_edge]
    odd = [row for row in top if not row.agrees]
    holds = all(row.has(row.closer) for row in odd)
    if top and not failed:
        share = written(100.0 * (1.0 - len(odd) / len(top)), 3)
        words = "Where the hysteresis is small, the map gives the period just above grazing for"
        run.finding(f"{words} {share} % of the springs and frequencies.")
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
    return {"agree": agree, "exceptions_in_top_quarter": odd, "closer_excess": CLOSER * excess}


def born_everywhere(scene: Scene, run: Run, count: int) -> list[Born]:
    """Every spring at every f T; the disagreements next to an upper edge once more, closer to grazing."""
    excess = scene.scan.born_excess
    places = np.linspace(*SPAN, count).tolist()
    jobs = [Job(*spring, place, excess) for spring in springs(scene) for place in places]
    rows, born = [], run.attempt(born_at, jobs, "born periods")
    for job, period in zip(jobs, born, strict=True):
        frequency = job.f_times_t / scene.single_mode.free_period_s
        nordmark = nordmark_at(scene, frequency)
        edges = band_of(scene, maximal_m(nordmark))
        part = (frequency - edges.lower) / (edges.upper - edges.lower)
        rows.append(
            Born(
                spring=job.spring,
                f_times_t=job.f_times_t,
                m=period,
                map=maximal_m(nordmark),
                also=maximal_m(nordmark) + 1 if len(coexisting_m(nordmark)) > 1 else None,
                next_to_edge=part >= TOP,
            )
        )
    again = [i for i, row in enumerate(rows) if row.next_to_edge and not row.agrees]
    nearer = [jobs[i]._replace(excess=CLOSER * excess) for i in again]
    for i, period in zip(again, run.attempt(born_at, nearer, "born periods closer to grazing"), strict=True):
        rows[i] = replace(rows[i], closer=period)
    return rows


def period_adding(run: Run) -> Mapping[str, object]:
    """Whether the overdamped map has each p_m, stable with one impact, in the middle of its window of rho.

    The eigenvalues are l = `EIGENVALUE` and 0, tau = 0. As rho -> 0+ the window of p_m is
    rho = l^(2m-2) (1 - l) z (z + 1), 1/2 < z < (1 - l)/l.
    """
    nordmark = NordmarkMap(alpha=EIGENVALUE, gamma=0.0, restitution=0.0, whole_turns=0)
    z = math.sqrt(0.5 * (1.0 - EIGENVALUE) / EIGENVALUE)
    places = {m: EIGENVALUE ** (2 * m - 2) * (1.0 - EIGENVALUE) * z * (z + 1.0) for m in ADDED}
    there = [
        m
        for m, rho in places.items()
        if any(orbit.stable and orbit.admissible for orbit in MapFamily(nordmark, m).at_rho(rho))
    ]
    run.verdict(
        "period_adding",
        "agrees" if there == list(ADDED) else "differs",
        found=f"overdamped map with eigenvalue {EIGENVALUE:g}: {len(there)} of {len(ADDED)} periods, from "
        f"{ADDED[0]} to {ADDED[-1]}, each in its own window of ρ",
        note=f"the period rises by one where ρ falls by the factor {EIGENVALUE:g}², without end",
    )
    return {"periods": there, "rho": list(places.values())}
