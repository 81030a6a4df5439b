"""Contact under Hertz's law with the modes gathered into the derivatives of the tip velocity.

The force N = k d^(3/2) (1 + chi d') has no Taylor series at the touch d = 0, where every contact begins and
ends.  With r = sqrt(d) and a variable sigma that runs slowly while the contact is shallow (as in
``contact.hertz_series``),

    dt/dsigma = r,    dr/dsigma = d'/2,    r N = k (r^4 + chi r^4 d'),

all right-hand sides are polynomials.  The modes enter through the tip velocity alone.  Let s_k(t) be the
answer of mode k to a unit impulse, with the derivatives s_kj at t = 0

    s_k0 = 0,   s_k1 = 1,   s_k(j+2) = -c_k s_k(j+1) - omega_k^2 s_kj,

and let Y_m be what the (m+1)-th derivative of the tip displacement would be if the force stopped now,

    Y_m = theta^m [ x_s^(m+1)(t) + sum_k phi_k u_k^(m+1) ],   u_k^(j) = s_kj v_k - omega_k^2 s_k(j-1) u_k
                                                                          (+ load_k s_k(j-1)),

theta a time that keeps the numbers near one.  Then, without approximation,

    dY_m/dsigma = (r/theta) Y_(m+1) - g_m r N,    g_m = theta^m sum_k phi_k^2 s_k(m+1),    d' = Y_0:

and since the coefficients of d' to order p need those of Y_m to order p - m only, a step costs some p^3/6
multiplications however many modes there are, and two sums over the modes: Y_m at its start, and at its end, a
time h later,

    u = C u_0 + S v_0 - phi sum_j s_j I_j,     v = S' v_0 - omega^2 S u_0 - phi sum_j s_(j+1) I_j,
    S = sum_j s_j h^j/j!,    C = S' + c S,     I_j = integral of (h - t)^j/j! r N dsigma,

the integrals by Gauss's rule, which for a series cut where its terms drown in rounding is exact to rounding.
The neglected terms of a step lie below ``HERTZ_TOLERANCE`` of the modal speeds.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs
from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.crossing import first_polynomial_root, polynomial_root
from contact.flight import EPS, loaded_drift, tip_state
from contact.hertz_series import HERTZ_TOLERANCE, evaluate

__all__ = [
    "CHAIN_ORDER",
    "CLOCK_SERIES",
    "TIME_ORDER",
    "chain_scale",
    "chain_series",
    "chain_state",
    "chain_step",
    "chain_table",
    "depth_root",
]

CHAIN_ORDER = 20
"""p, the order in sigma."""

TIME_ORDER = 24
"""Terms of the sums over j."""

ROOT, CLOCK_SERIES, SPEED = 0, 1, 2
"""Rows of the scalar series: r, time since the step's start, d'."""

PUSH, SQUARE = 0, 1
"""Rows of the products: r N and r^2."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
NODES, WEIGHTS = 0.5 * (1.0 + _NODES), 0.5 * _WEIGHTS
"""Gauss's rule on [0, 1].  If the series converges up to sigma = R and the step is s, the error falls as
rho^-16, rho = q + sqrt(q^2 - 1), q = 2 R/s - 1: faster than the (s/R)^p of the series itself."""

INVERSE = 1.0 / np.maximum(1.0, np.arange(64.0))
"""1/n."""

SHORT = (1e-17 * math.factorial(TIME_ORDER)) ** (1.0 / TIME_ORDER)
"""Phase of the fastest mode up to which the sums over j leave out less than rounding, whatever its motion."""


@kernel
def chain_scale(motion):
    """theta [s]: 1 over the fastest rate."""
    fastest = motion.drive
    for k in range(motion.omega.size):
        fastest = max(fastest, motion.omega[k], motion.decay[k])
    return 1.0 / fastest if fastest > 0.0 else motion.period


