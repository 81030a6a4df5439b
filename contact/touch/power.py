"""A power of the depth with a dashpot: N = d^x (k d^y + c d') for d > 0.

    HertzContact, HuntCrossley    x = 3/2, y = 0; the second number of the law is c/k
    PowerContact, c > 0           x = (p-1)/2, y = (p+1)/2; the force is cut at zero
    PowerContact, c = 0           x = p, y = 0

Let m be the least number for which m x and m y are whole.  With rho = d^(1/m), a variable sigma that runs
slowly while the contact is shallow, and l = m x + m - 1,

    dt/dsigma = rho^(m-1),  drho/dsigma = d'/m,  du/dsigma = rho^(m-1) v,
    dv/dsigma = rho^(m-1) (g - c_k v - omega^2 u) - phi_k P,    d' = sum phi_k v + x_s'(t),
    P = rho^(m-1) N = rho^l G,    G = k rho^(m y) + c d'.

The motion is analytic in sigma through touch and release: ``docs/theory/contact.md``.  The coefficients of
one order n follow from the orders before, by the sums

    sum_j rho_(n-j) rho^i_j            for all powers of rho that are needed,
    sum_j rho^(m-1)_(n-j) x_j          for x = d', sin(w t), cos(w t), all u and all v.

All these are columns of one array, computed eight at a time (``contact.machine.vector_loops``); for m = 2 one
call computes both sums.  The term with the newest x_n is added separately, so that no sum waits for it.

A step ends at the sigma at which the last terms, in every mode and in rho, reach `TOLERANCE` of the modal
speeds.  A step ends earlier at the release, where rho falls to zero.  A force that is cut lets go where G
falls to zero, before d does (regime INSIDE).  There the tip moves without a force, until G rises through zero
again, or the tip leaves.
"""

import math

import numpy as np

from contact.flight.elementary import EPS, sine_cosine
from contact.flight.modal_flow import BRIEF, speed_scale
from contact.flight.numbers import SQUARE
from contact.flight.polynomial_root import first_fall, first_polynomial_root, horner, polynomial_root
from contact.flight.tip import tip_rounding, tip_state, tip_sum
from contact.machine.compiled import kernel, part
from contact.machine.vector_loops import LANES, next_modes, weighted_rows
from contact.state import CONTACT, INSIDE, OUTSIDE
from contact.touch.exchange import exchange_of
from contact.touch.series import WINDOW, add_modes, limited_by_force, log_longest, powers_of, product

LAW, METHOD = "HertzContact, HuntCrossley or PowerContact", "contact-series"
REGIMES = (OUTSIDE, CONTACT, INSIDE)

ORDER = 20  # order of the series in sigma, even: the cost per unit of time is flat from 16 to 24
TOLERANCE = 1e-15  # last terms of a step over the modal speeds, at the rounding of the sum of all terms
EDGE = TOLERANCE ** (1.0 / ORDER)  # step over the radius of convergence
FAR = math.log(1.5)
"""Logarithm of a factor.  Terms of rho before the last limit a step only if their bound is shorter than the
others by this factor.  Where the modes take part, the last terms agree within it."""

SPEED, SINE, COSINE = range(3)
"""Columns of the series in front of the modes: d', sine and cosine of the drive; powers of rho follow."""

ROOT, CLOCK, PUSH, POWERS, LETS_GO, TIME, LEVER, STEEP = range(8)
"""Rows of the scalar series: rho, time since the start of the step, P, powers of sigma, G, rho^(m-1), rho^l
and rho^(m x - 1)."""

RELAXED = 3.0
"""Longest step times the rate phi^2 dN/dd' at which the dissipation damps a disturbance.  A series of order
20 keeps ten digits of exp(-3).  Beyond 8 the tangents grow, although the motion does not show it."""

INVERSE = 1.0 / np.maximum(1.0, np.arange(64.0))  # 1/n


@part
def law_of(numbers):
    """m, m x, m y and c."""
    m, outer, inner = int(numbers.table[0, 0]), int(numbers.table[0, 1]), int(numbers.table[0, 2])
    return m, outer, inner, numbers.number1 * (numbers.number0 if inner == 0 else 1.0)


