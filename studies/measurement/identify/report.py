"""The rows of a fit: estimates with errors and intervals, and the quality of the fit."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, Any

import numpy as np

from studies.measurement.identify import figure
from studies.measurement.identify.fit.profiles import Profile, rows_of
from studies.measurement.identify.fit.result import Fit
from studies.measurement.identify.motion.readings import UNITS
from studies.physics.calibration import calibrate
from studies.physics.parameters import fitted_scene, parameters_of
from studies.shell.digits import minus, prefixed, written
from studies.shell.run import Run
from studies.shell.scene import Scene, SceneError

TRADE, NOTABLE = 0.95, 0.5  # correlations from which on two parameters trade off, or are shown
MOST = 10  # correlations that are shown
LESS = 0.7  # residuals over the given noise, below which it is too large
OF_EQUATION_1 = (
    "single_mode.free_period_s",
    "single_mode.decay_rate_per_s",
    "single_mode.restitution",
    "stop.gap_m",
)
UNLIKE = 2.0  # ratio of a fitted amplitude to a given one that contradicts it; clamped beams: 1.57
SHOWN = ("record", "parameter", "value", "interval", "began", "in_scene")  # columns on the terminal


@dataclass(frozen=True)
class Estimate:
    """One parameter of a fit, in SI units.

    The properties are for a person: they round to the second digit of the error, in a unit with a prefix.
    """

    record: str
    parameter: str
    unit: Annotated[str, "SI unit of the parameter"]
    start: Annotated[float, "where the fit began, in the SI unit"]
    estimate: Annotated[float, "estimate, in the SI unit"]
    standard_error: Annotated[float, "standard error, in the SI unit"]
    low90: Annotated[float, "lower end of the 90 % interval, in the SI unit; by the likelihood if known"]
    high90: Annotated[float, "upper end of the 90 % interval, in the SI unit"]
    scene: Annotated[float, "value of the scene, in the SI unit"]
    correlation: Annotated[Mapping[str, float], "correlation with another"]

    @property
    def value(self) -> str:
        """The estimate with its error and unit: 40.798(11) ms, 12.3(4.5) mm, 773(46) kN/m."""
        scale, digits, unit = self._style
        last = f"{self.standard_error / scale * 10.0**digits:.0f}"
        last = last if digits > 1 else self._written(self.standard_error)
        return f"{self._written(self.estimate)}({last}) {unit}".removesuffix(" 1")

    interval = property(lambda self: f"{self._written(self.low90)} to {self._written(self.high90)}")
    began = property(lambda self: self._written(self.start))
    in_scene = property(lambda self: self._written(self.scene))

    @property
    def _style(self) -> tuple[float, int, str]:
        """Scale of the unit, digits after the point and the unit."""
        scale, unit = prefixed(max(abs(self.estimate), self.standard_error), self.unit)
        first = f"{self.standard_error / scale:.1e}".partition("e")[2]
        return scale, 1 - int(first or 0), unit

    def _written(self, number: float) -> str:
        scale, digits, _ = self._style
        return minus(f"{round(number / scale, digits):z.{max(digits, 0)}f}")


@dataclass(frozen=True)
class Correlation:
    """The correlation of two estimates of a fit."""

    record: str
    parameter: str
    other: Annotated[str, "other parameter"]
    correlation: float


@dataclass(frozen=True)
class Quality:
    """The residuals of a fit."""

    record: str
    rows: Annotated[int, "number of rows"]
    noise: Annotated[float, "noise of the readings; in m, or of an excess"]
    freedom: Annotated[int, "degrees of freedom"]
    chance: Annotated[float, "probability of such residuals from noise alone"]


def units_of(found: Fit) -> list[str]:
    """The units of a fit's numbers."""
    units = {name: one.unit for name, one in parameters_of(found.oscillator).items()} | UNITS
    units["offset"] = found.record.unit
    return [units[name] for name in found.names]


def without_errors(found: Fit) -> str:
    """The best values of a fit whose errors mean little."""
    words = list[str]()
    for name, value, own in zip(found.names, found.estimate.tolist(), units_of(found), strict=True):
        scale, unit = prefixed(abs(value), own)
        words.append(f"{name} {value / scale:.5g} {unit}".removesuffix(" 1"))
    return ", ".join(words)


def estimates_of(name: str, found: Fit) -> list[Estimate]:
    """The rows of a fit."""
    columns = found.start, found.estimate, found.errors, *found.intervals().T, found.before
    numbers = (column.tolist() for column in columns)
    correlations = [dict(zip(found.names, row, strict=True)) for row in found.correlations.tolist()]
    rows = zip(found.names, units_of(found), *numbers, correlations, strict=True)
    return [Estimate(name, *row) for row in rows]


def correlated(name: str, found: Fit) -> list[Correlation]:
    """The pairs of a fit whose correlation is largest in size, the largest first."""
    size, names = np.abs(found.correlations), found.names
    pairs = sorted(combinations(range(len(names)), 2), key=lambda pair: -size[pair])[:MOST]
    shown = [(i, k) for i, k in pairs if size[i, k] > NOTABLE]
    return [Correlation(name, names[i], names[k], float(found.correlations[i, k])) for i, k in shown]


