"""Oscillators for whole motions, and an independent event-driven integration of them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np
from oscillators import OMEGA, PHI, spring
from scipy.integrate import solve_ivp

from beam import ModalModel
from contact.laws import ContactLaw, HertzContact, HuntCrossley, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.trajectory import State, Trajectory

FREE, CONTACT, INSIDE, HELD, WAITING = 0, 1, 2, 3, 4
IMPACT, GRAZE, STAY = 0, 1, 2

HERTZ, SOFTER = HertzContact(stiffness=3e7), HertzContact(stiffness=1e6)
LOSSY = HuntCrossley(stiffness=3e7, dissipation=1.2)
SPRING, DASHPOT = LinearContact(stiffness=3e5), LinearContact(stiffness=3e5, damping=15.0)


def name_of(value: object) -> str:
    """A test's name for a parameter: its text without addresses, which differ between processes."""
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:80]


def falling_body(
    height: float, law: ContactLaw, *, gravity: float = 9.81, beside: tuple[float, ...] = ()
) -> ImpactOscillator:
    """Unit mass falling on a floor; modes `beside` [rad/s] that neither touch nor feel anything."""
    omega = np.array([0.0, *beside])
    one = (omega == 0).astype(float)
    model = ModalModel(omega=omega, decay_rate=0 * omega, phi=one, participation=0 * omega)
    return ImpactOscillator(model=model, stop=Stop(gap=height, law=law), load=gravity * one)


# ------------------------------------------------------------------------- an independent event-driven motion


@dataclass
class Motion:
    """What the independent integration found."""

    times: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    end: np.ndarray = field(default_factory=lambda: np.zeros(0))
    touch: list[float] = field(default_factory=list)
    release: list[float] = field(default_factory=list)
    approach: list[float] = field(default_factory=list)
    rebound: list[float] = field(default_factory=list)
    loss: list[float] = field(default_factory=list)


