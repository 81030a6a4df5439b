"""The letter's other claims, each with the numbers that decide it.

Claims (letter 1996), for the Nordmark map (Eqs. (2), (3)), for Eq. (1) and for springs with many modes:

    loss           "the magnitude of the hysteresis |rho_m| decreases with increasing energy loss"
    secondary      "in the mapping these secondary bifurcations always occur at rho > 0. In Eq. (1) [they]
                   may occur at values rho < 0 that become smaller if collisions become more elastic"
    universality   "independent of the details of the dynamics in between collisions ... universal": at equal
                   f T each spring has just above grazing the period that the map has as rho -> 0+
    period_adding  "an infinite series of period addings for the overdamped oscillator"

Equations: fold of p_m and its first bifurcation in closed form, of the map and of Eq. (1)
(contact.maps.nordmark_orbits, MaximalFamily; x'' + mu x' + omega^2 x = ..., x' -> -tau x' at the wall); the
born period of the beams by following their motion; p_m of the overdamped map, in the windows of rho of
W. Chin, E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.

Run:     python -m studies claims [--positions N]
Writes:  loss.csv, universality.csv, and the figures loss, secondary, universality
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated

from contact import NordmarkMap, maximal_orbits
from studies.experiment.claims.energy_loss import energy_loss
from studies.experiment.claims.universality import universality
from studies.shell.scene import Scene, harmonic
from studies.shell.study import Run, study

EIGENVALUE, ADDED = 0.45, range(4, 21)
"""Of the overdamped map: its eigenvalue, between 1/4 and 2/3 where windows are parted by chaos; periods."""


@study(needs={"fold": 0.05}, quick={"positions": 13, "across": 60, "restitutions": 10})
def claims(
    scene: Scene,
    run: Run,
    *,
    positions: Annotated[int, "values of f T at which a period is born (universality)"] = 55,
    across: Annotated[int, "frequencies over which secondary bifurcations are counted"] = 240,
    restitutions: Annotated[int, "restitutions at which they are counted"] = 46,
) -> Mapping[str, object]:
    """Compute, store and draw, one claim after the other."""
    harmonic(scene)
    return {
        **energy_loss(scene, run, across=across, restitutions=restitutions),
        "universality": universality(scene, run, positions=positions),
        "period_adding": period_adding(run),
    }


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
        if any(orbit.stable and orbit.admissible for orbit in maximal_orbits(nordmark, m, rho))
    ]
    run.verdict(
        "period_adding",
        "agrees" if there == list(ADDED) else "differs",
        found=f"overdamped map with eigenvalue {EIGENVALUE:g}: {len(there)} of {len(ADDED)} periods, from "
        f"{ADDED[0]} to {ADDED[-1]}, each in its own window of rho",
        note=f"the period rises by one where rho falls by the factor {EIGENVALUE:g}^2, without end",
    )
    return {"periods": there, "rho": list(places.values())}
