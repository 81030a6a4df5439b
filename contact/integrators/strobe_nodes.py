"""One mode at the nodes of a drive period: its motion anywhere in the period without sines.

The period P is cut into K equal stretches by the nodes t_k = k P/K.  Kept are, for every node, the swing of
the steady tip motion, X_k = S sin(w t_k) + C cos(w t_k) and R_k = X'_k/w, and the flow F_k of the free
deviation over k stretches (``contact.flight``).  For a time t next to node k, x = t - t_k,

    steady motion = X_k cos(w x) + R_k sin(w x),      flow over t = F(x) F_k,

and with |x| <= P/(2K) the cosine, the sine and the flow F(x) follow from the series

    cos sqrt(z) = 1 - z/2! + z^2/4! - ...,   sin sqrt(z)/sqrt(z) = 1 - z/3! + z^2/5! - ...,   e^y = 1 + y ...

at z = (w x)^2, z = D x^2 (below zero for an over-damped mode) and y = -c x/2.  K is chosen such that w x,
omega x and c x stay below 0.05: the first terms left out, z^5/10! and y^9/9!, are then below 1e-17.

The peak of the steady motion lies at the time t_p of the period, at the height A = sqrt(S^2 + C^2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import kernel
from contact.flight import Motion, flow_matrix

__all__ = [
    "SingleMode",
    "StrobeNodes",
    "flow_over",
    "nodes_at",
    "nodes_of",
    "short_fades",
    "short_flow",
    "short_turn",
    "tip_near",
]

FEWEST, MOST = 64, 4096
"""Stretches of a period: 64 where the drive is fastest (w x <= pi/64), more for a faster mode; beyond 4096,
for a mode some sixty times faster than the drive, the table would outgrow the nearest cache."""

HIGHEST = 1e6
"""Steady amplitude in gaps up to which the peak's place is good enough to tell the middle of a period."""


class SingleMode(NamedTuple):
    """The scalars of one mode that the small kernels need (few, since they are passed at every call).

    level = static tip displacement minus gap [m]; phi [kg^-0.5]; stiffness = omega^2 [1/s^2]; decay = c
    [1/s]; determinant = D [1/s^2]; drive = w [rad/s]; stretch = P/K and its inverse [s, 1/s].
    """

    level: float
    phi: float
    stiffness: float
    decay: float
    determinant: float
    drive: float
    stretch: float
    per_second: float


class StrobeNodes(NamedTuple):
    """A drive period of one mode, cut into stretches.

    mode : SingleMode
    rows : ndarray, shape (K + 1, 6)
        X_k, R_k [m] and the four numbers of F_k.
    level, from_u, from_v : ndarray, shape (K + 1,)
        Tip displacement relative to the stop at the nodes: level + from_u u_0 + from_v v_0.
    amplitude, peak : float
        A [m] and t_p [s].
    to_peak : ndarray, shape (4,)
        phi times the flow over t_p.
    inner : bool
        Whether t_p lies in the middle half of the period.
    """

    mode: SingleMode
    rows: np.ndarray
    level: np.ndarray
    from_u: np.ndarray
    from_v: np.ndarray
    amplitude: float
    peak: float
    to_peak: np.ndarray
    inner: bool


@kernel
def fill_nodes(motion, count, rows):
    """The steady motion and the flow at the `count` + 1 nodes."""
    w = motion.drive
    for k in range(count + 1):
        t = k * (motion.period / count)
        s, c = math.sin(w * t), math.cos(w * t)
        rows[k, 0] = motion.tip_sine * s + motion.tip_cosine * c
        rows[k, 1] = motion.tip_sine * c - motion.tip_cosine * s
        rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5] = flow_matrix(
            motion.omega[0], motion.decay[0], motion.damped[0], motion.damped_low[0], t
        )


@kernel
def is_inner(peak, period, amplitude, level):
    """Whether t_p = `peak` lies in the middle half of the period."""
    return abs(peak / period - 0.5) <= 0.25 + 1e-12 and amplitude <= HIGHEST * abs(level)


