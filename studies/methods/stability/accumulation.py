r"""Accumulating impacts: infinitely many in a finite time, and what becomes of a loop that counts them.

A ball dropped from h rebounds with e times its speed; its impacts fall at

    t_n = t_0 (1 + 2 (e + ... + e^n)),   t_0 = sqrt(2 h/g),   t_inf = t_0 (1 + e)/(1 - e).                 (a)

The package computes hops until their height drowns in rounding, sums the rest and lets the ball lie. For
contrast a loop as it is often written: solve_ivp with a terminal event, restarted with -e times the velocity.
Once a hop is shorter than what the event detection resolves, no change of sign is seen and the ball falls
through the floor.

Number to compare with: h = 1 m, g = 9.81 m/s^2, e = 0.7 gives t_inf = 2.55863 s.
"""

import math
from functools import partial

import numpy as np
from scipy.integrate import solve_ivp

from beam import ModalModel
from contact import ImpactKind, ImpactOscillator, NewtonRestitution, Stop, simulate
from studies.methods.stability.model import Findings, Limit
from studies.shell.scene import Scene

HEIGHT, GRAVITY = 1.0, 9.81
MOST_EVENTS = 1000  # bound of the events of the loop: three times what e = 0.9 needs to fall through
TOLERANCES = (1e-12, 1e-6)

entry = partial(Limit, family="accumulation")


def ball(restitution: float) -> ImpactOscillator:
    """Unit mass that falls through `HEIGHT` onto a floor."""
    none, one = np.zeros(1), np.ones(1)
    model = ModalModel(omega=none, decay_rate=none, phi=one, participation=none)
    stop = Stop(gap=HEIGHT, law=NewtonRestitution(local_restitution=restitution))
    return ImpactOscillator(model=model, stop=stop, load=GRAVITY * one)


def rest_time(restitution: float) -> float:
    """t_inf of (a) [s]."""
    return math.sqrt(2.0 * HEIGHT / GRAVITY) * (1.0 + restitution) / (1.0 - restitution)


def time_of_rest(restitution: float) -> tuple[float, int]:
    """When the package lets the ball lie [s], and how many impacts it has computed."""
    impacts = simulate(ball(restitution), duration=1.1 * rest_time(restitution)).impacts
    (stay,) = np.flatnonzero(impacts.kind == ImpactKind.STAY)
    left = 2.0 * abs(float(impacts.approach[stay])) / (GRAVITY * (1.0 - restitution))
    return float(impacts.start[stay]) + left, int(stay)


def event_loop(restitution: float, tolerance: float) -> tuple[str, np.ndarray]:
    """How solve_ivp, restarted at its events, ends, and the times of its events [s]."""

    def height(_t: float, y: np.ndarray) -> float:
        return float(y[0])

    height.terminal, height.direction = True, -1  # type: ignore[attr-defined]
    times: list[float] = []
    end, t, y = 1.5 * rest_time(restitution), 0.0, np.array([HEIGHT, 0.0])
    for _ in range(MOST_EVENTS):
        found = solve_ivp(
            lambda _t, y: [y[1], -GRAVITY], (t, end), y, events=height, rtol=tolerance, atol=tolerance
        )
        t, y = float(found.t[-1]), found.y[:, -1] * (1.0, -restitution)
        if found.status == 0:
            break
        times.append(t)
    return "falls through" if y[0] < -1e-6 * HEIGHT else "lies", np.array(times)


def measure(scene: Scene, quick: bool) -> Findings:
    """Times of rest of the package, and how far the loop gets; nothing depends on the scene."""
    limits = list[Limit]()
    rest = partial(entry, method="event-driven", parameter="time of rest", unit="s")
    for e in [0.3, 0.7, 0.9] if quick else [0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999]:
        at, count = time_of_rest(e)
        case, theory = f"bouncing ball, e = {e:g}, rests after {count} impacts", rest_time(e)
        limits.append(rest(case=case, theory=theory, measured=at))
    row = partial(entry, method="scipy RK45, restarted at events", parameter="number of the last event")
    for e in (0.7,) if quick else (0.5, 0.7, 0.9):
        for tolerance in TOLERANCES:
            how, times = event_loop(e, tolerance)
            case = f"bouncing ball, e = {e:g}, tolerance {tolerance:g}: {how}"
            limits.append(row(case=case, theory=None, measured=float(times.size), refused=False))
    return limits, {}
