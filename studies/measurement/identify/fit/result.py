"""A fit: parameters, errors, correlations and intervals, and whether the record determines them.

    covariance  s^2 (J^T J)^-1,   s^2 = 1 where the noise is known, else chi^2/(n - number of unknowns).

90 % intervals follow from Student's t for the unknowns of the fit, or from a profile of the likelihood.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy import stats
from scipy.special import expit, logit

from contact import ImpactOscillator
from studies.measurement.identify.fit.descent import SEEN, Found
from studies.measurement.identify.fit.problem import MOST, SETTLED, Problem, chance_of
from studies.measurement.identify.fit.profiles import Walk
from studies.measurement.identify.motion.readings import SENSOR
from studies.measurement.identify.record.records import Array, NoAnswer, Record, Undetermined
from studies.physics.parameters import parameters_of
from studies.shell.digits import in_unit

LEVEL = 0.90  # probability of the intervals
TOO_SMALL = 1e-3  # probability of such residuals from noise alone, below which the model is too small
OPEN = ("stiffness",)  # may have no end: a record may only show that a stop is harder than a bound
SIZES = {"restitution": 0.5, "phase": 1.0, "offset": math.inf}  # least sizes; some values may be zero
PART = 0.3  # of the largest, from which a parameter takes part in a direction that is not determined
LOST = 2.0  # standard error of a logarithm above which its parameter is not determined
LONGEST = 300.0  # logarithm of the longest interval


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """A fit; arrays by `names`, parameters and then numbers of the sensor, in SI units.

    `before` has the values before the record was looked at, `start` the ones where the fit began.  `noise` is
    the standard deviation of x [m], or of an excess in units of its error.  `residuals` are observed less
    predicted, in the shape of the record's `observed`.  `chance` is the probability of residuals of such
    size or pattern from noise alone, `left` the fall of chi^2 by a further step in the noise's variance.
    `problem` and `unknowns` are what was solved.  `walks` has the intervals of the parameters along which
    chi^2 is no parabola, by its profile.
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
    residuals: Array
    chance: float
    left: float
    problem: Problem
    unknowns: Array
    walks: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def errors(self) -> Array:
        """Standard errors; of a parameter with a profile those that would give its interval."""
        found = np.sqrt(np.diag(self.covariance))
        for name, ends in self.walks.items():
            i = self.names.index(name)
            lasting = [math.isfinite(end) and not (end == 0.0 and self.problem.log[i]) for end in ends]
            sides = [abs(end - self.estimate[i]) for end, lasts in zip(ends, lasting, strict=True) if lasts]
            found[i] = np.mean(sides) / self.reach if all(lasting) else math.inf
            if name in OPEN and sides:
                found[i] = min(sides) / self.reach
        return np.asarray(found)

    @property
    def correlations(self) -> Array:
        """Shape (n, n)."""
        errors = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(errors, errors)

    def walk(self, name: str) -> Walk:
        """The likelihood along a parameter."""
        variance, i = (self.noise / self.problem.noise) ** 2, self.names.index(name)
        error = float(np.sqrt(self.covariance[i, i]))
        return Walk(self.problem, self.unknowns, error, variance, name)

    @property
    def too_small(self) -> bool:
        """Whether the residuals are unlike noise: the model is too small for the record."""
        return self.chance < TOO_SMALL

    @property
    def against_noise(self) -> str:
        """The size of the residuals beside the given noise, in words."""
        seen, given = (in_unit(one, self.record.unit, 3) for one in (float(self.residuals.std()), self.noise))
        return f"the residuals are {seen}, the given noise is {given}"

    @property
    def settled(self) -> bool:
        """Whether no further step would lower chi^2 by more than a part of the noise's variance."""
        return self.left <= SETTLED

    @property
    def reach(self) -> float:
        """Half a 90 % interval in standard errors, by Student's t; the normal law's if noise is known."""
        tail = 0.5 + 0.5 * LEVEL
        return float(stats.norm.ppf(tail) if self.noise_known else stats.t.ppf(tail, self.problem.freedom))

    def intervals(self) -> Array:
        """Lower and upper ends, shape (n, 2), within the physical range.

        They follow from intervals of the unknowns; for a restitution r from an interval of log(r/(1 - r)).
        """
        log = self.problem.log[self.problem.named]
        wide = self.reach * np.sqrt(np.diag(self.covariance))
        found = self.estimate[:, None] + np.outer(wide, [-1.0, 1.0])
        factor = np.exp(np.minimum(wide[log] / self.estimate[log], LONGEST))
        found[log] = self.estimate[log, None] * np.column_stack([1.0 / factor, factor])
        for i, name in enumerate(self.names):
            if name == "restitution" and 0.0 < (r := self.estimate[i]) < 1.0:
                part = wide[i] / (r * (1.0 - r))
                found[i] = expit(logit(r) + np.array([-part, part]))
            found[i] = self.walks.get(name, found[i])
        return np.asarray(found)


