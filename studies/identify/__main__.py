"""From a measured record to the parameters of the oscillator, with errors that can be believed.

Claim: a record of a beam that rattles tells its free period, decay rate, gap, restitution and delay, or its
contact stiffness, each with an error; and where a record cannot tell two of them apart, it says so.

Records are CSV files, told by their heading (studies.identify.records; the example makes one of each):

    x_m[,v_m_per_s]                        strobe points of a settled motion, a row a drive period
    time_s,x_m                             displacement of the tip relative to the base, at a constant rate
    frequency_hz,period,excess[,error]     where p_m is lost as the drive is lowered

The oscillator is that of the scene: Eq. (1) (one_mode), the same with a constant delay (two_parameters), or
the spring on its stop (beam). Least squares with exact derivatives; errors and intervals from (J^T J)^-1 and
the scatter of the residuals; where two parameters trade off (correlation beyond 0.95) the likelihood along
one of them, the others fitted again (`profile`). Residuals that are no noise say that the model is too small.
Without a record three synthetic ones, with 0.5 um of read-out noise, are made and fitted.

Run:     python -m studies.identify RECORD.csv --fit free_period restitution gap     10 s
Writes:  parameters.csv, correlations.csv, profile.csv, residuals.npz, identify.png (record and fit,
         residuals, profile), fitted.toml, a scene that every study takes; the example also its three records
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from beam.parameters import require_within
from contact import DelayedRestitution, HarmonicDrive, ImpactOscillator
from studies.identify.fit import Fit, Profile, fit, profile
from studies.identify.parameters import fitted_scene, parameters_of
from studies.identify.records import Kind, Record, read_record, synthetic
from studies.options import POSITIONAL
from studies.run import Run, study
from studies.scene import Scene, beam_at, harmonic, model_of, single_mode_at

__all__ = ["identify"]

Description = Literal["one_mode", "two_parameters", "beam"]

TRADE = 0.95
"""Correlation from which on two parameters trade off."""

USUAL: Mapping[Kind, tuple[str, ...]] = {
    "strobe": ("free_period", "decay_rate", "gap", "restitution"),
    "displacement": ("free_period", "decay_rate", "gap", "amplitude", "restitution", "delay"),
    "transitions": ("free_period", "restitution"),
}
"""What is fitted of a kind of record if nobody says, as far as the oscillator has it."""

EXAMPLES: Sequence[tuple[Kind, Description]] = (
    ("strobe", "one_mode"), ("displacement", "two_parameters"), ("transitions", "one_mode"),
)  # fmt: skip
FREQUENCY_HZ, SEED = 22.20, 1996
"""Of the example: the letter's p5."""


SHOWN = ("record", "parameter", "unit", "start", "told", "low90", "high90", "scene")
"""Columns of the estimates on the terminal."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One parameter: where the fit started, what it found, standard error and 90 % interval, the value of the
    scene, and estimate and error in short, 40.80(2)."""

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


@dataclass(frozen=True, kw_only=True)
class Correlation:
    """Of two estimates."""

    record: str
    parameter: str
    other: str
    correlation: float


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


def described(scene: Scene, description: Description, frequency: float, delay: float) -> ImpactOscillator:
    """The oscillator of the scene at a drive frequency [Hz], at the excess at which periods are born."""
    if description == "beam":
        oscillator = beam_at(scene, frequency, model_of(scene))
    else:
        oscillator = single_mode_at(scene, frequency)
    if description == "two_parameters":
        law = DelayedRestitution(restitution=scene.single_mode.restitution, delay=delay)
        oscillator = replace(oscillator, stop=replace(oscillator.stop, law=law))
    return oscillator.with_excess(scene.scan.born_excess)


def usual(record: Record, oscillator: ImpactOscillator) -> tuple[str, ...]:
    """What is fitted of a record if nobody says; of strobe points a delay or the gap, not both."""
    known = parameters_of(oscillator)
    names = [name for name in USUAL[record.kind] if name in known]
    if record.kind == "strobe" and "delay" in known:
        names[names.index("gap")] = "delay"
    return (*names, *(name for name in ("stiffness",) if name in known and "restitution" not in known))


def driven(record: Record, oscillator: ImpactOscillator, names: Sequence[str]) -> ImpactOscillator:
    """The oscillator at the drive of the record."""
    if record.kind == "transitions":
        return oscillator
    amplitude = record.amplitude
    if amplitude is None and "amplitude" not in names:
        raise ValueError(
            "the record does not say the amplitude of the base: give --amplitude-mm, or fit amplitude"
        )
    assert record.frequency is not None
    drive = HarmonicDrive(frequency=record.frequency, amplitude=amplitude or oscillator.driven.amplitude)
    return replace(oscillator, drive=drive)


