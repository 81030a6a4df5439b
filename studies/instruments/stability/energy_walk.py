r"""Energy over many elastic contacts: the exact methods keep it, a stable fixed step lets it walk.

Central difference changes ln E in each contact by f(s) - f(s'), f = ln(1 - X s(1 - s)), X = (h omega_c)^2,
with the phases s, s' of the grid at touch and release (``short_contacts``). A contact lasts pi/W steps,
W = 2 arcsin(h omega_c/2), so that s' = r - s up to whole numbers, r the part of pi/W beyond a whole number.
For evenly spread s and small X the variance is that of X (g(s) - g(r - s)), g = s(1 - s),

    X^2 (1 + 30 B4(r))/90,     B4(r) = r^4 - 2 r^3 + r^2 - 1/30,

which vanishes for r = 0, a contact of a whole number of steps, and is X^2/90 on average over r. A body that
bounces on a spring under gravity flies for 2 v/g: once a change of v moves the next touch by more than a
step, the phases are independent and ln E walks at random, after n contacts with the standard deviation

    X sqrt(n (1 + 30 B4(r))/90).

Units: SI.
"""

from __future__ import annotations

import math

import numpy as np

from contact.integrators import CentralDifference
from contact.laws import HertzContact, LinearContact
from contact.simulation import simulate
from contact.trajectory import State
from studies.instruments.stability.findings import Limit
from studies.instruments.stability.phase_drift import OMEGA, one_mode

__all__ = ["bounces", "walk", "wander"]

GRAVITY, SPEED, CONTACT = 9.81, 1.0, 4000.0
"""Of the bouncing body: g [m/s^2], first speed [m/s] and contact frequency omega_c [rad/s]."""
ODD = 0.37
"""Part of a step by which a contact is longer than a whole number of them, which would hide the error."""


def bounces(quick: bool) -> list[Limit]:
    """Energy over many elastic contacts: the exact methods, and central difference."""
    limits: list[Limit] = []
    for law, contacts in (
        (LinearContact(stiffness=1e6), 2000 if quick else 100_000),
        (HertzContact(stiffness=1e8), 500 if quick else 20_000),
    ):
        oscillator = one_mode(law, 0.01)
        speed = 3.0 * 0.01 * OMEGA
        start = State(displacement=np.zeros(1), velocity=np.full(1, speed))
        period = 2.0 * math.pi / OMEGA
        run = simulate(oscillator, start, periods=contacts)
        # energy at the last strobe off the stop
        free = np.flatnonzero(run.strobe_displacement[:, 0] < 0.01)[-1]
        now = oscillator.energy(run.strobe_displacement[free], run.strobe_velocity[free])
        name = "piecewise-linear" if law.code == LinearContact.code else "contact-series"
        limits.append(
            Limit(
                method=name, case=f"undamped mode against an elastic stop, {len(run.impacts)} contacts",
                knob="relative change of energy [1]", theory=0.0,
                measured=float(abs(now / (0.5 * speed**2) - 1.0)), refused=None,
                note=f"in {contacts} periods of {1e3 * period:.1f} ms",
            )
        )  # fmt: skip
    for per_contact in (7,) if quick else (7, 10, 14):
        contacts, starts = (20, 32) if quick else (20, 100)
        found = wander(per_contact, contacts, starts)
        limits.append(
            Limit(
                method=CentralDifference.name,
                case=f"body bouncing on a spring, {per_contact} steps per contact, {contacts} contacts",
                knob="standard deviation of ln E [1]", theory=walk(per_contact, contacts), measured=found,
                refused=None,
                note=f"from {starts} starts, good to {1.0 / math.sqrt(2.0 * starts):.0%}; stable and "
                "accepted, yet the energy walks at random",
            )
        )  # fmt: skip
    return limits


def walk(per_contact: int, contacts: int) -> float:
    """Standard deviation of ln E by theory [1]."""
    x = math.pi / (per_contact + ODD)
    # gravity keeps the body a little longer in contact
    turn = math.pi + 2.0 * math.atan(GRAVITY / (CONTACT * SPEED))
    r = math.fmod(turn / (2.0 * math.asin(0.5 * x)), 1.0)
    bernoulli = r**4 - 2.0 * r**3 + r**2 - 1.0 / 30.0
    return x * x * math.sqrt(contacts * (1.0 + 30.0 * bernoulli) / 90.0)


def wander(per_contact: int, contacts: int, starts: int) -> float:
    """Standard deviation of ln E of a body that bounces on a spring, central difference [1]."""
    step = math.pi / (CONTACT * (per_contact + ODD))
    oscillator = one_mode(LinearContact(stiffness=CONTACT**2), 0.0, omega=0.0, load=GRAVITY)
    changes = []
    for j in range(starts):
        v = SPEED * (1.0 + 0.05 * (j + 0.5) / starts)
        begin = State(displacement=np.array([-1e-3]), velocity=np.array([v]))
        flight = 2.0 * v / GRAVITY + math.pi / CONTACT
        run = simulate(
            oscillator, begin, duration=1.6 * contacts * flight, method=CentralDifference(step=step)
        )
        # a flight lasts 2 v/g: its length tells the energy better than a velocity read off near the kink
        flights = run.impacts.start[1:] - run.impacts.end[:-1]
        if flights.size <= contacts:
            raise ValueError(f"contacts is {contacts}; the run had {flights.size}")
        changes.append(2.0 * math.log(flights[contacts] / flights[0]))
    return float(np.std(changes))
