"""The parameters that a record may determine of an impact oscillator: values, derivatives, and other values.

free_period T, decay_rate c     of mode 1: omega_1^2 = (2 pi/T)^2 + (c/2)^2; the other frequencies keep
                                their ratio to omega_1, the other decay rates theirs to c
tip_mass                        at the tip, of a model with more than one mode; T and the decay rates are kept
gap                             of the stop
restitution, delay, stiffness, damping, dissipation     the plain numbers of the contact law
frequency, amplitude            of the base motion; with one mode Z is that of Eq. (1), Gamma phi Z of a
                                spring, so that it is fitted where the record is not that of one mode
"""

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from difflib import get_close_matches
from numbers import Real
from typing import Any, Literal

from beam import (
    InvalidValue,
    SuspiciousValue,
    decay_rate_change,
    free_period_change,
    tip_mass_change,
    with_tip_mass,
)
from contact import (
    ContactLaw,
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    ImpactOscillator,
    LinearContact,
)
from contact.orbits import Change
from studies.shell.scene import Scene, beam_at, hertz_of, single_mode_at
from studies.shell.scene.mode_lists import LISTS

Description = Literal["one_mode", "two_parameters", "beam"]

LEAST = {"delay": 1e-3, "restitution": 0.01, "decay_rate": 0.01}
"""What counts as a change of a parameter that may be zero, times drive periods or per drive period if it has
a unit."""

ALIASES = {"T": "free_period", "mu": "decay_rate", "tau": "restitution"}
"""Symbols of the letter that name parameters on the command line."""

OF_SOME = ("tip_mass", "restitution", "delay", "stiffness", "damping", "dissipation")
"""Parameters that only a model of several modes or some laws have."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter of an oscillator: its value, the size that a change of it is measured by, its unit."""

    value: float
    size: float
    unit: str


def numbers_of(law: ContactLaw) -> dict[str, tuple[str, str]]:
    """The plain numbers of a law in their order: name -> field and unit."""
    units = {"restitution": "s^0", "delay": "s"} if isinstance(law, DelayedRestitution) else law.units
    plain = {
        field: unit.strip("[]") for field, unit in units.items() if isinstance(getattr(law, field), Real)
    }
    return {field.removeprefix("local_"): (field, unit.replace("s^0", "1")) for field, unit in plain.items()}


def parameters_of(oscillator: ImpactOscillator) -> dict[str, Parameter]:
    """The parameters that this oscillator has, by name."""
    law, drive, period = oscillator.stop.law, oscillator.driven, oscillator.period
    mass = oscillator.model.tip_mass
    known = {
        "free_period": (oscillator.model.free_period, "s"),
        "decay_rate": (float(oscillator.model.decay_rate[oscillator.model.leading_mode]), "1/s"),
        **({"tip_mass": (float(mass), "kg")} if mass and oscillator.n_modes > 1 else {}),
        "gap": (oscillator.stop.gap, "m"),
        "frequency": (drive.frequency, "Hz"),
        "amplitude": (drive.amplitude, "m"),
        **{name: (getattr(law, field), unit) for name, (field, unit) in numbers_of(law).items()},
    }
    scale = {"s": period, "1/s": 1.0 / period}
    return {
        name: Parameter(value=v, size=max(abs(v), LEAST.get(name, 0.0) * scale.get(unit, 1.0)), unit=unit)
        for name, (v, unit) in known.items()
    }


def changes_of(oscillator: ImpactOscillator, names: Sequence[str]) -> list[Change]:
    """How the oscillator's numbers change with the named parameters."""
    model, law = oscillator.model, [*numbers_of(oscillator.stop.law)]
    found: dict[str, Change] = {
        "free_period": Change(model=free_period_change(model)) if "free_period" in names else Change(),
        "decay_rate": Change(model=decay_rate_change(model, None)) if "decay_rate" in names else Change(),
        "tip_mass": Change(model=tip_mass_change(model)) if "tip_mass" in names else Change(),
        "gap": Change(gap=1.0),
        "frequency": Change(frequency=1.0),
        "amplitude": Change(amplitude=1.0),
    } | {name: Change(law=(1.0 - i, float(i))) for i, name in enumerate(law)}
    return [found[name] for name in names]


def in_full(names: Sequence[str]) -> tuple[str, ...]:
    """The names with each symbol of `ALIASES` replaced."""
    return tuple(ALIASES.get(name, name) for name in names)


def require_names(
    names: Sequence[str], oscillator: ImpactOscillator, option: str = "fit", more: Iterable[str] = ()
) -> None:
    """ValueError unless each names a parameter of this oscillator, or is one of `more`, given once."""
    known, count = [*parameters_of(oscillator), *more], oscillator.n_modes
    for name in names:
        if name not in known and name in OF_SOME:
            whose = f"{type(oscillator.stop.law).__name__} with {count} mode{'s' * (count > 1)}"
            others = ", ".join(known)
            raise InvalidValue(f"{option} names {name}, which {whose} does not have; there are {others}")
        if name not in known:
            nearest = get_close_matches(name[:60], [*known, *OF_SOME, *ALIASES], n=1, cutoff=0.0)[0]
            raise InvalidValue(f"{option} names {name[:60]!r}, no parameter; the nearest is {nearest}")
    if len(set(names)) < len(names) or not names:
        raise InvalidValue(f"{option} names {', '.join(names) or 'nothing'}; it must name each one once")


