"""Map, Eq. (1) and beam at one drive frequency: born period, end on the way down, scans.

`excess` is F/F_g - 1; the map's own variable x is observed for the map, the tip [m] for Eq. (1), the
read-out [m] for the beam.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beam import ModalModel
from contact import ContactError, StrobedMap, StrobedNordmarkMap, StroboscopicMap
from contact.orbits import OrbitDiagram, born, born_period, fold_excess, orbit_diagram, orbit_end
from studies import letter
from studies.scene import READOUT, Scene, beam_at, nordmark_at, single_mode_at

TITLES = {"map": "Nordmark map", "single_mode": "Eq. (1)", "beam": "beam"}
OTHER_EXCESSES = (2.5e-4, 1e-2)
"""Where the born period is given as well: the letter's amplitude stability, and well above grazing."""


Strobed = StrobedMap[Any]
Diagram = OrbitDiagram[Any]


class Description(NamedTuple):
    """One model at one frequency, and what is drawn of it."""

    strobed: Strobed
    observe: Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, kw_only=True)
class Transition:
    """What one description says at one frequency; None where it could not be computed."""

    period: int | None = None
    excess_down: float | None = None
    ends_by: str | None = None
    bracket: tuple[float, float] | None = None
    also: Mapping[str, int]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One frequency: periods (0: did not settle), ends on the way down [1], the letter's period."""

    frequency_hz: float
    letter: int | None
    map: int | None
    single_mode: int | None
    beam: int | None
    excess_down_map: float | None
    excess_down_single_mode: float | None
    excess_down_beam: float | None
    ends_by_map: str | None
    ends_by_single_mode: str | None
    ends_by_beam: str | None
    exact_map: float | None
    exact_single_mode: float | None
    beam_linear: int | None
    excess_down_beam_linear: float | None
    bracket_map: tuple[float, float] | None
    bracket_single_mode: tuple[float, float] | None
    bracket_beam: tuple[float, float] | None
    born_map: Mapping[str, int]
    born_single_mode: Mapping[str, int]
    born_beam: Mapping[str, int]
    not_settled: list[str]
    grazing_amplitude_m: float

    def periods(self) -> dict[str, int | None]:
        """Born period of each description."""
        return {"map": self.map, "single_mode": self.single_mode, "beam": self.beam}

    def ends(self) -> list[float]:
        """The ends of the three orbits, as far as there are any [1]."""
        found = (self.excess_down_map, self.excess_down_single_mode, self.excess_down_beam)
        return [end for end in found if end is not None]


Scans = Mapping[str, Mapping[str, Diagram]]
"""Description -> "up" or "down" -> orbit diagram, at one frequency."""


def describe(scene: Scene, frequency: float, model: ModalModel) -> dict[str, Description]:
    """The three descriptions at `frequency` [Hz]; displacements are observed in metres."""
    single = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    beam = StroboscopicMap(oscillator=beam_at(scene, frequency, model))
    nordmark = StrobedNordmarkMap(map=nordmark_at(scene, frequency))
    return {
        "map": Description(nordmark, lambda points: points[:, 0]),
        "single_mode": Description(single, single.tip),
        "beam": Description(beam, lambda points: beam.readout(points, READOUT)),
    }


def transition(strobed: Strobed, excess: float, cycles: int) -> Transition:
    """Born periods, 0 where the motion did not settle, and the end of the orbit on the way down."""
    orbit = born(strobed, excess, most_cycles=cycles)
    also = {f"{other:g}": born_period(strobed, other, most_cycles=cycles) for other in OTHER_EXCESSES}
    end = orbit_end(strobed, orbit.end, excess, most_cycles=cycles) if orbit.period > 1 else None
    if end is None:
        return Transition(period=orbit.period, also=also)
    return Transition(
        period=orbit.period, excess_down=end.excess, ends_by=end.kind, bracket=(end.lost, end.held), also=also
    )


def row_at(scene: Scene, frequency: float, model: ModalModel) -> tuple[Row, list[tuple[str, str]]]:
    """One row of the table, and what failed: where, why."""
    cycles, failures = max(scene.scan.settle_cycles, 1), list[tuple[str, str]]()
    described = {name: strobed for name, (strobed, _) in describe(scene, frequency, model).items()}
    if scene.contact.law == "hertz":  # linear contact of the same contact time in place of Hertz's law
        linear = scene.replace({"contact.law": "linear"})
        described["beam_linear"] = StroboscopicMap(oscillator=beam_at(linear, frequency, model))
    found = dict.fromkeys([*TITLES, "beam_linear"], Transition(also={}))
    for name, strobed in described.items():
        try:
            found[name] = transition(strobed, scene.scan.born_excess, cycles)
        except ContactError as error:
            failures.append((f"{frequency:g} Hz, {name}", str(error)))
    exact_map, exact_single = exact_ends(scene, frequency, found["map"].period, found["single_mode"].period)
    columns, not_settled = dict[str, Any](), list[str]()
    for name, title in TITLES.items():
        one = found[name]
        columns |= {name: one.period, f"excess_down_{name}": one.excess_down, f"ends_by_{name}": one.ends_by}
        columns |= {f"bracket_{name}": one.bracket, f"born_{name}": one.also}
        periods = {f"{scene.scan.born_excess:g}": one.period, **one.also}
        not_settled += [f"{title} at {excess}" for excess, period in periods.items() if period == 0]
    row = Row(
        frequency_hz=frequency, letter=letter.PERIODS.get(frequency), **columns, exact_map=exact_map,
        exact_single_mode=exact_single, beam_linear=found["beam_linear"].period,
        excess_down_beam_linear=found["beam_linear"].excess_down, not_settled=not_settled,
        grazing_amplitude_m=beam_at(scene, frequency, model).grazing_amplitude(),
    )  # fmt: skip
    return row, failures


def exact_ends(
    scene: Scene, frequency: float, of_map: int | None, of_single: int | None
) -> tuple[float | None, float | None]:
    """The folds of the p_m orbits in closed form, of the map and of Eq. (1) [1]; no orbit for None, 0, 1."""
    single = StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    of_mapping = fold_excess(StrobedNordmarkMap(map=nordmark_at(scene, frequency)), of_map or 0)
    return of_mapping, fold_excess(single, of_single or 0)


def scans(scene: Scene, row: Row, model: ModalModel, full: bool) -> Scans:
    """Upward and downward scan of each description, in proportion to the largest hysteresis found.

    That is taken to two digits, so that the last bit of an end moves no amplitude, and none lies on a fold.
    """
    scan, found = scene.scan, {}
    reach = float(f"{max([*map(abs, row.ends()), scan.narrowest]):.2g}")
    values = np.linspace(-scan.reach_below * reach, scan.reach_above * reach, scan.points)
    for name, (strobed, observe) in describe(scene, row.frequency_hz, model).items():
        way = partial(
            orbit_diagram, strobed, observe=observe, record_cycles=scan.record_cycles, early=not full,
            settle_cycles=letter.SETTLE_CYCLES if full else max(scan.settle_cycles, 1),
            largest_period=scan.largest_period,
        )  # fmt: skip
        up = way(values, strobed.at(float(values[0])).steady())
        found[name] = {"up": up, "down": way(values[::-1], up.end)}
    return found
