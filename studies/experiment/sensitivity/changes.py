"""One parameter of the scene changed at a time, and what it does to born period and fold at one frequency.

T, mu within the letter's errors, tau between 0.05 and 0.15, and the free assumptions of the spring. A change
of the spring goes with the thickness of the sheet that keeps T; the rate of mode 1, gap and mass stay. A
hysteresis is compared with that of the same p_m before the change, whatever is born after it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from beam import ModalModel
from contact import ContactError, StroboscopicMap
from contact.orbits import born_period, fold_excess
from studies.letter import BREAKDOWN, FREE_PERIOD_ERROR_S
from studies.physics.calibration import calibrate_damping, calibrate_thickness, free_period
from studies.shell.scene import Scene, beam_at, model_of, nordmark_at, single_mode_at

NAMES = ("map", "single_mode", "beam")

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class Change:
    """A parameter lowered (`sign` -1) or raised (1): `by` is added to its key, in `unit`, or a factor on it
    where there is no unit.

    Without a key the factor is on the decay rates above the first. `tune`: the sheet is fitted to the free
    period again.
    """

    parameter: str
    key: str
    sign: int
    by: float
    unit: str | None
    tune: bool

    @property
    def text(self) -> str:
        """The change for a table."""
        return f"x {self.by:g}" if self.unit is None else f"{self.by:+g} {self.unit}".rstrip()

    def __str__(self) -> str:
        return f"{self.parameter} {self.text}"

    def value(self, scene: Scene) -> float:
        """What the key becomes."""
        before = scene.number(self.key)
        value = before * self.by if self.unit is None else before + self.by
        return max(1, round(value)) if self.key == "modes.count" else value


def _both(
    parameter: str, key: str, lower: float, higher: float, unit: str | None = None, *, tune: bool = False
) -> list[Change]:
    """Lowered and raised."""
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
"""The letter's errors, then the assumptions; the first four in the small form."""


def changes_of(scene: Scene, quick: bool = False) -> list[Change]:
    """All lowered, then all raised, but for a coverage above the whole leg."""
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
class Row:
    """One frequency after one change: born period at excess 1e-3 (0: did not settle, None: failed), and
    F_m/F_g - 1 at the fold of the p_m that is born without the change; m is that of the beam."""

    frequency_hz: float
    parameter: str = "none"
    change: str = ""
    sign: int = 0
    m: int
    born_map: int | None
    born_single_mode: int | None
    born_beam: int | None
    fold_map: float | None
    fold_single_mode: float | None
    fold_beam: float | None


def known(compute: Callable[..., T], *arguments: object) -> T | None:
    """What is computed; None where that fails: the orbits next to where a fold should be are not there."""
    try:
        return compute(*arguments)
    except ContactError:
        return None


def row_at(scene: Scene, model: ModalModel, frequency: float, base: Row | None = None) -> Row:
    """Born period and fold of the map, of Eq. (1) and of the beam; `base` is the row without the change."""
    strobed = {
        "map": nordmark_at(scene, frequency),
        "single_mode": StroboscopicMap(oscillator=single_mode_at(scene, frequency)),
        "beam": StroboscopicMap(oscillator=beam_at(scene, frequency, model)),
    }
    columns = dict[str, Any](frequency_hz=frequency)
    for name, motion in strobed.items():
        period = known(born_period, motion)
        columns["m"] = (period if base is None else getattr(base, f"born_{name}")) or 0
        columns |= {f"born_{name}": period, f"fold_{name}": known(fold_excess, motion, columns["m"])}
    return Row(**columns)


def rows_after(scene: Scene, base: Sequence[Row], change: Change) -> list[Row]:
    """The rows of a change at the frequencies of `base`; SceneError if the scene does not allow it."""
    there, model = changed(scene, change)
    return [
        replace(
            row_at(there, model, row.frequency_hz, row),
            parameter=change.parameter,
            change=change.text,
            sign=change.sign,
        )
        for row in base
    ]
