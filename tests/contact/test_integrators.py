"""One contract for all methods: statements, refusals, collisions, what a trajectory holds."""

from contextlib import nullcontext
from functools import partial

import numpy as np
import pytest
from oscillators import modes_on_stop

import contact
from contact.integrators import EXACT_NAMES, INTEGRATORS, Exact, GeneralisedAlpha, Integrator
from contact.laws import LINEAR, NEWTON, POWER
from contact.touch.delayed import DELAYED

LAWS: dict[int, tuple[contact.ContactLaw, ...]] = {
    NEWTON: (contact.NewtonRestitution(local_restitution=0.6),),
    DELAYED: (contact.DelayedRestitution(restitution=0.6, delay=4e-4),),
    LINEAR: (contact.LinearContact(stiffness=4e5), contact.LinearContact(stiffness=4e5, damping=20.0)),
    POWER: (
        contact.HertzContact(stiffness=8e7),
        contact.HuntCrossley(stiffness=8e7, dissipation=0.2),
        contact.PowerContact(stiffness=8e7, exponent=1.5, damping=150.0),
    ),
}
"""Laws soft enough for the coarsest method, one or two of each kind."""

PERIOD = 1 / 22.2


def oscillator_with(law: contact.ContactLaw, modes: int = 3, gap: float = 0.01) -> contact.ImpactOscillator:
    """A light driven spring of up to three modes, 2 % above grazing."""
    rows = [154.0, 980.0, 2500.0], [3.56, 20.0, 50.0], [10.0, 9.0, 8.0], [0.10, 0.05, 0.03]
    return modes_on_stop(*(row[:modes] for row in rows), law=law, gap=gap, drive=22.2).with_excess(0.02)


FINEST = {
    "sampled-flight": lambda fine: dict(points=round(64 * fine)),
    "moreau-jean": lambda fine: dict(step=PERIOD / (40000 * fine)),
    "nonsmooth-generalised-alpha": lambda fine: dict(step=PERIOD / (40000 * fine), rho=0.8),
}
FINEST |= {
    name: lambda fine: dict(step=PERIOD / (8000 * fine))
    for name in ("splitting", "central-difference", "generalised-alpha")
}
"""The numbers of every method that is not exact, by how fine it is made: a new one has to be entered here."""


def made(name: str, fine: float = 1) -> Integrator:
    """The method, `fine` times as fine as its coarsest setting here."""
    return INTEGRATORS[name](**FINEST[name](fine)) if name in FINEST else INTEGRATORS[name]()


CASES = [
    pytest.param(name, law, id=f"{name}-{type(law).__name__}-{getattr(law, 'damping', 0):g}")
    for name, method in INTEGRATORS.items()
    for code in method.laws
    for law in LAWS.get(code, ())
]
"""Each method with each law that it accepts."""


def modes_for(law: contact.ContactLaw) -> int:
    """The delayed rebound holds for one mode; under Newton's law impacts of one mode do not accumulate."""
    return 1 if law.code in (DELAYED, NEWTON) else 3


def distance(
    run: contact.Trajectory, exact: contact.Trajectory, oscillator: contact.ImpactOscillator
) -> float:
    """Largest difference of the states at the strobes, as tip displacement over the gap."""
    model = oscillator.model
    speed = (run.strobe_velocity - exact.strobe_velocity) / model.omega
    apart = np.abs(model.phi) * np.hypot(run.strobe_displacement - exact.strobe_displacement, speed)
    return float(np.max(apart.sum(axis=1)) / oscillator.stop.gap)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_law_that_does_not_fit_is_refused_before_time_starts(name: str) -> None:
    for code, laws in LAWS.items():
        if code not in INTEGRATORS[name].laws:
            with pytest.raises(TypeError, match="method"):
                contact.simulate(oscillator_with(laws[0], 1), periods=1, method=made(name))


