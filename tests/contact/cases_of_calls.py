"""The laws of contact, oscillators, starts and approach speeds for which the public calls are made."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from oscillators import equation_1, modes_on_stop

import contact
from contact.orbits import KickFamily, PeriodicOrbit, Shooting

GAP = 0.0107
LAWS: dict[str, contact.ContactLaw] = {
    "newton": contact.NewtonRestitution(local_restitution=0.1),
    "newton by table": contact.NewtonRestitution(local_restitution=[[0.0, 0.1, 3.0], [0.9, 0.5, 0.3]]),
    "delayed": contact.DelayedRestitution(restitution=0.1, delay=1e-4),
    "delayed by table": contact.DelayedRestitution(
        restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 2e-4 * v**0.2
    ),
    "linear": contact.LinearContact(stiffness=1e7),
    "dashpot": contact.LinearContact(stiffness=1e7, damping=100.0),
    "hertz": contact.HertzContact(stiffness=1e9),
    "hunt-crossley": contact.HuntCrossley(stiffness=1e9, dissipation=0.3),
    "power": contact.PowerContact(stiffness=1e9, exponent=1.5, damping=1000.0),
}
EXTREME: dict[str, contact.ContactLaw] = {
    "plastic": contact.NewtonRestitution(local_restitution=0.0),
    "elastic": contact.NewtonRestitution(local_restitution=1.0),
    "no delay": contact.DelayedRestitution(restitution=0.9, delay=0.0),
    "delay of rounding": contact.DelayedRestitution(restitution=0.0, delay=1e-12),
    "delay that holds": contact.DelayedRestitution(restitution=0.0, delay=5e-3),
    "delay of all periods": contact.DelayedRestitution(restitution=0.5, delay=1.0),
    "softest": contact.LinearContact(stiffness=1e-300),
    "stiffest": contact.LinearContact(stiffness=1e18, damping=1e3),
    "overdamped": contact.LinearContact(stiffness=1e5, damping=1e5),
    "softest hertz": contact.HertzContact(stiffness=1e-300),
    "stiffest hertz": contact.HertzContact(stiffness=1e20),
    "softest power": contact.PowerContact(stiffness=1e-300, exponent=2.75, damping=1e-300),
    "stiffest power": contact.PowerContact(stiffness=1e20, exponent=1.25),
    "overdamped power": contact.PowerContact(stiffness=1e5, exponent=1.5, damping=1e6),
    "dissipative": contact.HuntCrossley(stiffness=1e9, dissipation=100.0),
    "dissipative and soft": contact.HuntCrossley(stiffness=1e5, dissipation=1e6),
    "creeping": contact.HuntCrossley(stiffness=1e9, dissipation=3e3),
    "creeping longest": contact.HuntCrossley(stiffness=1e9, dissipation=1e4),
}
MODES = {"dissipative": (2, 12), "creeping": (12,), "creeping longest": (12,)}
"""Other numbers of modes than one and two; delayed rebounds need a single one."""


def oscillator_of(law: contact.ContactLaw, modes: int) -> contact.ImpactOscillator:
    """Eq. (1), or a beam with two or with twelve modes; its read-out is the tip."""
    k = np.arange(modes)
    omega, phi = 154.0 * (1.0 + 1.5 * k) ** 2, (-0.8) ** (k % 2) * (1.0 if modes == 2 else 7.0)
    gamma = 1.0 / (1.0 + 2.3 * k) / phi[0]
    several = modes_on_stop(omega, 0.02 * omega, phi, gamma, law=law, gap=GAP, drive=22.2)
    plain = several if modes > 1 else equation_1(22.2, law, gap=GAP)
    return replace(plain, model=replace(plain.model, points={"laser": plain.model.points["tip"]}))


@dataclass(frozen=True)
class Case:
    """An oscillator, the start of a motion, an approach speed, and the arguments made of them."""

    oscillator: contact.ImpactOscillator
    starts_fast: bool = False
    part: float = 0.05
    """Approach speed over that of the drive at the gap."""

    @cached_property
    def driven(self) -> contact.ImpactOscillator:
        """Above grazing; the one of twelve modes far above."""
        return self.oscillator.with_excess(1e4 if self.oscillator.n_modes == 12 else 0.02)

    @cached_property
    def strobed(self) -> contact.StroboscopicMap:
        return contact.StroboscopicMap(oscillator=self.driven)

    @cached_property
    def below(self) -> contact.StroboscopicMap:
        """A map below grazing."""
        return self.strobed.at(-0.1)

    @property
    def fast(self) -> contact.State:
        """All modes at 1 m kg^0.5/s."""
        rest = contact.State.rest(self.oscillator.n_modes)
        return contact.State(displacement=rest.displacement, velocity=rest.velocity + 1.0)

    @cached_property
    def state(self) -> contact.State:
        return self.fast if self.starts_fast else self.strobed.steady()

    @cached_property
    def kicks(self) -> KickFamily:
        return KickFamily(oscillator=self.oscillator, m=5)

    @cached_property
    def family(self) -> Shooting:
        return Shooting(oscillator=self.oscillator, m=5)

    @property
    def speed(self) -> float:
        """An approach speed [m/s]."""
        return self.part * self.oscillator.drive.angular_frequency * GAP

    @cached_property
    def kicked(self) -> contact.SingleImpactOrbit:
        return self.kicks.orbit(self.speed)

    @cached_property
    def orbit(self) -> PeriodicOrbit:
        return self.family.at_speed(self.speed)


def cases_of(oscillator: contact.ImpactOscillator) -> dict[str, tuple[Case, ...]]:
    """Cases by what a call follows: a motion, one from each start, a family, its orbits at each speed."""
    slow, fast = Case(oscillator), Case(oscillator, starts_fast=True)
    speeds = tuple(Case(oscillator, part=part) for part in (1e-6, 0.05, 0.3, 20.0))
    return {"motion": (slow,), "starts": (slow, fast), "family": (speeds[1],), "speeds": speeds}


NEWTON = Case(oscillator_of(contact.NewtonRestitution(local_restitution=0.1), 1))
"""The usual case of a motion."""
HERTZ = Case(oscillator_of(contact.HertzContact(stiffness=8e9), 1))
"""The usual case of a family."""
USUAL = {"motion": NEWTON, "starts": NEWTON, "family": HERTZ, "speeds": HERTZ}
