"""Map, Eq. (1), two parameters and beam at one drive frequency: born period, end on the way down, scans.

`excess` is F/F_g - 1; the map's own variable x is observed for the map, the tip for one mode [m], and for
the beam its read-out [m or rad].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import ModalModel, Refusal
from contact import ContactError, State, StrobedMap, StroboscopicMap
from contact.orbits import OrbitDiagram, born, born_period, fold_excess, orbit_diagram, orbit_end
from studies import letter
from studies.physics.two_parameters import Extracted, extracted, two_parameters_at
from studies.shell.scene import READOUT, Scene, beam_at, nordmark_at, single_mode_at

TITLES = {"map": "Nordmark map", "single_mode": "Eq. (1)", "two_parameters": "two parameters", "beam": "beam"}
OTHER_EXCESSES = (2.5e-4, 1e-2)
"""Where the born period is given as well: the letter's amplitude stability, and well above grazing."""

Strobed = StrobedMap[Any]
Diagram = OrbitDiagram[Any]


@dataclass(frozen=True, kw_only=True)
class Transition:
    """What one description says at one frequency; None where it could not be computed."""

    period: int | None = None
    excess_down: float | None = None
    ends_by: str | None = None
    end_speed: float | None = None
    bracket: tuple[float, float] | None = None
    born: Mapping[str, int]
    state: State | None = None


@dataclass(frozen=True, kw_only=True)
class Row:
    """One frequency: periods (0: did not settle), ends on the way down [1], the letter's period.

    `end_speed_beam` is the approach velocity [m/s] of the beam's orbit at its end. It identifies the orbit if
    several of that period exist. `exact_*` is the excess [1] of the fold in closed form; for the two
    parameters it follows from the kicks of mode 1 in the beam's collisions, without a simulation.
    """

    frequency_hz: float
    letter: int | None
    map: int | None
    single_mode: int | None
    two_parameters: int | None
    beam: int | None
    excess_down_map: float | None
    excess_down_single_mode: float | None
    excess_down_two_parameters: float | None
    excess_down_beam: float | None
    ends_by_map: str | None
    ends_by_single_mode: str | None
    ends_by_two_parameters: str | None
    ends_by_beam: str | None
    end_speed_beam: float | None
    exact_map: float | None
    exact_single_mode: float | None
    exact_two_parameters: float | None
    extracted: Extracted | None
    beam_linear: int | None
    excess_down_beam_linear: float | None
    bracket_map: tuple[float, float] | None
    bracket_single_mode: tuple[float, float] | None
    bracket_two_parameters: tuple[float, float] | None
    bracket_beam: tuple[float, float] | None
    born_map: Mapping[str, int]
    born_single_mode: Mapping[str, int]
    born_two_parameters: Mapping[str, int]
    born_beam: Mapping[str, int]
    not_settled: list[str]
    grazing_amplitude_m: float

    def periods(self) -> dict[str, int | None]:
        """Born period of each description."""
        return {name: getattr(self, name) for name in TITLES}


Scans = Mapping[str, Mapping[str, Diagram]]
"""Description -> "up" or "down" -> orbit diagram, at one frequency."""


def describe(
    scene: Scene, frequency: float, model: ModalModel, failures: list[tuple[str, str]] | None = None
) -> dict[str, Strobed]:
    """The four descriptions at `frequency` [Hz]; without two parameters, and why, where there are none."""
    found: dict[str, Strobed] = {
        "map": nordmark_at(scene, frequency),
        "single_mode": StroboscopicMap(oscillator=single_mode_at(scene, frequency)),
        "beam": StroboscopicMap(oscillator=beam_at(scene, frequency, model)),
    }
    try:
        found["two_parameters"] = StroboscopicMap(oscillator=two_parameters_at(scene, frequency, model))
    except (ContactError, Refusal) as error:
        if failures is not None:
            failures.append((f"{frequency:g} Hz, two_parameters", str(error)))
    return found


