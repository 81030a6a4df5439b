"""A method with a time step: checks of a run, the loop over its steps, and the trajectory made of it."""

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from beam.parameters import InvalidValue, brief, is_number, record, require
from contact.engine.plan import Plan
from contact.engine.recorder import Recorder, grown, recorder_for, trajectory_of
from contact.errors import Diverged, StepTooLarge
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import Numbers
from contact.integrators.grid import DIVERGED, DONE, FULL, PROGRESS, Grid, first_tangent
from contact.integrators.method import FORCE_LAWS, Integrator
from contact.oscillator import ImpactOscillator
from contact.state import CONTACT, OUTSIDE, UNDER_WAY, State
from contact.touch.passage import open_touch
from contact.trajectory import Trajectory


def stiffness_at(numbers: Numbers, square: float | np.ndarray) -> float:
    """Stiffness of a lasting contact at which the highest squared frequency reaches `square` [N/m].

    The squared frequencies lambda of K + k phi phi^T are the roots of 1 + k sum phi^2/(omega^2 - lambda) = 0,
    so that k = 1/sum phi^2/(lambda - omega^2).  The result is below zero if a mode lies higher already.
    `square` [rad^2/s^2] may differ from mode to mode, shape (n_modes,).
    """
    slack = square - numbers.omega**2
    return 1.0 / numbers.mobility(slack) if np.all(slack > 0.0) else -1.0


def _refuse(numbers: Numbers, plan: Plan, step: float, critical: float, where: dict[str, float]) -> None:
    """ValueError for a start behind the stop, StepTooLarge for a step that cannot be stable."""
    within = step * numbers.most_at_tip(plan.start.velocity) + 1e-12 * max(numbers.gap, 1e-6)
    if numbers.law not in FORCE_LAWS and -where["gap"] > within:
        behind = f"{-where['gap']:.3g} m behind the stop; with an impact law it must start on the near side"
        raise InvalidValue(f"displacement of the state puts the tip {behind}")
    stiff, _damping = first_tangent(numbers)
    if critical <= 0.0 or stiff > critical:
        bears = f"it bears a contact of {critical:.4g} N/m, and the first touch has {stiff:.4g} N/m"
        bears = "it is unstable even in flight" if critical <= 0.0 else bears
        raise StepTooLarge(**where, detail=f"step {step:.4g} s: {bears}")  # type: ignore[arg-type]


def _merged(recorder: Recorder, plan: Plan, period: float) -> tuple[Recorder, np.ndarray]:
    """A recorder with strobes, wanted times and the end of the run as samples in the order of time.

    The array tells for each strobe, then each wanted time, last the end, which sample it is.
    """
    strobes = period * np.arange(1, plan.last - plan.first + 1)
    wanted = (plan.sample_stretch - plan.first) * period + plan.sample_clock
    clock = np.concatenate([strobes, wanted, [plan.clock + plan.length]])
    order = np.argsort(clock, kind="stable")
    samples, stretch_of = np.empty((clock.size, recorder.samples.shape[1])), np.full(clock.size, plan.first)
    merged = recorder._replace(sample_stretch=stretch_of, sample_clock=clock[order], samples=samples)
    return merged, np.argsort(order)


def _separated(recorder: Recorder, plan: Plan, order: np.ndarray, period: float, begun: bool) -> Recorder:
    """Undo `_merged`: split the samples into strobes and wanted times, and count touches between strobes.

    The first touch does not count if it was `begun` when the run began.
    """
    passed, rows = plan.last - plan.first, recorder.samples[order]
    began = recorder.log["start"][int(begun) : recorder.marks[0]["logged"]]
    edges = np.concatenate([[-math.inf], period * np.arange(1, passed + 1)])
    counts = np.diff(np.searchsorted(began, edges, side="right"))
    return recorder._replace(strobes=rows[:passed], counts=counts, samples=rows[passed:-1])