def integrate(oscillator: ImpactOscillator, state: State, times: np.ndarray, *, held: bool = False) -> Motion:
    """The modal equations by DOP853, split at every touch, release and change of sign of the contact force.

    Beside the modes it integrates the work done on the stop.  `held` starts on the wall, kept there by
    whatever force that takes, until it would pull.
    """
    model, law, gap = oscillator.model, oscillator.stop.law, oscillator.stop.gap
    omega, decay, phi = model.omega, model.decay_rate, model.phi
    n = omega.size
    load = np.zeros(n) if oscillator.load is None else oscillator.load
    w = oscillator.drive.angular_frequency if oscillator.drive else 0.0
    push = model.participation * (oscillator.drive.amplitude if oscillator.drive else 0.0) * w**2
    linear = isinstance(law, LinearContact)
    k, c = (law.stiffness, law.damping) if linear else (0.0, 0.0)

    def free(t, y):
        return load + push * math.sin(w * t) - decay * y[n : 2 * n] - omega**2 * y[:n]

    def law_force(y):
        return k * (phi @ y[:n] - gap) + c * (phi @ y[n : 2 * n])

    def holding(t, y):
        return phi @ free(t, y) / (phi @ phi)

    def right(t, y, regime):
        force = {FREE: 0.0, INSIDE: 0.0, CONTACT: law_force(y), HELD: holding(t, y)}[regime]
        return np.concatenate([y[n : 2 * n], free(t, y) - phi * force, [force * (phi @ y[n : 2 * n])]])

    def height(t, y, regime):
        return phi @ y[:n] - gap

    def sign_of_force(t, y, regime):
        return holding(t, y) if regime == HELD else law_force(y)

    motion = Motion(times, np.full((times.size, n), np.nan), np.full((times.size, n), np.nan))
    t, end = state.time, float(times[-1])
    y = np.concatenate([state.displacement, state.velocity, [0.0]])
    regime = HELD if held else FREE
    while t < end:
        surface = {
            FREE: [(height, 1)],
            CONTACT: [(sign_of_force, -1)],
            HELD: [(sign_of_force, -1)],
            INSIDE: [(height, -1), (sign_of_force, 1)],
        }[regime]
        events = []
        for function, direction in surface:

            def event(t, y, regime=regime, function=function):
                return function(t, y, regime)

            event.terminal, event.direction = True, direction
            events.append(event)
        # leave the surface on which the stretch begins before watching it
        dt = min(1e-6 / omega.max() if omega.max() > 0 else 1e-6, 0.5 * (end - t))
        settings = dict(args=(regime,), method="DOP853", rtol=3e-14, atol=1e-18)
        first = solve_ivp(right, (t, t + dt), y, **settings)
        rest = solve_ivp(
            right,
            (t + dt, end),
            first.y[:, -1],
            events=events,
            dense_output=True,
            max_step=1.0 / max(omega.max(), w, 1.0),
            **settings,
        )
        inside = (times >= t) & (times <= rest.t[-1])
        for i in np.flatnonzero(inside):
            at = rest.sol(max(times[i], t + dt)) if times[i] > t else y
            motion.displacement[i], motion.velocity[i] = at[:n], at[n : 2 * n]
        t, y = float(rest.t[-1]), rest.y[:, -1].copy()
        if rest.status == 0:
            break
        speed = phi @ y[n : 2 * n]
        if regime == FREE:
            motion.touch.append(t)
            motion.approach.append(speed)
            y[-1] = 0.0
            if linear:
                regime = CONTACT
                continue
            e = law.local_restitution
            y[n : 2 * n] -= phi * (1 + e) * speed / (phi @ phi)
            motion.release.append(t)
            motion.rebound.append(-e * speed)
            motion.loss.append(0.5 * (1 - e * e) * speed**2 / (phi @ phi))
            if e == 0 and holding(t, y) > 0:
                regime = HELD
        elif regime == CONTACT and c > 0:
            regime = INSIDE
        elif regime == INSIDE and rest.t_events[1].size:
            regime = CONTACT
        else:
            motion.release.append(t)
            motion.rebound.append(speed)
            motion.loss.append(y[-1])
            regime = FREE
    motion.end = y
    return motion


def assert_same_motion(run: Trajectory, other: Motion, *, digits: float) -> None:
    """States at the sample times and the whole list of impacts, errors relative to the largest value."""
    for mine, theirs in ((run.displacement, other.displacement), (run.velocity, other.velocity)):
        assert np.max(np.abs(mine - theirs)) < digits * np.max(np.abs(theirs))
    impacts = run.impacts
    own = impacts.kind == IMPACT
    assert own.sum() == len(other.touch)
    np.testing.assert_allclose(impacts.start[own], other.touch, rtol=0, atol=digits * run.end.time)
    np.testing.assert_allclose(
        impacts.approach[own], other.approach, rtol=0, atol=digits * max(other.approach)
    )
    done = np.isfinite(impacts.end[own])
    assert done.sum() >= len(other.release) >= done.sum() - 1
    count = len(other.release)
    np.testing.assert_allclose(impacts.end[own][:count], other.release, rtol=0, atol=digits * run.end.time)
    np.testing.assert_allclose(
        impacts.rebound[own][:count], other.rebound, rtol=0, atol=digits * max(other.approach)
    )
    np.testing.assert_allclose(
        impacts.loss[own][:count], other.loss, rtol=0, atol=digits * max(max(other.loss), 1e-3)
    )


def pressed(n_modes: int, restitution: float, *, amplitude: float = 4e-4) -> ImpactOscillator:
    """A spring whose static load would hold its tip 1.2 gaps out; the drive pulls it off now and then."""
    load = np.zeros(n_modes)
    load[0] = 1.2 * 0.005 / PHI[0] * OMEGA[0] ** 2
    return spring(
        n_modes, NewtonRestitution(local_restitution=restitution), drive=(21.5, amplitude), load=load
    )
