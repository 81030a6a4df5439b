"""The first crossing of the stop by the letter's search: at a few instants of each drive period.

The letter (1996, note [11]) computes the exact position at t_j = j / (k f), k times in each drive period.  It
detects a crossing where a sampled position is beyond the stop, and at the turning points of the motion, where
the sampled velocities change from rising to falling.  A flight that begins in between starts with a shorter
interval.  What the search misses: ``docs/theory/crossing.md``.
"""

import math
from typing import NamedTuple

import numpy as np

from contact.flight import modal_flow as rows
from contact.flight.crossing import CROSSES, FREE
from contact.flight.modal_flow import apply_flow, flow_over, propagate_flight
from contact.flight.numbers import Numbers
from contact.flight.tip import tip_rounding, tip_state
from contact.flight.tip_search import find_peak, root_between, tip_now
from contact.machine.compiled import kernel

ALIGNED = 1e-9
"""Largest difference of an interval from the spacing, over the spacing, for which the flow over the spacing
is used: the samples serve to detect, not to locate."""


class Samples(NamedTuple):
    """Instants at which the motion is looked at, and the way from one to the next."""

    spacing: float  # time between them [s]
    flows: np.ndarray  # flow over this time, shape (n_modes, 6)


def samples_of(numbers: Numbers, points: int) -> Samples:
    """Samples at so many `points` of each drive period."""
    spacing = numbers.period / points
    return Samples(spacing, flow_over(numbers, spacing))


@kernel
def first_sampled_crossing(numbers, flight, base, duration, contact_order, samples):
    """First crossing of a free flight that `samples` detect; see ``contact.flight.crossing.first_crossing``.

    Returns FREE or CROSSES, the time since the start of the flight [s], and the number of positions computed.
    """
    (spacing, flows), n, count = samples, numbers.size, 0
    u, v = flight[rows.START_U, :n], flight[rows.START_V, :n]
    margin = tip_rounding(numbers, u, v)
    height, rate, _acceleration = tip_state(numbers, base, u, v)
    if contact_order == 0 and height >= -margin and rate > 0.0:
        return CROSSES, 0.0, count
    su, sv, s, j = u.copy(), v.copy(), 0.0, int(base / spacing)
    while s < duration:
        j += 1
        until = min(j * spacing - base, duration)
        if until - s <= ALIGNED * spacing and until < duration:
            continue
        count += 1
        if abs(until - s - spacing) <= ALIGNED * spacing:
            apply_flow(flows, su, sv)
        else:
            propagate_flight(numbers, flight, until, su, sv)
        height, new_rate, _acceleration = tip_state(numbers, base + until, su, sv)
        if height > margin:
            return CROSSES, root_between(numbers, flight, base, s, until, margin), count
        if rate > 0.0 and new_rate < 0.0:
            middle = 0.5 * (s + until)
            point = (middle, *tip_now(numbers, flight, base, middle))
            peak = find_peak(numbers, flight, base, point, (s, until), math.inf, margin)
            count += 1
            if tip_now(numbers, flight, base, peak)[0] > margin:
                return CROSSES, root_between(numbers, flight, base, s, peak, margin), count
        s, rate = until, new_rate
    return FREE, duration, count
