"""The strobed motion of one mode under Newton's law: most periods cost one multiplication and one proof.

Eq. (1) of the letter (1996) in the notation of ``contact.flight``: relative to the stop the tip is at

    y(t) = -G + A cos(w (t - t_p)) + phi u(t),

G the distance of the stop from the tip's mean place, A and t_p height and time of the steady peak, u the
free deviation.  From strobe to strobe (u, v) is multiplied by the constant flow of a period.  What has to be
proved is that y stays below zero meanwhile.  Let rho = |phi| sqrt(u^2 + (v/omega)^2), which bounds |phi u|
and |phi u'|/omega for good, and m the margin for rounding.  Because of u'' = -c u' - omega^2 u,

    y'' + w^2 (y + G) = phi (u'' + w^2 u) <= w^2 d,     d = (|w^2 - omega^2| + c omega) rho/w^2,

so that z = y + G - d obeys z'' + w^2 z <= 0.  Compared with the swing of the same height and slope at any t_1
(the difference is an integral over sin(w (t - s)) >= 0 of something not above zero), for |t - t_1| <= pi/w

    z(t) <= z_1 cos(w (t - t_1)) + (z_1'/w) sin(w (t - t_1)) <= sqrt(z_1^2 + (z_1'/w)^2).                (1)

Where cos(w (t - t_p)) <= 0, on the other hand, y <= rho - G.  Let rho + m < G and d + m < G, and t_p lie in
the middle half of the period (below resonance it does, unless the mode's sign puts it at the strobe).

* For a t_1 within a quarter of a period of t_p both together cover the period: there is no crossing if

      z_1^2 + (z_1'/w)^2 < (G - d - m)^2.                                                              (*)

  At t_1 = t_p these are z_1 = A + p - d and z_1' = q, (p, q) = phi (u, u') there, each two products of (u, v)
  with constants: a period that is settled so needs no sine.  If that fails, t_1 near the peak may settle it.
* A zero of y lies within a quarter of a period of t_p.  If y' > 0 there, (1) with t_1 at the zero shows y < 0
  all the time before it: it is the first crossing, whichever way it was found.  It is one beyond rounding if
  the peak that its slope must reach, y'^2/(2 max|y''|), exceeds m.  ``struck_period`` finds nearly all of
  them in one evaluation and tells whether it did; an iteration finds the others.
* After an impact (1) with z_1 = G - d > 0 and z_1' <= 0 shows y < 0 for the rest of the period, with the rho
  and d from then on; and y'' <= -w^2 z_1 < 0, so that impacts do not accumulate.

For other deviations the nodes of ``contact.integrators.strobe_nodes`` are searched.  A period that none of
this settles beyond rounding, every period with a stay on the wall or with accumulating impacts, and every
graze is left as it was and given to ``event_loop.advance``.
"""

from __future__ import annotations

import math

import numpy as np

from contact.compiled import kernel
from contact.impact_log import LOG_FIELDS, ORDER, REGIME
from contact.integrators.event_loop import DONE, advance
from contact.integrators.node_search import rising_zero, searched_period
from contact.integrators.strobe_nodes import flow_over, tip_near
from contact.integrators.struck_period import (
    carried,
    free_near,
    guessed,
    is_settled,
    steady_near,
    tip_derivatives,
    zero_of,
)
from contact.series import OUTSIDE

__all__ = ["strobed_motion"]


@kernel
def left_period(motion, u, v, integers, floats, index):
    """The period `index` by ``event_loop.advance``: status, period reached, impacts."""
    # a literal one as an argument would make numba compile the event loop once more
    count, one = np.zeros(1, dtype=np.int64), np.int64(1)
    status, reached = advance(
        motion, u, v, integers, floats, index, one, 0.0, np.empty((1, 2)), count, np.empty((0, LOG_FIELDS)),
        np.empty((0, 4)), np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 2)),
    )
    return status, reached, count[0]


