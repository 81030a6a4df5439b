"""The least-squares problem of a fit: residuals and their derivatives by unknowns without units."""

import copy
import math
from typing import Self

import numpy as np
from scipy import stats

from beam import Refusal
from contact import ContactError, ImpactOscillator
from studies.measurement.identify.fit.descent import Found, descend
from studies.measurement.identify.motion.predictions import Prediction
from studies.measurement.identify.record.records import Array, NoAnswer
from studies.measurement.identify.record.spectrum import count_of, harmonics
from studies.physics.parameters import parameters_of, through_any_value, with_values

MOST = 100  # steps of a fit: a dozen are usual, a hundred along a valley of two parameters that trade off
GAIN = 1e-3  # fall of chi^2 at which a fit ends, in the noise's variance: 0.03 standard errors
SETTLED = 0.1  # fall of chi^2 that may be left to a further step, in the noise's variance
RANGES = {"decay_rate": (0.0, math.inf), "restitution": (0.0, 1.0)}
"""The parameters that may come close to an end of their range; there a logarithm would have no end."""
FARTHEST = {"free_period": 2.0, "frequency": 2.0}
"""Logarithm by which a search may leave where it begins: a motion of endless oscillations takes for ever."""
LAGS = 10  # of the autocorrelation of residuals
TINY = 1e-300  # least ratio of a value to where it starts: a step along a tangent may round to zero


class Problem:
    """Residuals and Jacobian in units of the noise, by unknowns u without units.

    A parameter p that starts at p_0 > 0 has u = log(p/p_0).  Others, and those in `RANGES`, have u = p/size.
    No search leaves the physical range.  A prior holds the further unknowns.  A `leash` holds the
    parameters: a standard deviation of u about where it starts.
    """

    def __init__(
        self,
        prediction: Prediction,
        oscillator: ImpactOscillator,
        names: tuple[str, ...],
        noise: float,
        leash: float = math.inf,
    ) -> None:
        self.prediction, self.oscillator, self.names = prediction, oscillator, names
        known = parameters_of(oscillator)
        self.sizes = np.concatenate([[known[name].size for name in names], prediction.sizes])
        values = np.concatenate([[known[name].value for name in names], prediction.extra])
        self.log = (np.arange(values.size) < len(names)) & (values > 0.0)
        self.log[[i for i, name in enumerate(names) if name in RANGES]] = False
        self.sizes[self.log] = values[self.log]
        self.start = self.unknowns_of(values)
        everything = [*names, *[""] * prediction.sizes.size]
        self.farthest = np.array([FARTHEST.get(name, math.inf) for name in everything])
        ranges = [RANGES.get(name, (-math.inf, math.inf)) for name in everything]
        self.bounds = np.array(ranges).T / self.sizes
        self.weights = 1.0 / prediction.record.units(noise).ravel()
        self.observed = prediction.record.observed.ravel()
        self.noise, own = noise, np.arange(self.sizes.size) < len(names)
        self.held = 1.0 / np.append(np.full(len(names), leash), prediction.prior / prediction.sizes)
        self.middle = np.where(own, self.start, 0.0)
        self.unknowns = self.start.size - int(np.isfinite(prediction.prior).sum())
        self.freedom = max(self.observed.size - self.unknowns, 1)
        sensor = range(self.start.size - len(prediction.sensor), self.start.size)
        self.named = [*range(len(names)), *sensor]
        self.last: tuple[Array, ImpactOscillator, Array] | None = None

    def values(self, unknowns: Array) -> Array:
        """Parameters and further unknowns in their units."""
        found = unknowns * self.sizes
        found[self.log] = self.sizes[self.log] * np.exp(np.clip(unknowns[self.log], -50.0, 50.0))
        return np.asarray(found)

    def unknowns_of(self, values: Array) -> Array:
        """The inverse of `values`."""
        found = values / self.sizes
        found[self.log] = np.log(np.maximum(found[self.log], TINY))
        return np.asarray(found)

    def slopes(self, unknowns: Array) -> Array:
        """Derivatives of `values` by the unknowns, shape (n,)."""
        return np.asarray(np.where(self.log, self.values(unknowns), self.sizes))

    def at(self, unknowns: Array) -> tuple[ImpactOscillator, Array]:
        """Oscillator and further unknowns; for the same unknowns the same objects."""
        if self.last is None or not np.array_equal(self.last[0], unknowns):
            values, n = self.values(unknowns), len(self.names)
            own = dict(zip(self.names, values[:n].tolist(), strict=True))
            self.last = unknowns.copy(), with_values(self.oscillator, own), values[n:]
        return self.last[1], self.last[2]

    @through_any_value()
    def residuals(self, unknowns: Array) -> Array:
        """Residuals of rows and priors; not a number where there is no motion, which rejects the step."""
        try:
            if np.any(np.abs(unknowns - self.start) > self.farthest):
                raise NoAnswer("free period or drive frequency is far from where the search begins")
            predicted = self.prediction.values(*self.at(unknowns)).ravel()
        except (ContactError, Refusal):
            return np.full(self.observed.size + self.held.size, np.nan)
        off = (predicted - self.observed) * self.weights
        return np.concatenate([off, (unknowns - self.middle) * self.held])

    @through_any_value()
    def jacobian(self, unknowns: Array) -> Array:
        """Shape (rows + unknowns, unknowns); NoAnswer if it is not finite."""
        rows = self.prediction.jacobian(*self.at(unknowns), self.names) * self.weights[:, None]
        if not np.all(np.isfinite(rows)):
            raise NoAnswer("the motion depends too sensitively on its start")
        return np.vstack([rows * self.slopes(unknowns), np.diag(self.held)])

    def of(self, prediction: Prediction) -> Self:
        """The same problem by a prediction that stands elsewhere."""
        found = copy.copy(self)
        found.prediction, found.last = prediction, None
        return found

    def solve(self, start: Array, most: int = MOST, gain: float = GAIN) -> Found:
        """The best fit from `start`, in so many steps at `most`, until a step lowers chi^2 by no more than
        `gain` times the noise's variance."""
        if not np.all(np.isfinite(self.residuals(start))):
            raise NoAnswer("no motion like the record's was found to start from")
        return descend(self.residuals, self.jacobian, start, self.bounds, most, gain / self.freedom)


