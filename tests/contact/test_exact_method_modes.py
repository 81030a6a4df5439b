"""Newton's law at the tip as modes are added: one impact loses its meaning, the whole collision does not.

All modes of a bare cantilever have the same phi^2: an impact takes (1 + e)/N of the velocity of mode 1, which
is stopped by many impacts in quick succession.  Units of the beam: L = EI = m = 1.
"""

import math

import numpy as np
import pytest
from oscillators import newton
from simulated_orbit import on_stop

import contact
from beam import ModalModel, UniformBeam, exact_modes

GAP = 0.0107


def model_of(mass: float, count: int) -> ModalModel:
    """The first modes of the unit cantilever with a tip mass: 24.5 Hz, one per cent of damping in each."""
    unit = UniformBeam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0, tip_mass=mass)
    modes = exact_modes(unit, count)
    omega = modes.omega * (2.0 * math.pi * 24.5 / modes.omega[0])
    shapes = dict(phi=modes.phi, participation=modes.participation)
    return ModalModel(omega=omega, decay_rate=0.02 * omega, tip_mass=mass, **shapes)


def whole_collision(mass: float, count: int, restitution: float) -> contact.Collision:
    """The collision that ends the steady motion at excess 0.013, 22.2 Hz."""
    oscillator = on_stop(model_of(mass, count), 22.2, newton(restitution), gap=GAP)
    return contact.first_collision(oscillator.with_excess(0.013))


def test_the_collision_of_a_bare_tip_has_a_limit_that_forgets_the_restitution():
    few, many = whole_collision(0.0, 10, 1.0), whole_collision(0.0, 40, 1.0)
    assert many.impacts > 10 * few.impacts and many.kick == pytest.approx(few.kick, rel=0.03)
    plastic = whole_collision(0.0, 40, 0.0)
    assert plastic.kick == pytest.approx(many.kick, rel=0.01)


def test_a_linear_contact_becomes_newtons_elastic_impact():
    """The kick of mode 1 by one contact tends to 2 phi_1^2/sum phi^2 as k^-1/2, up to k/k_modal = 1e12."""
    model = model_of(0.3, 5)
    modal = float(model.omega[0] ** 2 / model.phi[0] ** 2)
    velocity = 3.0 * GAP * model.omega[0] / model.phi[0] * np.eye(5)[0]
    off = []
    for part in (1e8, 1e10, 1e12):
        stop = contact.Stop(gap=GAP, law=contact.LinearContact(stiffness=part * modal))
        start = contact.State(displacement=np.zeros(5), velocity=velocity)
        oscillator = contact.ImpactOscillator(model=model, stop=stop)
        impacts = contact.simulate(oscillator, start, duration=0.01).impacts
        jump = impacts.velocity_end[0, 0] - impacts.velocity_start[0, 0]
        share = model.phi[0] ** 2 / (model.phi @ model.phi)
        off.append(abs(-model.phi[0] * jump / impacts.approach[0] - 2.0 * share))
    assert off[0] < 1e-2 and off[2] < 1e-4
    assert math.log10(off[0] / off[2]) == pytest.approx(2.0, abs=0.2)
