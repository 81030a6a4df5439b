r"""Accumulating impacts: infinitely many in a finite time, and what becomes of a loop that counts them.

A ball dropped from h rebounds with e times its speed; its impacts fall at

    t_n = t_0 (1 + 2 (e + ... + e^n)),   t_0 = sqrt(2 h/g),   t_inf = t_0 (1 + e)/(1 - e).                 (a)

The package computes hops until their height drowns in rounding, sums the rest and lets the ball lie. For
contrast a loop as it is often written: solve_ivp with a terminal event, restarted with -e times the velocity.
Once a hop is shorter than what the event detection resolves, no change of sign is seen and the ball falls
through the floor.

Number to compare with: h = 1 m, g = 9.81 m/s^2, e = 0.7 gives t_inf = 2.55863 s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from beam import ModalModel
from contact import ImpactKind, ImpactOscillator, NewtonRestitution, Stop, simulate
from studies.methods.stability import Findings, Limit
from studies.shell import plotting
from studies.shell.scene import Scene

HEIGHT, GRAVITY = 1.0, 9.81
MOST_EVENTS = 1000
"""Bound of the events of the loop: three times what e = 0.9 needs to fall through."""
TOLERANCES = (1e-12, 1e-6)
SHOWN = 0.7
"""Restitution of the events that the figure shows one by one."""

Row = partial(Limit, family="accumulation")


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
    restitutions = np.array([0.3, 0.7, 0.9] if quick else [0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999])
    found = np.array([time_of_rest(float(e)) for e in restitutions])
    limits = [
        Row(
            method="event-driven",
            case=f"bouncing ball, e = {e:g}, rests after {count:.0f} impacts",
            parameter="time of rest [s]",
            theory=rest_time(float(e)),
            measured=float(at),
        )
        for e, (at, count) in zip(restitutions, found, strict=True)
    ]
    arrays: dict[str, np.ndarray] = {}
    for e in (SHOWN,) if quick else (0.5, SHOWN, 0.9):
        for tolerance in TOLERANCES:
            how, times = event_loop(e, tolerance)
            arrays[f"events_{tolerance:g}_{e:g}"] = rest_time(e) - times
            limits.append(
                Row(
                    method="scipy RK45, restarted at events",
                    case=f"bouncing ball, e = {e:g}, tolerance {tolerance:g}: {how}",
                    parameter="number of the last event [1]",
                    theory=None,
                    measured=float(times.size),
                    refused=False,
                )
            )
    return limits, arrays


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Time left to the accumulation over the events of the loop."""
    figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.065)
    for number, tolerance in enumerate(TOLERANCES):
        values = np.maximum(np.abs(arrays[f"events_{tolerance:g}_{SHOWN:g}"]), 1e-16)
        n, style = np.arange(1, values.size + 1), plotting.series(number)
        axes.plot(
            n,
            values,
            **style,
            markevery=(number, 5),
            markerfacecolor="none",
            label=f"tolerance {tolerance:g}",
        )
        axes.plot(n[-1:], values[-1:], color=style["color"], marker="Xd"[number], markersize=8)
    axes.set_yscale("log")
    plotting.label(axes.xaxis, "number of the event")
    plotting.label(axes.yaxis, "time left to the accumulation", "s")
    axes.legend(loc="upper right")
    return figure, (
        f"A bouncing ball, e = {SHOWN:g}, by solve_ivp restarted at its events: at the large mark the ball "
        "falls through."
    )
