"""From touch to touch with derivatives: the flow that periodic orbits are made of.

The drive is carried along as two more coordinates, S = Z sin(w t) and C = Z cos(w t), so that the motion is
an autonomous flow of e = (u, v, S, C), 2 N + 2 numbers, in which amplitude and phase of the drive are
ordinary initial values.  The tip is at

    y(e) = phi . u + a S + b C + level,      a + i b the tip response per unit base amplitude.

Starting at a touch, y = 0, the flow runs through a given number of contacts and then freely to the end of m
drive periods, the wall ignored after the last of them: it is therefore smooth in e right through grazing,
where the strobe map has its square root.

Tangents d = de(t)/de(0), columns of a (2 N + 2) x (2 N + 2) matrix:

* free flight: the flows of the modes, and the rotation of (S, C);
* contact: the variational equation d'' = -c d' - omega^2 d - phi (N_d y(d) + N_d' y'(d)), as a series in time
  (linear law) or in the variable sigma of the reference motion (Hertz, Hunt-Crossley);
* a touch at which the force jumps by F (dashpot): d -> d - phi F (n.d)/v, n.d = y of the tangent, v the
  approach velocity; forces that start from zero need no jump (saltation matrix of Aizerman and Gantmacher;
  R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, ch. 7);
* Newton's law: d -> R d + (R f - f') (-n.d / v), R the reflection of the tip velocity, f and f' the velocity
  of the flow before and after;
* a touch that waits: ``contact.waiting``.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.crossing import CROSSES, first_crossing, first_polynomial_root
from contact.flight import (
    Motion,
    flow_matrix,
    mode_acceleration,
    propagate,
    tip_rounding,
    tip_state,
)
from contact.hertz_series import HERTZ_ORDER, evaluate, hertz_series, hertz_state, hertz_step
from contact.laws import DELAYED, HERTZ, LINEAR, NEWTON
from contact.newton import newton_impact
from contact.series import CONTACT, INSIDE, SERIES_ORDER, contact_series, series_state, series_step
from contact.waiting import waiting_touch

__all__ = ["FAILED", "FEWER_TOUCHES", "FLOWN", "flow_from_touch"]

FLOWN, FEWER_TOUCHES, FAILED = 0, 1, 2

MOST_STEPS = 1_500
"""Bound of contact steps in one flow: they cover 3000 radians of the fastest mode, a hundred times the
longest contact of the letter's beam."""


@kernel
def variation(motion, sine, cosine):
    """The linear part of the motion, for a tangent: no level, no load, tip harmonic `sine`, `cosine`."""
    return Motion(
        motion.omega, motion.decay, motion.damped, motion.damped_low, motion.phi, np.zeros(motion.omega.size),
        motion.sine, motion.cosine, motion.offset, sine, cosine, 0.0, motion.drive, motion.period, motion.gap,
        motion.compliance, motion.law, motion.number0, motion.number1, motion.table,
    )


@kernel
def turn_drive(tangent, n, angle):
    """Rotate the (S, C) rows of all tangents by the phase `angle`."""
    s, c = math.sin(angle), math.cos(angle)
    for j in range(2 * n + 2):
        a, b = tangent[2 * n, j], tangent[2 * n + 1, j]
        tangent[2 * n, j] = c * a + s * b
        tangent[2 * n + 1, j] = c * b - s * a


@kernel
def tangent_flight(motion, tangent, time):
    """Carry the tangents through a free flight of length `time` [s]."""
    n = motion.omega.size
    for k in range(n):
        a, b, c, d = flow_matrix(
            motion.omega[k], motion.decay[k], motion.damped[k], motion.damped_low[k], time
        )
        for j in range(2 * n + 2):
            x, y = tangent[k, j], tangent[n + k, j]
            tangent[k, j] = a * x + b * y
            tangent[n + k, j] = c * x + d * y
    turn_drive(tangent, n, motion.drive * time)


@kernel
def tangent_series(motion, response_sine, response_cosine, regime, tangent, time, series, depth, force):
    """Carry the tangents through a contact step of the linear law of length `time` [s]."""
    n = motion.omega.size
    u, v = np.empty(n), np.empty(n)
    for j in range(2 * n + 2):
        for k in range(n):
            u[k], v[k] = tangent[k, j], tangent[n + k, j]
        s, c = tangent[2 * n, j], tangent[2 * n + 1, j]
        linear = variation(
            motion, response_sine * c - response_cosine * s, response_sine * s + response_cosine * c
        )
        contact_series(linear, regime, 0.0, u, v, series, depth, force)
        series_state(series, time, u, v)
        for k in range(n):
            tangent[k, j], tangent[n + k, j] = u[k], v[k]
    turn_drive(tangent, n, motion.drive * time)


