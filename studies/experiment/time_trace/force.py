"""The force of the plate on the ball along a motion, from the laws that a scene can have.

    N = k d + c d'  (linear),   N = k d^(3/2)  (Hertz),   at depth d [m] and rate d' [m/s], while they touch

A law of restitution has no force: not a number.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from beam import InvalidType
from contact import HertzContact, ImpactOscillator, LinearContact, NewtonRestitution, Trajectory

Array = NDArray[np.float64]


def touching(run: Trajectory) -> NDArray[np.bool_]:
    """Whether tip and plate touch at the samples of a trajectory, shape (n_samples,)."""
    begin, end = run.impacts.start, run.impacts.end
    inside: NDArray[np.bool_] = np.any((run.time[:, None] >= begin) & (run.time[:, None] <= end), axis=1)
    return inside


def contact_force(oscillator: ImpactOscillator, run: Trajectory) -> Array:
    """Force [N] at the samples of a trajectory, shape (n_samples,)."""
    law = oscillator.stop.law
    depth = np.maximum(oscillator.tip(run.displacement) - oscillator.stop.gap, 0.0)
    if isinstance(law, NewtonRestitution):
        return np.full(depth.shape, np.nan)
    if isinstance(law, LinearContact):
        force = law.stiffness * depth + law.damping * oscillator.tip(run.velocity)
    elif isinstance(law, HertzContact):
        force = law.stiffness * depth**1.5
    else:
        raise InvalidType(f"the force of {type(law).__name__} is not known here")
    return np.where(touching(run), np.maximum(force, 0.0), 0.0)
