"""Every public call that follows a motion returns or is refused, with every law of contact.

Compiled code cannot be interrupted: the calls run in a process of their own under a watchdog that names the
one that does not come back (``python tests/contact/test_bounded_calls.py``, with the root on the path).
"""

from __future__ import annotations

import faulthandler
import inspect
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oscillators import equation_1

import contact
from beam import ModalModel
from contact import (
    ContactLaw,
    DelayedRestitution,
    HarmonicDrive,
    HertzContact,
    HuntCrossley,
    ImpactOscillator,
    LinearContact,
    NewtonRestitution,
    State,
    Stop,
    StroboscopicMap,
    integrators,
)
from contact import orbits as periodic
from contact.errors import ContactError
from contact.orbits.branches import continuation, path
from contact.orbits.families import kick, shooting, single_impact
from contact.orbits.observation import lyapunov

ROOT = Path(__file__).parent.parent.parent
LONGEST, COMPILED = 120.0, 20.0
"""Seconds within which each call comes back, with its compilation and without; most take milliseconds, and 10
are the bound on a quiet machine."""

GAP = 0.0107
LAWS: dict[str, ContactLaw] = {
    "newton": NewtonRestitution(local_restitution=0.1),
    "delayed": DelayedRestitution(restitution=0.1, delay=1e-4),
    "delayed by table": DelayedRestitution(
        restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 2e-4 * v**0.2
    ),
    "linear": LinearContact(stiffness=1e7),
    "dashpot": LinearContact(stiffness=1e7, damping=100.0),
    "hertz": HertzContact(stiffness=1e9),
    "hunt-crossley": HuntCrossley(stiffness=1e9, dissipation=0.3),
}
EXTREME: dict[str, ContactLaw] = {
    "plastic": NewtonRestitution(local_restitution=0.0),
    "elastic": NewtonRestitution(local_restitution=1.0),
    "no delay": DelayedRestitution(restitution=0.9, delay=0.0),
    "delay of rounding": DelayedRestitution(restitution=0.0, delay=1e-12),
    "delay that holds": DelayedRestitution(restitution=0.0, delay=5e-3),
    "delay of all periods": DelayedRestitution(restitution=0.5, delay=1.0),
    "softest": LinearContact(stiffness=1e-300),
    "stiffest": LinearContact(stiffness=1e18, damping=1e3),
    "overdamped": LinearContact(stiffness=1e5, damping=1e5),
    "softest hertz": HertzContact(stiffness=1e-300),
    "stiffest hertz": HertzContact(stiffness=1e20),
    "dissipative": HuntCrossley(stiffness=1e9, dissipation=100.0),
    "dissipative and soft": HuntCrossley(stiffness=1e5, dissipation=1e6),
    "creeping": HuntCrossley(stiffness=1e9, dissipation=3e3),
    "creeping longest": HuntCrossley(stiffness=1e9, dissipation=1e4),
}
MODES = {"dissipative": (2, 12), "creeping": (12,), "creeping longest": (12,)}
"""Other numbers of modes than one and two; the one of delayed rebounds."""
TWELVE = ("born", "fold_of", "folds_of", "orbit_end", "orbit_exponents")
"""Calls that are made with twelve modes: each of them once took ten seconds and more."""
THE_SAME_SEARCH = {
    "fold_along_frequency",
    "folds_of",
    "lowest_of",
    "KickFamily.orbits",
    "Shooting.fold",
    "Shooting.orbits",
}
"""Searches made of ``fold_of``, ``follow`` and ``orbits_at``: with the extreme laws only these three run,
of the general motion where there is one, and with the others each with two modes; all of them in the long
form."""

WITHOUT_A_LAW = {
    # closed forms of the letter's map and of flights
    "band",
    "bands",
    "before_collision",
    "fold",
    "maximal_orbits",
    "maximal_period",
    "maximal_periods",
    "modal_flow",
    "stable_range",
}
CHANGE = periodic.Change(gap=1.0, frequency=1e3)
COMPUTING = (
    "KickFamily",
    "MaximalFamily",
    "PeriodicOrbit",
    "Shooting",
    "SingleImpactOrbit",
    "StroboscopicMap",
)


def oscillator_of(law: ContactLaw, modes: int) -> ImpactOscillator:
    if modes == 1:
        return equation_1(22.2, law, gap=GAP)
    k = np.arange(modes)
    omega, phi = 154.0 * (1.0 + 1.5 * k) ** 2, (-0.8) ** (k % 2) * (1.0 if modes == 2 else 7.0)
    gamma = 1.0 / (1.0 + 2.3 * k) / phi[0]
    model = ModalModel(omega=omega, decay_rate=0.02 * omega, phi=phi, participation=gamma)
    return ImpactOscillator(model=model, stop=Stop(gap=GAP, law=law), drive=HarmonicDrive(frequency=22.2))


