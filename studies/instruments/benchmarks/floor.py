"""The arithmetic that no method of this kind can avoid, as kernels of their own.

A period without an impact has to carry every mode by its 2 x 2 matrix and to look at one number that says
that no touch was possible:

    (u, v) -> (a u + b v, c u + d v) for each mode,   one weighted sum compared with a bound.

A contact has to evaluate the force, a sum over the modes, and add it to every mode, at each of the stages of
the cheapest scheme; the floor given here leaves contacts out, so it is one of the periods without any.
"""

from __future__ import annotations

import numpy as np

from contact.compiled import kernel
from contact.flight.modal_flow import flow_matrix
from contact.oscillator import ImpactOscillator

__all__ = ["carry", "flows_of"]


def flows_of(oscillator: ImpactOscillator) -> np.ndarray:
    """The flow of a drive period of each mode, shape (n_modes, 4)."""
    motion = oscillator.motion()
    return np.array(
        [
            flow_matrix(w, c, high, low, motion.period)
            for w, c, high, low in zip(
                motion.omega, motion.decay, motion.damped, motion.damped_low, strict=True
            )
        ]
    )


@kernel
def carry(flow, weight, bound, u, v, periods):
    """Carry the deviations over `periods`; returns how often the weighted sum exceeded `bound`."""
    exceeded = 0
    for _ in range(periods):
        total = 0.0
        for k in range(u.size):
            uk = u[k]
            u[k] = flow[k, 0] * uk + flow[k, 1] * v[k]
            v[k] = flow[k, 2] * uk + flow[k, 3] * v[k]
            total += weight[k] * abs(u[k])
        if total > bound:
            exceeded += 1
    return exceeded
