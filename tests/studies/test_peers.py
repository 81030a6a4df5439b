"""Outside solvers against the exact methods, each held to what its tolerance promises."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pytest
from oscillators import equation_1, light_tip, newton

import contact
from contact import ContactError, HertzContact, ImpactOscillator, LinearContact, State, Trajectory, simulate
from contact.integrators import Integrator
from studies.methods import peers
from studies.methods.peers import SOLVERS, OutsideSolver, adapters, installed_solvers, missing_solvers
from studies.methods.peers.piecewise import Equations

FAST = ("scipy DOP853", "heyoka Taylor", "CVODE Adams")
PROMISE = {"CVODE BDF": 2000.0, "CVODE Adams": 2000.0, "scipy RK45": 100.0, "scipy LSODA": 300.0}
"""Error of the state over the tolerance that a solver may gather in a run of some ten periods of its fastest
mode; 30 for those not named.  The tolerance is that of one step, and multistep methods start anew."""

every = pytest.mark.parametrize("label", SOLVERS)
fast = pytest.mark.parametrize("label", FAST)


def solver(label: str, tolerance: float) -> Integrator:
    """The solver with this label; skips the test only if its library is missing."""
    if SOLVERS[label][0] in missing_solvers():
        pytest.skip(f"{SOLVERS[label][0]} is not installed")
    return OutsideSolver(solver=label, tolerance=tolerance)


spring = partial(light_tip, excess=0.02, frequency=22.2)
EQUATION_1 = equation_1(22.2, excess=0.2)


@dataclass(frozen=True)
class Case:
    """A motion from a state over a length [s]."""

    oscillator: ImpactOscillator
    start: State
    length: float

    def follow(self, method: Integrator | None = None) -> Trajectory:
        times = self.start.time + np.linspace(0.0, self.length, 41)
        return simulate(self.oscillator, self.start, duration=self.length, times=times, method=method)


def collision(oscillator: ImpactOscillator, periods: float) -> Case:
    """From the lowest point of the steady motion."""
    return Case(oscillator, contact.before_collision(oscillator), periods * oscillator.period)


CASES = {
    "hard wall, Eq. (1)": collision(EQUATION_1, 6.3),
    "linear, 4 modes": collision(spring(4, LinearContact(stiffness=3e5)), 1.2),
    "Hertz, 4 modes": collision(spring(4, HertzContact(stiffness=1e9)), 1.2),
}


def distance(run: Trajectory, exact: Trajectory, oscillator: ImpactOscillator) -> float:
    """Largest difference of the states at the samples and the end, as energy, over that of the motion [1]."""
    omega = np.maximum(oscillator.model.omega, 2 * math.pi / oscillator.period)

    def size(displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        return np.sqrt(np.sum((omega * displacement) ** 2 + velocity**2, axis=-1))

    largest = size(exact.displacement, exact.velocity).max()
    apart = size(run.displacement - exact.displacement, run.velocity - exact.velocity).max()
    ends = size(run.end.displacement - exact.end.displacement, run.end.velocity - exact.end.velocity)
    return float(max(apart, ends) / largest)


@every
@pytest.mark.parametrize("name", CASES)
def test_meets_its_tolerance_with_the_same_touches(label: str, name: str) -> None:
    case = CASES[name]
    exact = case.follow()
    assert len(exact.impacts) >= 1
    tolerance = 1e-6 if label == "scipy Radau" else 1e-9
    within = PROMISE.get(label, 30.0) * tolerance
    run = case.follow(solver(label, tolerance))
    assert distance(run, exact, case.oscillator) < within
    np.testing.assert_array_equal(run.strobe_impacts, exact.strobe_impacts)
    away = np.abs(run.strobe_displacement - exact.strobe_displacement)
    assert np.max(away, initial=0.0) <= within * np.abs(exact.displacement).max()
    fastest = 2 * math.pi / case.oscillator.model.omega.max()
    speed = np.abs(exact.impacts.approach).max()
    lost = 0.5 * speed**2 / float(case.oscillator.model.phi @ case.oscillator.model.phi)
    times, speeds = dict.fromkeys(("start", "end"), 30 * fastest), ("approach", "rebound")
    for part, bound in (times | dict.fromkeys(speeds, 100 * speed) | {"loss": 300 * lost}).items():
        found, truth = getattr(run.impacts, part), getattr(exact.impacts, part)
        np.testing.assert_allclose(found, truth, rtol=0, atol=bound * within)
    assert run.end.time == exact.end.time and run.evaluations > 50


@every
def test_error_falls_with_the_tolerance(label: str) -> None:
    """Three decades of tolerance bring at least one and a half of error, also through a Hertz contact."""
    case = CASES["Hertz, 4 modes"]
    exact = case.follow()
    coarse, fine = (1e-4, 1e-7) if label == "scipy Radau" else (1e-6, 1e-9)
    errors = [distance(case.follow(solver(label, tol)), exact, case.oscillator) for tol in (coarse, fine)]
    assert errors[1] < errors[0] / 30


@fast
def test_sets_out_from_the_stop_moving_in(label: str) -> None:
    """Four modes without a drive, gap 0."""
    oscillator = replace(spring(4, LinearContact(stiffness=3e5)), drive=None)
    oscillator = replace(oscillator, stop=replace(oscillator.stop, gap=0.0))
    case = Case(oscillator, State(displacement=np.zeros(4), velocity=[0.02, 0.0, 0.0, 0.0]), 0.01)
    exact, run = case.follow(), case.follow(solver(label, 1e-9))
    assert run.impacts.start[0] == 0.0 and run.impacts.end[0] == pytest.approx(exact.impacts.end[0], rel=1e-5)
    assert distance(run, exact, case.oscillator) < PROMISE.get(label, 30.0) * 1e-9


@fast
def test_times_wanted_anywhere(label: str) -> None:
    """States at the start, at strobes, twice at one time, within contacts and at the end."""
    case = CASES["Hertz, 4 modes"]
    exact = case.follow()
    inside = np.linspace(exact.impacts.start[0], exact.impacts.end[0], 9)
    first, last = case.start.time, case.start.time + case.length
    times = np.sort(np.concatenate([inside, [first, last, last], exact.strobe_time, exact.strobe_time]))
    given, methods = dict(duration=case.length, times=times), (None, solver(label, 1e-11))
    truth, found = (simulate(case.oscillator, case.start, **given, method=method) for method in methods)
    scale = np.abs(truth.displacement).max()
    np.testing.assert_allclose(found.displacement, truth.displacement, atol=1e-7 * scale, rtol=0)
    np.testing.assert_array_equal(found.displacement[-1], found.end.displacement)
    np.testing.assert_array_equal(found.displacement[0], case.start.displacement)
    assert np.count_nonzero(found.displacement @ case.oscillator.model.phi - 0.005 > 1e-9) >= 7


def test_threads_do_not_share_a_compiled_integrator() -> None:
    """Two motions at once come out as they do one after the other."""
    method = solver("heyoka Taylor", 1e-12)
    oscillators = [spring(4, HertzContact(stiffness=1e9), excess=e) for e in (0.02, 0.05, 0.1, 0.2)]

    def end(oscillator: ImpactOscillator) -> np.ndarray:
        return simulate(oscillator, periods=20, method=method).end.displacement

    alone = [end(oscillator) for oscillator in oscillators]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(end, oscillators))
    np.testing.assert_array_equal(together, alone)


def test_wrong_use_is_refused() -> None:
    method = OutsideSolver(solver="scipy DOP853", tolerance=1e-10)
    late = contact.DelayedRestitution(restitution=0.1, delay=1e-4)
    with pytest.raises(TypeError):
        simulate(equation_1(22.2, late), periods=1, method=method)
    lossy = contact.HuntCrossley(stiffness=1e9, dissipation=0.3)
    for law in (LinearContact(stiffness=3e5, damping=20.0), lossy):
        with pytest.raises(TypeError, match="law of the stop"):
            simulate(spring(2, law), periods=1, method=method)
    with pytest.raises(ValueError, match="tolerance"):
        OutsideSolver(solver="scipy RK45", tolerance=1e-15)
    with pytest.raises(ValueError, match="solver"):
        OutsideSolver(solver="scipy RK23", tolerance=1e-10)
    inside = State(displacement=[1.0], velocity=[0.0], regime=3)
    for state in (State(displacement=[1.1], velocity=[0.0]), inside):
        with pytest.raises(ValueError, match="regime of the state"):
            simulate(EQUATION_1, state, periods=1, method=method)


@pytest.mark.parametrize("label", [label for label in SOLVERS if label != "heyoka Taylor"])
def test_a_solver_that_gives_up_gives_no_number(label: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Accelerations that stop being numbers half way."""
    method, case, whole = solver(label, 1e-6), CASES["hard wall, Eq. (1)"], Equations.rates

    def broken(self: Equations, contact: bool, t: float, y: np.ndarray, out: np.ndarray) -> np.ndarray:
        whole(self, contact, t, y, out)
        if t > 0.5 * case.length:
            out[:] = np.nan
        return out

    monkeypatch.setattr(Equations, "rates", broken)
    monkeypatch.setattr(adapters, "MOST_STEPS", 1000)  # CVODE goes on among numbers that are none
    with pytest.raises(ContactError) as caught:
        case.follow(method)
    assert 0.4 * case.length < caught.value.time - case.start.time <= case.length


def test_what_cannot_be_followed_gives_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """Impacts that accumulate to a stay on the stop, and a series of too many steps."""
    ringing = replace(spring(5, newton(0.3)), drive=None)
    start = State(displacement=np.zeros(5), velocity=np.array([0.3, 0.12, 0.1, 0.05, 0.02]))
    assert 2 in simulate(ringing, start, duration=0.06).impacts.kind
    with pytest.raises(contact.Chatter):
        simulate(ringing, start, duration=0.06, method=OutsideSolver(solver="scipy RK45", tolerance=1e-8))
    method = solver("heyoka Taylor", 1e-9)
    monkeypatch.setattr(adapters, "MOST_STEPS", 2)
    with pytest.raises(ContactError, match="step_limit"):
        CASES["linear, 4 modes"].follow(method)


def test_a_missing_package_is_named_and_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(peers, "find_spec", lambda name: object() if name == "scipy" else None)
    for name in ("heyoka Taylor", "CVODE BDF"):
        with pytest.raises(ImportError, match="not installed"):
            OutsideSolver(solver=name, tolerance=1e-10)
    assert missing_solvers() == ["heyoka", "sundials"]
    assert installed_solvers() == [name for name in SOLVERS if name.startswith("scipy")]
