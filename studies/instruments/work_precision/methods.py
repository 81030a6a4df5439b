"""Which methods run at which settings.

Fixed steps start at one step per contact (hard wall: 32 steps per drive period), or at the limit of stability
of the fastest mode, 2/omega, if that is smaller, and are quartered from one setting to the next.  Outside
solvers run over their tolerance.  Exact methods have one setting.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.integrators import (
    EXACT_NAMES,
    CentralDifference,
    Exact,
    GeneralisedAlpha,
    Integrator,
    MoreauJean,
    NonsmoothGeneralisedAlpha,
    SampledFlight,
    Splitting,
)
from studies.instruments import peers
from studies.instruments.work_precision.problems import Problem

__all__ = ["Line", "Setting", "lines_for", "missing_peers"]

EXACT, STEPPED, OUTSIDE = "exact", "fixed step", "outside"

FINEST, FINEST_HARD = 7, 10
"""Settings of a fixed step: down to 1/4096 of a contact, and to 1/2^23 of a period for the hard wall."""

POINTS = tuple(4**k for k in range(1, 9))
"""Samples of a flight per drive period."""

TOLERANCES = tuple(10.0**-p for p in (3, 5, 7, 9, 11, 13))


@dataclass(frozen=True, kw_only=True)
class Setting:
    """One point of a line: what is turned, its words, and the method."""

    value: float
    words: str
    method: Integrator


@dataclass(frozen=True, kw_only=True)
class Line:
    """A method over its settings, the coarsest first.

    Parameters
    ----------
    label : str
    family : str
        "exact", "fixed step" or "outside".
    growth : float
        Factor by which a setting costs more than the one before; 1 for a single setting.
    settings : tuple of Setting
    """

    label: str
    family: str
    growth: float
    settings: tuple[Setting, ...]


def coarsest_step(problem: Problem) -> float:
    """Step with which the ladder begins [s]."""
    fastest = 2.0 / float(np.max(problem.oscillator.model.omega))
    return min(problem.contact_time, fastest) if problem.contact_time > 0.0 else problem.period / 32.0


def _exact(law: int) -> Line:
    setting = Setting(value=float("nan"), words="exact", method=Exact())
    return Line(label=EXACT_NAMES[law], family=EXACT, growth=1.0, settings=(setting,))


STEPS: dict[str, Callable[[float], Integrator]] = {
    "central difference": lambda h: CentralDifference(step=h),
    "splitting, order 2": lambda h: Splitting(step=h, order=2),
    "splitting, order 4": lambda h: Splitting(step=h, order=4),
    "Newmark, 1/4, 1/2": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, alpha 0.05": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.05),
    "generalised alpha, rho 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "Moreau-Jean, theta 1/2": lambda h: MoreauJean(step=h),
    "nonsmooth generalised alpha, rho 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
}
"""Methods with a step by their labels."""


def lines_for(problem: Problem, *, quick: bool = False) -> list[Line]:
    """Every method that knows the law of `problem`, over its settings."""
    lines = [_exact(problem.law)]
    stride = 3 if quick else 1
    hard = problem.contact_time == 0.0
    steps = coarsest_step(problem) * 4.0 ** -np.arange(0, FINEST_HARD if hard else FINEST, stride)
    for label, make in STEPS.items():
        if make(1.0).accepts(problem.law):
            settings = tuple(
                Setting(value=h, words=f"step {h:.3g} s", method=make(h)) for h in steps.tolist()
            )
            lines.append(Line(label=label, family=STEPPED, growth=4.0**stride, settings=settings))
    if problem.law in SampledFlight.laws:
        settings = tuple(
            Setting(value=1.0 / n, words=f"{n} points per period", method=SampledFlight(points=n))
            for n in POINTS[::stride]
        )
        lines.append(Line(label="sampled flight", family=STEPPED, growth=4.0**stride, settings=settings))
    tolerances = TOLERANCES[1::3] if quick else TOLERANCES
    ladders = [peers.lineup(tolerance) for tolerance in tolerances]
    for label, peer in ladders[0].items():
        if peer.accepts(problem.law):
            settings = tuple(
                Setting(value=tolerance, words=f"tolerance {tolerance:.0e}", method=ladder[label])
                for tolerance, ladder in zip(tolerances, ladders, strict=True)
            )
            lines.append(Line(label=label, family=OUTSIDE, growth=3.0**stride, settings=settings))
    return lines


def missing_peers() -> list[str]:
    """Outside libraries that are not installed."""
    return sorted(set(peers.PEERS) - set(peers.available()))