@kernel
def force(numbers, depth, rate):
    """N at penetration `depth` >= 0 and its `rate` [N]."""
    m, outer, inner, c = law_of(numbers)
    push = depth ** (outer / m) * (numbers.number0 * depth ** (inner / m) + c * rate)
    return max(0.0, push) if inner > 0 else push


@kernel
def stiffness(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m]."""
    m, outer, inner, c = law_of(numbers)
    spring, steep = numbers.number0 * depth ** (inner / m), depth ** (outer / m - 1.0)
    if inner > 0 and spring + c * rate <= 0.0:
        return 0.0, 0.0
    return steep * (outer * (spring + c * rate) + inner * spring) / m, c * steep * depth


@kernel
def series_size(numbers):
    """Order and columns of the series: drive and powers of rho, filled up to eight, then u, then v."""
    m, outer, inner, _c = law_of(numbers)
    front = COSINE + 1 + max(outer + m - 1, outer + inner - 1, inner)
    return ORDER, (front + LANES - 1) // LANES * LANES + 2 * numbers.modes.shape[1]


@part
def power(rows, n, i):
    """Order n of rho^i."""
    return rows[n, COSINE + i] if i > 0 else (1.0 if n == 0 else 0.0)


@part
def fill(numbers, base, u, v, pushes, series):
    """The Taylor coefficients in sigma from (u, v) at drive time `base` [s], with or without the force.

    On entry scalars[ROOT, 0] holds rho.  Computed anew from the tip displacement, rho would lose its digits
    at shallow depth.
    """
    rows, sums, modes, w, scalars = series.rows, series.sums, numbers.modes, numbers.drive, series.scalars
    a, b, k, (m, outer, inner, c) = numbers.tip_sine, numbers.tip_cosine, numbers.number0, law_of(numbers)
    root, clock, push, lets_go = scalars[ROOT], scalars[CLOCK], scalars[PUSH], scalars[LETS_GO]
    time, lever, rho = scalars[TIME], scalars[LEVER], root[0]
    lift, at_v, share, unit = outer + m - 1, rows.shape[1] - modes.shape[1], 1.0 / m, 1.0 if c != 0.0 else k
    at_u, top = at_v - modes.shape[1], max(lift, outer + inner - 1, inner)
    front = sums if m == 2 else sums[:at_u]
    sine, cosine = sine_cosine(w * base, 0.0)
    speed = tip_sum(numbers, w * (a * cosine - b * sine), v)
    for i in range(u.size):
        rows[0, at_u + i] = u[i]
        rows[0, at_v + i] = v[i]
    rows[0, SPEED], rows[0, SINE], rows[0, COSINE] = speed, sine, cosine
    clock[0], push[ORDER] = 0.0, 0.0
    for n in range(ORDER):
        inverse, value = INVERSE[n + 1], root[n]
        weighted_rows(root, n, -1, rows, n, front)
        root[n + 1], turn = share * inverse * speed, w * inverse
        rows[n, COSINE + 1] = value
        for i in range(COSINE + 1, COSINE + top):
            value = front[i] + rho * value
            rows[n, i + 1] = value
        lever[n], force = power(rows, n, lift), value  # without damping l is the highest power
        if c != 0.0:
            lets_go[n] = k * power(rows, n, inner) + c * speed
            force = product(lever, lets_go, n) if pushes else 0.0
        push[n], time[n] = unit * force, power(rows, n, m - 1)
        if m != 2:
            weighted_rows(time, n, -1, rows, n, sums)
        clock[n + 1], start = inverse * time[n], time[0]
        tip = next_modes(modes, sums, start, inverse, time[n], unit * inverse * force, n, rows)
        sine, cosine = turn * (sums[COSINE] + start * cosine), -turn * (sums[SINE] + start * sine)
        speed = w * (a * cosine - b * sine) + tip
        rows[n + 1, SPEED], rows[n + 1, SINE], rows[n + 1, COSINE] = speed, sine, cosine


@kernel
def slopes(numbers, run, series, weights):
    """The series for the tangents: rho^(m-1) times 1, dN/dd, dN/dd', N and its slopes by the two numbers."""
    (m, outer, inner, c), k, pushes = law_of(numbers), numbers.number0, 0.0 if run.regime == INSIDE else 1.0
    rows, rates, rises = series.rows, series.rows[:, SPEED], series.rows[:, COSINE + inner]
    lever, steep, push = series.scalars[LEVER], series.scalars[STEEP], series.scalars[PUSH]
    for n in range(ORDER):
        steep[n] = power(rows, n, outer - 1)
        drag = outer * c * product(steep, rates, n) if c != 0.0 else 0.0
        weights.time[n], weights.force[n] = series.scalars[TIME, n], push[n]
        weights.depth[n] = pushes * ((outer + inner) * k * power(rows, n, outer + inner - 1) + drag) / m
        weights.rate[n] = pushes * c * lever[n]
        weights.second[n] = pushes * product(lever, rates, n)
        weights.first[n] = pushes * product(lever, rises, n) if inner > 0 else push[n] / k
        if inner == 0:  # the second number is c/k
            weights.second[n] *= k
    return ORDER


