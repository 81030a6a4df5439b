"""Lyapunov exponents from the Jacobians of the period map.

J_n is the derivative of the period map at the n-th strobe.  With Q R = J_n Q', Q' from the step before,

    lambda_i = < log |R_ii| >        [per drive period],  largest first.

For an impact oscillator J_n comes from ``contact.sensitivity.replay``.  A strobe that falls into a contact is
passed over: that J_n spans more than one period.  Averages are weighted by w(t) = exp(-1/(t (1 - t))), t the
fraction of the run (S. Das, Y. Saiki, E. Sander, J. A. Yorke, Nonlinearity 30 (2017) 4111).  The standard
error comes from the scatter of blocks.  See ``docs/theory/orbits.md``.
"""

import math
from typing import TypeVar

import numpy as np

from beam.parameters import Array, record, require_whole
from contact.errors import NoDerivative, NotPeriodic
from contact.maps.protocol import DifferentiableMap, require_map
from contact.orbits.observation.repetition import require_orbit

S = TypeVar("S")

AT_ONCE = 64  # periods simulated at a time, which bounds the memory; no result depends on it
BLOCKS = 20  # blocks whose scatter gives the standard error: enough for an estimate within a sixth of itself
MOST_STRETCHES = 64  # bound of repetitions of an orbit's period until its strobe is off the wall
SMALLEST = 1e-300  # replaces a zero on the diagonal of R, where an impact without rebound erases a direction


@record
class Exponents:
    """Lyapunov exponents of a motion.

    Parameters
    ----------
    values : ndarray, shape (n_exponents,)
        The exponents, largest first [per drive period].
    error : float
        Standard error of the largest exponent [per drive period]; 0 on a periodic orbit.
    """

    values: Array
    error: float

    @property
    def largest(self) -> float:
        """The largest exponent, above zero in chaos [per drive period]."""
        return float(self.values[0])


def _finite(matrix: Array) -> Array:
    """The matrix; NoDerivative if it has left the range of numbers."""
    if not np.all(np.isfinite(matrix)):
        raise NoDerivative(detail="the derivatives are not finite")
    return matrix


def _weighted(rates: Array, spans: Array) -> tuple[Array, float]:
    """Weighted mean of `rates`, (n, k), over steps of length `spans`, and standard error of column 0."""
    ends = np.cumsum(spans)
    middle = (ends - 0.5 * spans) / ends[-1]
    weight = np.exp(-1.0 / (middle * (1.0 - middle))) * spans
    mean = weight @ rates / weight.sum()
    blocks = np.array_split(np.arange(rates.shape[0]), min(BLOCKS, rates.shape[0]))
    parts = [float(spans[b] @ rates[b, 0] / spans[b].sum()) for b in blocks]
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
    frame, rates, spans, done = np.eye(strobed.coordinates(state).size), [], [], 0
    while done < align + count:
        found, state = strobed.jacobians(state, min(AT_ONCE, align + count - done))
        for matrix, span in found:
            frame, triangle = np.linalg.qr(_finite(matrix @ frame))
            done += span
            if done > align:
                rates.append(np.log(np.maximum(np.abs(np.diag(triangle)), SMALLEST)) / span)
                spans.append(float(span))
    mean, error = _weighted(np.array(rates), np.array(spans))
    return Exponents(values=np.sort(mean)[::-1], error=error), state


def orbit_exponents(strobed: DifferentiableMap[S], state: S, m: int) -> Exponents:
    """Return the Lyapunov exponents of a periodic orbit.

    They are ``log(abs(mu_i))/m``, with mu_i the Floquet multipliers of the orbit.

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
    matrix = np.eye(strobed.coordinates(state).size)
    done = 0
    while done % m or done == 0:  # a strobe in contact is never the last: m periods later it is again
        if done > MOST_STRETCHES * m:
            raise NotPeriodic(detail="every strobe of the orbit is in contact")
        found, state = strobed.jacobians(state, m - done % m)
        for step, span in found:
            matrix, done = _finite(step @ matrix), done + span
    sizes = np.maximum(np.abs(np.linalg.eigvals(matrix)), SMALLEST)
    return Exponents(values=np.sort(np.log(sizes))[::-1] / done, error=0.0)
