"""A cut through the plane at one drive frequency: period, impacts and Lyapunov exponent over the amplitude.

The amplitude is raised and lowered again, and the state is carried along.

lyapunov_map     largest Lyapunov exponent per drive period, from the Jacobians of the period map
kind             periodic, chaotic (exponent above zero by three standard errors), not settled (below zero
                 by as much: a long period or a slow transient), or undecided
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from contact import ContactError, State, StroboscopicMap
from contact.orbits import Exponents, Settled, map_exponents, orbit_exponents, settle
from studies.physics.descriptions import TITLES, strobed_at
from studies.shell.scene import READOUT, Scene, model_of, require_drive_below
from studies.shell.study import Run

FREQUENCY = 21.50
"""Drive frequency of the letter's period 4 [Hz]."""

EXCESSES, QUICK_EXCESSES = np.linspace(-0.016, 0.06, 39), np.linspace(-0.016, 0.06, 11)
AVERAGE, QUICK_AVERAGE = 600, 100
"""Amplitudes of the cut [1]; drive periods in the averages of the exponents. The small form has fewer."""

SIGNIFICANT = 3.0
"""Standard errors by which an exponent must differ from zero to be told from it."""

ALIGN = 20
"""Periods in which tangents find their direction: the slowest contraction between two of them is e^-0.08."""

WITHOUT, PERIODIC, CHAOTIC = "without impacts", "periodic", "chaotic"
NOT_SETTLED, UNDECIDED = "not settled", "undecided"


@dataclass(frozen=True, kw_only=True)
class Settlement:
    """The settled motion at one amplitude: `period` in drive periods, 0 for none; `impacts` in one such
    period; `lyapunov_map` per drive period with its standard error."""

    model: str
    direction: str
    excess: float
    kind: str
    period: int
    impacts: int
    lyapunov_map: float
    error_map: float


def kind_of(strobed: StroboscopicMap, settled: Settled[State], cycles: int) -> tuple[str, Exponents]:
    """Chaos told from a long period or a slow transient by the exponents, averages over `cycles` drive
    periods."""
    if settled.period:
        kind = PERIODIC if settled.impacts else WITHOUT
        return kind, orbit_exponents(strobed, settled.end, settled.period)
    exponents, _end = map_exponents(strobed, settled.end, cycles, align=ALIGN)
    if abs(exponents.largest) <= SIGNIFICANT * exponents.error:
        return UNDECIDED, exponents
    return CHAOTIC if exponents.largest > 0 else NOT_SETTLED, exponents


def carried(
    named: tuple[str, StroboscopicMap], scene: Scene, values: np.ndarray, cycles: int
) -> tuple[list[Settlement], list[np.ndarray], list[str]]:
    """Upward and downward scan of one model, the settled state the start at the next amplitude; with the rows
    their strobed read-out, shape (record_cycles,) each, and third what failed.

    On the way up a motion stays without impacts as far as it can, on the way down it stays on p_m.
    """
    name, strobed = named
    rows, points, failures = [], [], []
    state = strobed.at(float(values[0])).steady()
    places = [("up", e) for e in values.tolist()] + [("down", e) for e in values[::-1].tolist()]
    for direction, excess in places:
        here = strobed.at(excess)
        try:
            settled = settle(here, state, most_cycles=scene.scan.settle_cycles)
            state = replace(settled.end, time=0.0)
            orbit = here.orbit(state, scene.scan.record_cycles)
            kind, exponents = kind_of(here, settled, cycles)
        except ContactError as error:
            failures.append(f"{TITLES[name]}, excess {excess:.6g}, {direction}: {error}")
            continue
        points.append(here.readout(orbit.points, READOUT))
        found = {"period": settled.period, "impacts": settled.impacts if settled.period else 0}
        found |= {"lyapunov_map": exponents.largest, "error_map": exponents.error}
        rows.append(Settlement(model=name, direction=direction, excess=excess, kind=kind, **found))
    return rows, points, failures


def cut(scene: Scene, run: Run, f: float) -> Mapping[str, object]:
    """The settled motions of Eq. (1) and of the beam at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import cut_figure  # matplotlib is slow to import

    modes = model_of(scene)
    require_drive_below(scene, modes, f)
    maps = {name: strobed_at(name, scene, f, modes) for name in ("single_mode", "beam")}
    values, cycles = (QUICK_EXCESSES, QUICK_AVERAGE) if run.quick else (EXCESSES, AVERAGE)
    rows, strobes = list[Settlement](), list[np.ndarray]()
    jobs = partial(carried, scene=scene, values=values, cycles=cycles)
    for scan, recorded, failures in run.map(jobs, maps.items(), "scans"):
        rows, strobes = rows + scan, strobes + recorded
        for reason in failures:
            run.failed("scan", reason)
    run.table("cut", rows, "Settled motions; kind by the largest Lyapunov exponent.")
    run.arrays("cut", points=np.array(strobes), excess=[row.excess for row in rows])
    run.figure("cut", cut_figure.draw_scan(rows, strobes, f, scene.readout.quantity), cut_figure.SCAN)
    chaotic = {name: [r.excess for r in rows if (r.model, r.kind) == (name, CHAOTIC)] for name in maps}
    spans = [f"{TITLES[name]}: {min(at):.3g} to {max(at):.3g}" for name, at in chaotic.items() if at]
    run.verdict(
        "chaos",
        "agrees" if spans else "differs",
        found="; ".join(spans) or "none",
        note=f"excess with a positive Lyapunov exponent at {f:.2f} Hz",
    )
    kinds = Counter(f"{TITLES[row.model]}, {row.kind}" for row in rows)
    return {"cut_hz": f, "rows": rows, "kinds": kinds}
