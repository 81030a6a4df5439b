"""The covariance of the strobe points around an orbit under noise of the drive, to first order.

In drive period n the amplitude is (1 + e_n) times that of the orbit, e_n Gaussian of standard deviation sigma
and memory r: e_(n+1) = r e_n + sqrt(1 - r^2) sigma xi_n.  With M_n the derivative of a strobe by the one
before and b_n by e_n, the covariance C_n of deviation and e_n obeys

    C_(n+1) = A_n C_n A_n^T + Q,   A_n = [[M_n, b_n], [0, r]],   Q = diag(0, (1 - r^2) sigma^2),

and repeats after the m periods of the orbit.  No touch may come or go within the cloud.
Source: Simpson, Hogan and Kuske, arXiv:1207.2703.  Derivation: ``docs/theory/noise.md``.
"""

from dataclasses import replace
from functools import reduce

import numpy as np

from beam.parameters import Array, require, require_kind, require_whole, require_within
from contact.errors import NotPeriodic
from contact.maps.nordmark import NordmarkMap
from contact.maps.stroboscope import StroboscopicMap
from contact.orbits.observation.repetition import require_orbit
from contact.sensitivity.change import Change
from contact.sensitivity.derivatives import motion_derivatives
from contact.state import State

Strobed = StroboscopicMap | NordmarkMap


def strobe_derivatives(strobed: Strobed, state: State | Array, m: int) -> list[tuple[Array, Array]]:
    """Return the derivatives of each strobe along an orbit, by the strobe before and by the amplitude.

    Parameters
    ----------
    strobed : StroboscopicMap or NordmarkMap
        Strobed oscillator or map at the excess of the orbit.
    state : State or ndarray, shape (2,)
        State at a strobe off the stop; a pair (x, y) for a NordmarkMap.
    m : int
        Number of drive periods, one or more.

    Returns
    -------
    list of (ndarray, ndarray)
        The pair (M_n, b_n) of each period, in the coordinates of the points.  M_n has shape (n_coordinates,
        n_coordinates), and b_n has shape (n_coordinates,).  In b_n the amplitude counts relative to that of
        the orbit.

    Raises
    ------
    TypeError
        If `strobed` is neither a StroboscopicMap nor a NordmarkMap, or `state` is no state of it.
    ValueError
        If a strobe falls into a contact, if `state` does not lie at a strobe, or if `m` is below one.
    NoDerivative
        If the motion grazes the stop, or rests on it.
    """
    require_kind("strobed", strobed, (StroboscopicMap, NordmarkMap), "a strobed oscillator or map")
    require_whole("m", m, "drive periods")
    if isinstance(strobed, NordmarkMap):
        jacobians, _end = strobed.jacobians(state, m)  # type: ignore[arg-type]
        return [(jacobian, np.array([strobed.rho_per_factor, 0.0])) for jacobian, _span in jacobians]
    oscillator = strobed.oscillator
    here, found = require_kind("state", state, State, "a State"), list[tuple[Array, Array]]()
    strobed.orbit(here, 0)  # which refuses a state that is not at a strobe
    change, ones = Change(amplitude=oscillator.driven.amplitude), np.ones(oscillator.n_modes)
    weight = strobed.coordinates(State(displacement=ones, velocity=ones))
    for _ in range(m):
        step = motion_derivatives(oscillator, replace(here, time=0.0), [change], periods=1)
        tangent = weight[:, None] * step.strobes[0]
        found.append((tangent[:, :-1] / weight, tangent[:, -1]))
        here = step.trajectory.end
    return found


def strobe_covariance(
    strobed: Strobed, state: State | Array, m: int, *, deviation: float, memory: float = 0.0
) -> Array:
    """Return the covariance of the strobe points of a stable orbit under noise of the drive amplitude.

    Parameters
    ----------
    strobed : StroboscopicMap or NordmarkMap
        Strobed oscillator or map at the excess of the orbit.
    state : State or ndarray, shape (2,)
        State on the orbit, at a strobe off the stop; a pair (x, y) for a NordmarkMap.
    m : int
        Period of the orbit in drive periods, one or more.
    deviation : float
        Standard deviation sigma of the amplitude, relative to the amplitude [1].
    memory : float, optional
        Correlation r of the noise from one drive period to the next, from 0 to below 1 [1].

    Returns
    -------
    ndarray, shape (m, n_coordinates, n_coordinates)
        Covariances of the points ``strobed.orbit(state, m)``, in the square of their unit.

    Raises
    ------
    TypeError
        If `strobed` is neither a StroboscopicMap nor a NordmarkMap, or `state` is no state of it.
    ValueError
        If `deviation` or `memory` is out of range, or as in `strobe_derivatives`.
    NotPeriodic
        If the state lies on no stable orbit of this period.
    NoDerivative
        If the motion grazes the stop, or rests on it.
    """
    require_within("deviation", deviation, "[1]", low=0)
    require_within("memory", memory, "[1]", low=0)
    require(memory < 1.0, f"memory is {memory} [1]; it must be below 1")
    made = strobe_derivatives(strobed, state, m)
    require_orbit(strobed, state, m)
    steps = [np.block([[m, b[:, None]], [np.zeros((1, b.size)), np.array([[memory]])]]) for m, b in made]
    size = len(steps[0])
    source = np.zeros((size, size))
    source[-1, -1] = (1.0 - memory**2) * deviation**2
    whole = reduce(lambda done, step: step @ done, steps, np.eye(size))
    if not np.max(np.abs(np.linalg.eigvals(whole))) < 1.0:
        raise NotPeriodic(detail="an unstable orbit has no cloud")
    gathered = reduce(lambda c, step: step @ c @ step.T + source, steps, np.zeros((size, size)))

    from scipy.linalg import solve_discrete_lyapunov  # slow to import

    found = [solve_discrete_lyapunov(whole, gathered)]
    for step in steps:
        found.append(step @ found[-1] @ step.T + source)
    return np.array(found)[1:, :-1, :-1]
