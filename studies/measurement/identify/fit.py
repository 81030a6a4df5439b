"""Least squares: from a record to parameters, errors and correlations, and whether the model is enough.

    r_i = (observed_i - predicted_i(p))/sigma_i,   chi^2 = sum r_i^2  ->  least,
    covariance  s^2 (J^T J)^-1,   s^2 = 1 where the noise is known, else chi^2/(n - number of unknowns),

90 % intervals by Student's t. A step to where there is no orbit is rejected by the trust region. The model is
too small where residuals are not noise: by their size if the noise is known, and by their pattern: strobe
points by the lack-of-fit test of rows that repeat (between the m points, against within), a displacement by
the autocorrelation of its residuals (Ljung and Box, Biometrika 65 (1978) 297).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.special import expit, logit

from beam import Refusal
from contact import ContactError, ImpactOscillator
from studies import letter
from studies.measurement.identify.diagnosis import wanders
from studies.measurement.identify.displacement import SENSOR
from studies.measurement.identify.linear import Linear
from studies.measurement.identify.predictions import Prediction
from studies.measurement.identify.problem import MOST, Problem, chance_of
from studies.measurement.identify.records import READ_OUT, NoAnswer, Record
from studies.measurement.identify.soundness import sound
from studies.measurement.identify.starts import predictions_of
from studies.measurement.identify.unsteady import unsteady_starts
from studies.physics.parameters import parameters_of, require_names, with_values

Array = NDArray[np.float64]

LEVEL = 0.90
"""Probability of the intervals."""

SINGULAR = 1e-8
"""Ratio of singular values below which the record does not depend on a direction of the parameters."""

TOO_SMALL = 1e-3
"""Probability of such residuals from noise alone, below which the model is called too small."""

LEASH = 1.0
"""Prior of the parameters while the beginning of a record is fitted, which need not determine all of them."""

EARLY, FINISHED, SAME, ASTRAY = 40, 3, 1e-4, 9.0
"""Steps from each start; starts that are fitted to the end; relative difference of chi^2 of two that are one;
growth of chi^2 by row at which the fit of more and more rows is given up."""

SHORT = 20.0
"""Drive periods of a motion that are fitted where more are not: chaos forgets its start."""

SETTLED = 0.1
"""Fall of chi^2 that may be left to a further step, in units of the noise's variance: a third of an error."""

PART, LOST = 0.3, 2.0
"""Part of the largest from which a parameter takes part in a direction that is not determined; standard error
of a logarithm above which its parameter is not determined."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """A fit; arrays by `names`, parameters and then numbers of the sensor, in SI units.

    `before` has the values before the record was looked at, `start` those at the start of the fit.

    `noise`: standard deviation of x [m], or of an excess in units of its error; `freedom`: rows less
    unknowns; `residuals`: observed less predicted, shape of the record's `observed`; `chance`: probability of
    residuals of such size or pattern from noise alone; `problem` and `unknowns`: what was solved.
    """

    record: Record
    oscillator: ImpactOscillator
    names: tuple[str, ...]
    before: Array
    start: Array
    estimate: Array
    covariance: Array
    noise: float
    noise_known: bool
    freedom: int
    residuals: Array
    chance: float
    problem: Problem
    unknowns: Array

    @property
    def errors(self) -> Array:
        """Standard errors."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlations(self) -> Array:
        """Shape (n, n)."""
        return self.covariance / np.outer(self.errors, self.errors)

    @property
    def too_small(self) -> bool:
        """Whether the residuals are unlike noise: the model is too small for the record."""
        return self.chance < TOO_SMALL

    @property
    def reach(self) -> float:
        """Half a 90 % interval in standard errors, by Student's t; the normal law's if noise is known."""
        tail = 0.5 + 0.5 * LEVEL
        return float(stats.norm.ppf(tail) if self.noise_known else stats.t.ppf(tail, self.freedom))

    def intervals(self) -> Array:
        """Lower and upper ends, shape (n, 2), within the physical range.

        They are those of the unknowns of the problem, of a restitution r those of log(r/(1 - r)).
        """
        log = self.problem.log[self.problem.named]
        wide = self.reach * self.errors
        found = self.estimate[:, None] + np.outer(wide, [-1.0, 1.0])
        factor = np.exp(wide[log] / self.estimate[log])
        found[log] = self.estimate[log, None] * np.column_stack([1.0 / factor, factor])
        for i, name in enumerate(self.names):
            if name == "restitution" and 0.0 < (r := self.estimate[i]) < 1.0:
                wide = self.reach * self.errors[i] / (r * (1.0 - r))
                found[i] = expit(logit(r) + np.array([-wide, wide]))
        return np.asarray(found)


