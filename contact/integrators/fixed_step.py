"""A method with a time step: its run is checked, marched on a grid, and turned into a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from beam.parameters import InvalidValue, brief, is_number, require
from contact.engine.recorder import Recorder, grown, open_touch, recorder_for, trajectory_of
from contact.errors import ContactError, Diverged, StepTooLarge
from contact.flight.modal_flow import steady_motion
from contact.flight.motion import Motion
from contact.integrators.grid import DIVERGED, DONE, FULL, PLACE, Grid
from contact.integrators.method import Integrator
from contact.laws import LINEAR
from contact.oscillator import ImpactOscillator
from contact.touch import TOUCHES
from contact.trajectory import CONTACT, OUTSIDE, UNDER_WAY, Run, State, Trajectory


def stiffness_at(motion: Motion, square: float | np.ndarray) -> float:
    """Stiffness of a lasting contact at which the highest squared frequency reaches `square` [N/m].

    The frequencies of K + k phi phi^T are the roots of 1 + k sum phi^2/(omega^2 - lambda) = 0, so that k =
    1/sum phi^2/(lambda - omega^2); below zero if a mode lies higher already.  `square` [rad^2/s^2] may differ
    from mode to mode, shape (n_modes,).
    """
    room = square - motion.omega**2
    return 1.0 / motion.mobility(room) if np.all(room > 0.0) else -1.0


def _refuse(motion: Motion, run: Run, step: float, critical: float, place: dict[str, float]) -> None:
    """ValueError for a start behind the stop, StepTooLarge for a step that cannot be stable."""
    within = step * motion.most_at_tip(run.start.velocity) + 1e-12 * max(motion.gap, 1e-6)
    if CONTACT not in TOUCHES[motion.law].REGIMES and -place["gap"] > within:
        raise InvalidValue(
            f"displacement of the state puts the tip {-place['gap']:.3g} m behind the stop; with an impact "
            "law it must start on the near side"
        )
    stiff = motion.number0 if motion.law == LINEAR else 0.0
    if critical <= 0.0 or stiff > critical:
        bears = "it is unstable even in flight" if critical <= 0.0 else f"it bears {critical:.4g} N/m"
        detail = f"step {step:.4g} s, contact stiffness {stiff:.4g} N/m: {bears}"
        raise StepTooLarge(**place, detail=detail)  # type: ignore[arg-type]


def _in_order(recorder: Recorder, run: Run, period: float) -> tuple[Recorder, np.ndarray]:
    """Strobes and the end of the run as samples among the others, and their places in the new order.

    The strobes come first, then what was asked for, the end last.
    """
    strobes = period * np.arange(1, run.last - run.first + 1)
    wanted = (run.sample_period - run.first) * period + run.sample_clock
    clock = np.concatenate([strobes, wanted, [run.clock + run.length]])
    order = np.argsort(clock, kind="stable")
    return recorder._replace(
        sample_period=np.full(clock.size, run.first),
        sample_clock=clock[order],
        samples=np.empty((clock.size, recorder.samples.shape[1])),
    ), np.argsort(order)


def _sorted_out(recorder: Recorder, run: Run, order: np.ndarray, period: float, begun: bool) -> Recorder:
    """The opposite: strobes, with the touches that began since the one before, and samples.

    The first touch counts for none if it was `begun` when the run began.
    """
    passed, rows = run.last - run.first, recorder.samples[order]
    began = recorder.log["start"][int(begun) : recorder.marks[0]["logged"]]
    edges = np.concatenate([[-math.inf], period * np.arange(1, passed + 1)])
    counts = np.diff(np.searchsorted(began, edges, side="right"))
    return recorder._replace(strobes=rows[:passed], counts=counts, samples=rows[passed:-1])


def _loads(oscillator: ImpactOscillator) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes of the inertia forces of the drive and the constant loads of all modes [N kg^-0.5]."""
    drive = oscillator.drive
    base = 0.0 if drive is None else drive.amplitude * drive.angular_frequency**2
    constant = np.zeros(oscillator.n_modes) if oscillator.load is None else np.array(oscillator.load)
    return oscillator.model.participation * base, constant


