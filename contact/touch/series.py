"""What the power series of all contact laws share: their room, and how far they reach.

While the tip is in contact all modes are coupled through one number, the contact force N:

    u_k'' = -c_k u_k' - omega_k^2 u_k + g_k - phi_k N(d, d'),   d(t) = sum_k phi_k u_k + x_s(t) - gap.

The coefficients of a series follow from each other at a cost proportional to the number of modes, without
eigenvectors and so without their ill-conditioning for repeated or critically damped ones.  A step is as long
as the last terms stay below rounding, so that only rounding error remains.

A law may leave out orders: under N = k d^3 a free mass has but every fourth.  Modes of their own fill every
second order at least, and the force moves all of them by the one series N, so that the last orders of N tell
when the last two orders of the modes say too little: each order n estimates the radius of convergence by the
root test, R_n = (A/|x_n|)^(1/n), and a step of R tol^(1/p) leaves terms of tol A at the order p.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.machine.compiled import inlined, kernel, part
from contact.machine.vector_loops import aligned, weighted_rows
from contact.trajectory import CONTACT

WINDOW = 8
"""Orders of the force that are looked at."""

LOOSE = 1.15
"""How much longer than by an earlier order of the force a step may be: no two orders agree better."""


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
NODE_POWERS = (0.5 * (1.0 + _NODES)) ** np.arange(31.0)[:, None]
WEIGHTS = 0.5 * _WEIGHTS
"""Gauss's rule on [0, 1], and powers of its nodes up to the highest order of a series.  For a product that
turns by some six radians in a step its error is below 1e-20; under series that converge up to R and a step s
it falls as rho^-32, rho = q + sqrt(q^2 - 1), q = 2 R/s - 1: faster than the (s/R)^p of the series."""


class Series(NamedTuple):
    """Room for one step of a contact.

    rows : ndarray, shape (order + 1, columns)
        Coefficients of the modes, row n holding order n.
    sums : ndarray, shape (columns,)
    scalars : ndarray, shape (8, order + 1)
        Series of single numbers, named where they are filled.
    """

    rows: np.ndarray
    sums: np.ndarray
    scalars: np.ndarray


@kernel
def new_series(order, columns):
    """Room for a series, of zeros."""
    return Series(aligned(order + 1, columns), aligned(1, columns)[0], np.zeros((8, order + 1)))


@part
def enter(motion, run, u, v, approach):
    """A touch under a force law: the contact begins at d = 0.  Returns as ``contact.touch`` says."""
    run.root, run.speed = 0.0, -1.0
    return CONTACT, math.nan, 0.0


@part
def leave(motion, run, u, v):
    """The end of a contact that pushed: the next flight starts on the wall."""
    run.order = 1


@part
def saltation(motion, vary, before, after, tangent):
    """Nothing: the tangents have gone through the contact with its series."""


@part
def powers_of(s, out):
    """Fill `out` with 1, s, s^2, ..."""
    power = 1.0
    for n in range(out.size):
        out[n] = power
        power *= s


@kernel
def work_of(series, force, rate, s):
    """The integral of a force times a rate, series both, over a step up to `s`; uses the last two rows."""
    terms, nodes, power, done = force.size, WEIGHTS.size, 1.0, 0.0
    pushes, rates, push, speed = series.scalars[6], series.scalars[7], np.empty(nodes), np.empty(nodes)
    for n in range(terms):
        pushes[n], rates[n] = power * force[n], power * rate[n]
        power *= s
    weighted_rows(pushes, 0, 1, NODE_POWERS, terms, push)
    weighted_rows(rates, 0, 1, NODE_POWERS, terms, speed)
    for i in range(nodes):
        done += WEIGHTS[i] * s * push[i] * speed[i]
    return done


@kernel
def reach(last, order, allowed):
    """Logarithm of the s at which `last` s^`order` reaches `allowed`; of infinity if it never does."""
    return (math.log(allowed) - math.log(last)) / order if last > 0.0 else math.inf


@inlined
def within_force(s, push, last, mobility, speed, edge):
    """The step `s`, or a shorter one if the force says that the last two orders of the modes miss something.

    Parameters
    ----------
    s : float
        By the last two orders of the modes; infinite if these are zero.
    push : ndarray
        Series of the force on the modes; phi_k push_n, over n + 1, enters the order n + 1 of the speeds.
    last : int
        Order up to which it is filled.
    mobility, speed : float
        sqrt of the compliance, the size of all phi_k, and that of the speeds.
    edge : float
        Tolerance to the power of one over the order of the series.
    """
    x, first = s / (LOOSE * edge), last - WINDOW + 1
    power, fits = mobility * x**first, True
    for n in range(first, last + 1):
        power *= x
        fits = fits and abs(push[n]) * power <= speed * (n + 1)
    if fits:
        return s
    for n in range(first, last + 1):
        if push[n] != 0.0:
            s = min(s, edge * (speed * (n + 1) / (mobility * abs(push[n]))) ** (1.0 / (n + 1)))
    return s
