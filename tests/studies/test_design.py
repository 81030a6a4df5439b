"""What to measure next: information, its limits and what it says, each by a second route."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from beam import single_mode
from contact import DelayedRestitution, HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate
from contact.orbits import Shooting
from studies.identify import design
from studies.identify.design import Nodes, Plan, covariance, errors_of, measurement

AT = {"free_period": 40.80e-3, "restitution": 0.1, "delay": 2e-4, "decay_rate": 3.56, "gap": 11.9e-3}


def of(frequency, **values):
    """Eq. (1) with two parameters."""
    now = {**AT, **values}
    law = DelayedRestitution(restitution=now["restitution"], delay=now["delay"])
    return ImpactOscillator(
        model=single_mode(free_period=now["free_period"], decay_rate=now["decay_rate"]),
        stop=Stop(gap=now["gap"], law=law), drive=HarmonicDrive(frequency=frequency),
    )  # fmt: skip


def node(frequency, period, excess):
    nodes = Nodes(of(frequency), period)
    return nodes.at(excess), nodes


def predicted(near, plan, values):
    """What is measured at other values of all that is unknown, by shooting at that amplitude and simulation."""
    *rest, amplitude = values
    there = of(near.oscillator.driven.frequency, **dict(zip(plan.unknown, rest, strict=False)))
    excess = amplitude / there.grazing_amplitude() - 1.0
    orbit = Shooting(oscillator=there, period=near.period).at_excess(excess, near)
    run = simulate(orbit.oscillator, orbit.state(), periods=orbit.period)
    return np.append(run.strobe_displacement[:, 0], there.grazing_amplitude()), orbit


def scale(orbit, plan):
    """Standard errors of what is measured."""
    return np.append(np.full(orbit.period, plan.noise * math.sqrt(orbit.period / plan.strobes)), plan.amplitude_error)


@pytest.mark.parametrize(("f", "m", "excess"), [(21.50, 4, 4e-3), (22.20, 5, 5e-4)])
def test_the_rows_are_finite_differences_of_the_orbit(f, m, excess):
    plan, (orbit, fold) = Plan(), node(f, m, excess)
    rows, away = design.changed(orbit, plan)
    values = design.values_of(orbit, plan)
    for k in range(len(values)):
        step = 1e-6 * np.eye(len(values))[k]
        (high, a), (low, b) = (predicted(orbit, plan, values * (1.0 + way * step)) for way in (1, -1))
        slope = (high - low) / 2e-6 / scale(orbit, plan)
        assert rows[:, k] == pytest.approx(slope, rel=1e-4, abs=1e-6 * np.abs(rows[:, k]).max())
        assert away[k] == pytest.approx((a.excess - b.excess) / 2e-6, rel=1e-4, abs=1e-8)


@pytest.mark.parametrize(("f", "m", "excess"), [(21.50, 4, 1e-3), (22.00, 5, -5.66e-3)])
def test_the_errors_are_the_spread_of_fits(f, m, excess):
    """60 records with the noise of the plan, fitted by shooting; a spread of 60 is good to 9 %."""
    plan, random = Plan(), np.random.default_rng(1996)
    orbit, values, sizes = node(f, m, excess)[0], None, None
    values, sizes = design.values_of(orbit, plan), scale(orbit, plan)
    clean, root = predicted(orbit, plan, values)[0], np.linalg.cholesky(covariance([orbit], plan))
    before = np.array([plan.before["decay_rate"], plan.amplitude_error]) / values[[3, 5]]
    held, found = np.eye(6)[[3, 5]] / before[:, None], []

    def slopes(part):
        there = predicted(orbit, plan, values * (1.0 + root @ part))[1]
        rows = design.changed(there, plan)[0] * (values / design.values_of(there, plan))
        return np.vstack([rows, held]) @ root

    for _ in range(60):
        seen, known = clean + sizes * random.standard_normal(m + 1), before * random.standard_normal(2)

        def off(part, seen=seen, known=known):
            there = predicted(orbit, plan, values * (1.0 + root @ part))[0]
            return np.append((there - seen) / sizes, ((root @ part)[[3, 5]] - known) / before)

        found.append(root @ least_squares(off, np.zeros(6), slopes).x)
    errors = np.sqrt(np.diag(root @ root.T))
    print(np.std(found,axis=0)/errors, np.mean(found, axis=0)/errors)
    assert np.std(found, axis=0) == pytest.approx(errors, rel=0.27)  # three times 0.09
    assert np.abs(np.mean(found, axis=0) / errors).max() < 3.0 / math.sqrt(60)


def test_one_orbit_does_not_tell_gap_restitution_and_delay_apart():
    """However much is read; with the gap from the amplitude at grazing, or with a second orbit, it does."""
    three = Plan(names=("gap", "restitution", "delay"), before={}, velocity=True)
    for f, m in ((20.90, 3), (21.50, 4), (22.60, 6)):
        rows = design.changed(node(f, m, 1e-3)[0], three)[0][:-1, :3]
        values = np.linalg.svd(rows / np.linalg.norm(rows, axis=0), compute_uv=False)
        assert values[2] < 1e-8 < 1e-4 < values[1]
    blind = Plan(amplitude_error=1e3)
    first, second = node(20.90, 3, 1e-3)[0], node(22.20, 5, 1e-3)[0]
    assert errors_of([second], blind)[0][1] > 1e3 > 1e-2 > errors_of([second, first], blind)[0][1]


def test_the_limit_is_the_fold():
    """D and its error by moving the parameters; towards the fold the errors alone vanish as D^(1/2)."""
    plan = Plan()
    nodes = Nodes(of(22.20), 5)
    near, far = (measurement(nodes.at(nodes.fold.excess + d), nodes, plan) for d in (1e-8, 1e-6))
    assert np.array(near.alone) / far.alone == pytest.approx(0.1, rel=0.1)
    assert not near.kept and near.distance == pytest.approx(1e-8, rel=1e-3)
