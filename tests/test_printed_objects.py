"""How public objects print: in a few lines, with units, and as a table in a notebook."""

import dataclasses
import re

import numpy as np
import pytest
from calls_of_beam import BEAM
from calls_of_contact import CONTACT, METHODS
from calls_of_orbits import ORBITS
from cases_of_calls import USUAL
from public_names import public

from beam import BRASS, ModalModel
from beam.record import LINES, WIDEST, record, units_of

OBJECTS = {
    f"{entry.name}-{number}": (entry, number)
    for table in (BEAM, CONTACT, METHODS, ORBITS)
    for number, entry in enumerate(table)
    if entry.wrong and entry.name != "final classes"
}
RECORDS = {thing for thing in public().values() if dataclasses.is_dataclass(thing)}


@pytest.mark.parametrize("name", OBJECTS)
def test_what_a_public_call_returns_prints_in_a_few_lines(name):
    entry, _ = OBJECTS[name]
    found = entry.call(**entry.right(USUAL.get(entry.over)))
    for one in found if isinstance(found, list | tuple) else (found,):
        if type(one).__module__.partition(".")[0] not in ("beam", "contact") or isinstance(one, type):
            continue
        lines = repr(one).splitlines()
        assert 1 <= len(lines) <= LINES and max(map(len, lines)) <= WIDEST + 5, repr(one)
        assert lines[0].startswith(type(one).__name__), lines[0]
        if type(one) in RECORDS:
            assert one._repr_html_().count("<table>") >= 1


def test_every_number_with_a_unit_prints_it():
    """Each unit that a docstring gives to a plain number stands behind that number."""
    assert repr(BRASS) == (
        "Material(youngs_modulus=1.05e+11 Pa, poissons_ratio=0.34, density=8500 kg/m^3, loss_factor=0.001)"
    )
    counted = 0
    for entry, _ in OBJECTS.values():
        one = entry.call(**entry.right(USUAL.get(entry.over))) if entry.call in RECORDS else None
        text, units = repr(one), units_of(type(one))
        for field in dataclasses.fields(one) if type(one) in RECORDS else ():
            value = getattr(one, field.name)
            if units.get(field.name) and f"{field.name}=" in text and type(value) is float:
                counted += 1
                assert f"{field.name}={value:.6g} {units[field.name]}" in text, text
    assert counted > 30


def test_defaults_long_arrays_and_long_records_are_cut():
    @record
    class Many:
        """Numbers.

        Parameters
        ----------
        first, second : float
            A length [m] and a time [s].
        row : ndarray, shape (n,)
            Forces [N].
        """

        first: float
        second: float = 2.0
        row: np.ndarray
        model: ModalModel | None = None

    assert repr(Many(first=1.5, row=np.ones(3))) == "Many(first=1.5 m, row=(1, 1, 1) N)"
    text = repr(Many(first=1.5, second=3.0, row=np.linspace(0.0, 1e4, 99)))
    assert text == "Many(first=1.5 m, second=3 s, row=float64 of shape (99,), 0 to 10000 N)"
    model = ModalModel(omega=[154, 960], decay_rate=[3.6, 20], phi=[8, 9], participation=[0.1, 0.05])
    text = repr(Many(first=1.5, row=np.full(9, np.nan), model=model))
    assert "model=ModalModel(omega=(154, 960) rad/s, decay_rate=(3.6, 20) 1/s, points={tip}, ...)" in text
    assert re.findall(r"<th>(\w+ \[.*?\])", model._repr_html_())[0] == "omega [rad/s]"
    assert "<td>960</td><td>20</td><td>9</td><td>0.05</td>" in model._repr_html_()
