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
from typing import Annotated

import numpy as np

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactKind, ImpactOscillator, Regime, State, StroboscopicMap, simulate
from contact.orbits import settle
from studies.experiment.period_map import SimulatedMap
from studies.physics.least_model import ALWAYS, least_modes
from studies.shell.options import MOST_CELLS
from studies.shell.scene import Scene, SceneError, beam_at, model_of, require_drive_below
from studies.shell.scene.key import Key, key, shown
from studies.shell.scene.values import KEYS, split
from studies.shell.sweep import Column

WITHOUT = 64  # drive periods whose numbers are given where a motion has no period

MOST_COLUMNS = 256  # files of finished cells, where any cell can be computed alone

ROUNDING = 1e-12  # energy lost over impulse times speed below which a law loses none

REST = "rest"
UNUSED = ("single_mode", "scan")  # sections that do not change the motion of the beam

Values = Mapping[str, float]  # what a cell has in place of the scene's values, and its drive, by name


@dataclass(frozen=True, kw_only=True)
class DriveKeys:
    """What may be swept besides the keys of the scene."""

    frequency: float = key(1.0, "Hz", "drive frequency", low=1e-6)
    excess: float = key(0.0, "1", "excess F/F_g - 1", low=-0.999999, high=1e6)
    amplitude: float = key(0.0, "m", "amplitude of the base", low=1e-12)


DRIVE: dict[str, Key] = {entry.name: entry.metadata["key"] for entry in fields(DriveKeys)}
ALL = DRIVE | KEYS


@dataclass(frozen=True, kw_only=True)
class Axis:
    """The `values` of a name in rising order; `even` if they have equal distances, else equal ratios."""

    name: str
    values: tuple[float, ...]
    even: bool

    @property
    def unit(self) -> str:
        """Its unit; 1 for a pure number."""
        return ALL[self.name].unit


