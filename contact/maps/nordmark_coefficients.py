r"""The coefficients of Nordmark's map, from one mode, its drive and its restitution.

The deviation u from the steady motion obeys u'' + c u' + omega_1^2 u = 0, with flow M over 1/f. With the peak
phase as strobe phase, an overshoot h meets the wall at speed v = sqrt(2 a h), where a = (2 pi f)^2 gap, and
Newton's law changes the velocity at that phase by -(1 + tau) v to leading order. The height of the next peak
changes by -M12 (1 + tau) v, so the scale at which the root has coefficient one is 2 a M12^2 (1 + tau)^2.
Eliminating the velocity from two successive steps gives

    alpha = tr M = exp(-c/2f) 2 cos(omega_d/f),    omega_d^2 = omega_1^2 - c^2/4 > 0  (2 cosh(kappa/f) if < 0)
    gamma = det M = exp(-c/f)
    rho   = (F/F_g - 1) (1 - alpha + gamma) / (2 (2 pi f M12)^2 (1 + tau)^2)

For an underdamped mode of free period T = 2 pi/omega_d, (2 pi f M12)^2 = gamma (f T)^2 sin^2(2 pi/(f T)).
A kick that comes `delay` seconds late is (1 + tau) v - a delay, hence d = delay / (2 M12 (1 + tau)^2).
The sign of the root is that of M12: Eq. (3) is the case M12 > 0, for an underdamped mode a fractional part of
1/(f T) below one half (2/3 < f T < 1 in the letter).

In the letter the bracket in rho is broken, "(1 + tau^2 sin^2(2 pi/fT)"; it must read
(1 + tau)^2 sin^2(2 pi/(f T)). The "rho = F/F_g - 1" under its Fig. 4 is not this rho, but `excess` here.

Sources: letter of 1996, Eqs. (1) to (3); A. B. Nordmark, J. Sound Vib. 145 (1991) 279.
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
