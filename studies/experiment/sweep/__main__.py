"""The settled motion over one or two numbers of a scene or of its drive.

Claim (letter 1996): the control parameters, amplitude and frequency, decide the settled motion.  So do the
numbers of the spring and of the stop.  In each cell of the sweep the beam settles from rest, or from the
motion of the cell before it as in a slow change on a rig (--start up, --start down, along the first key).
The change from cell to cell is sudden: steps next to grazing must be small, lest the step itself makes the
first touch.

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

from collections.abc import Iterable, Mapping
from functools import partial
from itertools import chain
from typing import Annotated, Any, Literal

import numpy as np

from studies.experiment.sweep.model import ALL, NUMBERS, REST, Cell, Plan, Values, column_of, plan_of
from studies.shell.digits import written
from studies.shell.options import HERTZ, Within
from studies.shell.scene import Scene
from studies.shell.study import Run, study
from studies.shell.sweep import note_failures
from studies.shell.sweep import sweep as stored

CAPTION = (
    "Settled motion over the swept numbers: period, impacts, largest force, greatest approach speed, and "
    "energy lost at the stops in a drive period. Grey cells have none of them."
)

HOLDS = (
    "The columns of sweep.csv, shape (n of the second key or 1, n of the first); m is -1 in a failed cell."
)

MOST_SHOWN = 100  # cells on the terminal; all are in the table
STARTS = {"rest": "from the spring at rest", "up": "from the cell below it", "down": "from the cell above it"}


def conditions(scene: Scene, options: Mapping[str, Any]) -> tuple[list[float], float]:
    """Refuse a sweep that cannot be computed, before anything is; the study chooses its modes itself."""
    plan_of(scene, options)
    return [], 0.0


@study(quick={"over": ("excess=-0.01:0.02:7",)}, at=conditions, many_stops=True)
def sweep(
    scene: Scene,
    run: Run,
    *,
    over: Annotated[tuple[str, ...], "KEY=FROM:TO:N or KEY=FROM:TO:N:log, one or two"] = (
        "excess=-0.02:0.06:41",
    ),
    start: Annotated[Literal["rest", "up", "down"], "of a motion: from rest, or carried along"] = "rest",
    frequency: Annotated[float | None, "drive frequency (Hz), as in time_trace by default", HERTZ] = None,
    excess: Annotated[float | None, "F/F_g - 1 (0.013)", Within(-1, 1e6, open=True)] = None,
    amplitude: Annotated[
        float | None, "amplitude of the base (m), instead of the excess", Within(0, 1e3, "m", open=True)
    ] = None,
    fresh: Annotated[bool, "forget what is stored and begin anew"] = False,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    given = {"over": over, "start": start, "frequency": frequency, "excess": excess, "amplitude": amplitude}
    plan = plan_of(scene, given)
    scene = run.choose_modes(*plan.with_modes(scene))
    drive = in_words(plan.fixed)
    run.say(f"{drive}{'; ' * bool(drive)}each motion starts {STARTS[start]}")
    settings = {"over": over, "start": start, "fixed": plan.fixed, "scene": scene.values()}
    name = "-".join([start, *(f"{axis.name}-{len(axis.values)}" for axis in plan.axes)])
    work = partial(column_of, scene=scene, start=start, fixed=plan.fixed)
    columns = stored(run, name, settings, plan.columns(), work, fresh=fresh)
    shape = (-1, len(plan.axes[0].values))
    cells = {each: np.concatenate([one[each] for one in columns]).reshape(shape) for each in NUMBERS}
    rows = rows_of(chain.from_iterable(plan.columns()), cells)
    run.table("sweep", rows, "The cells of the sweep.", of=Cell, show=None if len(rows) <= MOST_SHOWN else ())
    note_failures(run, ((in_words(row.swept), row.reason) for row in rows if row.reason))
    run.arrays("sweep", HOLDS, **{axis.name: axis.values for axis in plan.axes} | cells)
    from studies.experiment.sweep.figure import draw  # matplotlib is slow to import

    run.figure("sweep", draw(plan.axes, cells, drive), CAPTION)
    findings(run, plan, cells)
    return {"rows": rows, "modes": scene.kept_modes, "start": start, **plan.fixed}


def in_words(values: Values) -> str:
    """Names, values and units."""
    return ", ".join(f"{name} {v:.6g} {ALL[name].unit}".removesuffix(" 1") for name, v in values.items())


def rows_of(swept: Iterable[Values], cells: Mapping[str, np.ndarray]) -> list[Cell]:
    """The cells in the order of the grid, the first axis fastest."""
    columns, rows = [values.ravel().tolist() for values in cells.values()], list[Cell]()
    for at, *row in zip(swept, *columns, strict=True):
        numbers = dict(zip(cells, row, strict=True))
        rows.append(Cell(swept=at, **numbers | ({"m": None, "impacts": None} if numbers["reason"] else {})))
    return rows


def findings(run: Run, plan: Plan, cells: Mapping[str, np.ndarray]) -> None:
    """What came out, what began from rest, and a key that changes nothing."""
    done = cells["m"] >= 0
    if done.any():
        share = written(100.0 * float(np.mean(cells["m"][done] > 0)), 3)
        run.finding(f"The motion has a period in {share} % of the cells.")
    if np.any(cells["peak_force"] > 0.0):
        most = written(float(np.nanmax(cells["peak_force"])), 3)
        run.finding(f"The largest contact force of the sweep is {most} N.")
    if plan.start != REST:
        run.say(f"cells that begin from rest: {np.sum(done & ~cells['carried'])}")
    numbers = [values for name, values in cells.items() if name not in ("carried", "reason")]
    for number, axis in enumerate(plan.axes):
        first = [np.broadcast_to(values.take([0], 1 - number), values.shape) for values in numbers]
        if done.any() and all(map(partial(np.array_equal, equal_nan=True), first, numbers)):
            run.warn(f"{axis.name} changes no number of this sweep: the scene may make no use of it")
