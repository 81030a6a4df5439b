"""The descriptions of the experiment by name, and what each of them gives: strobed map, fold of p_m, scans.

    map              Eqs. (2), (3) of the letter, corrected
    single_mode      Eq. (1) of the letter
    two_parameters   Eq. (1) with the restitution and the delay of the beam's collisions
    kicks            all modes; each collision is entered without the ringing of the one before
    beam             all modes

Each has at a drive frequency a family of orbits p_m with one impact in m drive periods, which ends at a
fold (`fold_at`). All but the kicks, which describe orbits and no motion, have a strobed map (`strobed_at`).
`contact.orbits.onset_orbit` gives the orbit of that map that is born at grazing.

The folds come by closed form (map, Eq. (1)), from what each collision of the beam does to mode 1 (two
parameters) or to all modes (kicks), and by shooting (beam).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue, ModalModel, Refusal
from contact import (
    ContactError,
    ImpactOscillator,
    MaximalFamily,
    SingleImpactOrbit,
    StrobedMap,
    StroboscopicMap,
)
from contact.orbits import (
    KickFamily,
    OrbitDiagram,
    OrbitEnd,
    Settled,
    fold_excess,
    onset_orbit,
    orbit_diagram,
    orbit_end,
)
from studies.physics.two_parameters import fold_of_kicks, two_parameters_at
from studies.shell.scene import READOUT, Scene, beam_at, nordmark_at, single_mode_at

TITLES = {"map": "Nordmark map", "single_mode": "Eq. (1)", "two_parameters": "two parameters", "beam": "beam"}
"""The descriptions with a strobed map, from the shortest to the fullest, and how figures name them."""

BELOW = -1e-3  # excess of the motion without impacts from which a motion above grazing starts [1]

ROUNDING = 1e-12  # change of an excess that is rounding [1]

Strobed = StrobedMap[Any]
Diagram = OrbitDiagram[Any]

P = ParamSpec("P")
S = TypeVar("S")
T = TypeVar("T")


def strobed_at(name: str, scene: Scene, frequency: float, model: ModalModel | None = None) -> Strobed:
    """The strobed map of a description at drive `frequency` [Hz]; `model` saves computing the modes again."""
    if name == "map":
        return nordmark_at(scene, frequency)
    if name == "single_mode":
        return StroboscopicMap(oscillator=single_mode_at(scene, frequency))
    make = {"two_parameters": two_parameters_at, "beam": beam_at}.get(name)
    if make is None:
        raise InvalidValue(f"name is {name!r}; descriptions with a strobed map are {', '.join(TITLES)}")
    return StroboscopicMap(oscillator=make(scene, frequency, model))


def fold_at(
    name: str, scene: Scene, frequency: float, m: int, model: ModalModel | None = None
) -> float | None:
    """F_m/F_g - 1 at the fold of p_m with one impact, `m` drive periods; None without one, and for m < 2."""
    if name not in ("two_parameters", "kicks"):
        return fold_excess(strobed_at(name, scene, frequency, model), m)
    beam = beam_at(scene, frequency, model)
    if name == "kicks":
        return kick_fold(StroboscopicMap(oscillator=beam), m)
    return fold_of_kicks(KickFamily(oscillator=beam, m=m)) if m > 1 else None


def fold_orbit(oscillator: ImpactOscillator, m: int) -> SingleImpactOrbit | None:
    """The orbit p_m at its fold under Newton's law, in closed form; None if there is none."""
    return MaximalFamily.from_oscillator(oscillator, m=m).fold()


def kick_fold(strobed: StroboscopicMap, m: int) -> float | None:
    """The fold of p_m by the kick that a collision gives all modes, without simulation of the orbit."""
    found = KickFamily(oscillator=strobed.oscillator, m=m).fold() if m > 1 else None
    return None if found is None else found.excess


def observe(strobed: Strobed, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """What is drawn of strobed points: x of the map, the read-out of Eq. (1) or of the beam [m or rad]."""
    return strobed.readout(points, READOUT) if isinstance(strobed, StroboscopicMap) else points[:, 0]


def up_and_down(strobed: Strobed, excesses: NDArray[np.float64], **settings: Any) -> dict[str, Diagram]:
    """The orbit diagrams of `both_ways`.

    `settings` are options of `contact.orbits.orbit_diagram`; by default it observes as `observe` does.
    """
    settings = {"observe": partial(observe, strobed), **settings}

    def scan(_way: str, values: NDArray[np.float64], state: object) -> tuple[Diagram, object]:
        found = orbit_diagram(strobed, values, state, **settings)
        return found, found.end

    return both_ways(strobed, excesses, scan)


def both_ways(
    strobed: StrobedMap[S],
    excesses: NDArray[np.float64],
    scan: Callable[[str, NDArray[np.float64], S], tuple[T, S]],
) -> dict[str, T]:
    """The upward scan from the motion without impacts, and the downward scan from where that ends.

    `scan(way, excesses, state)`, `way` "up" or "down", returns what it found and the state at its end.
    """
    state, found = strobed.at(float(excesses[0]) if excesses[0] < 0.0 else BELOW).steady(), dict[str, T]()
    for way, values in (("up", excesses), ("down", excesses[::-1])):
        found[way], state = scan(way, values, state)
    return found


@dataclass(frozen=True)
class StrobePoint:
    """A strobed point of a scan: one period of a settled motion, all that was recorded of another."""

    frequency_hz: float
    description: str
    direction: Annotated[str, "direction of the scan"]
    amplitude: Annotated[float, "drive amplitude [m]"]
    excess: float
    m: int
    strobe: Annotated[int, "number of the strobe"]
    value: Annotated[float, "strobed read-out; m, or rad for a rotation, or for the map its x, a pure number"]


def strobe_points_of(f: float, name: str, grazing: float, ways: Mapping[str, Diagram]) -> list[StrobePoint]:
    """The points of scans by their directions at drive `f` [Hz]; `grazing` is the grazing amplitude [m]."""
    return [
        StrobePoint(f, name, way, grazing * (1.0 + excess), excess, period, number, value)
        for way, scan in ways.items()
        for excess, period, points in zip(scan.excess.tolist(), scan.m.tolist(), scan.points, strict=True)
        for number, value in enumerate(points[: period or None].tolist())
    ]


def born_and_lowered(
    strobed: Strobed, excess: float, most_cycles: int
) -> tuple[Settled[Any], OrbitEnd[Any] | None]:
    """The orbit that is born at `excess`, and its end when the amplitude is lowered; None for p1 and none."""
    orbit = onset_orbit(strobed, excess, most_cycles=most_cycles)
    if orbit.m < 2:
        return orbit, None
    return orbit, orbit_end(strobed, orbit.end, excess, most_cycles=most_cycles)


def or_none(function: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T | None:
    """The value of the function, or None where it cannot be computed (a ContactError or a Refusal)."""
    try:
        return function(*arguments, **options)
    except (ContactError, Refusal):
        return None


def falls(excesses: Sequence[float]) -> bool:
    """Whether no value exceeds the one before it by more than rounding; a NaN does not fall."""
    return bool(np.all(np.diff(excesses) <= ROUNDING))


def word(m: int | None) -> str:
    """A period in words: "p4"; "no period up to 64" for 0, a motion that did not settle; "-" for None."""
    return "-" if m is None else f"p{m}" if m else "no period up to 64"


def words(periods: Mapping[str, int | None]) -> str:
    """The periods of several descriptions in words."""
    return ", ".join(f"{TITLES[name]} {word(period)}" for name, period in periods.items())
