"""The letter's other claims, each with the numbers that decide it.

Claims (letter 1996), for the Nordmark map (Eqs. (2), (3)), for Eq. (1) and for springs with many modes:

    loss           "the magnitude of the hysteresis |rho_m| decreases with increasing energy loss"
    secondary      "in the mapping these secondary bifurcations always occur at rho > 0. In Eq. (1) [they]
                   may occur at values rho < 0 that become smaller if collisions become more elastic"
    bands          "bands in the (alpha, gamma) parameter plane ... crossed approximately transversely. At the
                   upper boundary ... there is no hysteresis", which grows "towards ... the lower-lying m - 1"
    universality   "independent of the details of the dynamics in between collisions ... universal": at equal
                   f T each spring has just above grazing the period that the map has as rho -> 0+
    overdamped     "an infinite series of period addings for the overdamped oscillator"

Equations: fold of p_m and its first bifurcation in closed form, of the map and of Eq. (1)
(contact.maps.nordmark_orbits, MaximalFamily; x'' + mu x' + omega^2 x = ..., x' -> -tau x' at the wall); the
born period of the beams by following their motion; Lyapunov exponents of the overdamped map.

Run:     python -m studies claims [--positions N]
Writes:  loss, bands, universality, overdamped (.csv); loss, secondary, bands, universality, overdamped (.png,
         .pdf)
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from studies.experiment.claims.bands import bands
from studies.experiment.claims.energy_loss import energy_loss
from studies.experiment.claims.overdamped import overdamped
from studies.experiment.claims.universality import universality
from studies.shell.scene import Scene, harmonic
from studies.shell.study import Run, study


@study(
    needs={"fold": 0.05},
    quick={"positions": 13, "across": 60, "restitutions": 10, "inside": 26, "alphas": 19},
)
def claims(
    scene: Scene,
    run: Run,
    *,
    positions: Annotated[int, "values of f T at which a period is born (universality)"] = 55,
    across: Annotated[int, "frequencies over which secondary bifurcations are counted"] = 240,
    restitutions: Annotated[int, "restitutions at which they are counted"] = 46,
    inside: Annotated[int, "frequencies inside each band"] = 101,
    alphas: Annotated[int, "values of alpha of the overdamped map"] = 46,
) -> Mapping[str, object]:
    """Compute, store and draw, one claim after the other."""
    harmonic(scene)
    return {
        **energy_loss(scene, run, across=across, restitutions=restitutions),
        "bands": bands(scene, run, inside=inside),
        "universality": universality(scene, run, positions=positions),
        "overdamped": overdamped(run, alphas=alphas),
    }
