"""Modes side by side against modes one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact.compiled import kernel
from contact.flight.modal_flow import U, V, flow, load_state, mode_flow, new_flight
from contact.flight.motion import Motion, motion_of
from contact.laws import NewtonRestitution
from contact.vector_loops import LANES, aligned, next_modes, next_order, weighted_rows


@kernel
def sums_of(weights, top, step, rows, count, out):
    weighted_rows(weights, top, step, rows, count, out)


@kernel
def order_of(numbers, factor, scale, push, lift, n, series):
    return next_order(numbers, factor, scale, push, lift, n, series)


@kernel
def modes_of(numbers, earlier, r0, inverse, r_now, r_force, n, series):
    return next_modes(numbers, earlier, r0, inverse, r_now, r_force, n, series)


@pytest.mark.parametrize("width", [8, 16, 24, 40, 88])
def test_weighted_rows_are_sums_over_rows(width):
    generator = np.random.default_rng(width)
    weights, rows = generator.standard_normal(40), generator.standard_normal((21, width))
    for count in range(22):
        for top, step in ((30, -1), (3, 1)):
            out = np.full(width, np.nan)
            sums_of(weights, top, step, rows, count, out)
            chosen = weights[top + step * np.arange(count)]
            for k in range(width):
                terms = chosen * rows[:count, k]
                assert abs(out[k] - math.fsum(terms)) <= 1e-15 * np.sum(np.abs(terms))


def test_aligned_rows_begin_where_they_should():
    for rows, columns in ((1, 8), (21, 24), (31, 40)):
        array = aligned(rows, columns)
        assert array.shape == (rows, columns) and array.ctypes.data % 64 == 0
        assert not array.any() and array.flags.c_contiguous


def test_next_coefficients_are_those_of_the_recurrences():
    generator = np.random.default_rng(3)
    numbers, m = generator.standard_normal((9, 16)), 16
    c, square, phi, load = numbers[:4]
    series = generator.standard_normal((6, m))
    push, scale = 0.7, 1.0 / 12.0
    fresh = scale * (0.5 * load - c * 3.0 * series[3] - square * series[2] - phi * push)
    total = order_of(numbers, 3.0, scale, push, 0.5, 2, series)
    np.testing.assert_allclose(series[4], fresh, rtol=0, atol=1e-15)
    assert total == pytest.approx(float(phi @ fresh), abs=1e-14)

    series, earlier = generator.standard_normal((6, LANES + 2 * m)), generator.standard_normal(LANES + 2 * m)
    u, v = slice(LANES, LANES + m), slice(LANES + m, LANES + 2 * m)
    r0, inverse, r_now, force = 0.3, 0.25, 0.2, 0.9
    ru, rv = earlier[u] + r0 * series[3, u], earlier[v] + r0 * series[3, v]
    u_next = inverse * rv
    v_next = inverse * (load * r_now - square * ru) - c * u_next - phi * force
    total = modes_of(numbers, earlier, r0, inverse, r_now, force, 3, series)
    np.testing.assert_allclose(series[4, u], u_next, rtol=0, atol=1e-15)
    np.testing.assert_allclose(series[4, v], v_next, rtol=0, atol=2e-15)
    assert total == pytest.approx(float(phi @ v_next), abs=2e-14)


def ladder(n: int, damping: float, load: float = 0.0) -> Motion:
    omega = 154.0 * (2.0 * np.arange(1.0, n + 1.0) - 1.0) ** 2
    omega[0] = 0.0 if load else omega[0]
    decay = damping * omega
    return motion_of(
        omega, decay, np.ones(n), law=NewtonRestitution(local_restitution=0.5), gap=0.01, drive=135.0,
        period=math.tau / 135.0, load=load * (omega == 0),
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
            scale = abs(v[k]) + size[k] * abs(u[k]) + abs(motion.load[k]) * t
            assert abs(room[U, k] - x) * size[k] <= 1e-15 * scale
            assert abs(room[V, k] - y) <= 1e-15 * scale
