"""Periods and numbers of impacts over drive frequency and amplitude.

Claim (letter 1996, Figs. 1 to 3, for a whole plane): below grazing an orbit p_m coexists with the motion
without impacts down to its fold; at grazing the period follows the bands of the map; above it periods
double, and chaos lies between. At each frequency the amplitude is raised and lowered again with the state
carried along; each cell gets period (up to 64) and impacts of the orbit on which the motion settles.

At one drive frequency, --cut-hz, there are two more questions on Eq. (1) and on the beam with its N modes:

    cut      the largest Lyapunov exponent of the settled motions: periodic or chaotic
    basins   for Eq. (1) below grazing: the orbit to which each start on the strobe plane leads

    python -m studies chart                          Eq. (1), 400 x 400, both directions
    python -m studies chart --model beam             the beam of the scene, 120 x 120
    python -m studies chart --executor processes     or dask://host:port, for a cluster

Every finished column is kept (``studies.shell.sweep``): the same command goes on; --fresh begins anew.

Run:     python -m studies chart [--model beam] [--quick]
Writes:  chart_MODEL.npz (cells), folds_MODEL.csv; cut.csv, cut.npz; basins.npz; and the figures of these
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Annotated, Literal

import numpy as np

from contact import ImpactOscillator
from contact.orbits import AmplitudeScan
from studies import letter
from studies.experiment.chart import settled
from studies.experiment.chart.model import (
    EXCESSES,
    FREQUENCIES_HZ,
    KNEE,
    Fold,
    Plane,
    bands_in,
    column_at,
    folds_of_beam,
    folds_of_single_mode,
)
from studies.physics.descriptions import TITLES, strobed_at
from studies.physics.least_model import least_modes
from studies.shell.digits import written
from studies.shell.options import HERTZ, MOST_CELLS, Within
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
from studies.shell.sweep import Column, note_failures, sweep

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

CUT_NEEDS = {"fold": 0.05}  # accuracy requirement of the cut


@study(quick={"side": 32})
def chart(
    scene: Scene,
    run: Run,
    *,
    model: Annotated[Literal["single_mode", "beam"], "Eq. (1) or the beam"] = "single_mode",
    points: Annotated[
        tuple[int, int] | None, "frequencies and amplitudes (400 400, beam 120 120)", Within(2, MOST_CELLS)
    ] = None,
    cut_hz: Annotated[float | None, "frequency of the cut (21.5; another spring: its f T)", HERTZ] = None,
    side: Annotated[int, "starts along each side of the basins", Within(2, 1000)] = 200,
    fresh: Annotated[bool, "forget what is stored and begin anew"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    f = corresponding(harmonic(scene), letter.TIME_TRACE_HZ) if cut_hz is None else cut_hz
    with_modes = run.choose_modes(*least_modes(scene, CUT_NEEDS))
    columns, rows = points or (QUICK_POINTS if run.quick else POINTS)[model]
    low, high = (corresponding(harmonic(scene), f) for f in FREQUENCIES_HZ)
    plane = Plane(columns=columns, rows=rows, frequencies_hz=(low, high))
    bound = QUICK_CYCLES if run.quick else CYCLES[model]
    if model == "beam":
        scene = run.choose_modes(*least_modes(scene, NEEDS))
    oscillator = (beam_at if model == "beam" else single_mode_at)(scene, 0.5 * (low + high))
    scan = AmplitudeScan(oscillator=oscillator, most_cycles=bound)
    settings = {"model": model, "plane": plane, "knee": KNEE, "most_cycles": bound, "scene": scene.values()}
    work, name = partial(column_at, scan=scan, plane=plane), f"{model}-{columns}x{rows}"
    found = sweep(run, name, settings, plane.frequencies().tolist(), work, fresh=fresh)
    note_failures(run, failures(found))
    return {
        "model": model,
        "modes": oscillator.n_modes,
        "points": [columns, rows],
        "most_cycles": bound,
        **drawn(scene, run, plane, oscillator, found, model),
        **cut(with_modes, run, f),
        **basins(with_modes, run, f, side),
    }


def failures(columns: list[Column]) -> Iterator[tuple[str, str]]:
    """Where cells failed, and why."""
    for column in columns:
        for way, place in np.argwhere(column["reason"] != ""):
            where = f"{float(column['frequency_hz']):.6g} Hz, excess {float(column['excess'][place]):.6g}"
            yield f"{where}, {column['direction'][way, 0]}", str(column["reason"][way, place])


def drawn(
    scene: Scene, run: Run, plane: Plane, oscillator: ImpactOscillator, columns: list[Column], model: str
) -> dict[str, object]:
    """Store the cells and what theory says, draw both."""
    from studies.experiment.chart.figure import CAPTION, draw  # matplotlib is slow to import

    edges, names = bands_in(scene, *plane.frequencies_hz), ("m", "impacts", "cycles")
    cells = {name: np.stack([one[name] for one in columns], axis=1).astype(np.int32) for name in names}
    frequencies, excesses, lowest = plane.frequencies(), plane.rising_excesses(), EXCESSES[0]
    if model == "single_mode":
        folds = folds_of_single_mode(oscillator, frequencies, lowest)
    else:
        folds = folds_of_beam(oscillator, edges, frequencies, lowest)
    holds = "Period (0: none), impacts, drive periods spent (-1: failed) by scan, frequency [Hz], excess [1]."
    run.arrays(f"chart_{model}", holds, frequency_hz=frequencies, excess=excesses, **cells)
    run.table(f"folds_{model}", folds, "Exact folds of p_m orbits with one impact.", of=Fold, show=())
    run.figure(f"chart_{model}", draw(plane, cells, edges, folds, TITLES[model]), CAPTION)
    without = float(np.mean(cells["m"] == 0))
    run.say(f"{100 * without:.1f} % of the cells without a period up to {LARGEST_PERIOD}")
    if without > 0.0:
        name = "beam" if model == "beam" else "motion of Eq. (1)"
        run.finding(f"In {written(100.0 * without, 3)} % of the plane the {name} settles on no short period.")
    return {"share_without_period": without, "folds": len(folds)}


def cut(scene: Scene, run: Run, f: float) -> Mapping[str, object]:
    """The settled motions of Eq. (1) and of the beam at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import figure  # matplotlib is slow to import

    modes = model_of(scene)
    require_drive_below(scene, modes, f)
    maps = {name: strobed_at(name, scene, f, modes) for name in ("single_mode", "beam")}
    values, cycles = settled.QUICK_CUT if run.quick else settled.CUT
    rows, strobes = list[settled.Settlement](), list[np.ndarray]()
    jobs = partial(settled.carried, scene=scene, values=values, cycles=cycles)
    for scan, recorded, failures in run.map(jobs, maps.items(), "scans"):
        rows, strobes = rows + scan, strobes + recorded
        for reason in failures:
            run.failed("scan", reason)
    words = "Motions that settled at one drive frequency, classified by the largest Lyapunov exponent."
    run.table("cut", rows, words, of=settled.Settlement)
    holds = "Strobed points [m, or rad for a rotation] at each excess [1], row by row as in cut.csv."
    run.arrays("cut", holds, points=np.array(strobes), excess=[row.excess for row in rows])
    run.figure("cut", figure.draw_scan(rows, strobes, f, scene.readout.quantity), figure.SCAN)
    wild = [row for row in rows if row.kind == settled.CHAOTIC]
    chaotic = {name: [row.excess for row in wild if row.model == name] for name in maps}
    ends = {name: sorted({min(at), max(at)}) for name, at in chaotic.items() if at}
    spans = [f"{TITLES[name]}: {' to '.join(written(e, 3) for e in at)}" for name, at in ends.items()]
    if "beam" in ends and ends["beam"][0] > 0.0:
        first = written(100.0 * ends["beam"][0], 2)
        run.finding(f"The smallest amplitude at which the beam is chaotic lies {first} % above grazing.")
    run.verdict(
        "chaos",
        "agrees" if spans else "differs",
        found="; ".join(spans) or "none",
        note=f"excess with a positive Lyapunov exponent at {f:.2f} Hz",
        figure="cut",
    )
    kinds = Counter(f"{TITLES[row.model]}, {row.kind}" for row in rows)
    return {"cut_hz": f, "rows": rows, "kinds": kinds}


