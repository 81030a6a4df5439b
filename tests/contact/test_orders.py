"""Each method errs by that power of its step that theory gives: in flight, in a contact, after an impact.

A force that begins as d^p costs h^(p + 1) at the touch and at the release. The instant of an impact is off
by a part of a step: order 1, whatever the order of the flight. The errors are root mean squares over steps
that put the touch at sixteen parts of a step.
"""

import math
from functools import partial

import numpy as np
import pytest
from oscillators import OMEGA, PHI, THROWN, newton, spring
from whole_motions import DASHPOT, HERTZ, LOSSY, SPRING

from contact import ContactLaw, integrators, simulate

FLIGHT, IMPACT, CONTACT = 0.003, 0.006, 0.005
"""Durations [s]: up to just before the first touch, just after an impact, just after a contact."""

NEWTON = newton(0.6)
ALPHA, NONSMOOTH = integrators.GeneralisedAlpha, integrators.NonsmoothGeneralisedAlpha
MOREAU_JEAN = integrators.MoreauJean
SECOND = [integrators.CentralDifference, *(partial(ALPHA.newmark, beta=beta) for beta in (0.25, 0.0))]
SECOND += [partial(ALPHA.hht, alpha=0.1), *(partial(ALPHA.with_dissipation, rho=rho) for rho in (0.0, 0.8))]
# method, law, duration, numbers of steps before the touch, order
CASES = [(make, HERTZ, CONTACT, (450, 900, 1800), 2.0) for make in SECOND]
CASES += [(partial(ALPHA.newmark, beta=0.5, gamma=0.8), HERTZ, CONTACT, (450, 900, 1800), 1.0)]
CASES += [
    (partial(MOREAU_JEAN, theta=theta), NEWTON, FLIGHT, (150, 300, 600), order)
    for theta, order in ((0.5, 2.0), (0.6, 1.0), (1.0, 1.0))
]
CASES += [(partial(NONSMOOTH, rho=rho), NEWTON, FLIGHT, (300, 600, 1200), 2.0) for rho in (0.0, 0.6)]
CASES += [
    (make, NEWTON, IMPACT, (400, 1600, 6400), 1.0)
    for make in (MOREAU_JEAN, partial(NONSMOOTH, rho=0.0), partial(NONSMOOTH, rho=0.6))
]
CASES += [
    (partial(integrators.Splitting, order=order), law, CONTACT, 3600 // order**2 * 2 ** np.arange(5), power)
    for law, *powers in ((HERTZ, 2.0, 2.5), (LOSSY, 2.0), (SPRING, 2.0, 2.0), (DASHPOT, 1.0, 1.0))
    for order, power in zip((2, 4), powers, strict=False)
]


def errors(make, law: ContactLaw, duration: float, counts, tries: int = 16):
    """Root mean square of the error of the tip's place, as a velocity, for each number of steps."""
    oscillator = spring(3, law, drive=(21.5, 1e-4))
    exact = simulate(oscillator, THROWN, duration=duration)
    assert len(exact.impacts) == (duration != FLIGHT) and exact.end.regime == 0
    touch = exact.impacts.start[0] if len(exact.impacts) else duration
    found = []
    for count in counts:
        steps = [touch / (count + i / tries) for i in range(tries)]
        ends = [simulate(oscillator, THROWN, duration=duration, method=make(step=h)).end for h in steps]
        away = [PHI[:3] * OMEGA[:3] * (end.displacement - exact.end.displacement) for end in ends]
        found.append(math.sqrt(np.mean(np.square(away))))
    return np.array(found)


@pytest.mark.parametrize(("make", "law", "duration", "counts", "order"), CASES)
def test_the_error_falls_with_the_power_of_the_step_that_theory_gives(make, law, duration, counts, order):
    found = errors(make, law, duration, counts)
    rate = -np.polyfit(np.log(counts), np.log(found), 1)[0]
    assert rate == pytest.approx(order, abs=0.1 if duration != CONTACT else 0.25)


def test_the_velocity_across_an_impact_falls_with_the_root_of_the_step():
    """It is off by its whole jump while one motion has bounced and the other has not."""
    oscillator = spring(3, NEWTON, drive=(21.5, 1e-4))
    touch = float(simulate(oscillator, THROWN, duration=IMPACT).impacts.start[0])
    times = np.linspace(0.95 * touch, 1.05 * touch, 20001)
    arguments = {"duration": IMPACT, "times": times}
    reference = simulate(oscillator, THROWN, **arguments).velocity
    counts, norms = np.array([200, 800, 3200]), []
    for count in counts:
        steps = [touch / (count + i / 16) for i in range(16)]
        runs = [simulate(oscillator, THROWN, **arguments, method=MOREAU_JEAN(step=h)) for h in steps]
        norms.append(math.sqrt(np.mean([(run.velocity - reference) ** 2 for run in runs])))
    assert -np.polyfit(np.log(counts), np.log(norms), 1)[0] == pytest.approx(0.5, abs=0.1)
