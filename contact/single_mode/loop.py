"""Drive periods of one mode under Newton's law: most of them cost one multiplication and one proof.

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
  the peak that its slope must reach, y'^2/(2 max|y''|), exceeds m.  ``one_impact`` finds nearly all of
  them in one evaluation and tells whether it did; an iteration finds the others.
* After an impact (1) with z_1 = G - d > 0 and z_1' <= 0 shows y < 0 for the rest of the period, with the rho
  and d from then on; and y'' <= -w^2 z_1 < 0, so that impacts do not accumulate.

For other deviations the nodes of the ``period_table`` are searched.  A period that none of
this settles beyond rounding, every period with a stay on the wall or with accumulating impacts, and every
graze is left as it was and given to ``event_loop.advance``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from contact.compiled import borrowed, inlined, kernel, part
from contact.event_loop import DONE, advance
from contact.recorder import strobes_only
from contact.single_mode.one_impact import guessed, one_impact
from contact.single_mode.period_table import flow_over, through, tip_near
from contact.single_mode.search import rising_zero, searched_period
from contact.trajectory import OUTSIDE

__all__ = ["any_periods", "one_mode_periods"]


@part
def any_periods(motion, u, v, runs, points, counts):
    """Drive periods from a strobe by ``event_loop.advance``, as many as `counts` has places.

    `points`, shape (periods, 2 n_modes), gets the deviations at the strobes.
    """
    return advance(motion, u, v, runs, runs[0].period + counts.size, 0.0, strobes_only(points, counts))


@inlined
def is_free(n, z, rate, height):
    """(*): whether a height z and its rate [m, m/s] prove the period free; `height` = G - d [m]."""
    room = height - n.margin
    return z * z + n.slow * rate * rate < room * room


class Seen(NamedTuple):
    """What (*) needs: rho [m], (p, q) = phi (u, u') at the steady peak, and G - d [m]."""

    rho: float
    free: float
    slope: float
    height: float


@inlined
def seen_at_peak(n, u, v):
    """A period from (u, v), as it is seen at its steady peak."""
    rho = math.sqrt(n.square_u * u * u + n.square_v * v * v)
    p, slope = through(n.peak_flow, u, v)
    return Seen(rho, p, slope, n.gap - n.detuning * rho)


@inlined
def settled_period(n, rows, seen, u, v):
    """A period from (u, v) that (*) does not settle at the peak: impacts, at most one, and the deviation at
    its end; or -1 impacts, which leaves it open."""
    p, slope = seen.free, seen.slope
    t = guessed(n, p, slope)
    if 0.0 <= t <= n.period:
        settled, _time, _approach, un, vn = one_impact(n, rows, t, seen.rho, u, v)
        if settled:
            return 1, un, vn
        found, t, un, vn, approach = rising_zero(n, rows, np.int64(0), u, v, t, 0.0, n.period, n.margin)
        vn += n.kick * approach
        if found and n.square_u * un * un + n.square_v * vn * vn < n.most * n.most:
            u, v = flow_over(n, rows, n.period - t, un, vn)
            return 1, u, v
        return -1, u, v
    # no crossing in sight: perhaps (*) holds at the peak
    drop = n.decay * slope + n.stiffness * p
    dip = n.crest + drop
    twist = n.decay * drop - n.stiffness * slope
    x = slope / dip
    x += 0.5 * twist * x * x / (dip - twist * x)
    if dip > 0.0 and abs(x) * n.drive < 1.5:
        _u, _v, _swing, y0, y1, _y2 = tip_near(n, rows, np.int64(0), u, v, n.peak + x)
        if is_free(n, y0 + seen.height, y1, seen.height):
            u, v = through(n.period_flow, u, v)
            return 0, u, v
    return -1, u, v


@kernel
def one_mode_periods(table, system, u, v, runs, points, counts):
    """``strobed_motion`` for the one mode of `table`, a field of `system` which numba cannot tell from None.

    Returns
    -------
    status : int
        As that of ``advance``.
    searched, left : int
        Periods that needed a search, and those left to ``advance``.
    """
    table, u, v, points = borrowed(table), borrowed(u), borrowed(v), borrowed(points)
    counts, n, rows = borrowed(counts), table.mode, table.rows
    mean_u, mean_v, weight_u, weight_v = system.mean[0], system.mean[1], system.weight[0], system.weight[1]
    searched, left, run = 0, 0, runs[0]
    first = run.period
    un, vn = u[0], v[0]
    outside = run.regime == OUTSIDE and run.order == 0
    for i in range(counts.size):
        impacts = 0
        seen = seen_at_peak(n, un, vn)
        compared = outside and seen.rho < n.most
        if compared and is_free(n, n.above + seen.free + seen.height, seen.slope, seen.height):
            un, vn = through(n.period_flow, un, vn)
        else:
            impacts = -1
            if compared:
                impacts, ui, vi = settled_period(n, rows, seen, un, vn)
            if outside and impacts < 0:
                searched += 1
                impacts, ui, vi = searched_period(table, un, vn)
            if impacts < 0:
                left += 1
                u[0], v[0], run.period = un, vn, first + i
                status = any_periods(system.motion, u, v, runs, points[i : i + 1], counts[i : i + 1])
                if status != DONE:
                    return status, searched, left
                impacts, ui, vi = counts[i], u[0], v[0]
                outside = run.regime == OUTSIDE and run.order == 0
            un, vn = ui, vi
        points[i, 0] = (un + mean_u) * weight_u
        points[i, 1] = (vn + mean_v) * weight_v
        counts[i] = impacts
    u[0], v[0], run.period = un, vn, first + counts.size
    return DONE, searched, left
