"""A rebound that waits: the tip stays on the wall for a time, then leaves (``DelayedRestitution``, one mode).

The touch is at time t with approach velocity v = y'(t) > 0; tau and delta are the law's restitution and delay
at this speed, sampled in a table with their slopes.  At t + delta the tip, y = phi u + a S + b C + level, has

    y = 0,      y' = -tau(v) v,

while the drive (S, C) has turned by w delta.  The deviations (u, u') on the wall (regime WAITING) and after
it are linear in the drive; of the motion before the touch only v matters.

**Tangents.** Let a neighbour stand `height` higher at t and move faster by `rate`.  It touches later by
dt = -height/v, hits the stop faster by dv = rate + y''(t) dt, and leaves it later by d = dt + delta' dv.  At
t + delta its tip therefore differs by

    height -> tau v d,      rate -> -(tau + tau' v) dv - y''(t + delta) d,

the saltation matrix of this law, of determinant tau (tau + tau' v).  Without delay and slopes it is that of
Newton's law.

**Orbits.** One touch in m drive periods has a closed form.  With (p, r) the steady tip displacement and
velocity at the touch, R their turn by the angle w delta and N the free flow over m/f - delta, the tip leaves
with the deviation (gap, -tau v) - R (p, r) and comes back with (gap, v) - (p, r):

    (I - N R) (p, r) = (gap, v) - N (gap, -tau v),      A(v)^2 = p^2 + (r/(2 pi f))^2.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from beam.parameters import final, record, require, require_within
from contact.errors import NotPeriodic
from contact.flight.modal_flow import free_flow
from contact.flight.numbers import COSINE, DECAY, LOAD, SQUARE, WEIGHT
from contact.flight.tip import hold, push_on, tip_state, tip_steady
from contact.flight.variation import NUMBER0, NUMBER1, all_tip_changes, tangent_flight
from contact.laws import ContactLaw
from contact.machine.compiled import kernel, part
from contact.speed_table import SPEEDS, SpeedFunction, at_speed, raised, require_speeds, sampled
from contact.state import OUTSIDE, WAITING
from contact.touch import newton

DELAYED = 3  # the code of this law


@final
@record
class DelayedRestitution(ContactLaw):
    """Delayed impact: the tip waits on the wall, then leaves with -`restitution` times its approach velocity.

    The law holds for one mode only, where two numbers describe the whole effect of a collision.

    Parameters
    ----------
    restitution : float or callable
        Restitution from 0 to 1 [1], or a function that returns it for an approach speed [m/s].
    delay : float or callable
        Time on the wall, zero or more [s], or a function that returns it for an approach speed [m/s].
    speeds : (float, float)
        Range of approach speeds in which functions are sampled; beyond it they keep their end values [m/s].

    Raises
    ------
    ValueError
        If a restitution lies outside 0 to 1, a delay is negative or not finite, or `speeds` do not rise.
    TypeError
        If a restitution or a delay is neither a number nor a function that returns one.

    Notes
    -----
    The tip keeps waiting whatever force pulls at it.  Let v be its approach speed, and a its deceleration at
    the touch.  Without the wall the tip would be back after the time ``2 * v / a``.  A longer wait holds the
    tip against the pull and adds energy to the motion.  Orbits of period 1 then appear far below grazing, and
    are stable if the wait is long (``tests/contact/test_delayed_orbits.py``).

    Under a constant delay this happens in every touch slower than ``a * delay / 2``, and a touch of vanishing
    speed is no graze.  A delay that falls at least as fast as the speed has no such touches.
    """

    restitution: float | SpeedFunction
    delay: float | SpeedFunction
    speeds: tuple[float, float] = (1e-5, 10.0)
    code: ClassVar[int] = DELAYED
    one_mode_only: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_speeds(self.speeds)
        for name, unit, high in (("restitution", "[1]", 1.0), ("delay", "s", None)):
            if not callable(getattr(self, name)):
                require_within(name, getattr(self, name), unit, low=0, high=high)
        _v, tau, _slope, delay, _slope2 = self.table
        words = f"restitution runs from {tau.min()} to {tau.max()}; it must lie between 0 and 1"
        require(bool(np.all((tau >= 0) & (tau <= 1))), words)
        words = f"delay runs from {delay.min()} to {delay.max()} s; it must be finite and zero or more"
        require(bool(np.all(np.isfinite(delay) & (delay >= 0))), words)

    @property
    def adjustable(self) -> tuple[float, float]:
        """Restitution [1] and delay [s]; of functions of the speed, their values at the lowest speed."""
        return float(self.table[1, 0]), float(self.table[3, 0])

    @cached_property
    def table(self) -> np.ndarray:
        """Rows: speed, restitution and its slope, delay and its slope; shape (5, n)."""
        count = SPEEDS if callable(self.restitution) or callable(self.delay) else 2
        speed = np.geomspace(*self.speeds, count)
        restitution = sampled("restitution", self.restitution, speed)
        return np.array([speed, *restitution, *sampled("delay", self.delay, speed)])

    def moved(self, first: float, second: float) -> DelayedRestitution:
        """The law with restitution and delay moved by so much at every speed."""
        return replace(self, restitution=raised(self.restitution, first), delay=raised(self.delay, second))


LAW, METHOD = "DelayedRestitution", "event-driven"
REGIMES = (OUTSIDE, WAITING)

force, stiffness, slopes = newton.force, newton.stiffness, newton.slopes

RESTITUTION, DELAY = 1, 3  # rows of the table, each followed by its slope; row 0 holds the approach speeds
SINGULAR = 1e-13  # a smaller determinant of I - N R is rounding of terms of size 1: the mode is back


@kernel
def numbers_at(table, speed):
    """Restitution [1], its slope [s/m], delay [s] and its slope [s^2/m] at an approach speed [m/s]."""
    restitution, restitution_slope = at_speed(table, RESTITUTION, speed)
    delay, delay_slope = at_speed(table, DELAY, speed)
    return restitution, restitution_slope, delay, delay_slope


@kernel
def strike(numbers, run, u, v, approach):
    """The touch: how long the tip will wait, and with which velocity it will leave."""
    restitution, _slope, run.wait, _slope = numbers_at(numbers.table, approach)
    run.rebound = -restitution * approach
    impulse = approach / numbers.inverse_mass
    return WAITING, run.rebound, 0.5 * approach * impulse, impulse


@part
def step(numbers, run, u, v, limit, series):
    """The wait, at most `limit` [s]; see ``contact.touch``."""
    h = min(run.wait, limit)
    run.wait -= h
    return h, h, WAITING if run.wait > 0.0 else OUTSIDE


@part
def state(numbers, run, h, series, u, v):
    """The deviation a time `h` [s] into the wait."""
    u[0], v[0] = 0.0, 0.0
    hold(numbers, run.clock + h, u, v)


@part
def height_over(numbers, run, weight, own, series, out):
    """No series: the only mode stands still."""
    return 0


@kernel
def exchange(numbers, run, span, series, known):
    """The impulse that holds the tip against spring and drive, and at the end the impulse of the rebound.

    In the wait phi u = -s, s the steady tip displacement past the stop, so that N phi^2 = s'' + c s' +
    omega^2 s + phi g.  Its integral has a closed form.  The instants of touch and rebound have no largest
    force.
    """
    w, modes, length = numbers.drive, numbers.modes, span[1]
    height, rate, _pull = tip_steady(numbers, run.clock)
    height_end, rate_end, _pull = tip_steady(numbers, run.clock + length)
    area = numbers.level * length - (rate_end - rate) / (w * w) if w > 0.0 else height * length
    pull = rate_end - rate + modes[DECAY, 0] * (height_end - height) + modes[SQUARE, 0] * area
    pull += modes[WEIGHT, 0] * modes[LOAD, 0] * length
    if run.wait > 0.0:
        return 0.0, pull / numbers.inverse_mass, math.nan
    return -0.5 * run.rebound**2 / numbers.inverse_mass, (pull - run.rebound) / numbers.inverse_mass, math.nan


@part
def leave(numbers, run, u, v):
    """The rebound."""
    newton.newton_impact(numbers, v, -run.rebound, 0.0)
    run.contact_order = 1 if run.rebound < 0.0 else 2
    return run.rebound


@kernel
def saltation(numbers, vary, before, after, tangent):
    """The effect of touch and wait on the tangents."""
    share = push_on(numbers, 0, -1.0 / numbers.inverse_mass)  # 1/phi: the mode per tip
    clock, u, v = before
    _height, approach, pull_in = tip_state(numbers, clock, u, v)
    restitution, restitution_slope, delay, delay_slope = numbers_at(numbers.table, approach)
    _height, _velocity, pull_out = tip_state(numbers, after[0], after[1], after[2])
    height, rate = all_tip_changes(vary, tangent, u, v, clock)
    first = height.size - len(vary.scalars)
    for j in range(height.size):
        late = -height[j] / approach
        faster = rate[j] + pull_in * late
        late += delay_slope * faster
        slower = -(restitution + restitution_slope * approach) * faster
        if j >= first:
            late += vary.scalars[j - first, NUMBER1]
            slower -= vary.scalars[j - first, NUMBER0] * approach
        height[j], rate[j] = restitution * approach * late, slower - pull_out * late
    # only the drive keeps its tangents over the wait; the mode follows from height and rate of the tip
    tangent_flight(vary, tangent, np.zeros(1), np.zeros(1), clock, delay)
    tangent[:2] = 0.0
    own = all_tip_changes(vary, tangent, after[1], after[2], after[0])
    for j in range(height.size):
        tangent[0, j], tangent[1, j] = share * (height[j] - own[0][j]), share * (rate[j] - own[1][j])


@kernel
def inside(numbers, vary, now, length, tangent):
    """The tip has waited at the stop for a time `length` [s], and the drive has gone on."""
    clock, u, v = now
    share = push_on(numbers, 0, 1.0 / numbers.inverse_mass)
    tangent_flight(vary, tangent, u, v, clock - length, length)
    tangent[:2] = 0.0
    height, rate = all_tip_changes(vary, tangent, u, v, clock)
    tangent[0], tangent[1] = share * height, share * rate


def acceleration(numbers, free, q, rate):
    """During the wait the mode stands still, so that its deviation follows the drive."""
    return numbers.drive**2 * numbers.row(COSINE)


def repeated_touch(numbers, speed, m):
    """The touch with approach `speed` [m/s] that repeats after `m` drive periods.

    Returns the jumps of the mode and its velocity, referred to the touch by the free flow, shape (1, 2), the
    length of the wait [s], and whether the tip leaves with a velocity.  NotPeriodic is raised if the wait
    takes up the m periods, or the mode is back after them.
    """
    gap = numbers.gap
    restitution, _slope, delay, _slope = numbers_at(numbers.table, speed)
    left = m * numbers.period - delay
    w, angle = numbers.drive, numbers.drive * delay
    turn = np.array([[np.cos(angle), np.sin(angle) / w], [-w * np.sin(angle), np.cos(angle)]])
    before, after = np.array([gap, speed]), np.array([gap, -restitution * speed])
    flow = free_flow(numbers, max(left, 0.0))[0]
    back = np.eye(2) - flow @ turn
    if left <= 0.0 or abs(np.linalg.det(back)) <= SINGULAR:
        detail = f"no orbit of period {m} has a touch that waits for {delay:g} s"
        raise NotPeriodic(time=delay, velocity=speed, detail=detail)
    steady = np.linalg.solve(back, before - flow @ after)
    met, left_with = before - steady, after - turn @ steady
    jump = free_flow(numbers, -delay)[0] @ left_with - met
    return numbers.least_change(jump), float(delay), restitution > 0.0
