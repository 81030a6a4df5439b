r"""Newton's law at the tip as modes are added: one impact loses its meaning, the whole collision does not.

The impulse of an impact acts on the tip alone; one that finds the higher modes at rest takes the part

    kick = (1 + e) r_N,   r_N = phi_1^2 / sum_{k <= N} phi_k^2

of the velocity of mode 1. All modes of a bare cantilever have the same phi^2, hence r_N = 1/N: the law has no
limit, and mode 1 is stopped by many impacts in quick succession, whose number grows with N. With a mass M at
the tip sum phi^2 -> 1/M and r_N -> M phi_1^2, with an error of the order 1/N. A linear contact tends to that
law as it stiffens. Units: those of the beam with L = EI = m = 1, times scaled to 24.5 Hz.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from beam import ExactModes, ModalModel, UniformBeam, exact_modes
from contact import (
    Collision,
    HarmonicDrive,
    ImpactOscillator,
    LinearContact,
    NewtonRestitution,
    State,
    Stop,
    first_collision,
    simulate,
)

FIRST, GAP = 24.5, 0.0107


@cache
def cantilever(mass: float) -> ExactModes:
    """Exact modes of the unit cantilever with a tip mass."""
    beam = UniformBeam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0, tip_mass=mass)
    return exact_modes(beam, 100)


def model_of(mass: float, count: int) -> ModalModel:
    """The first `count` modes, the first at `FIRST` Hz, one per cent of damping in each."""
    modes = cantilever(mass)
    omega = modes.omega[:count] * (2.0 * math.pi * FIRST / modes.omega[0])
    return ModalModel(
        omega=omega,
        decay_rate=0.02 * omega,
        phi=modes.phi[:count],
        participation=modes.participation[:count],
        tip_mass=mass,
    )


def share(mass: float, count: int) -> float:
    """r_N [1]."""
    phi = cantilever(mass).phi[:count]
    return float(phi[0] ** 2 / (phi @ phi))


def one_impact(mass: float, count: int, restitution: float) -> float:
    """Part of its velocity that mode 1 loses in one impact that finds the other modes at rest [1]."""
    model = model_of(mass, count)
    law = NewtonRestitution(local_restitution=restitution)
    velocity = np.zeros(count)
    velocity[0] = 3.0 * GAP * model.omega[0] / model.phi[0]
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=GAP, law=law))
    start = State(displacement=np.zeros(count), velocity=velocity)
    impacts = simulate(oscillator, start, duration=0.01).impacts
    jump = impacts.velocity_end[0, 0] - impacts.velocity_start[0, 0]
    return float(-model.phi[0] * jump / impacts.approach[0])


def whole_collision(mass: float, count: int, restitution: float) -> Collision:
    """The collision that ends the steady motion at excess 0.013, 22.2 Hz."""
    law = NewtonRestitution(local_restitution=restitution)
    return first_collision(
        ImpactOscillator(
            model=model_of(mass, count), stop=Stop(gap=GAP, law=law), drive=HarmonicDrive(frequency=22.2)
        ).with_excess(0.013)
    )


@pytest.mark.parametrize("mass", [0.0, 0.1, 0.3, 1.0])
def test_one_impact_takes_the_share_of_mode_1_whose_limit_is_that_of_the_tip_mass(mass):
    kicks = {n: one_impact(mass, n, 0.5) for n in (1, 5, 20, 40)}
    for n, kick in kicks.items():
        assert kick == pytest.approx(1.5 * share(mass, n) if mass else 1.5 / n, rel=1e-9)
    limit = 1.5 * mass * cantilever(mass).phi[0] ** 2
    assert abs(2 * kicks[40] - kicks[20] - limit) < 0.1 * abs(kicks[40] - limit)  # the error goes as 1/N


def test_the_collision_of_a_bare_tip_has_a_limit_that_forgets_the_restitution():
    few, many = whole_collision(0.0, 10, 1.0), whole_collision(0.0, 40, 1.0)
    assert many.impacts > 10 * few.impacts
    assert many.kick == pytest.approx(few.kick, rel=0.03)
    plastic = whole_collision(0.0, 40, 0.0)
    assert plastic.kick == pytest.approx(many.kick, rel=0.01)


def test_a_linear_contact_becomes_newtons_elastic_impact():
    """The kick of mode 1 by one contact tends to 2 r_N as k^-1/2, up to k/k_modal = 1e12."""
    model = model_of(0.3, 5)
    modal = float(model.omega[0] ** 2 / model.phi[0] ** 2)
    velocity = np.array([3.0 * GAP * model.omega[0] / model.phi[0], 0.0, 0.0, 0.0, 0.0])
    off = []
    for part in (1e8, 1e10, 1e12):
        stop = Stop(gap=GAP, law=LinearContact(stiffness=part * modal))
        start = State(displacement=np.zeros(5), velocity=velocity)
        impacts = simulate(ImpactOscillator(model=model, stop=stop), start, duration=0.01).impacts
        jump = impacts.velocity_end[0, 0] - impacts.velocity_start[0, 0]
        off.append(abs(-model.phi[0] * jump / impacts.approach[0] - 2.0 * share(0.3, 5)))
    assert off[0] < 1e-2 and off[2] < 1e-4
    assert math.log10(off[0] / off[2]) == pytest.approx(2.0, abs=0.2)
