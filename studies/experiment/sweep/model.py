"""The axes of a sweep, its cells, and the motion of one of them.

A cell is the scene with other values of the swept keys, at a drive frequency [Hz] and an amplitude of the
base [m] or an excess [1].  The numbers of a cell are of one period of the orbit on which its motion settles,
m drive periods, or of `WITHOUT` drive periods after the transient if it settles on none up to 64:

    impacts, max N (contact force), max v (approach speed), sum of the losses of all touches / m
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from itertools import product
from typing import Annotated, Any, NamedTuple

import numpy as np

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactKind, ImpactOscillator, State, StroboscopicMap, simulate
from contact.orbits import settle
from studies import letter
from studies.experiment.period_map import SimulatedMap
from studies.physics.least_model import ALWAYS, least_modes
from studies.shell.options import MOST_CELLS
from studies.shell.scene import Scene, beam_at, harmonic, model_of, own_frequency, require_drive_below
from studies.shell.scene.key import ASSUMED, Key, SceneError, shown
from studies.shell.scene.values import KEYS, split
from studies.shell.sweep import Column

WITHOUT = 64  # drive periods whose numbers are given where a motion has no period

ROUNDING = 1e-12  # energy lost over impulse times speed below which a law loses none

REST = "rest"
UNUSED = ("single_mode", "scan")  # sections that do not change the motion of the beam

Values = Mapping[str, float]  # numbers by the names of keys

DRIVE = {
    "frequency": Key(1.0, "Hz", ASSUMED, "drive frequency", 1e-6, 1e7, (), None),
    "excess": Key(0.0, "1", ASSUMED, "excess $F/F_g - 1$", -0.999999, 1e6, (), None),
    "amplitude": Key(0.0, "m", ASSUMED, "amplitude of the base", 1e-12, 1e3, (), None),
}
"""What may be swept besides the keys of the scene."""

ALL = DRIVE | KEYS


class Axis(NamedTuple):
    """The `values` of a name in rising order, with equal ratios if `log`, else equal distances."""

    name: str
    values: tuple[float, ...]
    log: bool


def axis_of(text: str) -> Axis:
    """The axis in KEY=FROM:TO:N or KEY=FROM:TO:N:log."""
    name, _, span = (part.strip() for part in text.partition("="))
    if name not in DRIVE and "." not in name:
        raise InvalidValue(f"--over is {shown(text)}; it must name a key of a scene, {' or '.join(DRIVE)}")
    known = DRIVE.get(name) or KEYS[".".join(split(name))]
    if name.partition(".")[0] in UNUSED or type(known.default) not in (int, float):
        raise SceneError(name, "cannot be swept; --over needs a key that is a number and moves the beam")
    try:
        first, last, count, *form = span.replace(" ", "").split(":")
        low, high, number = *sorted([float(first), float(last)]), int(count)
        right = -math.inf < low < high < math.inf and 2 <= number <= MOST_CELLS and "_" not in span
        if not right or form not in ([], ["log"]) or (form and low <= 0.0):
            raise ValueError
    except ValueError:
        words = "it must be KEY=FROM:TO:N or KEY=FROM:TO:N:log, FROM and TO different, with :log above 0"
        words += f", and N a whole number from 2 to {MOST_CELLS}"
        raise InvalidValue(f"--over is {shown(text)}; {words}") from None
    values = (np.geomspace if form else np.linspace)(low, high, number).tolist()
    for value in values:
        known.checked(name, value)
    return Axis(name, tuple(values), bool(form))


def grid(values: Mapping[str, Sequence[float]]) -> list[Values]:
    """Every combination of the values of the names, the first name's fastest."""
    rows = product(*reversed(list(values.values())))
    return [dict(zip(values, reversed(row), strict=True)) for row in rows]


def plan_of(scene: Scene, options: Mapping[str, Any]) -> tuple[list[Axis], dict[str, float]]:
    """What a command sweeps, and what it fixes of `DRIVE`; refuses a sweep that cannot be computed."""
    harmonic(scene)
    axes = [axis_of(text) for text in options["over"]]
    fixed = {name: options[name] for name in DRIVE if options[name] is not None}
    names = [axis.name for axis in axes] + list(fixed)
    sizes, cells = {"excess", "amplitude"} & {*names}, math.prod(len(axis.values) for axis in axes)
    rules = {
        "--over must name one key or two": not 1 <= len(axes) <= 2,
        "each number must be swept or given once": len({*names}) < len(names),
        "excess (which is swept by default) and amplitude exclude each other": len(sizes) > 1,
        f"at most {MOST_CELLS} cells are computed, not {cells}": cells > MOST_CELLS,
    }
    for words in (rule for rule, broken in rules.items() if broken):
        raise InvalidValue(f"--over and the options name {', '.join(names)}; {words}")
    if not sizes:
        fixed["excess"] = letter.TIME_TRACE_EXCESS
    if "frequency" not in names:
        fixed["frequency"] = own_frequency(scene, letter.TIME_TRACE_HZ)
    return axes, fixed


