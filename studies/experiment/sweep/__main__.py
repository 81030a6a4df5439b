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
Writes:  sweep.csv (one row a cell), sweep.png; for two keys sweep.npz (arrays on the grid)
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, make_dataclass
from functools import partial
from itertools import product
from typing import Annotated, Any, Literal

import numpy as np

from studies import letter
from studies.experiment.sweep.model import ALL, DRIVE, NUMBERS, REST, Axis, Cell, Plan, axis_of, column_of
from studies.shell.digits import written
from studies.shell.options import HERTZ, Within
from studies.shell.scene import Scene, harmonic, own_frequency
from studies.shell.study import Run, study
from studies.shell.sweep import note_failures
from studies.shell.sweep import sweep as stored

CAPTION = (
    "Settled motion over the swept numbers: period, impacts, largest force, greatest approach speed, and "
    "energy lost at the stops in a drive period. Grey cells have none of them."
)

MOST_SHOWN = 100  # cells on the terminal; all are in the table
STARTS = {"rest": "from the spring at rest", "up": "from the cell below it", "down": "from the cell above it"}


def plan_of(scene: Scene, options: Mapping[str, Any]) -> Plan:
    """The sweep of the command; refuses one that cannot be computed."""
    harmonic(scene)
    axes = tuple(axis_of(text) for text in options["over"])
    swept = {axis.name for axis in axes}
    fixed = {name: options[name] for name in DRIVE if options[name] is not None}
    if not {"excess", "amplitude"} & {*fixed, *swept}:
        fixed["excess"] = letter.TIME_TRACE_EXCESS
    if "frequency" not in {*fixed, *swept}:
        fixed["frequency"] = own_frequency(scene, letter.TIME_TRACE_HZ)
    return Plan(axes=axes, start=options["start"], fixed=fixed)


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
    drive = ", ".join(f"{name} {in_units(name, value)}" for name, value in plan.fixed.items())
    run.say(f"{drive}{'; ' * bool(drive)}each motion starts {STARTS[start]}")
    settings = {"over": over, "start": start, "fixed": plan.fixed, "scene": scene.values()}
    name = "-".join([start, *(f"{axis.name}-{len(axis.values)}" for axis in plan.axes)])
    work = partial(column_of, scene=scene, start=start)
    columns = stored(run, name, settings, plan.columns(), work, fresh=fresh)
    cells = plan.on_grid(columns)
    kind = kind_of(plan.axes)
    rows = rows_of(plan.axes, cells, kind)
    shown = [entry.name for entry in fields(kind) if entry.name not in ("carried", "reason")]
    run.table(
        "sweep", rows, "The cells of the sweep.", of=kind, show=shown if len(rows) <= MOST_SHOWN else ()
    )
    note_failures(run, failures(plan.axes, rows))
    if len(plan.axes) == 2:
        holds = (
            "The columns of sweep.csv, shape (n of the second key, n of the first); m -1 in a failed cell."
        )
        places = {axis.name: axis.values for axis in plan.axes if axis.name not in DRIVE}
        run.arrays("sweep", holds, **places, **cells)
    from studies.experiment.sweep.figure import draw  # matplotlib is slow to import

    run.figure("sweep", draw(plan.axes, cells, drive), CAPTION)
    findings(run, plan, cells)
    return {"rows": rows, "modes": scene.kept_modes, "start": start, **plan.fixed}


def in_units(name: str, value: float) -> str:
    """A value with the unit of its name."""
    unit = ALL[name].unit
    return f"{value:.6g} {unit if unit != '1' else ''}".rstrip()


def kind_of(axes: Sequence[Axis]) -> type[Cell]:
    """The cells with a column for each key of the scene that is swept, before the others."""
    keys = {axis.name: axis.unit for axis in axes if axis.name not in DRIVE}
    words = {name: f"{name} [{unit}]" if unit not in ("", "1") else name for name, unit in keys.items()}
    entries = [(name.replace(".", "_"), Annotated[float, text]) for name, text in words.items()]
    swept = make_dataclass("Swept", entries, frozen=True, kw_only=True)
    return make_dataclass("Cell", [], bases=(Cell, swept), frozen=True, kw_only=True)


def rows_of(axes: Sequence[Axis], cells: Mapping[str, np.ndarray], kind: type[Cell]) -> list[Cell]:
    """The cells in the order of the grid, the first axis fastest."""
    rows, keys = list[Cell](), [axis.name.replace(".", "_") for axis in axes]
    known = {entry.name for entry in fields(kind)}
    values = product(*(axis.values for axis in reversed(axes)))
    for place, swept in enumerate(values):
        cell = {name: numbers.flat[place].item() for name, numbers in cells.items()}
        at = dict(zip(keys, reversed(swept), strict=True))
        failed = {"m": None, "impacts": None} if cell["reason"] else {}
        rows.append(kind(**cell | failed | {name: at[name] for name in at.keys() & known}))
    return rows


def failures(axes: Sequence[Axis], rows: Sequence[Cell]) -> Iterator[tuple[str, str]]:
    """Where cells failed, and why."""
    places = product(*(axis.values for axis in reversed(axes)))
    for row, place in zip(rows, places, strict=True):
        if row.reason:
            where = zip(axes, reversed(place), strict=True)
            yield ", ".join(f"{axis.name} {in_units(axis.name, value)}" for axis, value in where), row.reason


def findings(run: Run, plan: Plan, cells: Mapping[str, np.ndarray]) -> None:
    """What came out, what began from rest, and a key that changes nothing."""
    done = cells["m"] >= 0
    if done.any():
        share = written(100.0 * float(np.mean(cells["m"][done] > 0)), 3)
        run.finding(f"The motion has a period in {share} % of the cells.")
        if np.any(cells["peak_force"] > 0.0):
            most = written(float(np.nanmax(cells["peak_force"])), 3)
            run.finding(f"The largest contact force of the sweep is {most} N.")
    later = np.s_[:, :-1] if plan.start == "down" else np.s_[:, 1:]
    anew = np.sum(done[later] & ~cells["carried"][later])
    if plan.start != REST and anew:
        run.say(f"cells that begin from rest, as the motion before cannot start there: {anew}")
    for axis, name in enumerate(one.name for one in plan.axes):
        along = [np.moveaxis(cells[key], 1 - axis, 0) for key in NUMBERS if key not in ("carried", "reason")]
        if len(along[0]) > 1 and all(np.all((v == v[:1]) | (v != v) & (v[:1] != v[:1])) for v in along):
            run.warn(f"{name} changes no number of this sweep: the scene may make no use of it")
