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
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import least_squares

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactOscillator
from studies import letter
from studies.measurement.identify.predictions import Prediction
from studies.measurement.identify.records import READ_OUT, Record
from studies.measurement.identify.starts import prediction_of
from studies.physics.parameters import parameters_of, require_names, with_values

Array = NDArray[np.float64]

LEVEL = 0.90
"""Probability of the intervals."""

SINGULAR = 1e-8
"""Ratio of singular values below which the record does not depend on a direction of the parameters."""

TOO_SMALL = 1e-3
"""Probability of such residuals from noise alone, below which the model is called too small."""

LAGS = 10
"""Number of lags in the autocorrelation of residuals."""

MOST = 200
"""Steps of a fit: a dozen are usual, a hundred along a valley of two parameters that trade off."""

LEASH = 1.0
"""Prior of the parameters while the beginning of a record is fitted, which need not determine all of them."""

REGION, PART = 2.0, 0.3
"""Half axes of the confidence region in standard errors; part of the largest from which a parameter takes
part in a direction that is not determined."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """A fit; arrays by `names`, in SI units: `before` the record was looked at, at the `start` of the fit.

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
        """Lower and upper ends, shape (n, 2)."""
        return self.estimate[:, None] + np.outer(self.errors, [-self.reach, self.reach])


