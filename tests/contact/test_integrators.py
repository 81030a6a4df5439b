"""One contract for all methods: statements, refusals, flights, collisions, what a trajectory holds."""

from __future__ import annotations

import dataclasses
import math
from contextlib import nullcontext
from functools import partial

import numpy as np
import pytest

from beam import ModalModel
from contact.collision import before_collision, collisions
from contact.drive import HarmonicDrive
from contact.errors import StepTooLarge
from contact.integrators import EXACT_NAMES, INTEGRATORS, Exact, GeneralisedAlpha, Integrator
from contact.laws import (
    DELAYED,
    HERTZ,
    LINEAR,
    NEWTON,
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
from contact.touch import TOUCHES
from contact.trajectory import State, Trajectory

LAWS: dict[int, tuple[ContactLaw, ...]] = {
    NEWTON: (NewtonRestitution(local_restitution=0.6),),
    DELAYED: (DelayedRestitution(restitution=0.6, delay=4e-4),),
    LINEAR: (LinearContact(stiffness=4e5), LinearContact(stiffness=4e5, damping=20.0)),
    HERTZ: (HertzContact(stiffness=8e7), HuntCrossley(stiffness=8e7, dissipation=0.2)),
}
"""Laws soft enough for the coarsest method, one or two of each kind."""

PERIOD = 1 / 22.2


def _fields(name: str) -> set[str]:
    """Parameters of a method."""
    return {field.name for field in dataclasses.fields(INTEGRATORS[name])}  # type: ignore[arg-type]


def oscillator_with(law: ContactLaw, modes: int = 3, gap: float = 0.01) -> ImpactOscillator:
    """A light driven spring of up to three modes, 2 % above grazing."""
    model = ModalModel(
        omega=[154.0, 980.0, 2500.0][:modes],
        decay_rate=[3.56, 20.0, 50.0][:modes],
        phi=[10.0, 9.0, 8.0][:modes],
        participation=[0.10, 0.05, 0.03][:modes],
    )
    return ImpactOscillator(
        model=model, stop=Stop(gap=gap, law=law), drive=HarmonicDrive(frequency=22.2)
    ).with_excess(0.02)


FINEST = {
    "sampled-flight": lambda fine: INTEGRATORS["sampled-flight"](points=round(64 * fine)),
    "splitting": lambda fine: INTEGRATORS["splitting"](step=PERIOD / (8000 * fine)),
    "central-difference": lambda fine: INTEGRATORS["central-difference"](step=PERIOD / (8000 * fine)),
    "generalised-alpha": lambda fine: INTEGRATORS["generalised-alpha"](step=PERIOD / (8000 * fine)),
    "moreau-jean": lambda fine: INTEGRATORS["moreau-jean"](step=PERIOD / (40000 * fine)),
    "nonsmooth-generalised-alpha": lambda fine: INTEGRATORS["nonsmooth-generalised-alpha"](
        step=PERIOD / (40000 * fine), rho=0.8
    ),
}
"""Every method that is not exact, by how fine it is made: a new one has to be entered here."""

ALL: dict[str, type[Integrator]] = INTEGRATORS


def made(name: str, fine: float = 1) -> Integrator:
    """The method, `fine` times as fine as its coarsest setting here."""
    return FINEST[name](fine) if name in FINEST else ALL[name]()


CASES = [
    pytest.param(name, law, id=f"{name}-{type(law).__name__}-{getattr(law, 'damping', 0):g}")
    for name, method in ALL.items()
    for code in method.laws
    for law in LAWS.get(code, ())
]
"""Each method with each law that it accepts."""


def modes_for(law: ContactLaw) -> int:
    """The delayed rebound holds for one mode; under Newton's law impacts of one mode do not accumulate."""
    return 1 if law.code in (DELAYED, NEWTON) else 3


def distance(run: Trajectory, exact: Trajectory, oscillator: ImpactOscillator) -> float:
    """Largest difference of the states at the strobes, as tip displacement over the gap."""
    model = oscillator.model
    apart = np.abs(model.phi) * np.hypot(
        run.strobe_displacement - exact.strobe_displacement,
        (run.strobe_velocity - exact.strobe_velocity) / model.omega,
    )
    return float(np.max(apart.sum(axis=1)) / oscillator.stop.gap)


@pytest.mark.parametrize("name", ALL)
def test_a_method_says_what_it_is(name: str) -> None:
    method = ALL[name]
    assert method.name == name or (method is Exact and name in EXACT_NAMES.values())
    assert issubclass(method, Integrator)
    assert set(method.laws) <= set(TOUCHES) and len(set(method.laws)) == len(method.laws) > 0
    assert made(name).order > 0 or math.isnan(made(name).order)
    assert method.__doc__
    assert made(name).critical_stiffness(oscillator_with(LAWS[LINEAR][0]).motion()) > 0
    # what is proved is exact and says how exact
    assert not method.certified or method.accuracy < 1e-6


@pytest.mark.parametrize("name", ALL)
def test_a_law_that_does_not_fit_is_refused_before_time_starts(name: str) -> None:
    for code, laws in LAWS.items():
        if code not in ALL[name].laws:
            with pytest.raises(TypeError, match="method"):
                simulate(oscillator_with(laws[0], 1), periods=1, method=made(name))


@pytest.mark.parametrize("name", ALL)
def test_a_flight_is_a_flight(name: str) -> None:
    """Without a touch the strobed motion is the closed form, to the method's own error."""
    law = LAWS[ALL[name].laws[0]][0]
    free = oscillator_with(law, modes_for(law)).with_excess(-0.3)
    exact = simulate(free, periods=2)
    coarse, fine = (distance(simulate(free, periods=2, method=made(name, n)), exact, free) for n in (1, 2))
    assert coarse < 2e-4
    assert fine < 1e-10 or fine < 0.6 * coarse


@pytest.mark.parametrize(("name", "law"), CASES)
def test_a_collision_is_the_exact_one_in_the_limit(name: str, law: ContactLaw) -> None:
    """State, time and number of impacts of the first collision; a finer setting is closer.

    Where the force jumps (a dashpot that is met at speed) the error falls with the step itself, times a
    number that depends on where in a step the touch falls: so the worst of a few settings, against the worst
    of some that are six times finer.
    """
    oscillator = oscillator_with(law, modes_for(law))
    start = before_collision(oscillator)
    exact = simulate(oscillator, start, periods=2)
    errors = []
    grid = "step" in _fields(name) and getattr(law, "damping", 0) > 0
    for fine in (1, 6):
        worst = 0.0
        for shift in (1.0, 1.1, 1.2, 1.3) if grid else (1.0,):
            run = simulate(oscillator, start, periods=2, method=made(name, fine * shift))
            assert len(run.impacts) == len(exact.impacts) == 1
            np.testing.assert_allclose(run.impacts.start, exact.impacts.start, atol=2e-4 * PERIOD)
            np.testing.assert_array_equal(run.strobe_impacts, exact.strobe_impacts)
            worst = max(worst, distance(run, exact, oscillator))
        errors.append(worst)
    assert errors[0] < 3e-3
    assert errors[1] < 1e-9 or errors[1] < 0.75 * errors[0]
    mine, truth = (collisions(oscillator, one, unfinished="drop")[0] for one in (run, exact))
    assert mine.kick == pytest.approx(truth.kick, abs=1e-2)
    if truth.returns:
        assert mine.restitution == pytest.approx(truth.restitution, abs=2e-2)


@pytest.mark.parametrize("name", ALL)
def test_what_a_trajectory_holds(name: str) -> None:
    law = LAWS[ALL[name].laws[0]][0]
    oscillator = oscillator_with(law, modes_for(law))
    n, start = oscillator.n_modes, before_collision(oscillator)
    period = oscillator.period
    times = start.time + np.sort(np.concatenate([np.linspace(0.0, 3.0, 50) * period, [0.4321 * period]]))
    run = simulate(oscillator, start, periods=3, times=times, method=made(name))
    assert run.strobe_displacement.shape == run.strobe_velocity.shape == (3, n)
    assert run.displacement.shape == run.velocity.shape == (times.size, n)
    assert run.strobe_impacts.shape == run.strobe_time.shape == (3,)
    np.testing.assert_allclose(run.strobe_time, np.arange(1, 4) * period, rtol=1e-12)
    assert run.strobe_impacts.sum() <= len(run.impacts) and run.evaluations > 0
    assert run.end.time == pytest.approx(start.time + 3 * period, rel=1e-12)
    np.testing.assert_allclose(run.displacement[-1], run.end.displacement, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(run.displacement[0], start.displacement, rtol=1e-9, atol=1e-12)
    hits = run.impacts
    assert np.all(hits.approach > 0) and np.all(hits.rebound <= 1e-9) and np.all(hits.end >= hits.start)
    # states at a touch lie at the stop, within what the tip moves in a step
    at_touch = hits.displacement_start @ oscillator.model.phi
    np.testing.assert_allclose(at_touch, oscillator.stop.gap, atol=1e-4 * oscillator.stop.gap)
    # a run in two pieces is the same motion
    half = simulate(oscillator, start, duration=1.5 * period, method=made(name))
    rest = simulate(oscillator, half.end, duration=1.5 * period, method=made(name))
    apart = rest.end.displacement - run.end.displacement
    assert np.abs(oscillator.model.phi) @ np.abs(apart) < 2e-2 * oscillator.stop.gap


@pytest.mark.parametrize("name", ALL)
def test_wrong_use_is_one_sentence(name: str) -> None:
    law = LAWS[ALL[name].laws[0]][0]
    oscillator = oscillator_with(law, modes_for(law))
    with pytest.raises(ValueError, match="displacement"):
        simulate(oscillator, State.rest(5), periods=1, method=made(name))
    behind = State(displacement=np.full(oscillator.n_modes, 0.1), velocity=np.zeros(oscillator.n_modes))
    if law.code in (NEWTON, DELAYED):
        with pytest.raises(ValueError, match="behind"):
            simulate(oscillator, behind, periods=1, method=made(name))


EXPLICIT = {
    "splitting": INTEGRATORS["splitting"],
    "central-difference": INTEGRATORS["central-difference"],
    "explicit Newmark": partial(GeneralisedAlpha.newmark, beta=0.0),
}


@pytest.mark.parametrize("name", EXPLICIT)
def test_a_step_beyond_the_limit_is_refused(name: str) -> None:
    """Before the run for a linear contact; during it for Hertz's, whose stiffness grows with the depth."""
    method = EXPLICIT[name](step=1e-4)
    limit = method.critical_stiffness(oscillator_with(LinearContact(stiffness=1.0)).motion())
    for part, refused in ((0.99, False), (1.01, True)):
        linear = oscillator_with(LinearContact(stiffness=part * limit))
        with pytest.raises(StepTooLarge, match="stability") if refused else nullcontext():
            simulate(linear, before_collision(linear), periods=1, method=method)
    hertz = oscillator_with(HertzContact(stiffness=1e12))
    with pytest.raises(StepTooLarge, match="too stiff") as caught:
        simulate(hertz, before_collision(hertz), periods=1, method=EXPLICIT[name](step=2e-5))
    assert caught.value.gap < 0


@pytest.mark.parametrize(
    "method",
    [
        INTEGRATORS["moreau-jean"](step=1e-4, theta=0.0),
        GeneralisedAlpha.newmark(step=1e-6, gamma=0.45),
        GeneralisedAlpha.newmark(step=2.01 / 2500.0, beta=0.0),
    ],
)
def test_a_method_that_makes_flights_grow_is_refused(method: Integrator) -> None:
    with pytest.raises(StepTooLarge, match="flight"):
        simulate(oscillator_with(LAWS[method.laws[0]][0]), periods=1, method=method)


def test_the_default_is_the_exact_method_of_the_law() -> None:
    for code, laws in LAWS.items():
        method = Exact()
        assert method.certified and method.accepts(code)
        for law in laws:
            oscillator = oscillator_with(law, modes_for(law))
            start = before_collision(oscillator)
            default, named = (
                simulate(oscillator, start, periods=2, method=chosen) for chosen in (None, method)
            )
            np.testing.assert_array_equal(default.strobe_displacement, named.strobe_displacement)


def test_methods_are_also_called_by_name() -> None:
    oscillator = oscillator_with(LAWS[LINEAR][0])
    by_name = simulate(oscillator, periods=1, method="piecewise-linear")
    np.testing.assert_array_equal(by_name.end.displacement, simulate(oscillator, periods=1).end.displacement)
    with pytest.raises(ValueError, match="method"):
        simulate(oscillator, periods=1, method="magic")
    with pytest.raises(TypeError, match="step"):
        simulate(oscillator, periods=1, method="splitting")
    with pytest.raises(TypeError, match="method"):
        simulate(oscillator, periods=1, method=3)  # type: ignore[arg-type]
