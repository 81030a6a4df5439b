"""What a compiled run writes down: impacts, samples, and where it stands.

A run is carried from call to call by two small arrays: `integers` (regime, number of derivatives that vanish
at the start of the flight, rows logged, samples taken, impacts in this period, flights and contact steps so
far, and how crossings are looked for: 0 certified, else samples per period) and `floats` (time since the
strobe [s], approach velocity of the contact under way [m/s], energy that it has lost [J], time that it still
waits [s] and velocity with which it then leaves [m/s]).  A row of the log
holds period and time of the first touch, period and time of the release, both tip velocities, the energy lost
and the kind (``trajectory.ImpactKind``); `log_state` the deviations (u, v) at both ends.
"""

from __future__ import annotations

import math

from contact.certificate import polynomial_root
from contact.compiled import kernel
from contact.flight import propagate, tip_steady
from contact.hertz_lanes import CLOCK as CLOCK_SERIES
from contact.hertz_lanes import lane_state
from contact.linear_lanes import linear_state
from contact.trajectory import ImpactKind

REGIME, ORDER, LOGGED, SAMPLED, COUNT, EVALUATIONS, SEARCH = 0, 1, 2, 3, 4, 5, 6
INTEGERS = 7
CLOCK, APPROACH, LOSS, WAIT, REBOUND = 0, 1, 2, 3, 4
LOG_FIELDS = 8
START_PERIOD, START, END_PERIOD, END, IN, OUT, LOST, KIND = 0, 1, 2, 3, 4, 5, 6, 7
IMPACT, GRAZE, STAY = map(int, ImpactKind)
"""The kinds as kernels write them, plain integers."""


@kernel
def sample_flight(
    motion, u, v, base, until, period_index, integers, sample_period, sample_clock, samples, su, sv
):
    """States at the sample times of a free flight from (u, v) at `base` that lasts `until` (both since the
    strobe)."""
    n = motion.omega.size
    i = integers[SAMPLED]
    while i < sample_clock.size and sample_period[i] == period_index and sample_clock[i] <= until:
        propagate(motion, u, v, sample_clock[i] - base, su, sv)
        for k in range(n):
            samples[i, k] = su[k]
            samples[i, n + k] = sv[k]
        i += 1
    integers[SAMPLED] = i


@kernel
def sample_linear(
    series, sums, scalars, base, until, period_index, integers, sample_period, sample_clock, samples, su, sv
):
    """States at the sample times of a contact step from `base` that lasts `until` (both since the strobe)."""
    n = su.size
    i = integers[SAMPLED]
    while i < sample_clock.size and sample_period[i] == period_index and sample_clock[i] <= until:
        linear_state(sample_clock[i] - base, series, sums, scalars, su, sv)
        for k in range(n):
            samples[i, k] = su[k]
            samples[i, n + k] = sv[k]
        i += 1
    integers[SAMPLED] = i


@kernel
def sample_hertz(
    series, sums, scalars, base, until, end, period_index, integers, sample_period, sample_clock, samples,
    late, su, sv,
):
    """States at the sample times of a step under Hertz's law that ends at sigma = `end`, time `until`."""
    n = su.size
    i = integers[SAMPLED]
    while i < sample_clock.size and sample_period[i] == period_index and sample_clock[i] <= until:
        s = 0.0
        if sample_clock[i] > base:
            for j in range(late.size):
                late[j] = scalars[CLOCK_SERIES, j]
            late[0] = base - sample_clock[i]
            s = polynomial_root(late, 0.0, end)
        lane_state(s, series, sums, scalars, su, sv)
        for k in range(n):
            samples[i, k] = su[k]
            samples[i, n + k] = sv[k]
        i += 1
    integers[SAMPLED] = i


@kernel
def sample_waiting(motion, until, period_index, integers, sample_period, sample_clock, samples):
    """States at the sample times of a single mode that is held on the wall until `until` (since the
    strobe)."""
    i = integers[SAMPLED]
    while i < sample_clock.size and sample_period[i] == period_index and sample_clock[i] <= until:
        height, velocity, _acceleration = tip_steady(motion, sample_clock[i])
        samples[i, 0] = -height / motion.phi[0]
        samples[i, 1] = -velocity / motion.phi[0]
        i += 1
    integers[SAMPLED] = i


@kernel
def open_row(log, log_state, integers, floats, period_index, base, approach, kind, u, v):
    """Start a row of the impact log."""
    integers[COUNT] += 1 if kind == IMPACT else 0
    floats[APPROACH] = approach
    floats[LOSS] = 0.0
    i = integers[LOGGED]
    integers[LOGGED] += 1
    if log.shape[0] == 0:
        return
    n = u.size
    log[i, START_PERIOD] = period_index
    log[i, START] = base
    log[i, END_PERIOD] = period_index
    log[i, END] = math.nan
    log[i, IN] = approach
    log[i, OUT] = math.nan
    log[i, LOST] = math.nan
    log[i, KIND] = kind
    for k in range(n):
        log_state[i, k] = u[k]
        log_state[i, n + k] = v[k]
        log_state[i, 2 * n + k] = math.nan
        log_state[i, 3 * n + k] = math.nan


@kernel
def close_row(log, log_state, integers, floats, period_index, base, rebound, u, v):
    """Complete the last row of the impact log."""
    if log.shape[0] == 0:
        return
    i = integers[LOGGED] - 1
    n = u.size
    log[i, END_PERIOD] = period_index
    log[i, END] = base
    log[i, OUT] = rebound
    log[i, LOST] = floats[LOSS]
    for k in range(n):
        log_state[i, 2 * n + k] = u[k]
        log_state[i, 3 * n + k] = v[k]


