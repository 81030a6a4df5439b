"""One step of a splitting method, and the march over many: exact flow, contact force in kicks.

The motion is split into the flight, which is known in closed form (``contact.flight``), and the contact,
during which displacements and drive stand still:

    A:  u' = v, v' = -c v - omega^2 u       B:  u' = 0,  v' = -phi N(d, r),   r = sum phi v + x_s'(t)

with the deviations u, v from the steady motion, x_s its tip displacement, and N as in ``contact.laws``.  A
step of length h is exp(b_0 h B) exp(a_1 h A) exp(b_1 h B) ... exp(a_s h A) exp(b_s h B).

B is solved exactly.  Along phi the tip rate obeys r' = -Phi N(d, r), Phi = sum phi^2, and all laws here are
N = N_0 + B (r - r_0) at fixed d, with B = c (dashpot) or k d^(3/2) chi (Hunt, Crossley):

    N(t) = N_0 exp(-B Phi t),   impulse J = N_0 (1 - exp(-B Phi t)) / (B Phi),   v -> v - phi J

(J = N_0 t for B = 0).  N keeps its sign, so that max(0, k d + c d') stays where it is within a kick.  The
energy given to the stop is J (r + r - Phi J) / 2.

Within a step the motion is what the same step would give if it were shorter: it meets the grid points, and
keeps the order of the method.  The times of touch and release are the roots of its penetration.  Far from the
stop no kick acts, and flows compose: m steps with

    y + m h (|x_s'| + sum |phi_k| sqrt(v_k^2 + omega_k^2 u_k^2)) < 0,   y the distance behind the stop,

are one flow of length m h.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.flight.modal_flow import flow_over, propagate
from contact.flight.motion import LOAD, OMEGA, WEIGHT, Motion
from contact.integrators.equation import contact_force, contact_tangent
from contact.integrators.grid import DONE, begin_step, passes, recording

__all__ = ["Composition", "Split", "march", "split_of", "take_step"]

RENEW = 32
"""Steps after which sin and cos of the drive's phase are computed anew instead of turned on: their rounding
error then stays below 1e-14."""

WORTHWHILE = 8
"""Steps that a flight has to clear to be taken at once: that costs as much as some eight steps."""


class Composition(NamedTuple):
    """The coefficients a_1 .. a_s and b_0 .. b_s of one step [1]."""

    flows: np.ndarray
    kicks: np.ndarray


@kernel
def fill_flows(motion, composition, length, flows):
    """`flows`, shape (stages, n_modes + 1, 6): the sub-flows of a step of `length` [s].

    Each mode's matrix by rows and the drift under a constant load; last the cosine and sine of the drive.
    """
    n = motion.size
    for j in range(composition.flows.size):
        t = composition.flows[j] * length
        flows[j, :n] = flow_over(motion, t)
        flows[j, n, 0], flows[j, n, 1] = math.cos(motion.drive * t), math.sin(motion.drive * t)


@kernel
def tip_depth(motion, u, sine, cosine):
    """Penetration of the tip [m]; `sine`, `cosine` belong to the phase of the drive."""
    depth = motion.level + motion.tip_sine * sine + motion.tip_cosine * cosine
    for k in range(u.size):
        depth += motion.modes[WEIGHT, k] * u[k]
    return depth


@kernel
def tip_rate(motion, v, sine, cosine):
    """Its rate [m/s]."""
    rate = motion.drive * (motion.tip_sine * cosine - motion.tip_cosine * sine)
    for k in range(v.size):
        rate += motion.modes[WEIGHT, k] * v[k]
    return rate


@kernel
def kick(motion, depth, v, sine, cosine, length):
    """The contact acts for a time `length` [s] on velocities alone; returns the energy it has taken [J]."""
    rate = tip_rate(motion, v, sine, cosine)
    force = contact_force(motion, depth, rate)
    if force == 0.0:
        return 0.0
    _stiffness, damping = contact_tangent(motion, depth, rate)
    x = damping * motion.compliance * length
    impulse = force * length * (-math.expm1(-x) / x if x != 0.0 else 1.0)
    for k in range(v.size):
        v[k] -= motion.modes[WEIGHT, k] * impulse
    return impulse * (rate - 0.5 * motion.compliance * impulse)


@kernel
def take_step(motion, composition, flows, length, depth, sine, cosine, u, v, kicks):
    """One step of `length` [s] from penetration `depth`, with the sub-flows that `fill_flows` made for it.

    `kicks` is the number of kicks, one less than there are for the state just before the last.

    Returns penetration, sine and cosine of the drive's phase at the end, the energy taken by the contact, and
    the number of kicks that found the tip in it.
    """
    n = u.size
    taken, touches = 0.0, 0
    stages = composition.flows.size
    for j in range(stages + 1):
        if depth > 0.0 and j < kicks:
            taken += kick(motion, depth, v, sine, cosine, composition.kicks[j] * length)
            touches += 1
        if j == stages:
            break
        flow = flows[j]
        c, s = flow[n, 0], flow[n, 1]
        sine, cosine = c * sine + s * cosine, c * cosine - s * sine
        depth = motion.level + motion.tip_sine * sine + motion.tip_cosine * cosine
        for k in range(n):
            uk, vk = u[k], v[k]
            u[k] = flow[k, 0] * uk + flow[k, 1] * vk + flow[k, 4]
            v[k] = flow[k, 2] * uk + flow[k, 3] * vk + flow[k, 5]
            depth += motion.modes[WEIGHT, k] * u[k]
    return depth, sine, cosine, taken, touches


class Split(NamedTuple):
    """What a run needs.

    motion : Motion
    composition : Composition
    flows, part : ndarray, shape (stages, n_modes + 1, 6)
        The sub-flows of a step, and of a part of one.
    law, number0, number1 : int, float, float
        Of the contact.
    """

    motion: Motion
    composition: Composition
    flows: np.ndarray
    part: np.ndarray
    law: int
    number0: float
    number1: float


def split_of(motion: Motion, composition: Composition) -> Split:
    """The numbers of an oscillator, split."""
    flows = np.zeros((composition.flows.size, motion.size + 1, 6))
    return Split(
        motion=motion, composition=composition, flows=flows, part=flows.copy(), law=motion.law,
        number0=motion.number0, number1=motion.number1,
    )  # fmt: skip


@kernel
def phase_of(motion, clock):
    """sin and cos of the phase of the drive."""
    phase = motion.drive * clock
    return math.sin(phase), math.cos(phase)


@kernel
def part_of_step(split, grid, x, h, acting):
    """The state after the fraction `x` of a step is that of a shorter one, without its last kick if the force
    is not `acting`; see ``contact.integrators.grid``."""
    motion, composition = split.motion, split.composition
    for k in range(motion.size):
        grid.q_at[k], grid.v_at[k] = grid.q0[k], grid.v0[k]
    fill_flows(motion, composition, x * h, split.part)
    sine, cosine = phase_of(motion, grid.clock + grid.places[0].step * grid.step)
    depth = tip_depth(motion, grid.q_at, sine, cosine)
    kicks = composition.kicks.size if acting else composition.flows.size
    depth, sine, cosine, _taken, _touches = take_step(
        motion, composition, split.part, x * h, depth, sine, cosine, grid.q_at, grid.v_at, kicks
    )
    return depth, tip_rate(motion, grid.v_at, sine, cosine)


record_step, _record_times = recording(part_of_step)


@kernel
def clear_steps(motion, depth, u, v, h):
    """How many steps of length h the tip is sure not to reach the stop."""
    speed = motion.drive * math.sqrt(motion.tip_sine**2 + motion.tip_cosine**2)
    for k in range(u.size):
        if motion.modes[LOAD, k] != 0.0:
            return 0.0
        speed += abs(motion.modes[WEIGHT, k]) * math.sqrt(v[k] * v[k] + (motion.modes[OMEGA, k] * u[k]) ** 2)
    return -depth / (speed * h) - 1.0 if speed > 0.0 else math.inf


@kernel
def march(split, grid):
    """March from the grid point reached; the grid carries deviations from the steady motion."""
    motion, composition, place = split.motion, split.composition, grid.places[0]
    h, u, v, stages = grid.step, grid.q, grid.v, composition.flows.size
    fill_flows(motion, composition, h, split.flows)
    sine, cosine = phase_of(motion, grid.clock + place.step * h)
    depth = tip_depth(motion, u, sine, cosine)
    look, renew = place.step, place.step + RENEW
    while place.step < grid.steps:
        jump, left = 1, grid.steps - place.step
        if place.step >= look and depth < 0.0 and grid.recorder.marks[0].touching == 0:
            clear = clear_steps(motion, depth, u, v, h)
            jump = left if clear > left else int(clear)
            if jump < WORTHWHILE:
                jump, look = 1, place.step + WORTHWHILE // 2
        begin_step(grid)
        before, taken, touches = depth, 0.0, 0
        if jump == 1:
            place.evaluations += stages
            depth, sine, cosine, taken, touches = take_step(
                motion, composition, split.flows, h, depth, sine, cosine, u, v, stages + 1
            )
        else:
            place.evaluations += 1
            propagate(motion, u, v, jump * h, u, v)
        if place.step + jump >= renew or jump > 1:
            sine, cosine = phase_of(motion, grid.clock + (place.step + jump) * h)
            renew = place.step + jump + RENEW
            depth = tip_depth(motion, u, sine, cosine)
        if passes(grid, jump, depth, depth <= 0.0 and touches == 0):
            continue
        status = record_step(split, grid, jump, (before, depth), taken, touches > 0)
        if status != DONE:
            return status
    return DONE
