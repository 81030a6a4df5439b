"""What the spring settles on: period, impacts and Lyapunov exponent, and which starts lead where.

Claim (letter 1996): besides the p_m orbits "other transitions" occur, which "may even be to chaotic states",
and below grazing p_m and the motion without impacts coexist.

Computed at one drive frequency (--frequency, 21.50 Hz) for Eq. (1) and for the beam with its N modes:

    period, impacts     of the settled orbit in an upward and a downward scan that carry the state along
    exponent, kind      largest Lyapunov exponent per drive period, and periodic or chaotic by it
    basins              for Eq. (1) at --basin-excess (-0.006): where each start on the strobe plane leads

Run:     python -m studies attractors [--model single_mode] [--quick]
Writes:  rows.csv (a row an amplitude), attractors.npz (strobe points), basins.npz; attractors, basins (png,
         pdf)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import partial
from typing import Annotated, Literal

import numpy as np

from beam import InvalidValue
from contact import StroboscopicMap
from studies.experiment.attractors.basins import parts, plane_of
from studies.experiment.attractors.scan import CHAOTIC, KINDS, TITLES, Row, carried
from studies.shell.options import require_cells
from studies.shell.scene import (
    Scene,
    beam_at,
    corresponding,
    harmonic,
    model_of,
    require_drive_below,
    single_mode_at,
)
from studies.shell.study import Run, study

FREQUENCY = 21.50
"""Where the letter has period 4 [Hz]."""


@study(needs={"fold": 0.05}, quick={"points": 11, "cycles": 100, "side": 32})
def attractors(
    scene: Scene,
    run: Run,
    *,
    frequency: Annotated[float | None, "drive frequency [Hz] (21.5; another spring: its f T)"] = None,
    model: Annotated[Literal["single_mode", "beam", "both"], "which description"] = "both",
    lowest: Annotated[float, "lowest excess of the scan"] = -0.016,
    highest: Annotated[float, "highest excess of the scan"] = 0.06,
    points: Annotated[int, "amplitudes of the scan"] = 39,
    cycles: Annotated[int, "drive periods in the averages"] = 600,
    basin_excess: Annotated[float, "excess of the basins"] = -0.006,
    side: Annotated[int, "starts along each side of the basins"] = 200,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if not -1.0 < lowest < highest:
        raise InvalidValue(f"lowest is {lowest} and highest {highest}; -1 < lowest < highest must hold")
    if not -1.0 < basin_excess < 0.0:
        raise InvalidValue(f"basin-excess is {basin_excess}; it must lie above -1 and below grazing, 0")
    require_cells("side", side, side**2)
    if min(side, points) < 2:
        raise InvalidValue(f"side is {side} and points {points}; each must be 2 or more")
    f = corresponding(harmonic(scene), FREQUENCY) if frequency is None else frequency
    maps = {}
    if model != "beam":
        maps["single_mode"] = StroboscopicMap(oscillator=single_mode_at(scene, f))
    if model != "single_mode":
        modes = model_of(scene)
        require_drive_below(scene, modes, f)
        maps["beam"] = StroboscopicMap(oscillator=beam_at(scene, f, modes))
    rows, strobes = list[Row](), list[np.ndarray]()
    jobs = partial(carried, scene=scene, values=np.linspace(lowest, highest, points), cycles=cycles)
    for scan, recorded, failures in run.map(jobs, maps.items(), "scans"):
        rows, strobes = rows + scan, strobes + recorded
        for reason in failures:
            run.failed("scan", reason)
    run.table("rows", rows, "Settled motions; kind by the largest Lyapunov exponent.")
    run.arrays("attractors", points=np.array(strobes), excess=[row.excess for row in rows])
    plane = plane_of(scene, f, basin_excess, side)
    leads = np.array(run.map(plane.line, plane.velocity.tolist(), "basins"))  # shape (velocities, x)
    run.arrays("basins", x=plane.x, velocity=plane.velocity, leads=leads, orbit=plane.strobes(plane.period))
    from studies.experiment.attractors import figure

    quantity, period, shares = scene.readout.quantity, plane.period, parts(leads, plane.period)
    run.figure("attractors", figure.draw_scan(rows, strobes, f, quantity), figure.SCAN)
    run.figure("basins", figure.draw_basins(plane, leads, f), figure.BASINS)
    counts = Counter((row.model, row.kind) for row in rows)
    kinds = {name: {kind: counts[name, kind] for kind in KINDS} for name in maps}
    chaotic = {name: [r.excess for r in rows if (r.model, r.kind) == (name, CHAOTIC)] for name in maps}
    both = period > 1 and shares[f"p{period}"] > 0.0  # p1 without impacts is stable below grazing
    run.verdict(
        "coexistence",
        "agrees" if both else "differs",
        found=f"Eq. (1): p1 and p{period}" if both else "Eq. (1): one of them alone",
        note=f"at excess {basin_excess:g} the start decides which of them is reached",
    )
    spans = [f"{TITLES[name]}: {min(at):.3g} to {max(at):.3g}" for name, at in chaotic.items() if at]
    run.verdict(
        "chaos",
        "agrees" if spans else "differs",
        found="; ".join(spans) or "none",
        note=f"excess with a positive Lyapunov exponent at {f:.2f} Hz",
    )
    return {
        "frequency_hz": f,
        "kinds": kinds,
        "chaotic": chaotic,
        "basins": {"excess": basin_excess, "period": period, "parts": shares},
    }
