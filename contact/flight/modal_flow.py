"""The motion of the modes between contacts, in closed form.

Each mode obeys q'' + c q' + omega^2 q = g + Gamma Z w^2 sin(w t), w = 2 pi f [SI, u in m kg^0.5].  With the
steady motion q = q_s(t) + u,

    q_s(t) = g/omega^2 + S sin(w t) + C cos(w t),   S + iC = Gamma Z w^2 / (omega^2 - w^2 + i c w),
    u(t) = e^{-ct/2} [ Cn(t) u_0 + Sn(t) (v_0 + c u_0/2) ],
    v(t) = e^{-ct/2} [ Cn(t) v_0 - Sn(t) (omega^2 u_0 + c v_0/2) ],

the g-term only for omega > 0.  With D = omega^2 - (c/2)^2, (Cn, Sn) is (cos, sin/d) of d t, d = sqrt(D), for
an under-damped mode, (1, t) for a critical one and (cosh, sinh/k) of k t, k = sqrt(-D), for an over-damped
one.  A mode of zero frequency under a constant load g adds g t^2 phi_2(-c t) to u, phi_2(x) = (e^x - 1 -
x)/x^2.  The phase d t is a sum of two doubles.  Derivation: ``docs/theory/flight.md``.
"""

import math

import numpy as np

from contact.flight.elementary import FARTHEST, exponential, fast_sine_cosine, sine_cosine, two_product
from contact.flight.numbers import DAMPED, DAMPED_LOW, DECAY, LOAD, OMEGA, SQUARE, Numbers
from contact.machine.compiled import aligned, inlined, kernel

START_U, START_V, U, V, HEIGHT, RATE, ACCELERATION, JERK_BOUND, ABOVE = range(9)
"""Rows of the workspace of a flight: deviation and velocity at its start, and now; their parts of the tip
displacement, of two derivatives and of the bound of the third; the sum of the amplitudes of all higher modes.
"""

FAINT, LOOK = 1e-150, 256
"""A deviation below the first is set to zero, every so many drive periods: its square is a denormal number,
with which arithmetic is slow, and rounding would keep a lightly damped mode at the smallest one for ever."""

BRIEF = 1e-12  # part of a drive period in which a load gives modes at rest a speed to compare with


@kernel
def new_flight(numbers):
    """Workspace of flights, shape (9, m)."""
    return aligned(9, numbers.modes.shape[1])


@kernel
def load_state(flight, u, v):
    """Set (u, v), shape (n_modes,) each, as the start of a flight."""
    for k in range(u.size):
        flight[START_U, k] = u[k]
        flight[START_V, k] = v[k]


@kernel
def flow_matrix(omega, decay, damped, damped_low, t):
    """The 2 x 2 flow (u, v) -> (u, v) of a free mode over a time `t` [s], as four numbers."""
    half = 0.5 * decay
    if damped > 0.0 and omega > half:
        p, e = two_product(damped, t)
        s, c = sine_cosine(p, e + damped_low * t)
        fade = exponential(-half * t)
        cn = fade * c
        sn = fade * s / damped
    elif damped > 0.0:
        slow = omega * omega / (half + damped)
        fade = math.exp(-slow * t)
        lost = -math.expm1(-2.0 * damped * t)
        cn = fade * (1.0 - 0.5 * lost)
        sn = fade * lost / (2.0 * damped)
    else:
        cn = math.exp(-half * t)
        sn = cn * t
    return cn + half * sn, sn, -omega * omega * sn, cn - half * sn


@kernel
def loaded_drift(decay, load, t):
    """Displacement and velocity that a constant `load` adds to a mode of zero frequency in a time `t`."""
    x = -decay * t
    if x > -1.0:
        phi2 = 0.0
        for n in range(20, 1, -1):
            phi2 = (1.0 + x * phi2) / n
        phi1 = 1.0 + x * phi2
    else:
        phi1 = math.expm1(x) / x
        phi2 = (phi1 - 1.0) / x
    return load * t * t * phi2, load * t * phi1


@kernel
def mode_flow(modes, k, u, v, t):
    """Deviation (u, v) of mode `k` of a table after a time `t` [s]."""
    a, b, c, d = flow_matrix(modes[OMEGA, k], modes[DECAY, k], modes[DAMPED, k], modes[DAMPED_LOW, k], t)
    un, vn = a * u + b * v, c * u + d * v
    if modes[LOAD, k] != 0.0:
        du, dv = loaded_drift(modes[DECAY, k], modes[LOAD, k], t)
        un += du
        vn += dv
    return un, vn


