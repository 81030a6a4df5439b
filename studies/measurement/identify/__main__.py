"""From a measured record to the parameters of the oscillator, with errors that can be believed.

Claim: a record of a beam that rattles tells its free period, decay rate, gap, restitution and delay, or its
contact stiffness, each with an error; and where a record cannot tell two of them apart, it says so.

Records are CSV files, told by their heading (studies.measurement.identify.records; the example makes one of
each):

    x_m[,v_m_per_s]                        strobe points of a settled motion, a row a drive period
    time_s,x_m                             displacement of the tip relative to the base, at a constant rate
    frequency_hz,period,excess[,error]     where p_m is lost as the drive is lowered

The oscillator is that of the scene: Eq. (1) (one_mode), the same with a constant delay (two_parameters), or
the spring on its stop (beam). Least squares with exact derivatives; errors and intervals from (J^T J)^-1 and
the scatter of the residuals; where two parameters trade off (correlation beyond 0.95) the likelihood along
one of them, the others fitted again (`profile`). Residuals that are no noise say that the model is too small.
Without a record three synthetic ones, with 0.5 um of read-out noise, are made and fitted; --coverage N asks
of N records of each kind whether 90 % intervals hold the truth 90 % of the time.

Run:     python -m studies identify [RECORD.csv --fit free_period restitution gap] [--coverage N]
Writes:  parameters.csv with correlations, quality.csv, profile.csv, residuals.npz, identify.png (record
         and fit, residuals, profile), fitted.toml, a scene that every study takes; the example also its
         three records; --coverage also coverage.csv
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from beam import InvalidValue
from contact import ImpactOscillator
from studies.measurement.identify import coverage as covering
from studies.measurement.identify import figures
from studies.measurement.identify.fit import Fit
from studies.measurement.identify.fit import fit as fitted
from studies.measurement.identify.profiles import Profile, profile
from studies.measurement.identify.records import Kind, Record, read_record, synthetic
from studies.physics.parameters import Description, described, fitted_scene, parameters_of
from studies.shell.options import POSITIONAL
from studies.shell.scene import Scene, corresponding, harmonic, periods_of
from studies.shell.study import Run, study

TRADE = 0.95
"""Correlation from which on two parameters trade off."""

USUAL: Mapping[Kind, tuple[str, ...]] = {
    "strobe": ("free_period", "decay_rate", "gap", "restitution", "stiffness"),
    "displacement": ("free_period", "decay_rate", "gap", "amplitude", "restitution", "delay", "stiffness"),
    "transitions": ("free_period", "restitution"),
}
"""What is fitted of a kind of record if nobody says, as far as the oscillator has it."""

EXAMPLES: Mapping[Kind, Description] = {
    "strobe": "one_mode",
    "displacement": "two_parameters",
    "transitions": "one_mode",
}
FREQUENCY_HZ, SEED = 22.20, 1996  # of the example: the letter's p5

SHOWN = ("record", "parameter", "unit", "start", "told", "low90", "high90", "scene")
"""Columns of the estimates on the terminal."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One parameter: where the fit started, what it found, standard error and 90 % interval (of the profile
    likelihood where there is one), the value of the scene, estimate and error in short, 40.80(2), and its
    correlations with all that the record told, in their order."""

    record: str
    parameter: str
    unit: str
    start: float
    estimate: float
    standard_error: float
    low90: float
    high90: float
    scene: float
    told: str
    correlations: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """What is left of a record: noise found (that of x [m], or of an excess [1]), degrees of freedom, and the
    probability of such residuals from noise alone; below 0.001 the model is too small."""

    record: str
    rows: int
    noise: float
    freedom: int
    chance: float
    too_small: bool


def frequency_of(record: Record) -> float:
    """The drive frequency of a record, the first of a table [Hz]."""
    if (frequency := float(record.rows[0, 0]) if record.kind == "transitions" else record.frequency) is None:
        raise InvalidValue("the record does not say the frequency of the drive: give --drive HZ MM")
    return frequency


def in_step(record: Record, oscillator: ImpactOscillator) -> int:
    """Rows a drive period if that is a whole number, as far as the length of the record tells; else 0."""
    times = record.rows[:, 0]
    rows = oscillator.period / (times[1] - times[0])
    return round(rows) if abs(rows - round(rows)) * (times[-1] - times[0]) < oscillator.period else 0


def usual(record: Record, oscillator: ImpactOscillator) -> tuple[str, ...]:
    """What is fitted of a record if nobody says; of strobe points a delay or the gap, not both."""
    known = parameters_of(oscillator)
    names = [name for name in USUAL[record.kind] if name in known]
    if record.kind == "strobe" and "delay" in known:
        names[names.index("gap")] = "delay"
    return tuple(names)


def driven(record: Record, oscillator: ImpactOscillator, names: Sequence[str]) -> ImpactOscillator:
    """The oscillator at the drive amplitude of the record."""
    if record.amplitude is not None:
        return oscillator.with_amplitude(record.amplitude)
    if record.kind != "transitions" and "amplitude" not in names:
        raise InvalidValue("the record does not say the amplitude of the base: give --drive HZ MM, or fit it")
    return oscillator


@study()
def identify(
    scene: Scene,
    run: Run,
    *,
    record: Annotated[Path | None, "CSV file; without one, the example", POSITIONAL] = None,
    fit: Annotated[tuple[str, ...], "parameters to fit (default: those that its kind of record tells)"] = (),
    description: Annotated[Description, "what stands for the spring"] = "one_mode",
    drive: Annotated[
        tuple[float, float] | None, "frequency (Hz) and amplitude of the base (mm), in place of the record's"
    ] = None,
    noise_um: Annotated[float | None, "noise of the read-out, where it is known"] = None,
    delay_ms: Annotated[
        float | None, "two_parameters: the delay, or where its fit starts (default: T/136)"
    ] = None,
    coverage: Annotated[int | None, "also fit so many synthetic records of each kind: true errors?"] = None,
) -> Mapping[str, object]:
    """Read or make, fit, report and draw."""
    harmonic(scene)
    if noise_um is not None and not 0.0 < noise_um < math.inf:
        raise InvalidValue(f"noise_um is {noise_um} um; it must be finite and above zero")
    if drive is not None and (min(drive) <= 0.0 or record is None):
        raise InvalidValue(f"drive is {drive[0]:g} Hz, {drive[1]:g} mm; it needs a record, and both above 0")
    if delay_ms is not None and description != "two_parameters" and record is not None:
        raise InvalidValue(f"delay_ms is {delay_ms:g} ms; only --description two_parameters has a delay")
    noise = None if noise_um is None else 1e-6 * noise_um
    delay = None if delay_ms is None else 1e-3 * delay_ms
    if description == "beam":
        scene = run.choose_modes(scene, {"fold": 0.05})
    if record is not None:
        read = read_record(record)
        if drive is not None:
            read = replace(read, frequency=drive[0], amplitude=1e-3 * drive[1])
        oscillator = described(scene, description, delay, frequency_of(read))
        given = {record.stem: (read, oscillator)}
    elif fit:
        raise InvalidValue(f"fit names {' '.join(fit)}, but no record is given: put its file before --fit")
    else:
        given = examples(scene, run, delay)
    found = {
        name: fitted(one, driven(one, oscillator, fit), fit or usual(one, oscillator), noise=noise)
        for name, (one, oscillator) in given.items()
    }
    results = report(run, found)
    for name, (one, oscillator) in given.items():
        if one.kind == "displacement" and (rows := in_step(one, oscillator)):
            run.say(
                f"{name}: {rows} rows a drive period, so that all impacts lie alike between two of them: "
                "errors of gap, restitution and delay are too small; record at another rate"
            )
    first = next(iter(found))
    run.text("fitted.toml", as_scene(scene, found[first], [r for r in results["rows"] if r.record == first]))
    if coverage is not None:
        results |= truth(scene, run, coverage)
    return results


def examples(scene: Scene, run: Run, delay: float | None) -> dict[str, tuple[Record, ImpactOscillator]]:
    """A record of each kind, stored, and the oscillator of which it is."""
    found = dict[str, tuple[Record, ImpactOscillator]]()
    for kind, description in EXAMPLES.items():
        oscillator = described(scene, description, delay, corresponding(scene, FREQUENCY_HZ))
        found[kind] = synthetic(kind, oscillator, tuple(periods_of(scene).items()), seed=SEED), oscillator
        run.text(f"{kind}.csv", found[kind][0].text())
    return found


def truth(scene: Scene, run: Run, records: int) -> dict[str, object]:
    """How often do the intervals hold the true values?"""
    beam = run.choose_modes(scene, {"fold": 0.05})
    rows = covering.coverage(scene, beam, run, records=records, beam_records=records // 4)
    run.table("coverage", rows, covering.COVERED)
    return {"coverage": rows}


def report(run: Run, found: Mapping[str, Fit]) -> dict[str, Any]:
    """Tables and figure of the fits."""
    profiles = {name: traded(one, run.quick) for name, one in found.items()}
    estimates = [row for name, one in found.items() for row in estimates_of(name, one, profiles[name])]
    run.table("parameters", estimates, "Estimates with standard errors and 90 % intervals.", show=SHOWN)
    quality = [
        Quality(
            record=name,
            rows=len(one.residuals),
            noise=one.noise,
            freedom=one.freedom,
            chance=one.chance,
            too_small=one.too_small,
        )
        for name, one in found.items()
    ]
    run.table("quality", quality, "What is left of the records.")
    for row in (row for row in quality if row.too_small):
        run.say(
            f"{row.record}: residuals are no noise (p {row.chance:.0e}), errors mean little: the model "
            "is too small, or the start was too far off"
        )
    points = [row for rows in profiles.values() for row in rows]
    run.table("profile", points, "Likelihood along one of two parameters that trade off.", show=())
    run.arrays("residuals", **{f"residuals_{name}": one.residuals for name, one in found.items()})
    run.figure("identify", figures.draw(found, profiles), figures.CAPTION)
    return {"rows": estimates, "quality": quality}


def as_scene(scene: Scene, found: Fit, rows: Sequence[Estimate]) -> str:
    """What was fitted, as a scene, in TOML; its first lines tell the estimates."""
    table = found.record.kind == "transitions"
    frequencies = sorted(set(found.record.rows[:, 0])) if table else [found.oscillator.driven.frequency]
    about = [f"# {row.parameter} {row.told} {row.unit}" for row in rows]
    return "\n".join([*about, "", fitted_scene(scene, found.oscillator, frequencies).dump()])


def estimates_of(name: str, found: Fit, profiles: Sequence[Profile]) -> list[Estimate]:
    """The rows of a fit; intervals are those of the likelihood where its profile is known."""
    known, intervals = parameters_of(found.oscillator), dict(zip(found.names, found.intervals(), strict=True))
    for one in {row.parameter for row in profiles}:
        points = [row for row in profiles if row.parameter == one]
        values, depth = np.array([(row.value, max(row.depth, 0.0)) for row in points]).T
        middle = found.estimate[found.names.index(one)]
        roots, reach = np.copysign(depth**0.5, values - middle), found.reach
        intervals[one] = np.interp([-reach, reach], roots, values)
    return [
        Estimate(
            record=name,
            parameter=one,
            unit=known[one].unit,
            start=float(found.start[i]),
            low90=float(low),
            estimate=float(found.estimate[i]),
            standard_error=float(found.errors[i]),
            high90=float(high),
            told=in_short(float(found.estimate[i]), float(found.errors[i])),
            scene=float(found.before[i]),
            correlations=tuple(found.correlations[i].tolist()),
        )
        for i, (one, (low, high)) in enumerate(intervals.items())
    ]


def in_short(value: float, error: float) -> str:
    """The value with its error in units of its last digits, 0.04080(2)."""
    if not 0.0 < error < math.inf:
        return f"{value:.6g}"
    digits = 1 - math.floor(math.log10(error))
    return f"{value:.{max(digits, 0)}f}({round(error * 10.0 ** max(digits, 0))})"


def traded(found: Fit, quick: bool) -> list[Profile]:
    """The profile of each parameter that trades off with another, the most correlated pair first; or this
    alone, of few points."""
    size = np.abs(found.correlations) - np.eye(len(found.names))
    partners = {i: int(np.argmax(row)) for i, row in enumerate(size) if row.max() > TRADE}
    order = sorted(partners, key=lambda i: -size[i, partners[i]])
    kept = [i for k, i in enumerate(order) if partners[i] not in order[:k] or partners[partners[i]] != i]
    return [
        row
        for i in kept[: 1 if quick else None]
        for row in profile(found, found.names[i], found.names[partners[i]], points=5 if quick else 9)
    ]
