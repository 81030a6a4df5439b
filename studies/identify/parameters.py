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
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from functools import partial

from beam import decay_rate_change, free_period_change
from contact import ContactLaw, ImpactOscillator
from contact.orbits import Change

__all__ = ["Parameter", "changes_of", "parameters_of", "require_names", "with_values"]

SHORT_DELAY = 1e-3
"""Of the drive period: what counts as one unit of a delay, which may be zero."""

LAW_UNITS = {
    "local_restitution": "1", "restitution": "1", "delay": "s", "stiffness": "N/m", "damping": "N s/m",
    "dissipation": "s/m",
}  # fmt: skip
"""Fields of contact laws that are plain numbers, and their units where a law does not say them."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter of an oscillator: its value, the size that a change of it is measured by, its unit."""

    value: float
    size: float
    unit: str


def law_fields(law: ContactLaw) -> list[str]:
    """The names of its plain numbers."""
    return [field.name for field in fields(law) if field.name in LAW_UNITS]


def parameters_of(oscillator: ImpactOscillator) -> dict[str, Parameter]:
    """The parameters that this oscillator has, by name."""
    law, drive = oscillator.stop.law, oscillator.driven
    known = {
        "free_period": (oscillator.model.free_period, "s"),
        "decay_rate": (float(oscillator.model.decay_rate[0]), "1/s"),
        "gap": (oscillator.stop.gap, "m"),
        "frequency": (drive.frequency, "Hz"),
        "amplitude": (drive.amplitude, "m"),
    }
    for field in law_fields(law):
        unit = law.units.get(field, LAW_UNITS[field]).strip("[]")
        known[field.removeprefix("local_")] = getattr(law, field), unit
    period = oscillator.period
    least = {"delay": SHORT_DELAY * period, "restitution": 0.01, "decay_rate": 0.01 / period}
    return {
        name: Parameter(value=value, size=max(abs(value), least.get(name, 0.0)), unit=unit)
        for name, (value, unit) in known.items()
        if not callable(value)
    }


def changes_of(oscillator: ImpactOscillator, names: Sequence[str]) -> list[Change]:
    """How the oscillator's numbers change with the named parameters."""
    law = oscillator.stop.law
    numbers = [field.removeprefix("local_") for field in law_fields(law)]
    of_model = {"free_period": free_period_change, "decay_rate": partial(decay_rate_change, mode=None)}

    def change(name: str) -> Change:
        if name in of_model:
            return Change(model=of_model[name](oscillator.model))
        if name in numbers:
            return Change(law=(float(numbers.index(name) == 0), float(numbers.index(name) == 1)))
        return Change(**{name: 1.0})

    return [change(name) for name in names]


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
        period = values.get("free_period") or model.free_period
        if not (period > 0.0 and rate >= 0.0):
            raise ValueError(f"free_period is {period:g} s, decay_rate {rate:g} 1/s; they must be above zero")
        pace = math.hypot(2.0 * math.pi / period, 0.5 * rate) / float(model.omega[0])
        rates = model.decay_rate * (rate / before) if before > 0.0 else model.decay_rate + rate
        model = replace(model, omega=model.omega * pace, decay_rate=rates)
    own = {field: values[name] for field in law_fields(law) if (name := field.removeprefix("local_")) in values}
    if own or "gap" in values:
        changed: ContactLaw = replace(law, **own)  # type: ignore[type-var]
        stop = replace(stop, gap=values.get("gap", stop.gap), law=changed)
    moved = {name: values[name] for name in ("frequency", "amplitude") if name in values}
    return replace(oscillator, model=model, stop=stop, drive=replace(drive, **moved) if moved else drive)