def motions(oscillator: ImpactOscillator) -> Iterator[tuple[str, Callable[[], object]]]:
    """Calls that follow a motion; of twelve modes, one far above grazing."""
    driven = oscillator.with_excess(1e4 if oscillator.n_modes == 12 else 0.02)
    strobed = StroboscopicMap(oscillator=driven)
    rest = State.rest(oscillator.n_modes)
    fast = State(displacement=rest.displacement, velocity=rest.velocity + 1.0)
    yield "StroboscopicMap.at", lambda: strobed.at(0.1)
    yield "StroboscopicMap.steady", strobed.steady
    for state in (strobed.steady(), fast):
        yield (
            "simulate",
            lambda state=state: contact.simulate(driven, state, periods=5, times=np.linspace(0.0, 0.2, 50)),
        )
        yield (
            "collisions",
            lambda state=state: contact.collisions(
                driven, contact.simulate(driven, state, periods=5), unfinished="drop"
            ),
        )
        yield "first_collision", lambda state=state: contact.first_collision(driven, state, periods=5)
        yield "StroboscopicMap.orbit", lambda state=state: strobed.orbit(state, 20)
        yield "StroboscopicMap.coordinates", lambda state=state: strobed.coordinates(state)
        yield (
            "motion_derivatives",
            lambda state=state: periodic.motion_derivatives(
                driven, state, [CHANGE], periods=3, times=np.linspace(0.01, 0.1, 5)
            ),
        )
        yield "StroboscopicMap.jacobians", lambda state=state: strobed.jacobians(state, 5)
        yield "strobed_orbits", lambda state=state: contact.strobed_orbits([strobed] * 2, [state] * 2, 20)
        for exponents in (lyapunov.map_exponents, lyapunov.orbit_exponents):
            yield exponents.__name__, lambda state=state, e=exponents: e(strobed, state, 5)
        for prove in (True, False):
            yield (
                "settle",
                lambda state=state, prove=prove: periodic.settle(
                    strobed, state, most_cycles=256, prove=prove
                ),
            )
        yield (
            "orbit_diagram",
            lambda state=state: periodic.orbit_diagram(
                strobed, [1e-3, -1e-3], state, observe=strobed.tip, settle_cycles=128
            ),
        )
    settled = [strobed.at(-0.1), strobed.at(-0.1).steady(), 2]
    yield "orbit_exponents", lambda: lyapunov.orbit_exponents(*settled)
    below, noise = strobed.at(-0.1), 1.0 + 0.2 * np.sin(np.arange(20.0))
    yield "StroboscopicMap.orbit", lambda: strobed.orbit(fast, 20, factors=noise)
    yield "strobe_derivatives", lambda: periodic.strobe_derivatives(below, below.steady(), 2)
    yield "cloud", lambda: periodic.cloud(below, below.steady(), 2, deviation=1e-3, memory=0.5)
    yield "orbit_end", lambda: periodic.orbit_end(strobed, fast, 0.02, most_cycles=128)
    yield "born", lambda: periodic.born(strobed, most_cycles=256)
    yield "fold_excess", lambda: periodic.fold_excess(strobed, 5)
    yield "born_period", lambda: periodic.born_period(strobed, most_cycles=256)
    yield (
        "period_of",
        lambda: periodic.period_of(
            (run := strobed.orbit(strobed.steady(), 20)).points, run.impacts, largest_period=8, tolerance=1e-9
        ),
    )
    for method in (
        integrators.SampledFlight(points=64),
        integrators.NonsmoothGeneralisedAlpha(step=1e-5, rho=0.9),
        integrators.Splitting(step=1e-5),
        integrators.CentralDifference(step=1e-5),
        integrators.MoreauJean(step=1e-5),
        integrators.GeneralisedAlpha(step=1e-5),
    ):
        yield "simulate", lambda method=method: contact.simulate(driven, fast, periods=2, method=method)
    yield "first_collision", lambda: contact.first_collision(oscillator)
    yield "StroboscopicMap.tip", lambda: strobed.tip(strobed.orbit(strobed.steady(), 3).points)
    yield "StroboscopicMap.readout", lambda: strobed.readout(np.zeros((1, oscillator.n_modes)), "none")


