"""Outside solvers against the exact methods, each held to what its tolerance promises."""

from __future__ import annotations

import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from beam import ModalModel, UniformBeam, exact_modes, single_mode
from contact.collision import before_collision
from contact.drive import HarmonicDrive
from contact.errors import ContactError
from contact.integrators.equation import equation_of
from contact.laws import (
    ContactLaw,
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import CONTACT, INSIDE, OUTSIDE, SUSTAINED, State, Trajectory
from studies.instruments import peers
from studies.instruments.peers import PEERS, HeyokaTaylor, ScipyMethod, SundialsCvode, available, lineup
from studies.instruments.peers.equations import jacobian, packed, rates, surfaces

LABELS = {
    "scipy RK45": "scipy", "scipy DOP853": "scipy", "scipy Radau": "scipy", "scipy LSODA": "scipy",
    "heyoka Taylor": "heyoka", "CVODE BDF": "sundials", "CVODE Adams": "sundials",
}  # fmt: skip
FAST = ("scipy DOP853", "heyoka Taylor", "CVODE Adams")
PROMISE = {"CVODE BDF": 2000.0, "CVODE Adams": 2000.0, "scipy RK45": 100.0, "scipy LSODA": 300.0}
"""Error of the state over the tolerance that a solver may gather in a run of some ten periods of its fastest
mode; 30 for those not named.  The tolerance is that of one step, and multistep methods start anew."""


def solver(label: str, tolerance: float) -> ScipyMethod | HeyokaTaylor | SundialsCvode:
    """The solver with this label; skips the test only if its library is missing."""
    if LABELS[label] not in available():
        pytest.skip(f"{LABELS[label]} is not installed")
    return lineup(tolerance)[label]  # type: ignore[return-value]


every = pytest.mark.parametrize("label", LABELS)
fast = pytest.mark.parametrize("label", FAST)


def spring(n_modes: int, law: ContactLaw, *, excess: float = 0.02) -> ImpactOscillator:
    """The first modes of a driven spring of 24.5 Hz; the stop 5 mm away."""
    k = np.arange(n_modes)
    omega = 154.0 * (1.0 + 2.0 * k) ** 1.5
    model = ModalModel(
        omega=omega, decay_rate=0.02 * omega, phi=10.0 / (1.0 + 0.4 * k), participation=0.09 / (1.0 + k)
    )
    return ImpactOscillator(
        model=model, stop=Stop(gap=0.005, law=law), drive=HarmonicDrive(frequency=22.2)
    ).with_excess(excess)


def undriven(oscillator: ImpactOscillator) -> ImpactOscillator:
    return replace(oscillator, drive=None)


def equation_1(excess: float = 0.2) -> ImpactOscillator:
    return ImpactOscillator(
        model=single_mode(free_period=0.0408, decay_rate=3.56),
        stop=Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.1)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(excess)


@dataclass(frozen=True)
class Case:
    oscillator: ImpactOscillator
    start: State
    length: float

    def follow(self, method: object = None) -> Trajectory:
        times = self.start.time + np.linspace(0.0, self.length, 41)
        return simulate(self.oscillator, self.start, duration=self.length, times=times, method=method)


def collision(oscillator: ImpactOscillator, periods: float) -> Case:
    return Case(oscillator, before_collision(oscillator), periods * oscillator.period)


CASES = {
    "hard wall, Eq. (1)": collision(equation_1(0.2), 6.3),
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


def agree(run: Trajectory, exact: Trajectory, oscillator: ImpactOscillator, within: float) -> None:
    """The same touches and, within an error of the state, the same motion."""
    assert distance(run, exact, oscillator) < within
    np.testing.assert_array_equal(run.strobe_impacts, exact.strobe_impacts)
    np.testing.assert_array_equal(run.impacts.kind, exact.impacts.kind)
    fastest = 2 * math.pi / oscillator.model.omega.max()
    np.testing.assert_allclose(run.impacts.start, exact.impacts.start, rtol=0, atol=30 * within * fastest)
    speed = np.abs(exact.impacts.approach).max()
    close = dict(rtol=0, atol=100 * within * speed)
    np.testing.assert_allclose(run.impacts.approach, exact.impacts.approach, **close)
    np.testing.assert_allclose(run.impacts.rebound, exact.impacts.rebound, **close)
    lost = 0.5 * speed**2 / oscillator.motion().compliance
    np.testing.assert_allclose(run.impacts.loss, exact.impacts.loss, atol=300 * within * lost, rtol=0)
    np.testing.assert_allclose(
        run.impacts.displacement_start, exact.impacts.displacement_start, rtol=0,
        atol=30 * within * np.abs(exact.displacement).max(),
    )  # fmt: skip
    assert run.end.regime == exact.end.regime and run.end.time == exact.end.time


@every
@pytest.mark.parametrize("name", CASES)
def test_meets_its_tolerance(label: str, name: str) -> None:
    case = CASES[name]
    exact = case.follow()
    assert len(exact.impacts) >= 1
    tolerance = 1e-6 if label == "scipy Radau" else 1e-9
    run = case.follow(solver(label, tolerance))
    agree(run, exact, case.oscillator, PROMISE.get(label, 30.0) * tolerance)
    assert run.evaluations > 50


@every
def test_error_falls_with_the_tolerance(label: str) -> None:
    """Three decades of tolerance bring at least one and a half of error, also through a Hertz contact."""
    case = CASES["Hertz, 4 modes"]
    exact = case.follow()
    coarse, fine = (1e-4, 1e-7) if label == "scipy Radau" else (1e-6, 1e-9)
    errors = [distance(case.follow(solver(label, tol)), exact, case.oscillator) for tol in (coarse, fine)]
    assert errors[1] < errors[0] / 30


@fast
@pytest.mark.parametrize(
    "law",
    [
        NewtonRestitution(local_restitution=0.0),
        LinearContact(stiffness=3e5, damping=100.0),
        HuntCrossley(stiffness=1e9, dissipation=0.3),
    ],
)
def test_many_touches_without_drive(label: str, law: ContactLaw) -> None:
    """Undriven, fast modes ringing: several touches, stays on the wall, contacts that let go behind it."""
    oscillator = undriven(spring(5, law))
    start = State(displacement=np.zeros(5), velocity=np.array([0.3, 0.12, 0.1, 0.05, 0.02]))
    case = Case(oscillator, start, 0.06)
    exact = case.follow()
    assert len(exact.impacts) >= 2
    agree(case.follow(solver(label, 1e-10)), exact, oscillator, 1e-6)


@every
def test_sets_out_from_the_stop_moving_in(label: str) -> None:
    """The beam swung on a spring (gap 0): rigid turning and 9 bending modes."""
    length, side, density = 0.783, 14e-3, 2400.0
    line = density * side**2
    beam = UniformBeam(
        length=length, bending_stiffness=6.7e10 * side**4 / 12, mass_per_length=line,
        supports=("pinned", "free"),
    )  # fmt: skip
    bending = exact_modes(beam, 9)
    omega = np.append(0.0, bending.omega)
    phi = np.append(math.sqrt(3 / (line * length)), bending.phi)
    model = ModalModel(omega=omega, decay_rate=0.02 * omega, phi=phi, participation=0 * omega)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=45000.0)))
    velocity = np.zeros(10)
    velocity[0] = 3.8 * length / phi[0]
    case = Case(oscillator, State(displacement=np.zeros(10), velocity=velocity), 0.0121)
    exact = case.follow()
    tolerance = 1e-7 if label == "scipy Radau" else 1e-9
    run = case.follow(solver(label, tolerance))
    assert run.impacts.start[0] == 0.0 and run.strobe_impacts.sum() == exact.strobe_impacts.sum()
    assert distance(run, exact, oscillator) < PROMISE.get(label, 30.0) * tolerance
    assert run.impacts.end[0] == pytest.approx(exact.impacts.end[0], rel=1e-5)


