"""The motion as a general solver sees it: y = (q, v), one smooth right-hand side in flight, one in contact.

    q_k' = v_k,   v_k' = P_k sin(w t + phase) - c_k v_k - omega_k^2 q_k - phi_k N
    N = 0 in flight, k d in a linear contact, k d^(3/2) in Hertz's;   d = sum phi_k q_k - gap

    flight --d rises--> Newton's law: v_k -> v_k - phi_k (1 + e) d'/sum phi^2, and on in flight; else contact
    contact --d falls--> flight

In contact N is not cut off for d < 0 (Hertz's is continued by zero), so that the right-hand side is smooth
past the release, within the step that finds it. What is watched rises through zero: d less a bound of its
rounding in flight, -d in contact. Absolute tolerances follow from one energy: with V the largest of |q'|,
|omega q| over the start, the steady motion and a motion that reaches the stop, velocities get tolerance V,
displacements tolerance V/omega_k. The right-hand side is compiled; in numpy it would make SciPy and CVODE a
third slower.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from beam import InvalidType, InvalidValue
from contact import (
    Chatter,
    ContactError,
    HertzContact,
    ImpactOscillator,
    Impacts,
    LinearContact,
    NewtonRestitution,
    State,
    Trajectory,
)
from contact.integrators import Plan

EPS = 2.220446049250313e-16

FLIGHT, LINEAR, HERTZ = 0, 1, 2  # what a piece is, for the kernel

MOST_IMPACTS = 2000
"""Bound of impacts in one period: with so many the tip is on its way to rest, which is not followed, or the
solver finds one event after another at one time."""

Array = NDArray[np.float64]
compiled: Any = numba.njit(cache=True, nogil=True)


class Piece(NamedTuple):
    """How far a solver came: time, state, whether an event ended it, the states at the times passed, and what
    it has spent."""

    end: float
    state: Array
    event: bool
    samples: Array
    evaluations: int


Advance = Callable[[bool, float, Array, Array], Piece]
"""advance(contact, begin, y, times) -> Piece: to the first event or to the last of `times`."""


@compiled
def penetration(y: Array, modes: Array, scalars: Array) -> float:
    """d [m]."""
    depth = -scalars[2]
    for k in range(modes.shape[1]):
        depth += modes[2, k] * y[k]
    return depth


@compiled
def rates(t: float, y: Array, out: Array, modes: Array, scalars: Array, kind: int) -> None:
    """Fill `out` with dy/dt; `modes` (4, n): omega^2, c, phi, P; `scalars`: w, phase, gap, k."""
    n = modes.shape[1]
    depth, force, shake = penetration(y, modes, scalars), 0.0, math.sin(scalars[0] * t + scalars[1])
    if kind == LINEAR:
        force = scalars[3] * depth
    elif kind == HERTZ and depth > 0.0:
        force = scalars[3] * depth * math.sqrt(depth)
    for k in range(n):
        out[k] = y[n + k]
        out[n + k] = modes[3, k] * shake - modes[1, k] * y[n + k] - modes[0, k] * y[k] - modes[2, k] * force


def numbers_of(oscillator: ImpactOscillator, clock: float = 0.0) -> tuple[Array, Array]:
    """`modes` and `scalars` of `rates`; times count from the drive time `clock` [s]."""
    model, drive, stop = oscillator.model, oscillator.drive, oscillator.stop
    amplitude, w = (0.0, 0.0) if drive is None else (drive.amplitude, drive.angular_frequency)
    push = model.participation * amplitude * w**2
    modes = np.ascontiguousarray([model.omega**2, model.decay_rate, model.phi, push])
    return modes, np.array([w, w * clock, stop.gap, stop.law.numbers[0]])


class Equations:
    """The equations of a plan; times count from its start."""

    def __init__(self, oscillator: ImpactOscillator, plan: Plan, tolerance: float) -> None:
        model, law, drive = oscillator.model, oscillator.stop.law, oscillator.drive
        self.hard = law.code == NewtonRestitution.code and law.table.size == 0  # a constant restitution
        self.hertz = law.code == HertzContact.code
        elastic = (self.hertz or law.code == LinearContact.code) and not any(law.numbers[1:])
        if not (self.hard or elastic) or oscillator.load is not None:
            raise InvalidType(
                f"law of the stop is {law}; outside solvers follow elastic contacts without load"
            )
        self.oscillator, self.start, self.tolerance = oscillator, plan.start, tolerance
        self.n, self.phi = oscillator.n_modes, model.phi
        self.compliance, self.number = float(model.phi @ model.phi), law.numbers[0]
        self.modes, self.scalars = numbers_of(oscillator, plan.clock)
        w, amplitude = float(self.scalars[0]), 0.0 if drive is None else drive.amplitude
        lowest = w if w > 0.0 else 2.0 * math.pi / oscillator.period
        omega = np.maximum(model.omega, lowest)
        vectors = (
            plan.start.velocity,
            model.omega * plan.start.displacement,
            amplitude * lowest * np.abs(oscillator.steady_response()),
        )
        reach = lowest * oscillator.stop.gap / math.sqrt(self.compliance)
        speed = max(reach, *(float(np.linalg.norm(vector)) for vector in vectors)) or 1.0
        self.absolute = tolerance * np.concatenate([speed / omega, np.full(self.n, speed)])
        self.rounding = 32.0 * EPS * (oscillator.stop.gap + float(np.abs(model.phi) @ (speed / omega)))

    def tip(self, y: Array) -> tuple[float, float]:
        """Penetration [m] and its rate [m/s]."""
        return float(penetration(y, self.modes, self.scalars)), float(self.phi @ y[self.n :])

    def rates(self, contact: bool, t: float, y: Array, out: Array) -> Array:
        """Fill `out`, shape (2 n_modes,), with dy/dt and return it."""
        rates(t, y, out, self.modes, self.scalars, (HERTZ if self.hertz else LINEAR) if contact else FLIGHT)
        return out

    def jacobian(self, contact: bool, y: Array) -> Array:
        """The derivatives of the rates, shape (2 n_modes, 2 n_modes)."""
        n, slope = self.n, 0.0
        if contact:
            depth = self.tip(y)[0]
            slope = 1.5 * self.number * math.sqrt(max(depth, 0.0)) if self.hertz else self.number
        stiffness = np.diag(self.modes[0]) + slope * np.outer(self.phi, self.phi)
        return np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -np.diag(self.modes[1])]])

    def surface(self, contact: bool, begin: float, t: float, y: Array) -> float:
        """What rises through zero at the event of a piece that began at `begin`, on the surface."""
        depth = float(penetration(y, self.modes, self.scalars))
        value = -depth if contact else depth - self.rounding
        return -abs(value) - 1e-300 if t <= begin else value

    def failed(
        self, s: float, y: Array, detail: str, kind: type[ContactError] = ContactError
    ) -> ContactError:
        """The error at the place where a solver has stopped."""
        depth, rate = self.tip(np.nan_to_num(y))
        return kind(time=self.start.time + s, gap=-depth, velocity=rate, detail=detail)

    def touch(self, y: Array) -> tuple[bool, Array, Array]:
        """Whether a contact begins, the states just before and just after the touch; the root finding leaves
        a trace of penetration, which would be found again."""
        n, before = self.n, y.copy()
        before[:n] -= self.phi * self.tip(y)[0] / self.compliance
        after = before.copy()
        if self.hard:
            after[n:] -= self.phi * (1.0 + self.number) * self.tip(y)[1] / self.compliance
        return not self.hard, before, after

    def impacts(self, touches: list[tuple[float, Array]], releases: list[tuple[float, Array]]) -> Impacts:
        """The touches as named arrays; a contact that has not ended has no release."""
        n, open_ended = self.n, len(touches) - len(releases)
        closed = [*releases, *[(math.nan, np.full(2 * n, np.nan))] * open_ended]
        begin, end = (np.array([s for s, _y in log]).reshape(-1) for log in (touches, closed))
        before, after = (np.array([y for _s, y in log]).reshape(-1, 2 * n) for log in (touches, closed))
        approach, rebound = before[:, n:] @ self.phi, after[:, n:] @ self.phi
        return Impacts.of_states(
            self.oscillator,
            times=self.start.time + np.array([begin, end]),
            states=np.array([before, after]).reshape(2, -1, 2, n),
            approach=approach,
            rebound=rebound,
            loss=0.5 * (approach**2 - rebound**2) / self.compliance if self.hard else 0.0 * rebound,
            impulse=(approach - rebound) / self.compliance if self.hard else np.nan * rebound,
            kind=np.zeros(begin.size, np.int64),
        )


def pieced(
    oscillator: ImpactOscillator, plan: Plan, tolerance: float, solver: Callable[[Equations], Advance]
) -> Trajectory:
    """The motion of `plan`, from one event to the next."""
    e = Equations(oscillator, plan, tolerance)
    n, period, start, advance = e.n, oscillator.period, plan.start, solver(e)
    y = np.concatenate([start.displacement, start.velocity])
    depth, rate = e.tip(y)
    if start.regime != 0 or depth > e.rounding:
        raise InvalidValue(
            f"regime of the state is {start.regime}, {depth:.3g} m behind the stop; outside "
            "solvers begin off the stop"
        )
    touches, releases = list[tuple[float, Array]](), list[tuple[float, Array]]()

    def touched(s: float, y: Array) -> tuple[bool, Array]:
        contact, before, after = e.touch(y)
        touches.append((s, before))
        if not contact:
            releases.append((s, after))
        return contact, after

    contact, y = touched(0.0, y) if depth >= -e.rounding and rate > 0.0 else (False, y)
    passed = np.arange(plan.first + 1, plan.last + 1)
    strobe = np.clip((passed - plan.first) * period - plan.clock, 0.0, plan.length)
    sample = np.clip(
        (plan.sample_stretch - plan.first) * period + plan.sample_clock - plan.clock, 0.0, plan.length
    )
    times, place = np.unique(np.concatenate([strobe, sample, [plan.length]]), return_inverse=True)
    states, reached, s = np.empty((times.size, 2 * n)), 0, 0.0
    spent, slack = 0, 8.0 * EPS * plan.length
    while True:
        while reached < times.size and times[reached] <= s + slack:
            states[reached] = y
            reached += 1
        if reached == times.size:
            break
        piece = advance(contact, s, y, times[reached:])
        states[reached : reached + len(piece.samples)] = piece.samples
        reached, spent = reached + len(piece.samples), spent + piece.evaluations
        s, y = piece.end, piece.state
        if not np.all(np.isfinite(y)):
            raise e.failed(s, y, "the state is not finite")
        if piece.event and contact:
            contact = False
            releases.append((s, y))
        elif piece.event:
            contact, y = touched(s, y)
        if len(touches) > MOST_IMPACTS and s - touches[-MOST_IMPACTS][0] < period:
            raise e.failed(s, y, f"more than {MOST_IMPACTS} in one period", Chatter)
    begun = [s for s, _y in touches]
    counts = np.bincount(np.searchsorted(strobe, begun), minlength=passed.size + 1)[: passed.size]
    at_strobe, at_sample, last = np.split(states[place], [passed.size, passed.size + sample.size])
    end = State(
        displacement=last[0, :n],
        velocity=last[0, n:],
        time=plan.last * period + plan.clock_end,
        regime=int(contact),
    )
    return Trajectory(
        oscillator=oscillator,
        end=end,
        strobe_time=passed * period,
        strobe_displacement=at_strobe[:, :n],
        strobe_velocity=at_strobe[:, n:],
        strobe_impacts=counts.astype(np.int64),
        time=plan.times,
        displacement=at_sample[:, :n],
        velocity=at_sample[:, n:],
        impacts=e.impacts(touches, releases),
        evaluations=spent,
    )