def orbits(oscillator: ImpactOscillator) -> Iterator[tuple[str, Callable[[], object]]]:
    """Calls that look for an orbit."""
    kicks, family = (make(oscillator=oscillator, period=5) for make in (kick.KickFamily, shooting.Shooting))
    unit = oscillator.drive.angular_frequency * GAP
    for part in (1e-6, 0.05, 0.3, 20.0):
        speed = part * unit
        yield "KickFamily.kick", lambda v=speed: kicks.kick(v)
        yield "KickFamily.orbit", lambda v=speed: kicks.orbit(v)
        yield "KickFamily.orbit_of", lambda v=speed: kicks.orbit_of(kicks.kick(v))
        yield "KickFamily.error", lambda v=speed: kicks.error(kicks.orbit(v))
        yield "KickFamily.excess", lambda v=speed: kicks.excess(v)
        yield "KickFamily.closed", lambda v=speed: kicks.closed(kicks.kick(v).jump)
        yield "Shooting.flow", lambda v=speed: family.flow(unknown_of(kicks.orbit(v)))
        yield "Shooting.orbit", lambda v=speed: family.orbit(v)
        yield "Shooting.at_speed", lambda v=speed: family.at_speed(v)
        yield "Shooting.at_excess", lambda v=speed: family.at_excess(0.01, family.at_speed(v))
        for name in ("state", "monodromy", "release", "repeats", "strobe_state"):
            yield f"PeriodicOrbit.{name}", lambda v=speed, name=name: getattr(family.at_speed(v), name)()
        yield (
            "follow",
            lambda v=speed: continuation.follow(
                family, family.at_speed(v), low=0.5 * v, high=2.0 * v, step=0.3
            ),
        )
    speed = 0.05 * unit
    for derivatives in (
        periodic.excess_derivatives,
        periodic.doubling_derivatives,
        periodic.graze_derivatives,
        periodic.orbit_derivatives,
    ):
        yield derivatives.__name__, lambda d=derivatives: d(family.at_speed(speed), [CHANGE])
    yield (
        "multiplier_derivatives",
        lambda: periodic.multiplier_derivatives(periodic.orbit_derivatives(family.at_speed(speed), [CHANGE])),
    )
    yield "KickFamily.fold", lambda: kicks.fold()
    yield "KickFamily.orbits", lambda: kicks.orbits(0.01)
    yield "Shooting.fold", lambda: family.fold()
    yield "Shooting.orbits", lambda: family.orbits(0.01)
    yield "orbits_at", lambda: continuation.orbits_at(family, 0.01)
    yield "Shooting.of", lambda: family.of(oscillator)
    yield "Shooting.with_impacts", lambda: family.with_impacts(2)
    for name in ("Shooting.unknowns", "Shooting.equations"):
        yield name, lambda: family.equations(family.unknowns(family.orbit(speed).deviations, speed))
    yield "fold_of", lambda: continuation.fold_of(family)
    yield "fold_of", lambda: continuation.fold_of(family, family.at_speed(0.1 * unit))
    yield "folds_of", lambda: periodic.folds_of(family)
    yield "lowest_of", lambda: periodic.lowest_of(family)
    yield "first_event", lambda: periodic.first_event(family, family.at_speed(0.1 * unit), -0.5)
    yield "fold_along_frequency", lambda: continuation.fold_along_frequency(family, np.array([22.2]))
    yield (
        "follow_path",
        lambda: path.follow_path(
            oscillator.with_excess,
            near := family.at_speed(0.1 * unit),
            near.excess,
            low=near.excess,
            high=near.excess + 0.05,
            step=1.0,
        ),
    )
    several = shooting.Shooting(oscillator=oscillator, period=2, impacts=3)
    yield "Shooting.at_speed", lambda: several.at_speed(0.1 * unit)
    driven = oscillator.with_excess(0.02)
    start = StroboscopicMap(oscillator=driven).steady()
    yield "Shooting.from_state", lambda: shooting.Shooting(oscillator=driven, period=5).from_state(start)
    yield "MaximalFamily.from_oscillator", lambda: closed_forms(oscillator)


def closed_forms(oscillator: ImpactOscillator) -> None:
    """The orbits of Newton's law; TypeError for another one."""
    family = single_impact.MaximalFamily.from_oscillator(oscillator, period=5)
    fold = family.fold()
    assert fold is not None and family.orbits(0.01)
    assert family.orbit(0.1).state().time == family.orbit(0.1).phase
    assert family.excess(1e-3) < 1.0
    assert fold.monodromy().shape == (2 * oscillator.n_modes, 2 * oscillator.n_modes)


def unknown_of(orbit: single_impact.SingleImpactOrbit) -> np.ndarray:
    """Deviations and drive at the touch of an orbit."""
    angle = orbit.oscillator.drive.angular_frequency * orbit.phase
    drive = orbit.amplitude * np.array([np.sin(angle), np.cos(angle)])
    return np.concatenate([orbit.displacement, orbit.velocity, drive])


