r"""Accumulating impacts: infinitely many in a finite time, and what becomes of methods that count them.

A ball dropped from h rebounds with e times its speed; its impacts fall at

    t_n = t_0 (1 + 2 (e + ... + e^n)),   t_0 = sqrt(2 h/g),   t_inf = t_0 (1 + e)/(1 - e).                 (a)

The package computes hops until their height drowns in rounding, (v e^n)^2 <= 2 g L with L the lowest hop
(``contact.touch.newton.lowest_hop``), sums the rest and lets the ball lie. The number of hops that are
computed is ln(v / sqrt(2 g L)) / ln(1/e); if it exceeds the bound ``MOST_IMPACTS`` of one drive period, which
with e below 1 needs 1 - e of some 1e-4 and less, the run ends with ``Chatter``.

Two loops as they are often written, for contrast, both with a bound on the events:

* closed form, no sum: flight times 2 v e^n/g are added up to the clock until they no longer move it,
  2 v e^n/g < eps t_inf/2: from then on events go on at a standing clock (Zeno).
* solve_ivp with a terminal event, restarted with -e times the velocity: once a hop is shorter than what
  the event detection resolves, no change of sign is seen and the ball falls through the floor.

A driven mode that is held: the stop lets it go when the force that holds it vanishes, Z w^2 sin(w t) =
omega^2 gap on the falling side (one mode, phi = Gamma = 1).                                               (b)

Units: SI. Number to compare with: h = 1 m, g = 9.81 m/s^2, e = 0.7 gives 2.55863 s.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from beam.reduction import ModalModel
from contact.drive import HarmonicDrive
from contact.errors import Chatter, ContactError
from contact.event_loop import MOST_IMPACTS
from contact.flight.modal_flow import tip_rounding
from contact.laws import NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.touch.newton import lowest_hop
from contact.trajectory import ImpactKind, State
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.peers import lineup
from studies.instruments.scene import Scene
from studies.instruments.stability.accumulation_figures import draw_accumulation
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.findings import Findings, Limit

__all__ = [
    "ball", "counting_loop", "draw", "event_loop", "last_hops", "measure", "most_elastic", "rest_time",
    "time_of_rest",
]  # fmt: skip

NAME = "event-driven"
HEIGHT, GRAVITY = 1.0, 9.81
RESTITUTIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999)
MOST_EVENTS = 20_000
"""Bound of the events of the two loops: fifty times what e = 0.9 needs to run into rounding."""


def ball(restitution: float, height: float = HEIGHT) -> ImpactOscillator:
    """Unit mass that falls through `height` [m] onto a floor."""
    none, one = np.zeros(1), np.ones(1)
    return ImpactOscillator(
        model=ModalModel(omega=none, decay_rate=none, phi=one, participation=none),
        stop=Stop(gap=height, law=NewtonRestitution(local_restitution=restitution)),
        load=GRAVITY * one,
    )


def rest_time(restitution: float) -> float:
    """t_inf of (a) [s]."""
    return math.sqrt(2.0 * HEIGHT / GRAVITY) * (1.0 + restitution) / (1.0 - restitution)


def time_of_rest(restitution: float) -> tuple[float, int]:
    """When the package lets the ball lie [s], and how many impacts it has computed."""
    run = simulate(ball(restitution), duration=1.1 * rest_time(restitution))
    stay = np.flatnonzero(run.impacts.kind == ImpactKind.STAY)
    if stay.size != 1:
        raise ValueError(f"restitution is {restitution}; the ball rests {stay.size} times instead of once")
    i = int(stay[0])
    left = 2.0 * abs(float(run.impacts.approach[i])) / (GRAVITY * (1.0 - restitution))
    return float(run.impacts.start[i]) + left, i


def counting_loop(restitution: float) -> tuple[float, int, np.ndarray]:
    """Clock and number of events at which the clock has stopped moving, and the clock after each event."""
    speed = math.sqrt(2.0 * GRAVITY * HEIGHT)
    clock, clocks = speed / GRAVITY, []
    for n in range(MOST_EVENTS):
        speed *= restitution
        after = clock + 2.0 * speed / GRAVITY
        clocks.append(after)
        if after == clock:
            return clock, n, np.array(clocks)
        clock = after
    raise ValueError(f"restitution is {restitution}; the clock still moves after {MOST_EVENTS} events")


def event_loop(restitution: float, tolerance: float) -> tuple[str, np.ndarray]:
    """How solve_ivp, restarted at its events, ends, and the times of its events [s]."""

    def height(_t: float, y: np.ndarray) -> float:
        return float(y[0])

    setattr(height, "terminal", True)  # noqa: B010
    setattr(height, "direction", -1)  # noqa: B010
    end = 1.5 * rest_time(restitution)
    times: list[float] = []
    t, y = 0.0, np.array([HEIGHT, 0.0])
    while len(times) < MOST_EVENTS:
        found = solve_ivp(
            lambda _t, y: [y[1], -GRAVITY], (t, end), y, events=height, rtol=tolerance, atol=tolerance
        )
        if found.status == 0:
            fell = found.y[0, -1]
            return ("falls through" if fell < -1e-6 * HEIGHT else "lies"), np.array(times)
        after = float(found.t[-1])
        times.append(after)
        if len(times) > 50 and times[-1] == times[-50]:
            return "stands still", np.array(times)
        t, y = after, np.array([found.y[0, -1], -restitution * found.y[1, -1]])
    return "runs out of events", np.array(times)


def _rests(restitutions: tuple[float, ...]) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The package against (a)."""
    limits, times, counts = [], [], []
    for e in restitutions:
        found, count = time_of_rest(e)
        times.append(found)
        counts.append(count)
        limits.append(
            Limit(
                method=NAME, case=f"bouncing ball comes to rest, e = {e:g}", knob="time of rest [s]",
                theory=rest_time(e), measured=found, refused=None,
                note=f"relative error {abs(found / rest_time(e) - 1):.1e}; {count} impacts computed, the "
                "rest summed, then the ball lies",
            )
        )  # fmt: skip
    return limits, {"restitution": np.array(restitutions), "rest": np.array(times), "count": np.array(counts)}


