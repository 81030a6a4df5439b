"""One parameter of the scene changed at a time, and what it does to born period and fold at one frequency.

T, mu within the letter's errors, tau between 0.05 and 0.15, and the free assumptions of the spring. A change
of the spring goes with the thickness of the sheet that keeps T; the rate of mode 1, gap and mass stay. A
hysteresis is compared with that of the same p_m before the change, whatever is born after it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from beam import ModalModel
from contact import ContactError, MaximalFamily, NordmarkMap, StroboscopicMap, fold
from contact.orbits import KickFamily, Shooting, born_period, fold_of
from studies.calibration import calibrate_damping, free_period, solve_for
from studies.letter import BREAKDOWN, FREE_PERIOD_ERROR_S, PERIODS
from studies.scene import Scene, SceneError, beam_at, model_of, nordmark_at, single_mode_at
from studies.sensitivity.noise import first_birth, upper_end

HIGHEST = max(PERIODS.values())
"""m of the last transition that the letter saw."""

NAMES = {"map": "map", "single_mode": "Eq. (1)", "beam": "beam"}


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """What is varied: a key of the scene, lowered and raised by `add` or by two factors.

    Without a key the factors are on the decay rates above the first. `tune`: the sheet is fitted to the free
    period again.
    """

    name: str
    key: str = ""
    add: float = 0.0
    unit: str = ""
    factors: tuple[float, float] = (1.0, 1.0)
    tune: bool = False


PARAMETERS = (
    Parameter(name="free period", key="single_mode.free_period_s", add=FREE_PERIOD_ERROR_S, unit="s",
              tune=True),
    Parameter(name="decay rate of mode 1", key="single_mode.decay_rate_per_s",
              add=float(BREAKDOWN["decay_rate_error_per_s"]), unit="1/s"),
    Parameter(name="restitution of Eq. (1)", key="single_mode.restitution", add=0.05),
    Parameter(name="damping of higher modes", factors=(0.5, 2.0)),
    Parameter(name="mass of ball and mount", key="tip.mass_kg", factors=(0.8, 1.2), tune=True),
    Parameter(name="gap", key="stop.gap_m", factors=(0.8, 1.25)),
    Parameter(name="radius of the ball", key="tip.ball_radius_m", factors=(0.5, 2.0)),
    Parameter(name="radius of the bend", key="spring.bend_radius_m", factors=(0.7, 1.3), tune=True),
    Parameter(name="width of the strip", key="spring.width_m", factors=(0.7, 1.3), tune=True),
    Parameter(name="modulus of the tape", key="spring.tape_modulus_pa", factors=(0.5, 2.0), tune=True),
    Parameter(name="coverage of the tape", key="spring.tape_coverage", factors=(0.75, 1.25), tune=True),
    Parameter(name="number of modes", key="modes.count", add=5),
)  # fmt: skip
"""The letter's errors, then the assumptions; the first four in the small form."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """A parameter lowered (`sign` -1) or raised (1) to `value`, or by that factor without a key."""

    parameter: Parameter
    sign: int
    value: float

    @property
    def text(self) -> str:
        """The change for a table."""
        add, factor = self.sign * self.parameter.add, self.parameter.factors[self.sign > 0]
        return f"{add:+g} {self.parameter.unit}".rstrip() if add else f"x {factor:g}"


def changes_of(scene: Scene, parameters: tuple[Parameter, ...]) -> Iterator[Change]:
    """Both changes of every parameter, but for a coverage above the whole leg."""
    for sign in (-1, 1):
        for parameter in parameters:
            value = parameter.factors[sign > 0]
            if parameter.key:
                value = scene.number(parameter.key) * value + sign * parameter.add
            if parameter.name == "number of modes":
                value = max(1, round(value))
            if not (parameter.name == "coverage of the tape" and value > 1.0):
                yield Change(parameter=parameter, sign=sign, value=value)


def changed(scene: Scene, change: Change) -> tuple[Scene, ModalModel]:
    """Scene and modes after a change."""
    key, value = change.parameter.key, change.value
    period = value if key == "single_mode.free_period_s" else free_period(scene)
    if key:
        scene = scene.replace({key: value})
    if key == "single_mode.decay_rate_per_s":
        if scene.damping.kind == "strips":
            scene = scene.replace({"damping.decay_rate_per_s": value})
        else:
            scene = calibrate_damping(scene, value)
    if change.parameter.tune:
        h = scene.spring.thickness_m
        scene = solve_for("spring.thickness_m", scene, free_period, period, name="free period", unit="s",
                          between=(0.7 * h, 1.4 * h))  # fmt: skip
    model = model_of(scene)
    rates = model.decay_rate.copy()
    rates[1:] *= 1.0 if key else value
    return scene, replace(model, decay_rate=rates)


