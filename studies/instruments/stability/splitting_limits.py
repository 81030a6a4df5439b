"""Where a splitting method fails in a contact that lasts."""

from __future__ import annotations

import numpy as np

from contact.integrators.splitting import COMPOSITIONS, Splitting
from contact.integrators.splitting_limit import step_matrix
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.trajectory import State

__all__ = ["settled"]


def settled(oscillator: ImpactOscillator, method: Splitting) -> State:
    """The state of a tip pressed on a linear stop that a step leaves as it is.

    It differs from the rest position by the error of the method.  While the contact is closed a step is an
    affine map x -> M x + b: one Newton step from the rest position gives its fixed point.
    """
    model, law = oscillator.model, oscillator.stop.law
    k, c, _zero = law.numbers
    load = np.zeros(oscillator.n_modes) if oscillator.load is None else oscillator.load
    stiff = np.diag(model.omega**2) + k * np.outer(model.phi, model.phi)
    rest = np.linalg.solve(stiff, load + k * oscillator.stop.gap * model.phi)
    x = np.concatenate([rest, np.zeros_like(rest)])
    matrix = step_matrix(oscillator.motion(), COMPOSITIONS[method.order], method.step, k, c)

    def after(y: np.ndarray) -> np.ndarray:
        start = State(displacement=y[: rest.size], velocity=y[rest.size :])
        end = simulate(oscillator, start, duration=method.step, method=method).end
        return np.concatenate([end.displacement, end.velocity])

    x = x + np.linalg.solve(np.eye(x.size) - matrix, after(x) - x)
    return State(displacement=x[: rest.size], velocity=x[rest.size :])
