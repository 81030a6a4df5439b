r"""A linear contact in extended precision by the eigenvectors of the coupled system.

With y = (u, v/s), s_k a scale of mode k's rates, the contact is y' = A y + w Im(T e^{iwt}) + w level, linear
with constant coefficients, where w acts on the velocities as -phi k. Hence

    y(t) = Im(Y e^{iwt}) + y_0 + V e^{Lambda t} b,
    (i w - A) Y = T w,   A y_0 = -level w,   A V = V Lambda,   V b = y(0) - Im(Y) - y_0.

The release is the first root of the penetration, bracketed in double precision and found by Newton's method.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from studies.instruments.work_precision.extended_flight import (
    WIDER,
    ExtendedSpring,
    Modal,
    NoReference,
    newton_root,
)

__all__ = ["contact_by_eigenvectors"]


def contact_by_eigenvectors(
    spring: ExtendedSpring, deviation: Modal, start: Any, limit: Any
) -> tuple[Any, Modal] | None:
    n, k_stop = spring.size, spring.number
    scale = [max(w, 1 / (1000 * spring.swing)) for w in spring.omega]  # v in these units: a balanced matrix
    system = mp.zeros(2 * n)
    for i in range(n):
        system[i, n + i] = scale[i]
        system[n + i, n + i] = -spring.decay[i]
        for j in range(n):
            stiff = k_stop * spring.phi[i] * spring.phi[j] + (spring.omega[i] ** 2 if i == j else 0)
            system[n + i, j] = -stiff / scale[i]
    # answer to the level and to the steady tip motion: -phi k (level + Im(T e^{iwt}))
    pushes = [-k_stop * phi / s for phi, s in zip(spring.phi, scale, strict=True)]
    weight = mp.matrix([mp.mpf(0)] * n + pushes)
    still = mp.lu_solve(system, -spring.level * weight)
    turn = spring.tip_response * mp.expjpi(spring.drive * start / mp.pi)
    swing = mp.lu_solve(mp.mpc(0, spring.drive) * mp.eye(2 * n) - system, turn * weight)
    rates, vectors = mp.eig(system)
    begin = mp.matrix(
        [u for u in deviation[0]] + [v / s for v, s in zip(deviation[1], scale, strict=True)]
    )
    parts = mp.lu_solve(vectors, begin - still - swing.apply(mp.im))

    def at(t: Any) -> Modal:
        forced = swing * mp.expjpi(spring.drive * t / mp.pi)
        free = vectors * mp.matrix([b * mp.exp(rate * t) for b, rate in zip(parts, rates, strict=True)])
        whole = [(still[i] + forced[i].imag + free[i].real) for i in range(2 * n)]
        return whole[:n], [x * s for x, s in zip(whole[n:], scale, strict=True)]

    def tip(t: Any) -> tuple[Any, Any]:
        return spring.tip(at(t), start + t)

    # the release bracketed in double precision, as a touch is
    fastest = max(abs(rate) for rate in rates)
    count = min(200_000, max(64, int(mp.ceil(16 * fastest * limit))))
    grid = np.linspace(0.0, float(limit), count + 1)[1:]
    mode_tip = np.array([complex(mp.fdot(spring.phi, vectors[:n, j])) for j in range(2 * n)])
    drive_tip = complex(mp.fdot(spring.phi, swing[:n, 0]) + turn)
    depth = float(spring.level + mp.fdot(spring.phi, still[:n, 0])) + np.zeros(count)
    depth += (drive_tip * np.exp(1j * float(spring.drive) * grid)).imag
    for rate, b, weight_tip in zip(rates, parts, mode_tip, strict=True):
        depth += (weight_tip * complex(b) * np.exp(complex(rate) * grid)).real
    below = np.flatnonzero(depth < 0.0)
    if below.size == 0:
        return None
    i = int(below[0])
    if i == 0:
        raise NoReference("a contact is shorter than the sampling of the reference")
    low, high = mp.mpf(grid[i - 1] * (1.0 - WIDER)), mp.mpf(grid[i] * (1.0 + WIDER))
    end = newton_root(tip, low, high, (low + high) / 2)
    return end, at(end)