def judged(problem: Problem, found: Found, oscillator: ImpactOscillator, known: bool) -> Fit:
    """The fit that a solution is; NoAnswer if the record does not determine it."""
    prediction, rows = problem.prediction, problem.observed.size
    spread = 1.0 if known else float(np.sqrt(found.chi2 / problem.freedom))
    names, own = problem.names + prediction.sensor, problem.named
    chance = chance_of(problem, found, known)
    lengths = np.linalg.norm(found.jac, axis=0)
    lengths[lengths == 0.0] = 1.0
    _left, singular, axes = np.linalg.svd(found.jac / lengths, full_matrices=False)
    slopes, values = problem.slopes(found.x), problem.values(found.x)
    sizes = np.where(problem.log, LOST * np.abs(values), np.maximum(np.abs(values), problem.sizes))
    axes = axes / lengths * slopes
    lost = not singular[-1] > SEEN * singular[0]
    if lost and chance > TOO_SMALL:
        blind = _blind((axes / sizes)[:, own], names)
        raise Undetermined(f"the record cannot {blind}: fit fewer parameters or another record")
    covariance = (axes.T / np.maximum(singular, SEEN * singular[0]) ** 2 @ axes * spread**2)[np.ix_(own, own)]
    before = parameters_of(oscillator)
    return Fit(
        record=prediction.record,
        oscillator=problem.at(found.x)[0],
        names=names,
        start=problem.values(problem.start)[own],
        before=np.array([before[name].value if name in before else SENSOR[name] for name in names]),
        estimate=values[own],
        covariance=covariance,
        noise=spread * problem.noise,
        noise_known=known,
        residuals=(-found.fun[:rows] / problem.weights).reshape(prediction.record.observed.shape),
        chance=chance,
        left=found.left / spread**2,
        problem=problem,
        unknowns=found.x,
    )


def determined(found: Fit) -> Fit:
    """The fit; NoAnswer if the error of a parameter is above its value, or if it has not settled."""
    sizes = np.array([SIZES.get(name, 0.0) for name in found.names])
    sizes = np.maximum(np.abs(found.estimate), sizes)
    sizes[found.problem.log[found.problem.named]] *= LOST
    share = found.errors / sizes
    if not found.too_small and not np.all(share <= 1.0):  # else the residuals say so
        axes = np.linalg.eigh(found.covariance / np.outer(sizes, sizes))[1].T
        by_slopes = np.where(share <= 1.0, 0.0, np.sqrt(np.diag(found.covariance)) / sizes)
        worst, blind = found.names[int(np.argmax(by_slopes))], _blind(axes, found.names)
        blind = blind if worst in blind.split() else f"determine {worst}"
        raise Undetermined(f"the record cannot {blind}: the standard error of {worst} is above its value")
    if not found.settled and not found.too_small:
        fall = f"chi^2 would still fall by {found.left:.2g}"
        raise NoAnswer(f"the fit has not settled after {MOST} steps: {fall}")
    return found


def _blind(axes: Array, names: Sequence[str]) -> str:
    """The parameters of the last axis, which a record cannot separate or determine."""
    share = np.abs(axes[-1])
    blind = [name for name, part in zip(names, share, strict=True) if part > PART * share.max()]
    return f"separate {' from '.join(blind)}" if len(blind) > 1 else f"determine {blind[0]}"