@study()
def identify(
    scene: Scene, run: Run, *,
    record: Annotated[Path | None, "CSV file; without one, the example", POSITIONAL] = None,
    fit: Annotated[tuple[str, ...], "parameters to fit (default: those that its kind of record tells)"] = (),
    description: Annotated[Description, "what stands for the spring"] = "one_mode",
    frequency_hz: Annotated[float | None, "drive frequency, in place of the record's"] = None,
    amplitude_mm: Annotated[float | None, "amplitude of the base, in place of the record's"] = None,
    noise_um: Annotated[float | None, "noise of the read-out, where it is known"] = None,
    delay_ms: Annotated[float, "two_parameters: the delay, or where its fit starts"] = 0.3,
) -> Mapping[str, object]:  # fmt: skip
    """Read or make, fit, report and draw."""
    harmonic(scene)
    if description == "beam":
        scene = run.choose_modes(scene, {"fold": 0.05})
    given: list[tuple[str, Record, ImpactOscillator, tuple[str, ...]]] = []
    if record is None:
        if fit:
            raise ValueError(f"fit names {' '.join(fit)}, but no record is given: put its file before --fit")
        for kind, stands in EXAMPLES:
            oscillator = described(scene, stands, FREQUENCY_HZ, 1e-3 * delay_ms)
            made = synthetic(kind, oscillator, seed=SEED)
            run.text(f"{kind}.csv", made.text())
            given.append((kind, made, oscillator, usual(made, oscillator)))
    else:
        read = read_record(record)
        if read.kind != "transitions":
            read = replace(read, frequency=frequency_hz or read.frequency)
            if read.frequency is None:
                raise ValueError("the record does not say the drive frequency: give --frequency-hz")
            if amplitude_mm is not None:
                read = replace(read, amplitude=1e-3 * amplitude_mm)
        frequency = read.frequency or float(read.rows[0, 0])
        oscillator = described(scene, description, frequency, 1e-3 * delay_ms)
        names = fit or usual(read, oscillator)
        given.append((record.stem, read, driven(read, oscillator, names), names))
    noise = None if noise_um is None else 1e-6 * require_within("noise_um", noise_um, "um", above=0)
    found = {name: _fit(made, oscillator, names, noise=noise) for name, made, oscillator, names in given}
    profiles = {name: traded(one, 5 if run.quick else 9) for name, one in found.items()}
    estimates = [row for (name, one), (*_, before, _) in zip(found.items(), given, strict=True)
                 for row in estimates_of(name, one, before)]  # fmt: skip
    run.table("parameters", estimates, "Estimates with standard errors and 90 % intervals.", show=SHOWN)
    quality = [
        Quality(record=name, rows=len(one.residuals), noise=one.noise, freedom=one.freedom,
                chance=one.chance, too_small=one.too_small) for name, one in found.items()
    ]  # fmt: skip
    run.table("quality", quality, "What is left of the records.")
    correlations = [
        Correlation(record=name, parameter=a, other=b, correlation=float(one.correlations[i, j]))
        for name, one in found.items() for (i, a), (j, b) in combinations(enumerate(one.names), 2)
    ]  # fmt: skip
    run.table("correlations", correlations, "Correlations of the estimates.", show=())
    run.table("profile", [row for rows in profiles.values() for row in rows],
              "Likelihood along one of two parameters that trade off.", show=())  # fmt: skip
    run.arrays("residuals", **{name: one.residuals for name, one in found.items()})
    for row in quality:
        if row.too_small:
            run.say(f"{row.record}: the model is too small: its residuals are no noise (p {row.chance:.0e})")
    best = found[given[0][0]]
    about = [f"# {row.parameter} {row.told} {row.unit}" for row in estimates if row.record == given[0][0]]
    table = best.record.kind == "transitions"
    frequencies = sorted(set(best.record.rows[:, 0])) if table else [best.oscillator.driven.frequency]
    fitted = fitted_scene(scene, best.oscillator, frequencies)
    run.text("fitted.toml", "\n".join([*about, "", fitted.dump()]))
    from studies.identify import figures  # matplotlib is slow to import

    run.figure("identify", figures.draw(found, profiles), figures.CAPTION)
    return {"rows": estimates, "quality": quality, "correlations": correlations}


def _fit(record: Record, oscillator: ImpactOscillator, names: Sequence[str], *, noise: float | None) -> Fit:
    return fit(record, oscillator, names, noise=noise)


def estimates_of(name: str, found: Fit, before: ImpactOscillator) -> list[Estimate]:
    """The rows of a fit."""
    known = parameters_of(before)
    return [
        Estimate(
            record=name, parameter=one, unit=known[one].unit, start=float(found.start[i]),
            estimate=float(found.estimate[i]), standard_error=float(found.errors[i]),
            low90=float(low), high90=float(high), scene=known[one].value,
            told=in_short(float(found.estimate[i]), float(found.errors[i])),
        ) for i, (one, (low, high)) in enumerate(zip(found.names, found.intervals(), strict=True))
    ]  # fmt: skip


def in_short(value: float, error: float) -> str:
    """The value with its error in units of its last digits, 0.04080(2)."""
    if not 0.0 < error < math.inf:
        return f"{value:.6g}"
    digits = 1 - math.floor(math.log10(error))
    return f"{value:.{max(digits, 0)}f}({round(error * 10.0 ** max(digits, 0))})"


def traded(found: Fit, points: int) -> list[Profile]:
    """The profile of each parameter that trades off with another, the most correlated pair first."""
    size = np.abs(found.correlations) - np.eye(len(found.names))
    partners = {i: int(np.argmax(row)) for i, row in enumerate(size) if row.max() > TRADE}
    order = sorted(partners, key=lambda i: -size[i, partners[i]])
    kept = [i for k, i in enumerate(order) if partners[i] not in order[:k] or partners[partners[i]] != i]
    return [
        row for i in kept
        for row in profile(found, found.names[i], found.names[partners[i]], points=points)
    ]  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(identify.main())
