"""Wrong input at every public entry: one sentence of our own, never a silent number, no traceback of others.

The tables `calls_of_beam`, `calls_of_contact` and `calls_of_orbits` hold right arguments of each public call,
and values that make it wrong.  Besides, every plain number of every right call is replaced by each of
`NO_NUMBERS`.  A public name without three wrong values fails `test_every_public_name_has_wrong_values`.
"""

import dataclasses
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from calls_of_beam import BEAM, INF, NAN, Entry, says, strip
from calls_of_contact import CONTACT, METHODS
from calls_of_orbits import ORBITS
from cases_of_calls import USUAL

import beam
import contact
from beam import parameters
from beam.parameters import Refusal, SuspiciousValue, shown
from contact import integrators, orbits

ROOT = Path(__file__).resolve().parent.parent
TABLES = {"beam": BEAM, "contact": CONTACT, "orbits": ORBITS, "integrators": METHODS}
ENTRIES = {
    f"{package}.{entry.name}": entry for package, table in TABLES.items() for entry in table if entry.wrong
}

NOT_FINITE = (NAN, INF, -INF, 10**400)
NO_NUMBERS = ("a\nb" * 100, True, 1j, [1.0], [], np.arange(1000.0), {"deep": [1] * 500}, object())
"""In place of a number: texts, truth values, complex numbers, lists, arrays, empty and long ones."""

FIELDS = {
    "Pa": "youngs_modulus",
    "kg/m^3": "density",
    "kg": "mass tip_mass",
    "kg m^2": "rotary_inertia",
    "m": "length width thickness radius gap tip_at at amplitude",
    "rad": "angle",
    "rad/s": "omega",
    "1/s": "decay_rate mass_coefficient",
    "Hz": "frequency drive_frequency",
    "s": "free_period duration delay time step stiffness_coefficient",
    "m/s": "speed velocity",
    "s/m": "dissipation",
    "N s/m": "damping",
    "N m^2": "bending_stiffness",
}
UNITS = {field: unit for unit, fields in FIELDS.items() for field in fields.split()}
"""Unit that the sentence gives with a number which is refused."""

RESULTS = {
    "beam": "Backbone ExactModes FiniteRotation PeriodicMotion ShapesAlong SpringMesh",
    "contact": "Band Collision Impacts MaximalOrbit MeasuredRestitution SingleImpactOrbit StrobedOrbit "
    "Trajectory",
    "orbits": "Branch Event Exponents Kick MotionDerivatives OrbitDerivatives OrbitDiagram OrbitEnd "
    "PeriodicOrbit Settled SingleImpactOrbit",
    "integrators": "Plan",
}
"""What entries return; nobody has to make one by hand."""

NO_ENTRIES = {
    "beam": "Damping InvalidType InvalidValue Refusal Support SuspiciousValue suspect "
    "solid_spring write_frames write_mode_motion write_modes",  # these: tests/beam/test_paraview_files.py
    "contact": "BranchEnded Chatter ContactError ContactLaw ContactTooStiff Diverged ImpactKind NoDerivative "
    "NotPeriodic Regime StepTooLarge StrobedMap TouchedAtOnce UnresolvedCrossing",
    "orbits": "Family MaximalFamily Orbit",  # the second is in the table of contact
    "integrators": "Exact Integrator",  # the first takes no numbers
}
"""Protocols, abstract classes, types, enumerations and errors."""


def right(entry: Entry) -> dict[str, Any]:
    """The arguments of a right call."""
    return entry.right(USUAL.get(entry.over))


NUMBERS = [
    pytest.param(entry, field, id=f"{name}-{field}")
    for name, entry in ENTRIES.items()
    for field, value in right(entry).items()
    # a list of counts is a right use of the elements of a mesh
    if type(value) in (float, int) and entry.name != "assemble"
]
ROWS = [
    pytest.param(entry, field, value, error, id=f"{name}-{field}-{number}")
    for name, entry in ENTRIES.items()
    for number, (field, value, error) in enumerate(entry.wrong)
]


def refusal(entry: Entry, field: str, value: object, error: Any) -> Refusal:
    """The error that this value brings, if it is one sentence and was raised in one of our packages."""
    with pytest.raises(error) as caught:
        entry.call(**right(entry) | {field: value})
    text = str(caught.value)
    assert isinstance(caught.value, Refusal)
    assert text.isprintable() and 0 < len(text) < 400 and not text.endswith("."), text
    place = Path(caught.traceback[-1].path)
    assert place.is_relative_to(ROOT / "beam") or place.is_relative_to(ROOT / "contact"), f"{place}: {text}"
    return caught.value


def quoted(value: Any) -> list[str]:
    """How a sentence may quote a value: as shown, by its shape or length, or its entry that is wrong."""
    found = [shown(value)]
    if isinstance(value, list | tuple | dict | np.ndarray):
        entries = list(value.values() if isinstance(value, dict) else value)
        found += [f"{len(entries)} entries", *(shown(entry) for entry in entries)]
        found += [f"{entry:g}" for entry in entries if isinstance(entry, float)]
        found += [f"shape {np.shape(value)}"] if len({np.shape(entry) for entry in entries}) < 2 else []
    elif isinstance(value, float):
        found.append(f"shape {np.shape(value)}")
    return found


