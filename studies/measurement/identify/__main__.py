"""Parameters of the oscillator, with checked errors, from a record.

Claim: a record of a beam that rattles determines its free period, decay rate, gap, restitution and delay, or
its contact stiffness, each with an error.  Where it cannot separate two of them, the study says so.

A record is a file as an instrument wrote it: CSV or text, LabVIEW, WAV, MATLAB, universal file, TDMS
(docs/guide/records.md).  Its time and one channel are a displacement, velocity or acceleration of the tip.
Two more kinds of record are known by their heading; the example makes one of each:

    x_m[,v_m_per_s]                        strobe points of a settled motion, a row a drive period
    frequency_hz,period,excess[,error]     where p_m is lost as the drive is lowered

The oscillator is that of the scene: Eq. (1) (one_mode), the same with a constant delay (two_parameters), or
the spring on its stop (beam).  Least squares have exact derivatives; errors and intervals come from
(J^T J)^-1 and the scatter of the residuals.  Where two parameters trade off (correlation beyond 0.95) the
likelihood along one of them is computed, with the others fitted again.  A fit whose residuals are unlike
noise is no answer: it ends with exit code 3 and its best values, without a table.  Without a record three
synthetic ones, with 0.5 um of read-out noise, are made and fitted.

--fit takes these names, or the symbol in brackets:

    free_period (T)     s            damped free period of mode 1
    decay_rate (mu)     1/s          decay rate of mode 1: amplitudes fall as exp(-mu t/2)
    gap                 m            distance from the tip at rest to the stop
    frequency           Hz           frequency f of the drive
    amplitude           m            amplitude Z of the base
    restitution (tau)   1            speed after an impact over the speed before (one_mode, two_parameters)
    delay               s            time from contact to release (two_parameters)
    stiffness           N/m^1.5      of Hertz's contact; N/m of a linear one (beam)
    damping             N s/m        of a linear contact (beam)
    dissipation         s/m          of Hunt and Crossley's contact (beam)
    tip_mass            kg           mass at the tip; the free period is a number of its own (beam)
    phase               rad          phase of the base at time zero; it and the next two need a motion
    offset              m            reading of the sensor at equilibrium
    scale               1            reading per displacement

The base moves as Z sin(2 pi f t + phase).  The time t is that of the record's stamps.

--next NAMES finds the next measurement: the drive frequency and excess at which the strobes of one orbit
determine these parameters best (studies.measurement.next_measurement).  The oscillator is Eq. (1)
with the restitution and the constant delay of the fit.  A place counts if the orbit outlives its errors.

Run:     python -m studies identify [RECORD.csv --fit T tau gap phase] [--next NAMES]
Writes:  parameters.csv and correlations.csv, quality.csv, profile.csv, residuals.npz, identify.png (record
         and fit, residuals, intervals, profile), fitted.toml, a scene that every study takes; the example
         a figure a record, and its three records; --next and the example measurements.csv (a row an
         orbit), next.csv (the best five), letter_orbits.csv, next.png
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from beam import InvalidValue, Refusal
from contact import ImpactOscillator
from studies import letter
from studies.measurement.identify.fit.diagnosis import contradictions
from studies.measurement.identify.fit.result import Fit
from studies.measurement.identify.fit.search import fit as fitted
from studies.measurement.identify.motion.readings import SENSOR
from studies.measurement.identify.record.reading import read_record
from studies.measurement.identify.record.records import Kind, NoAnswer, Record, synthetic
from studies.measurement.identify.report import as_scene, report, without_errors
from studies.measurement.next_measurement.figure import where_to_measure
from studies.measurement.next_measurement.model import Plan
from studies.physics.least_model import least_modes
from studies.physics.parameters import Description, described, in_full, parameters_of, require_names
from studies.shell.options import POSITIONAL, Within
from studies.shell.scene import Scene, corresponding, harmonic, periods_of
from studies.shell.study import Run, study

STEADY = ("free_period", "decay_rate", "gap", "amplitude")
USUAL: Mapping[Kind, tuple[str, ...]] = {
    "strobe": ("free_period", "decay_rate", "gap", "restitution", "stiffness"),
    "motion": (*STEADY, "restitution", "delay", "stiffness", "frequency"),
    "transitions": ("free_period", "restitution"),
}
"""The parameters that are fitted to a kind of record by default, as far as the oscillator has them."""

EXAMPLES: Mapping[Kind, Description] = {
    "strobe": "one_mode",
    "motion": "two_parameters",
    "transitions": "one_mode",
}
FREQUENCY_HZ, SEED = letter.TRANSITION_HZ[5], 1996  # of the example


def frequency_of(record: Record, scene: Scene) -> float:
    """The drive frequency where a fit begins [Hz]: of the record, the first of a table, or of the scene."""
    if record.kind == "transitions":
        return float(record.rows[0, 0])
    if record.frequency is None and record.kind == "strobe":
        raise InvalidValue("the record does not say the frequency of the drive: give --drive HZ MM")
    return record.frequency or corresponding(scene, FREQUENCY_HZ)


def usual(record: Record, oscillator: ImpactOscillator) -> tuple[str, ...]:
    """The parameters that are fitted by default; to strobe points a delay or the gap, not both."""
    known = parameters_of(oscillator)
    names = [name for name in USUAL[record.kind] if name in known]
    if record.kind == "strobe" and "delay" in known:
        names[names.index("gap")] = "delay"
    return tuple(names)


def driven(record: Record, oscillator: ImpactOscillator, names: Sequence[str]) -> ImpactOscillator:
    """The oscillator at the drive amplitude of the record."""
    if record.amplitude is None and record.kind == "strobe" and "amplitude" not in names:
        raise InvalidValue("the record does not say the amplitude of the base: give --drive HZ MM, or fit it")
    return oscillator if record.amplitude is None else oscillator.with_amplitude(record.amplitude)


@study()
def identify(
    scene: Scene,
    run: Run,
    *,
    record: Annotated[Path | None, "file of the instrument; without one, the example", POSITIONAL] = None,
    fit: Annotated[
        tuple[str, ...],
        "names to fit, see above; other parameters keep the values of the scene (default: the usual ones). "
        "Phase and offset of a motion are fitted, unless phase, offset or scale is named",
    ] = (),
    description: Annotated[Description, "the oscillator"] = "one_mode",
    drive: Annotated[
        tuple[float, float] | None,
        "frequency (Hz) and amplitude of the base (mm), in place of the record's",
        Within(0, 1e6, "Hz, mm", open=True),
    ] = None,
    noise_um: Annotated[
        float | None,
        "noise of the read-out, where it is known; for a velocity in µm/s, for an acceleration in µm/s²",
        Within(0, 1e9, "µm", open=True),
    ] = None,
    delay_ms: Annotated[
        float | None, "two_parameters: delay, or start of its fit (default: T/136)", Within(0, 1e9, "ms")
    ] = None,
    columns: Annotated[
        str | None, "TIME,VALUE of the record by name or number; VALUE if it has no time"
    ] = None,
    unit: Annotated[
        str | None, "unit of the channel (mm, m/s, g), or what one recorded unit is: V=5e-3m, 1=2.5e-6m"
    ] = None,
    rate: Annotated[
        float | None, "sampling rate of a record without times", Within(0, 1e9, "Hz", open=True)
    ] = None,
    frame: Annotated[
        Literal["base", "ground"] | None,
        "what the reading of a motion is relative to (default: base; of an acceleration ground)",
    ] = None,
    next: Annotated[tuple[str, ...], "parameters of the next measurement (example: T tau delay)"] = (),
) -> Mapping[str, object]:
    """Read or make, fit, report and draw."""
    harmonic(scene)
    if drive is not None and record is None:
        raise InvalidValue(f"drive is {drive[0]:g} Hz, {drive[1]:g} mm; it needs a record")
    for name, value in (("columns", columns), ("unit", unit), ("rate", rate), ("frame", frame)):
        if value is not None and record is None:
            raise InvalidValue(f"{name} is {value}; it needs a record")
    if delay_ms is not None and description != "two_parameters" and record is not None:
        raise InvalidValue(f"delay_ms is {delay_ms:g} ms; only --description two_parameters has a delay")
    noise = None if noise_um is None else 1e-6 * noise_um
    delay = None if delay_ms is None else 1e-3 * delay_ms
    if wanted := in_full(next) or (() if record else Plan().names):
        there = described(scene, "two_parameters", delay, corresponding(scene, FREQUENCY_HZ))
        require_names(wanted, there, "next")
    if "amplitude" in wanted:
        raise InvalidValue("next names amplitude, which is measured with each orbit; name another parameter")
    if description == "beam":
        scene = run.choose_modes(*least_modes(scene, {"fold": 0.05}))
    if record is not None:
        read = in_frame(read_record(record, columns=columns, unit=unit, rate=rate), frame, run)
        if drive is not None:
            read = replace(read, frequency=drive[0], amplitude=1e-3 * drive[1])
        oscillator = described(scene, description, delay, frequency_of(read, scene))
        given = {record.stem: (read, oscillator)}
        if fit:
            require_names(in_full(fit), oscillator, more=SENSOR)
            if read.kind != "motion" and (lost := [name for name in fit if name in SENSOR]):
                raise InvalidValue(f"fit names {lost[0]}, which only a motion over time has")
            if {"scale", "gap", "amplitude"} <= {*in_full(fit)}:
                raise InvalidValue("fit names scale, gap and amplitude: give one of the three")
    elif fit:
        raise InvalidValue(f"fit names {' '.join(fit)}, but no record is given: put its file before --fit")
    else:
        given = examples(scene, run, delay)
    found = dict[str, Fit]()
    named = tuple(name for name in in_full(fit) if name not in SENSOR)
    free = tuple(name for name in fit if name in SENSOR) or ("phase", "offset")
    for name, (rows_of, oscillator) in given.items():
        names, at = named or usual(rows_of, oscillator), driven(rows_of, oscillator, named)
        try:
            found[name] = answered(fitted(rows_of, at, names, noise=noise, free=free))
        except (NoAnswer, Refusal) as error:
            if record is not None:
                raise
            run.failed(name, error)  # the study made this record: no wrong use
    if not found:
        return {"rows": []}
    first, *_ = found
    fit_scene = as_scene(scene, found[first])  # before the report: it refuses values that no scene has
    results = report(run, found)
    if fit_scene.spring.kind != "modal_data":
        sheet = f"a sheet of {1e3 * fit_scene.spring.thickness_m:.4g} mm and its damping"
        run.say(f"fitted.toml keeps the beam of the scene: {sheet} give mode 1 the fitted T and mu")
    about = [f"# {row.parameter} {row.value}" for row in results["rows"] if row.record == first]
    run.text("fitted.toml", "\n".join([*about, "", fit_scene.dump()]), "The scene with the fitted values.")
    if wanted:
        known = scene if record is None else fit_scene
        if record is not None and description == "two_parameters":
            delay = parameters_of(found[first].oscillator)["delay"].value
        results["next"] = where_to_measure(known, run, wanted, delay, noise or Plan().noise)
    return results


def examples(scene: Scene, run: Run, delay: float | None) -> dict[str, tuple[Record, ImpactOscillator]]:
    """A record of each kind, stored, and the oscillator of which it is."""
    found = dict[str, tuple[Record, ImpactOscillator]]()
    for kind, description in EXAMPLES.items():
        oscillator = described(scene, description, delay, corresponding(scene, FREQUENCY_HZ))
        found[kind] = synthetic(kind, oscillator, tuple(periods_of(scene).items()), seed=SEED), oscillator
        holds = f"A synthetic record ({kind}) of {description}; each column has its unit in its name."
        run.text(f"{kind}.csv", found[kind][0].text(), holds.replace("_", " "))
    return found


def in_frame(record: Record, frame: str | None, run: Run) -> Record:
    """The record with the place of its sensor; what was chosen in reading it is printed."""
    if record.kind != "motion":
        if frame is not None:
            raise InvalidValue(f"frame is {frame}, but the record is no motion over time")
        return record
    usual, other = ("ground", "base") if record.order == 2 else ("base", "ground")
    if record.reading:
        run.say(record.reading)
        if frame is None:
            run.say(
                f"taken as relative to the {usual}; if not, give --frame {other}: gap and amplitude differ"
            )
    if record.origin:
        run.say(f"the stamps begin at {record.origin:.15g} s: 0 is the first row")
    return replace(record, ground=(frame or usual) == "ground")


def answered(one: Fit) -> Fit:
    """The fit; NoAnswer with reasons and the best values if its residuals are unlike noise."""
    if not one.too_small:
        return one
    why = ["the model is too small for the record"]
    if one.record.kind == "motion":
        (times, values), residuals = one.record.rows.T, one.residuals[:, 0]
        frequency, period = one.oscillator.driven.frequency, one.problem.prediction.m
        why = contradictions(times, values, residuals, frequency, period, one.record.order)
    if one.noise_known:
        why.append(one.against_noise)
    reason = "; ".join([*dict.fromkeys(why)][:2])
    raise NoAnswer(f"{reason}; the best values found, of unknown error, are {without_errors(one)}")
