"""Restitution of a spring and dashpot, and of a ball that bounces.

A free mass m meets a stop with N = max(0, k d + c d').  With the damping ratio zeta = c/(2 sqrt(k m)) it
leaves where the force vanishes, after 2 theta/sin(theta) radians of sqrt(k/m), cos(theta) = zeta, with

    e = exp(-2 zeta theta/sin(theta)),

the restitution of T. Schwager and T. Poeschel (Granular Matter 9 (2007) 465) in one formula: it is analytic
in zeta, exp(-2) at zeta = 1, and beyond theta/sin(theta) is acosh(zeta)/sqrt(zeta^2 - 1).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import require, require_array, require_within

LEAST_BOUNCES = 3  # two intervals have one ratio


class MeasuredRestitution(NamedTuple):
    """A restitution from a measurement, with its standard error."""

    restitution: float  # [1]
    standard_error: float  # [1], NaN if unknown


def restitution_of_damping_ratio(damping_ratio: float) -> float:
    """Restitution of a free mass at a spring and dashpot whose force is cut at zero.

    Parameters
    ----------
    damping_ratio : float
        zeta = c/(2 sqrt(k m)), zero or more [1].

    Returns the restitution, at most 1 [1].  Raises InvalidType or InvalidValue for a wrong number.
    """
    zeta = require_within("damping_ratio", damping_ratio, "[1]", low=0)
    return math.exp(-_exponent(zeta))


def _exponent(zeta: float) -> float:
    """2 zeta theta/sin(theta): minus the logarithm of the restitution."""
    root = math.sqrt(abs(1.0 - zeta)) * math.sqrt(1.0 + zeta)
    if root == 0.0:
        return 2.0
    return 2.0 * zeta * (math.acos(zeta) if zeta < 1.0 else math.acosh(zeta)) / root


def damping_ratio(restitution: float) -> float:
    """Damping ratio of the spring and dashpot, its force cut at zero, with this restitution of a free mass.

    It is the inverse of `restitution_of_damping_ratio` (T. Schwager, T. Poeschel, Granular Matter 9 (2007)
    465).  The dashpot of a mass m at a stiffness k is c = 2 zeta sqrt(k m).

    Parameters
    ----------
    restitution : float
        Rebound speed over approach speed, above 0 and at most 1 [1].

    Returns the damping ratio zeta [1].  Raises InvalidType or InvalidValue for a wrong number.
    """
    e = require_within("restitution", restitution, "[1]", above=0, high=1)
    wanted = -math.log(e)
    if wanted == 0.0:
        return 0.0

    from scipy.optimize import brentq  # slow to import

    # theta/sin(theta) is at most pi/2; beyond zeta = 1 the exponent is above 2 acosh(zeta)
    low, high = 0.999 * wanted / math.pi, 1.001 * math.cosh(0.5 * wanted)
    return float(
        brentq(lambda zeta: _exponent(zeta) - wanted, low, high, xtol=1e-300, rtol=1e-15, maxiter=2000)
    )


def restitution_from_bounces(times: ArrayLike) -> MeasuredRestitution:
    """Restitution of a ball from the times at which it hits a floor at rest.

    The intervals between bounces fall by the restitution, t_n = t_0 + T (1 + e + ... + e^(n-1)).  The three
    unknowns are fitted to the times by least squares.  This is the best estimate if the times have
    independent errors of one size.  Ratios of successive intervals would share these errors.

    Parameters
    ----------
    times : array_like, shape (n,)
        Times of successive bounces, rising [s]; three or more.

    Returns
    -------
    MeasuredRestitution
        The `restitution` [1], which errors of the times can lift above 1, and its `standard_error` [1].  The
        size of the errors is taken from the residuals; three times leave none, and the error is NaN.

    Raises InvalidType or InvalidValue for wrong times.
    """
    given = require_array("times", times, "s", dimensions=1)
    require(
        given.size >= LEAST_BOUNCES,
        "times",
        f"has {given.size} entries; it must have {LEAST_BOUNCES} or more",
    )
    falls = np.flatnonzero(np.diff(given) <= 0.0)
    if falls.size:
        i = int(falls[0])
        require(False, "times", f"falls or stays from {given[i]:g} to {given[i + 1]:g} s; it must rise")
    span = given[-1] - given[0]
    t, n = (given - given[0]) / span, np.arange(given.size)
    restitution = float((t[-1] - t[1]) / t[-2])
    if given.size == LEAST_BOUNCES:
        return MeasuredRestitution(restitution, math.nan)

    from scipy.optimize import least_squares  # slow to import

    def columns(e: float) -> np.ndarray:
        """1 + e + ... + e^(n-1), and its derivative."""
        powers = np.append(0.0, e ** n[:-1])
        slopes = np.append([0.0, 0.0], n[1:-1] * e ** (n[1:-1] - 1))
        return np.array([np.cumsum(powers), np.cumsum(slopes)])

    def jacobian(x: np.ndarray) -> np.ndarray:
        sums, slopes = columns(x[2])
        return np.column_stack([np.ones(n.size), sums, x[1] * slopes])

    found = least_squares(
        lambda x: x[0] + x[1] * columns(x[2])[0] - t,
        [0.0, t[1], restitution],
        jacobian,
        method="lm",
        xtol=1e-15,
    )
    _, triangle = np.linalg.qr(jacobian(found.x))
    variance = 2.0 * found.cost / (given.size - 3) / triangle[2, 2] ** 2
    return MeasuredRestitution(float(found.x[2]), math.sqrt(variance))
