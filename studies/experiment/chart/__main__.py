"""The plane of drive frequency and amplitude: which period, how many impacts, upwards and downwards.

Claim (letter 1996, Figs. 1 to 3, for a whole plane): below grazing an orbit p_m coexists with the motion
without impacts down to its fold; at grazing the period follows the bands of the map; above it periods
double, and chaos lies between. Computed on a grid refined around grazing: at each frequency the amplitude is
raised and lowered again with the state carried along, and each cell gets the period (up to 64) and the
impacts of the orbit on which the motion settles, within --cycles drive periods
(contact.orbits.AmplitudeScan). Drawn over it: the band edges of the map and the exact folds.

At one drive frequency, --cut-hz, two more questions are asked of Eq. (1) and of the beam with its N modes:

    cut      period, impacts and largest Lyapunov exponent of the settled motions: periodic or chaotic
    basins   for Eq. (1) below grazing: the orbit to which each start on the strobe plane leads

    python -m studies chart                          Eq. (1), 400 x 400, both directions
    python -m studies chart --model beam             the beam of the scene, 120 x 120
    python -m studies chart --executor processes     or dask://host:port, for a cluster

Every finished column is a file in MODEL-NxM (``studies.shell.sweep``); the same command goes on where the
last one was stopped, in whatever way; --fresh begins anew.

Run:     python -m studies chart [--model beam] [--quick]
Writes:  chart_MODEL.npz (cells), folds_MODEL.csv, chart_MODEL.png; cut.csv, cut.npz,
         cut.png; basins.npz, basins.png
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Literal

import numpy as np

from beam import InvalidValue
from contact import ImpactOscillator
from contact.orbits import AmplitudeScan
from studies import letter
from studies.experiment.chart.model import (
    EXCESSES,
    FREQUENCIES_HZ,
    KNEE,
    Plane,
    bands_in,
    column_at,
    folds_of_beam,
    folds_of_single_mode,
    side_by_side,
)
from studies.experiment.chart.settled import basins, cut
from studies.physics.descriptions import TITLES
from studies.shell.options import require_cells
from studies.shell.scene import Scene, beam_at, corresponding, harmonic, single_mode_at
from studies.shell.study import Run, study
from studies.shell.sweep import Column, sweep

POINTS = {"single_mode": (400, 400), "beam": (120, 120)}
QUICK_POINTS = {"single_mode": (46, 40), "beam": (10, 16)}
CYCLES = {"single_mode": 8192, "beam": 1024}
"""Bounds of settling in drive periods: free motion falls by e^-1 in 12 of them, so that a motion that is not
periodic to 1e-9 of the gap after 512 is chaotic or next to a bifurcation. With one mode 8192 are cheap, and
then the orbits next to all folds have come to rest."""

QUICK_CYCLES = 256
LARGEST_PERIOD = 64

NEEDS = {"born_period": 0.0, "fold_middle": 0.07}
"""What the chart of the beam rests on; Eq. (1) needs nothing."""

CUT_NEEDS = {"fold": 0.05}
"""Accuracy requirement of the cut."""

MOST_REASONS = 20
"""Failures with a sentence of their own; all are in the columns."""


@study(quick={"side": 32})
def chart(
    scene: Scene,
    run: Run,
    *,
    model: Annotated[Literal["single_mode", "beam"], "Eq. (1) or the beam"] = "single_mode",
    points: Annotated[tuple[int, int] | None, "frequencies and amplitudes (400 400, beam 120 120)"] = None,
    cut_hz: Annotated[float | None, "drive frequency of the cut [Hz] (21.5; another spring: its f T)"] = None,
    side: Annotated[int, "starts along each side of the basins"] = 200,
    fresh: Annotated[bool, "forget what is stored and begin anew"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    require_cells("side", side, side**2)
    if side < 2:
        raise InvalidValue(f"side is {side}; it must be 2 or more")
    f = corresponding(harmonic(scene), letter.TIME_TRACE_HZ) if cut_hz is None else cut_hz
    with_modes = run.choose_modes(scene, CUT_NEEDS)
    columns, rows = points or (QUICK_POINTS if run.quick else POINTS)[model]
    low, high = (corresponding(harmonic(scene), f) for f in FREQUENCIES_HZ)
    plane = Plane(columns=columns, rows=rows, frequencies_hz=(low, high))
    bound = QUICK_CYCLES if run.quick else CYCLES[model]
    if model == "beam":
        scene = run.choose_modes(scene, NEEDS)
    oscillator = (beam_at if model == "beam" else single_mode_at)(scene, 0.5 * (low + high))
    scan = AmplitudeScan(oscillator=oscillator, most_cycles=bound)
    settings = {"model": model, "plane": plane, "knee": KNEE, "most_cycles": bound, "scene": scene.values()}
    work, name = partial(column_at, scan=scan, plane=plane), f"{model}-{columns}x{rows}"
    found = sweep(run, name, settings, plane.frequencies().tolist(), work, fresh=fresh)
    tell_failures(run, found)
    return {
        "model": model,
        "modes": oscillator.n_modes,
        "points": [columns, rows],
        "most_cycles": bound,
        **drawn(scene, run, plane, oscillator, found, model),
        **cut(with_modes, run, f),
        **basins(with_modes, run, f, side),
    }


def tell_failures(run: Run, columns: list[Column]) -> None:
    """Every failed cell counts; the first are told."""
    for column in columns:
        for way, place in np.argwhere(column["reason"] != ""):
            where = f"{float(column['frequency_hz']):.6g} Hz, excess {float(column['excess'][place]):.6g}"
            reason = str(column["reason"][way, place])
            if len(run.failures) < MOST_REASONS:
                run.failed(f"{where}, {column['direction'][way, 0]}", reason)
            else:
                run.failures.append(f"{where}: {reason}")


def drawn(
    scene: Scene, run: Run, plane: Plane, oscillator: ImpactOscillator, columns: list[Column], model: str
) -> dict[str, object]:
    """Store the cells and what theory says, draw both."""
    from studies.experiment.chart.figure import CAPTION, draw  # matplotlib is slow to import

    edges, cells = bands_in(scene, *plane.frequencies_hz), side_by_side(columns)
    frequencies, excesses, lowest = plane.frequencies(), plane.rising_excesses(), EXCESSES[0]
    if model == "single_mode":
        folds = folds_of_single_mode(oscillator, frequencies, lowest)
    else:
        folds = folds_of_beam(oscillator, edges, frequencies, lowest)
    run.arrays(f"chart_{model}", frequency_hz=frequencies, excess=excesses, **cells)
    run.table(f"folds_{model}", folds, "Exact folds of p_m orbits with one impact.", show=())
    title = f"{TITLES[model]}, {plane.columns} × {plane.rows}"
    run.figure(f"chart_{model}", draw(plane, cells, edges, folds, title), CAPTION)
    without = float(np.mean(cells["period"] == 0))
    run.say(f"{100 * without:.1f} % of the cells without a period up to {LARGEST_PERIOD}")
    return {"share_without_period": without, "folds": len(folds)}