def axis_of(text: str) -> Axis:
    """The axis in KEY=FROM:TO:N or KEY=FROM:TO:N:log."""
    name, _, span = (part.strip() for part in text.partition("="))
    if name not in DRIVE and "." not in name:
        raise InvalidValue(f"over is {shown(text)}; it must name a key of a scene, {' or '.join(DRIVE)}")
    known = DRIVE.get(name) or KEYS[".".join(split(name))]
    if name.partition(".")[0] in UNUSED or type(known.default) not in (int, float):
        raise SceneError(name, "cannot be swept; over needs a key that is a number and moves the beam")
    try:
        first, last, count, *form = (part.strip() for part in span.split(":"))
        (low, high), number, even = sorted([float(first), float(last)]), int(count), form != ["log"]
        if form not in ([], ["log"]) or "_" in span:
            raise ValueError
    except ValueError:
        words = "it must be KEY=FROM:TO:N, or KEY=FROM:TO:N:log for equal ratios"
        raise InvalidValue(f"over is {shown(text)}; {words}") from None
    known.checked(name, low), known.checked(name, high)
    if not 1 <= number <= MOST_CELLS or (low == high) != (number == 1):
        words = f"N must be a whole number from 2 to {MOST_CELLS}, and 1 only where FROM = TO"
        raise InvalidValue(f"over is {shown(text)}; {words}")
    if not even and low <= 0.0:
        raise InvalidValue(f"over is {shown(text)}; with :log FROM and TO must be above 0")
    places = (np.linspace if even else np.geomspace)(low, high, number).tolist()
    for place in places:
        known.checked(name, place)
    return Axis(name=name, values=tuple(places), even=even)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """One axis or two, how a motion `start`s, and what is `fixed` of frequency, excess and amplitude."""

    axes: tuple[Axis, ...]
    start: str
    fixed: Values

    def __post_init__(self) -> None:
        names = [axis.name for axis in self.axes]
        if len(names) not in (1, 2) or len({*names}) < len(names):
            raise InvalidValue(f"over has {', '.join(names)}; it must name one key, or two different ones")
        cells = math.prod(len(axis.values) for axis in self.axes)
        if cells > MOST_CELLS:
            raise InvalidValue(f"over makes {cells} cells; at most {MOST_CELLS} are computed")
        given = sorted([*names, *self.fixed])
        if both := sorted({name for name in given if given.count(name) > 1}):
            raise InvalidValue(f"{both[0]} is given and swept: leave out one of them")
        if {"excess", "amplitude"} <= {*given}:
            words = "over sweeps the excess by default; leave out one of them"
            raise InvalidValue(f"excess and amplitude are both given or swept: {words}")

    def columns(self) -> list[list[Values]]:
        """The cells by what is computed together: the first axis where the state is carried, else few."""
        first, *others = self.axes
        order = first.values[::-1] if self.start == "down" else first.values
        names = [axis.name for axis in others]
        rest = [dict(zip(names, values, strict=True)) for values in product(*(a.values for a in others))]
        lines: list[list[Values]] = [[{**self.fixed, first.name: x, **one} for x in order] for one in rest]
        if self.start != REST:
            return lines
        cells = [cell for line in lines for cell in line]
        size = math.ceil(len(cells) / MOST_COLUMNS)
        return [cells[k : k + size] for k in range(0, len(cells), size)]

    def on_grid(self, columns: Sequence[Column]) -> dict[str, np.ndarray]:
        """The numbers of all cells, shape (n of the second axis or 1, n of the first), both rising."""
        shape, step = (-1, len(self.axes[0].values)), -1 if self.start == "down" else 1
        return {
            name: np.concatenate([column[name] for column in columns]).reshape(shape)[:, ::step]
            for name in columns[0]
        }

    def with_modes(self, scene: Scene) -> tuple[Scene, str]:
        """The scene with as many modes as the ends of the sweep need (``least_model``), and why."""
        if scene.modes.count or "modes.count" in (axis.name for axis in self.axes):
            return scene, ""
        names, found = [axis.name for axis in self.axes], list[tuple[Scene, str]]()
        refused: Refusal | None = None
        for values in product(*((axis.values[0], axis.values[-1]) for axis in self.axes)):
            cell = {**self.fixed, **dict(zip(names, values, strict=True))}
            try:  # modes are chosen with the plate of [stop] alone
                there = scene_of(replace(scene, stops=()), cell)
                excess = oscillator_at(there, cell).excess
                found.append(least_modes(there, ALWAYS, [cell["frequency"]], excess))
            except Refusal as error:
                refused = refused or error
        if not found and refused:
            raise refused
        most, why = max(found, key=lambda pair: pair[0].modes.count)
        return scene.replace({"modes.count": most.modes.count}, provenance="least"), why


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One cell; a failed one has no numbers."""

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


NUMBERS = tuple(entry.name for entry in fields(Cell))


def scene_of(scene: Scene, cell: Values) -> Scene:
    """The scene with the values of the cell in place of its own."""
    return scene.replace({name: value for name, value in cell.items() if name in KEYS})


_model_of = lru_cache(maxsize=1024)(model_of)
BARE = Scene()


def oscillator_at(scene: Scene, cell: Values) -> ImpactOscillator:
    """The beam of the scene on its stops, driven as in the cell."""
    # of what the modes depend on: the drive is checked below, and cells that share a spring share its modes
    spring = replace(scene, stop=BARE.stop, contact=BARE.contact, scan=BARE.scan, stops=())
    model = _model_of(spring.replace({"drive.kind": "none"}))
    require_drive_below(scene, model, cell["frequency"])
    oscillator = beam_at(scene, cell["frequency"], model)
    if "amplitude" in cell:
        return oscillator.with_amplitude(cell["amplitude"])
    return oscillator.with_excess(cell["excess"])


def can_start(oscillator: ImpactOscillator, state: State) -> bool:
    """Whether a motion without contact lies before all stops, and the number of modes is the same."""
    if state.displacement.size != oscillator.n_modes:
        return False
    touching = any(regime != Regime.OUTSIDE for regime in state.regimes.values())
    return touching or bool(oscillator.heights(state.displacement).max() <= 0.0)


def settled_cell(oscillator: ImpactOscillator, state: State | None, most_cycles: int) -> tuple[Cell, State]:
    """The cell of the motion from `state`, or from rest if it is None or cannot start there; and its end."""
    several = len(oscillator.stops) > 1
    strobed = (SimulatedMap if several else StroboscopicMap)(oscillator=oscillator)
    started = state if state is not None and can_start(oscillator, state) else None
    try:
        settled = settle(strobed, started or State.rest(oscillator.n_modes), most_cycles=most_cycles)
    except Refusal:
        if started is None:
            raise
        return settled_cell(oscillator, None, most_cycles)
    end = replace(settled.end, time=0.0)
    periods = settled.m or WITHOUT
    run = simulate(oscillator, end, periods=periods)
    touches, driven = run.impacts, oscillator.driven
    lost, given = np.sum(touches.loss), np.nansum(np.abs(touches.impulse * touches.approach))
    cell = Cell(
        frequency_hz=driven.frequency,
        excess=oscillator.excess,
        amplitude_m=driven.amplitude,
        m=settled.m,
        impacts=int(np.sum((touches.kind == ImpactKind.IMPACT) & np.isfinite(touches.approach))),
        peak_force=float(np.fmax.reduce(touches.peak_force)) if len(touches) else 0.0,
        approach=float(np.fmax.reduce(touches.approach, initial=np.nan)),
        energy_lost=float(lost) / periods if abs(lost) > ROUNDING * given else 0.0,
        carried=started is not None,
        reason="",
    )
    return cell, end if settled.m else replace(run.end, time=0.0)


def column_of(cells: Sequence[Values], scene: Scene, start: str) -> Column:
    """The numbers of some cells, arrays of one length; m and impacts are -1 in a cell that failed."""
    found, state = list[Cell](), None
    most = max(scene.scan.settle_cycles, 1)
    for cell in cells:
        try:
            numbers, end = settled_cell(oscillator_at(scene_of(scene, cell), cell), state, most)
            numbers = replace(numbers, excess=cell.get("excess", numbers.excess))
            state = None if start == REST else end
        except (ContactError, Refusal) as error:
            numbers = failed_cell(cell, str(error) or type(error).__name__)
        found.append(numbers)
    return {name: np.array([getattr(numbers, name) for numbers in found]) for name in NUMBERS}


def failed_cell(cell: Values, reason: str) -> Cell:
    """The cell without numbers."""
    drive = {"frequency_hz": cell["frequency"], "excess": cell.get("excess", math.nan)}
    none = dict.fromkeys(("peak_force", "approach", "energy_lost"), math.nan)
    amplitude = cell.get("amplitude", math.nan)
    return Cell(**drive, amplitude_m=amplitude, m=-1, impacts=-1, **none, carried=False, reason=reason)