@kernel
def chain_table(motion, theta, impulse, seen, pull):
    """Numbers of the oscillator that all steps share.

    Parameters
    ----------
    motion : Motion
    theta : float
        [s]
    impulse : ndarray, shape (TIME_ORDER + 2, n_modes)
        Results: theta^(j-1) s_kj.
    seen : ndarray, shape (n_modes, CHAIN_ORDER + 2)
        Results: phi_k theta^(j-1) s_kj.
    pull : ndarray, shape (CHAIN_ORDER + 8,)
        Results: g_m, then zeros.
    """
    for m in range(pull.size):
        pull[m] = 0.0
    for k in range(motion.omega.size):
        c, o2 = motion.decay[k] * theta, (motion.omega[k] * theta) ** 2
        x, y = 0.0, 1.0
        for j in range(TIME_ORDER + 2):
            impulse[j, k] = x
            if j <= CHAIN_ORDER + 1:
                seen[k, j] = motion.phi[k] * x
            if 1 <= j <= CHAIN_ORDER + 1:
                pull[j - 1] += motion.phi[k] ** 2 * x
            x, y = y, -c * y - o2 * x


@kernel
def chain_series(motion, theta, seen, pull, base, u, v, chain, scalars, products):
    """Fill the Taylor coefficients in sigma of a contact that is at (u, v) at time `base` after the strobe.

    Parameters
    ----------
    motion : Motion
        number0 = k [N/m^1.5], number1 = chi [s/m].
    theta, seen, pull
        From `chain_scale`, `chain_table`.
    base : float
        [s]
    u, v : ndarray, shape (n_modes,)
    chain : ndarray, shape (CHAIN_ORDER + 1, CHAIN_ORDER + 9)
        Results: row n holds the coefficients of order n of all Y_m.  Finite numbers on entry.
    scalars : ndarray, shape (3, CHAIN_ORDER + 1)
        Results: r, time, d'.  On entry scalars[0, 0] holds r, which the caller carries along: computed anew
        from the tip displacement it would lose its digits at shallow depth.
    products : ndarray, shape (2, 2 CHAIN_ORDER)
        Results: r N to order CHAIN_ORDER - 1, r^2.
    """
    w = motion.drive
    stiffness, chi = motion.number0, motion.number1
    r, clock, speed = scalars[ROOT], scalars[CLOCK_SERIES], scalars[SPEED]
    push, square = products[PUSH], products[SQUARE]
    for n in range(2 * CHAIN_ORDER):
        push[n] = 0.0
        square[n] = 0.0
    sine, cosine = math.sin(w * base), math.cos(w * base)
    a = motion.tip_sine * sine + motion.tip_cosine * cosine
    b = motion.tip_sine * cosine - motion.tip_cosine * sine
    y = chain[0]
    turn = w
    for m in range(0, CHAIN_ORDER + 1, 2):
        y[m] = turn * b
        y[m + 1] = -turn * (w * theta) * a
        turn *= -((w * theta) ** 2)
    for k in range(u.size):
        vk, uk = v[k], -((motion.omega[k] * theta) ** 2) / theta * u[k] + motion.load[k] * theta
        row = seen[k]
        for m in range(CHAIN_ORDER + 1):
            y[m] += row[m + 1] * vk + row[m] * uk
    clock[0] = 0.0
    for n in range(CHAIN_ORDER):
        rn, inverse = r[n], INVERSE[n + 1]
        speed[n] = chain[n, 0]
        twice = 2.0 * rn
        for j in range(n):
            square[n + j] += twice * r[j]
        square[2 * n] += rn * rn
        sn = square[n]
        twice = 2.0 * sn
        for j in range(n):
            push[n + j] += twice * square[j]
        push[2 * n] += sn * sn
        total = push[n]
        if chi != 0.0:
            for i in range(n + 1):
                total += chi * push[i] * speed[n - i]
        r_force = stiffness * inverse * total
        r[n + 1] = 0.5 * inverse * speed[n]
        clock[n + 1] = inverse * rn
        scale = inverse / theta
        # sums of eight columns at a time, which stay in registers; what goes beyond order p - n is unused
        for m in range(0, CHAIN_ORDER - n, 8):
            a0, a1, a2, a3, a4, a5, a6, a7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for i in range(n + 1):
                ri, j = r[i], n - i
                a0 += ri * chain[j, m + 1]
                a1 += ri * chain[j, m + 2]
                a2 += ri * chain[j, m + 3]
                a3 += ri * chain[j, m + 4]
                a4 += ri * chain[j, m + 5]
                a5 += ri * chain[j, m + 6]
                a6 += ri * chain[j, m + 7]
                a7 += ri * chain[j, m + 8]
            chain[n + 1, m] = scale * a0 - pull[m] * r_force
            chain[n + 1, m + 1] = scale * a1 - pull[m + 1] * r_force
            chain[n + 1, m + 2] = scale * a2 - pull[m + 2] * r_force
            chain[n + 1, m + 3] = scale * a3 - pull[m + 3] * r_force
            chain[n + 1, m + 4] = scale * a4 - pull[m + 4] * r_force
            chain[n + 1, m + 5] = scale * a5 - pull[m + 5] * r_force
            chain[n + 1, m + 6] = scale * a6 - pull[m + 6] * r_force
            chain[n + 1, m + 7] = scale * a7 - pull[m + 7] * r_force
    speed[CHAIN_ORDER] = chain[CHAIN_ORDER, 0]
    # r N from r^4
    if chi != 0.0:
        for n in range(CHAIN_ORDER - 1, -1, -1):
            total = push[n]
            for i in range(n + 1):
                total += chi * push[i] * speed[n - i]
            push[n] = stiffness * total
    else:
        for n in range(CHAIN_ORDER):
            push[n] *= stiffness


