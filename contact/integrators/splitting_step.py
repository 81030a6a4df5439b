"""One step of a splitting method, and the loop over many: exact flow, contact force in kicks.

The motion is split into the flight, which is known in closed form (``contact.flight``), and the contact,
during which displacements and drive stand still:

    A:  u' = v, v' = -c v - omega^2 u       B:  u' = 0,  v' = -phi N(d, r),   r = sum phi v + x_s'(t)

with the deviations u, v from the steady motion, x_s its tip displacement, and N as in ``contact.laws``.  A
step of length h is exp(b_0 h B) exp(a_1 h A) exp(b_1 h B) ...  exp(a_s h A) exp(b_s h B).  With N linearised
about the rate r_0 at the start of a kick of length t, N = N_0 + B (r - r_0), and Phi = sum phi^2,

    impulse J = N_0 (1 - exp(-B Phi t)) / (B Phi),   v -> v - phi J      (J = N_0 t for B = 0).

This is exact for a force that is linear in the rate, as with all laws of the package.  For any other force
a kick is in error by h^3 d^2N/dd'^2: order 2 remains, order 4 becomes 2.  The energy given to the stop is
J (r + r - Phi J) / 2.

Within a step the state at the fraction x is that of a step of length x h.  This interpolation meets the grid
points and keeps the order of the method; the roots of its penetration are the times of touch and release.
Far from the stop no kick acts, and flows compose: m steps are one flow of length m h if

    y + m h (|x_s'| + sum |phi_k| sqrt(v_k^2 + omega_k^2 u_k^2)) < 0,   y the distance behind the stop.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.flight.modal_flow import flow_over, propagate
from contact.flight.numbers import LOAD, OMEGA
from contact.flight.tip import at_tip, push_on, tip_bound, tip_sum
from contact.integrators.grid import DONE, contact_force, contact_tangent, make_contact_writer, make_end_step
from contact.machine.compiled import inlined, kernel

RENEW = 32
"""Steps after which sine and cosine of the drive's phase are computed anew, so that the rounding error of
their recurrence stays below 1e-14."""

WORTHWHILE = 8  # least number of steps that are taken as one flight, which costs as much as some eight steps


class Composition(NamedTuple):
    """The coefficients a_1 .. a_s and b_0 .. b_s of one step [1]."""

    flows: np.ndarray
    kicks: np.ndarray


@kernel
def sub_flows(numbers, composition, length):
    """The sub-flows of a step of `length` [s], shape (stages, n_modes + 1, 6).

    A row holds the matrix of a mode by rows and its drift under a constant load.  The last row holds the
    cosine and sine of the drive's phase over the sub-flow.
    """
    n = numbers.size
    flows = np.zeros((composition.flows.size, n + 1, 6))
    for j in range(composition.flows.size):
        t = composition.flows[j] * length
        flows[j, :n] = flow_over(numbers, t)
        flows[j, n, 0], flows[j, n, 1] = math.cos(numbers.drive * t), math.sin(numbers.drive * t)
    return flows


@kernel
def tip_at(numbers, u, clock):
    """Penetration of the tip [m] at a time since a strobe [s], sine and cosine of the drive's phase there."""
    sine, cosine = math.sin(numbers.drive * clock), math.cos(numbers.drive * clock)
    steady = numbers.level + numbers.tip_sine * sine + numbers.tip_cosine * cosine
    return tip_sum(numbers, steady, u), sine, cosine


@kernel
def tip_rate(numbers, v, sine, cosine):
    """Rate of the penetration [m/s], with `sine` and `cosine` of the drive's phase."""
    return tip_sum(numbers, numbers.drive * (numbers.tip_sine * cosine - numbers.tip_cosine * sine), v)


@kernel
def kick(numbers, tip, v, length):
    """The contact acts for a time `length` [s] on velocities alone.

    `tip`: penetration, sine and cosine of the drive's phase.  Returns the energy it has taken [J], its
    impulse [N s] and its force [N].
    """
    depth, sine, cosine = tip
    rate = tip_rate(numbers, v, sine, cosine)
    force = contact_force(numbers, depth, rate)
    if force == 0.0:
        return 0.0, 0.0, 0.0
    _stiffness, damping = contact_tangent(numbers, depth, rate)
    x = damping * numbers.inverse_mass * length
    impulse = force * length * (-math.expm1(-x) / x if x != 0.0 else 1.0)
    for k in range(v.size):
        v[k] += push_on(numbers, k, impulse)
    return impulse * (rate - 0.5 * numbers.inverse_mass * impulse), impulse, force


