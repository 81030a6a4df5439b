"""The rows of a fit: estimates with errors and intervals, and the quality of the fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.measurement.identify.displacement import UNITS
from studies.measurement.identify.fit import Fit
from studies.measurement.identify.profiles import Profile, profile
from studies.physics.parameters import parameters_of

TRADE = 0.95
"""Correlation from which on two parameters trade off."""

SHOWN = ("record", "parameter", "unit", "start", "short", "low90", "high90", "scene")
"""Columns of the estimates on the terminal."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One parameter of a fit.

    The 90 % interval is that of the profile likelihood where there is one.  ``short`` is the estimate with
    its error, 40.80(2); ``scene`` is the value of the scene; ``correlations`` are with each parameter in
    turn.
    """

    record: str
    parameter: str
    unit: str
    start: float
    estimate: float
    standard_error: float
    low90: float
    high90: float
    scene: float
    short: str
    correlations: tuple[float, ...]


@dataclass(frozen=True)
class Quality:
    """The residuals of a fit.

    ``noise`` is that of x [m], or of an excess [1]; ``chance`` is the probability of such residuals from
    noise alone.  The model is too small if it is below 0.001.
    """

    record: str
    rows: int
    noise: float
    freedom: int
    chance: float
    too_small: bool


def estimates_of(name: str, found: Fit, profiles: Sequence[Profile]) -> list[Estimate]:
    """The rows of a fit; intervals come from the likelihood where its profile is known."""
    units = {name: one.unit for name, one in parameters_of(found.oscillator).items()} | UNITS
    intervals = dict(zip(found.names, found.intervals(), strict=True))
    for one in {row.parameter for row in profiles}:
        points = [row for row in profiles if row.parameter == one]
        values, depth = np.array([(row.value, max(row.depth, 0.0)) for row in points]).T
        middle = found.estimate[found.names.index(one)]
        roots, reach = np.copysign(depth**0.5, values - middle), found.reach
        intervals[one] = np.interp([-reach, reach], roots, values)
    return [
        Estimate(
            record=name,
            parameter=one,
            unit=units[one],
            start=float(found.start[i]),
            low90=float(low),
            estimate=float(found.estimate[i]),
            standard_error=float(found.errors[i]),
            high90=float(high),
            short=in_short(float(found.estimate[i]), float(found.errors[i])),
            scene=float(found.before[i]),
            correlations=tuple(found.correlations[i].tolist()),
        )
        for i, (one, (low, high)) in enumerate(intervals.items())
    ]


def in_short(value: float, error: float) -> str:
    """The value with its error in units of its last digits, 0.04080(2)."""
    if not 0.0 < error < math.inf:
        return f"{value:.6g}"
    digits = 1 - math.floor(math.log10(error))
    return f"{value:.{max(digits, 0)}f}({round(error * 10.0 ** max(digits, 0))})"


def traded(found: Fit, quick: bool) -> list[Profile]:
    """The profile of each parameter that trades off with another, the most correlated pair first.

    The small form has this pair alone, with fewer points.
    """
    size = np.abs(found.correlations) - np.eye(len(found.names))
    partners = {i: int(np.argmax(row)) for i, row in enumerate(size) if row.max() > TRADE}
    partners = {i: k for i, k in partners.items() if max(i, k) < len(found.problem.names)}
    order = sorted(partners, key=lambda i: -size[i, partners[i]])
    kept = [i for k, i in enumerate(order) if partners[i] not in order[:k] or partners[partners[i]] != i]
    return [
        row
        for i in kept[: 1 if quick else None]
        for row in profile(found, found.names[i], found.names[partners[i]], points=5 if quick else 9)
    ]