@pytest.mark.parametrize("name", ENTRIES)
def test_the_right_call_is_right_and_raises_no_eyebrow(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", SuspiciousValue)
        ENTRIES[name].call(**right(ENTRIES[name]))


@pytest.mark.parametrize(("entry", "field", "value", "error"), ROWS)
def test_the_sentence_names_the_field_and_the_value(entry: Entry, field: str, value: Any, error: Any) -> None:
    words = None
    if isinstance(value, says):
        value, words = value.value, value.words
    found = refusal(entry, field, value, error)
    text = str(found)
    if words:
        assert words in text
        return
    start = re.search(rf"\b{field}\b(\[.*?\])?( of the [a-z ]+?)? (is|has|holds|must|runs from) ", text)
    assert start and (found.field == field or entry not in BEAM), text
    assert any(words in text[start.start() :] for words in quoted(value)), text
    if error is ValueError and type(value) in (int, float) and field in UNITS:
        assert f"{shown(value)} {UNITS[field]}" in text


@pytest.mark.parametrize(("entry", "field"), NUMBERS)
def test_no_number_is_taken_for_one(entry: Entry, field: str) -> None:
    for values, error in ((NOT_FINITE, ValueError), (NO_NUMBERS, (TypeError, ValueError))):
        for value in values:
            text = str(refusal(entry, field, value, error))
            assert field.split("_")[-1] in text or "duration" in text, (value, text)


@pytest.mark.parametrize("module", [beam, contact, orbits, integrators])
def test_every_public_name_has_wrong_values(module: ModuleType) -> None:
    package = module.__name__.rpartition(".")[2]
    names = {name for name in module.__all__ if callable(getattr(module, name))}
    listed = {re.match(r"\w+", entry.name)[0] for entry in TABLES[package] if entry.wrong}
    assert names - {*RESULTS[package].split(), *NO_ENTRIES[package].split()} <= listed


@pytest.mark.parametrize("name", sorted({re.match(r"\w+\.\w+", name)[0] for name in ENTRIES}))
def test_every_function_or_class_has_three_wrong_values(name: str) -> None:
    assert sum(len(entry.wrong) for other, entry in ENTRIES.items() if re.match(rf"{name}\b", other)) >= 3


# --------------------------------------------------------------------------------------------------- warnings


def warned(make: Callable[[], object]) -> list[str]:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        make()
    assert all(warning.category is SuspiciousValue for warning in found)
    assert all(Path(warning.filename) == Path(__file__) for warning in found), [w.filename for w in found]
    return [str(warning.message) for warning in found]


MODE = beam.single_mode(free_period=40.8e-3, decay_rate=3.56)
LAW = contact.NewtonRestitution(local_restitution=0.1)


def leaf(length: float, **tip: float) -> object:
    return beam.cantilever(length=length, section=strip(), tip=beam.Tip(mass=0.004, **tip))


def driven(**numbers: float) -> object:
    drive = contact.HarmonicDrive(**dict(frequency=22.2, amplitude=1e-3) | numbers)
    return contact.ImpactOscillator(model=MODE, stop=contact.Stop(gap=0.0107, law=LAW), drive=drive)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: leaf(0.005), "of the strip's length 0.005 m"),
        (lambda: leaf(0.01), "it is a plate"),
        (lambda: leaf(0.13, rotary_inertia=1e-4), "rotary_inertia of the tip is 0.0001"),
        (lambda: beam.single_mode(free_period=0.04, decay_rate=500.0), "it hardly oscillates"),
        (lambda: driven(amplitude=1.5), "amplitude of the drive is 1.5 m"),
        (lambda: contact.ImpactOscillator(model=MODE, stop=contact.Stop(gap=3.0, law=LAW)), "gap is 3 m"),
        (lambda: driven(frequency=0.0222), "frequency of the drive is 0.0222 Hz"),
        (lambda: contact.simulate(driven(amplitude=0.0), periods=1), "starts at rest: nothing moves"),
    ],
)
def test_a_suspicious_value_is_taken_with_a_warning_that_says_why(
    make: Callable[[], object], words: str
) -> None:
    """Further ones are in tests/studies/test_scene_doubts.py, as keys of a scene."""
    sentences = warned(make)
    assert any(words in sentence for sentence in sentences), sentences
    assert all(sentence.isprintable() and len(sentence) < 250 for sentence in sentences)


def test_each_kind_of_warning_is_given_once_and_not_without_metres() -> None:
    parameters._said.clear()
    own = dataclasses.replace(MODE.truncated(1), dimensionless=True)
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("default")
        for gap in (2.0, 2.5, 3e4):
            stop = contact.Stop(gap=gap, law=LAW)
            contact.ImpactOscillator(model=MODE, stop=stop)
            contact.ImpactOscillator(model=own.truncated(1), stop=stop)
        driven(amplitude=5.0)
    assert [str(one.message).split(" is ")[0] for one in found] == ["gap", "amplitude of the drive"]
    assert all("dimensionless=True" in str(one.message) for one in found)
    drive = contact.HarmonicDrive(frequency=22.2, amplitude=5.0)
    stop = contact.Stop(gap=0.1, law=LAW)
    assert not warned(lambda: contact.ImpactOscillator(model=own, stop=stop, drive=drive))
