"""A run of a method with a time step: its march called, what it wrote down turned into named arrays."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from beam.parameters import brief, is_number, require
from contact.errors import ContactError, Diverged, StepTooLarge
from contact.integrators.equation import Equation, equation_of, tip_of
from contact.integrators.grid import (
    DIVERGED,
    END,
    EVALUATIONS,
    FINISHED,
    FULL,
    GRID_FIELDS,
    IN,
    LOGGED,
    LOST,
    OUT,
    SAMPLED,
    START,
    STEP,
    TOO_LARGE,
    TOUCHING,
    Grid,
)
from contact.integrators.method import Run
from contact.laws import DELAYED, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import CONTACT, OUTSIDE, Impacts, State, Trajectory

__all__ = ["check_step", "grid_trajectory"]

March = Callable[[Equation, Grid, np.ndarray, np.ndarray, np.ndarray, int], int]
"""march(equation, grid, q, v, carried, steps) -> status: goes on from step grid.integers[STEP] to `steps`,
overwriting q and v, and `carried`, whatever else the method carries from step to step."""


def check_step(step: float) -> None:
    """ValueError unless `step` is a time step [s]."""
    require(is_number(step) and step > 0, f"step is {brief(step)} s; it must be finite and above zero")


def _place(equation: Equation, time: float, q: np.ndarray, v: np.ndarray) -> dict[str, Any]:
    depth, rate = tip_of(equation, q, v)
    return {"time": time, "gap": -float(depth), "velocity": float(rate)}


def _refuse(equation: Equation, run: Run, step: float, critical: float) -> None:
    """ValueError for a start behind the stop, StepTooLarge for a step that cannot be stable."""
    q, v = run.start.displacement, run.start.velocity
    place = _place(equation, run.start.time, q, v)
    within = step * float(np.abs(equation.phi * v).sum()) + 1e-12 * max(equation.gap, 1e-6)
    if equation.law in (NEWTON, DELAYED) and -place["gap"] > within:
        raise ValueError(
            f"displacement of the state puts the tip {-place['gap']:.3g} m behind the stop; with an impact "
            "law it must start on the near side"
        )
    stiff = equation.number0 if equation.law == LINEAR else 0.0
    if critical <= 0.0 or stiff > critical:
        bears = "it is unstable even in flight" if critical <= 0.0 else f"it bears {critical:.4g} N/m"
        error = StepTooLarge(**place, detail=f"step {step:.4g} s, contact stiffness {stiff:.4g} N/m: {bears}")
        error.step = step
        raise error


def _failure(
    status: int, equation: Equation, run: Run, reached: int, step: float, q: np.ndarray, v: np.ndarray
) -> ContactError:
    place = _place(equation, run.start.time + reached * step, q, v)
    if status == DIVERGED:
        return Diverged(**place)
    error = StepTooLarge(**place, detail=f"step {step:.4g} s: the contact has become too stiff for it")
    error.step = step
    return error


def grid_trajectory(
    oscillator: ImpactOscillator,
    run: Run,
    *,
    step: float,
    march: March,
    carried: np.ndarray,
    critical: float = math.inf,
) -> Trajectory:
    """The motion of `run` on a grid of steps.

    Parameters
    ----------
    oscillator : ImpactOscillator
    run : Run
    step : float
        Time step [s]; strobes, samples and the end of the run need not lie on the grid.
    march : callable
        The method's own loop.
    carried : ndarray
        What it carries from step to step besides q and v.
    critical : float
        Largest contact stiffness that the step bears [N/m].

    Raises
    ------
    ValueError
        For a start behind the stop under an impact law.
    StepTooLarge, Diverged
        See ``contact.errors``.
    """
    n, period, start = oscillator.n_modes, oscillator.period, run.start
    equation = equation_of(oscillator, run.clock)
    _refuse(equation, run, step, critical)
    q, v = np.array(start.displacement), np.array(start.velocity)
    passed = np.arange(run.first + 1, run.last + 1)
    sample = (run.sample_period - run.first) * period + run.sample_clock - run.clock
    capacity = 64
    grid = Grid(
        integers=np.zeros(7, dtype=np.int64),
        log=np.empty((capacity, GRID_FIELDS)),
        log_state=np.empty((capacity, 4 * n)),
        strobe=(passed - run.first) * period - run.clock,
        strobes=np.empty((passed.size, 2 * n)),
        counts=np.zeros(passed.size, dtype=np.int64),
        sample=np.append(sample, run.length),
        samples=np.empty((sample.size + 1, 2 * n)),
    )
    early = int(np.searchsorted(sample, 0.0, side="right"))
    grid.samples[:early] = np.concatenate([q, v])
    grid.integers[SAMPLED] = early
    depth, rate = tip_of(equation, q, v)
    if depth > 0.0 and equation.law not in (NEWTON, DELAYED):
        grid.log[0] = [0.0, np.nan, rate, np.nan, 0.0]
        grid.log_state[0] = np.concatenate([q, v, np.full(2 * n, np.nan)])
        grid.integers[LOGGED] = grid.integers[TOUCHING] = 1
    steps = math.ceil(run.length / step - 1e-9)
    while True:
        status = march(equation, grid, q, v, carried, steps)
        if status != FULL:
            break
        grid = grid._replace(
            log=np.concatenate([grid.log, np.empty_like(grid.log)]),
            log_state=np.concatenate([grid.log_state, np.empty_like(grid.log_state)]),
        )
    if status in (TOO_LARGE, DIVERGED):
        raise _failure(status, equation, run, int(grid.integers[STEP]), step, q, v)
    assert status == FINISHED

    logged = int(grid.integers[LOGGED])
    log, log_state = grid.log[:logged], grid.log_state[:logged]
    force_law = equation.law not in (NEWTON, DELAYED)
    unfinished = bool(grid.integers[TOUCHING]) and force_law
    impacts = Impacts(
        start=start.time + log[:, START],
        end=start.time + log[:, END],
        approach=log[:, IN].copy(),
        rebound=log[:, OUT].copy(),
        loss=np.where(np.isnan(log[:, END]), np.nan, log[:, LOST]),
        kind=np.zeros(logged, dtype=np.int64),
        displacement_start=log_state[:, :n].copy(),
        velocity_start=log_state[:, n : 2 * n].copy(),
        displacement_end=log_state[:, 2 * n : 3 * n].copy(),
        velocity_end=log_state[:, 3 * n :].copy(),
    )
    end = grid.samples[-1]
    return Trajectory(
        end=State(
            displacement=end[:n], velocity=end[n:], time=run.last * period + run.clock_end,
            regime=CONTACT if unfinished and equation.phi @ end[:n] > equation.gap else OUTSIDE,
        ),
        strobe_time=passed * period,
        strobe_displacement=grid.strobes[:, :n],
        strobe_velocity=grid.strobes[:, n:],
        strobe_impacts=grid.counts,
        time=run.times,
        displacement=grid.samples[:-1, :n],
        velocity=grid.samples[:-1, n:],
        impacts=impacts,
        evaluations=int(grid.integers[EVALUATIONS]),
    )  # fmt: skip
