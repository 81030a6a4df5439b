"""Profile likelihood: what a fit becomes with one parameter held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beam import Refusal
from studies.measurement.identify.fit import Fit
from studies.measurement.identify.problem import Problem
from studies.physics.parameters import with_values


@dataclass(frozen=True, kw_only=True)
class Profile:
    """One point of a profile likelihood: `parameter` held at `value`, all others fitted again.

    `other` is the parameter that trades off with it, `other_value` what it becomes; `depth` is the rise of
    chi^2 in units of the noise's variance.
    """

    parameter: str
    value: float
    other: str
    other_value: float
    depth: float


def profile(found: Fit, name: str, other: str, *, points: int = 9, reach: float = 3.0) -> list[Profile]:
    """The profile likelihood of `name`, `reach` standard errors to both sides."""
    problem, i, variance = found.problem, found.names.index(name), (found.noise / found.problem.noise) ** 2
    best, rows = np.sum(problem.residuals(found.unknowns) ** 2), list[Profile]()
    others = tuple(one for one in problem.names if one != name)
    for side in np.linspace(-reach, reach, points):
        unknowns = found.unknowns.copy()
        step = side * found.covariance[:, i] / found.errors[i]
        unknowns[problem.named] += step / problem.slopes(found.unknowns)[problem.named]
        values = problem.values(unknowns)
        try:
            at = with_values(found.oscillator, {name: float(values[i])})
            fewer = Problem(problem.prediction, at, others, problem.noise)
            held = fewer.solve(fewer.unknowns_of(np.delete(values, i)))
        except Refusal:
            continue
        rows.append(
            Profile(
                parameter=name,
                value=float(values[i]),
                depth=float(2.0 * held.cost - best) / variance,
                other=other,
                other_value=float(fewer.values(held.x)[fewer.named][others.index(other)]),
            )
        )
    return rows
