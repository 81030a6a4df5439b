"""One parameter of the scene is changed at a time: born period and fold at each frequency.

T and mu change within the letter's errors, tau between 0.05 and 0.15, and then the assumptions on the spring.
A change of the spring adapts the thickness of the sheet, which keeps T; decay rate of mode 1, gap and mass
stay.  The fold after a change is that of the p_m that is born without it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from beam import ModalModel
from contact.orbits import fold_excess, onset_m
from studies.letter import BREAKDOWN, FREE_PERIOD_ERROR_S
from studies.physics.calibration import calibrate_damping, calibrate_thickness, free_period
from studies.physics.descriptions import or_none, strobed_at
from studies.shell.digits import minus
from studies.shell.scene import Scene, model_of

DESCRIPTIONS = {"map": "map", "single_mode": "Eq. (1)", "beam": "beam"}


@dataclass(frozen=True, kw_only=True)
class Change:
    """A parameter lowered (`sign` -1) or raised (1).

    ``by`` is added to its key, in ``unit``; without a unit it is a factor.  Without a key the factor acts on
    the decay rates above the first.  With ``tune`` the thickness of the sheet is fitted to T again.
    """

    parameter: str
    key: str
    sign: int
    by: float
    unit: str | None
    tune: bool

    @property
    def text(self) -> str:
        """The change for a person."""
        if self.unit is None:
            return f"× {self.by:g}"
        by, unit = (1e3 * self.by, "ms") if self.unit == "s" else (self.by, self.unit)
        return minus(f"{by:+g} {unit}").rstrip()

    def __str__(self) -> str:
        return f"{self.parameter} {self.text}"

    def value(self, scene: Scene) -> float:
        """The new value of the key."""
        before = scene.number(self.key)
        value = before * self.by if self.unit is None else before + self.by
        return max(1, round(value)) if self.key == "modes.count" else value


def _both(
    parameter: str, key: str, lower: float, higher: float, unit: str | None = None, *, tune: bool = False
) -> list[Change]:
    """The change down and the change up."""
    return [
        Change(parameter=parameter, key=key, sign=sign, by=by, unit=unit, tune=tune)
        for sign, by in ((-1, lower), (1, higher))
    ]


RATE_ERROR = BREAKDOWN["decay_rate_error_per_s"]
PARAMETERS = (
    _both(
        "free period", "single_mode.free_period_s", -FREE_PERIOD_ERROR_S, FREE_PERIOD_ERROR_S, "s", tune=True
    ),
    _both("decay rate of mode 1", "single_mode.decay_rate_per_s", -RATE_ERROR, RATE_ERROR, "1/s"),
    _both("restitution of Eq. (1)", "single_mode.restitution", -0.05, 0.05, ""),
    _both("damping of higher modes", "", 0.5, 2.0),
    _both("mass of ball and mount", "tip.mass_kg", 0.8, 1.2, tune=True),
    _both("gap", "stop.gap_m", 0.8, 1.25),
    _both("radius of the ball", "tip.ball_radius_m", 0.5, 2.0),
    _both("radius of the bend", "spring.bend_radius_m", 0.7, 1.3, tune=True),
    _both("width of the strip", "spring.width_m", 0.7, 1.3, tune=True),
    _both("modulus of the tape", "spring.tape_modulus_pa", 0.5, 2.0, tune=True),
    _both("coverage of the tape", "spring.tape_coverage", 0.75, 1.25, tune=True),
    _both("number of modes", "modes.count", -5, 5, ""),
)
"""The letter's errors, then the assumptions; the small form takes the first four."""


def changes_of(scene: Scene, quick: bool = False) -> list[Change]:
    """All changes down, then all up; a coverage beyond the whole leg is left out."""
    found = [pair[way] for way in (0, 1) for pair in PARAMETERS[: 4 if quick else None]]
    return [c for c in found if c.key != "spring.tape_coverage" or c.value(scene) <= 1.0]


def changed(scene: Scene, change: Change) -> tuple[Scene, ModalModel]:
    """Scene and modes after a change."""
    key, period = change.key, free_period(scene)
    if key:
        value = change.value(scene)
        scene = scene.replace({key: value})
    if key == "single_mode.free_period_s":
        period = value
    elif key == "single_mode.decay_rate_per_s" and scene.damping.kind == "strips":
        scene = scene.replace({"damping.decay_rate_per_s": value})
    elif key == "single_mode.decay_rate_per_s":
        scene = calibrate_damping(scene, value)
    if change.tune:
        scene = calibrate_thickness(scene, period)
    model = model_of(scene)
    rates = model.decay_rate.copy()
    rates[1:] *= 1.0 if key else change.by
    return scene, replace(model, decay_rate=rates)


@dataclass(frozen=True, kw_only=True)
class Transition:
    """The transition at one frequency in one description after one change."""

    frequency_hz: float
    description: str
    parameter: Annotated[str, "changed parameter"] = "none"
    change: Annotated[str, "change; × is a factor"] = ""
    sign: Annotated[int, "direction of the change; −1 for lowered, 1 for raised"] = 0
    m: Annotated[int, "period born without the change; 0 for none"]
    born: Annotated[int | None, "period born with it at excess 0.001; 0 where the motion does not settle"]
    fold: Annotated[float | None, "fold of p_m, F/F_g − 1; where p_m ends as the drive is lowered"]


def transitions_at(
    scene: Scene, model: ModalModel, frequency: float, periods: Sequence[int] | None = None
) -> list[Transition]:
    """The transition in map, Eq. (1) and beam; `periods` are the m of each, by default what is born."""
    found = list[Transition]()
    for k, (name, words) in enumerate(DESCRIPTIONS.items()):
        strobed = strobed_at(name, scene, frequency, model)
        born = or_none(onset_m, strobed)
        m = (born or 0) if periods is None else periods[k]
        fold = or_none(fold_excess, strobed, m)
        found.append(Transition(frequency_hz=frequency, description=words, m=m, born=born, fold=fold))
    return found


def transitions_after(scene: Scene, base: Sequence[Transition], change: Change) -> list[Transition]:
    """The transitions of `base` after a change; SceneError if the scene does not allow it."""
    there, model = changed(scene, change)
    found = list[Transition]()
    for frequency in dict.fromkeys(row.frequency_hz for row in base):
        periods = [row.m for row in base if row.frequency_hz == frequency]
        found += [
            replace(row, parameter=change.parameter, change=change.text, sign=change.sign)
            for row in transitions_at(there, model, frequency, periods)
        ]
    return found
