"""The coefficients of Nordmark's map, from one mode, its drive and its restitution.

With the free flow M of u'' + c u' + omega_1^2 u = 0 over 1/f, and omega_d^2 = omega_1^2 - c^2/4,

    alpha = tr M = exp(-c/2f) 2 cos(omega_d/f)      (2 cosh(kappa/f) if omega_d^2 = -kappa^2 < 0)
    gamma = det M = exp(-c/f)
    rho   = (F/F_g - 1) (1 - alpha + gamma) / (2 (2 pi f M12)^2 (1 + tau)^2)
    d     = delay / (2 M12 (1 + tau)^2)

For an underdamped mode of free period T = 2 pi/omega_d, (2 pi f M12)^2 = gamma (f T)^2 sin^2(2 pi/(f T)).
Eq. (3) is the case M12 > 0.

Sources: letter of 1996, Eqs. (1) to (3), its bracket in rho corrected; A. B. Nordmark, J. Sound Vib. 145
(1991) 279.  Derivation: ``docs/theory/map.md``.
"""

import math

from beam.parameters import require, require_within
from contact.flight.modal_flow import flow_matrix
from contact.flight.numbers import damped_frequency


def coefficients(
    omega: float, decay_rate: float, drive_frequency: float, restitution: float, delay: float
) -> tuple[float, float, float, int]:
    """alpha, gamma, d and the integer part of 1/(f T), for the arguments of ``NordmarkMap.from_mode``."""
    require_within("omega", omega, "rad/s", above=0)
    require_within("decay_rate", decay_rate, "1/s", low=0)
    require_within("drive_frequency", drive_frequency, "Hz", above=0)
    require_within("delay", delay, "s", low=0)
    require_within("restitution", restitution, "[1]", low=0, high=1)
    damped, damped_low = damped_frequency(omega, decay_rate)
    n11, n12, _, n22 = flow_matrix(omega, decay_rate, damped, damped_low, 1.0 / drive_frequency)
    turns = damped / (2.0 * math.pi * drive_frequency) if omega > 0.5 * decay_rate else 0.0
    own = damped / (2.0 * math.pi)
    words = f"the map has p_m only below resonance, here from {own / 1.5:.6g} to {own:.6g} Hz"
    require(n12 > 0.0, f"drive_frequency is {drive_frequency} Hz; {words}")
    delay_term = delay / (2.0 * n12 * (1.0 + restitution) ** 2)
    return n11 + n22, math.exp(-decay_rate / drive_frequency), delay_term, math.floor(turns)
