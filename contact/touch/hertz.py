"""A ball on a plate: N = k d^(3/2) (1 + chi d') for d > 0 (``HertzContact``; ``HuntCrossley`` for chi > 0).

The force has no Taylor series at d = 0, where every contact begins and ends.  Take r = sqrt(d) as an unknown
of its own, and a variable sigma that runs slowly while the contact is shallow:

    dt/dsigma = r,  dr/dsigma = d'/2,  du/dsigma = r v,  dv/dsigma = r (g - c v - omega^2 u) - phi_k r N,
    dd/dsigma = r d',  r N = k (r^4 + chi r^4 d'),  d' = sum phi_k v + x_s'(t),

All right-hand sides are polynomials, so that the motion is analytic through touch and release, where r
changes sign (the substitution is Sundman's, Acta Math. 36 (1913) 105).  Each contains the factor r.  The
coefficients of one order therefore follow from one set of sums over the orders before,

    sum_j r_(n-j) x_j    for x = d', d, r d, sin(w t), cos(w t), all u and all v,

which fill the columns of one array and are computed eight at a time (``contact.machine.vector_loops``).  The
term with the newest x_n is added separately, so that no sum waits for it.  The cost of a step is the number
of modes times the square of the order.

A step ends at the sigma at which the last terms, in every mode and in r, reach `TOLERANCE` of the modal
speeds.  The energy of a lossless contact is conserved to that order.  A step ends earlier at the release,
where r falls to zero.
"""

import math

import numpy as np

from contact.flight.elementary import EPS, sine_cosine
from contact.flight.modal_flow import BRIEF, speed_scale, tip_rounding, tip_state, tip_sum
from contact.flight.motion import SQUARE
from contact.flight.polynomial_root import first_polynomial_root, horner, polynomial_root
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import LANES, next_modes, weighted_rows
from contact.touch.exchange import exchange_of
from contact.touch.series import limited_by_force, log_longest, powers_of
from contact.trajectory import CONTACT, OUTSIDE

LAW, METHOD = "HertzContact or HuntCrossley", "contact-series"
REGIMES = (OUTSIDE, CONTACT)

ORDER = 20  # order of the series in sigma, even: the cost per unit of time is flat from 16 to 24
TOLERANCE = 1e-15  # last terms of a step over the modal speeds, at the rounding of the sum of all terms
FAR = math.log(1.5)
"""Logarithm of a factor.  The last term but one of r limits a step only if its bound is shorter than the
others by this factor: where the modes take part, the last two terms agree within it."""

SPEED, DEPTH, CUBE, SINE, COSINE = range(5)
"""Columns of the series in front of the modes: d', d, r d, sine and cosine of the drive."""

ROOT, CLOCK, PUSH, POWERS, QUARTIC = range(5)
"""Rows of the scalar series: r, time since the start of the step, r N, powers of sigma, k r^4."""

RELAXED = 3.0
"""Longest step times the rate phi^2 dN/dd' at which the dissipation damps a disturbance.  A series of order
20 keeps ten digits of exp(-3).  Beyond 8 the tangents grow, although the motion does not show it."""

_EDGE = TOLERANCE ** (1.0 / ORDER)

INVERSE = 1.0 / np.maximum(1.0, np.arange(64.0))  # 1/n


@kernel
def force(numbers, depth, rate):
    """N at penetration `depth` >= 0 and its `rate` [N]."""
    return numbers.number0 * depth * math.sqrt(depth) * (1.0 + numbers.number1 * rate)


