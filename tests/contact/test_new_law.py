"""A law is one file: nothing of it stands elsewhere, and a new one, N = k d^3, needs no other change."""

import os
import shutil
import subprocess
import sys
import tokenize
from pathlib import Path

import pytest
from oscillators import slow

import contact
from contact import ContactLaw
from contact.touch import LAWS

ROOT = Path(__file__).parents[2]

LAW = '''"""N = k d^3 for d > 0, by the series in time."""
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from contact.flight.tip import tip_rounding
from contact.flight.polynomial_root import first_polynomial_root
from contact.laws import ContactLaw
from contact.machine.compiled import kernel, part
from contact.touch.time_series import DEPTH, FORCE, ORDER, begin, extend, longest_step
from contact.state import CONTACT, OUTSIDE

LAW, METHOD, REGIMES = "OwnContact", "cubic-series", (OUTSIDE, CONTACT)

@dataclass(frozen=True, kw_only=True)
class OwnContact(ContactLaw):
    stiffness: float
    code: ClassVar[int] = 9
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^3"}
@part
def force(numbers, depth, rate):
    return numbers.number0 * depth**3
@part
def stiffness(numbers, depth, rate):
    return 3.0 * numbers.number0 * depth**2, 0.0
@kernel
def slopes(numbers, run, series, weights):
    depth, force = series.scalars[DEPTH], series.scalars[FORCE]
    weights.time[0] = 1.0
    for n in range(ORDER):
        weights.depth[n] = 3.0 * numbers.number0 * np.sum(depth[: n + 1] * depth[n::-1])
        weights.force[n], weights.first[n] = force[n], force[n] / numbers.number0
    return ORDER
@kernel
def step(numbers, run, u, v, limit, series):
    depth, force, square = series.scalars[DEPTH], series.scalars[FORCE], np.zeros(ORDER)
    begin(numbers, run.clock, u, v, series)
    for n in range(ORDER - 1):
        square[n] = np.sum(depth[: n + 1] * depth[n::-1])
        force[n] = numbers.number0 * np.sum(square[: n + 1] * depth[n::-1])
        extend(numbers, n, force[n], series)
    h = min(longest_step(numbers, 0.5 * numbers.number0 * depth[0] ** 4, u, v, series), limit)
    end = first_polynomial_root(depth, -1.0, h, tip_rounding(numbers, u, v))
    return (end, end, OUTSIDE) if end >= 0.0 else (h, h, CONTACT)
'''

PROGRAM = """
import sys
import numpy as np
import pytest
from oscillators import modes_on_stop
from contact import OwnContact, State, simulate
from contact.integrators import CentralDifference, GeneralisedAlpha, Splitting
from contact.orbits import Shooting

law, speed, whole = OwnContact(stiffness=1e12), 2.0, sys.argv[1] == "whole"
free, thrown = modes_on_stop(0.0, phi=0.5, law=law), State(displacement=[0.0], velocity=[2.0 * speed])
# a mass of m = 4 kg goes (2 m v^2/k)^(1/4) deep, and the contact is 2.622 times as long as a way so far at v
lasts = 2.0 * 1.3110287771460599 * (8.0 * speed**2 / 1e12) ** 0.25 / speed
for method in (CentralDifference, GeneralisedAlpha, Splitting)[: 3 if whole else 1]:
    hits = [simulate(free, thrown, duration=0.02, method=method(step=h)).impacts for h in (4e-5, 2e-5, 1e-5)]
    errors = [abs(hit.end[0] - hit.start[0] - lasts) for hit in hits]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.2), (method, errors)
if whole:
    hit = simulate(free, thrown, duration=0.02).impacts
    assert hit.rebound[0] == pytest.approx(-speed, rel=1e-14) and abs(hit.loss[0]) < 1e-13
    assert hit.end[0] - hit.start[0] == pytest.approx(lasts, rel=1e-12)
    spring = modes_on_stop([154.0, 980.0], [3.56, 20.0], [10.0, 9.0], [0.1, 0.05], law=law, drive=22.2)
    orbit = Shooting(oscillator=spring, m=5).at_speed(0.3)
    driven, start = spring.with_excess(orbit.excess), orbit.state()
    run = simulate(driven, start, periods=5)
    assert len(run.impacts) == 1 and run.impacts.approach[0] == pytest.approx(0.3, rel=1e-9)
    assert run.end.displacement == pytest.approx(start.displacement, abs=1e-9 * spring.stop.gap)
    near = simulate(driven, start, periods=5, method=Splitting(step=2e-5, order=4)).end
    assert near.displacement == pytest.approx(start.displacement, abs=1e-7 * spring.stop.gap)
"""


def words_of(path: Path) -> set[str]:
    """The names in the code of a file, and its texts of one word; docstrings and comments are longer."""
    with path.open() as file:
        return {token.string.strip("\"'") for token in tokenize.generate_tokens(file.readline)}


def test_what_serves_a_single_law_stands_in_its_file_alone():
    """`State` keeps the wait and the rebound of a delayed rebound: the one exception."""
    laws = [name for name, one in vars(contact).items() if getattr(one, "__mro__", ())[1:2] == (ContactLaw,)]
    files = [law.__name__.rpartition(".")[2] for law in LAWS.values()]
    of_one = {*laws, *files, *(name.upper() for name in files)}
    of_one |= {"INSIDE", "SUSTAINED", "WAITING", "wait"}
    shared = "engine/event_loop flight/numbers sensitivity/replay orbits/families/kick "
    for name in (shared + "orbits/observation/amplitude_scan engine/recorder sensitivity/change").split():
        assert words_of(ROOT / "contact" / f"{name}.py") & of_one == set()
    files = {path.stem for path in (ROOT / "contact").rglob("*.py") if "wait" in words_of(path)}
    assert files == {"state", "passage", "start", "delayed"} and laws


@pytest.mark.parametrize("form", ["short", *slow("whole")])
def test_a_new_law_is_one_file_one_line_and_one_export(form, tmp_path):
    """Exact motion, the three methods with a step and an orbit, without a change of any other file."""
    for package in ("beam", "contact"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "contact/touch/own.py").write_text(LAW)
    table, exports = tmp_path / "contact/touch/__init__.py", tmp_path / "contact/__init__.py"
    text = table.read_text().replace("from contact.touch import ", "from contact.touch import own, ", 1)
    table.write_text(text.replace("LAWS = {", "LAWS = {9: offered(own),", 1))
    export = "\nfrom contact.touch.own import OwnContact\n\n__version"
    exports.write_text(exports.read_text().replace("\n__version", export, 1))
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment["PYTHONPATH"] = os.pathsep.join([str(tmp_path), str(ROOT / "tests/contact")])
    command = [sys.executable, "-c", PROGRAM, form]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
