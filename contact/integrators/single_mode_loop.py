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
  all the time before it: it is the first crossing, whichever way an iteration came to it.  It is one beyond
  rounding if the peak that its slope must reach, y'^2/(2 max|y''|), exceeds m.
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
from contact.flight import EPS
from contact.impact_log import LOG_FIELDS, ORDER, REGIME
from contact.integrators.event_loop import DONE, advance
from contact.integrators.node_search import SAFETY, rising_zero, searched_period
from contact.integrators.strobe_nodes import flow_over, tip_near
from contact.newton import newton_impact
from contact.series import OUTSIDE

__all__ = ["strobed_motion"]

LEAST_ROOM = 1.0 / 16.0
"""G - d and G - rho over G below which (*) is not used, so that squares are rounded by less than m allows."""


@kernel
def strobed_motion(motion, nodes, u, v, integers, floats, first, periods, mean, weight, points, counts):
    """Carry the deviation (u, v), shape (1,) each, from strobe `first` over `periods` periods.

    Parameters are those of ``event_loop.advance`` but for

    nodes : StrobeNodes
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
    mode, rows = nodes.mode, nodes.rows
    w, decay, stiffness, phi = mode.drive, mode.decay, mode.stiffness, mode.phi
    last = rows.shape[0] - 1
    f0, f1, f2, f3 = rows[last, 2], rows[last, 3], rows[last, 4], rows[last, 5]
    g0, g1, g2, g3 = nodes.to_peak[0], nodes.to_peak[1], nodes.to_peak[2], nodes.to_peak[3]
    gap, amplitude, omega = -motion.level, nodes.amplitude, motion.omega[0]
    steady = abs(motion.level) + abs(motion.tip_sine) + abs(motion.tip_cosine) + motion.gap
    margin = SAFETY * 4.0 * EPS * (steady + 2.0 * max(1.0, 0.5 * decay / omega) * abs(gap))
    detuning = (abs(w * w - stiffness) + decay * omega) / (w * w)
    most = (1.0 - LEAST_ROOM) * gap / max(1.0, detuning) if nodes.inner else -1.0  # of rho
    slow = 1.0 / (w * w)
    above = amplitude + motion.level
    square_u, square_v = phi * phi, phi * phi / stiffness
    crest = amplitude * w * w
    q, q_rate, weight_u, weight_v = mean[0], mean[1], weight[0], weight[1]

    none, none_whole = np.empty(0), np.empty(0, dtype=np.int64)
    no_log, no_states = np.empty((0, LOG_FIELDS)), np.empty((0, 4))
    strobe, count = np.empty((1, 2)), np.zeros(1, dtype=np.int64)
    end = np.empty(1)
    searched, left = 0, 0
    un, vn = u[0], v[0]
    for i in range(periods):
        impacts = -1
        if integers[REGIME] == OUTSIDE and integers[ORDER] == 0:
            rho = math.sqrt(square_u * un * un + square_v * vn * vn)
            if rho < most:
                p, slope = g0 * un + g1 * vn, g2 * un + g3 * vn
                height = above + p
                deviant = detuning * rho
                room = gap - deviant - margin
                z = height + gap - deviant
                if z * z + slow * slope * slope < room * room:
                    impacts = 0
                    un, vn = f0 * un + f1 * vn, f2 * un + f3 * vn
                else:
                    # the motion next to t_p by its third-order Taylor polynomial
                    drop = decay * slope + stiffness * p
                    dip = crest + drop
                    twist = decay * drop - stiffness * slope
                    under = slope * slope + 2.0 * dip * height
                    if under > 0.0 and dip > 0.0:
                        x = (slope - math.sqrt(under)) / dip
                        rate = slope + x * (0.5 * x * twist - dip)
                        x -= (height + x * (slope + x * (x * twist / 6.0 - 0.5 * dip))) / rate
                        found, t, ui, vi, approach = rising_zero(
                            mode, rows, 0, un, vn, nodes.peak + x, 0.0, motion.period, crest, margin
                        )
                        if found:
                            end[0] = vi
                            newton_impact(motion, end, approach, motion.number0)
                            vi = end[0]
                            if math.sqrt(square_u * ui * ui + square_v * vi * vi) < most:
                                impacts = 1
                                un, vn = flow_over(mode, rows, motion.period - t, ui, vi)
                    elif dip > 0.0:
                        x = slope / dip
                        x += 0.5 * twist * x * x / (dip - twist * x)
                        if abs(x) * w < 1.5:
                            _u, _v, _swing, y0, y1, _y2 = tip_near(mode, rows, 0, un, vn, nodes.peak + x)
                            z = y0 + gap - deviant
                            if z * z + slow * y1 * y1 < room * room:
                                impacts = 0
                                un, vn = f0 * un + f1 * vn, f2 * un + f3 * vn
            if impacts < 0:
                searched += 1
                impacts, ui, vi = searched_period(motion, nodes, un, vn)
                if impacts >= 0:
                    un, vn = ui, vi
        if impacts < 0:
            left += 1
            u[0], v[0] = un, vn
            status, reached = advance(
                motion, u, v, integers, floats, first + i, 1, 0.0, strobe, count, no_log, no_states,
                none_whole, none, strobe,
            )
            if status != DONE:
                return status, reached, searched, left
            un, vn, impacts = u[0], v[0], count[0]
        points[i, 0] = (un + q) * weight_u
        points[i, 1] = (vn + q_rate) * weight_v
        counts[i] = impacts
    u[0], v[0] = un, vn
    return DONE, first + periods, searched, left