@kernel
def exchange(numbers, run, span, series, known):
    """What the tip gives to the stop: work, impulse and largest force; see ``contact.touch``."""
    rate, time = series.rows[:, SPEED], series.scalars[TIME]
    return exchange_of(series, series.scalars[PUSH], rate, time, span, known)


@part
def greatest_speed(modes, rows, order):
    """The largest coefficient of this order among all v and omega u."""
    m, top = modes.shape[1], 0.0
    at_v = rows.shape[1] - m
    for k in range(m):
        u, v = rows[order, at_v - m + k], rows[order, at_v + k]
        top = max(top, v * v, modes[SQUARE, k] * u * u)
    return math.sqrt(top)


@part
def farthest(numbers, speed, root):
    """The sigma up to which a step sees a force that enters the speeds beyond `WINDOW` orders.

    All terms of such a step could be small although the force is not.  It reaches at most thrice the rho of
    its start, or the depth up to which the impulse of this force is below rounding.
    """
    m, outer, inner, c = law_of(numbers)
    entry = outer + inner + m  # m (p + 1)
    allowed = 0.5 * entry / m * TOLERANCE * speed / math.sqrt(numbers.inverse_mass)
    # the impulse k d^(p+1)/((p+1) d'), d' = m root[1], and that of the dashpot, 2 c d^((p+1)/2)/(p+1)
    negligible = (2.0 * allowed * m * abs(root[1]) / numbers.number0) ** (1.0 / entry)
    if inner > WINDOW:
        negligible = min(negligible, (allowed / c) ** (1.0 / inner))
    way = max(2.0 * root[0], negligible - root[0])
    s = way / abs(root[1]) if root[1] != 0.0 else math.inf
    return min(s, math.sqrt(way / abs(root[2]))) if root[2] != 0.0 and way > 0.0 else s