def fit(
    record: Record,
    oscillator: ImpactOscillator,
    names: Sequence[str],
    *,
    noise: float | None = None,
    free: Sequence[str] = ("phase", "offset"),
) -> Fit:
    """Fit the named parameters; the others keep the values of `oscillator`, driven as the record was.

    `noise` is the standard deviation of the read-out where it is known [m], or of the excesses of a table;
    `free` are the numbers of the sensor that are fitted to a displacement.  NoAnswer is raised, in one
    sentence, for a record that cannot determine them.
    """
    require_names(names, oscillator)
    known = noise is not None or len(record.columns) == 4
    unit = noise or (letter.AMPLITUDE_STABILITY if record.kind == "transitions" else READ_OUT)
    if record.kind == "displacement":
        return _displacement(*sound(record, oscillator), tuple(names), free, unit, known)
    starts = predictions_of(record, oscillator, tuple(names), free)
    return _solved(starts, tuple(names), oscillator, unit, known)


def _solved(
    starts: Sequence[tuple[Prediction, ImpactOscillator]],
    names: tuple[str, ...],
    oscillator: ImpactOscillator,
    unit: float,
    known: bool,
) -> Fit:
    problems = [Problem(one, at, names, unit) for one, at in starts]
    return _judged(*_best(problems, known), oscillator, known)


def _displacement(
    record: Record,
    oscillator: ImpactOscillator,
    names: tuple[str, ...],
    free: Sequence[str],
    unit: float,
    known: bool,
) -> Fit:
    """The best fit of a displacement: of a linear motion, of one that repeats, or of one that does not."""
    given = names, oscillator, unit, known
    linear, failure = Linear(record), None
    found: Fit | None = None
    try:
        starts = [] if linear.likely else predictions_of(record, oscillator, names, free)
        if starts:
            found = _solved(starts, *given)
        else:  # a linear motion, its stop far away while it is fitted
            prediction, begun, own = linear.start(oscillator, names, free)
            found = _solved([(prediction, begun)], own, *given[1:])
            found = replace(found, oscillator=with_values(found.oscillator, {"gap": oscillator.stop.gap}))
        if not found.too_small:
            return found
    except NoAnswer as error:
        failure = error
    times, x = record.rows.T
    residuals = found.residuals[:, 0] if found else x - x.mean()
    words = wanders(times, x, residuals, float(linear.frequency))
    early = int(np.searchsorted(times, times[0] + SHORT / float(linear.frequency)))
    for size in dict.fromkeys([len(x), early] if words else []):
        linear.record = replace(record, rows=record.rows[:size])
        with suppress(NoAnswer):
            other = _solved(unsteady_starts(linear, oscillator, names, free), *given)
            if not other.too_small:
                rows = "" if size == len(x) else f" by the first {size} rows"
                note = f"{words[0]}: the fit is one of a transient or a chaotic motion{rows}"
                return replace(other, record=replace(other.record, notes=(*record.notes, note)))
    if found is None:
        raise failure or NoAnswer("no motion like the record's was found")
    return found


