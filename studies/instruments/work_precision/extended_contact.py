r"""Contacts in extended precision, each law by two routes that share nothing but the equation of motion.

In deviations (u, v) from the steady motion, with the penetration d = sum phi u + x_s(t) - gap,

    u_k' = v_k,   v_k' = -c_k v_k - omega_k^2 u_k - phi_k N(d).

Linear contact, N = k d
    first    eigenvectors of the coupled system (`extended_eigenvectors`): d(t) is a sum of exponentials
    second   Taylor series in t, steps put one after another until d < 0

Hertz, N = k d^(3/2)
    first    Taylor series in t, where w = d^(3/2) follows from  d w' = (3/2) d' w:
             n d_0 w_n = sum_{j=1}^{n} (3j/2 - (n - j)) d_j w_{n-j}.  Touch and release are singular, so the
             steps shrink with the distance to them, and the contact is entered and left by free flights below
             the depth `SHALLOW` of the greatest, where the neglected impulse is SHALLOW^(5/2) of the whole
    second   the variable sigma, dt = r dsigma with r = sqrt(d), in which nothing is singular

Every series ends where its last terms lie below the working precision.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from mpmath import mp

from contact.laws import HERTZ
from studies.instruments.work_precision.extended_eigenvectors import contact_by_eigenvectors
from studies.instruments.work_precision.extended_flight import (
    WIDER,
    ExtendedSpring,
    Modal,
    NoReference,
    newton_root,
)
from studies.instruments.work_precision.extended_series import Series, horner, order_for_digits, reach, slope

__all__ = ["contact"]

SHALLOW = "1e-10"
"""Depth, in units of the greatest, below which Hertz's force is left out by the first route: 1e-25 of the
impulse."""

MOST_STEPS = 4000
"""Bound of series steps in one contact: Hertz's first route takes 200, a linear one two for each swing of the
fastest mode."""

def contact(spring: ExtendedSpring, deviation: Modal, start: Any, limit: Any) -> tuple[Any, Modal] | None:
    """Duration of the contact that begins with `deviation` at drive time `start`, and the end's deviations.

    None if it lasts beyond `limit`.
    """
    if spring.law == HERTZ:
        if spring.second:
            return _contact_in_sigma(spring, deviation, start, limit)
        shallow = _shallow(spring, deviation, start)
        return _contact_in_time(spring, deviation, start, limit, _hertz_force, shallow)
    if spring.second:
        return _contact_in_time(spring, deviation, start, limit, _linear_force, None)
    return contact_by_eigenvectors(spring, deviation, start, limit)


# --------------------------------------------------------------------------------------- series in time


def _linear_force(spring: ExtendedSpring, depth: Series, force: Series) -> Any:
    return spring.number * depth[-1]


def _hertz_force(spring: ExtendedSpring, depth: Series, force: Series) -> Any:
    n = len(depth) - 1
    if n == 0:
        return spring.number * depth[0] * mp.sqrt(depth[0])
    weights = [(5 * j - 2 * n) * depth[j] for j in range(1, n + 1)]
    return mp.fdot(weights, force[::-1]) / (2 * n * depth[0])


Force = Callable[[ExtendedSpring, Series, Series], Any]


def _time_series(
    spring: ExtendedSpring, deviation: Modal, t: Any, force_term: Force
) -> tuple[list[Series], list[Series], Series, Series]:
    """Taylor coefficients of u and v of all modes, of the penetration and of the force at drive time `t`."""
    order = order_for_digits()
    us, vs = [[x] for x in deviation[0]], [[x] for x in deviation[1]]
    turn = spring.tip_response * mp.expjpi(spring.drive * t / mp.pi)
    depth: Series = []
    force: Series = []
    for n in range(order):
        steady = turn.imag + (spring.level if n == 0 else 0)
        depth.append(steady + mp.fsum(spring.phi[k] * us[k][n] for k in range(spring.size)))
        force.append(force_term(spring, depth, force))
        for k in range(spring.size):
            pull = spring.decay[k] * vs[k][n] + spring.omega[k] ** 2 * us[k][n] + spring.phi[k] * force[n]
            us[k].append(vs[k][n] / (n + 1))
            vs[k].append(-pull / (n + 1))
        turn *= mp.mpc(0, spring.drive) / (n + 1)
    return us, vs, depth, force


def _shallow(spring: ExtendedSpring, deviation: Modal, start: Any) -> Any:
    """Depth below which the force is left out [m]."""
    _depth, speed = spring.tip(deviation, start)
    greatest = (mp.mpf(5) / 4 * spring.mass * speed**2 / spring.number) ** mp.mpf("0.4")
    return mp.mpf(SHALLOW) * greatest


def _contact_in_time(
    spring: ExtendedSpring, deviation: Modal, start: Any, limit: Any, force_term: Force, shallow: Any
) -> tuple[Any, Modal] | None:
    clock = mp.mpf(0)
    _depth, speed = spring.tip(deviation, start)
    fastest = max([w for w in spring.omega if w > 0], default=mp.mpf(0))
    # a third of a radian of the fastest frequency in contact: no root of the depth lies between two samples
    short = 1 / (3 * mp.sqrt(spring.number / spring.mass + fastest**2)) if shallow is None else mp.inf
    if shallow is not None:
        clock = shallow / speed
        deviation = spring.fly(deviation, clock)
    for _ in range(MOST_STEPS):
        us, vs, depth, force = _time_series(spring, deviation, start + clock, force_term)
        rush = max(abs(row[0]) for row in vs)
        h = min(reach(row, rush) for row in vs)
        if shallow is not None:
            h = min(h, reach(depth, depth[0]), reach(force, force[0]))
        released = False
        if shallow is None:
            grid = np.linspace(0.0, float(h), int(h / short) + 2)[1:]
            below = np.flatnonzero(np.polyval([float(x) for x in depth[::-1]], grid) < 0.0)
            if below.size:
                high = mp.mpf(grid[below[0]] * (1.0 + WIDER))
                low = mp.mpf(grid[below[0] - 1] * (1.0 - WIDER)) if below[0] else mp.mpf(0)
                if clock == 0 and low == 0:
                    low = high / 64  # past the touch itself
                h = newton_root(lambda t, row=depth: (horner(row, t), slope(row, t)), low, high, high)
                released = True
        deviation = [horner(row, h) for row in us], [horner(row, h) for row in vs]
        clock += h
        if clock > limit:
            return None
        if released:
            return clock, deviation
        here, rate = spring.tip(deviation, start + clock)
        if shallow is not None and rate < 0 and here < shallow:
            def free(t: Any, base: Modal = deviation, at: Any = clock) -> tuple[Any, Any]:
                return spring.tip(spring.fly(base, t), start + at + t)

            rest = newton_root(free, mp.mpf(0), -2 * here / rate, -here / rate, spring.swing)
            return clock + rest, spring.fly(deviation, rest)
    raise NoReference(f"a contact took more than {MOST_STEPS} steps of the series")


# ---------------------------------------------------------------------------------------- sigma, Hertz


def _sigma_series(
    spring: ExtendedSpring, deviation: Modal, root: Any, t: Any
) -> tuple[list[Series], list[Series], Series, Series]:
    """Taylor coefficients in sigma of u, v, r and the time, for r = `root` at drive time `t`."""
    order, n_modes = order_for_digits(), spring.size
    us, vs = [[x] for x in deviation[0]], [[x] for x in deviation[1]]
    r: Series = [root]
    clock: Series = [mp.mpf(0)]
    turn: Series = [mp.expjpi(spring.drive * t / mp.pi)]
    square: Series = []
    cube: Series = []
    for n in range(order):
        back = r[::-1]
        square.append(mp.fdot(r, back))
        cube.append(mp.fdot(square, back))
        push = spring.number * mp.fdot(cube, back)  # coefficient of r N
        rate = spring.drive * (spring.tip_response * turn[n]).real
        rate += mp.fsum(spring.phi[k] * vs[k][n] for k in range(n_modes))
        for k in range(n_modes):
            ru, rv = mp.fdot(us[k], back), mp.fdot(vs[k], back)
            us[k].append(rv / (n + 1))
            vs[k].append(-(spring.decay[k] * rv + spring.omega[k] ** 2 * ru + spring.phi[k] * push) / (n + 1))
        clock.append(r[n] / (n + 1))
        turn.append(mp.mpc(0, spring.drive) * mp.fdot(turn, back) / (n + 1))
        r.append(rate / (2 * (n + 1)))
    return us, vs, r, clock


def _contact_in_sigma(
    spring: ExtendedSpring, deviation: Modal, start: Any, limit: Any
) -> tuple[Any, Modal] | None:
    clock, root = mp.mpf(0), mp.mpf(0)
    wide = mp.sqrt(_shallow(spring, deviation, start) / mp.mpf(SHALLOW))
    for _ in range(MOST_STEPS):
        us, vs, r, time = _sigma_series(spring, deviation, root, start + clock)
        rush = max(abs(row[0]) for row in vs)
        s = min(reach(r, wide), *(reach(row, rush) for row in vs))
        released = horner(r, s) <= 0
        if released:
            low = s / 1024 if root == 0 else mp.mpf(0)
            s = newton_root(lambda x, row=r: (horner(row, x), slope(row, x)), low, s, s)
        deviation = [horner(row, s) for row in us], [horner(row, s) for row in vs]
        clock, root = clock + horner(time, s), horner(r, s)
        if clock > limit:
            return None
        if released:
            return clock, deviation
    raise NoReference(f"a contact took more than {MOST_STEPS} steps of the series")