@fast
@pytest.mark.parametrize("law", [LinearContact(stiffness=3e5, damping=20.0), HertzContact(stiffness=1e9)])
def test_sets_out_behind_the_stop(label: str, law: ContactLaw) -> None:
    oscillator = spring(3, law)
    start = State(displacement=np.array([5.05e-4, 0.0, 0.0]), velocity=np.array([0.01, 0.02, 0.0]), time=0.01)
    case = Case(oscillator, start, 0.06)
    exact = case.follow()
    assert exact.impacts.start[0] == start.time
    agree(case.follow(solver(label, 1e-10)), exact, oscillator, 1e-6)


@fast
def test_twenty_modes(label: str) -> None:
    oscillator = spring(20, HertzContact(stiffness=1e9))
    case = collision(oscillator, 0.7)
    exact = case.follow()
    assert len(exact.impacts) >= 1
    run = case.follow(solver(label, 1e-10))
    assert distance(run, exact, oscillator) < 1e-6 and len(run.impacts) == len(exact.impacts)


@every
def test_accumulating_impacts_come_to_rest(label: str) -> None:
    """A ball dropped from 1 m, e = 0.7: at rest after 2.55863 s, or the solver admits that it got stuck."""
    model = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.7)), load=np.array([9.81])
    )
    method = solver(label, 1e-10)
    try:
        run = simulate(oscillator, duration=3.0, times=np.array([2.5, 2.6]), method=method)
    except ContactError as error:
        # hops that are shorter than LSODA's first interpolant can follow
        assert label == "scipy LSODA" and 2.5 < error.time < 2.56
        return
    assert run.end.regime == SUSTAINED and run.impacts.kind[-1] == 2
    assert run.impacts.start[-1] == pytest.approx(2.55863, abs=1e-3)
    assert run.displacement[1, 0] == pytest.approx(1.0, abs=1e-8)
    np.testing.assert_allclose(run.impacts.approach[1:6] / run.impacts.approach[:5], 0.7, rtol=1e-5)


