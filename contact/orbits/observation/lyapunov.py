"""Lyapunov exponents from the Jacobians of the period map.

J_n is the derivative of the period map at the n-th strobe.  With Q R = J_n Q', Q' from the step before,

    lambda_i = < log |R_ii| >        [per drive period],  largest first.

For an impact oscillator J_n comes from ``contact.sensitivity.replay``.  A strobe that falls into a contact is
passed over: that J_n spans more than one period.  A rest on the stop forgets two directions, and an impact
without rebound one: J_n is then a product of factors through fewer directions.  Each direction that is lost
has the multiplier 0 and the exponent -inf.  Averages are weighted by w(t) = exp(-1/(t (1 - t))), t the
fraction of the run (S. Das, Y. Saiki, E. Sander, J. A. Yorke, Nonlinearity 30 (2017) 4111).  The standard
error comes from the scatter of blocks.  See ``docs/theory/orbits.md``.
"""

import math
from functools import reduce
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from beam.parameters import Array, record, require_whole
from contact.errors import NoDerivative, NotPeriodic
from contact.maps.protocol import DifferentiableMap, require_map
from contact.orbits.observation.repetition import require_orbit

S = TypeVar("S")

AT_ONCE = 64  # periods simulated at a time, which bounds the memory; no result depends on it
BLOCKS = 20  # blocks whose scatter gives the standard error: enough for an estimate within a sixth of itself
MOST_STRETCHES = 64  # bound of repetitions of an orbit's period until its strobe is off the wall


@record
class Exponents:
    """Lyapunov exponents of a motion.

    Parameters
    ----------
    values : ndarray, shape (n_exponents,)
        The exponents, largest first [per drive period].  A direction that the motion forgets, as at rest on
        the stop, has -inf.
    error : float
        Standard error of the largest exponent [per drive period]; 0 on a periodic orbit, and for -inf.
    """

    values: Array
    error: float

    @property
    def largest(self) -> float:
        """The largest exponent, above zero in chaos, -inf if all are [per drive period]."""
        return float(self.values[0])


def _finite(matrix: Array) -> Array:
    """The matrix; NoDerivative if it has left the range of numbers."""
    if not np.all(np.isfinite(matrix)):
        raise NoDerivative(detail="the derivatives are not finite")
    return matrix


@np.errstate(divide="ignore")
def _logs(factors: ArrayLike) -> Array:
    """Logarithms of the sizes of `factors`; -inf for a zero."""
    return np.asarray(np.log(np.abs(factors)), dtype=float)


def _weighted(rates: Array, spans: Array) -> tuple[Array, float]:
    """Weighted mean of `rates`, (n, k), over steps of length `spans`, and standard error of the largest."""
    ends = np.cumsum(spans)
    middle = (ends - 0.5 * spans) / ends[-1]
    weight = np.exp(-1.0 / (middle * (1.0 - middle))) * spans
    mean, kept = np.full(rates.shape[1], -np.inf), np.all(np.isfinite(rates), axis=0)
    mean[kept] = weight @ rates[:, kept] / weight.sum()
    top = int(np.argmax(mean))
    if not kept[top]:
        return mean, 0.0
    blocks = np.array_split(np.arange(rates.shape[0]), min(BLOCKS, rates.shape[0]))
    parts = [float(spans[b] @ rates[b, top] / spans[b].sum()) for b in blocks]
    # the weights leave about 0.51 of the run: square of their mean over mean of their squares
    error = float(np.std(parts, ddof=1) / math.sqrt(0.51 * len(parts))) if len(parts) > 1 else math.inf
    return mean, error


