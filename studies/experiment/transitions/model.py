"""One transition p1 <-> p_m in each description: born period, end on the way down, orbit diagram."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from beam import ModalModel, Refusal
from contact import ContactError, State
from contact.orbits import fold_excess, onset_m
from studies import letter
from studies.physics.descriptions import (
    TITLES,
    Diagram,
    Strobed,
    born_and_lowered,
    or_none,
    strobed_at,
    up_and_down,
)
from studies.physics.two_parameters import Extracted, extracted
from studies.shell.scene import Scene, beam_at, of_the_letter, single_mode_at

OTHER_EXCESSES = (letter.AMPLITUDE_STABILITY, 1e-2)
"""Where the born period is given as well: the letter's amplitude stability, and well above grazing."""


@dataclass(frozen=True, kw_only=True)
class Transition:
    """What one description gives at one drive frequency; None where it could not be computed."""

    frequency_hz: float
    description: str
    letter: Annotated[int | None, "period in the letter"]
    m: Annotated[int | None, "born period; 0 where the motion did not settle"] = None
    excess_down: Annotated[float | None, "end of the orbit when the drive is lowered, F/F_g − 1"] = None
    ends_by: Annotated[str | None, "kind of that end"] = None
    end_speed: Annotated[float | None, "approach speed of the orbit at its end [m/s]"] = None
    lost: Annotated[float | None, "F/F_g − 1 at which the downward scan had lost the orbit"] = None
    held: Annotated[float | None, "F/F_g − 1 at which the downward scan still held the orbit"] = None
    exact: Annotated[
        float | None,
        "fold without simulation, F/F_g − 1; in closed form, for the two parameters from the beam's kicks",
    ] = None
    born: Annotated[Mapping[str, int], "born period at excess"]
    grazing_amplitude: Annotated[float, "drive amplitude of grazing [m]"]


@dataclass(frozen=True, kw_only=True)
class AtFrequency:
    """The rows of one frequency, what the beam's collisions gave there, and what failed: where and why."""

    rows: list[Transition]
    extracted: Extracted | None
    failures: list[tuple[str, str]]


def lowered(row: Transition, strobed: Strobed, excess: float, cycles: int) -> tuple[Transition, State]:
    """The row with what is born at `excess` and how that ends, and the state on the born orbit."""
    orbit, end = born_and_lowered(strobed, excess, cycles)
    periods = {f"{excess:g}": orbit.m}
    periods |= {f"{other:g}": onset_m(strobed, other, most_cycles=cycles) for other in OTHER_EXCESSES}
    row = replace(row, m=orbit.m, born=periods)
    if end is not None:
        speed = None if end.orbit is None else abs(end.orbit.speed)
        row = replace(row, excess_down=end.excess, ends_by=end.kind, end_speed=speed)
        row = replace(row, lost=end.lost, held=end.held)
    return row, orbit.end


def rows_at(scene: Scene, frequency: float, model: ModalModel) -> AtFrequency:
    """The rows of all descriptions at drive `frequency` [Hz]; those that fail keep None."""
    single, cycles = single_mode_at(scene, frequency).grazing_amplitude(), max(scene.scan.settle_cycles, 1)
    grazing = dict.fromkeys(TITLES, single) | {"beam": beam_at(scene, frequency, model).grazing_amplitude()}
    found, failures, parameters = list[Transition](), list[tuple[str, str]](), None
    own = of_the_letter(scene)
    for name in TITLES:
        row = Transition(
            frequency_hz=frequency,
            description=name,
            letter=letter.PERIODS.get(frequency) if own else None,
            grazing_amplitude=grazing[name],
            born={},
        )
        try:
            strobed = strobed_at(name, scene, frequency, model)
            row, state = lowered(row, strobed, scene.scan.born_excess, cycles)
            if name == "two_parameters" and row.m:
                parameters = extracted(scene, frequency, model, end=state, m=row.m)
                row = replace(row, exact=None if parameters is None else parameters.fold)
            elif name in ("map", "single_mode"):
                row = replace(row, exact=fold_excess(strobed, row.m or 0))
        except (ContactError, Refusal) as error:
            failures.append((f"{frequency:g} Hz, {name}", str(error)))
        found.append(row)
    return AtFrequency(rows=found, extracted=parameters, failures=failures)


Scans = Mapping[str, Mapping[str, Diagram]]
"""Description -> "up" or "down" -> orbit diagram, at one frequency."""


def scans(scene: Scene, model: ModalModel, full: bool, rows: Sequence[Transition]) -> Scans:
    """Upward and downward scan of each description, in proportion to the largest hysteresis in `rows`.

    That is rounded to two digits, so that the last bit of an end moves no amplitude, and none lies on a fold.
    """
    scan = scene.scan
    reach = float(f"{max([scan.narrowest, *(abs(row.excess_down or 0.0) for row in rows)]):.2g}")
    values = np.linspace(-scan.reach_below * reach, scan.reach_above * reach, scan.points)
    maps = {
        row.description: or_none(strobed_at, row.description, scene, row.frequency_hz, model) for row in rows
    }
    return {
        name: up_and_down(
            strobed,
            values,
            early=not full,
            settle_cycles=letter.SETTLE_CYCLES if full else max(scan.settle_cycles, 1),
            record_cycles=scan.record_cycles,
            largest_m=scan.largest_period,
        )
        for name, strobed in maps.items()
        if strobed is not None
    }