@fast
def test_times_wanted_anywhere(label: str) -> None:
    """States at the start, at strobes, twice at one time, within contacts and at the end."""
    case = CASES["Hertz, 4 modes"]
    exact = case.follow()
    begin, end = exact.impacts.start[0], exact.impacts.end[0]
    inside = np.linspace(begin, end, 9)
    first, last = case.start.time, case.start.time + case.length
    times = np.sort(np.concatenate([inside, [first, last, last], exact.strobe_time, exact.strobe_time]))
    runs = [
        simulate(case.oscillator, case.start, duration=case.length, times=times, method=method)
        for method in (None, solver(label, 1e-11))
    ]
    scale = np.abs(runs[0].displacement).max()
    np.testing.assert_allclose(runs[1].displacement, runs[0].displacement, atol=1e-7 * scale, rtol=0)
    np.testing.assert_array_equal(runs[1].displacement[-1], runs[1].end.displacement)
    np.testing.assert_array_equal(runs[1].displacement[0], case.start.displacement)
    depth = runs[1].displacement @ case.oscillator.model.phi - 0.005
    assert np.count_nonzero(depth > 1e-9) >= 7


@pytest.mark.parametrize(
    "law",
    [
        LinearContact(stiffness=3e5, damping=20.0),
        HuntCrossley(stiffness=1e9, dissipation=1.0),
        NewtonRestitution(local_restitution=0.5),
    ],
)
def test_jacobian_is_the_derivative_of_the_rates(law: ContactLaw) -> None:
    """Against central differences in every regime of the law, tip behind the stop."""
    oscillator = spring(3, law)
    force_law = not isinstance(law, NewtonRestitution)
    size = 7 if force_law else 6
    modes, scalars = packed(equation_of(oscillator, 0.003), 0.0)
    y = np.concatenate([[6e-4, 1e-5, -2e-5], [0.05, -0.1, 0.2], [0.0] * (size - 6)])
    assert modes[2] @ y[:3] > 0.005
    for regime in (OUTSIDE, CONTACT, INSIDE) if force_law else (OUTSIDE, SUSTAINED):
        found, plus, minus = np.empty((size, size)), np.empty(size), np.empty(size)
        jacobian(0.01, y, found, modes, scalars, regime)
        for j in range(size):
            delta = np.zeros(size)
            delta[j] = 1e-8 if j < 3 else 1e-6
            rates(0.01, y + delta, plus, modes, scalars, regime)
            rates(0.01, y - delta, minus, modes, scalars, regime)
            column = (plus - minus) / (2 * delta[j])
            noise = 1e-5 * np.abs(column).max() + 1e-9
            np.testing.assert_allclose(found[:, j], column, rtol=1e-5, atol=noise)


def test_what_is_watched_begins_below_zero() -> None:
    """Where a piece begins on a surface, rounding of either sign is no crossing."""
    oscillator = spring(1, LinearContact(stiffness=3e5))
    modes, scalars = packed(equation_of(oscillator, 0.0), 0.0)
    values = np.empty(2)
    for depth in (-1e-18, 1e-15):
        y = np.array([(0.005 + depth) / 10.0, 1.0])
        surfaces(0.5, y, values, modes, scalars, OUTSIDE, 0.5)
        assert np.all(values < 0)
    surfaces(0.5001, np.array([6e-4, 1.0]), values, modes, scalars, OUTSIDE, 0.5)
    assert values[0] == pytest.approx(1e-3)


