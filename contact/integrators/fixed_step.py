"""A run of a method with a time step: checked, marched, and turned into a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from beam.parameters import brief, is_number, require
from contact.errors import Diverged, StepTooLarge
from contact.flight.modal_flow import steady_motion
from contact.flight.motion import Motion
from contact.integrators.equation import Equation, equation_of, tip_of
from contact.integrators.grid import DIVERGED, DONE, FULL, PLACE, Grid
from contact.laws import LINEAR
from contact.oscillator import ImpactOscillator
from contact.recorder import grown, open_touch, put_sample, recorder_for, sample_due, trajectory_of
from contact.touch import TOUCHES
from contact.trajectory import CONTACT, IMPACT, OUTSIDE, Run, State, Trajectory

__all__ = ["check_step", "fixed_step_run"]


def check_step(step: float) -> None:
    """ValueError unless `step` is a time step [s]."""
    require(is_number(step) and step > 0, f"step is {brief(step)} s; it must be finite and above zero")


def _place(equation: Equation, time: float, q: np.ndarray, v: np.ndarray) -> dict[str, float]:
    depth, rate = tip_of(equation, q, v)
    return {"time": time, "gap": -float(depth), "velocity": float(rate)}


def _too_large(step: float, detail: str, place: dict[str, float]) -> StepTooLarge:
    error = StepTooLarge(**place, detail=f"step {step:.4g} s{detail}")  # type: ignore[arg-type]
    error.step = step
    return error


def _refuse(equation: Equation, run: Run, step: float, critical: float) -> None:
    """ValueError for a start behind the stop, StepTooLarge for a step that cannot be stable."""
    q, v = run.start.displacement, run.start.velocity
    place = _place(equation, run.start.time, q, v)
    within = step * float(np.abs(equation.phi * v).sum()) + 1e-12 * max(equation.gap, 1e-6)
    if CONTACT not in TOUCHES[equation.law].REGIMES and -place["gap"] > within:
        raise ValueError(
            f"displacement of the state puts the tip {-place['gap']:.3g} m behind the stop; with an impact "
            "law it must start on the near side"
        )
    stiff = equation.number0 if equation.law == LINEAR else 0.0
    if critical <= 0.0 or stiff > critical:
        bears = "it is unstable even in flight" if critical <= 0.0 else f"it bears {critical:.4g} N/m"
        raise _too_large(step, f", contact stiffness {stiff:.4g} N/m: {bears}", place)


def fixed_step_run(
    oscillator: ImpactOscillator, run: Run, *, step: float, march: Callable[[Equation, Grid], int],
    critical: float = math.inf, motion: Motion | None = None,
) -> Trajectory:  # fmt: skip
    """The motion of `run` on a grid of steps.

    Parameters
    ----------
    oscillator : ImpactOscillator
    run : Run
    step : float
        Time step [s]; strobes, samples and the end of the run need not lie on the grid.
    march : callable
        march(equation, grid) -> status: the method's own loop, from grid point places[0].step to `steps`.
    critical : float
        Largest contact stiffness that the step bears [N/m].
    motion : Motion, optional
        If given, the method carries deviations from its steady motion.

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

    def steady(clock: float) -> tuple[np.ndarray, np.ndarray]:
        if motion is None:
            return np.zeros(n), np.zeros(n)
        q, v = steady_motion(motion, np.array([clock]))
        return q[0], v[0]

    mean_q, mean_v = steady(run.clock)
    q, v = start.displacement - mean_q, start.velocity - mean_v
    recorder = recorder_for(run, n, period)
    end_clock = run.clock + run.length
    recorder = recorder._replace(  # the end of the run is one more sample
        sample_period=np.append(recorder.sample_period, run.first),
        sample_clock=np.append(recorder.sample_clock, end_clock),
        samples=np.empty((run.times.size + 1, 2 * n)),
    )
    while recorder.marks[0]["sampled"] < run.times.size and sample_due(recorder, run.first, run.clock):
        put_sample(recorder, q, v)
    depth, rate = tip_of(equation, start.displacement, start.velocity)
    if depth > 0.0 and CONTACT in TOUCHES[equation.law].REGIMES:
        open_touch(recorder, run.first, run.clock, rate, IMPACT, q, v)
        recorder.marks["impacts"] = 0  # a touch under way
    places = np.zeros(1, dtype=PLACE)
    places["due"] = -math.inf  # the first step has to look
    grid = Grid(
        places=places, step=float(step), clock=float(run.clock), period=float(period),
        first=int(run.first), steps=math.ceil(run.length / step - 1e-9), critical=float(critical), q=q, v=v,
        q0=q.copy(), v0=v.copy(), q_at=q.copy(), v_at=v.copy(), recorder=recorder,
    )  # fmt: skip
    while (status := march(equation, grid)) == FULL:
        grid = grid._replace(recorder=grown(grid.recorder))
    if status != DONE:
        reached = run.clock + grid.places[0]["step"] * step
        mean_q, mean_v = steady(reached)
        place = _place(equation, start.time - run.clock + reached, grid.q + mean_q, grid.v + mean_v)
        if status == DIVERGED:
            raise Diverged(**place)  # type: ignore[arg-type]
        raise _too_large(step, ": the contact has become too stiff for it", place)
    recorder = grid.recorder
    last, (mean_q, mean_v) = recorder.samples[-1], steady(end_clock)
    q, v = last[:n] + mean_q, last[n:] + mean_v
    touching = CONTACT in TOUCHES[equation.law].REGIMES and recorder.marks[0]["touching"] == 1
    end = State(
        displacement=q, velocity=v, time=run.last * period + run.clock_end,
        regime=CONTACT if touching and equation.phi @ q > equation.gap else OUTSIDE,
    )  # fmt: skip
    return trajectory_of(
        recorder._replace(samples=recorder.samples[:-1]), run, end, period,
        evaluations=int(grid.places[0]["evaluations"]), motion=motion,
    )  # fmt: skip