@kernel
def take_step(numbers, split, length, tip, u, v, with_force):
    """One step of `length` [s] from `tip` (see `kick`); `split`: the composition, and its sub-flows over it.

    Returns the tip at the end, the energy [J] and impulse [N s] taken by the contact with its largest force
    [N], and whether a kick found the tip in it.
    Without `with_force` the last kick is left out.
    """
    composition, flows = split
    n, stages, touched = u.size, composition.flows.size, False
    loss, impulse, largest = 0.0, 0.0, 0.0
    depth, sine, cosine = tip
    for j in range(stages + 1):
        if depth > 0.0 and (with_force or j < stages):
            energy, push, force = kick(numbers, (depth, sine, cosine), v, composition.kicks[j] * length)
            loss, impulse, largest = loss + energy, impulse + push, max(largest, force)
            touched = True
        if j == stages:
            break
        flow = flows[j]
        c, s = flow[n, 0], flow[n, 1]
        sine, cosine = c * sine + s * cosine, c * cosine - s * sine
        depth = numbers.level + numbers.tip_sine * sine + numbers.tip_cosine * cosine
        for k in range(n):
            uk, vk = u[k], v[k]
            u[k] = flow[k, 0] * uk + flow[k, 1] * vk + flow[k, 4]
            v[k] = flow[k, 2] * uk + flow[k, 3] * vk + flow[k, 5]
            depth += at_tip(numbers, k, u[k])
    return (depth, sine, cosine), (loss, impulse, largest), touched


@inlined
def shorter_step(grid, split, x, h, with_force):
    """The state after the fraction `x` of a step: that of a shorter step (``grid.Interpolate``)."""
    numbers, u, v = grid.numbers, grid.q_at, grid.v_at
    for k in range(u.size):
        u[k], v[k] = grid.q0[k], grid.v0[k]
    tip = tip_at(numbers, u, grid.clock + grid.progress[0].step * grid.step)
    shorter = split[0], sub_flows(numbers, split[0], x * h)
    (depth, sine, cosine), _given, _touched = take_step(numbers, shorter, x * h, tip, u, v, with_force)
    return depth, tip_rate(numbers, v, sine, cosine)


end_split_step = make_end_step(shorter_step, make_contact_writer(shorter_step))


@kernel
def clear_steps(numbers, depth, u, v, h):
    """Number of steps of length h for which the tip surely stays off the stop."""
    speed = numbers.drive * numbers.amplitude
    for k in range(u.size):
        if numbers.modes[LOAD, k] != 0.0:
            return 0.0
        speed += tip_bound(numbers, k, v[k], numbers.modes[OMEGA, k] * u[k])
    return -depth / (speed * h) - 1.0 if speed > 0.0 else math.inf


@kernel
def split_steps(grid, split):
    """Steps from the grid point reached, with deviations from the steady motion; `split`: see `take_step`."""
    numbers, progress, h, u, v = grid.numbers, grid.progress[0], grid.step, grid.q, grid.v
    tip, look = tip_at(numbers, u, grid.clock + progress.step * h), progress.step
    while progress.step < grid.steps:
        count, before, given, touched = 1, tip[0], (0.0, 0.0, 0.0), False
        if progress.step >= look and before < 0.0 and grid.recorder.marks[0].touching == 0:
            count = int(min(clear_steps(numbers, before, u, v, h), grid.steps - progress.step))
            if count < WORTHWHILE:
                count, look = 1, progress.step + WORTHWHILE // 2
        if count == 1:
            tip, given, touched = take_step(numbers, split, h, tip, u, v, True)
        else:
            propagate(numbers, u, v, count * h, u, v)
        if count > 1 or (progress.step + 1) % RENEW == 0:
            tip = tip_at(numbers, u, grid.clock + (progress.step + count) * h)
        no_contact = tip[0] <= 0.0 and not touched
        status = end_split_step(grid, split, count, tip[0], no_contact, (before, given, touched))
        if status != DONE:
            return status
    return DONE
