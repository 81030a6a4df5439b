"""Derivatives of the free flow of a mode with respect to its numbers.

With half = c/2, D = omega^2 - half^2 and cn, sn as in ``contact.flight.modal_flow`` (damping included), the
flow is (cn + half sn, sn; -omega^2 sn, cn - half sn), and

    d cn/dD = -t sn/2,      d sn/dD = (t cn - sn)/(2 D),      dD/d(omega^2) = 1,      dD/dc = -half,

while d exp(-half t)/dc = -t/2 exp(-half t).  Where D t^2 is small, d sn/dD is the series

    e^(-half t) t^3 sum_k (-1)^k (D t^2)^(k-1) k/(2k + 1)!,      k = 1, 2, ...
"""

import math

from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import DAMPED, DAMPED_LOW, DECAY, OMEGA
from contact.machine.compiled import kernel

TERMS = 10  # terms of the series for |D t^2| < 1: the next one is below 1e-19 of the first


@kernel
def flow_derivative(modes, k, square, decay, t):
    """Derivative of the flow of mode `k` over a time `t` [s], as four numbers, in a direction of the numbers.

    `square` and `decay` are the changes of omega^2 and c in that direction.
    """
    omega, half = modes[OMEGA, k], 0.5 * modes[DECAY, k]
    m11, sn, m21, m22 = flow_matrix(omega, modes[DECAY, k], modes[DAMPED, k], modes[DAMPED_LOW, k], t)
    distance = math.copysign(modes[DAMPED, k] ** 2, omega - half)
    x = distance * t * t
    if abs(x) < 1.0:
        term, slope = -t * t * t * math.exp(-half * t) / 6.0, 0.0
        for n in range(1, TERMS + 1):
            slope += n * term
            term *= -x / ((2.0 * n + 2.0) * (2.0 * n + 3.0))
    else:
        slope = (0.5 * t * (m11 + m22) - sn) / (2.0 * distance)
    moved, faded, spread = square - half * decay, -0.5 * t * decay, 0.5 * decay * sn
    even, odd = -0.5 * t * sn * moved, half * slope * moved
    return (
        faded * m11 + even + odd + spread,
        faded * sn + slope * moved,
        faded * m21 - sn * square - omega * omega * slope * moved,
        faded * m22 + even - odd - spread,
    )
