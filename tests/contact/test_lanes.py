"""Modes side by side against modes one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact.flight.modal_flow import U, V, flow, load_state, mode_flow, new_flight
from contact.flight.motion import LOAD, Motion, motion_of
from contact.laws import NewtonRestitution


def ladder(n: int, damping: float, load: float = 0.0) -> Motion:
    omega = 154.0 * (2.0 * np.arange(1.0, n + 1.0) - 1.0) ** 2
    omega[0] = 0.0 if load else omega[0]
    decay = damping * omega
    return motion_of(
        omega,
        decay,
        np.ones(n),
        law=NewtonRestitution(local_restitution=0.5),
        gap=0.01,
        drive=135.0,
        period=math.tau / 135.0,
        load=load * (omega == 0),
    )


@pytest.mark.parametrize("modes", [1, 7, 8, 20])
@pytest.mark.parametrize(
    "damping, load, longest", [(0.01, 0.0, 0.1), (0.0, 0.0, 2e3), (2.5, 0.0, 0.1), (0.01, 3.0, 0.1)]
)
def test_modes_carried_side_by_side_are_those_carried_one_by_one(modes, damping, load, longest):
    """Also where they are not carried side by side: over-damped or loaded modes, phases beyond 5e5."""
    motion, generator = ladder(modes, damping, load), np.random.default_rng(modes)
    room = new_flight(motion)
    size = np.maximum(motion.omega, 1.0)
    u, v = generator.standard_normal(modes) / size, generator.standard_normal(modes)
    load_state(room, u, v)
    for t in longest * 10 ** generator.uniform(-6, 0, 40):
        flow(motion, room, 0, room.shape[1], t)
        for k in range(modes):
            x, y = mode_flow(motion.modes, k, u[k], v[k], t)
            scale = abs(v[k]) + size[k] * abs(u[k]) + abs(motion.row(LOAD)[k]) * t
            assert abs(room[U, k] - x) * size[k] <= 1e-15 * scale
            assert abs(room[V, k] - y) <= 1e-15 * scale