def observe(strobed: Strobed, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """What is drawn of strobed points."""
    return strobed.readout(points, READOUT) if isinstance(strobed, StroboscopicMap) else points[:, 0]


def transition(strobed: Strobed, excess: float, cycles: int) -> Transition:
    """Born periods, 0 where the motion did not settle, and the end of the orbit on the way down."""
    orbit = born(strobed, excess, most_cycles=cycles)
    also = {f"{other:g}": born_period(strobed, other, most_cycles=cycles) for other in OTHER_EXCESSES}
    end = orbit_end(strobed, orbit.end, excess, most_cycles=cycles) if orbit.period > 1 else None
    if end is None:
        return Transition(period=orbit.period, born=also, state=orbit.end)
    return Transition(
        period=orbit.period,
        excess_down=end.excess,
        ends_by=end.kind,
        end_speed=None if end.orbit is None else abs(end.orbit.speed),
        bracket=(end.lost, end.held),
        born=also,
        state=orbit.end,
    )


def row_at(scene: Scene, frequency: float, model: ModalModel) -> tuple[Row, list[tuple[str, str]]]:
    """One row of the table, and what failed: where, why."""
    cycles, failures = max(scene.scan.settle_cycles, 1), list[tuple[str, str]]()
    described = describe(scene, frequency, model, failures)
    if scene.contact.law == "hertz":  # linear contact of the same contact time in place of Hertz's law
        linear = scene.replace({"contact.law": "linear"})
        described["beam_linear"] = StroboscopicMap(oscillator=beam_at(linear, frequency, model))
    found = dict.fromkeys([*TITLES, "beam_linear"], Transition(born={}))
    for name, strobed in described.items():
        try:
            found[name] = transition(strobed, scene.scan.born_excess, cycles)
        except ContactError as error:
            failures.append((f"{frequency:g} Hz, {name}", str(error)))
    columns, not_settled = dict[str, Any](), list[str]()
    for name, title in TITLES.items():
        one = vars(found[name])
        columns |= {name: one["period"]}
        columns |= {f"{key}_{name}": one[key] for key in ("excess_down", "ends_by", "bracket", "born")}
        periods = {f"{scene.scan.born_excess:g}": one["period"], **one["born"]}
        not_settled += [f"{title} at {excess}" for excess, period in periods.items() if period == 0]
    for name in ("map", "single_mode"):  # closed forms; there is none of p1
        columns[f"exact_{name}"] = fold_excess(described[name], found[name].period or 0)
    two = found["two_parameters"]
    parameters = None
    if two.state is not None and two.period:
        try:
            parameters = extracted(scene, frequency, model, end=two.state, period=two.period)
        except ContactError as error:
            failures.append((f"{frequency:g} Hz, parameters extracted", str(error)))
    row = Row(
        frequency_hz=frequency,
        letter=letter.PERIODS.get(frequency),
        **columns,
        extracted=parameters,
        exact_two_parameters=None if parameters is None else parameters.fold,
        beam_linear=found["beam_linear"].period,
        not_settled=not_settled,
        excess_down_beam_linear=found["beam_linear"].excess_down,
        end_speed_beam=found["beam"].end_speed,
        grazing_amplitude_m=beam_at(scene, frequency, model).grazing_amplitude(),
    )
    return row, failures


def scans(scene: Scene, row: Row, model: ModalModel, full: bool) -> Scans:
    """Upward and downward scan of each description, in proportion to the largest hysteresis found.

    That is taken to two digits, so that the last bit of an end moves no amplitude, and none lies on a fold.
    """
    scan, found = scene.scan, {}
    ends = [abs(getattr(row, f"excess_down_{name}") or 0.0) for name in TITLES]
    reach = float(f"{max([*ends, scan.narrowest]):.2g}")
    values = np.linspace(-scan.reach_below * reach, scan.reach_above * reach, scan.points)
    for name, strobed in describe(scene, row.frequency_hz, model).items():
        way = partial(
            orbit_diagram,
            strobed,
            observe=partial(observe, strobed),
            early=not full,
            settle_cycles=letter.SETTLE_CYCLES if full else max(scan.settle_cycles, 1),
            record_cycles=scan.record_cycles,
            largest_period=scan.largest_period,
        )
        up = way(values, strobed.at(float(values[0])).steady())
        found[name] = {"up": up, "down": way(values[::-1], up.end)}
    return found
