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
from contact.flight.motion import COSINE, LOAD, OFFSET, OMEGA, SINE, WEIGHT
from contact.integrators.equation import contact_force, contact_tangent
from contact.integrators.grid import (
    COUNT,
    DIVERGED,
    END,
    EVALUATIONS,
    FINISHED,
    FULL,
    LOGGED,
    LOST,
    OUT,
    SAMPLED,
    STEP,
    STROBED,
    TOO_LARGE,
    TOUCHING,
    UNBOUNDED,
    open_touch,
)

__all__ = ["Composition", "march", "take_step"]

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
    x = contact_tangent(motion, depth, rate)[1] * motion.compliance * length
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


@kernel
def partial_step(motion, composition, length, sine, cosine, u0, v0, u, v, flows, kicks):
    """Put the state a time `length` after (u0, v0) into (u, v); returns penetration, sine and cosine."""
    for k in range(u0.size):
        u[k], v[k] = u0[k], v0[k]
    fill_flows(motion, composition, length, flows)
    depth = tip_depth(motion, u, sine, cosine)
    depth, sine, cosine, _taken, _touches = take_step(
        motion, composition, flows, length, depth, sine, cosine, u, v, kicks
    )
    return depth, sine, cosine


@kernel
def steady_of(motion, k, sine, cosine):
    """Steady displacement and velocity of mode `k` at a phase of the drive."""
    modes = motion.modes
    return (
        modes[OFFSET, k] + modes[SINE, k] * sine + modes[COSINE, k] * cosine,
        motion.drive * (modes[SINE, k] * cosine - modes[COSINE, k] * sine),
    )


@kernel
def put_state(motion, sine, cosine, u, v, row):
    """Write the physical state, steady motion added, into the first 2 n_modes places of `row`."""
    n = u.size
    for k in range(n):
        x, rate = steady_of(motion, k, sine, cosine)
        row[k], row[n + k] = u[k] + x, v[k] + rate


@kernel
def record_times(motion, composition, grid, s0, length, sine, cosine, u0, v0, u, v, flows):
    """Strobes and samples in (s0, s0 + length], from the state (u0, v0) at s0; u, v and `flows` are work
    space."""
    end = s0 + length * (1.0 + 1e-9)
    while True:
        i, j = grid.integers[SAMPLED], grid.integers[STROBED]
        sample = grid.sample[i] if i < grid.sample.size else math.inf
        strobe = grid.strobe[j] if j < grid.strobe.size else math.inf
        time = min(sample, strobe)
        if not time <= end:
            return
        _depth, s, c = partial_step(
            motion, composition, time - s0, sine, cosine, u0, v0, u, v, flows, composition.kicks.size
        )
        if sample <= strobe:
            put_state(motion, s, c, u, v, grid.samples[i])
            grid.integers[SAMPLED] += 1
        else:
            put_state(motion, s, c, u, v, grid.strobes[j])
            grid.counts[j] = grid.integers[COUNT]
            grid.integers[COUNT] = 0
            grid.integers[STROBED] += 1