@kernel
def strobed_motion(
    motion, nodes, numbers, u, v, integers, floats, first, periods, mean, weight, points, counts
):
    """Carry the deviation (u, v), shape (1,) each, from strobe `first` over `periods` periods.

    Parameters are those of ``event_loop.advance`` but for

    nodes, numbers : StrobeNodes, LoopNumbers
    mean, weight : ndarray, shape (2,)
        Steady displacement and velocity at a strobe, and what their sums with (u, v) are multiplied by in
        `points`, shape (periods, 2).

    Returns
    -------
    status, period : int
        As those of ``advance``.
    searched, left : int
        Periods that needed a search, and those left to ``advance``.
    """
    mode, rows, n = nodes.mode, nodes.rows, numbers
    q, q_rate, weight_u, weight_v = mean[0], mean[1], weight[0], weight[1]
    searched, left, strobe = 0, 0, np.int64(0)
    un, vn = u[0], v[0]
    for i in range(periods):
        impacts = -1
        if integers[REGIME] == OUTSIDE and integers[ORDER] == 0:
            square = n.square_u * un * un + n.square_v * vn * vn
            if square < n.most:
                rho = math.sqrt(square)
                p, slope = n.g0 * un + n.g1 * vn, n.g2 * un + n.g3 * vn
                room = n.gap - n.detuning * rho
                z, room = n.above + p + room, room - n.margin
                if z * z + n.slow * slope * slope < room * room:
                    impacts = 0
                    un, vn = n.f0 * un + n.f1 * vn, n.f2 * un + n.f3 * vn
                else:
                    t = guessed(n, p, slope, n.above + p)
                    if 0.0 <= t <= n.period:
                        k = int(t * n.per_second + 0.5)
                        j, x = rows.shape[0] - 1 - k, t - k * n.stretch
                        u0, v0, s0, s1 = free_near(
                            n, x, rows[k, 2] * un + rows[k, 3] * vn, rows[k, 4] * un + rows[k, 5] * vn
                        )
                        swing, glide = steady_near(n, x, rows[k, 0], rows[k, 1])
                        y0, y1, y2, y3, y4 = tip_derivatives(n, u0, v0, swing, glide)
                        d, rest, approach = zero_of(y0, y1, y2, y3, y4)
                        u0, v0 = carried(n, u0, v0, d)
                        s0, s1 = carried(n, s0, s1, -d)
                        jump = n.kick * approach
                        if is_settled(n, rho, u0, v0 + jump, y1, d, rest, approach):
                            impacts = 1
                            un, vn = (
                                n.f0 * un + n.f1 * vn + jump * (rows[j, 2] * s0 + rows[j, 3] * s1),
                                n.f2 * un + n.f3 * vn + jump * (rows[j, 4] * s0 + rows[j, 5] * s1),
                            )
                        else:
                            found, t, ui, vi, approach = rising_zero(
                                mode, rows, strobe, un, vn, t, 0.0, n.period, n.crest, n.margin
                            )
                            vi += n.kick * approach
                            if found and n.square_u * ui * ui + n.square_v * vi * vi < n.most:
                                impacts = 1
                                un, vn = flow_over(mode, rows, n.period - t, ui, vi)
                    else:
                        # no crossing in sight: perhaps (*) holds at the peak
                        drop = n.decay * slope + n.stiffness * p
                        dip = n.crest + drop
                        twist = n.decay * drop - n.stiffness * slope
                        x = slope / dip
                        x += 0.5 * twist * x * x / (dip - twist * x)
                        if dip > 0.0 and abs(x) * n.drive < 1.5:
                            _u, _v, _swing, y0, y1, _y2 = tip_near(mode, rows, strobe, un, vn, n.peak + x)
                            z = y0 + n.gap - n.detuning * rho
                            if z * z + n.slow * y1 * y1 < room * room:
                                impacts = 0
                                un, vn = n.f0 * un + n.f1 * vn, n.f2 * un + n.f3 * vn
            if impacts < 0:
                searched += 1
                impacts, ui, vi = searched_period(motion, nodes, un, vn)
                if impacts >= 0:
                    un, vn = ui, vi
        if impacts < 0:
            left += 1
            u[0], v[0] = un, vn
            status, reached, impacts = left_period(motion, u, v, integers, floats, first + i)
            if status != DONE:
                return status, reached, searched, left
            un, vn = u[0], v[0]
        points[i, 0] = (un + q) * weight_u
        points[i, 1] = (vn + q_rate) * weight_v
        counts[i] = impacts
    u[0], v[0] = un, vn
    return DONE, first + periods, searched, left
