"""Samples, splits and clocks change no motion; what cannot be followed is reported with its place."""

import math
import pickle
import re

import numpy as np
import pytest
from oscillators import equation_1, modes_on_stop, newton, spring
from whole_motions import DASHPOT, HERTZ, LOSSY, SOFTER, TABLE, WAIT, falling_body, pressed

import contact
from contact import ContactError, ImpactKind, LinearContact, Regime, State, simulate
from contact.engine import event_loop
from contact.integrators import CentralDifference

SYSTEMS = {
    "one mode, Newton": lambda: equation_1(22.2, excess=0.05),
    "six modes, Newton": lambda: spring(6, newton(0.5), drive=(21.5, 1.5e-3)),
    "three modes, linear": lambda: spring(3, LinearContact(stiffness=2e4, damping=5.0), drive=(21.5, 1.5e-3)),
    "three modes, pressed": lambda: pressed(3, 0.5),
    "no drive": lambda: spring(3, LinearContact(stiffness=2e4), damping=0.0),
    "four modes, Hertz": lambda: spring(4, HERTZ, drive=(21.5, 2.2e-3)),
    "one mode, soft": lambda: spring(1, SOFTER, drive=(21.5, 2.2e-3)),
    "four modes, lossy": lambda: spring(4, LOSSY, drive=(21.5, 2.2e-3)),
    "four modes, dashpot": lambda: spring(4, DASHPOT, drive=(21.5, 2.2e-3)),
    "delayed": lambda: spring(1, WAIT, drive=(21.5, 2.2e-3)),
    "delayed by table": lambda: spring(1, TABLE, drive=(21.5, 2.2e-3)),
}


def shaken(n_modes: int) -> State:
    return State(displacement=np.zeros(n_modes), velocity=0.15 * np.eye(n_modes)[0])


@pytest.mark.parametrize("name", SYSTEMS)
def test_samples_at_the_strobes_are_the_strobes(name):
    oscillator = SYSTEMS[name]()
    state = shaken(oscillator.n_modes)
    run = simulate(oscillator, state, periods=25, times=np.arange(26) * oscillator.period)
    assert np.array_equal(run.strobe_time, np.arange(1, 26) * oscillator.period)
    scale = np.max(np.abs(run.strobe_velocity))
    np.testing.assert_allclose(run.displacement[0], state.displacement, atol=1e-17)
    np.testing.assert_allclose(run.displacement[1:], run.strobe_displacement, atol=1e-13)
    np.testing.assert_allclose(run.velocity[1:], run.strobe_velocity, atol=1e-12 * scale)
    assert np.array_equal(run.end.displacement, run.strobe_displacement[-1])
    assert np.array_equal(run.end.velocity, run.strobe_velocity[-1])
    plain = simulate(oscillator, state, periods=25)  # samples change nothing
    assert np.array_equal(plain.end.displacement, run.end.displacement)
    assert np.array_equal(plain.impacts.start, run.impacts.start)
    hits = run.impacts.start[run.impacts.kind == ImpactKind.IMPACT]
    assert hits.size >= 3
    expected = np.histogram(hits, np.arange(26) * oscillator.period)[0]
    assert np.array_equal(run.strobe_impacts, expected)


