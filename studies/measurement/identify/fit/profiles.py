"""Profile likelihood: what a fit becomes with one parameter held, and how far it may be moved.

With p held at a value all others are fitted again; chi^2 rises by r^2 in units of the noise's variance.  The
90 % interval ends where r is the `reach`, 1.645 or Student's t for it.  A refit begins at the last one, the
value moves on by the secant of r.  A refit that has not settled is not believed: a shorter step follows.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from beam import Refusal
from contact import ContactError
from studies.measurement.identify.fit.problem import RANGES, SETTLED, Problem
from studies.measurement.identify.motion.predictions import Prediction
from studies.measurement.identify.record.records import Array
from studies.physics.parameters import through_any_value, with_values

REFITS, FEW = 16, 30  # most refits to a side, and the steps of each
NEAR = 0.15  # distance of the last r from the reach, as a part of it
GROW, SHRINK = 4.0, 0.3  # longest step over the last one; what follows a step that fails
WILD = 1e4  # rise of chi^2 where no refit begins
FARTHEST = 50.0  # logarithm by which a step along a tangent moves a value at most
FAR = 0.25  # part of the reach from which on a walk that comes to a halt is continued by a line
BENT = 0.2  # part by which chi^2 a reach away differs from what (J^T J)^-1 says, if there is a profile


@dataclass(frozen=True)
class Profile:
    """One point of a profile likelihood: a parameter is held, all others are fitted again."""

    parameter: Annotated[str, "parameter that is held"]
    value: Annotated[float, "its value, in its SI unit"]
    other: Annotated[str, "parameter that trades off with it"]
    other_value: Annotated[float, "fitted value of that one, in its SI unit"]
    depth: Annotated[float, "rise of χ²"]


@dataclass(frozen=True, eq=False)
class Conditional:
    """A parameter held `away` standard errors from the best: the `rise` of chi^2 in the noise's variance,
    the `values` of all unknowns, their change `along` one more standard error, and the prediction there."""

    away: float
    rise: float
    values: Array
    along: Array
    prediction: Prediction

    @property
    def r(self) -> float:
        """The root of the rise."""
        return math.sqrt(max(self.rise, 0.0))


class Walk:
    """Steps along one parameter, `name`, of a `problem` solved by `unknowns`.

    `error` is its standard error by (J^T J)^-1, `variance` that of the noise in the problem's units.
    """

    def __init__(self, problem: Problem, unknowns: Array, error: float, variance: float, name: str) -> None:
        self.problem, self.name, self.variance, self.error = problem, name, variance, error
        self.i, self.chi2 = problem.names.index(name), float(np.sum(problem.residuals(unknowns) ** 2))
        self.best = self._point(0.0, 0.0, problem.values(unknowns), problem.prediction)

    def _point(self, away: float, rise: float, values: Array, prediction: Prediction) -> Conditional:
        """A point with the direction in which chi^2 rises least as the parameter moves on."""
        problem = self.problem.of(prediction)
        unknowns = problem.unknowns_of(values)
        rows = np.linalg.qr(problem.jacobian(unknowns))[1] / problem.slopes(unknowns)
        sizes = np.linalg.norm(rows, axis=0)
        sizes[sizes == 0.0] = 1.0
        others = np.delete(rows / sizes, self.i, axis=1)
        follow = np.linalg.lstsq(others, -rows[:, self.i], rcond=None)[0] / np.delete(sizes, self.i)
        each = values[self.i] / self.best.values[self.i] if away and self.problem.log[self.i] else 1.0
        return Conditional(away, rise, values, np.insert(follow, self.i, 1.0) * self.error * each, prediction)

    def moved(self, point: Conditional, step: float, last: Conditional | None = None) -> Array:
        """All values so many standard errors on: along a point's direction, on the parabola through the last;
        logarithms where they are fitted."""
        found, log = point.values + step * point.along, self.problem.log
        if last is not None:
            back = last.away - point.away
            found += (last.values - point.values - back * point.along) * (step / back) ** 2
            found[self.i] = point.values[self.i] + step * point.along[self.i]
        part = np.clip(found[log] / point.values[log] - 1.0, -FARTHEST, FARTHEST)
        found[log] = point.values[log] * np.exp(part)
        others = np.arange(found.size) != self.i
        low, high = self.problem.bounds * self.problem.sizes
        found[others] = np.clip(found, low, high)[others]
        return found

    def rise_of(self, values: Array, prediction: Prediction) -> float:
        """The rise of chi^2 at these values; not a number where there is no motion."""
        low, high = self.problem.bounds[:, self.i] * self.problem.sizes[self.i]
        if not low < values[self.i] < high:
            return math.nan
        problem = self.problem.of(prediction)
        chi2 = float(np.sum(problem.residuals(problem.unknowns_of(values)) ** 2))
        return (chi2 - self.chi2) / self.variance

    def bent(self, reach: float) -> bool:
        """Whether chi^2 is not the parabola that (J^T J)^-1 says."""
        rises = [self.rise_of(self.moved(self.best, way), self.best.prediction) for way in (-reach, reach)]
        return not all(abs(rise / reach**2 - 1.0) < BENT for rise in rises)

    @through_any_value()
    def held(self, point: Conditional, step: float, last: Conditional | None) -> Conditional | None:
        """The fit with the parameter a step beyond a point; None if it does not settle."""
        values, problem = self.moved(point, step, last), self.problem
        prediction, value = point.prediction.again(), float(values[self.i])
        if not self.rise_of(values, prediction) < WILD:
            return None
        others = tuple(one for one in problem.names if one != self.name)
        try:
            at = with_values(problem.oscillator, {self.name: value})
            fewer = Problem(prediction, at, others, problem.noise)
            found = fewer.solve(fewer.unknowns_of(np.delete(values, self.i)), FEW, 0.1 * SETTLED)
            if found.left > self.variance * SETTLED:
                return None
            rise = (found.chi2 - self.chi2) / self.variance
            whole = np.insert(fewer.values(found.x), self.i, value)
            return self._point(point.away + step, rise, whole, prediction)
        except (ContactError, Refusal):
            return None

    def side(self, reach: float) -> tuple[list[Conditional], float]:
        """Points from the best outwards to the side of the sign of `reach`, and where the interval ends."""
        low, last, high, points = self.best, None, None, list[Conditional]()
        step, most = reach, abs(reach)
        for _ in range(REFITS):
            point = self.held(low, step, last)
            if point is None:
                step *= SHRINK
                continue
            points.append(point)
            if abs(point.r / most - 1.0) < NEAR:
                return points, self._end(low, point, most)
            if point.r > most:
                high = point
            else:
                slope = (point.r - low.r) / abs(step)
                step = math.copysign(min((most - point.r) / max(slope, 1e-9), GROW * abs(step)), reach)
                low, last = point, low
            if high is not None:
                part = (most - low.r) / (high.r - low.r)
                step = (high.away - low.away) * min(max(part, 0.1), 0.9)
        if high is None and last is not None and low.r > FAR * most and low.r > last.r:
            low, high = last, low  # the walk has come to a halt: the line through its last two points
        edge = RANGES.get(self.name, (0.0, math.inf))[reach > 0.0]  # no r inside it is as large as the reach
        return points, edge if high is None else self._end(low, high, most)

    def _end(self, low: Conditional, high: Conditional, reach: float) -> float:
        """Where r is the reach, by the line through two points."""
        ends = low.values[self.i], high.values[self.i]
        return float(ends[0] + (ends[1] - ends[0]) * (reach - low.r) / (high.r - low.r))


def rows_of(walk: Walk, points: Sequence[Conditional], other: str) -> list[Profile]:
    """The points of a walk, the parameter rising."""
    k = walk.problem.names.index(other)
    points = sorted([walk.best, *points], key=lambda point: point.away)
    rows = [(float(point.values[walk.i]), float(point.values[k]), point.rise) for point in points]
    return [Profile(walk.name, value, other, fitted, rise) for value, fitted, rise in rows]