def last_hops(left: float) -> tuple[ImpactOscillator, State]:
    """A ball on the floor with 1 - e = `left`, and a speed whose hops last half a period (1 s) together."""
    height = 1e-3
    state = State(displacement=np.array([height]), velocity=np.array([-0.25 * GRAVITY * left]))
    return ball(1.0 - left, height), state


def expected_impacts(left: float) -> float:
    """Hops from the first speed of `last_hops` to that of the lowest hop."""
    oscillator, state = last_hops(left)
    rounding = tip_rounding(oscillator.motion(), np.array(state.displacement), np.zeros(1))
    lowest = math.sqrt(2.0 * GRAVITY * lowest_hop(1.0 - left, rounding))
    return math.log(abs(float(state.velocity[0])) / lowest) / -math.log1p(-left)


def most_elastic() -> float:
    """The 1 - e at which the hops expected are as many as a period may hold."""
    return bisect(lambda left: expected_impacts(left) > MOST_IMPACTS, 1e-2, 1e-5, relative=1e-9)


def _bound(quick: bool) -> Limit:
    """How elastic the law may be until a drive period holds too many impacts."""

    def chatters(left: float) -> bool:
        oscillator, state = last_hops(left)
        try:
            simulate(oscillator, state, duration=0.9)
        except Chatter:
            return True
        return False

    theory = most_elastic()
    measured = bisect(chatters, 1.3 * theory, 0.75 * theory, relative=0.05 if quick else 1e-3)
    return Limit(
        method=NAME, case="ball on its last hops within one period", knob="1 - e [1]", theory=theory,
        measured=measured, refused=chatters(0.9 * measured),
        note=f"Chatter: more than {MOST_IMPACTS} impacts in one period; {expected_impacts(measured):.0f} are "
        "expected at the limit found",
    )  # fmt: skip