@pytest.mark.parametrize("name", SYSTEMS)
def test_run_split_in_two_is_the_run_in_one(name):
    """Split anywhere: in flight, in contact, while held, at a strobe, at a touch; ends and samples agree."""
    oscillator = SYSTEMS[name]()
    start, period = shaken(oscillator.n_modes), oscillator.period
    length = 6.0 * period
    times = np.linspace(0, length, 120)
    whole = simulate(oscillator, start, duration=length, times=times)
    scale = np.max(np.abs(whole.velocity))
    cuts = [*np.random.default_rng(3).uniform(0.1, 5.9, 25) * period, 2 * period]
    contacts = np.flatnonzero(whole.impacts.end > whole.impacts.start)
    cuts += [0.5 * (whole.impacts.start[i] + whole.impacts.end[i]) for i in contacts[:3]]
    cuts += list(whole.impacts.start[:3])
    regimes = set()
    for cut in cuts:
        one = simulate(oscillator, start, duration=cut, times=times[times <= cut])
        regimes.add(one.end.regime)
        assert one.end.time == pytest.approx(cut, rel=1e-14)
        two = simulate(oscillator, one.end, duration=length - cut, times=times[times > cut])
        both = np.concatenate([one.velocity, two.velocity])
        assert np.max(np.abs(both - whole.velocity)) < 1e-8 * scale
        assert np.max(np.abs(two.end.velocity - whole.end.velocity)) < 1e-8 * scale
        if one.end.regime == Regime.OUTSIDE:
            hits = [x.impacts.start[x.impacts.kind == ImpactKind.IMPACT] for x in (one, two, whole)]
            starts, reference = np.concatenate(hits[:2]), hits[2]
            if cut not in whole.impacts.start:
                np.testing.assert_allclose(starts, reference, rtol=0, atol=1e-9 * period)
    law = oscillator.stop.law
    if isinstance(law, contact.NewtonRestitution):
        assert Regime.SUSTAINED in regimes or name != "three modes, pressed"
    else:
        assert (Regime.WAITING if isinstance(law, contact.DelayedRestitution) else Regime.CONTACT) in regimes


def test_every_sample_is_filled_in_whatever_the_length():
    """Lengths at random, a sample at the very end: none is left out by rounding."""
    oscillator = spring(1, newton(0.5), drive=(21.5, 1.5e-3))
    generator, start = np.random.default_rng(4), shaken(1)
    for length in generator.uniform(0.01, 0.5, 200):
        run = simulate(oscillator, start, duration=length, times=[0.3 * length, length])
        scale = abs(run.velocity).max() + 1e-3
        assert run.displacement[-1] == pytest.approx(run.end.displacement, abs=1e-14)
        assert run.velocity[-1] == pytest.approx(run.end.velocity, abs=1e-12 * scale)


def test_a_sample_that_was_not_written_is_an_error(monkeypatch):
    monkeypatch.setattr(event_loop, "advance", lambda *_: event_loop.DONE)
    at_rest = spring(1, newton(0.5))
    with pytest.raises(ContactError, match="not written down") as error:
        simulate(at_rest, duration=0.1, times=[0.05])
    assert error.value.gap == at_rest.stop.gap


def test_nothing_is_computed_with_samples_that_were_not_written(monkeypatch):
    """A signalling NaN, which stands in unused memory now and then, is a warning when it is added to."""
    empty = np.empty

    def unused(shape, dtype=float, **more):
        made = empty(shape, dtype, **more)
        if made.dtype == float:
            made.view(np.uint64)[...] = 0x7FF0000000000001
        return made

    monkeypatch.setattr(np, "empty", unused)
    run = simulate(spring(1, newton(0.5), drive=(20.0, 1e-4)), duration=0.1, times=[0.03, 0.1])
    assert run.displacement[-1] == run.end.displacement


def test_the_end_of_millions_of_steps_is_written_down():
    """Rounding puts the end of this run two billionths of a step behind the last grid point."""
    oscillator = spring(1, LinearContact(stiffness=2e4), drive=(21.5, 1e-4))
    start, length = State(displacement=[1e-5], velocity=[0.0], time=0.0066015456780014106), 8.388849000000002
    exact = simulate(oscillator, start, duration=length).end
    step = CentralDifference(step=1e-6)
    run = simulate(oscillator, start, duration=length, times=[start.time + length], method=step)
    for found in (run.displacement[0], run.end.displacement):
        assert found == pytest.approx(exact.displacement, abs=1e-9)


def test_motion_without_drive_does_not_depend_on_the_clock():
    oscillator = spring(3, LinearContact(stiffness=2e4, damping=3.0))
    ends = []
    for time in (0.0, 0.0123, 17.0, -0.4):
        state = State(displacement=np.zeros(3), velocity=[0.3, 0.0, 0.0], time=time)
        run = simulate(oscillator, state, duration=0.5)
        assert run.end.time == pytest.approx(time + 0.5, abs=1e-14) and len(run.impacts) >= 3
        ends.append(np.concatenate([run.end.displacement, run.end.velocity, run.impacts.start - time]))
    for end in ends[1:]:
        np.testing.assert_allclose(end, ends[0], rtol=0, atol=1e-11)


