"""Springs and collisions on which exactness is tried, and the error of a run against 60 digits.

The tip starts at rest position with a velocity in every mode and meets a linear stop once; the run ends
between its release and its next touch.  The error is the largest difference of a mode, velocity or frequency
times displacement, over the largest velocity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beam import ModalModel
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State, Trajectory
from studies.instruments.stability.extended_precision import collision

__all__ = ["Collided", "collide", "error_of_collision", "spring"]

GAP = 0.005
SPEED = 0.2
"""Initial velocity of each mode [m kg^0.5/s]."""
FIRST = 2.0 * np.pi * 24.5
RATIOS = np.array(
    [1.0, 6.1, 15.4, 29.0, 47.0, 70.0, 98.0, 130.0, 167.0, 208.0, 254.0, 304.0, 358.0, 417.0, 480.0]
)
PHI = np.asarray(10.0 / (1.0 + 0.4 * np.arange(15)), dtype=np.float64)


def spring(count: int, *, ratio: float = 0.01) -> ModalModel:
    """`count` modes like those of a leaf spring with a tip mass, damping ratio `ratio` in each."""
    omega = FIRST * RATIOS[:count]
    return ModalModel(
        omega=omega, decay_rate=2.0 * ratio * omega, phi=PHI[:count], participation=np.zeros(count)
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Collided:
    """A run over one collision, and where it was found to touch and let go [s]."""

    oscillator: ImpactOscillator
    start: State
    end: float
    touch: float
    release: float
    run: Trajectory


def collide(model: ModalModel, stiffness: float, *, speed: np.ndarray | None = None) -> Collided:
    """The first collision with a stop of `stiffness` [N/m], by the default method."""
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=GAP, law=LinearContact(stiffness=stiffness)))
    given = np.full(model.n_modes, SPEED) if speed is None else speed
    start = State(displacement=np.zeros(model.n_modes), velocity=given)
    long = 0.05
    impacts = simulate(oscillator, start, duration=long).impacts
    if len(impacts) == 0 or not np.isfinite(impacts.end[0]):
        raise ValueError(f"stiffness is {stiffness:g} N/m; there is no collision that ends within {long} s")
    touch, release = float(impacts.start[0]), float(impacts.end[0])
    later = float(impacts.start[1]) if len(impacts) > 1 else long
    end = float(min(0.5 * (release + later), release + 0.5 * (release - touch) + 1e-3))
    run = simulate(oscillator, start, duration=end)
    return Collided(
        oscillator=oscillator, start=start, end=float(run.end.time), touch=touch, release=release, run=run
    )


def error_of_collision(found: Collided) -> float:
    """Error of the state at the end against 60 digits, relative to the largest modal velocity [1]."""
    model, law = found.oscillator.model, found.oscillator.stop.law
    u, v, _touch, _release = collision(
        omega=model.omega, decay=model.decay_rate, phi=model.phi, gap=GAP, stiffness=law.numbers[0],
        displacement=found.start.displacement, velocity=found.start.velocity, touch=found.touch,
        release=found.release, end=found.end,
    )  # fmt: skip
    weight = np.maximum(model.omega, 1.0 / found.end)
    off = np.concatenate([found.run.end.velocity - v, weight * (found.run.end.displacement - u)])
    return float(np.abs(off).max() / np.abs(v).max())