def left_to_the_long_form(name: str, modes: int, call: str, what: object) -> bool:
    """Whether another call or another number of modes covers this one."""
    if modes == 12:
        return call != "fold_of"
    if name in EXTREME:
        alone = isinstance(EXTREME[name], DelayedRestitution)
        return not alone and (call in THE_SAME_SEARCH or (what is orbits and modes == 1))
    alone = isinstance(LAWS[name], DelayedRestitution)
    return not alone and modes == 1 and call in THE_SAME_SEARCH | {"follow_path"}


def run_all(said: Callable[[str], None], long: bool) -> None:
    """Every call with every law, one line each: law, modes, call, seconds, what came of it."""
    warnings.simplefilter("ignore")  # the extreme laws are suspicious on purpose
    for name, law in (LAWS | EXTREME).items():
        for modes in (1,) if isinstance(law, DelayedRestitution) else MODES.get(name, (1, 2)):
            oscillator = oscillator_of(law, modes)
            for what in (motions, orbits):
                for call, run in what(oscillator):
                    if modes == 12 and call not in TWELVE:
                        continue
                    if not long and left_to_the_long_form(name, modes, call, what):
                        continue
                    said(f"\n{name} | {modes} | {call} | ")
                    faulthandler.dump_traceback_later(LONGEST, exit=True)
                    start, came = time.process_time(), "returned"
                    try:
                        run()
                    except (ContactError, ValueError, TypeError) as error:
                        ours = not isinstance(error, np.linalg.LinAlgError)  # a ValueError, but none of ours
                        came = f"{'refused' if ours else 'failed'} with {type(error).__name__}: {error}"
                    except Exception as error:
                        came = f"failed with {error!r}"
                    said(f"{time.process_time() - start:.2f} | {came}")
                    faulthandler.cancel_dump_traceback_later()


def public_names() -> set[str]:
    """Public functions, and public methods of the classes that compute."""
    names: set[str] = set()
    for module in (contact, periodic, kick, shooting, continuation, lyapunov, single_impact):
        for name in module.__all__:
            found: Any = getattr(module, name)
            if name in COMPUTING:
                methods = inspect.getmembers(found, callable)
                names |= {f"{name}.{method}" for method, _ in methods if not method.startswith("_")}
            elif inspect.isfunction(found):  # other classes only hold what was computed
                names.add(name)
    return names


@pytest.mark.parametrize("form", ["short", pytest.param("long", marks=pytest.mark.slow)])
def test_every_public_call_comes_back(form: str) -> None:
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    ended = subprocess.run(
        [sys.executable, __file__, form],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": path},
        text=True,
        capture_output=True,
        timeout=900,
    )
    lines = [line for line in ended.stdout.splitlines() if line]
    assert ended.returncode == 0, f"{lines[-1:]} did not come back\n{ended.stderr[-3000:]}"
    rows = [[part.strip() for part in line.split("|", 4)] for line in lines]
    assert not [row for row in rows if row[4].startswith("failed")]
    assert not [row for row in rows if row[0] in EXTREME and float(row[3]) > COMPILED]
    # of the ordinary laws orbits, folds and motions are there, not refused
    for name, law in LAWS.items():
        returned = {row[2] for row in rows if row[0] == name and row[4] == "returned"}
        refused = set() if isinstance(law, NewtonRestitution) else {"MaximalFamily.from_oscillator"}
        # none of the orbits lies at a graze or a doubling, and the model has no point of that name
        refused |= {"doubling_derivatives", "graze_derivatives", "StroboscopicMap.readout"}
        assert {row[2] for row in rows} - returned == refused
    # nothing public is left out
    called = {row[2] for row in rows}
    closed = {name for name in public_names() if name.split(".")[0] in ("MaximalFamily", "SingleImpactOrbit")}
    assert public_names() - WITHOUT_A_LAW - closed == called - closed


def test_a_call_that_does_not_come_back_is_named() -> None:
    """The watchdog ends compiled code that runs for good."""
    code = (
        "import faulthandler, numba\n"
        "@numba.njit\n"
        "def endless(x):\n"
        "    while x > 0.0:\n"
        "        x = 0.5 * x + 1.0\n"
        "    return x\n"
        "endless(-1.0)\n"
        "faulthandler.dump_traceback_later(0.5, exit=True)\n"
        "endless(1.0)\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert ended.returncode != 0 and "Timeout" in ended.stderr


if __name__ == "__main__":

    def said(words: str) -> None:
        sys.stdout.write(words.replace("\n", " ") if not words.startswith("\n") else words)
        sys.stdout.flush()

    run_all(said, long=sys.argv[1:] == ["long"])
