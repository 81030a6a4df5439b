"""The grid of a run with a time step: its state, the forces, and the record of touches between its points.

    q_k'' = f_k - phi_k N(d, d'),   f_k = g_k + P_k sin(w t) - c_k q_k' - omega_k^2 q_k,   P_k = Gamma_k Z w^2
    d = sum_k phi_k q_k - gap,      N as in ``contact.touch``

A touch is seen if the penetration d is positive at a grid point; a touch between two of them is missed.
Between grid points each method supplies its own interpolation.  Most use the cubic Hermite polynomial through
the displacements and velocities of a mode at both ends of the step,

    q(s) = H00 q0 + H10 h v0 + H01 q1 + H11 h v1,

whose error, h^4/384 q'''', is below their own.  Touch and release are roots of the interpolated penetration.
Times count from the strobe before the run's start.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from contact import touch
from contact.engine.recorder import Recorder, put_sample, sample_due
from contact.flight.numbers import DECAY, SQUARE, Numbers
from contact.flight.tip import push_on, tip_sum
from contact.machine.compiled import inlined, kernel, part
from contact.state import IMPACT
from contact.touch.passage import add_exchange, close_touch, is_full, open_touch

DONE, FULL, TOO_LARGE, DIVERGED = 0, 1, 2, 3
"""How a step or a run ends: well; with a full log; at a contact too stiff for the step; with a motion that is
no longer finite."""

PROGRESS = np.dtype([("step", "i8"), ("due", "f8")])
"""Number of the grid point reached; time of the next sample since the strobe `first` [s]."""

UNBOUNDED = 1e12  # penetration [m] beyond which a motion counts as diverged
ON_THE_GRID = 1e-9  # part of a step by which a time may miss a grid point and be taken for it
LEAST_DEPTH = float(np.finfo(float).tiny)  # penetration in place of d = 0, where the stop does not act [m]
WELL_WITHIN = 1e-12  # part of a step to which a touch is dated: rounding moves the root by as much


class Grid(NamedTuple):
    """A run under way on its grid."""

    progress: np.ndarray  # `PROGRESS`, shape (1,)
    numbers: Numbers
    push: np.ndarray  # P [N kg^-0.5], shape (n_modes,)
    constant: np.ndarray  # g [N kg^-0.5], shape (n_modes,)
    step: float  # h [s]
    clock: float  # time of the first grid point since the strobe `first` [s]
    first: int  # number of the drive period in which the run starts
    steps: int  # in all
    critical: float  # contact stiffness beyond which the run ends [N/m]
    q: np.ndarray  # the modal state that the method carries: now, shape (n_modes,) each,
    v: np.ndarray
    q0: np.ndarray  # at the last grid point,
    v0: np.ndarray
    q_at: np.ndarray  # and interpolated
    v_at: np.ndarray
    recorder: Recorder


@inlined
def tip_of(numbers, q, v):
    """Penetration d [m] and its rate [m/s]."""
    return tip_sum(numbers, -numbers.gap, q), tip_sum(numbers, 0.0, v)


@inlined
def force_in_flight(grid, k, sine, q, v):
    """f of mode `k`; `sine` is sin(w t)."""
    modes = grid.numbers.modes
    return grid.constant[k] + grid.push[k] * sine - modes[DECAY, k] * v[k] - modes[SQUARE, k] * q[k]


@inlined
def contact_force(numbers, depth, rate):
    """Force N of the stop on the tip [N]; zero for impact laws."""
    return touch.force(numbers, depth, rate) if depth > 0.0 else 0.0


@inlined
def contact_tangent(numbers, depth, rate):
    """dN/dd [N/m] and dN/dd' [N s/m], zero off the stop."""
    return touch.stiffness(numbers, depth, rate) if depth > 0.0 else (0.0, 0.0)


@kernel
def first_tangent(numbers):
    """dN/dd [N/m] and dN/dd' [N s/m] at the first touch, of a tip at rest; zero for impact laws."""
    return contact_tangent(numbers, LEAST_DEPTH, 0.0)


@kernel
def accelerations(grid):
    """The modal accelerations at the first grid point, shape (n_modes,)."""
    q, v, numbers = grid.q, grid.v, grid.numbers
    sine = math.sin(numbers.drive * grid.clock)
    depth, rate = tip_of(numbers, q, v)
    push, found = contact_force(numbers, depth, rate), np.empty(q.size)
    for k in range(q.size):
        found[k] = force_in_flight(grid, k, sine, q, v) + push_on(numbers, k, push)
    return found


Interpolate = Callable[..., tuple[float, float]]
"""interpolate(grid, method, x, h, with_force) puts the state at the fraction x of the step just made, of
length h, into q_at and v_at, and returns penetration and its rate.  Without `with_force` the last force of
the stop has not acted yet, as at the instant of a touch."""

WriteContact = Callable[..., None]
"""write(grid, method, span, depth, report) writes touches and releases down.  span is (start, h), `depth` the
penetration at the end of the step, and `report` the method's own account of the contact in it."""


