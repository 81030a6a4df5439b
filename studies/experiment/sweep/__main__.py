"""The settled motion over one or two numbers of a scene or of its drive.

Claim (letter 1996): the control parameters, amplitude and frequency, decide the settled motion.  So do the
numbers of the spring and of the stop.  In each cell the motion settles from rest, or from the cell before it
as in a slow change on a rig (--start up, --start down, along the first key).  Near grazing use small steps: a
large one can cause an impact by itself.

    period m         drive periods after which the motion repeats; 0: none up to 64
    impacts          in one period, on all stops; the scene may have several, [[stops]]
    peak force, approach speed, energy lost in a drive period

    python -m studies sweep --over stop.gap_m=0.010:0.012:41 --amplitude 0.0026
    python -m studies sweep --over frequency=19:24:101 --over excess=-0.02:0.05:71 --start up
    python -m studies sweep --over contact.stiffness_n_per_m=1e3:1e7:41:log --set contact.law=linear

KEY is any number of a scene (--dump-scene lists them), or frequency [Hz], excess [1] or amplitude [m].
Every finished column is kept (``studies.shell.sweep``): the same command goes on; --fresh begins anew.

Run:     python -m studies sweep [--over KEY=FROM:TO:N] [--over KEY=FROM:TO:N] [--start up]
Writes:  sweep.csv (one row a cell), sweep.npz (arrays on the grid), sweep.png
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Literal

import numpy as np

from studies.experiment.sweep import model
from studies.experiment.sweep.model import ALL, REST, Axis, Cell, Values
from studies.shell.digits import written
from studies.shell.options import HERTZ, Within
from studies.shell.scene import Scene
from studies.shell.study import Run, study
from studies.shell.sweep import note_failures
from studies.shell.sweep import sweep as stored

CAPTION = "Period, impacts, contact force, approach speed and energy lost over the swept numbers."
HOLDS = "Columns of sweep.csv, shape (n of the second key or 1, n of the first); m is -1 in a failed cell."
MOST_SHOWN = 100  # cells on the terminal; all are in the table
STARTS = {"rest": "from the spring at rest", "up": "from the cell below it", "down": "from the cell above it"}


@study(quick={"over": ("excess=-0.01:0.02:7",)}, many_stops=True)
def sweep(
    scene: Scene,
    run: Run,
    *,
    over: Annotated[tuple[str, ...], "one or two KEY=FROM:TO:N, or ...:N:log"] = ("excess=-0.02:0.06:41",),
    start: Annotated[
        Literal["rest", "up", "down"],
        "of a cell: at rest, or from the cell before, as the first key rises or falls",
    ] = "rest",
    frequency: Annotated[float | None, "drive frequency (Hz); by default of the scene", HERTZ] = None,
    excess: Annotated[
        float | None, "drive amplitude over grazing amplitude, minus 1 (0.013)", Within(-1, 1e6, open=True)
    ] = None,
    amplitude: Annotated[float | None, "of the base (m)", Within(0, 1e3, "m", open=True)] = None,
    fresh: Annotated[bool, "forget what is stored and begin anew"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    given = {"over": over, "start": start, "frequency": frequency, "excess": excess, "amplitude": amplitude}
    axes, fixed = model.plan_of(scene, given)
    scene = run.choose_modes(*model.with_modes(scene, axes, fixed))
    drive = in_words(fixed)
    run.say(f"{drive}{'; ' * bool(drive)}each motion starts {STARTS[start]}")
    settings = {"over": over, "start": start, "fixed": fixed, "scene": scene.values()}
    parts = [f"{axis.name}-{len(axis.values)}" for axis in axes]
    name = "-".join([start, *parts, *(f"{each}-{value:g}" for each, value in fixed.items())])
    work = partial(model.column_of, scene=scene, start=start, fixed=fixed)
    swept, size = model.grid({axis.name: axis.values for axis in axes}), len(axes[0].values)
    step = 1 if start == REST and len(axes) == 1 else size  # the cells of a line in one column
    lines = [swept[at : at + step] for at in range(0, len(swept), step)]
    columns = stored(run, name, settings, lines, work, fresh=fresh)
    cells = {each: np.concatenate([one[each] for one in columns]).reshape(-1, size) for each in model.NUMBERS}
    rows = rows_of(swept, cells)
    run.table("sweep", rows, "The cells of the sweep.", of=Cell, show=None if len(rows) <= MOST_SHOWN else ())
    note_failures(run, ((in_words(row.swept), row.reason) for row in rows if row.reason))
    run.arrays("sweep", HOLDS, **{axis.name: axis.values for axis in axes} | cells)
    from studies.experiment.sweep.figure import draw  # matplotlib is slow to import

    run.figure("sweep", draw(axes, cells, drive), CAPTION)
    findings(run, axes, cells)
    if unsettled := np.sum(cells["m"] == 0):
        cycles = scene.scan.settle_cycles
        words = f"have no period up to 64 within {cycles} drive periods; look longer with"
        run.say(f"{unsettled} cells {words} --set scan.settle_cycles={10 * cycles}")
    if start != REST:
        run.say(f"cells whose motion starts from rest: {np.sum(~cells['carried'] & (cells['m'] >= 0))}")
    return {"rows": rows, "modes": scene.kept_modes, "start": start, **fixed}


def in_words(values: Values) -> str:
    """Names, values and units."""
    return ", ".join(f"{name} {v:.6g} {ALL[name].unit}".removesuffix(" 1") for name, v in values.items())


def rows_of(swept: Sequence[Values], cells: Mapping[str, np.ndarray]) -> list[Cell]:
    """The cells in the order of the grid, the first axis fastest."""
    columns, rows = [values.ravel().tolist() for values in cells.values()], list[Cell]()
    for at, *row in zip(swept, *columns, strict=True):
        numbers = dict(zip(cells, row, strict=True))
        rows.append(Cell(swept=at, **numbers | ({"m": None, "impacts": None} if numbers["reason"] else {})))
    return rows


def findings(run: Run, axes: Sequence[Axis], cells: Mapping[str, np.ndarray]) -> None:
    """What came out, and a key that changes nothing."""
    done = cells["m"] >= 0
    if done.any():
        share = written(100.0 * float(np.mean(cells["m"][done] > 0)), 3)
        run.finding(f"The motion has a period in {share} % of the cells.")
    if np.any(cells["peak_force"] > 0.0):
        most = written(float(np.nanmax(cells["peak_force"])), 3)
        run.finding(f"The largest contact force of the sweep is {most} N.")
    numbers = [values for name, values in cells.items() if name not in ("carried", "reason")]
    for number, axis in enumerate(axes):
        first = [np.broadcast_to(values.take([0], 1 - number), values.shape) for values in numbers]
        if done.any() and all(map(partial(np.array_equal, equal_nan=True), first, numbers)):
            run.warn(f"{axis.name} changes no number of this sweep: the scene may make no use of it")
