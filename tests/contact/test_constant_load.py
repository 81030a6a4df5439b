"""A constant load g moves the rest position of a mode by g/omega^2, and a mode of zero frequency drifts."""

from dataclasses import astuple, replace
from functools import partial

import numpy as np
import pytest
from oscillators import modes_on_stop

import contact
from contact import NordmarkMap, State, Stop, StroboscopicMap, collisions, integrators, orbits, simulate

LOAD, REFUSED, GAP = np.array([70.0, -150.0]), "load (is|drives)", orbits.Change(gap=1.0)
hits = partial(collisions, unfinished="drop")
STEPPED = integrators.CentralDifference, integrators.GeneralisedAlpha, integrators.Splitting
METHODS = [integrators.Exact(), *(kind(step=1e-5) for kind in STEPPED)]
HARD = [integrators.SampledFlight(points=500), integrators.MoreauJean(step=1e-5)]
HARD += [integrators.NonsmoothGeneralisedAlpha(step=1e-5, rho=0.8)]


def strobed(o, excess=0.02):
    return StroboscopicMap(oscillator=o.with_excess(excess))


def hard(o):
    return replace(o, stop=Stop(gap=o.stop.gap, law=contact.NewtonRestitution(local_restitution=0.5)))


def settled(below):
    return orbits.settle(below, below.steady(), most_cycles=64).end


def thrown(rest):
    return State(displacement=rest, velocity=np.full(2, 0.3))


def followed(o, rest, method):
    return simulate(o, thrown(rest), periods=2, method=method).end.displacement - rest


def diagram(o, rest):
    start, seen = strobed(o, -0.2).steady(), dict(observe=lambda points: points[:, 1], settle_cycles=9)
    return orbits.orbit_diagram(strobed(o), [-0.2, -0.1], start, **seen).end.displacement - rest


# each call takes an oscillator and its rest position
CALLS = {
    "grazing_amplitude": lambda o, rest: o.grazing_amplitude(),
    "excess": lambda o, rest: o.excess,
    "drive_at": lambda o, rest: o.drive_at(o.tip(rest) + 0.002, 0.1),
    "steady": lambda o, rest: StroboscopicMap(oscillator=o).steady().displacement - rest,
    "before_collision": lambda o, rest: contact.before_collision(o).displacement - rest,
    "first_collision": lambda o, rest: astuple(contact.first_collision(o.with_excess(0.3))),
    "collisions": lambda o, rest: astuple(hits(simulate(o, thrown(rest), periods=4))[0]),
    "orbit": lambda o, rest: strobed(o).orbit(thrown(rest), 20).end.displacement - rest,
    "factors": lambda o, rest: strobed(o).orbit(thrown(rest), 2, factors=[1.2, 0.9]).end.displacement - rest,
    "jacobians": lambda o, rest: strobed(o).jacobians(thrown(rest), 3)[0][-1][0],
    "settle": lambda o, rest: settled(strobed(o, -0.1)).displacement - rest,
    "born": lambda o, rest: orbits.onset_orbit(strobed(o), 1e-3, most_cycles=200).end.displacement - rest,
    "exponents": lambda o, rest: orbits.map_exponents(strobed(o), thrown(rest), 20)[0].values,
    "diagram": diagram,
    "scan": lambda o, rest: orbits.AmplitudeScan(oscillator=o, most_cycles=128)(20.0, [-0.2, -0.1]).m,
}
FOLLOWED = {
    **{m.name: lambda o, rest, m=m: followed(o, rest, m) for m in METHODS},
    **{m.name: lambda o, rest, m=m: followed(hard(o), rest, m) for m in HARD},
    "nordmark": lambda o, rest: NordmarkMap.from_oscillator(o, restitution=0.5).alpha,
    "no changes": lambda o, rest: orbits.motion_derivatives(o, thrown(rest), [], periods=2).strobes,
}
WITHOUT = {
    "cloud": lambda o, rest: orbits.strobe_covariance(
        strobed(o, -0.1), strobed(o, -0.1).steady(), 2, deviation=1e-3
    ),
    "derivatives": lambda o, rest: orbits.strobe_derivatives(strobed(o, -0.1), strobed(o, -0.1).steady(), 2),
    "fold": lambda o, rest: orbits.fold_excess(strobed(o), 3),
    "kick": lambda o, rest: orbits.KickFamily(oscillator=o, m=1),
    "shooting": lambda o, rest: orbits.Shooting(oscillator=o, m=1),
    "changes": lambda o, rest: orbits.motion_derivatives(o, thrown(rest), [GAP], periods=1),
}


def loaded(omega):
    law = contact.LinearContact(stiffness=1e6)
    return modes_on_stop(omega, 3.0, [1.0, -0.8], [1.0, 0.3], law=law, drive=(22.2, 0.01), load=LOAD)


@pytest.mark.parametrize("name", CALLS | FOLLOWED | WITHOUT)
def test_a_load_moves_the_rest_position_or_is_refused(name):
    stiff, call, still = loaded([154.0, 900.0]), (CALLS | FOLLOWED | WITHOUT)[name], np.zeros(2)
    rest = LOAD / stiff.model.omega**2
    moved = replace(stiff, load=None, stop=Stop(gap=stiff.stop.gap - stiff.tip(rest), law=stiff.stop.law))
    right = call(moved, still)
    if name in WITHOUT:
        with pytest.raises(ValueError, match=REFUSED):
            call(stiff, rest)
    else:
        np.testing.assert_allclose(call(stiff, rest), right, rtol=1e-8, atol=1e-12)
    if name not in FOLLOWED:
        with pytest.raises(ValueError, match=REFUSED):
            call(loaded([0.0, 0.0]), still)


def test_a_load_moves_a_free_body_that_touches_the_stop_at_rest():
    body = modes_on_stop(0.0, gap=0.0, load=-9.81)
    assert simulate(body, duration=0.1).end.displacement[0] == pytest.approx(-0.5 * 9.81 * 0.01, rel=1e-14)


def test_free_modes_fall_with_their_own_loads_over_whole_periods():
    loads = np.array([-9.81, -3.0])
    two = modes_on_stop([0.0, 0.0], phi=[1.0, 0.5], gap=0.1, drive=(20.0, 0.01), load=loads)
    end = simulate(two, periods=4).end
    np.testing.assert_allclose(end.displacement, 0.5 * loads * 0.2**2, rtol=1e-14)