def make_end_step(interpolate: Interpolate, write: WriteContact) -> Callable[..., int]:
    """The compiled end of a step, for a method's interpolation and its way to write contacts down.

    It is end_step(grid, method, count, depth, no_contact, report) -> status.
    """

    @inlined
    def write_down(grid, method, count, depth, report):
        """Write down contacts and samples of `count` steps; DONE, or why the run has to leave its loop."""
        recorder, progress, h = grid.recorder, grid.progress[0], count * grid.step
        start, marks, clock = grid.clock + progress.step * grid.step, recorder.marks[0], recorder.sample_clock
        write(grid, method, (start, h), depth, report)
        # rounding may put the end of a long run behind the last grid point by more than that
        until = start + h + ON_THE_GRID * h if progress.step + count < grid.steps else math.inf
        while sample_due(recorder, grid.first, until):
            x = max(0.0, (clock[marks.sampled] - start) / h)
            interpolate(grid, method, 1.0 if x > 1.0 - ON_THE_GRID else x, h, True)
            put_sample(recorder, grid.q_at, grid.v_at)
        progress.due = clock[marks.sampled] if marks.sampled < clock.size else math.inf
        if not abs(depth) < UNBOUNDED:
            return DIVERGED
        stiffness, _damping = contact_tangent(grid.numbers, depth, 0.0)
        if stiffness > grid.critical:
            return TOO_LARGE
        return FULL if is_full(recorder) else DONE

    @part
    def end_step(grid, method, count, depth, no_contact, report):
        """Go on to the grid point `count` further; with `no_contact` the stop has not acted on the way."""
        progress, status = grid.progress[0], DONE
        end = grid.clock + (progress.step + count) * grid.step
        quiet = no_contact and grid.recorder.marks[0].touching == 0 and abs(depth) < UNBOUNDED
        quiet = quiet and progress.step + count < grid.steps
        if not (quiet and end + ON_THE_GRID * grid.step < progress.due):
            status = write_down(grid, method, count, depth, report)
        progress.step += count
        for k in range(grid.q.size):
            grid.q0[k], grid.v0[k] = grid.q[k], grid.v[k]
        return status

    return end_step


def make_contact_writer(interpolate: Interpolate) -> WriteContact:
    """The compiled record of a step under a force law, for a method's interpolation."""

    @inlined
    def crossing(grid, method, h, depth):
        """Fraction of the step at which the penetration changes sign, and its rate there; `depth` is its end.

        Newton's steps, and halves of the bracket where they leave it.
        """
        low, high, x, rate = 0.0, 1.0, 0.5, 0.0
        for _ in range(100):
            height, rate = interpolate(grid, method, x, h, False)
            low, high = (low, x) if (height > 0.0) == (depth > 0.0) else (x, high)
            new = x - height / (rate * h)
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - x) <= WELL_WITHIN:
                break
            x = new
        return x, rate

    @inlined
    def write(grid, method, span, depth, report):
        """`report`: penetration at the start of the step; energy [J] and impulse [N s] that the stop has
        taken, and the largest force [N]; and whether the tip has touched it within the step."""
        before, given, touched = report
        recorder, (start, h) = grid.recorder, span
        touching = recorder.marks[0].touching == 1
        opens = not touching and (depth > 0.0 or touched)
        closes = depth <= 0.0 and (touching or opens)
        x = rate = 0.0
        if opens or closes:
            # a touch that begins and ends between two grid points lasts the whole step
            if (before > 0.0) != (depth > 0.0):
                x, rate = crossing(grid, method, h, depth)
            else:
                _depth, rate = interpolate(grid, method, 0.0, h, False)
        if opens:
            open_touch(recorder, 0, grid.first, start + x * h, rate, IMPACT, grid.q_at, grid.v_at)
        if touching or opens:
            add_exchange(recorder, 0, given[0], given[1], given[2])
        if closes:
            if opens:
                x = 1.0
                _depth, rate = interpolate(grid, method, x, h, True)
            close_touch(recorder, 0, grid.first, start + x * h, rate, grid.q_at, grid.v_at)

    return write


@inlined
def cubic_interpolation(grid, _method, x, h, _with_force):
    """The state at the fraction `x` of a step of length h on the cubic."""
    z = 1.0 - x
    for k in range(grid.q.size):
        rise = grid.q[k] - grid.q0[k]
        a, b = h * grid.v0[k] - rise, h * grid.v[k] - rise
        grid.q_at[k] = z * grid.q0[k] + x * grid.q[k] + x * z * (z * a - x * b)
        grid.v_at[k] = (rise + (1.0 - 2.0 * x) * (z * a - x * b) - x * z * (a + b)) / h
    return tip_of(grid.numbers, grid.q_at, grid.v_at)


_write_on_cubic = make_contact_writer(cubic_interpolation)


@inlined
def _write_contact(grid, method, span, depth, _report):
    """The trapezoidal rule gives the energy and the impulse that the stop takes."""
    d0, r0 = tip_of(grid.numbers, grid.q0, grid.v0)
    d1, r1 = tip_of(grid.numbers, grid.q, grid.v)
    f0, f1, half = contact_force(grid.numbers, d0, r0), contact_force(grid.numbers, d1, r1), 0.5 * span[1]
    given = half * (r0 * f0 + r1 * f1), half * (f0 + f1), max(f0, f1)
    _write_on_cubic(grid, method, span, depth, (d0, given, False))


end_contact_step = make_end_step(cubic_interpolation, _write_contact)
