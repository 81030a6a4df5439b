"""Work and precision: reference by closed forms and a second route, orders, front, known crossings."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from oscillators import light_tip, newton

import contact
from contact import ContactLaw, HertzContact, LinearContact, Stop, before_collision, first_collision, simulate
from contact.integrators import CentralDifference, Exact
from studies.letter import TIME_TRACE_EXCESS
from studies.methods.peers import missing_solvers
from studies.methods.work_precision import gradients
from studies.methods.work_precision.__main__ import sentences
from studies.methods.work_precision.costs import heyoka_orbit
from studies.methods.work_precision.methods import EXACT, SAMPLED, STEPPED, Setting, Sweep, sweeps_for
from studies.methods.work_precision.model import (
    Measured,
    Reference,
    in_turns,
    missed_share,
    reference_of,
    rows_of,
)
from studies.methods.work_precision.problems import HERTZ, driven_problem, hertz_beam, linear_beam
from studies.methods.work_precision.reference import extended_motion
from studies.shell.scene import read_scene, single_mode_at

SCENE = read_scene("letter", [])
FEW_MODES = SCENE.replace({"modes.count": 4})


leaf = partial(light_tip, 3, excess=0.013)


@pytest.mark.parametrize(
    "law",
    [newton(0.1), LinearContact(stiffness=2e5), HertzContact(stiffness=1e8)],
    ids=["newton", "linear", "hertz"],
)
def test_the_exact_method_agrees_with_the_reference(law: ContactLaw) -> None:
    """The Taylor series in 24 digits and `simulate`, which share no formula, to the rounding of doubles."""
    oscillator = leaf(law)
    start = before_collision(oscillator)
    probe = start.time + oscillator.period
    run = simulate(oscillator, start, duration=1.3 * oscillator.period, times=np.array([probe]))
    found = extended_motion(oscillator, start, probe)
    q, v, (begin, end) = found.displacement, found.velocity, found.touches[0]
    size = oscillator.stop.gap / oscillator.model.phi[0]
    speed = size * 2 * math.pi / oscillator.period
    assert float(begin) == pytest.approx(run.impacts.start[0], rel=1e-14)
    assert float(end) == pytest.approx(run.impacts.end[0], rel=1e-14)
    np.testing.assert_allclose([float(x) for x in q], run.displacement[0], atol=1e-13 * size)
    np.testing.assert_allclose([float(x) for x in v], run.velocity[0], atol=1e-13 * speed)


def test_what_the_reference_cannot_follow_is_refused() -> None:
    lossy = contact.HuntCrossley(stiffness=1e8, dissipation=0.5)
    for law in (lossy, LinearContact(stiffness=1e5, damping=1.0)):
        with pytest.raises(ValueError, match="law of the stop"):
            extended_motion(leaf(law), before_collision(leaf(law)), 0.1)
    deep = leaf(HertzContact(stiffness=1e8))
    start = before_collision(deep)
    touch = simulate(deep, start, periods=1).impacts
    with pytest.raises(ValueError, match="in a contact"):
        extended_motion(deep, start, 0.5 * (touch.start[0] + touch.end[0]))


def test_linear_contact_lasts_as_long_as_that_of_hertz() -> None:
    oscillator, hertz = linear_beam(FEW_MODES), hertz_beam(FEW_MODES)
    assert isinstance(oscillator.stop.law, LinearContact)
    assert oscillator.excess == pytest.approx(TIME_TRACE_EXCESS, rel=1e-9)
    wanted = first_collision(hertz).contact_time
    assert first_collision(oscillator).contact_time == pytest.approx(wanted, rel=1e-11)


@pytest.fixture(scope="module")
def few() -> Reference:
    """Four modes, linear contact."""
    return reference_of(driven_problem("linear", "four modes", linear_beam(FEW_MODES)))


def test_the_exact_method_is_at_rounding(few: Reference) -> None:
    (sweep,) = [one for one in sweeps_for(few.problem) if one.family == EXACT]
    (exact,) = rows_of(few, sweep, repeats=1)
    method = Exact()
    assert exact.certified and exact.missed == 0.0
    assert exact.error is not None and exact.error < 1e-13 < method.accuracy and few.own_error < 1e-19


def test_a_refused_or_slow_setting_is_a_row_with_its_sentence(few: Reference) -> None:
    settings = [Setting(h, f"{h:g}", CentralDifference(step=h)) for h in (6e-5, 1e-5, 1e-6, 1e-10)]
    sweep = Sweep(label="x", family=STEPPED, growth=1e4, settings=settings)
    refused, first, *rest = rows_of(few, sweep, slowest=1e-3, repeats=1)
    assert refused.failed.startswith("StepTooLarge") and first.failed == "" and len(rest) == 2
    assert all(one.failed.startswith("not run") for one in rest)
    assert all(one.error is one.missed is one.time_per_period_us is None for one in (refused, *rest))


def test_crossings_are_missed_by_a_coarse_grid_and_never_by_the_exact_method(few: Reference) -> None:
    soft = Stop(gap=few.problem.oscillator.stop.gap, law=LinearContact(stiffness=10.0))
    problem = replace(few.problem, oscillator=replace(few.problem.oscillator, stop=soft))
    shares = [missed_share(problem, CentralDifference(step=step)) for step in (3e-4, 3e-5, 3e-6)]
    assert missed_share(few.problem, Exact()) == missed_share(problem, Exact()) == 0.0
    assert shares == sorted(shares, reverse=True) and shares[0] > 0.1 > shares[-1]


def test_errors_of_gradients_fall_as_the_order_of_the_differences_says(letter_scene, monkeypatch):
    """And then rise; derivatives are better than the best of them by five orders of magnitude."""
    monkeypatch.setattr(gradients, "REPEATS", 1)
    rows = gradients.gradients(single_mode_at(letter_scene, 22.2).with_excess(1e-3))
    exact = next(row.error for row in rows if row.method == "exact")
    error = {round(-np.log10(row.setting)): row.error for row in rows if row.method == "central differences"}
    assert np.log10(error[5] / error[6]) == pytest.approx(2.0, abs=0.05)
    assert error[12] > 10.0 * min(error.values()) > 1e5 * exact
    assert exact < 1e-12


def test_runs_are_timed_in_turns() -> None:
    order: list[str] = []
    spent = in_turns({name: (lambda _periods, name=name: order.append(name), 5) for name in "ab"}, 3)
    assert order == ["a", "b"] * 4 and set(spent) == {"a", "b"} and min(spent.values()) >= 0.0


@pytest.mark.skipif("heyoka" in missing_solvers(), reason="heyoka is not installed")
def test_bare_heyoka_is_on_the_same_orbit(letter_scene) -> None:
    """It reaches the p5 of the package: it is a peer, not a straw man."""
    oscillator = single_mode_at(letter_scene, 22.2).with_excess(0.02)
    strobed = contact.StroboscopicMap(oscillator=oscillator)
    settled = strobed.orbit(strobed.steady(), 2000).end
    cycle = strobed.tip(strobed.orbit(settled, 5).points)
    orbit, taylor = heyoka_orbit(oscillator)
    orbit(2000)
    assert np.min(np.abs(cycle - taylor.state[0] * oscillator.model.phi[0])) < 1e-8 * oscillator.stop.gap


def test_the_exact_method_is_compared_with_methods_that_miss_no_touch() -> None:
    same = Measured(
        problem=HERTZ, method="", family=STEPPED, setting="", value=1.0, certified=False, error=1e-9
    )
    exact = replace(same, family=EXACT, missed=0.0, time_per_period_us=10.0)
    rows = [exact, replace(exact, family=STEPPED, time_per_period_us=50.0)]
    rows += [replace(same, missed=0.2, time_per_period_us=20.0), replace(rows[1], time_per_period_us=None)]
    rows += [
        replace(exact, family=STEPPED, method=SAMPLED, missed=lost, time_per_period_us=15.0)
        for lost in (0, 0.3)
    ]
    said = " ".join(sentences(rows))
    assert all(words in said for words in ("takes 10 µs", "at least 5 times", "miss 30 %"))