@record(eq=True)
class FixedStep(Integrator):
    """A method with a time step; strobes, samples and the end of a run need not lie on its grid.

    Parameters
    ----------
    step : float
        Time step [s].
    beyond_limit : bool
        Run even where the step is unstable, for a study of what happens there.

    Attributes
    ----------
    laws : tuple of int
        All laws with a force, as ``contact.touch`` gives it; methods by percussions take Newton's law alone.
    time_loop : compiled function
        time_loop(grid, prepared) -> status: the method's steps, from grid point progress[0].step to `steps`.
    deviations : bool
        Whether the method carries deviations from the steady motion.
    """

    step: float
    beyond_limit: bool = False
    laws: ClassVar[tuple[int, ...]] = FORCE_LAWS
    time_loop: ClassVar[Callable[..., int]]
    deviations: ClassVar[bool] = False

    def __post_init__(self) -> None:
        step = self.step
        require(is_number(step) and step > 0, f"step is {brief(step)} s; it must be finite and above zero")

    def prepare(self, grid: Grid) -> object:
        """The numbers and arrays that the time loop needs besides the grid."""
        raise NotImplementedError

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """The motion of `plan` on a grid of steps.

        ValueError is raised for a start behind the stop under an impact law; see ``contact.errors`` for
        StepTooLarge and Diverged.
        """
        n, period, start, numbers = oscillator.n_modes, oscillator.period, plan.start, oscillator.numbers()
        step, forced = float(self.step), numbers.law in FORCE_LAWS

        def steady(clock: float) -> np.ndarray:
            """The part of (q, v) that the method does not carry, shape (2, n_modes)."""
            return np.array(steady_motion(numbers, clock)) if self.deviations else np.zeros((2, n))

        def where(time: float, q: np.ndarray, v: np.ndarray) -> dict[str, float]:
            depth, rate = float(numbers.tip(q)), float(numbers.tip(v))
            return {"time": time, "gap": numbers.gap - depth, "velocity": rate}

        here = where(start.time, start.displacement, start.velocity)
        critical = math.inf if self.beyond_limit else float(self.critical_stiffness(numbers))
        _refuse(numbers, plan, step, critical, here)
        q, v = np.array([start.displacement, start.velocity]) - steady(plan.clock)
        recorder, order = _merged(recorder_for(plan, n), plan, period)
        under_way = forced and here["gap"] < 0.0
        if under_way:
            open_touch(recorder, 0, plan.first, plan.clock, math.nan, UNDER_WAY, q, v)
        progress = np.zeros(1, dtype=PROGRESS)
        progress["due"] = -math.inf  # the first step has to look for samples
        base = 0.0 if oscillator.drive is None else oscillator.drive.amplitude * numbers.drive**2
        load = np.zeros(n) if oscillator.load is None else np.array(oscillator.load)
        forces = oscillator.model.participation * base, load
        clock, first, steps = plan.clock, plan.first, math.ceil(plan.length / step - 1e-9)
        states = q, v, q.copy(), v.copy(), q.copy(), v.copy()
        grid = Grid(progress, numbers, *forces, step, clock, first, steps, critical, *states, recorder)
        prepared = self.prepare(grid)
        while (status := self.time_loop(grid, prepared)) == FULL:
            grid = grid._replace(recorder=grown(grid.recorder))
        if status != DONE:
            reached = plan.clock + progress[0]["step"] * step
            here = where(start.time - plan.clock + reached, *(np.array([grid.q, grid.v]) + steady(reached)))
            why = "" if status == DIVERGED else f"step {step:.4g} s: the contact has become too stiff for it"
            raise (Diverged if status == DIVERGED else StepTooLarge)(**here, detail=why)  # type: ignore[arg-type]
        q, v = (recorder := grid.recorder).samples[-1].reshape(2, n) + steady(plan.clock + plan.length)
        touching = forced and recorder.marks[0]["touching"] == 1 and numbers.tip(q) > numbers.gap
        regime, time = CONTACT if touching else OUTSIDE, plan.last * period + plan.clock_end
        end = State(displacement=q, velocity=v, time=time, regime=regime)
        recorder = _separated(recorder, plan, order, period, under_way)
        return trajectory_of(recorder, plan, end, oscillator, grid.steps, deviations=self.deviations)