@kernel
def tangent_hertz(motion, response_sine, response_cosine, scalars, tangent, s, us, vs):
    """Carry the tangents through a step of length `s` in sigma under Hertz's law."""
    n = motion.omega.size
    w = motion.drive
    order = HERTZ_ORDER
    r, speed = scalars[0], scalars[4]
    # coefficients of the variational force: r dN = stiff y(d) + damp y'(d)
    stiff, damp = np.zeros(order + 1), np.zeros(order + 1)
    square, cube = np.zeros(order + 1), np.zeros(order + 1)
    for m in range(order + 1):
        for i in range(m + 1):
            square[m] += r[i] * r[m - i]
    for m in range(order + 1):
        stiff[m] = 1.5 * motion.number0 * square[m]
        if motion.number1 != 0.0:
            for i in range(m + 1):
                stiff[m] += 1.5 * motion.number0 * motion.number1 * square[i] * speed[m - i]
                cube[m] += square[i] * square[m - i]
            damp[m] = motion.number0 * motion.number1 * cube[m]
    sine, cosine = np.empty(order + 1), np.empty(order + 1)
    depth, rate = np.empty(order + 1), np.empty(order + 1)
    for j in range(2 * n + 2):
        for k in range(n):
            us[0, k], vs[0, k] = tangent[k, j], tangent[n + k, j]
        sine[0], cosine[0] = tangent[2 * n, j], tangent[2 * n + 1, j]
        for m in range(order):
            depth[m] = response_sine * sine[m] + response_cosine * cosine[m]
            rate[m] = w * (response_sine * cosine[m] - response_cosine * sine[m])
            for k in range(n):
                depth[m] += motion.phi[k] * us[m, k]
                rate[m] += motion.phi[k] * vs[m, k]
            push, rs, rc = 0.0, 0.0, 0.0
            for i in range(m + 1):
                push += stiff[i] * depth[m - i] + damp[i] * rate[m - i]
                rs += r[i] * sine[m - i]
                rc += r[i] * cosine[m - i]
            scale = 1.0 / (m + 1.0)
            for k in range(n):
                us[m + 1, k] = 0.0
                vs[m + 1, k] = 0.0
            for i in range(m + 1):
                ri = r[i] * scale
                for k in range(n):
                    us[m + 1, k] += ri * vs[m - i, k]
                    vs[m + 1, k] += ri * us[m - i, k]
            for k in range(n):
                vs[m + 1, k] = (
                    -motion.decay[k] * us[m + 1, k]
                    - motion.omega[k] ** 2 * vs[m + 1, k]
                    - motion.phi[k] * push * scale
                )
            sine[m + 1] = w * scale * rc
            cosine[m + 1] = -w * scale * rs
        for k in range(n):
            x, y = us[order, k], vs[order, k]
            for m in range(order - 1, -1, -1):
                x = x * s + us[m, k]
                y = y * s + vs[m, k]
            tangent[k, j], tangent[n + k, j] = x, y
    turn_drive(tangent, n, w * evaluate(scalars[1], s))


@kernel
def touch_jump(motion, response_sine, response_cosine, base, u, v, approach, tangent):
    """Apply impact or onset of force at a touch with velocity `approach` to the tangents (and, Newton, to
    v)."""
    n = motion.omega.size
    if motion.law != NEWTON and motion.number1 == 0.0:
        return
    before = np.empty(n)
    for k in range(n):
        before[k] = v[k]
    if motion.law == NEWTON:
        newton_impact(motion, v, approach, motion.number0)
    for j in range(2 * n + 2):
        reach = response_sine * tangent[2 * n, j] + response_cosine * tangent[2 * n + 1, j]
        rate = motion.drive * (response_sine * tangent[2 * n + 1, j] - response_cosine * tangent[2 * n, j])
        for k in range(n):
            reach += motion.phi[k] * tangent[k, j]
            rate += motion.phi[k] * tangent[n + k, j]
        if motion.law == LINEAR:
            for k in range(n):
                tangent[n + k, j] -= motion.phi[k] * motion.number1 * reach
            continue
        if motion.law != NEWTON:
            continue
        # Newton: reflect, then correct for the change of the time of impact, -reach/approach
        late = -reach / approach
        _y, _velocity, pull = tip_state(motion, base, u, before)
        flip = (1.0 + motion.number0) / motion.compliance
        for k in range(n):
            slow = mode_acceleration(motion, k, u[k], before[k]) - motion.phi[k] * flip * pull
            after = mode_acceleration(motion, k, u[k], v[k])
            tangent[k, j] += (before[k] - v[k]) * late
            tangent[n + k, j] += -motion.phi[k] * flip * rate + (slow - after) * late


