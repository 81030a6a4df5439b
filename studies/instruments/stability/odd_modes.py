r"""Odd modes: critically damped or nearly so, repeated, of zero frequency, damped hardly at all or very much.

Every mode of a flight has a closed form in which D = omega^2 - (c/2)^2 is formed to 32 digits
(``contact.flight``), and in contact the motion is a power series: neither takes eigenvectors, so that none of
these cases should cost a digit.  The error of the flow of one mode over a time t is

    max |P - P_exact| / max |P_exact|,   P in units in which u is omega times the displacement,

against 60 digits; that of a collision is the one of ``odd_springs``.

The contrast is the way through the eigenvectors of the first-order matrix A = [[0, 1], [-omega^2, -c]], exp(A
t) = V exp(L t) V^-1.  At zeta = 1 + d the two eigenvectors meet as sqrt(2 d): the condition of V is about
sqrt(2/d), so that the error is about

    eps sqrt(2/d)                                                                                          (a)

and 1e-12 are passed at d = 2 (eps/1e-12)^2 = 1e-7; at critical damping rounding alone keeps the two apart.
(Just below it the vectors are conjugate, and most of the error cancels in a 2 x 2 matrix.)  The Pade
approximation with scaling and squaring (scipy.linalg.expm) needs no eigenvectors, but its products lose
digits with the norm c t of a strongly damped mode.

Units: SI.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal, localcontext
from typing import Any

import numpy as np
import scipy.linalg

from beam.reduction import ModalModel
from contact.errors import ContactTooStiff
from contact.event_loop import MOST_STEPS
from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import damped_frequency
from contact.integrators import Exact
from contact.simulation import simulate
from studies.instruments.scene import Scene
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.extended_precision import DIGITS, flow
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.odd_figures import draw_odd
from studies.instruments.stability.odd_springs import collide, error_of_collision, spring

__all__ = ["by_eigenvectors", "by_pade", "cases", "draw", "flow_error", "measure", "package_flow"]

NAME = "piecewise-linear"
EPS = 2.0**-52
OMEGA = 150.0
TIMES = np.geomspace(1e-3, 30.0, 24) / OMEGA
"""Times of the flows: from a thousandth of a radian to thirty [s]."""
DISTANCES = (0.0, 2.0**-52, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
RATIOS = (1e-15, 1e-12, 1e-6, 1e-2, 1.0, 1e2, 1e4, 1e6)
LOST = 1e-12
"""Error from which on a flow counts as having lost digits."""

Flow = Callable[[float, float, float], np.ndarray]


def package_flow(omega: float, decay: float, time: float) -> np.ndarray:
    """The flow of the package, shape (2, 2)."""
    high, low = damped_frequency(omega, decay)
    return np.array(flow_matrix(omega, decay, high, low, time)).reshape(2, 2)


def _matrix(omega: float, decay: float) -> np.ndarray:
    return np.array([[0.0, 1.0], [-omega * omega, -decay]])


def by_eigenvectors(omega: float, decay: float, time: float) -> np.ndarray:
    """V exp(L t) V^-1, NaN where V cannot be inverted."""
    values, vectors = scipy.linalg.eig(_matrix(omega, decay))
    try:
        inverse = np.linalg.inv(vectors)
    except np.linalg.LinAlgError:
        return np.full((2, 2), np.nan)
    return np.real((vectors * np.exp(values * time)) @ inverse)


def by_pade(omega: float, decay: float, time: float) -> np.ndarray:
    """scipy.linalg.expm."""
    return scipy.linalg.expm(_matrix(omega, decay) * time)


def flow_error(method: Flow, omega: float, decay: float, times: np.ndarray = TIMES) -> float:
    """Largest relative error of a flow over `times`; infinite where it gives none."""
    weight = omega if omega > 0.0 else 1.0
    scale = np.array([[1.0, weight], [1.0 / weight, 1.0]])
    worst = 0.0
    for t in times:
        with localcontext() as context:
            context.prec = DIGITS
            exact = [[Decimal(0)] * 2, [Decimal(0)] * 2]
            (exact[0][0], exact[0][1], exact[1][0], exact[1][1]) = flow(omega, decay, Decimal(float(t)))
            found = method(omega, decay, float(t))
            if not np.all(np.isfinite(found)):
                return math.inf
            off = np.array(
                [[float(Decimal(float(found[i, j])) - exact[i][j]) for j in (0, 1)] for i in (0, 1)]
            )
            size = np.array([[float(exact[i][j]) for j in (0, 1)] for i in (0, 1)])
        worst = max(worst, float(np.abs(off * scale).max() / np.abs(size * scale).max()))
    return worst


def cases() -> dict[str, ModalModel]:
    """Springs of three modes with something odd about the second."""
    plain = spring(3)
    w = float(plain.omega[1])

    def second(omega: float, decay: float) -> ModalModel:
        omegas, decays = plain.omega.copy(), plain.decay_rate.copy()
        omegas[1], decays[1] = omega, decay
        return replace(plain, omega=omegas, decay_rate=decays)

    distances = (1e-4, 1e-8, 1e-12, -1e-12, -1e-8)
    near = {f"zeta - 1 = {d:+.0e}": second(w, 2.0 * w * (1.0 + d)) for d in distances}
    first, decay = float(plain.omega[0]), float(plain.decay_rate[0])
    return {
        "all ordinary": plain,
        "zeta = 1": second(w, 2.0 * w),
        "zeta one rounding above 1": second(w, float(np.nextafter(2.0 * w, np.inf))),
        "zeta one rounding below 1": second(w, float(np.nextafter(2.0 * w, 0.0))),
        **near,
        "repeated": second(first, decay),
        "repeated to 1e-15": second(first * (1.0 + 1e-15), decay),
        "repeated to 1e-8": second(first * (1.0 + 1e-8), decay),
        "zero frequency": second(0.0, 0.0),
        "zero frequency, drag": second(0.0, 30.0),
        "zeta = 1e-15": second(w, 2e-15 * w),
        "zeta = 1e2": second(w, 2e2 * w),
        "zeta = 1e3": second(w, 2e3 * w),
        "zeta = 1e6, omega 1": second(1.0, 2e6),
    }


STIFFNESS = 1e5
"""Stop of the collisions [N/m]: about a millisecond of contact."""


def overdamped(quick: bool) -> list[Limit]:
    """How strongly one mode may be damped until a contact takes too many steps."""
    plain = spring(2)

    def decayed(c: float) -> ModalModel:
        decays = plain.decay_rate.copy()
        decays[1] = c
        return replace(plain, decay_rate=decays)

    counted = 1e8
    found = collide(decayed(counted), STIFFNESS)
    lasts = found.release - found.touch
    step = counted * lasts / found.run.evaluations
    theory = MOST_STEPS * step / lasts

    def ends(c: float) -> bool:
        oscillator = replace(found.oscillator, model=decayed(c))
        try:
            simulate(oscillator, found.start, duration=found.end)
        except ContactTooStiff:
            return True
        return False

    measured = bisect(ends, 0.8 * theory, 1.4 * theory, relative=0.5 if quick else 0.05)
    return [
        Limit(
            method=NAME, case="contact of a spring with one strongly damped mode", knob="c of the mode [1/s]",
            theory=theory, measured=measured, refused=ends(1.3 * measured),
            note=f"ContactTooStiff: more than {MOST_STEPS:.0e} steps of {step:.2f}/c (counted at c = "
            f"{counted:.0e}) in the {1e3 * lasts:.2g} ms of contact; flights have no such limit",
        )
    ]  # fmt: skip


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Errors of flows and collisions; nothing in them depends on the scene."""
    ways: dict[str, Flow] = {"package": package_flow, "eig": by_eigenvectors, "expm": by_pade}
    distances = DISTANCES[::3] if quick else DISTANCES
    ratios = RATIOS[::3] if quick else RATIOS
    arrays: dict[str, np.ndarray] = {"distance": np.array(distances), "ratio": np.array(ratios)}
    for name, way in ways.items():
        arrays[f"near_{name}"] = np.array(
            [flow_error(way, OMEGA, 2.0 * OMEGA * (1.0 + d)) for d in distances]
        )
        arrays[f"ratio_{name}"] = np.array([flow_error(way, OMEGA, 2.0 * OMEGA * z) for z in ratios])

    def loses(d: float) -> bool:
        few = TIMES[::3]
        starts = [OMEGA * (1.0 + 0.013 * j) for j in range(4)]
        return max(flow_error(by_eigenvectors, w, 2.0 * w * (1.0 + d), few) for w in starts) > LOST

    largest = {name: float(values.max()) for name, values in arrays.items()}
    limits = [
        Limit(
            method=name, case="flow of one mode near critical damping", knob="zeta - 1 [1]", theory=None,
            measured=None, refused=None,
            note=f"no loss from 0 to 1e-2: largest error {largest['near_package']:.1e} against 60 digits",
        )
        for name in ("event-driven", NAME)
    ]  # fmt: skip
    limits += [
        Limit(
            method="scipy.linalg.eig", case=f"flow of one mode near critical damping, error {LOST:g}",
            knob="zeta - 1 [1]", theory=2.0 * (EPS / LOST) ** 2,
            measured=bisect(loses, 1e-3, 1e-12, relative=0.05), refused=None,
            note="theory (a) from the condition of the eigenvectors, good to its order of magnitude; largest "
            f"error down to zeta = 1: {largest['near_eig']:.1e}",
        ),
        Limit(
            method="event-driven", case="flow of one mode, damping ratio 1e-15 to 1e6", knob="zeta [1]",
            theory=None, measured=None, refused=None,
            note=f"largest error {largest['ratio_package']:.1e}; through eigenvectors "
            f"{largest['ratio_eig']:.1e}, by scipy.linalg.expm {largest['ratio_expm']:.1e}",
        ),
    ]  # fmt: skip
    odd = cases()
    chosen = {k: m for i, (k, m) in enumerate(odd.items()) if not quick or i % 4 == 0}
    errors = {name: error_of_collision(collide(model, STIFFNESS)) for name, model in chosen.items()}
    worst = max(errors, key=lambda name: errors[name])
    limits.append(
        Limit(
            method=NAME, case=f"one collision, {len(errors)} springs with an odd mode", knob="error [1]",
            theory=None, measured=None, refused=None,
            note=f"largest error {errors[worst]:.1e} ({worst}); stated {Exact.accuracy:g}",
        )
    )  # fmt: skip
    limits += overdamped(quick)
    arrays |= {"collision": np.array(list(errors)), "collision_error": np.array(list(errors.values()))}
    return Findings(limits=limits, arrays=arrays)


def draw(findings: Findings, record: Any) -> None:
    """Errors near critical damping, over the damping, and of collisions."""
    record.write_figure(draw_odd(findings.arrays), "odd_modes")
