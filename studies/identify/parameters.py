"""The parameters that a record may tell of an impact oscillator: value, unit, and the oscillator with others.

    free_period T, decay_rate c     of mode 1: omega_1^2 = (2 pi/T)^2 + (c/2)^2; the other frequencies keep
                                    their ratio to omega_1, the other decay rates theirs to c
    gap                             of the stop
    restitution, delay, stiffness, damping, dissipation     the plain numbers of the contact law
    frequency, amplitude            of the base motion
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches

from contact import ImpactOscillator

__all__ = ["Parameter", "free_period_of", "parameters_of", "require_names", "with_values"]

SHORT_DELAY = 1e-3
"""Of the drive period: what counts as one unit of a delay, which may be zero."""

LAW_UNITS = {
    "local_restitution": "1", "restitution": "1", "delay": "s", "stiffness": "N/m", "damping": "N s/m",
    "dissipation": "s/m",
}  # fmt: skip
"""Fields of contact laws that are plain numbers; Hertz's stiffness is in N/m^1.5."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter of an oscillator: its value, the size that a change of it is measured by, its unit."""

    value: float
    size: float
    unit: str


def free_period_of(oscillator: ImpactOscillator) -> float:
    """Damped free period of mode 1 [s]."""
    model = oscillator.model
    return 2.0 * math.pi / math.sqrt(model.omega[0] ** 2 - (0.5 * model.decay_rate[0]) ** 2)


def parameters_of(oscillator: ImpactOscillator) -> dict[str, Parameter]:
    """The parameters that this oscillator has, by name."""
    law, drive = oscillator.stop.law, oscillator.driven
    known = {
        "free_period": (free_period_of(oscillator), "s"),
        "decay_rate": (float(oscillator.model.decay_rate[0]), "1/s"),
        "gap": (oscillator.stop.gap, "m"),
        "frequency": (drive.frequency, "Hz"),
        "amplitude": (drive.amplitude, "m"),
    }
    for field, unit in LAW_UNITS.items():
        if field in type(law).__dataclass_fields__:
            hertzian = field == "stiffness" and type(law).__name__ != "LinearContact"
            known[field.removeprefix("local_")] = getattr(law, field), "N/m^1.5" if hertzian else unit
    period = oscillator.period
    least = {"delay": SHORT_DELAY * period, "restitution": 0.01, "decay_rate": 0.01 / period}
    return {
        name: Parameter(value=value, size=max(abs(value), least.get(name, 0.0)), unit=unit)
        for name, (value, unit) in known.items()
        if not callable(value)
    }


def require_names(names: Sequence[str], oscillator: ImpactOscillator) -> None:
    """ValueError unless each is the name of a parameter of this oscillator, given once."""
    known = parameters_of(oscillator)
    for name in names:
        if name not in known:
            others = {field.removeprefix("local_") for field in LAW_UNITS} - set(known)
            law = type(oscillator.stop.law).__name__
            if name in others:
                raise ValueError(f"fit names {name}, which {law} does not have; there are {', '.join(known)}")
            nearest = get_close_matches(name[:60], [*known, *others], n=1, cutoff=0.0)[0]
            raise ValueError(f"fit names {name[:60]!r}, which is no parameter; the nearest is {nearest}")
    if len(set(names)) < len(names) or not names:
        raise ValueError(f"fit names {', '.join(names) or 'nothing'}; it must name each parameter once")


def with_values(oscillator: ImpactOscillator, values: Mapping[str, float]) -> ImpactOscillator:
    """The oscillator with other values of some parameters; ValueError where one is out of range."""
    model, stop, drive, law = oscillator.model, oscillator.stop, oscillator.driven, oscillator.stop.law
    if "free_period" in values or "decay_rate" in values:
        before, rate = float(model.decay_rate[0]), values.get("decay_rate", float(model.decay_rate[0]))
        period = values.get("free_period", 0.0) or free_period_of(oscillator)
        if not (period > 0.0 and rate >= 0.0):
            raise ValueError(f"free_period is {period:g} s, decay_rate {rate:g} 1/s; they must be above zero")
        pace = math.hypot(2.0 * math.pi / period, 0.5 * rate) / float(model.omega[0])
        rates = model.decay_rate * (rate / before) if before > 0.0 else model.decay_rate + rate
        model = replace(model, omega=model.omega * pace, decay_rate=rates)
    fields = {
        field: values[name] for field in type(law).__dataclass_fields__
        if (name := field.removeprefix("local_")) in values
    }  # fmt: skip
    if fields or "gap" in values:
        stop = replace(stop, gap=values.get("gap", stop.gap), law=replace(law, **fields) if fields else law)
    moved = {name: values[name] for name in ("frequency", "amplitude") if name in values}
    return replace(oscillator, model=model, stop=stop, drive=replace(drive, **moved) if moved else drive)
