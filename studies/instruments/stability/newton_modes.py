r"""Newton's law at the tip as modes are added: what one impact does goes to zero without a tip mass.

The impulse of an impact acts on the tip alone, so that one impact which finds the higher modes at rest takes
the part

    kick = (1 + e) r_N,   r_N = phi_1^2 / sum_{k <= N} phi_k^2                                             (a)

of the velocity of mode 1. All modes of a bare cantilever have the same phi^2, hence r_N = 1/N: the law has no
limit, and mode 1 is stopped, if at all, by many impacts in quick succession, whose number grows with N. With
a mass M at the tip sum phi^2 -> 1/M and r_N -> M phi_1^2, an error of the order 1/N.

Measured on the exact modes of a straight cantilever (``beam.frequency_equation``) with the first frequency at
24.5 Hz, one per cent of damping in each mode and a gap of 10.7 mm: the jump of mode 1 in one impact, and the
whole collision at excess 0.013 and 22.2 Hz (``contact.collision``): its kick, number of impacts and cost.

Nothing is refused here: each finite number of modes is a well-posed problem, followed exactly. What a user
has to know is that with a light tip a single impact says nothing, that its number is an artefact of the
number of modes, and that only the collision as a whole has a limit.

Units: those of the beam with L = EI = m = 1, times scaled to 24.5 Hz.
"""

from __future__ import annotations

import math
import time
from functools import cache
from typing import Any

import numpy as np

from beam.frequency_equation import ExactModes, UniformBeam, exact_modes
from beam.reduction import ModalModel
from contact.collision import Collision, before_collision, collisions
from contact.drive import HarmonicDrive
from contact.errors import ContactError
from contact.laws import NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.scene import Scene
from studies.instruments.stability.bisection import bisect_count
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.newton_figures import draw_newton

__all__ = ["cantilever_modes", "draw", "measure", "mode_share", "one_impact", "whole_collision"]

NAME = "event-driven"
MOST_MODES = 100
MASSES = (0.0, 0.1, 0.3, 1.0)
"""Tip mass over the mass of the beam [1]."""
FREQUENCY, FIRST, GAP, EXCESS = 22.2, 24.5, 0.0107, 0.013
SMALL = 0.05
"""Part of the velocity of mode 1, over 1 + e, below which one impact is called lost."""


@cache
def cantilever(mass: float) -> ExactModes:
    """Exact modes of the unit cantilever with a tip mass."""
    beam = UniformBeam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0, tip_mass=mass)
    return exact_modes(beam, MOST_MODES)


def mode_share(mass: float, count: int) -> float:
    """r_N [1]."""
    phi = cantilever(mass).phi[:count]
    return float(phi[0] ** 2 / (phi @ phi))


def cantilever_modes(mass: float, count: int) -> ModalModel:
    """The first `count` modes with the first at `FIRST` Hz."""
    modes = cantilever(mass)
    omega = modes.omega[:count] * (2.0 * math.pi * FIRST / modes.omega[0])
    return ModalModel(
        omega=omega, decay_rate=0.02 * omega, phi=modes.phi[:count],
        participation=modes.participation[:count], tip_mass=mass,
    )  # fmt: skip


def one_impact(mass: float, count: int, restitution: float) -> float:
    """Part of its velocity that mode 1 loses in one impact that finds the other modes at rest [1]."""
    model = cantilever_modes(mass, count)
    law = NewtonRestitution(local_restitution=restitution)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=GAP, law=law))
    velocity = np.zeros(count)
    velocity[0] = 3.0 * GAP * model.omega[0] / model.phi[0]
    run = simulate(oscillator, State(displacement=np.zeros(count), velocity=velocity), duration=0.01)
    impacts = run.impacts
    jump = impacts.velocity_end[0, 0] - impacts.velocity_start[0, 0]
    return float(-model.phi[0] * jump / impacts.approach[0])


def whole_collision(mass: float, count: int, restitution: float) -> tuple[Collision, int, float]:
    """The collision that ends the steady motion at `EXCESS`, the flights of its run, and the time it took."""
    oscillator = ImpactOscillator(
        model=cantilever_modes(mass, count), drive=HarmonicDrive(frequency=FREQUENCY),
        stop=Stop(gap=GAP, law=NewtonRestitution(local_restitution=restitution)),
    ).with_excess(EXCESS)  # fmt: skip
    start = before_collision(oscillator)
    began = time.thread_time()
    run = simulate(oscillator, start, periods=3)
    spent = time.thread_time() - began
    return collisions(oscillator, run, unfinished="drop")[0], run.evaluations, spent