@kernel
def switch(motion, composition, h, depth0, depth1, sine, cosine, u0, v0, u, v, flows):
    """Where in a step from penetration `depth0` to `depth1`, of opposite signs, the tip passes the stop.

    Regula falsi with halved end values (M. Dowell, P. Jarratt, BIT 11 (1971) 168), bisection every third
    time.  The state just there, the force not yet acting, is left in (u, v); returns time, sine and cosine.
    """
    low, high, at_low, at_high = 0.0, h, depth0, depth1
    x, s, c, side = 0.5 * h, sine, cosine, 0
    for i in range(100):
        x = 0.5 * (low + high) if i % 3 == 2 else (low * at_high - high * at_low) / (at_high - at_low)
        if not low < x < high:
            x = 0.5 * (low + high)
        depth, s, c = partial_step(
            motion, composition, x, sine, cosine, u0, v0, u, v, flows, composition.flows.size
        )
        if depth == 0.0 or high - low <= 1e-14 * h:
            break
        if (depth > 0.0) == (at_high > 0.0):
            high, at_high = x, depth
            at_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, at_low = x, depth
            at_high *= 0.5 if side == -1 else 1.0
            side = -1
    return x, s, c


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
def march(motion, composition, grid, q, v, clock, steps, h, critical):
    """March from the step reached to `steps`; q and v are physical on entry and on return."""
    n = q.size
    stages = composition.flows.size
    flows, part = np.empty((stages, n + 1, 6)), np.empty((stages, n + 1, 6))
    fill_flows(motion, composition, h, flows)
    u, u0, v0, us, vs = np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    i = grid.integers[STEP]
    phase = motion.drive * (clock + i * h)
    sine, cosine = math.sin(phase), math.cos(phase)
    for k in range(n):
        x, rate = steady_of(motion, k, sine, cosine)
        u[k] = q[k] - x
        v[k] -= rate
    depth = tip_depth(motion, u, sine, cosine)
    look, renew = i, i + RENEW
    status = FINISHED
    while i < steps:
        if grid.integers[LOGGED] >= grid.log.shape[0] - 1:
            status = FULL
            break
        s0, jump = i * h, 1
        if i >= look and depth < 0.0 and grid.integers[TOUCHING] == 0:
            clear = clear_steps(motion, depth, u, v, h)
            jump = steps - i if clear > steps - i else int(clear)
            if jump < WORTHWHILE:
                jump, look = 1, i + WORTHWHILE // 2
        for k in range(n):
            u0[k], v0[k] = u[k], v[k]
        s_in, c_in, before = sine, cosine, depth
        taken, touches = 0.0, 0
        if jump == 1:
            grid.integers[EVALUATIONS] += stages
            depth, sine, cosine, taken, touches = take_step(
                motion, composition, flows, h, depth, sine, cosine, u, v, stages + 1
            )
        else:
            grid.integers[EVALUATIONS] += 1
            propagate(motion, u, v, jump * h, u, v)
        i += jump
        if i >= renew or jump > 1:
            phase = motion.drive * (clock + i * h)
            sine, cosine = math.sin(phase), math.cos(phase)
            renew = i + RENEW
            depth = tip_depth(motion, u, sine, cosine)
        # a touch that begins and ends between two grid points, under an inner kick, lasts the whole step
        opens = grid.integers[TOUCHING] == 0 and (depth > 0.0 or touches > 0)
        closes = depth <= 0.0 and (grid.integers[TOUCHING] == 1 or opens)
        x, s, c = 0.0, s_in, c_in
        for k in range(n):
            us[k], vs[k] = u0[k], v0[k]
        if (opens or closes) and (before > 0.0) != (depth > 0.0):
            x, s, c = switch(motion, composition, h, before, depth, s_in, c_in, u0, v0, us, vs, part)
        if opens:
            row = open_touch(grid, s0 + x, tip_rate(motion, vs, s, c))
            put_state(motion, s, c, us, vs, grid.log_state[row])
        if grid.integers[TOUCHING] == 1:
            grid.log[grid.integers[LOGGED] - 1, LOST] += taken
        if closes:
            row = grid.integers[LOGGED] - 1
            if opens:
                x, s, c = h, sine, cosine
                for k in range(n):
                    us[k], vs[k] = u[k], v[k]
            grid.log[row, END] = s0 + x
            grid.log[row, OUT] = tip_rate(motion, vs, s, c)
            put_state(motion, s, c, us, vs, grid.log_state[row, 2 * n :])
            grid.integers[TOUCHING] = 0
        record_times(motion, composition, grid, s0, jump * h, s_in, c_in, u0, v0, us, vs, part)
        if not abs(depth) < UNBOUNDED:
            status = DIVERGED
            break
        if contact_tangent(motion, depth, 0.0)[0] > critical:
            status = TOO_LARGE
            break
    grid.integers[STEP] = i
    for k in range(n):
        x, rate = steady_of(motion, k, sine, cosine)
        q[k] = u[k] + x
        v[k] += rate
    return status