def chance_of(problem: Problem, solved: Found, known: bool) -> float:
    """Probability of residuals of this size or pattern from noise alone."""
    prediction, freedom = problem.prediction, problem.freedom
    residuals = solved.fun[: problem.observed.size]
    found = [float(stats.chi2.sf(residuals @ residuals, freedom))] if known else []
    kind, period = prediction.record.kind, prediction.m
    if kind == "strobe":
        rows = residuals.reshape(len(prediction.record.rows), -1)
        means = np.array([rows[k::period].mean(axis=0) for k in range(period)])
        within = float(np.sum((rows - means[np.arange(len(rows)) % period]) ** 2))
        found += _beyond(float(residuals @ residuals), within, freedom - residuals.size + means.size, freedom)
    if kind == "motion":
        size, off = residuals.size, residuals - residuals.mean()
        lagged = np.array([off[k:] @ off[:-k] for k in range(1, LAGS + 1)]) / (off @ off)
        box = size * (size + 2) * np.sum(lagged**2 / (size - np.arange(1, LAGS + 1)))
        found.append(float(stats.chi2.sf(box, LAGS)))
        if period:
            times = prediction.record.rows[:, 0]
            base = problem.at(solved.x)[0].driven.frequency / period
            lines, scatter = harmonics(times, residuals, base, count_of(times, base))
            more = 2 * lines.size - 1 - problem.unknowns
            within = scatter**2 * (size - 2 * lines.size + 1)
            found += _beyond(float(residuals @ residuals), within, more, freedom)
    return min(1.0, len(found) * min(found)) if found else 1.0


def _beyond(whole: float, within: float, more: int, freedom: int) -> list[float]:
    """Probability that so many numbers `more` than those that are fitted leave no more than this of chi^2."""
    spare = freedom - more
    if more < 1 or spare < 1:
        return []
    return [float(stats.f.sf((whole - within) / more / (within / spare), more, spare))]