@pytest.mark.parametrize(("name", "law"), CASES)
def test_a_collision_is_the_exact_one_in_the_limit(name: str, law: contact.ContactLaw) -> None:
    """State, time and number of impacts of the first collision; a finer setting is closer.

    Where the force jumps (a dashpot that is met at speed) the error falls with the step itself, times a
    number that depends on where in a step the touch falls: so the worst of a few settings, against the worst
    of some that are six times finer.
    """
    oscillator = oscillator_with(law, modes_for(law))
    start = contact.before_collision(oscillator)
    exact, errors = contact.simulate(oscillator, start, periods=2), []
    grid = hasattr(made(name), "step") and getattr(law, "damping", 0) > 0
    for fine in (1, 6):
        worst = 0.0
        for shift in (1.0, 1.1, 1.2, 1.3) if grid else (1.0,):
            run = contact.simulate(oscillator, start, periods=2, method=made(name, fine * shift))
            assert len(run.impacts) == len(exact.impacts) == 1
            np.testing.assert_allclose(run.impacts.start, exact.impacts.start, atol=2e-4 * PERIOD)
            np.testing.assert_array_equal(run.strobe_impacts, exact.strobe_impacts)
            worst = max(worst, distance(run, exact, oscillator))
        errors.append(worst)
    assert errors[0] < 3e-3
    assert errors[1] < 1e-9 or errors[1] < 0.75 * errors[0]
    mine, truth = (contact.collisions(one, unfinished="drop")[0] for one in (run, exact))
    assert mine.kick == pytest.approx(truth.kick, abs=1e-2)
    if truth.returns:
        assert mine.restitution == pytest.approx(truth.restitution, abs=2e-2)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_what_a_trajectory_holds(name: str) -> None:
    law = LAWS[INTEGRATORS[name].laws[0]][0]
    oscillator = oscillator_with(law, modes_for(law))
    start, period = contact.before_collision(oscillator), oscillator.period
    times = start.time + np.sort(np.concatenate([np.linspace(0.0, 3.0, 50) * period, [0.4321 * period]]))
    run = contact.simulate(oscillator, start, periods=3, times=times, method=made(name))
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
    half = contact.simulate(oscillator, start, duration=1.5 * period, method=made(name))
    rest = contact.simulate(oscillator, half.end, duration=1.5 * period, method=made(name))
    apart = rest.end.displacement - run.end.displacement
    assert np.abs(oscillator.model.phi) @ np.abs(apart) < 2e-2 * oscillator.stop.gap


EXPLICIT = {name: INTEGRATORS[name] for name in ("splitting", "central-difference")}
EXPLICIT["explicit Newmark"] = partial(GeneralisedAlpha.newmark, beta=0.0)


@pytest.mark.parametrize("name", EXPLICIT)
def test_a_step_beyond_the_limit_is_refused(name: str) -> None:
    """Before the run for a linear contact; during it for Hertz's, whose stiffness grows with the depth."""
    method = EXPLICIT[name](step=1e-4)
    limit = method.critical_stiffness(oscillator_with(contact.LinearContact(stiffness=1.0)).numbers())
    for part, refused in ((0.99, False), (1.01, True)):
        linear = oscillator_with(contact.LinearContact(stiffness=part * limit))
        with pytest.raises(contact.StepTooLarge, match="stability") if refused else nullcontext():
            contact.simulate(linear, contact.before_collision(linear), periods=1, method=method)
    hertz = oscillator_with(contact.HertzContact(stiffness=1e12))
    with pytest.raises(contact.StepTooLarge, match="too stiff") as caught:
        contact.simulate(hertz, contact.before_collision(hertz), periods=1, method=EXPLICIT[name](step=2e-5))
    assert caught.value.gap < 0


GROWING = [INTEGRATORS["moreau-jean"](step=1e-4, theta=0.0), GeneralisedAlpha.newmark(step=1e-6, gamma=0.45)]
GROWING += [GeneralisedAlpha.newmark(step=2.01 / 2500.0, beta=0.0)]


@pytest.mark.parametrize("method", GROWING)
def test_a_method_that_makes_flights_grow_is_refused(method: Integrator) -> None:
    with pytest.raises(contact.StepTooLarge, match="flight"):
        contact.simulate(oscillator_with(LAWS[method.laws[0]][0]), periods=1, method=method)


def test_the_default_is_the_exact_method_of_the_law() -> None:
    assert Exact.certified and Exact.accuracy < 1e-6 and LAWS.keys() == EXACT_NAMES.keys()
    for code, laws in LAWS.items():
        oscillator = oscillator_with(laws[0], modes_for(laws[0]))
        methods = None, Exact(), EXACT_NAMES[code]
        ends = [contact.simulate(oscillator, periods=2, method=method).end.displacement for method in methods]
        assert Exact().accepts(code) and np.array_equal(*ends[:2]) and np.array_equal(*ends[1:])