def _loops(quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The two loops without a sum."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {}
    for e in (0.7,) if quick else (0.5, 0.7, 0.9):
        clock, stopped, clocks = counting_loop(e)
        fall = math.sqrt(2.0 * HEIGHT / GRAVITY)
        half_step = 0.5 * math.ulp(rest_time(e))
        theory = math.log(half_step / (2.0 * fall)) / math.log(e)
        limits.append(
            Limit(
                method="loop in closed form, no sum", case=f"bouncing ball, e = {e:g}: the clock stops",
                knob="number of the event [1]", theory=theory, measured=float(stopped), refused=False,
                note=f"at t = {clock:.9g} s; every further event falls at the same time: without a bound the "
                "loop never ends",
            )
        )  # fmt: skip
        arrays[f"left_closed_{e:g}"] = rest_time(e) - clocks
        for tolerance in (1e-6, 1e-12):
            how, times = event_loop(e, tolerance)
            left = rest_time(e) - times
            arrays[f"left_ivp_{tolerance:g}_{e:g}"] = left
            limits.append(
                Limit(
                    method="scipy RK45, restarted at events",
                    case=f"bouncing ball, e = {e:g}, tolerance {tolerance:g}: {how}",
                    knob="number of the last event [1]", theory=None, measured=float(times.size),
                    refused=False,
                    note=f"{left[-1]:.1e} s before the accumulation, {how} without a word; the default has "
                    f"{time_of_rest(e)[1]} impacts and then a ball at rest",
                )
            )  # fmt: skip
    return limits, arrays


def _peers() -> list[Limit]:
    """Outside solvers with care taken for the accumulation."""
    limits = []
    theory = rest_time(0.7)
    for name, method in lineup(1e-10).items():
        try:
            run = simulate(ball(0.7), duration=1.5 * theory, method=method)
        except ContactError as error:
            limits.append(
                Limit(
                    method=name, case="bouncing ball comes to rest, e = 0.7", knob="time of rest [s]",
                    theory=theory, measured=None, refused=True, note=f"{type(error).__name__}: {error}",
                )
            )  # fmt: skip
            continue
        stay = run.impacts.start[run.impacts.kind == ImpactKind.STAY]
        hops = np.count_nonzero(run.impacts.kind == ImpactKind.IMPACT)
        off = abs(float(run.end.displacement[0]) - HEIGHT)
        limits.append(
            Limit(
                method=name, case="bouncing ball comes to rest, e = 0.7", knob="time of rest [s]",
                theory=theory, measured=float(stay[0]) if stay.size else None, refused=None,
                note=f"tolerance 1e-10; {hops} impacts, then held because hops are below the tolerance; in "
                f"the end {off:.1e} m off the floor",
            )
        )  # fmt: skip
    return limits


def _driven(scene: Scene, periods: int) -> list[Limit]:
    """The single mode of the scene, e = 0.7, driven slowly and so hard that it is held in every period."""
    plain = single_mode_oscillator(scene, 1.0)
    frequency = 0.2 * float(plain.model.omega[0]) / (2.0 * math.pi)
    oscillator = ImpactOscillator(
        model=plain.model, drive=HarmonicDrive(frequency=frequency),
        stop=Stop(gap=plain.stop.gap, law=NewtonRestitution(local_restitution=0.7)),
    )  # fmt: skip
    push = oscillator.model.participation[0] * (2.0 * math.pi * frequency) ** 2
    amplitude = 3.0 * oscillator.model.omega[0] ** 2 * oscillator.stop.gap / push
    oscillator = oscillator.with_amplitude(amplitude)
    run = simulate(oscillator, periods=periods)
    held = (run.impacts.kind == ImpactKind.STAY) & np.isfinite(run.impacts.end)
    if not held.any():
        raise ValueError(f"the single mode at {frequency:g} Hz is not held within {periods} periods")
    phase = np.mod(run.impacts.end[held] * frequency, 1.0)
    theory = 0.5 - math.asin(1.0 / 3.0) / (2.0 * math.pi)
    hops = np.count_nonzero(run.impacts.kind == ImpactKind.IMPACT)
    return [
        Limit(
            method=NAME, case=f"driven single mode, e = 0.7, {periods} periods: held and let go",
            knob="drive phase of the release [1]", theory=theory, measured=float(phase[-1]), refused=None,
            note=f"{int(held.sum())} stays after {hops} impacts; largest departure of a release from (b) "
            f"{np.abs(phase - theory).max():.1e} periods",
        )
    ]  # fmt: skip


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Times of rest, the bound of the impacts, and how far loops without a sum get."""
    rests, table = _rests(RESTITUTIONS[1:6:2] if quick else RESTITUTIONS)
    loops, arrays = _loops(quick)
    limits = [*rests, _bound(quick), *loops, *_peers(), *_driven(scene, 20 if quick else 200)]
    return Findings(limits=limits, arrays={**table, **arrays})


def draw(findings: Findings, record: Any) -> None:
    """Error of the time of rest, and the time left over the events."""
    record.write_figure(draw_accumulation(findings.arrays, rest_time), "accumulation")