@kernel
def chain_step(motion, theta, u, v, scalars, products, negative, limit):
    """Length of the step in sigma and how it ends.

    Returns
    -------
    s : float
        Step in sigma.
    released : bool
        Whether the contact ends there.
    length : float
        Its duration [s], at most `limit`.
    """
    p = CHAIN_ORDER
    r, clock, speed, push = scalars[ROOT], scalars[CLOCK_SERIES], scalars[SPEED], products[PUSH]
    energy = 0.0
    for k in range(motion.omega.size):
        energy += v[k] ** 2 + (motion.omega[k] * u[k]) ** 2
        energy += motion.drive**2 * (motion.sine[k] ** 2 + motion.cosine[k] ** 2)
    weight = math.sqrt(motion.compliance)
    allowed = HERTZ_TOLERANCE * math.sqrt(energy)
    top = max(weight * abs(push[p - 1]) * INVERSE[p], abs(speed[p]) / weight)
    below = max(weight * abs(push[p - 2]) * INVERSE[p - 1], abs(speed[p - 1]) / weight)
    s = math.inf
    if top > 0.0:
        s = (allowed / top) ** (1.0 / p)
    if below > 0.0:
        s = min(s, (allowed / below) ** (1.0 / (p - 1)))
    if r[1] < 0.0 < r[0]:
        # no further than well behind the release: with no force left the terms give no bound
        s = min(s, -4.0 * r[0] / r[1])
    # r and the time must be resolved as well as the modes
    size = max(abs(r[1]), math.sqrt(abs(r[2])), abs(r[3]) ** (1.0 / 3.0))
    if abs(r[p]) > 0.0 and size > 0.0:
        for _ in range(40):
            if abs(r[p]) * s**p <= HERTZ_TOLERANCE * (abs(r[0]) + abs(r[1]) * s):
                break
            s *= 0.9
    # the sums over j must hold what they leave out below the same tolerance
    length = evaluate(clock, s)
    cut = limit
    if length > SHORT * theta:
        shove = 0.0
        for n in range(p - 1, -1, -1):
            shove = (shove + abs(push[n]) * INVERSE[n + 1]) * s
        last = 0.0
        for k in range(motion.omega.size):
            rate = max(motion.omega[k], motion.decay[k]) * theta
            moved = math.sqrt(v[k] ** 2 + (motion.omega[k] * u[k]) ** 2) + abs(motion.phi[k]) * shove
            last = max(last, rate**TIME_ORDER * moved)
        if last > 0.0:
            phase = SHORT * (0.1 * allowed / HERTZ_TOLERANCE / last) ** (1.0 / TIME_ORDER)
            cut = min(cut, theta * max(SHORT, phase))
    r_size, power = 0.0, 1.0
    for n in range(p + 1):
        r_size += abs(r[n]) * power
        power *= s
        negative[n] = -r[n]
    released = False
    end = first_polynomial_root(negative, 0.0, s, EPS * r_size)
    if end >= 0.0:
        s, released = end, True
        length = evaluate(clock, s)
    if length > cut:
        for n in range(p + 1):
            negative[n] = clock[n]
        negative[0] -= cut
        s, released, length = polynomial_root(negative, 0.0, s), False, cut
    return s, released, length


