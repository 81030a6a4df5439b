"""Every public call that follows a motion returns or is refused, with every law of contact.

Compiled code cannot be interrupted: the calls run in a process of their own under a watchdog that names the
one that does not come back (``python tests/contact/test_bounded_calls.py``, with the root, tests/beam and
tests/contact on the path).
"""

import faulthandler
import inspect
import os
import random
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from calls_of_beam import Entry
from calls_of_contact import CONTACT
from calls_of_orbits import ORBITS
from cases_of_calls import EXTREME, LAWS, MODES, Case, cases_of, oscillator_of

import contact
from contact import ContactError, ContactLaw, DelayedRestitution, NewtonRestitution, orbits

ROOT = Path(__file__).parent.parent.parent
LONGEST, COMPILED = 120.0, 20.0
"""Seconds within which each call comes back, with its compilation and without; most take milliseconds, and 10
are the bound on a quiet machine."""
CALLS = [entry for entry in (*CONTACT, *ORBITS) if entry.over]
TWELVE = ("onset_orbit", "fold_of", "orbit_end", "orbit_exponents")
"""Calls that the long form makes with twelve modes too: each of them once took ten seconds and more."""

WITHOUT_A_LAW = {"frequency_band", "before_collision", "maximal_m", "coexisting_m"}
WITHOUT_A_LAW |= {"PeriodicOrbit.failure", "damping_ratio", "restitution_from_bounces"}
"""Closed forms of the letter's map and of flights, and a method that makes an error."""
COMPUTING = ("KickFamily", "PeriodicOrbit", "Shooting", "StroboscopicMap")


def modes_of(name: str, law: ContactLaw) -> tuple[int, ...]:
    """Numbers of modes; delayed rebounds need a single one."""
    return (1,) if isinstance(law, DelayedRestitution) else MODES.get(name, (1, 2))


def calls(long: bool) -> Iterator[tuple[str, int, Entry, Case]]:
    """Law, number of modes, entry and case of every call, or of each entry under a law drawn by a seed."""
    draw, drawn, laws = random.Random(4), set(), LAWS | EXTREME
    small = [law for law in laws if 12 not in MODES.get(law, ()) or law == "dissipative"]
    for call in sorted({entry.public_name for entry in CALLS}):
        name = draw.choice(small)
        drawn.add((name, draw.choice([n for n in modes_of(name, laws[name]) if n < 12]), call))
    for name, law in laws.items():
        for modes in modes_of(name, law):
            cases = cases_of(oscillator_of(law, modes))
            for entry in CALLS:
                known = modes < 12 or entry.public_name in TWELVE
                if known and (long or (name, modes, entry.public_name) in drawn):
                    yield from ((name, modes, entry, case) for case in cases[entry.over])


def run_all(long: bool) -> None:
    """Make every call and print one line each: law, modes, call, seconds, what came of it."""
    warnings.simplefilter("ignore")  # the extreme laws are suspicious on purpose
    for name, modes, entry, case in calls(long):
        print(name, modes, entry.name, "", sep=" | ", end="", flush=True)
        for _ in range(2):  # what takes long once more: it is compiled then
            faulthandler.dump_traceback_later(LONGEST, exit=True)
            start, came = time.process_time(), "returned"
            try:
                entry.call(**entry.right(case))
            except (ContactError, ValueError, TypeError) as error:
                ours = not isinstance(error, np.linalg.LinAlgError)  # a ValueError, but none of ours
                came = f"{'refused' if ours else 'failed'} with {type(error).__name__}: {error}"
            except Exception as error:
                came = f"failed with {error!r}"
            faulthandler.cancel_dump_traceback_later()
            if (took := time.process_time() - start) <= COMPILED:
                break
        print(f"{took:.2f} | {came}".replace("\n", " "), flush=True)


def public_names() -> set[str]:
    """Public functions, and public methods of the classes that compute."""
    names: set[str] = set()
    for module in (contact, orbits):
        names |= {name for name in module.__all__ if inspect.isfunction(getattr(module, name))}
    for one in (getattr(module, name) for module in (contact, orbits) for name in module.__all__):
        if inspect.isclass(one) and one.__name__ in COMPUTING:
            methods = inspect.getmembers(one, callable)
            names |= {f"{one.__name__}.{method}" for method, _ in methods if not method.startswith("_")}
    return names


def test_every_public_call_is_in_the_tables() -> None:
    closed = {"MaximalFamily.from_oscillator"}  # of Newton's law only
    assert {entry.public_name for entry in CALLS} - closed == public_names() - WITHOUT_A_LAW


@pytest.mark.parametrize("form", ["short", pytest.param("long", marks=pytest.mark.slow)])
def test_every_public_call_comes_back(form: str) -> None:
    paths = [ROOT, ROOT / "tests/beam", ROOT / "tests/contact", os.environ.get("PYTHONPATH")]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(str(path) for path in paths if path)}
    command, settings = [sys.executable, __file__, form], dict(text=True, capture_output=True, timeout=900)
    ended = subprocess.run(command, cwd=ROOT, env=env, **settings)
    lines = [line for line in ended.stdout.splitlines() if line]
    assert ended.returncode == 0, f"{lines[-1:]} did not come back\n{ended.stderr[-3000:]}"
    rows = [[part.strip() for part in line.split("|", 4)] for line in lines]
    assert not [row for row in rows if row[4].startswith("failed")]
    assert not [row for row in rows if row[0] in EXTREME and float(row[3]) > COMPILED]
    # of the ordinary laws orbits, folds and motions are there, not refused
    for name, law in LAWS.items():
        made, returned = (
            {row[2].partition(",")[0] for row in rows if row[0] == name and row[4].startswith(came)}
            for came in ("", "returned")
        )
        closed = set() if isinstance(law, NewtonRestitution) else {"MaximalFamily.from_oscillator"}
        assert made - returned == made & closed


if __name__ == "__main__":
    run_all(long=sys.argv[1:] == ["long"])
