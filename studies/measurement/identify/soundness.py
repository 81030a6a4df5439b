"""Whether a record can answer, and whether the given values are in its units; before any search."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from beam import InvalidValue
from contact import ImpactOscillator
from studies.measurement.identify.diagnosis import defects, drive_found
from studies.measurement.identify.records import NoAnswer, Record
from studies.physics.parameters import parameters_of, with_values

MOST, DENSE = 20_000, 40
"""Rows of a displacement that are fitted at most; rows a drive period that are left of more."""

OFF, APART, BEYOND = 0.01, 100.0, 10.0
"""Part by which the given drive frequency may be off. Ratio of an amplitude to that of grazing which may be
one of units; of the largest strobe point to the gap."""


RATIOS = (
    ("milli{}", "1000", 1e3, 3.0, ("gap", "amplitude", "free_period")),
    ("micro{}", "1e6", 1e6, 3.0, ("gap", "amplitude", "free_period")),
    ("units of g", "9.81", 9.81, 1.01, ("amplitude",)),
    ("an angular frequency", "2 pi", 2.0 * math.pi, 1.01, ("free_period", "frequency")),
)
"""Units, their ratio, by which factor another may differ and still be one (10 is none), and of what."""


def sound(record: Record, oscillator: ImpactOscillator) -> tuple[Record, ImpactOscillator]:
    """The rows of a displacement that are fitted, and the oscillator at the drive that they show.

    NoAnswer is raised for defects, InvalidValue for a drive of another record; `notes` say what was changed.
    """
    (times, x), given = record.rows.T, record.frequency
    if faults := defects(times, x, given):
        raise NoAnswer(f"the record has no answer: {'; '.join(faults)}")
    if given and (other := drive_found(times, x, given)):
        if abs(given / other[0] - 1.0) > OFF:
            raise InvalidValue(other[1])
        record = replace(record, frequency=other[0], notes=(f"{other[1]}, where the fit begins",))
        oscillator = with_values(oscillator, {"frequency": other[0]})
    if (rows := times.size) > MOST:
        dense = float(rows / ((times[-1] - times[0]) * (record.frequency or oscillator.driven.frequency)))
        step = max(1, min(-(-rows // MOST), int(dense / DENSE)))
        kept = record.rows[::step][:MOST]
        note = f"1 row in {step} of {rows} is fitted, up to {kept[-1, 0]:.6g} s: {len(kept)} rows"
        record = replace(record, rows=kept, notes=(*record.notes, note))
    return record, oscillator


def unit_of(found: float, given: float, what: str) -> str | None:
    """Words for the unit in which the record or the given value of `what` would agree with the other one."""
    base = "seconds" if "period" in what else "metres"
    for unit, number, factor, near, whose in RATIOS:
        for one, other, thing in ((given, found, f"the given {what}"), (found, given, "the record")):
            if what in whose and 1.0 / near < one / (factor * other) < near:
                return f"{thing} looks like {unit.format(base)}: divide by {number}"
    return None


def require_units(record: Record, oscillator: ImpactOscillator, found: Mapping[str, float]) -> None:
    """InvalidValue if the ratio of two units is between given values and the ones `found` in the record."""
    for name in ("amplitude" if record.amplitude else "gap", "free_period"):
        known = parameters_of(oscillator)[name]
        if name in found and (words := unit_of(found[name], known.value, name)):
            both = f"{found[name]:.4g} {known.unit} by the record, {known.value:.4g} {known.unit} as given"
            raise InvalidValue(f"{name} is {both}: {words}")


def require_strobe_units(record: Record, oscillator: ImpactOscillator) -> None:
    """InvalidValue if strobe points are far beyond the stop, or the amplitude is far from grazing."""
    farthest, gap = float(np.abs(record.observed[:, 0]).max()), oscillator.stop.gap
    if farthest > BEYOND * gap:
        unit = "millimetres: divide by 1000" if farthest < 3e4 * gap else "micrometres: divide by 1e6"
        both = f"x_m reaches {farthest:.4g} m, where the gap is {gap:.4g} m"
        raise InvalidValue(f"{both}: the record looks like {unit}")
    given, least = record.amplitude or 0.0, oscillator.grazing_amplitude()
    if given > APART * least or 0.0 < given < least / APART:
        raise InvalidValue(
            f"the given amplitude is {given:.4g} m, but the tip meets the stop from {least:.4g} m on: "
            "--drive takes Hz and mm"
        )
