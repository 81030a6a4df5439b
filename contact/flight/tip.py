"""The tip over the stop: displacement, velocity and acceleration as sums over the modes, and their bounds.

    y = static displacement - gap + steady motion + sum phi_k u_k,

positive behind the stop, with the deviations u_k of ``contact.flight.modal_flow``.  Free modes obey, for all
later times (``docs/theory/crossing.md``),

    |u^(n)|   <= sqrt( (u^(n))^2 + (u^(n+1)/omega)^2 ) now,
    |u^(n+1)| <= sqrt( (u^(n+1))^2 + omega^2 (u^(n))^2 ) now.
"""

import math

from contact.flight.elementary import EPS, sine_cosine
from contact.flight.modal_flow import mode_acceleration
from contact.flight.numbers import DECAY, LOAD, SQUARE, TIME_SCALE, WEIGHT
from contact.machine.compiled import inlined, kernel


@kernel
def tip_steady(numbers, t):
    """Tip displacement relative to the stop, velocity and acceleration of the steady motion at drive time
    `t`."""
    w = numbers.drive
    s, c = sine_cosine(w * t, 0.0)
    x = numbers.tip_sine * s + numbers.tip_cosine * c
    return numbers.level + x, w * (numbers.tip_sine * c - numbers.tip_cosine * s), -w * w * x


@kernel
def tip_state(numbers, t, u, v):
    """Tip displacement relative to the stop [m], its velocity and acceleration, at drive time `t`."""
    modes = numbers.modes
    y0, y1, y2 = tip_steady(numbers, t)
    for k in range(u.size):
        phi = modes[WEIGHT, k]
        y0 += phi * u[k]
        y1 += phi * v[k]
        y2 += phi * (modes[LOAD, k] - modes[DECAY, k] * v[k] - modes[SQUARE, k] * u[k])
    return y0, y1, y2


@inlined
def at_tip(numbers, k, value):
    """The tip part phi_k `value` of a displacement or velocity of mode `k`."""
    return numbers.modes[WEIGHT, k] * value


@inlined
def tip_sum(numbers, rest, values):
    """The tip sum of modal `values`, added to `rest`."""
    for k in range(values.size):
        rest += at_tip(numbers, k, values[k])
    return rest


@inlined
def tip_bound(numbers, k, value, quadrature):
    """Bound of the tip part of a `value` of mode `k` while the mode is free.

    `quadrature` is the value a quarter period off: v/omega for u, omega u for v (see the bounds above).
    """
    return abs(numbers.modes[WEIGHT, k]) * math.sqrt(value * value + quadrature * quadrature)


@inlined
def push_on(numbers, k, push):
    """The modal force or impulse -phi_k `push` of a force or impulse of the stop on the tip."""
    return -numbers.modes[WEIGHT, k] * push


@kernel
def hold(numbers, clock, u, v):
    """Put the tip on the wall at rest; otherwise rounding would let it drift off over many steps."""
    height, velocity, _acceleration = tip_state(numbers, clock, u, v)
    for k in range(u.size):
        u[k] += push_on(numbers, k, height) / numbers.inverse_mass
        v[k] += push_on(numbers, k, velocity) / numbers.inverse_mass


@kernel
def tip_rounding(numbers, u, v):
    """Bound of the rounding error of the tip displacement in a flight that starts at (u, v) [m]."""
    total = abs(numbers.level) + abs(numbers.tip_sine) + abs(numbers.tip_cosine) + numbers.gap
    phi, time_scale = numbers.modes[WEIGHT], numbers.modes[TIME_SCALE]
    for k in range(u.size):
        total += abs(phi[k]) * (abs(u[k]) + abs(v[k]) * time_scale[k])
    return 4.0 * EPS * total


@kernel
def jerk_bound(numbers, u, v):
    """Bound of the third derivative of the tip displacement in a flight from (u, v) [m/s^3]."""
    total, modes = numbers.amplitude * numbers.drive**3, numbers.modes
    for k in range(numbers.size):
        a = mode_acceleration(numbers, k, u[k], v[k])
        jerk = -modes[DECAY, k] * a - modes[SQUARE, k] * v[k]
        total += tip_bound(numbers, k, jerk, math.sqrt(modes[SQUARE, k]) * a)
    return total