def with_modes(scene: Scene, axes: Sequence[Axis], fixed: Values) -> tuple[Scene, str]:
    """The scene with as many modes as the ends of the sweep need (``least_model``), and why."""
    ends = {axis.name: axis.values[:: len(axis.values) - 1] for axis in axes}
    if scene.modes.count or "modes.count" in ends:
        return scene, ""
    found, refused = list[tuple[Scene, str]](), list[Refusal]()
    for cell in ({**fixed, **corner} for corner in grid(ends)):
        try:  # modes are chosen with the plate of [stop] alone
            there = replace(scene, stops=()).replace({name: cell[name] for name in cell if name in KEYS})
            found.append(least_modes(there, ALWAYS, [cell["frequency"]], oscillator_at(there, cell).excess))
        except Refusal as error:
            refused.append(error)
    if not found:
        raise refused[0]
    most, why = max(found, key=lambda pair: pair[0].modes.count)
    return scene.replace({"modes.count": most.modes.count}, provenance="least"), why


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One cell; a failed one has no numbers but what is swept."""

    swept: Values
    frequency_hz: float
    excess: float
    amplitude_m: Annotated[float, "amplitude of the base [m]"]
    m: int | None
    impacts: Annotated[int | None, "impacts in a period; in 64 drive periods for a motion without one"]
    peak_force: Annotated[float, "largest contact force [N]; none under Newton's law"]
    approach: Annotated[float, "greatest approach speed [m/s]; none without impacts"]
    energy_lost: Annotated[float, "energy lost at the stops in a drive period [J]"]
    carried: Annotated[bool, "whether the motion starts from the cell before, or else from rest"]
    reason: Annotated[str, "why the cell failed"]


NUMBERS = [entry.name for entry in fields(Cell)][1:]


_model_of = lru_cache(maxsize=1024)(model_of)
BARE = Scene()


def oscillator_at(scene: Scene, cell: Values) -> ImpactOscillator:
    """The beam on its stops, with the values of the cell in place of the scene's."""
    scene = scene.replace({name: cell[name] for name in cell if name in KEYS})
    # cells that share a spring share its modes; the drive is checked below
    spring = replace(scene, stop=BARE.stop, contact=BARE.contact, scan=BARE.scan, stops=())
    model = _model_of(spring.replace({"drive.kind": "none"}))
    require_drive_below(scene, model, cell["frequency"])
    oscillator = beam_at(scene, cell["frequency"], model)
    if "amplitude" in cell:
        return oscillator.with_amplitude(cell["amplitude"])
    return oscillator.with_excess(cell["excess"])


def settled_cell(oscillator: ImpactOscillator, state: State | None, most: int) -> tuple[Values, State]:
    """The numbers of the motion from `state`, or from rest if it is None or refused; and where it ends."""
    several = len(oscillator.stops) > 1
    strobed = (SimulatedMap if several else StroboscopicMap)(oscillator=oscillator)
    try:
        settled = settle(strobed, state or State.rest(oscillator.n_modes), most_cycles=most)
    except Refusal:
        if state is None:
            raise
        return settled_cell(oscillator, None, most)
    end, periods = replace(settled.end, time=0.0), settled.m or WITHOUT
    run = simulate(oscillator, end, periods=periods)
    touches = run.impacts
    lost, given = np.sum(touches.loss), np.nansum(np.abs(touches.impulse * touches.approach))
    numbers = {
        "frequency_hz": oscillator.driven.frequency,
        "excess": oscillator.excess,
        "amplitude_m": oscillator.driven.amplitude,
        "m": settled.m,
        "impacts": int(np.sum((touches.kind == ImpactKind.IMPACT) & np.isfinite(touches.approach))),
        "peak_force": float(np.fmax.reduce(touches.peak_force)) if len(touches) else 0.0,
        "approach": float(np.fmax.reduce(touches.approach, initial=np.nan)),
        "energy_lost": float(lost) / periods if abs(lost) > ROUNDING * given else 0.0,
        "carried": state is not None,
    }
    return numbers, end if settled.m else replace(run.end, time=0.0)


def column_of(cells: Sequence[Values], scene: Scene, start: str, fixed: Values) -> Column:
    """The numbers of some cells, arrays of one length; m and impacts are -1 in a cell that failed."""
    found, state, step = list[dict[str, object]](), None, -1 if start == "down" else 1
    for cell in ({**fixed, **swept} for swept in cells[::step]):
        try:
            oscillator = oscillator_at(scene, cell)
            numbers, end = settled_cell(oscillator, state, max(scene.scan.settle_cycles, 1))
            state = None if start == REST else end
            found.append({**numbers, "excess": cell.get("excess", oscillator.excess), "reason": ""})
        except (ContactError, Refusal) as error:
            reason = str(error) or type(error).__name__
            found.append({"m": -1, "impacts": -1, "carried": False, "reason": reason})
    return {name: np.array([one.get(name, math.nan) for one in found[::step]]) for name in NUMBERS}