@kernel
def ringing_flow(modes, flight, start, stop, t):
    """`flow` for under-damped modes without load: a loop of vector instructions.

    The unsigned index gives it vector loads as well.
    """
    decay, damped, low, square = modes[DECAY], modes[DAMPED], modes[DAMPED_LOW], modes[SQUARE]
    u, v, u_out, v_out = flight[START_U], flight[START_V], flight[U], flight[V]
    for k in range(np.uintp(start), np.uintp(stop)):
        p, e = two_product(damped[k], t)
        s, c = fast_sine_cosine(p, e + low[k] * t)
        half = 0.5 * decay[k]
        fade = exponential(-half * t)
        cn, sn = fade * c, fade * s / damped[k]
        un, vn = u[k], v[k]
        u_out[k] = cn * un + sn * (vn + half * un)
        v_out[k] = cn * vn - sn * (square[k] * un + half * vn)


@inlined
def flow(numbers, flight, start, stop, t):
    """Deviations of modes `start` to `stop` a time `t` [s] into the flight, in its rows U and V."""
    if numbers.all_underdamped and numbers.phase_rate * abs(t) < FARTHEST:
        ringing_flow(numbers.modes, flight, start, stop, t)
    else:
        for k in range(start, stop):
            u, v = flight[START_U, k], flight[START_V, k]
            flight[U, k], flight[V, k] = mode_flow(numbers.modes, k, u, v, t)


@kernel
def flow_over(numbers, time):
    """The flow of all modes over a `time` [s], shape (n_modes, 6): matrix by rows, drift under the load."""
    modes, flows = numbers.modes, np.zeros((numbers.size, 6))
    for k in range(numbers.size):
        flows[k, 0], flows[k, 1], flows[k, 2], flows[k, 3] = flow_matrix(
            modes[OMEGA, k], modes[DECAY, k], modes[DAMPED, k], modes[DAMPED_LOW, k], time
        )
        if modes[LOAD, k] != 0.0:
            flows[k, 4], flows[k, 5] = loaded_drift(modes[DECAY, k], modes[LOAD, k], time)
    return flows


@kernel
def apply_flow(flows, u, v):
    """Advance all deviations by `flows`, in place."""
    for k in range(u.size):
        uk = u[k]
        u[k] = flows[k, 0] * uk + flows[k, 1] * v[k] + flows[k, 4]
        v[k] = flows[k, 2] * uk + flows[k, 3] * v[k] + flows[k, 5]


@kernel
def clear_faint(u, v):
    """Set deviations that have faded to zero (`FAINT`)."""
    for k in range(u.size):
        if abs(u[k]) + abs(v[k]) < FAINT:
            u[k], v[k] = 0.0, 0.0


@kernel
def propagate_flight(numbers, flight, t, u, v):
    """Deviations (u, v) of all modes a time `t` [s] into the flight."""
    flow(numbers, flight, 0, flight.shape[1], t)
    for k in range(u.size):
        u[k] = flight[U, k]
        v[k] = flight[V, k]


@kernel
def propagate(numbers, u, v, t, u_out, v_out):
    """Deviations of all modes after a time `t` [s]; `u_out`, `v_out` may be `u`, `v` themselves."""
    flight = new_flight(numbers)
    load_state(flight, u, v)
    propagate_flight(numbers, flight, t, u_out, v_out)


@kernel
def mode_acceleration(numbers, k, u, v):
    """Second derivative of the deviation of mode `k` when no contact acts."""
    modes = numbers.modes
    return modes[LOAD, k] - modes[DECAY, k] * v - modes[SQUARE, k] * u


@kernel
def speed_scale(numbers, u, v):
    """The square root of twice the modal energy, of the deviation and of the steady motion [m kg^0.5/s].

    It is above zero if anything moves: a load counts by the speed that it gives in a moment, see `BRIEF`.
    """
    energy, square, load = numbers.steady_energy, numbers.modes[SQUARE], numbers.modes[LOAD]
    moment = BRIEF * numbers.period
    for k in range(u.size):
        energy += v[k] * v[k] + square[k] * u[k] * u[k] + (moment * load[k]) ** 2
    return math.sqrt(energy)


def steady_motion(numbers: Numbers, clock: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Steady modal displacement and velocity at times `clock` since a strobe, each (..., n_modes)."""
    sine, cosine, offset = numbers.steady
    phase = numbers.drive * np.asarray(clock, dtype=float)[..., None]
    s, c = np.sin(phase), np.cos(phase)
    return offset + sine * s + cosine * c, numbers.drive * (sine * c - cosine * s)


def free_flow(numbers: Numbers, time: float) -> np.ndarray:
    """Free flow (u, u') -> (u, u') of each mode over `time` [s], of either sign, shape (n_modes, 2, 2)."""
    flows: np.ndarray = flow_over(numbers, time)[:, :4].reshape(-1, 2, 2)
    return flows
