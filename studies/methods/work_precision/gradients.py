"""Error and cost of a gradient through impacts: exact derivatives beside differences.

Differentiated is a motion of Eq. (1): time of its last impact, displacement and velocity at its last strobe,
by the six parameters of `NAMES`.

    exact        tangents through flights and impacts (contact.sensitivity.derivatives)
    differences  central, of the same motion, at relative steps of 1e-3 ... 1e-12

An error is the norm over 18 numbers, each parameter in units of its value, each result in units of its
largest derivative, against differences of the closed form in 60 digits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from mpmath import matrix, mp, mpf
from numpy.typing import NDArray

from contact import ImpactOscillator, State, simulate
from contact.orbits import motion_derivatives
from studies.methods.work_precision.model import timed
from studies.physics.parameters import changes_of, parameters_of, with_values

Array = NDArray[np.float64]

NAMES = ("free_period", "decay_rate", "gap", "restitution", "frequency", "amplitude")
PERIODS, REPEATS = 20, 11  # drive periods; runs of which the median processor time counts
POLISHED = 3  # steps of Newton's method from the 16 digits of a double to 60 and more


@dataclass(frozen=True, kw_only=True)
class Gradient:
    """A way to the gradient, at a step."""

    method: Annotated[str, "method"]
    setting: Annotated[float | None, "step of each parameter; relative to it"]
    error: Annotated[float | None, "error of the gradient; none where the step loses or adds an impact"]
    time_ms: Annotated[float, "time of a gradient [ms]"]


def motion_of(oscillator: ImpactOscillator) -> tuple[State, Array, Array]:
    """Start, parameters and impact times of the motion."""
    gap, known = oscillator.stop.gap, parameters_of(oscillator)
    start = State(displacement=np.array([0.5 * gap]), velocity=np.array([0.12 * oscillator.unit_speed]))
    hits = simulate(oscillator, start, periods=PERIODS).impacts.start
    return start, np.array([known[name].value for name in NAMES]), hits


def closed_form(values: Sequence[mpf], start: State, hits: Array) -> list[mpf]:
    """The three results in mpmath's precision: exponentials of the matrix of (x, v, sin w t, cos w t), impact
    times polished by Newton's method."""
    period, c, gap, tau, f, amplitude = values
    w, square, begun = 2 * mp.pi * f, (2 * mp.pi / period) ** 2 + c**2 / 4, mpf(0)
    rates = matrix([[0, 1, 0, 0], [-square, -c, amplitude * w**2, 0], [0, 0, 0, w], [0, 0, -w, 0]])
    y = matrix([float(start.displacement[0]), float(start.velocity[0]), 0, 1])
    for hit in hits:
        t = mpf(float(hit))
        for _ in range(POLISHED):
            there = mp.expm(rates * (t - begun)) * y
            t -= (there[0] - gap) / there[1]
        y, begun = mp.expm(rates * (t - begun)) * y, t
        y[1] *= -tau
    y = mp.expm(rates * (PERIODS / f - begun)) * y
    return [begun, y[0], y[1]]


def reference(values: Array, start: State, hits: Array) -> Array:
    """Derivatives of the closed form times the parameters, shape (3, 6)."""
    with mp.workdps(60):
        step, columns, given = mpf(10) ** -20, [], [mpf(x) for x in values.tolist()]
        for k in range(len(NAMES)):
            ends = ([*given[:k], given[k] * (1 + by), *given[k + 1 :]] for by in (step, -step))
            above, below = (closed_form(end, start, hits) for end in ends)
            columns.append([float((a - b) / (2 * step)) for a, b in zip(above, below, strict=True)])
    return np.array(columns).T


def gradients(oscillator: ImpactOscillator) -> list[Gradient]:
    """Measure every way to the gradient; the oscillator is Eq. (1)."""
    start, values, hits = motion_of(oscillator)
    truth, rows = reference(values, start, hits), list[Gradient]()
    scale = np.abs(truth).max(axis=1)[:, None]

    def results(at: Array) -> list[float]:
        there = with_values(oscillator, dict(zip(NAMES, at.tolist(), strict=True)))
        run = simulate(there, start, periods=PERIODS)
        last = run.impacts.start[-1] if len(run.impacts) == hits.size else np.nan
        return [last, run.strobe_displacement[-1, 0], run.strobe_velocity[-1, 0]]

    def exact() -> Array:
        found = motion_derivatives(oscillator, start, changes_of(oscillator, NAMES), periods=PERIODS)
        return np.vstack([found.impact_time[-1, 2:], found.strobes[-1, :, 2:]]) * values

    def differences(step: float) -> Array:
        ends = [[results(values * (1.0 + by * unit)) for unit in np.eye(6)] for by in (step, -step)]
        return (np.array(ends[0]) - np.array(ends[1])).T / (2.0 * step)

    def measured(method: str, setting: float | None, compute: Callable[[], Array]) -> None:
        found = compute()
        error = float(np.linalg.norm((found - truth) / scale) / np.linalg.norm(truth / scale))
        rows.append(
            Gradient(
                method=method,
                setting=setting,
                error=error if np.isfinite(error) else None,
                time_ms=1e-3 * timed(compute, REPEATS),
            )
        )

    measured("exact", None, exact)
    for step in np.logspace(-3, -12, 10):
        measured("central differences", step, partial(differences, step))
    return rows
