"""Which methods run at which settings.

Fixed steps start at one step per contact (hard wall: 32 steps per drive period), or at the limit of stability
of the fastest mode, 2/omega, if that is smaller, and are quartered from one setting to the next. Outside
solvers run over their tolerance. The exact method has one setting.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contact.integrators import (
    CentralDifference,
    Exact,
    GeneralisedAlpha,
    Integrator,
    MoreauJean,
    NonsmoothGeneralisedAlpha,
    SampledFlight,
    Splitting,
)
from studies.methods.peers import OutsideSolver, installed_solvers
from studies.methods.work_precision.problems import Problem

EXACT, STEPPED, OUTSIDE, PERIODIC = "exact", "fixed step", "outside", "periodic motion"
SAMPLED = "sampled flight"  # the letter's own scheme, note [11]

FINEST, FINEST_HARD = 7, 10
"""Settings of a fixed step: down to 1/4096 of a contact, and to 1/2^23 of a period for the hard wall."""

POINTS = tuple(4**k for k in range(1, 9))  # samples of a flight per drive period

TOLERANCES = tuple(10.0**-p for p in (3, 5, 7, 9, 11, 13))

STEPS: dict[str, Callable[[float], Integrator]] = {
    "central difference": lambda h: CentralDifference(step=h),
    "splitting, order 2": lambda h: Splitting(step=h, order=2),
    "splitting, order 4": lambda h: Splitting(step=h, order=4),
    "Newmark, β 1/4, γ 1/2": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, α 0.05": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.05),
    "generalised α, ρ 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "Moreau-Jean, θ 1/2": lambda h: MoreauJean(step=h),
    "nonsmooth generalised α, ρ 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
}
"""Methods with a step [s] by their labels."""


class Setting(NamedTuple):
    """One point of a sweep: step, samples' spacing over the period or tolerance; text; method; unit."""

    value: float | None
    text: str
    method: Integrator
    unit: str = "1"


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """A method over its settings, the coarsest first; each costs `growth` times as much as the one before."""

    label: str
    family: str
    growth: float
    settings: list[Setting]


def sweeps_for(problem: Problem, *, quick: bool = False) -> list[Sweep]:
    """Every method that knows the law of `problem`, over its settings."""
    law, stride, found = problem.oscillator.stop.law.code, 3 if quick else 1, list[Sweep]()

    def add(label: str, family: str, growth: float, settings: list[Setting]) -> None:
        if settings[0].method.accepts(law):
            found.append(Sweep(label=label, family=family, growth=growth**stride, settings=settings))

    add("exact method", EXACT, 1.0, [Setting(None, "exact", Exact())])
    finest = FINEST_HARD if problem.contact_time == 0.0 else FINEST
    fastest = 2.0 / float(np.max(problem.oscillator.model.omega))
    coarsest = min(problem.contact_time, fastest) if problem.contact_time > 0.0 else problem.period / 32.0
    steps = (coarsest * 4.0 ** -np.arange(0, finest, stride)).tolist()
    for label, made in STEPS.items():
        add(label, STEPPED, 4.0, [Setting(h, f"step {h:.3g} s", made(h), "s") for h in steps])
    rare = [(n, SampledFlight(points=n)) for n in POINTS[::stride]]
    add(SAMPLED, STEPPED, 4.0, [Setting(1.0 / n, f"{n} points per period", method) for n, method in rare])
    for label in installed_solvers():
        tolerances = TOLERANCES[1::3] if quick else TOLERANCES
        peers = [(tol, OutsideSolver(solver=label, tolerance=tol)) for tol in tolerances]
        settings = [Setting(tol, f"tolerance {tol:.0e}", peer) for tol, peer in peers]
        add(label.replace("scipy", "SciPy"), OUTSIDE, 3.0, settings)
    return found