class Problem:
    """Residuals and Jacobian in units of the noise, by unknowns in units of their size.

    The further unknowns are held by their prior, the parameters by a `leash`: a standard deviation about
    where they start, in units of their size.
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
        self.start = np.concatenate([[known[name].value for name in names], prediction.extra]) / self.sizes
        self.weights = 1.0 / prediction.record.units(noise).ravel()
        self.observed = prediction.record.observed.ravel()
        self.noise, own = noise, np.arange(self.sizes.size) < len(names)
        self.held = 1.0 / np.append(np.full(len(names), leash), prediction.prior / prediction.sizes)
        self.middle = np.where(own, self.start, 0.0)
        self.last: tuple[Array, ImpactOscillator, Array] | None = None

    def at(self, unknowns: Array) -> tuple[ImpactOscillator, Array]:
        """Oscillator and further unknowns; for the same unknowns the same objects."""
        if self.last is None or not np.array_equal(self.last[0], unknowns):
            values, n = unknowns * self.sizes, len(self.names)
            own = dict(zip(self.names, values[:n].tolist(), strict=True))
            self.last = unknowns.copy(), with_values(self.oscillator, own), values[n:]
        return self.last[1], self.last[2]

    def residuals(self, unknowns: Array) -> Array:
        """Residuals of rows and priors, shape (rows + unknowns,); not a number where there is no orbit, which
        rejects the step."""
        try:
            oscillator, extra = self.at(unknowns)
            predicted = self.prediction.values(oscillator, extra).ravel()
        except (ContactError, Refusal):
            return np.full(self.observed.size + self.held.size, np.nan)
        off = (predicted - self.observed) * self.weights
        return np.concatenate([off, (unknowns - self.middle) * self.held])

    def jacobian(self, unknowns: Array) -> Array:
        """Shape (rows + unknowns, unknowns)."""
        rows = self.prediction.jacobian(*self.at(unknowns), self.names) * self.weights[:, None]
        return np.vstack([rows * self.sizes, np.diag(self.held)])

    def solve(self, start: Array) -> Any:
        """``scipy.optimize.least_squares`` from `start`."""
        if not np.all(np.isfinite(self.residuals(start))):
            raise InvalidValue(
                "no motion like the record's was found to start from: fit more, or give better values"
            )
        with np.errstate(all="ignore"):  # of the trust region, along what is not seen
            return least_squares(
                self.residuals,
                start,
                jac=self.jacobian,
                x_scale="jac",
                max_nfev=MOST,
                xtol=1e-10,
                ftol=1e-12,
                gtol=1e-12,
            )


def fit(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str], *, noise: float | None = None
) -> Fit:
    """Fit the named parameters; the others keep the values of `oscillator`, driven as the record was.

    `noise` is the standard deviation of the read-out where it is known [m], or of the excesses of a table.
    ValueError is raised, in one sentence, for a record that cannot determine them.
    """
    require_names(names, oscillator)
    names = tuple(names)
    table = record.kind == "transitions"
    known = noise is not None or len(record.columns) == 4
    unit = noise or (letter.AMPLITUDE_STABILITY if table else READ_OUT)
    prediction, begun = prediction_of(record, oscillator, names)
    problem = Problem(prediction, begun, names, unit)
    rows, unknowns = problem.observed.size, problem.start.size - int(np.isfinite(prediction.prior).sum())
    if rows < unknowns + (not known):
        raise InvalidValue(
            f"the record has {rows} numbers, too short for {unknowns} unknowns and their errors"
        )
    at = start = problem.start
    for part in prediction.parts(begun)[:-1]:
        start = Problem(part, begun, names, unit, LEASH).solve(start).x
    found = problem.solve(start)
    if found.status == 0:
        raise InvalidValue(f"the fit has not settled after {MOST} steps: give better values, or fit fewer")
    freedom = max(rows - unknowns, 1)
    spread = 1.0 if known else float(np.sqrt(2.0 * found.cost / freedom))
    n, sizes, shape = len(names), problem.sizes, prediction.record.observed.shape
    _u, singular, axes = np.linalg.svd(found.jac, full_matrices=False)
    if not singular[-1] > SINGULAR * singular[0]:
        raise InvalidValue(f"the record cannot {_blind(axes, names)}: fit fewer parameters or another record")
    covariance = (axes.T / singular**2 @ axes * np.outer(sizes, sizes) * spread**2)[:n, :n]
    result = Fit(
        record=prediction.record,
        oscillator=problem.at(found.x)[0],
        names=names,
        start=(at * sizes)[:n],
        before=np.array([parameters_of(oscillator)[name].value for name in names]),
        estimate=(found.x * sizes)[:n],
        covariance=covariance,
        noise=spread * unit,
        noise_known=known,
        freedom=freedom,
        residuals=(-found.fun[:rows] / problem.weights).reshape(shape),
        chance=_chance(found.fun[:rows], prediction, known, freedom),
        problem=problem,
        unknowns=found.x,
    )
    if not result.too_small:  # else errors mean little, and `report` says so
        lost = result.errors > sizes[:n] * np.maximum(np.abs(found.x[:n]), 1.0)
        if np.any(lost):
            worst = names[int(np.argmax(lost))]
            raise InvalidValue(
                f"the record cannot {_blind(axes, names)}: the standard error of {worst} is above its value"
            )
        _require_same_impacts(problem, found.x, axes * spread / singular[:, None])
    return result


def _blind(axes: Array, names: Sequence[str]) -> str:
    """The parameters of the last axis, which a record cannot separate or determine."""
    share = np.abs(axes[-1][: len(names)])
    blind = [name for name, part in zip(names, share, strict=True) if part > PART * share.max()]
    return f"tell {' from '.join(blind)}" if len(blind) > 1 else f"determine {blind[0]}"


def _require_same_impacts(problem: Problem, unknowns: Array, axes: Array) -> None:
    """ValueError if the impacts change inside the confidence region with these half axes."""
    touches, before = problem.prediction.touches, problem.prediction.touches(*problem.at(unknowns))
    for axis in [sign * axis for axis in axes for sign in (-REGION, REGION)]:
        try:
            same = touches(*problem.at(unknowns + axis)) == before
        except (ContactError, Refusal):
            same = False
        if not same:
            raise InvalidValue(
                "the orbit changes its impacts inside the confidence region, so that errors mean nothing: "
                "record it longer, or farther from where it ends"
            )


def _chance(residuals: Array, prediction: Prediction, known: bool, freedom: int) -> float:
    """Probability of residuals of this size or pattern from noise alone."""
    found = [float(stats.chi2.sf(residuals @ residuals, freedom))] if known else []
    kind, period = prediction.record.kind, prediction.period
    if kind == "strobe":
        rows = residuals.reshape(len(prediction.record.rows), -1)
        means = np.array([rows[k::period].mean(axis=0) for k in range(period)])
        within = float(np.sum((rows - means[np.arange(len(rows)) % period]) ** 2))
        more, spare = freedom - residuals.size + means.size, residuals.size - means.size
        if more > 0 and spare > 0:
            ratio = (residuals @ residuals - within) / more / (within / spare)
            found.append(float(stats.f.sf(ratio, more, spare)))
    if kind == "displacement":
        size, off = residuals.size, residuals - residuals.mean()
        lagged = np.array([off[k:] @ off[:-k] for k in range(1, LAGS + 1)]) / (off @ off)
        box = size * (size + 2) * np.sum(lagged**2 / (size - np.arange(1, LAGS + 1)))
        found.append(float(stats.chi2.sf(box, LAGS)))
    return min(1.0, len(found) * min(found)) if found else 1.0
