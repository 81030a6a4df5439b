"""Oscillators for whole motions, and an independent event-driven integration of them."""

import math
import re
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
from oscillators import OMEGA, PHI, modes_on_stop, newton, spring
from scipy.integrate import solve_ivp

import contact
from contact import ContactLaw, HertzContact, HuntCrossley, ImpactOscillator, LinearContact, State, Trajectory

FREE, CONTACT, INSIDE, HELD = 0, 1, 2, 3
IMPACT, STAY = 0, 2

HERTZ, SOFTER = HertzContact(stiffness=3e7), HertzContact(stiffness=1e6)
LOSSY = HuntCrossley(stiffness=3e7, dissipation=1.2)
SPRING, DASHPOT = LinearContact(stiffness=3e5), LinearContact(stiffness=3e5, damping=15.0)
WAIT = contact.DelayedRestitution(restitution=0.3, delay=4e-4)
TABLE = contact.DelayedRestitution(restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 4e-4 + 1e-4 * v)


def name_of(value: object) -> str:
    """A test's name for a parameter: its text without addresses, which differ between processes."""
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:80]


def falling_body(
    height: float, law: ContactLaw, *, gravity: float = 9.81, beside: tuple[float, ...] = ()
) -> ImpactOscillator:
    """Unit mass falling on a floor; modes `beside` [rad/s] that neither touch nor feel anything."""
    omega = np.array([0.0, *beside])
    one = (omega == 0).astype(float)
    return modes_on_stop(omega, phi=one, law=law, gap=height, load=gravity * one)


def accelerations(oscillator: ImpactOscillator) -> Callable[[float, np.ndarray, np.ndarray], np.ndarray]:
    """Accelerations of the modes in flight, as a function of t, q and q'."""
    model, drive = oscillator.model, oscillator.drive
    load = 0.0 if oscillator.load is None else oscillator.load
    w = drive.angular_frequency if drive else 0.0
    push = model.participation * (drive.amplitude if drive else 0.0) * w**2
    return lambda t, q, v: load + push * math.sin(w * t) - model.decay_rate * v - model.omega**2 * q


def integrate(oscillator: ImpactOscillator, state: State, times: np.ndarray, *, held: bool = False):
    """The modal equations by DOP853, split at every touch, release and change of sign of the contact force.

    Beside the modes it integrates the work done on the stop.  `held` starts on the wall, kept there by
    whatever force that takes, until it would pull.
    """
    law, gap, flight = oscillator.stop.law, oscillator.stop.gap, accelerations(oscillator)
    omega, phi, n = oscillator.model.omega, oscillator.model.phi, oscillator.n_modes
    linear = isinstance(law, LinearContact)
    k, c = (law.stiffness, law.damping) if linear else (0.0, 0.0)

    def free(t, y):
        return flight(t, y[:n], y[n : 2 * n])

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

    samples = np.full((2, times.size, n), np.nan)
    motion = SimpleNamespace(displacement=samples[0], velocity=samples[1])
    motion.touch, motion.release, motion.approach, motion.rebound, motion.loss = ([] for _ in range(5))
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
        settings["max_step"] = 1.0 / max(omega.max(), 2.0 * math.pi / oscillator.period, 1.0)
        settings |= dict(events=events, dense_output=True)
        rest = solve_ivp(right, (t + dt, end), first.y[:, -1], **settings)
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
    return motion


def assert_same_motion(run: Trajectory, other: SimpleNamespace, *, digits: float) -> None:
    """States at the sample times and the whole list of impacts, errors relative to the largest value."""
    for mine, theirs in ((run.displacement, other.displacement), (run.velocity, other.velocity)):
        assert np.max(np.abs(mine - theirs)) < digits * np.max(np.abs(theirs))
    own = run.impacts.kind == IMPACT
    assert own.sum() == len(other.touch)
    assert np.isfinite(run.impacts.end[own]).sum() - len(other.release) in (0, 1)
    time, speed, loss = run.end.time, max(other.approach), max(*other.loss, 1e-3)
    for name, theirs, size in (
        ("start", other.touch, time),
        ("approach", other.approach, speed),
        ("end", other.release, time),
        ("rebound", other.rebound, speed),
        ("loss", other.loss, loss),
    ):
        mine = getattr(run.impacts, name)[own][: len(theirs)]
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=digits * size, err_msg=name)


def pressed(n_modes: int, restitution: float, *, amplitude: float = 4e-4) -> ImpactOscillator:
    """A spring whose static load would hold its tip 1.2 gaps out; the drive pulls it off now and then."""
    load = 1.2 * 0.005 / PHI[0] * OMEGA[0] ** 2 * np.eye(n_modes)[0]
    return spring(n_modes, newton(restitution), drive=(21.5, amplitude), load=load)