def _best(problems: Sequence[Problem], known: bool) -> tuple[Problem, Any]:
    """The problem that is solved best, and its solution: all are begun, the best that differ are finished."""
    rows = problems[0].observed.size
    if rows < problems[0].unknowns + (not known):
        raise NoAnswer(
            f"the record has {rows} numbers, too short for {problems[0].unknowns} unknowns and their errors"
        )
    failure, begun = None, list[tuple[float, int, Array]]()
    for i, problem in enumerate(problems):
        first = _part(problem, 0)
        try:
            found = first.solve(problem.start, EARLY)
            begun.append((found.cost, i, found.x))
        except (ContactError, Refusal) as error:
            failure = failure or error
    ends, last = list[tuple[Problem, Any]](), -math.inf
    for cost, i, unknowns in sorted(begun, key=lambda one: one[:2]):
        if len(ends) == FINISHED or cost < last * (1.0 + SAME):
            continue
        problem, last = problems[i], cost
        try:
            sizes = [len(part.record.rows) for part in problem.prediction.parts()]
            for k, size in enumerate(sizes[1:-1], 1):
                found = _part(problem, k).solve(unknowns)
                if found.cost * sizes[0] > ASTRAY * cost * size:
                    raise NoAnswer(f"the motion that is like the first {sizes[0]} rows is unlike later ones")
                unknowns = found.x
            ends.append((problem, problem.solve(unknowns)))
        except (ContactError, Refusal) as error:
            failure = failure or error
    if not ends:
        if isinstance(failure, NoAnswer):
            raise failure
        raise NoAnswer(f"no motion like the record's was found to start from: {failure}")
    return min(ends, key=lambda end: float(end[1].cost))


def _part(problem: Problem, number: int) -> Problem:
    """The problem of a part of its prediction."""
    parts = problem.prediction.parts()
    if len(parts) == 1:
        return problem
    return Problem(parts[number], problem.oscillator, problem.names, problem.noise, LEASH)


def _judged(problem: Problem, found: Any, oscillator: ImpactOscillator, known: bool) -> Fit:
    """The fit that a solution is; NoAnswer if the record does not determine it."""
    prediction, rows = problem.prediction, problem.observed.size
    spread = 1.0 if known else float(np.sqrt(2.0 * found.cost / problem.freedom))
    names, own = problem.names + prediction.sensor, problem.named
    chance = chance_of(found.fun[:rows], prediction, known, problem.freedom)
    lengths = np.linalg.norm(found.jac, axis=0)
    lengths[lengths == 0.0] = 1.0
    left, singular, axes = np.linalg.svd(found.jac / lengths, full_matrices=False)
    gain = float(np.sum((left.T @ found.fun) ** 2)) / spread**2
    if gain > SETTLED and chance > TOO_SMALL:  # else the model is too small
        raise NoAnswer(f"the fit has not settled after {MOST} steps: chi^2 would still fall by {gain:.2g}")
    slopes, values = problem.slopes(found.x), problem.values(found.x)
    sizes = np.where(problem.log, LOST * np.abs(values), np.maximum(np.abs(values), problem.sizes))
    axes = axes / lengths @ slopes.T
    if not singular[-1] > SINGULAR * singular[0]:
        blind = _blind((axes / sizes)[:, own], names)
        raise NoAnswer(f"the record cannot {blind}: fit fewer parameters or another record")
    covariance = (axes.T / singular**2 @ axes * spread**2)[np.ix_(own, own)]
    before = parameters_of(oscillator)
    result = Fit(
        record=prediction.record,
        oscillator=problem.at(found.x)[0],
        names=names,
        start=problem.values(problem.start)[own],
        before=np.array([before[name].value if name in before else SENSOR[name] for name in names]),
        estimate=values[own],
        covariance=covariance,
        noise=spread * problem.noise,
        noise_known=known,
        freedom=problem.freedom,
        residuals=(-found.fun[:rows] / problem.weights).reshape(prediction.record.observed.shape),
        chance=chance,
        problem=problem,
        unknowns=found.x,
    )
    share = result.errors / sizes[own]
    if not result.too_small and np.any(share > 1.0):  # else `report` says so
        worst, blind = names[int(np.argmax(share))], _blind((axes / sizes)[:, own], names)
        blind = blind if worst in blind.split() else f"determine {worst}"
        raise NoAnswer(f"the record cannot {blind}: the standard error of {worst} is above its value")
    return result


def _blind(axes: Array, names: Sequence[str]) -> str:
    """The parameters of the last axis, which a record cannot separate or determine."""
    share = np.abs(axes[-1])
    blind = [name for name, part in zip(names, share, strict=True) if part > PART * share.max()]
    return f"tell {' from '.join(blind)}" if len(blind) > 1 else f"determine {blind[0]}"