def nodes_of(motion: Motion) -> StrobeNodes | None:
    """The nodes of a driven oscillator of one mode; None if it has several modes, no stiffness or no drive,
    its node at the tip, or is so fast that too many nodes would be needed."""
    if motion.omega.size != 1 or not motion.omega[0] > 0 or motion.phi[0] == 0 or not motion.drive > 0:
        return None
    omega, decay, phi = float(motion.omega[0]), float(motion.decay[0]), float(motion.phi[0])
    ratio = max(motion.drive, omega, decay) / motion.drive
    if not ratio * FEWEST <= MOST:
        return None
    count = FEWEST * 2 ** math.ceil(math.log2(ratio))
    rows = np.empty((count + 1, 6))
    fill_nodes(motion, count, rows)
    amplitude = math.hypot(motion.tip_sine, motion.tip_cosine)
    angle = math.atan2(motion.tip_sine, motion.tip_cosine) % (2.0 * math.pi)
    peak = min(angle / motion.drive, motion.period)
    high, low = float(motion.damped[0]), float(motion.damped_low[0])
    return StrobeNodes(
        mode=SingleMode(
            level=motion.level, phi=phi, stiffness=omega * omega, decay=decay,
            determinant=math.copysign(high * (high + 2.0 * low), omega - 0.5 * decay), drive=motion.drive,
            stretch=motion.period / count, per_second=count / motion.period,
        ),
        rows=rows, level=motion.level + rows[:, 0], from_u=phi * rows[:, 2], from_v=phi * rows[:, 3],
        amplitude=amplitude, peak=peak, to_peak=phi * np.array(flow_matrix(omega, decay, high, low, peak)),
        inner=is_inner(peak, motion.period, amplitude, motion.level),
    )


@kernel
def nodes_at(nodes, factor, period):
    """The nodes of the same oscillator at `factor` times the drive amplitude, `period` its drive period.

    The steady motion alone depends on the amplitude, and in proportion.
    """
    rows, level = nodes.rows.copy(), np.empty(nodes.level.size)
    for k in range(level.size):
        rows[k, 0] *= factor
        rows[k, 1] *= factor
        level[k] = nodes.mode.level + rows[k, 0]
    amplitude = nodes.amplitude * factor
    return StrobeNodes(
        mode=nodes.mode, rows=rows, level=level, from_u=nodes.from_u, from_v=nodes.from_v,
        amplitude=amplitude, peak=nodes.peak, to_peak=nodes.to_peak,
        inner=is_inner(nodes.peak, period, amplitude, nodes.mode.level),
    )


@kernel
def short_turn(z):
    """cos sqrt(z) and sin sqrt(z)/sqrt(z) for |z| up to 0.0025."""
    even = 1.0 + z * (-1.0 / 2.0 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0))))
    return even, odd


@kernel
def short_fades(y):
    """cosh y and sinh y for |y| up to 0.05: e^y is their sum, e^-y their difference."""
    z = y * y
    even = 1.0 + z * (1.0 / 2.0 + z * (1.0 / 24.0 + z * (1.0 / 720.0 + z * (1.0 / 40320.0))))
    odd = 1.0 + z * (1.0 / 6.0 + z * (1.0 / 120.0 + z * (1.0 / 5040.0)))
    return even, y * odd


@kernel
def short_flow(mode, x, u, v):
    """Deviation (u, v) after a time |x| <= P/(2K) [s]."""
    half = 0.5 * mode.decay
    even, odd = short_turn(mode.determinant * x * x)
    fade, rest = short_fades(-half * x)
    fade += rest
    cn, sn = fade * even, fade * odd * x
    return cn * u + sn * (v + half * u), cn * v - sn * (mode.stiffness * u + half * v)


@kernel
def flow_over(mode, rows, t, u, v):
    """Deviation (u, v) after a time `t` of at most a period [s]."""
    k = int(t * mode.per_second + 0.5)
    u, v = short_flow(mode, t - k * mode.stretch, u, v)
    return rows[k, 2] * u + rows[k, 3] * v, rows[k, 4] * u + rows[k, 5] * v


@kernel
def tip_near(mode, rows, since, u, v, t):
    """The motion at time `t` since the strobe; (u, v) is the deviation at node `since`, not after `t`'s node.

    Returns
    -------
    Deviation and its rate; steady swing; tip displacement relative to the stop [m] and two derivatives.
    """
    w = mode.drive
    k = int(t * mode.per_second + 0.5)
    x = t - k * mode.stretch
    i = k - since
    un, vn = short_flow(mode, x, rows[i, 2] * u + rows[i, 3] * v, rows[i, 4] * u + rows[i, 5] * v)
    even, odd = short_turn(w * w * x * x)
    odd *= w * x
    swing = rows[k, 0] * even + rows[k, 1] * odd
    return (
        un, vn, swing, mode.level + swing + mode.phi * un,
        w * (rows[k, 1] * even - rows[k, 0] * odd) + mode.phi * vn,
        -w * w * swing - mode.phi * (mode.decay * vn + mode.stiffness * un),
    )
