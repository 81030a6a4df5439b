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

from beam.parameters import Array, require, require_array, require_within

FEWEST = 3  # bounces with a ratio of intervals


class MeasuredRestitution(NamedTuple):
    """A restitution from a measurement, with its standard error.

    Parameters
    ----------
    restitution : float
        Rebound speed over approach speed [1].
    standard_error : float
        Standard error of the restitution [1]; NaN if it is unknown.
    """

    restitution: float
    standard_error: float


def log_restitution(zeta: float) -> float:
    """Logarithm of the restitution at a damping ratio of zero or more."""
    root = math.sqrt(abs(1.0 - zeta)) * math.sqrt(1.0 + zeta)
    if root == 0.0:
        return -2.0
    return -2.0 * zeta * (math.acos(zeta) if zeta < 1.0 else math.acosh(zeta)) / root


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio of a spring and dashpot under which a free mass has this restitution.

    The force of the stop is cut at zero.  The dashpot of a mass m at a stiffness k is c = 2 zeta sqrt(k m)
    (T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465).

    Parameters
    ----------
    restitution : float
        Rebound speed over approach speed, above 0 and at most 1 [1].

    Returns
    -------
    float
        Damping ratio zeta [1].

    Raises
    ------
    ValueError
        If the restitution is not above 0 and at most 1.
    TypeError
        If the restitution is no number.
    """
    log = math.log(require_within("restitution", restitution, "[1]", above=0, high=1))
    if log == 0.0:
        return 0.0

    from scipy.optimize import brentq  # slow to import

    # theta/sin(theta) is at most pi/2; beyond zeta = 1 minus the logarithm is above 2 acosh(zeta)
    low, high = -0.999 * log / math.pi, 1.001 * math.cosh(0.5 * log)
    settings = dict(xtol=1e-300, rtol=1e-15, maxiter=2000)
    return float(brentq(lambda zeta: log_restitution(zeta) - log, low, high, **settings))


def restitution_from_bounces(times: ArrayLike) -> MeasuredRestitution:
    """Return the restitution of a ball from the times at which it hits a floor at rest.

    Parameters
    ----------
    times : array_like, shape (n,)
        Times of successive bounces, rising [s]; three or more.

    Returns
    -------
    MeasuredRestitution
        Restitution and its standard error [1].  Errors of the times can lift the restitution above 1.  The
        standard error is NaN for three times, which leave no residuals.

    Raises
    ------
    ValueError
        If there are fewer than three times, or if they do not rise or are not finite.
    TypeError
        If `times` is no array of numbers.

    See Also
    --------
    NewtonRestitution : The law that takes the restitution.
    damping_ratio : The damping ratio of a dashpot with this restitution.

    Notes
    -----
    Each interval between bounces is the one before it times the restitution.  The times are therefore
    ``t_n = t_0 + T (1 + e + ... + e^(n-1))``.  The three unknowns t_0, T and e are fitted by least squares.
    This is the best estimate if the times have independent errors of one size.

    Examples
    --------
    Times in seconds, read from a sound record:

    >>> from contact import restitution_from_bounces
    >>> e = restitution_from_bounces([0.001, 0.600, 1.081, 1.463, 1.771])
    >>> print(f"{e.restitution:.3f} with a standard error of {e.standard_error:.3f}")
    0.800 with a standard error of 0.001
    """
    given = require_array("times", times, "s", dimensions=1)
    require(given.size >= FEWEST, "times", f"has {given.size} entries; it must have {FEWEST} or more")
    ahead = np.diff(given)
    words = f"has {ahead.min():g} s from one entry to the next; it must rise"
    require(bool(np.all(ahead > 0.0)), "times", words)
    t = (given - given[0]) / (given[-1] - given[0])
    ratio = float((t[-1] - t[1]) / t[-2])
    if t.size == FEWEST:
        return MeasuredRestitution(ratio, math.nan)

    from scipy.optimize import curve_fit  # slow to import

    def bounces(n: Array, first: float, interval: float, e: float) -> Array:
        return first + interval * np.cumsum(np.append(0.0, e ** n[:-1]))

    fit, covariance = curve_fit(bounces, np.arange(t.size), t, [0.0, t[1], ratio], xtol=1e-15, ftol=1e-15)
    return MeasuredRestitution(float(fit[2]), math.sqrt(covariance[2, 2]))