@part
def longest_step(numbers, speed, series):
    """The sigma up to which the series holds: the last orders of modes, rho and force are small.

    The modes move at each order m of sigma, and so does rho: one of the last m orders shows it.
    """
    (m, outer, inner, c), root, longest = law_of(numbers), series.scalars[ROOT], math.inf
    for n in range(ORDER, ORDER - max(2, m), -1):
        top = greatest_speed(numbers.modes, series.rows, n)
        longest = min(longest, log_longest(top, n, speed))
        # rho must be resolved as well as the modes, relative to the larger of its first two terms: under a
        # contact so soft that the modes give no bound, it gives one
        if root[n] != 0.0 and (root[0] != 0.0 or root[1] != 0.0):
            whole = log_longest(abs(root[n]), n, abs(root[0])) if root[0] != 0.0 else -math.inf
            linear = log_longest(abs(root[n]), n - 1, abs(root[1])) if root[1] != 0.0 else -math.inf
            if n == ORDER or max(whole, linear) < longest - FAR:
                longest = min(longest, max(whole, linear))
    push, mobility = series.scalars[PUSH], math.sqrt(numbers.inverse_mass)
    s = limited_by_force(EDGE * math.exp(longest), push, ORDER - 1, mobility, speed, EDGE)
    if outer + inner + m > WINDOW:
        s = min(s, farthest(numbers, speed, root))
    if root[1] < 0.0 < root[0]:  # stop well behind the release: without a force the terms give no bound
        s = min(s, -4.0 * root[0] / root[1])
    if c == 0.0:
        return s
    # the dissipation is largest at the deeper end of the step
    deep = max(root[0], horner(root, 1.0, 0.0, s)[0]) if s < math.inf else root[0]
    return min(s, RELAXED / (numbers.inverse_mass * c * deep ** (outer + m - 1.0)))


@kernel
def series_variable(numbers, t, end, series):
    """The sigma at which a time `t` [s] has passed, in a step up to `end`."""
    return polynomial_root(series.scalars[CLOCK], 1.0, t, 0.0, end) if t > 0.0 else 0.0


@part
def first_depth(numbers, run, u, v):
    """The depth of a contact that begins: its rounding at least, as no sigma leads from rest at zero."""
    moment = EPS * BRIEF * numbers.period * run.memory1 * math.sqrt(numbers.inverse_mass)  # where u = 0
    return max(tip_rounding(numbers, u, v), tip_state(numbers, run.clock, u, v)[0], moment)


@kernel
def step(numbers, run, u, v, limit, series):
    """One step from (u, v), at most `limit` [s]; see ``contact.touch``."""
    root, clock, (m, _outer, inner, c) = series.scalars[ROOT], series.scalars[CLOCK], law_of(numbers)
    if run.memory1 < 0.0:
        run.memory1 = speed_scale(numbers, u, v)
    if run.memory0 < 0.0:
        run.memory0 = first_depth(numbers, run, u, v) ** (1.0 / m)
    root[0], regime = run.memory0, run.regime
    fill(numbers, run.clock, u, v, regime == CONTACT, series)
    if run.memory1 == 0.0:  # nothing moves
        return 0.0, limit, regime
    s = longest_step(numbers, run.memory1, series)
    if not (0.0 < s < math.inf):
        return math.nan, math.nan, CONTACT
    end, following = first_fall(root, s), regime
    if end >= 0.0:
        s, following = end, OUTSIDE
    if inner > 0:
        margin = 4.0 * EPS * c * math.sqrt(numbers.inverse_mass) * run.memory1
        end = first_polynomial_root(series.scalars[LETS_GO], -1.0 if regime == CONTACT else 1.0, s, margin)
        if 0.0 <= end < s:
            s, following = end, INSIDE if regime == CONTACT else CONTACT
    length = horner(clock, 1.0, 0.0, s)[0]
    if length > limit:
        s, length, following = series_variable(numbers, limit, s, series), limit, regime
    run.memory0 = horner(root, 1.0, 0.0, s)[0]
    return s, length, following


@kernel
def height_over(numbers, run, weight, own, series, out):
    """The series of the height over another stop, in `out`; see ``contact.touch``."""
    rows = series.rows
    for n in range(ORDER + 1):
        out[n] = own[1] * rows[n, SINE] + own[2] * rows[n, COSINE]
    return add_modes(rows, rows.shape[1] - 2 * weight.size, weight, own[0], out)


@kernel
def state(numbers, run, s, series, u, v):
    """Deviations of all modes at sigma = `s`, in `u` and `v`."""
    powers = series.scalars[POWERS]
    powers_of(s, powers)
    weighted_rows(powers, 0, 1, series.rows, ORDER + 1, series.sums)
    at_v = series.sums.size - numbers.modes.shape[1]
    for k in range(u.size):
        u[k] = series.sums[at_v - numbers.modes.shape[1] + k]
        v[k] = series.sums[at_v + k]