@contextmanager
def through_any_value() -> Iterator[None]:
    """No warnings of suspicious values, as a search may pass through any."""
    with warnings.catch_warnings(action="ignore", category=SuspiciousValue):
        yield


@through_any_value()
def with_values(oscillator: ImpactOscillator, values: Mapping[str, float]) -> ImpactOscillator:
    """The oscillator with other values of some parameters; ValueError where one is out of range."""
    model, stop, drive, law = oscillator.model, oscillator.stop, oscillator.driven, oscillator.stop.law
    if "tip_mass" in values:
        model = with_tip_mass(model, values["tip_mass"])
    if "free_period" in values or "decay_rate" in values:
        k = model.leading_mode
        before = float(model.decay_rate[k])
        rate, period = values.get("decay_rate", before), values.get("free_period", model.free_period)
        if not (period > 0.0 and rate >= 0.0):
            raise InvalidValue(f"free_period is {period:g} s, decay_rate {rate:g} 1/s; both must be positive")
        faster = math.hypot(2.0 * math.pi / period, 0.5 * rate) / float(model.omega[k])
        rates = model.decay_rate * (rate / before) if before > 0.0 else model.decay_rate + rate
        model = replace(model, omega=model.omega * faster, decay_rate=rates)
    own: dict[str, Any] = {
        field: values[name] for name, (field, _) in numbers_of(law).items() if name in values
    }
    if own or "gap" in values:
        changed: ContactLaw = replace(law, **own)  # type: ignore[type-var]
        stop = replace(stop, gap=values.get("gap", stop.gap), law=changed)
    moved = {name: values[name] for name in ("frequency", "amplitude") if name in values}
    return replace(oscillator, model=model, stop=stop, drive=replace(drive, **moved) if moved else drive)


def described(
    scene: Scene, description: Description, delay: float | None, frequency: float
) -> ImpactOscillator:
    """The oscillator of the scene at a drive frequency [Hz], at the excess at which periods are born.

    A `delay` [s] that is not given is T/136, 0.3 ms for the letter's spring: about that of its collisions.
    """
    if description == "beam":
        oscillator = beam_at(scene, frequency)
    else:
        oscillator = single_mode_at(scene, frequency)
    if description == "two_parameters":
        delay = scene.single_mode.free_period_s / 136.0 if delay is None else delay
        law = DelayedRestitution(restitution=scene.single_mode.restitution, delay=delay)
        oscillator = replace(oscillator, stop=replace(oscillator.stop, law=law))
    return oscillator.with_excess(scene.scan.born_excess)


def fitted_scene(scene: Scene, oscillator: ImpactOscillator, frequencies: Sequence[float]) -> Scene:
    """The scene with the modes of a fitted oscillator as measured ones, its law, gap and drive frequencies.

    A scene has no key for a constant delay; Hertz's stiffness is that of harder or softer bodies.
    """
    model, law = oscillator.model, oscillator.stop.law
    known = {name: one.value for name, one in parameters_of(oscillator).items()}
    changes: dict[str, object] = {
        **{f"modal_data.{name}": () for name in LISTS},
        "spring.kind": "modal_data",
        "modal_data.frequencies_hz": model.frequencies_hz.tolist(),
        "modal_data.decay_rates_per_s": model.decay_rate.tolist(),
        "modal_data.tip_values": model.phi.tolist(),
        "modal_data.participation": model.participation.tolist(),
        "modal_data.tip_mass_kg": model.tip_mass or 0.0,
        "modal_data.static_compliance_m_per_n": model.static_compliance or 0.0,
        "single_mode.free_period_s": known["free_period"],
        "single_mode.decay_rate_per_s": known["decay_rate"],
        "stop.gap_m": known["gap"],
        "drive.frequencies_hz": list(frequencies),
    }
    if isinstance(law, LinearContact):
        changes |= {"contact.stiffness_n_per_m": law.stiffness, "contact.damping_ns_per_m": law.damping}
    elif isinstance(law, HertzContact | HuntCrossley):
        moduli, harder = ("ball_young_modulus_pa", "plate_young_modulus_pa"), law.stiffness
        harder /= hertz_of(scene).stiffness
        changes |= {f"tip.{key}": harder * scene.number(f"tip.{key}") for key in moduli}
        changes["contact.dissipation_s_per_m"] = getattr(law, "dissipation", 0.0)
    else:
        changes |= {"contact.law": "newton", "contact.local_restitution": known["restitution"]}
    if model.n_modes == 1:
        changes["single_mode.restitution"] = known["restitution"]
    return scene.replace(changes, provenance="fitted")