def _single(counts: tuple[int, ...], restitution: float) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """One impact."""
    limits, arrays = [], {}
    n = counts[-1]
    for mass in MASSES:
        kicks = np.array([one_impact(mass, count, restitution) for count in counts])
        arrays[f"kick_{mass:g}"] = kicks
        if mass == 0.0:
            limits.append(
                Limit(
                    method=NAME, case=f"one impact of a bare tip, {n} modes, e = {restitution:g}",
                    knob="part of its velocity that mode 1 loses [1]", theory=(1.0 + restitution) / n,
                    measured=float(kicks[-1]), refused=None,
                    note="goes to zero as (1 + e)/N: Newton's law has no limit without a tip mass",
                )
            )  # fmt: skip
            continue
        phi = float(cantilever(mass).phi[0])
        last, before = float(kicks[-1]), float(kicks[-2])
        ratio = counts[-1] / counts[-2]
        limits.append(
            Limit(
                method=NAME,
                case=f"one impact, tip mass {mass:g} of the beam, e = {restitution:g}, N -> infinity",
                knob="part of its velocity that mode 1 loses [1]",
                theory=(1.0 + restitution) * mass * phi * phi,
                measured=last + (last - before) / (ratio - 1.0), refused=None,
                note=f"extrapolated in 1/N from {before:.4f} at {counts[-2]} and {last:.4f} at {n} modes",
            )
        )  # fmt: skip
    first = bisect_count(
        lambda count: one_impact(0.0, count, restitution) < SMALL * (1.0 + restitution) * (1.0 - 1e-9), 1,
        MOST_MODES,
    )  # fmt: skip
    limits.append(
        Limit(
            method=NAME, case=f"one impact of a bare tip takes less than {SMALL:.0%} of (1 + e)",
            knob="number of modes [1]", theory=math.floor(1.0 / SMALL) + 1.0, measured=float(first),
            refused=False, note="accepted without a word; `Collision.impacts` and `.kick` show it",
        )
    )  # fmt: skip
    return limits, arrays


def _whole(counts: tuple[int, ...], restitutions: tuple[float, ...]) -> tuple[list[Limit], dict[str, Any]]:
    """The collision as a whole."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {}
    for mass in MASSES[:3]:
        for e in restitutions:
            rows: list[tuple[float, ...]] = []
            failures = []
            for count in counts:
                try:
                    found, flights, spent = whole_collision(mass, count, e)
                    rows.append((found.kick, found.impacts, flights, spent))
                except ContactError as error:
                    failures.append(f"{count} modes: {type(error).__name__}")
                    rows.append((math.nan, math.nan, math.nan, math.nan))
            table = np.array(rows)
            for i, name in enumerate(("kick", "impacts", "flights", "seconds")):
                arrays[f"whole_{name}_{mass:g}_{e:g}"] = table[:, i]
            settled = table[np.isfinite(table[:, 0])]
            tip = "bare tip" if mass == 0.0 else f"tip mass {mass:g}"
            limits.append(
                Limit(
                    method=NAME, case=f"whole collision, {tip}, e = {e:g}, {counts[-1]} modes",
                    knob="kick of the collision [1]", theory=None, measured=float(settled[-1, 0]),
                    refused=True if failures else None,
                    note=f"{settled[-2, 0]:.4f} with {counts[-2]} modes; {int(settled[-1, 1])} impacts, "
                    f"{int(settled[-1, 2])} flights" + "".join(f"; {words}" for words in failures),
                )
            )  # fmt: skip
    bare = arrays[f"whole_impacts_0_{restitutions[-1]:g}"]
    many = np.array(counts) >= 10
    slope = float(np.polyfit(np.log(np.array(counts)[many]), np.log(bare[many]), 1)[0])
    spent = arrays[f"whole_seconds_0_{restitutions[-1]:g}"][-1]
    limits.append(
        Limit(
            method=NAME, case=f"impacts in one collision of a bare tip, e = {restitutions[-1]:g}",
            knob=f"number at {counts[-1]} modes [1]", theory=None, measured=float(bare[-1]), refused=None,
            note=f"grows as N^{slope:.1f} from 10 modes on; three periods take {1e3 * spent:.0f} ms",
        )
    )  # fmt: skip
    return limits, arrays


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Single impacts and whole collisions over the number of modes, on cantilevers of their own."""
    counts = (1, 2, 5, 10, 20) if quick else (1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 56, 80)
    restitutions = (0.5,) if quick else (0.0, 0.5, 1.0)
    limits, arrays = _single(counts, 0.5)
    whole, table = _whole(counts, restitutions)
    limit = np.array([1.5 * mass * float(cantilever(mass).phi[0]) ** 2 for mass in MASSES])
    return Findings(
        limits=[*limits, *whole],
        arrays={
            "count": np.array(counts), "limit": limit, "masses": np.array(MASSES),
            "restitutions": np.array(restitutions), **arrays, **table,
        },
    )  # fmt: skip


def draw(findings: Findings, record: Any) -> None:
    """Kick of one impact and of the collision, and the number of impacts, over the number of modes."""
    record.write_figure(draw_newton(findings.arrays), "newton_modes")