def test_start_in_contact_is_the_rest_of_the_contact():
    """A start behind a wall that pushes is a contact at once (a force law allows it)."""
    oscillator = falling_body(0.01, LinearContact(stiffness=4e4), gravity=0.0)
    depth = 1e-4
    run = simulate(oscillator, State(displacement=[0.01 + depth], velocity=[0.0]), duration=0.1)
    assert run.impacts.end[0] == pytest.approx(0.5 * math.pi / 200.0, rel=1e-12)
    assert run.end.velocity[0] == pytest.approx(-depth * 200.0, rel=1e-12)
    # with a dashpot and moving out fast it lies inside without force, and leaves freely
    oscillator = falling_body(0.01, LinearContact(stiffness=4e4, damping=1e3), gravity=0.0)
    run = simulate(oscillator, State(displacement=[0.01 + depth], velocity=[-0.5]), duration=0.1)
    assert run.end.velocity[0] == -0.5
    assert run.impacts.end[0] == pytest.approx(depth / 0.5, rel=1e-12)


def test_graze_is_logged_and_does_nothing():
    """An undamped mode whose amplitude is the gap: grazes, no impact, no loss."""
    run = simulate(modes_on_stop(2.0, gap=0.25), State(displacement=[-0.25], velocity=[0.0]), duration=10.0)
    assert np.all(run.impacts.kind == ImpactKind.GRAZE) and len(run.impacts) >= 3
    np.testing.assert_allclose(run.impacts.start[:3], np.pi / 2 * np.array([1, 3, 5]), atol=1e-7)
    assert run.end.displacement[0] == pytest.approx(-0.25 * math.cos(20.0), abs=1e-13)
    assert not np.any(run.impacts.loss) and np.all(run.strobe_impacts == 0)


def test_errors_leave_a_worker_as_themselves():
    """A pool of processes pickles them."""
    own = (kind for kind in ContactError.__subclasses__() if kind.__module__.startswith("contact."))
    kinds = [ContactError, *own]
    assert len(kinds) > 7
    for kind in kinds:
        error = kind(time=1.5, gap=-2e-3, velocity=0.25, detail="why")
        error.orbit = "the last one"
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is kind and again.orbit == "the last one"
        assert re.fullmatch(f"{kind.reason}.*; why", str(again))
        assert (again.time, again.gap, again.velocity) == (1.5, -2e-3, 0.25)


def test_graze_lost_in_rounding_is_reported_and_not_passed():
    """Two modes that cancel to a thousandth of their size reach the stop to rounding of the larger ones."""
    state = State(displacement=[-0.01 - 2.0**-17, -0.01], velocity=[0.0, 0.0])
    for factor, outcome in ((1.0, None), (1 + 1e-9, 0), (1 - 1e-9, 1)):
        gap = (0.01 + 2.0**-17 - 0.01) * factor
        oscillator = modes_on_stop([100.0, 100.0], phi=[1.0, -1.0], law=newton(1.0), gap=gap)
        if outcome is None:
            with pytest.raises(contact.UnresolvedCrossing, match="neither") as caught:
                simulate(oscillator, state, duration=0.05)
            assert caught.value.time == pytest.approx(0.01 * math.pi, abs=1e-3)
        else:
            assert len(simulate(oscillator, state, duration=0.05).impacts) == outcome


@pytest.mark.parametrize("given", [3, 3.0, np.int64(3), Regime.SUSTAINED])
def test_a_regime_given_as_a_number_is_the_regime(given):
    assert State(displacement=[0.0], velocity=[0.0], regime=given).regime is Regime.SUSTAINED


def test_a_state_cannot_be_changed():
    state = State(displacement=[0.0, 1.0], velocity=[0.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        state.displacement[0] = 1.0