@kernel
def stiffness(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m]."""
    root = math.sqrt(depth)
    return (
        1.5 * numbers.number0 * root * (1.0 + numbers.number1 * rate),
        numbers.number0 * depth * root * numbers.number1,
    )


@part
def series_size(motion):
    """Order and columns of the series: five scalars, then u from column 8 on, then v."""
    return ORDER, LANES + 2 * motion.modes.shape[1]


@part
def fill(motion, base, u, v, series):
    """The Taylor coefficients in sigma of a contact that is at (u, v) at drive time `base` [s].

    On entry scalars[ROOT, 0] holds r.  Computed anew from the tip displacement, r would lose its digits at
    shallow depth.
    """
    rows, sums, modes, w = series.rows, series.sums, motion.modes, motion.drive
    a, b, stiffness, chi = motion.tip_sine, motion.tip_cosine, motion.number0, motion.number1
    r, clock, push = series.scalars[ROOT], series.scalars[CLOCK], series.scalars[PUSH]
    at_v = LANES + modes.shape[1]
    sine, cosine = sine_cosine(w * base, 0.0)
    speed = tip_sum(motion, w * (a * cosine - b * sine), v)
    for k in range(u.size):
        rows[0, LANES + k] = u[k]
        rows[0, at_v + k] = v[k]
    r0 = r[0]
    rows[0, SPEED], rows[0, DEPTH], rows[0, SINE], rows[0, COSINE] = speed, r0 * r0, sine, cosine
    clock[0] = 0.0
    for n in range(ORDER):
        rn, inverse = r[n], INVERSE[n + 1]
        weighted_rows(r, n, -1, rows, n, sums)
        r[n + 1] = 0.5 * inverse * speed
        clock[n + 1] = inverse * rn
        depth = inverse * (sums[SPEED] + r0 * speed)
        cube = sums[DEPTH] + r0 * rows[n, DEPTH]
        rows[n, CUBE] = cube
        push[n] = sums[CUBE] + r0 * cube  # r^4 for now
        total = push[n]
        if chi != 0.0:
            for i in range(n + 1):
                total += chi * push[i] * rows[n - i, SPEED]
        tip = next_modes(modes, sums, r0, inverse, rn, stiffness * inverse * total, n, rows)
        sine, cosine = (w * inverse * (sums[COSINE] + r0 * cosine), -w * inverse * (sums[SINE] + r0 * sine))
        speed = w * (a * cosine - b * sine) + tip
        rows[n + 1, SPEED], rows[n + 1, DEPTH] = speed, depth
        rows[n + 1, SINE], rows[n + 1, COSINE] = sine, cosine
    push[ORDER] = 0.0
    if chi != 0.0:
        for n in range(ORDER - 1, -1, -1):  # r N from r^4
            total = push[n]
            for i in range(n + 1):
                total += chi * push[i] * rows[n - i, SPEED]
            push[n] = total
    for n in range(ORDER):
        push[n] *= stiffness


@kernel
def slopes(motion, run, series, weights):
    """The series for the tangents: r, r dN/dd = (3/2) k d (1 + chi d'), r dN/dd' = k chi d^2, r N, r N/k and
    r dN/dchi = k d^2 d'."""
    rows, k, chi, quartic = series.rows, motion.number0, motion.number1, series.scalars[QUARTIC]
    for n in range(ORDER + 1):
        weights.time[n], weights.force[n] = series.scalars[ROOT, n], series.scalars[PUSH, n]
        weights.depth[n], weights.rate[n] = 1.5 * k * rows[n, DEPTH], 0.0
        weights.first[n], weights.second[n], quartic[n] = weights.force[n] / k, 0.0, 0.0
        if chi != 0.0:
            for i in range(n + 1):
                weights.depth[n] += 1.5 * k * chi * rows[i, DEPTH] * rows[n - i, SPEED]
                weights.rate[n] += k * chi * rows[i, DEPTH] * rows[n - i, DEPTH]
        for i in range(n + 1):
            quartic[n] += k * rows[i, DEPTH] * rows[n - i, DEPTH]
        for i in range(n + 1):
            weights.second[n] += quartic[i] * rows[n - i, SPEED]
    return ORDER + 1


@part
def greatest_speed(modes, rows, order):
    """The largest coefficient of this order among all v and omega u."""
    m, top = modes.shape[1], 0.0
    for k in range(m):
        u, v = rows[order, LANES + k], rows[order, LANES + m + k]
        top = max(top, v * v, modes[SQUARE, k] * u * u)
    return math.sqrt(top)


@part
def longest_step(motion, speed, series):
    """The sigma up to which the series holds."""
    p, r = ORDER, series.scalars[ROOT]
    allowed = TOLERANCE * speed
    power = min(
        log_longest(greatest_speed(motion.modes, series.rows, p), p, allowed),
        log_longest(greatest_speed(motion.modes, series.rows, p - 1), p - 1, allowed),
    )
    # r must be resolved as well as the modes, relative to the larger of its first two terms.  Under a contact
    # so soft that the modes give no bound, r is odd in sigma, and its last term alone gives no bound either.
    for n in (p, p - 1):
        if r[n] != 0.0 and (r[0] != 0.0 or r[1] != 0.0):
            whole = log_longest(abs(r[n]), n, TOLERANCE * abs(r[0])) if r[0] != 0.0 else -math.inf
            linear = log_longest(abs(r[n]), n - 1, TOLERANCE * abs(r[1])) if r[1] != 0.0 else -math.inf
            if n == p or max(whole, linear) < power - FAR:
                power = min(power, max(whole, linear))
    s = limited_by_force(
        math.exp(power), series.scalars[PUSH], p - 1, math.sqrt(motion.inverse_mass), speed, _EDGE
    )
    if r[1] < 0.0 < r[0]:
        # stop well behind the release: without a force the terms give no bound
        s = min(s, -4.0 * r[0] / r[1])
    # the dissipation is largest at the deeper end of the step
    deep = max(r[0], horner(r, 1.0, 0.0, s)[0]) if s < math.inf else r[0]
    return min(s, RELAXED / (motion.inverse_mass * motion.number0 * motion.number1 * deep**4))


@part
def release_in(r, s):
    """The sigma in (0, s] at which r falls to zero, or -1."""
    rest, power = 0.0, s
    for n in range(2, ORDER + 1):
        power *= s
        rest += abs(r[n]) * power
    start, drift = abs(r[0]), r[1] * s
    size = start + abs(drift) + rest
    margin = 2.0 * EPS * size
    # r >= r_0 + (r_1 - rest/s) sigma if this bound grows, and always r >= r_0 - |drift| - rest
    if drift - rest > margin or start - abs(drift) - rest > margin:
        return -1.0
    return first_polynomial_root(r, -1.0, s, EPS * size)


@kernel
def series_variable(motion, t, end, series):
    """The sigma at which a time `t` [s] has passed, in a step up to `end`."""
    return polynomial_root(series.scalars[CLOCK], 1.0, t, 0.0, end) if t > 0.0 else 0.0


@part
def first_depth(motion, run, u, v):
    """The depth of a contact that begins: its rounding at least, as no sigma leads from rest at zero."""
    moment = EPS * BRIEF * motion.period * run.memory1 * math.sqrt(motion.inverse_mass)  # where u = 0
    return max(tip_rounding(motion, u, v), tip_state(motion, run.clock, u, v)[0], moment)


@kernel
def step(motion, run, u, v, limit, series):
    """One step from (u, v), at most `limit` [s]; see ``contact.touch``."""
    r, clock = series.scalars[ROOT], series.scalars[CLOCK]
    if run.memory1 < 0.0:
        run.memory1 = speed_scale(motion, u, v)
    if run.memory0 < 0.0:
        run.memory0 = math.sqrt(first_depth(motion, run, u, v))
    r[0] = run.memory0
    fill(motion, run.clock, u, v, series)
    if run.memory1 == 0.0:  # nothing moves
        return 0.0, limit, CONTACT
    s = longest_step(motion, run.memory1, series)
    if not (0.0 < s < math.inf):
        return math.nan, math.nan, CONTACT
    end, following = release_in(r, s), CONTACT
    if end >= 0.0:
        s, following = end, OUTSIDE
    length = horner(clock, 1.0, 0.0, s)[0]
    if length > limit:
        s, length, following = series_variable(motion, limit, s, series), limit, CONTACT
    run.memory0 = horner(r, 1.0, 0.0, s)[0]
    return s, length, following


@kernel
def state(motion, run, s, series, u, v):
    """Deviations of all modes at sigma = `s`, in `u` and `v`."""
    powers = series.scalars[POWERS]
    powers_of(s, powers)
    weighted_rows(powers, 0, 1, series.rows, ORDER + 1, series.sums)
    at_v = LANES + motion.modes.shape[1]
    for k in range(u.size):
        u[k] = series.sums[LANES + k]
        v[k] = series.sums[at_v + k]


@kernel
def exchange(motion, run, span, series, known):
    """What the tip gives to the stop: work, impulse and largest force; see ``contact.touch``."""
    rate, root = series.rows[:, SPEED], series.scalars[ROOT]
    return exchange_of(series, series.scalars[PUSH], rate, root, span, known)