def map_exponents(
    strobed: DifferentiableMap[S], state: S, count: int, *, align: int = 0
) -> tuple[Exponents, S]:
    """Return all Lyapunov exponents of a motion, from Jacobians.

    Parameters
    ----------
    strobed : DifferentiableMap
        The oscillator or map at its drive amplitude, such as a StroboscopicMap or a NordmarkMap.
    state : State
        State on the attractor, from which the motion starts.
    count : int
        Number of steps in the average, 2 or more.
    align : int, optional
        Number of steps before the average, in which the frame of directions finds its orientation.

    Returns
    -------
    exponents : Exponents
        The exponents per step, with the standard error of the largest.
    state : State
        The state at the end.

    Raises
    ------
    TypeError
        If `strobed` is no strobed map with derivatives, or an argument is no number.
    ValueError
        If `count` or `align` is out of range, or `state` is in contact or not at a strobe.
    NoDerivative
        If the motion grazes the stop, or the derivatives are not finite.
    ContactError
        If the motion could not be followed, or the tip came to rest on the wall.
    """
    require_map(strobed, DifferentiableMap)
    count = require_whole("count", count, "steps", low=2, why=": an average needs them")
    align = require_whole("align", align, "steps", low=0)
    size, rates, spans, done = strobed.coordinates(state).size, list[Array](), list[float](), 0
    frame, logs = np.eye(size), np.zeros(size)
    while done < align + count:
        found, state = strobed.jacobians(state, min(AT_ONCE, align + count - done))
        for matrix, span in found:
            # directions that are lost in the steps before the average are restored
            frame, triangle = np.linalg.qr(_finite(matrix @ frame), "complete" if done < align else "reduced")
            kept = min(triangle.shape)
            logs[:kept], logs[kept:] = logs[:kept] + _logs(np.diag(triangle)), -np.inf
            done += span
            if span > 0 and done > align:
                rates.append(logs / span)
                spans.append(float(span))
            logs = logs if span == 0 else np.zeros(size)
    mean, error = _weighted(np.array(rates), np.array(spans))
    return Exponents(values=np.sort(mean)[::-1], error=error), state


def orbit_exponents(strobed: DifferentiableMap[S], state: S, m: int) -> Exponents:
    """Return the Lyapunov exponents of a periodic orbit.

    They are ``log(abs(mu_i))/m``, with mu_i the Floquet multipliers of the orbit, and -inf where mu_i is 0.

    Parameters
    ----------
    strobed : DifferentiableMap
        The oscillator or map at the amplitude of the orbit, such as a StroboscopicMap or a NordmarkMap.
    state : State
        State on the orbit, at a strobe off the stop.
    m : int
        Period of the orbit in drive periods, one or more.

    Returns
    -------
    Exponents
        The exponents per drive period, without an error.

    Raises
    ------
    TypeError
        If `strobed` is no strobed map with derivatives, or `m` is no number.
    ValueError
        If `m` is no whole number of one or more, or `state` is in contact or not at a strobe.
    NotPeriodic
        If the motion is not back at `state` after `m` periods, or if all its strobes are in contact.
    NoDerivative
        If the motion grazes the stop, or the derivatives are not finite.
    """
    require_map(strobed, DifferentiableMap)
    m = require_whole("m", m, "drive periods")
    require_orbit(strobed, state, m)
    values, factors, done = np.full(strobed.coordinates(state).size, -np.inf), list[Array](), 0
    while done % m or done == 0:  # a strobe in contact is never the last: m periods later it is again
        if done > MOST_STRETCHES * m:
            raise NotPeriodic(detail="every strobe of the orbit is in contact")
        found, state = strobed.jacobians(state, m - done % m)
        for step, span in found:
            factors.append(step)
            done += span
    # from where the dimension is smallest: this leaves out multipliers that are certainly zero
    narrow = int(np.argmin([len(step) for step in factors])) + 1
    steps, start = factors[narrow:] + factors[:narrow], np.eye(len(factors[narrow - 1]))
    multipliers = np.linalg.eigvals(reduce(lambda product, step: _finite(step @ product), steps, start))
    values[: multipliers.size] = np.sort(_logs(multipliers))[::-1] / done
    return Exponents(values=values, error=0.0)