def basins(scene: Scene, run: Run, f: float, side: int) -> Mapping[str, object]:
    """The basins of Eq. (1) at the drive frequency `f` [Hz], stored and drawn."""
    from studies.experiment.chart import figure  # matplotlib is slow to import

    plane = settled.plane_of(scene, f, side)
    leads = np.array(run.map(plane.line, plane.velocity.tolist(), "rows of the basins"))
    holds = "Starts, x [m] and velocity [m/s]; the period each leads to (0: another, -1: behind the stop)."
    run.arrays("basins", holds, x=plane.x, velocity=plane.velocity, leads=leads)
    run.figure("basins", figure.draw_basins(plane, leads, f), figure.BASINS)
    period, shares = plane.m, settled.parts(leads, plane.m)
    both = period > 1 and shares[f"p{period}"] > 0.0  # p1 without impacts is stable below grazing
    if both:
        share = written(100.0 * shares[f"p{period}"], 3)
        rest = ", and some to the motion without impacts" * (shares["p1 without impacts"] > 0.0)
        run.finding(f"A little below grazing {share} % of the starts of Eq. (1) lead to p{period}{rest}.")
    run.verdict(
        "coexistence",
        "agrees" if both else "differs",
        found=f"Eq. (1): p1 and p{period}" if both else "Eq. (1): one of them alone",
        note=f"at excess {written(settled.EXCESS)} the start decides which of them is reached",
        figure="basins",
    )
    return {"basins": {"excess": settled.EXCESS, "m": period, "parts": shares}}
