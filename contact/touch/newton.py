"""Newton's impact law for any number of modes, where its impacts accumulate, and the rest on the wall.

The impulse of the stop acts on the tip alone, so that the modal velocities jump by

    v_k -> v_k - phi_k (1 + e) x' / sum_j phi_j^2,

which sends the tip velocity x' to -e x' (``NewtonRestitution``).  If e depends on x', low hops have its value
at the lowest speed.  Let an impact leave the tip with velocity -w while it is accelerated towards the wall
with a_0 + j t, a_0 > 0, and modal damping takes b w off a speed w in a unit of time.  Its hops end after

    T = W (1 - (j + a_0 b/2) W/(3 a_0)),      W = 2 w/(a_0 (1 - e)),

to first order in j and b.  Derivation: ``docs/theory/laws.md``.  In a free flight |a - a_0| <= J T, J the
bound of the jerk; the push of the wall on the modes adds to a.  With J W << a, the hops end before the pull
does.  Hops so low that rounding decides over them then change into a stay at once.  The impulse that takes
the speed w off takes the energy w^2/(2 sum phi^2), which the hops would lose together.

In a stay (regime SUSTAINED) the tip is held by the force that makes d'' = 0, until that force would pull; the
series is that of ``contact.touch.time_series``.
"""

import math

from contact.flight.elementary import EPS
from contact.flight.modal_flow import mode_acceleration
from contact.flight.numbers import DECAY, LOAD, SQUARE, WEIGHT
from contact.flight.polynomial_root import first_polynomial_root
from contact.flight.tip import hold, jerk_bound, push_on, tip_rounding, tip_state, tip_steady, tip_sum
from contact.flight.variation import NUMBER0, all_tip_changes
from contact.machine.compiled import kernel, part
from contact.speed_table import at_speed
from contact.state import OUTSIDE, SUSTAINED
from contact.touch import time_series
from contact.touch.exchange import UNIFORM, exchange_of
from contact.touch.time_series import FORCE, begin, extend, free_pull, longest_step

LAW, METHOD = "NewtonRestitution", "event-driven"
REGIMES = (OUTSIDE, SUSTAINED)

LOST_HOP, LOWEST_HOP = 4.0, 20.0
"""Heights of hops, in rounding bounds of the tip displacement.  Hops lower than `LOWEST_HOP` are a stay if
they end.  A hop loses 2(1 - e) of its height, and the search for its end may be wrong by the bound.  Where
the loss is smaller than the bound, hops need not get lower, and are a stay if they end in this period of the
drive.  A hop lower than `LOST_HOP` is lost in rounding, which moves its start, its top and the search for its
end by a bound each.  It is a stay even if it never ends."""

STEADY_PULL = 0.1
"""Part of itself by which the acceleration of the tip may change until the hops end: W is then right to 4 %,
and the hops do end."""

STEADY_WANTED = 2  # verdict of `low_hop`


@part
def force(numbers, depth, rate):
    """No force: the law acts at once [N]."""
    return 0.0


@part
def stiffness(numbers, depth, rate):
    """No stiffness and no damping [N/m, N s/m]."""
    return 0.0, 0.0


@part
def slopes(numbers, run, series, weights):
    """No series: the tangents change at the impact only (`saltation`)."""
    return 0


@part
def joins(numbers):
    """Its impacts and its rest are followed beside other contacts."""
    return True


@kernel
def newton_impact(numbers, v, approach, restitution):
    """Apply the impulse that turns the tip velocity `approach` into -`restitution` times itself."""
    impulse = (1.0 + restitution) * approach / numbers.inverse_mass
    for k in range(v.size):
        v[k] += push_on(numbers, k, impulse)


@part
def low_hop(numbers, clock, acceleration, rebound, rounding):
    """0 if a hop is not low enough for a stay or does not end, 1 if it is one, `STEADY_WANTED` if it is one
    under a steady pull; see `LOWEST_HOP`.

    `rebound` is the speed with which the tip leaves [m/s] and `rounding` the rounding bound of the tip
    displacement [m].
    """
    lost, lowest, energy = 1.0 - numbers.number0, rounding * acceleration, 0.5 * rebound * rebound
    if acceleration <= 0.0 or energy * lost > max(LOWEST_HOP * lost, 1.0) * lowest:
        return 0
    if energy <= LOST_HOP * lowest:
        return 1
    left = numbers.period if energy <= LOWEST_HOP * lowest else numbers.period - clock
    return STEADY_WANTED if 2.0 * rebound <= left * acceleration * lost else 0