def traded(found: Fit, quick: bool) -> list[Profile]:
    """The profile of each parameter that trades off with another, the most correlated pair first.

    The small form has this pair alone.
    """
    size = np.abs(found.correlations) - np.eye(len(found.names))
    partners = {i: int(np.argmax(row)) for i, row in enumerate(size) if row.max() > TRADE}
    partners = {i: k for i, k in partners.items() if max(i, k) < len(found.problem.names)}
    order = sorted(partners, key=lambda i: -size[i, partners[i]])
    kept = [i for k, i in enumerate(order) if partners[i] not in order[:k] or partners[partners[i]] != i]
    rows = list[Profile]()
    for i in kept[: 1 if quick else None]:
        walk = found.walk(found.names[i])
        sides = [(reach, walk.side(reach)[0]) for reach in (-found.reach, found.reach)]
        points = [point for _, side in sides for point in side]
        points += [p for reach, side in sides if len(side) == 1 for p in walk.side(0.5 * reach)[0]]
        rows += rows_of(walk, points, found.names[partners[i]])
    return rows


def notes_of(found: Fit) -> list[str]:
    """What was changed of a record, and what contradicts it or makes its errors too small."""
    record, notes = found.record, [*found.record.notes]
    given, fitted = record.amplitude, dict(zip(found.names, found.estimate, strict=True)).get("amplitude")
    if given and fitted and not 1.0 / UNLIKE < fitted / given < UNLIKE:
        both = f"{1e3 * fitted:.4g} mm contradicts the given {1e3 * given:.4g} mm"
        notes.append(f"the fitted amplitude of {both}")
    if found.noise_known and record.kind == "motion" and found.residuals.std() < LESS * found.noise:
        notes.append(f"{found.against_noise}: the errors are too large")
    if record.kind == "motion":
        if m := found.problem.prediction.m:
            notes.append(f"the motion is p{m}: it repeats after {m} drive period{'s' * (m > 1)}")
        times, period = record.rows[:, 0], found.oscillator.period
        rows = period / float(np.median(np.diff(times)))
        if abs(rows - round(rows)) * (times[-1] - times[0]) < period:
            why = f"about {round(rows)} rows a drive period: impacts lie at one place between two of them"
            notes.append(f"{why}, so that errors of the contact may be too small; record at another rate")
    return notes


def as_scene(scene: Scene, found: Fit) -> Scene:
    """The scene with the fitted oscillator.

    The modes of a fitted beam are measured ones.  After a fit of one mode a drawn spring stays: its sheet and
    tape give mode 1 the fitted period and decay rate, so that every study has a beam.  If no sheet and tape
    do, the mode is a measured one.
    """
    several = sorted(set(found.record.rows[:, 0])) if found.record.kind == "transitions" else []
    fitted = fitted_scene(scene, found.oscillator, several or [found.oscillator.driven.frequency])
    if found.oscillator.n_modes == 1 and scene.spring.kind != "modal_data":
        own = fitted.single_mode
        with suppress(SceneError):
            drawn = calibrate(scene, free_period_s=own.free_period_s, decay_rate_per_s=own.decay_rate_per_s)
            numbers: dict[str, object] = {key: fitted.number(key) for key in OF_EQUATION_1}
            numbers["drive.frequencies_hz"] = list(fitted.drive.frequencies_hz)
            return drawn.replace(numbers, provenance="fitted")
    return fitted


def report(run: Run, found: Mapping[str, Fit]) -> dict[str, Any]:
    """Tables, figure and notes of the fits."""
    profiles = {name: traded(one, run.quick) for name, one in found.items()}
    estimates = [row for name, one in found.items() for row in estimates_of(name, one)]
    caption = "Values with standard errors, 90 % intervals, where the fit began, and the scene's values."
    run.table("parameters", estimates, caption, of=Estimate, show=SHOWN)
    pairs = [pair for name, one in found.items() for pair in correlated(name, one)]
    run.table("correlations", pairs, "The largest correlations, above 0.5 in size.", of=Correlation)
    quality = [Quality(n, len(f.residuals), f.noise, f.problem.freedom, f.chance) for n, f in found.items()]
    run.table("quality", quality, "The residuals of the fits.", of=Quality)
    points = [row for rows in profiles.values() for row in rows]
    run.table("profile", points, "Likelihood where two parameters trade off.", of=Profile, show=())
    holds = "Reading less fit of each row of a record, in its unit: m, m/s, m/s², or an excess."
    run.arrays("residuals", holds, **{f"residuals_{name}": one.residuals for name, one in found.items()})
    for name, one in found.items():
        values = {row.parameter: row.value for row in estimates if row.record == name}
        stem, title = (f"identify_{name}", f"Record: {name}") if len(found) > 1 else ("identify", "")
        run.figure(stem, figure.draw(one, profiles[name], values, title), figure.CAPTION)
    for name, note in [(name, note) for name, one in found.items() for note in notes_of(one)]:
        run.say(f"{name}: {note}")
    own = [one for one in estimates if one.estimate and one.parameter not in UNITS]
    for part, name in sorted((abs(one.standard_error / one.estimate), one.parameter) for one in own)[-1:]:
        least = f"{name.replace('_', ' ')} is known least: to {written(100.0 * part, 1)} % of its value"
        run.finding(f"Of all fitted parameters the {least}.")
    return {"rows": estimates, "quality": quality}