@dataclass(frozen=True, kw_only=True)
class Row:
    """One frequency after one change: born period at excess 1e-3 (0: did not settle, None: failed), and
    F_m/F_g - 1 at the fold of the p_m that is born without the change; m is that of the beam."""

    frequency_hz: float
    parameter: str
    change: str
    sign: int
    m: int
    born_map: int | None
    born_single_mode: int | None
    born_beam: int | None
    fold_map: float | None
    fold_single_mode: float | None
    fold_beam: float | None

    def born(self, name: str) -> int | None:
        """Born period in one description."""
        value: int | None = getattr(self, f"born_{name}")
        return value

    def fold(self, name: str) -> float | None:
        """Fold in one description."""
        value: float | None = getattr(self, f"fold_{name}")
        return value


def row_at(
    scene: Scene, model: ModalModel, frequency: float, change: Change | None = None, base: Row | None = None
) -> Row:
    """Born period and fold of the map, of Eq. (1) and of the beam; `base` is the row without the change."""
    nordmark, single = nordmark_at(scene, frequency), single_mode_at(scene, frequency)
    beam = beam_at(scene, frequency, model)
    born = {
        "map": birth(nordmark),
        "single_mode": birth(StroboscopicMap(oscillator=single)),
        "beam": birth(StroboscopicMap(oscillator=beam)),
    }
    m = {name: (born[name] if base is None else base.born(name)) or 0 for name in NAMES}
    on_map = fold(nordmark, m["map"]) if m["map"] > 1 else None
    exact = None
    if m["single_mode"] > 1:
        exact = MaximalFamily.from_oscillator(single, period=m["single_mode"]).fold()
    of_beam = None
    if m["beam"] > 1:
        try:
            kick = KickFamily(oscillator=beam, period=m["beam"]).fold()
            if kick is not None:
                of_beam = fold_of(Shooting(oscillator=beam, period=m["beam"], impacts=kick.kick.touches))
        except ContactError:
            pass  # the orbits next to the place where the fold should be are not there
    return Row(
        frequency_hz=frequency, parameter="none" if change is None else change.parameter.name,
        change="" if change is None else change.text, sign=0 if change is None else change.sign, m=m["beam"],
        born_map=born["map"], born_single_mode=born["single_mode"], born_beam=born["beam"],
        fold_map=None if on_map is None else nordmark.excess(on_map.rho),
        fold_single_mode=None if exact is None else exact.excess,
        fold_beam=None if of_beam is None else of_beam.excess,
    )  # fmt: skip


def birth(strobed: NordmarkMap | StroboscopicMap) -> int | None:
    """Born period; None where it could not be computed."""
    try:
        return born_period(strobed)
    except ContactError:
        return None


def rows_of(scene: Scene, base: list[Row], change: Change) -> list[Row] | str:
    """The rows of a change at the frequencies of `base`, or why there are none."""
    try:
        there, model = changed(scene, change)
    except SceneError as error:
        return str(error)
    return [row_at(there, model, row.frequency_hz, change, row) for row in base]


@dataclass(frozen=True, kw_only=True)
class LastFrequency:
    """At the last frequency: the excess up to which the orbit born at 1e-3 keeps its period, and from which
    on a start from below grazing gives the letter's period."""

    description: str
    period: int
    lives_up_to: float | None
    letters_period_born_from: float | None


def at_last(scene: Scene, model: ModalModel, base: Row, name: str) -> LastFrequency:
    """The row of a description: Eq. (1), the same with the shortest T within the letter's error, the beam."""
    if name.endswith("short_period"):
        shorter = scene.single_mode.free_period_s - FREE_PERIOD_ERROR_S
        scene = scene.replace({"single_mode.free_period_s": shorter})
    f, period = base.frequency_hz, base.born_beam or 0
    oscillator = beam_at(scene, f, model) if name == "beam" else single_mode_at(scene, f)
    strobed = StroboscopicMap(oscillator=oscillator)
    return LastFrequency(description=name, period=period, lives_up_to=upper_end(strobed, period),
                         letters_period_born_from=first_birth(strobed, HIGHEST))  # fmt: skip