@part
def hops_end(numbers, run, u, v, rebound, rounding):
    """Whether the tip stays on the wall, as its hops are low and end; arguments of `low_hop`."""
    acceleration = tip_state(numbers, run.clock, u, v)[2]
    verdict = low_hop(numbers, run.clock, acceleration, rebound, rounding)
    if verdict != STEADY_WANTED:
        return verdict > 0
    pull = acceleration * (1.0 - numbers.number0)  # W = 2 rebound/pull
    change = 2.0 * rebound * jerk_bound(numbers, u, v)
    return change <= STEADY_PULL * acceleration * pull


@part
def restitution_at(numbers, speed):
    """e [1] and its slope [s/m] at an approach speed [m/s]."""
    if numbers.table.shape[1] == 0:
        return numbers.number0, 0.0
    e, slope = at_speed(numbers.table, 1, speed)
    return (e, slope) if 0.0 <= e <= 1.0 else (min(max(e, 0.0), 1.0), 0.0)  # a cubic may leave the range


@kernel
def hopping(numbers, clock, u, v, rebound):
    """W of hops that begin with the speed `rebound` [s], and the part by which they end earlier [1].

    While they go on the mean force a/sum phi^2 acts, under which a changes at the rate j.  W is 0 where the
    hops do not end.
    """
    modes, drag, jerk = numbers.modes, 0.0, -(numbers.drive**2) * tip_steady(numbers, clock)[1]
    for k in range(u.size):
        drag += modes[WEIGHT, k] ** 2 * modes[DECAY, k] / numbers.inverse_mass
    pull = tip_state(numbers, clock, u, v)[2] - drag * rebound
    for k in range(u.size):
        own = mode_acceleration(numbers, k, u[k], v[k]) + push_on(numbers, k, pull / numbers.inverse_mass)
        jerk -= modes[WEIGHT, k] * (modes[DECAY, k] * own + modes[SQUARE, k] * v[k])
    lost = pull * (1.0 - numbers.number0)
    if not lost > 0.0:
        return 0.0, 0.0
    whole = 2.0 * rebound / lost
    return whole, (jerk + 0.5 * drag * pull) * whole / (3.0 * pull)


@kernel
def acceleration_rounding(numbers, u, v):
    """Bound of the rounding error of the tip acceleration at (u, v) [m/s^2]."""
    total, modes = (abs(numbers.tip_sine) + abs(numbers.tip_cosine)) * numbers.drive**2, numbers.modes
    for k in range(u.size):
        pull = modes[SQUARE, k] * abs(u[k]) + modes[DECAY, k] * abs(v[k]) + abs(modes[LOAD, k])
        total += abs(modes[WEIGHT, k]) * pull
    return 4.0 * EPS * total


@kernel
def leaving_order(numbers, clock, u, v):
    """The order of the derivative of the height, 2 or 3, by which a tip at rest on the wall leaves; 0 if it
    stays."""
    pull, rounding = tip_state(numbers, clock, u, v)[2], acceleration_rounding(numbers, u, v)
    if abs(pull) > rounding:
        return 2 if pull < 0.0 else 0
    jerk, modes = -(numbers.drive**2) * tip_steady(numbers, clock)[1], numbers.modes
    for k in range(u.size):
        own = mode_acceleration(numbers, k, u[k], v[k])
        jerk -= modes[WEIGHT, k] * (modes[DECAY, k] * own + modes[SQUARE, k] * v[k])
    return 3 if jerk < -numbers.fastest * rounding else 0


