"""Drive periods of one mode under Newton's law: most of them cost one multiplication and one proof.

Relative to the stop the tip is at y(t) = -G + A cos(w (t - t_p)) + u(t), as in ``contact.flight.bounds`` with
phi = 1 and without other modes.  From strobe to strobe (u, u') is multiplied by the constant flow of a
period, if y stays below zero meanwhile.  With the rho and d of that file at the strobe, the margin m for
rounding and z = y + G - d, let rho + m < G and d + m < G, and t_p lie in the middle half of the period (below
resonance it does, unless the mode's sign puts it at the strobe).

* There is no crossing if at a t_1 within a quarter of a period of t_p

      z_1^2 + (z_1'/w)^2 < (G - d - m)^2.                                                              (*)

  At t_1 = t_p these are z_1 = A + p - d and z_1' = q, (p, q) = (u, u') there, each two products with
  constants: this proof needs no sine.  If it fails, (*) may hold for a t_1 near the peak.
* A zero of y with y' > 0 is the first crossing.  It is one beyond rounding if y'^2/(2 max|y''|) exceeds m.
  ``one_impact`` finds nearly all crossings in one evaluation and checks them; an iteration (`rising_zero`)
  finds the others.
* After an impact y stays below zero for the rest of the period, with the rho and d from then on.

``event_loop.advance`` takes every period that remains undecided: within rounding of a graze, with a stay on
the wall or several impacts, and with large deviations (from about twice the grazing amplitude on).
Derivation: ``docs/theory/orbits.md``.
"""

import math

from contact.engine.event_loop import DONE, advance
from contact.engine.recorder import strobes_only
from contact.flight.modal_flow import FAINT, LOOK
from contact.flight.numbers import COSINE, SINE, with_drive
from contact.machine.compiled import borrowed, inlined, kernel
from contact.one_mode.one_impact import crossing_guess, is_proved, one_impact, peak_derivatives
from contact.one_mode.period_table import SMALL, flow_over, table_at, taylor_flow, through, tip_near
from contact.state import OUTSIDE

NEWTON_STEPS = 60  # bound of Newton steps; next to a graze each halves the distance to the double root


@inlined
def is_free(n, s, z, rate, height):
    """(*): whether a height z and its rate [m, m/s] prove the period free; `height` = G - d [m]."""
    slack = height - s.margin
    return z * z + n.drive_time_squared * rate * rate < slack * slack


@kernel
def rising_zero(table, u, v, t):
    """Newton's iteration from the time `t` for a zero of the tip displacement where it rises.

    Returns its time [s], deviation and rate, and the approach velocity [m/s], NaN without a positive slope.
    """
    low, high = 0.0, table.mode.period
    for _ in range(NEWTON_STEPS):
        if not low < t < high:
            t = 0.5 * (low + high)
        un, vn, y0, y1, y2 = tip_near(table, u, v, t)
        if not y1 > 0.0:
            break
        x = -y0 / y1
        if abs(y2) * x * x < SMALL * table.steady.margin and low < t + x < high:
            # the error after this step is below rounding
            un, vn = taylor_flow(table.mode, un, vn, x)
            return t + x, un, vn, y1 + x * y2
        low, high = (t, high) if y0 < 0.0 else (low, t)
        # Halley's step where it is close to Newton's
        change = 0.5 * x * y2
        t += x if abs(change) > 0.25 * y1 else -y0 / (y1 + change)
    return t, u, v, math.nan


@inlined
def decided_period(table, rho, p, q, u, v):
    """One period that (*) at the steady peak does not cover, from (u, v) of size `rho`; (p, q) at the peak.

    Returns the number of impacts, 0 or 1, and the deviation at its end; or -1 impacts if it is undecided.
    """
    n, s = table.mode, table.steady
    t = crossing_guess(n, s, p, q)
    if 0.0 <= t <= n.period:
        proved, un, vn = one_impact(table, t, rho, u, v)
        if proved:
            return 1, un, vn
        t, un, vn, approach = rising_zero(table, u, v, t)
        vn += n.kick * approach
        if is_proved(n, s, rho, un, vn, approach, 0.0, 0.0, approach):
            u, v = flow_over(n, table.rows, n.period - t, un, vn)
            return 1, u, v
    # no crossing in sight: perhaps (*) holds at the peak
    deceleration, jerk, _snap = peak_derivatives(n, s, p, q)
    x = q / deceleration
    x += 0.5 * jerk * x * x / (deceleration - jerk * x)
    if deceleration > 0.0 and abs(x) * n.drive < 1.5:
        _u, _v, y0, y1, _y2 = tip_near(table, u, v, n.peak + x)
        height = n.gap - n.detuning * rho
        if is_free(n, s, y0 + height, y1, height):
            u, v = through(n.period_flow, u, v)
            return 0, u, v
    return -1, u, v


@kernel
def one_mode_periods(table, system, factors, u, v, runs, points, counts):
    """``strobed_motion`` for the one mode of `table`, a field of `system` whose type numba must know.

    Returns the status of ``advance``, and the number of periods left to it.
    """
    table, u, v, points = borrowed(table), borrowed(u), borrowed(v), borrowed(points)
    counts, local, n, weight = borrowed(counts), table, table.mode, system.weight[0]
    mean_u, mean_v = system.mean[0] * weight, system.mean[1] * weight
    driven_u = weight * system.numbers.modes[COSINE, 0]
    driven_v = weight * system.numbers.drive * system.numbers.modes[SINE, 0]
    per_omega = system.weight[1] / weight
    left, run, factor = 0, runs[0], 1.0
    first = run.stretch
    un, vn = weight * u[0], weight * v[0]
    outside = run.regime == OUTSIDE and run.contact_order == 0
    for start in range(0, counts.size, LOOK):
        if abs(un) + abs(vn) < FAINT:
            un, vn = 0.0, 0.0
        for i in range(start, min(start + LOOK, counts.size)):
            if factors.size > 0 and factors[i] != factor:
                change, factor = factors[i] - factor, factors[i]
                local = table_at(table, system.numbers, factor)
                un, vn = un - change * driven_u, vn - change * driven_v
                mean_u, mean_v = mean_u + change * driven_u, mean_v + change * driven_v
            impacts = 0
            s = local.steady
            rho = math.sqrt(un * un + n.mode_time_squared * vn * vn)
            height = n.gap - n.detuning * rho
            p, q = through(n.peak_flow, un, vn)
            compared = outside and rho < s.largest_deviation
            if compared and is_free(n, s, s.overshoot + p + height, q, height):
                un, vn = through(n.period_flow, un, vn)
            else:
                impacts = -1
                if compared:
                    impacts, ui, vi = decided_period(local, rho, p, q, un, vn)
                if impacts < 0:
                    left += 1
                    u[0], v[0], run.stretch = un / weight, vn / weight, first + i
                    numbers = system.numbers if factor == 1.0 else with_drive(system.numbers, factor)
                    here = strobes_only(points[i : i + 1], counts[i : i + 1])
                    status = advance(numbers, u, v, runs, first + i + 1, 0.0, here, None, None)
                    if status != DONE:
                        return status, left
                    impacts, ui, vi = counts[i], weight * u[0], weight * v[0]
                    outside = run.regime == OUTSIDE and run.contact_order == 0
                un, vn = ui, vi
            points[i, 0] = un + mean_u
            points[i, 1] = (vn + mean_v) * per_omega
            counts[i] = impacts
    change = 1.0 - factor
    un, vn = un - change * driven_u, vn - change * driven_v
    u[0], v[0], run.stretch = un / weight, vn / weight, first + counts.size
    return DONE, left