def _failure(status: int, step: float, here: dict[str, float]) -> ContactError:
    """The error of a march that ended with `status` at this place."""
    if status == DIVERGED:
        return Diverged(**here)  # type: ignore[arg-type]
    detail = f"step {step:.4g} s: the contact has become too stiff for it"
    return StepTooLarge(**here, detail=detail)  # type: ignore[arg-type]


@dataclass(frozen=True, kw_only=True)
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
    march : compiled function
        march(grid, carried) -> status: the method's own loop, from grid point places[0].step to `steps`.
    deviations : bool
        Whether the method carries deviations from the steady motion.
    """

    step: float
    beyond_limit: bool = False
    march: ClassVar[Callable[..., int]]
    deviations: ClassVar[bool] = False

    def __post_init__(self) -> None:
        step = self.step
        require(is_number(step) and step > 0, f"step is {brief(step)} s; it must be finite and above zero")

    def carried(self, grid: Grid) -> object:
        """What the march needs besides the grid, made before it starts."""
        raise NotImplementedError

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run` on a grid of steps.

        Raises
        ------
        ValueError
            For a start behind the stop under an impact law.
        StepTooLarge, Diverged
            See ``contact.errors``.
        """
        n, period, start, motion = oscillator.n_modes, oscillator.period, run.start, oscillator.motion()
        step, forced = float(self.step), CONTACT in TOUCHES[motion.law].REGIMES

        def steady(clock: float) -> np.ndarray:
            """What the method leaves out of (q, v), shape (2, n_modes)."""
            return np.array(steady_motion(motion, clock)) if self.deviations else np.zeros((2, n))

        def place(time: float, q: np.ndarray, v: np.ndarray) -> dict[str, float]:
            return {"time": time, "gap": motion.gap - float(motion.tip(q)), "velocity": float(motion.tip(v))}

        here = place(start.time, start.displacement, start.velocity)
        critical = math.inf if self.beyond_limit else float(self.critical_stiffness(motion))
        _refuse(motion, run, step, critical, here)
        q, v = np.array([start.displacement, start.velocity]) - steady(run.clock)
        recorder, order = _in_order(recorder_for(run, n), run, period)
        under_way = forced and here["gap"] < 0.0
        if under_way:
            open_touch(recorder, run.first, run.clock, math.nan, UNDER_WAY, q, v)
        places = np.zeros(1, dtype=PLACE)
        places["due"] = -math.inf  # the first step has to look
        push, constant = _loads(oscillator)
        grid = Grid(
            places=places,
            motion=motion,
            push=push,
            constant=constant,
            step=step,
            clock=run.clock,
            first=run.first,
            steps=math.ceil(run.length / step - 1e-9),
            critical=critical,
            q=q,
            v=v,
            q0=q.copy(),
            v0=v.copy(),
            q_at=q.copy(),
            v_at=v.copy(),
            recorder=recorder,
        )
        carried = self.carried(grid)
        while (status := self.march(grid, carried)) == FULL:
            grid = grid._replace(recorder=grown(grid.recorder))
        if status != DONE:
            reached = run.clock + grid.places[0]["step"] * step
            here = place(start.time - run.clock + reached, *(np.array([grid.q, grid.v]) + steady(reached)))
            raise _failure(status, step, here)
        recorder = grid.recorder
        q, v = recorder.samples[-1].reshape(2, n) + steady(run.clock + run.length)
        touching = forced and recorder.marks[0]["touching"] == 1 and motion.tip(q) > motion.gap
        regime, time = CONTACT if touching else OUTSIDE, run.last * period + run.clock_end
        end = State(displacement=q, velocity=v, time=time, regime=regime)
        return trajectory_of(
            _sorted_out(recorder, run, order, period, under_way),
            run,
            end,
            oscillator,
            evaluations=grid.steps,
            deviations=self.deviations,
        )