@kernel
def strike(numbers, run, u, v, approach):
    """The impact; in the regime SUSTAINED the hops that follow it are a stay."""
    (e, _slope), rounding = restitution_at(numbers, approach), tip_rounding(numbers, u, v)
    newton_impact(numbers, v, approach, e)
    turn = 1.0 + e  # rounded, so that the loss belongs to the rebound that follows
    impulse = turn * approach / numbers.inverse_mass
    loss = 0.5 * (2.0 - turn) * impulse * approach
    if e * approach == 0.0:
        run.contact_order, run.memory0 = leaving_order(numbers, run.clock, u, v), 0.0
        return OUTSIDE if run.contact_order > 0 else SUSTAINED, 0.0, loss, impulse
    if hops_end(numbers, run, u, v, e * approach, rounding):
        whole, sooner = hopping(numbers, run.clock, u, v, e * approach)
        run.memory0 = whole * (1.0 - sooner) if whole <= numbers.period and abs(sooner) < STEADY_PULL else 0.0
        return SUSTAINED, -e * approach, loss, impulse
    run.contact_order = 1
    return OUTSIDE, -e * approach, loss, impulse


@kernel
def step(numbers, run, u, v, limit, series):
    """One step of the stay on the wall, at most `limit` [s]; see ``contact.touch``."""
    begin(numbers, run.clock, u, v, series)
    for n in range(time_series.ORDER - 1):
        held = free_pull(numbers, n, series) / numbers.inverse_mass
        series.scalars[FORCE, n] = held
        extend(numbers, n, held, series)
    h = min(longest_step(numbers, 0.0, u, v, series), limit)
    if not h > EPS * run.clock:
        return math.nan, math.nan, SUSTAINED
    margin = acceleration_rounding(numbers, u, v) / numbers.inverse_mass
    end = first_polynomial_root(series.scalars[FORCE], -1.0, h, margin)
    if end >= 0.0:
        return end, end, OUTSIDE
    return h, h, SUSTAINED


@kernel
def state(numbers, run, h, series, u, v):
    """Deviations of all modes a time `h` [s] into the step, the tip on the wall."""
    time_series.state(numbers, run, h, series, u, v)
    hold(numbers, run.clock + h, u, v)


@kernel
def exchange(numbers, run, span, series, known):
    """The impulse and the largest force of the rest; no work, for the tip does not move."""
    force = series.scalars[FORCE]
    _work, impulse, largest = exchange_of(series, force, force, UNIFORM, span, known)
    return 0.0, impulse, largest


@part
def leave(numbers, run, u, v):
    """The end of the rest, where d, d' and d'' vanish."""
    run.contact_order = 3
    return tip_state(numbers, run.clock, u, v)[1]


@kernel
def saltation(numbers, vary, before, after, tangent):
    """The effect of the impact on the tangents: d -> R d + (R f - f') (-y(d)/v).

    R is the reflection of the tip velocity, f and f' are the velocities of the flow before and after (M. A.
    Aizerman, F. R. Gantmacher, Quart. J. Mech. Appl. Math. 11 (1958) 243; A. B. Nordmark, J. Sound Vib. 145
    (1991) 279).  Parameters change R as well.  If e depends on the approach v, the derivative of the rebound
    -e v with respect to v is -(e + e' v).
    """
    n, count = numbers.size, len(vary.scalars)
    clock, u, v = before
    rebound = after[2]
    _height, approach, pull = tip_state(numbers, clock, u, v)
    e, slope = restitution_at(numbers, approach)
    flip = (1.0 + e) / numbers.inverse_mass
    turn = flip + slope * approach / numbers.inverse_mass
    height, rate = all_tip_changes(vary, tangent, u, v, clock)
    for j in range(height.size):
        late = -height[j] / approach  # by how much later this neighbour touches
        for k in range(n):
            push = push_on(numbers, k, turn)
            slow = mode_acceleration(numbers, k, u[k], v[k]) + push * pull
            after_it = mode_acceleration(numbers, k, u[k], rebound[k])
            tangent[k, j] += (v[k] - rebound[k]) * late
            tangent[n + k, j] += push * rate[j] + (slow - after_it) * late
    for p in range(count):
        mobility = 2.0 * tip_sum(numbers, 0.0, vary.weight[p])
        flipped = (vary.scalars[p, NUMBER0] - flip * mobility) / numbers.inverse_mass
        for k in range(n):
            change = push_on(numbers, k, flipped) - vary.weight[p, k] * flip
            tangent[n + k, height.size - count + p] += change * approach
