"""The two further questions of the chart at one drive frequency, computed, stored and drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import partial

import numpy as np

from contact import StroboscopicMap
from studies.experiment.chart.basins import parts, plane_of
from studies.experiment.chart.cut import CHAOTIC, KINDS, TITLES, Settlement, carried
from studies.shell.scene import Scene, beam_at, model_of, require_drive_below, single_mode_at
from studies.shell.study import Run


def cut(scene: Scene, run: Run, f: float, excesses: np.ndarray, cycles: int) -> Mapping[str, object]:
    """The settled motions of Eq. (1) and of the beam at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import cut_figure  # matplotlib is slow to import

    modes = model_of(scene)
    require_drive_below(scene, modes, f)
    oscillators = {"single_mode": single_mode_at(scene, f), "beam": beam_at(scene, f, modes)}
    maps = {name: StroboscopicMap(oscillator=oscillator) for name, oscillator in oscillators.items()}
    rows, strobes = list[Settlement](), list[np.ndarray]()
    jobs = partial(carried, scene=scene, values=excesses, cycles=cycles)
    for scan, recorded, failures in run.map(jobs, maps.items(), "scans"):
        rows, strobes = rows + scan, strobes + recorded
        for reason in failures:
            run.failed("scan", reason)
    run.table("cut", rows, "Settled motions; kind by the largest Lyapunov exponent.")
    run.arrays("cut", points=np.array(strobes), excess=[row.excess for row in rows])
    run.figure("cut", cut_figure.draw_scan(rows, strobes, f, scene.readout.quantity), cut_figure.SCAN)
    counts = Counter((row.model, row.kind) for row in rows)
    kinds = {name: {kind: counts[name, kind] for kind in KINDS} for name in maps}
    chaotic = {name: [r.excess for r in rows if (r.model, r.kind) == (name, CHAOTIC)] for name in maps}
    spans = [f"{TITLES[name]}: {min(at):.3g} to {max(at):.3g}" for name, at in chaotic.items() if at]
    run.verdict(
        "chaos",
        "agrees" if spans else "differs",
        found="; ".join(spans) or "none",
        note=f"excess with a positive Lyapunov exponent at {f:.2f} Hz",
    )
    return {"cut_hz": f, "rows": rows, "kinds": kinds, "chaotic": chaotic}


def basins(scene: Scene, run: Run, f: float, excess: float, side: int) -> Mapping[str, object]:
    """The basins of Eq. (1) at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import cut_figure  # matplotlib is slow to import

    plane = plane_of(scene, f, excess, side)
    leads = np.array(run.map(plane.line, plane.velocity.tolist(), "basins"))  # shape (velocities, x)
    run.arrays("basins", x=plane.x, velocity=plane.velocity, leads=leads, orbit=plane.strobes(plane.period))
    run.figure("basins", cut_figure.draw_basins(plane, leads, f), cut_figure.BASINS)
    period, shares = plane.period, parts(leads, plane.period)
    both = period > 1 and shares[f"p{period}"] > 0.0  # p1 without impacts is stable below grazing
    run.verdict(
        "coexistence",
        "agrees" if both else "differs",
        found=f"Eq. (1): p1 and p{period}" if both else "Eq. (1): one of them alone",
        note=f"at excess {excess:g} the start decides which of them is reached",
    )
    return {"basins": {"excess": excess, "period": period, "parts": shares}}