@kernel
def flow_from_touch(motion, response_sine, response_cosine, base, u, v, duration, touches, tangent, record):
    """Flow for `duration` from a touch at time `base` after a strobe, through `touches` contacts.

    Parameters
    ----------
    motion : Motion
        Driven at the amplitude of this orbit.
    response_sine, response_cosine : float
        a and b, the tip response per unit base amplitude [1].
    base : float
        Drive time of the touch [s].
    u, v : ndarray, shape (n_modes,)
        Deviations at the touch; overwritten by those at the end.
    duration : float
        m/f [s].
    touches : int
        Contacts to go through; in the last flight the wall is ignored.
    tangent : ndarray, shape (2 n_modes + 2, 2 n_modes + 2), or (0, 0)
        The unit matrix on entry; overwritten by the derivatives of (u, v, S, C).
    record : ndarray, shape (touches, 4 + 2 n_modes)
        Results: start and end of each contact since the first touch [s], approach and rebound velocity [m/s],
        deviations (u, v) at its end.  The rebound velocity is zero only after an impact that gives none.

    Returns
    -------
    outcome : int
        FLOWN, FEWER_TOUCHES or FAILED.
    """
    n = motion.omega.size
    with_tangent = tangent.shape[0] > 0
    envelope = np.empty(n + 1)
    series = np.empty((SERIES_ORDER + 1, n))
    depth, force, negative = (
        np.empty(SERIES_ORDER + 1),
        np.empty(SERIES_ORDER + 1),
        np.empty(SERIES_ORDER + 1),
    )
    us, vs, scalars = (
        np.empty((HERTZ_ORDER + 1, n)),
        np.empty((HERTZ_ORDER + 1, n)),
        np.empty((7, HERTZ_ORDER + 1)),
    )
    clock = 0.0
    steps = 0
    for touch in range(touches):
        if touch > 0:
            order = 1 if record[touch - 1, 3] < 0.0 else 2
            outcome, s = first_crossing(motion, base + clock, u, v, duration - clock, order, envelope)
            if outcome != CROSSES:
                return FEWER_TOUCHES
            propagate(motion, u, v, s, u, v)
            if with_tangent:
                tangent_flight(motion, tangent, s)
            clock += s
        _height, approach, _a = tip_state(motion, base + clock, u, v)
        record[touch, 0], record[touch, 2] = clock, approach
        if approach <= 0.0:
            return FAILED
        rebound = -motion.number0 * approach
        if motion.law == DELAYED:
            wait, rebound = waiting_touch(
                motion, response_sine, response_cosine, base + clock, u, v, approach, tangent
            )
            clock += wait
        elif with_tangent:
            touch_jump(motion, response_sine, response_cosine, base + clock, u, v, approach, tangent)
        elif motion.law == NEWTON:
            newton_impact(motion, v, approach, motion.number0)
        regime = CONTACT
        root = 0.0
        while motion.law != NEWTON and motion.law != DELAYED:
            steps += 1
            if steps > MOST_STEPS or not clock <= duration:  # the latter holds for NaN as well
                return FAILED
            if motion.law == HERTZ:
                scalars[0, 0] = root
                hertz_series(motion, base + clock, u, v, us, vs, scalars)
                s, released, h = hertz_step(motion, u, v, us, vs, scalars, duration)
                hertz_state(us, vs, s, u, v)
                root = evaluate(scalars[0], s)
                if with_tangent:
                    tangent_hertz(motion, response_sine, response_cosine, scalars, tangent, s, us, vs)
                clock += h
                if released:
                    break
                continue
            contact_series(motion, regime, base + clock, u, v, series, depth, force)
            h = series_step(motion, u, v, series, depth)
            rounding = tip_rounding(motion, u, v)
            following = regime
            if regime == CONTACT:
                for i in range(SERIES_ORDER + 1):
                    negative[i] = -force[i]
                end = first_polynomial_root(negative, 0.0, h, rounding * motion.number0)
                if end >= 0.0:
                    h, following = end, (-1 if motion.number1 == 0.0 else INSIDE)
            else:
                closes = first_polynomial_root(force, 0.0, h, rounding * motion.number0)
                for i in range(SERIES_ORDER + 1):
                    negative[i] = -depth[i]
                leaves = first_polynomial_root(negative, 0.0, h, rounding)
                if leaves >= 0.0 and (closes < 0.0 or leaves <= closes):
                    h, following = leaves, -1
                elif closes >= 0.0:
                    h, following = closes, CONTACT
            series_state(series, h, u, v)
            if with_tangent:
                tangent_series(
                    motion, response_sine, response_cosine, regime, tangent, h, series, depth, force
                )
            clock += h
            if following < 0:
                break
            regime = following
        record[touch, 1] = clock
        if motion.law != NEWTON and motion.law != DELAYED:
            rebound = tip_state(motion, base + clock, u, v)[1]
        record[touch, 3] = rebound
        for k in range(n):
            record[touch, 4 + k] = u[k]
            record[touch, 4 + n + k] = v[k]
    if clock > duration:
        return FAILED
    propagate(motion, u, v, duration - clock, u, v)
    if with_tangent:
        tangent_flight(motion, tangent, duration - clock)
    return FLOWN