@pytest.mark.parametrize("name", ["RK45", "DOP853", "Radau", "LSODA"])
def test_evaluations_are_counted(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from studies.instruments.peers import scipy_method

    calls = [0]

    def counting(*arguments: object) -> None:
        calls[0] += 1
        rates(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(scipy_method, "rates", counting)
    run = CASES["hard wall, Eq. (1)"].follow(ScipyMethod(solver=name, tolerance=1e-5))
    # LSODA's wrapper calls the right-hand side once more for each piece, to check what it returns
    assert calls[0] - 3 * (name == "LSODA") <= run.evaluations <= calls[0]


def test_evaluations_of_cvode_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    from studies.instruments.peers import sundials_cvode

    method, calls = solver("CVODE BDF", 1e-7), [0]

    def counting(*arguments: object) -> None:
        calls[0] += 1
        rates(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(sundials_cvode, "rates", counting)
    assert CASES["hard wall, Eq. (1)"].follow(method).evaluations == calls[0] > 100


def test_threads_do_not_share_a_compiled_integrator() -> None:
    """Two motions at once come out as they do one after the other."""
    method = solver("heyoka Taylor", 1e-12)
    oscillators = [spring(4, HertzContact(stiffness=1e9), excess=e) for e in (0.02, 0.05, 0.1, 0.2)]

    def end(oscillator: ImpactOscillator) -> np.ndarray:
        return simulate(oscillator, periods=60, method=method).end.displacement

    alone = [end(oscillator) for oscillator in oscillators]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(end, oscillators))
    np.testing.assert_array_equal(together, alone)


def test_wrong_use_is_refused() -> None:
    late = replace(equation_1(), stop=Stop(gap=1.0, law=DelayedRestitution(restitution=0.1, delay=1e-4)))
    with pytest.raises(TypeError, match="DelayedRestitution"):
        simulate(late, periods=1, method=ScipyMethod())
    with pytest.raises(ValueError, match="tolerance is 1e-15"):
        ScipyMethod(tolerance=1e-15)
    with pytest.raises(ValueError, match="solver is 'RK23'"):
        ScipyMethod(solver="RK23")
    for name in available():
        with pytest.raises(ValueError, match="tolerance is 2"):
            PEERS[name](tolerance=2.0)
    behind = State(displacement=[1.1], velocity=[0.0])
    with pytest.raises(ValueError, match="behind the stop"):
        simulate(equation_1(), behind, periods=1, method=ScipyMethod())
    with pytest.raises(ValueError, match="regime of the state is 1"):
        touching = State(displacement=[1.0], velocity=[0.0], regime=1)
        simulate(equation_1(), touching, periods=1, method=ScipyMethod())


@pytest.mark.parametrize("label", [label for label in LABELS if label != "heyoka Taylor"])
def test_a_solver_that_gives_up_gives_no_number(label: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Accelerations that stop being numbers half way."""
    method, case = solver(label, 1e-6), CASES["hard wall, Eq. (1)"]
    from studies.instruments.peers import scipy_method, sundials_cvode

    def broken(t: float, y: np.ndarray, out: np.ndarray, *rest: object) -> None:
        rates(t, y, out, *rest)  # type: ignore[arg-type]
        if t > 0.5 * case.length:
            out[:] = np.nan

    for module in (scipy_method, sundials_cvode):
        monkeypatch.setattr(module, "rates", broken)
    monkeypatch.setattr(sundials_cvode, "MOST_STEPS", 1000)  # it goes on among numbers that are none
    with pytest.raises(ContactError) as caught:
        case.follow(method)
    assert 0.4 * case.length < caught.value.time - case.start.time <= case.length


def test_a_series_of_too_many_steps_gives_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    method = solver("heyoka Taylor", 1e-9)
    monkeypatch.setattr("studies.instruments.peers.heyoka_taylor.MOST_STEPS", 2)
    with pytest.raises(ContactError, match="step_limit"):
        CASES["linear, 4 modes"].follow(method)


def test_hertz_contact_without_speed_is_refused_by_the_series() -> None:
    """Pressed against the stop from rest at it: the series in sigma never leaves, which is an error."""
    model = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=0.0, law=HertzContact(stiffness=1e6)), load=np.array([9.81])
    )
    with pytest.raises(ContactError, match="heyoka"):
        simulate(oscillator, duration=0.1, method=solver("heyoka Taylor", 1e-9))
    run = simulate(oscillator, duration=0.1, method=ScipyMethod(tolerance=1e-10))
    deepest = (2.5 * 9.81 / 1e6) ** (2 / 3)  # g d = (2/5) k d^(5/2)
    assert 0 < run.end.displacement[0] < deepest


@pytest.mark.parametrize("peer, module", [(HeyokaTaylor, "heyoka_taylor"), (SundialsCvode, "sundials_cvode")])
def test_a_missing_package_is_named(peer: type, module: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"studies.instruments.peers.{module}.find_spec", lambda name: None)
    with pytest.raises(ImportError, match=r'pip install -e "\.\[peers\]"'):
        peer()
    monkeypatch.setattr(peers, "find_spec", lambda name: None if name == peer.library else object())
    assert peer.name not in available() and "scipy" in available()


def test_importing_the_peers_imports_no_library() -> None:
    code = "import studies.instruments.peers as p, sys; p.available(); print(sorted(sys.modules))"
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True,
        cwd=Path(__file__).resolve().parent.parent,
    )  # fmt: skip
    assert "studies.instruments.peers" in answer.stdout
    loaded = answer.stdout.replace("peers.heyoka_taylor", "")
    assert "heyoka" not in loaded and "sksundae" not in loaded