@kernel
def chain_state(motion, theta, impulse, u, v, scalars, products, s, work, u_out, v_out):
    """Deviations of all modes at sigma = `s`, and the work done on the stop so far [J].

    Parameters
    ----------
    u, v : ndarray, shape (n_modes,)
        Deviations at the start of the step.
    work : ndarray, shape (6, max(8, n_modes))
        Work space.
    u_out, v_out : ndarray, shape (n_modes,)
        Results; may be `u`, `v` themselves.
    """
    p, n_modes = CHAIN_ORDER, motion.omega.size
    clock, speed, push = scalars[CLOCK_SERIES], scalars[SPEED], products[PUSH]
    h = evaluate(clock, s)
    late, share = work[4], work[5]
    done = 0.0
    for i in range(8):
        x = NODES[i] * s
        t, q, d1 = clock[p], 0.0, speed[p]
        for n in range(p - 1, -1, -1):
            t = t * x + clock[n]
            q = q * x + push[n]
            d1 = d1 * x + speed[n]
        late[i] = (h - t) / theta
        share[i] = WEIGHTS[i] * s * q
        done += share[i] * d1
    flow, flow_rate, answer, answer_rate = work[0], work[1], work[2], work[3]
    for k in range(n_modes):
        flow[k], flow_rate[k], answer[k], answer_rate[k] = 0.0, 0.0, 0.0, 0.0
    phase, power = h / theta, 1.0
    for j in range(TIME_ORDER + 1):
        integral = 0.0
        for i in range(8):
            integral += share[i]
            share[i] *= late[i] * INVERSE[j + 1]
        now, after = impulse[j], impulse[j + 1]
        for k in range(n_modes):
            flow[k] += now[k] * power
            flow_rate[k] += after[k] * power
            answer[k] += now[k] * integral
            answer_rate[k] += after[k] * integral
        power *= phase * INVERSE[j + 1]
        if power < 1e-18:
            break
    for k in range(n_modes):
        uk, vk, c, o2 = u[k], v[k], motion.decay[k] * theta, (motion.omega[k] * theta) ** 2
        u_out[k] = uk * (flow_rate[k] + c * flow[k]) + theta * (vk * flow[k] - motion.phi[k] * answer[k])
        v_out[k] = (
            vk * flow_rate[k] - o2 / theta * flow[k] * uk - motion.phi[k] * answer_rate[k]
        )
        if motion.load[k] != 0.0:
            du, dv = loaded_drift(motion.decay[k], motion.load[k], h)
            u_out[k] += du
            v_out[k] += dv
    return done


@kernel
def depth_root(motion, base, u, v):
    """r = sqrt(d) of a contact that is under way at (u, v)."""
    return math.sqrt(max(0.0, tip_state(motion, base, u, v)[0]))
