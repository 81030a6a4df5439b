r"""Limits of central difference: in flight, in contact, with lagged damping, under Hertz's law.

With y_n ~ z^n and a unit vector x, the step of M = 1, K, C obeys for centred damping

    (z - 1)^2 + (h c/2)(z^2 - 1) + h^2 kappa z = 0,      c = x*Cx,  kappa = x*Kx,

and for lagged damping (z - 1)^2 + h c (z - 1) + h^2 kappa z = 0. All roots lie in the unit disc if and only
if h^2 K <= 4 (centred) and h^2 K + 2 h C <= 4 (lagged), as matrices: sufficient by Schur's conditions on the
quadratics, necessary because the determinant changes sign between z = -1 and z = -infinity. So

    centred                  h omega_max = 2, omega_max^2 the largest eigenvalue of K + k phi phi^T
    lagged, one mode         h omega = 2 (sqrt(1 + zeta^2) - zeta)
    lagged, modal damping    1/k = sum_k phi_k^2 / (4/h^2 - 2 c_k/h - omega_k^2)                           (a)

(a) is sharp, and the package refuses by it. Under Hertz's law the tangent 3/2 k d^(1/2) takes the place of
k. A free mass m that arrives with v reaches d = (5 m v^2/(4k))^(2/5), so that the step h bears speeds up to
the v with 3/2 k d^(1/2) = 4 m/h^2.

Units: SI. Source of the limits for a single mode: T. Belytschko, Computational Methods for Transient
Analysis (1983), ch. 1; (a) is derived here.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from beam import ModalModel
from contact.errors import StepTooLarge
from contact.integrators import CentralDifference
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.oscillators import hertz_of
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.explicit_figures import draw_contacts, draw_limits
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.pressed_contact import (
    STEPS,
    combined_frequency,
    disturbed,
    grows,
    growth_rate,
    pressed,
    pressed_hertz,
)
from studies.instruments.stability.short_contacts import MASS, NAME, collisions, free_body

__all__ = ["draw", "lagged_stiffness", "measure"]

RATIOS = (0.0, 0.01, 0.1, 0.3, 1.0, 3.0)
"""Damping ratios of the single mode with lagged damping [1]."""
SHARE = 0.01
"""How far beyond and within a limit the refusal is tried, relative."""


def lagged_stiffness(model: ModalModel, step: float) -> float:
    """Contact stiffness at which the largest eigenvalue of h^2 (K + k phi phi^T) + 2 h C is 4 [N/m].

    By bisection on the eigenvalues: a second route to the closed form (a).
    """
    fixed = np.diag(step**2 * model.omega**2 + 2.0 * step * model.decay_rate)
    push = step**2 * np.outer(model.phi, model.phi)

    def beyond(k: float) -> bool:
        return bool(np.linalg.eigvalsh(fixed + k * push)[-1] > 4.0)

    if beyond(0.0):
        raise ValueError(f"step is {step} s; a mode is beyond the limit in flight")
    high = 1.0
    while not beyond(high):
        high *= 2.0
    return bisect(beyond, 0.5 * high, high, relative=1e-13)


def one_mode(omega: float, ratio: float) -> ModalModel:
    one = np.ones(1)
    return ModalModel(omega=omega * one, decay_rate=2 * ratio * omega * one, phi=one, participation=one)


def refused(oscillator: ImpactOscillator, state: State, method: CentralDifference, duration: float) -> bool:
    """Whether the method says that its step is too large."""
    try:
        simulate(oscillator, state, duration=duration, method=method)
    except StepTooLarge:
        return True
    return False


def _one_sided(row: dict[str, Any], within: bool, beyond: bool) -> Limit:
    """The row with what was refused on both sides of the limit."""
    sides = f"default step check: {'refused' if within else 'accepted'} {SHARE:.0%} within, "
    sides += f"{'StepTooLarge' if beyond else 'accepted'} {SHARE:.0%} beyond"
    note = f"{row.pop('note')}; {sides}"
    return Limit(method=NAME, refused=beyond, note=note, **row)


def flights(quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """One mode without contact: centred and lagged damping."""
    limits: list[Limit] = []
    measured: dict[bool, list[float]] = {True: [], False: []}
    ratios, many = (RATIOS[::2], STEPS) if quick else (RATIOS, 3 * STEPS)
    for lagged in (False, True):
        for ratio in ratios:
            oscillator = ImpactOscillator(
                model=one_mode(1.0, ratio), stop=Stop(gap=1e3, law=LinearContact(stiffness=1e-12)),
                load=np.ones(1),
            )  # fmt: skip
            rest = np.ones(1)

            def fails(h: float, o: Any = oscillator, r: Any = rest, lag: bool = lagged) -> bool:
                return grows(o, r, CentralDifference(step=h, lagged=lag, beyond_limit=True), h, many)

            theory = 2.0 * (math.sqrt(1.0 + ratio**2) - ratio) if lagged else 2.0
            found = bisect(fails, 0.2 * theory, 2.0 * theory, relative=1e-8)
            measured[lagged].append(found)
            sides = [
                refused(
                    oscillator, disturbed(rest), CentralDifference(step=x * theory, lagged=lagged),
                    40 * theory,
                )
                for x in (1 - SHARE, 1 + SHARE)
            ]
            limits.append(
                _one_sided(
                    {
                        "case": f"one mode in flight, {'lagged' if lagged else 'centred'} damping, "
                        f"zeta = {ratio:g}",
                        "knob": "h omega [1]", "theory": theory, "measured": found,
                        "note": f"bisected on the growth of a disturbance over {many} steps",
                    },
                    *sides,
                )
            )  # fmt: skip
    arrays = {
        "ratio": np.array(ratios),
        "lagged": np.array(measured[True]),
        "centred": np.array(measured[False]),
    }
    return limits, arrays


def contacts(model: ModalModel, counts: tuple[int, ...]) -> list[Limit]:
    """The pressed contact of the scene's modes: centred damping by the step, lagged by the stiffness."""
    limits = []
    for n in counts:
        kept = model.truncated(n)
        stiffness = 1e3 * kept.omega[0] ** 2 / kept.phi[0] ** 2
        oscillator, rest = pressed(kept, stiffness)
        highest = combined_frequency(kept, stiffness)

        def fails(x: float, o: Any = oscillator, r: Any = rest, w: float = highest) -> bool:
            return grows(o, r, CentralDifference(step=x / w, beyond_limit=True), x / w)

        found = bisect(fails, 1.0, 3.0, relative=1e-9)
        sides = [
            refused(oscillator, disturbed(rest), CentralDifference(step=x / highest), 40 / highest)
            for x in (2 - 2 * SHARE, 2 + 2 * SHARE)
        ]
        modes = f"{n} mode{'s' if n > 1 else ''}"
        limits.append(
            _one_sided(
                {
                    "case": f"{modes} in lasting contact, centred modal damping, k = 1e3 k_modal",
                    "knob": "h omega_max [1]", "theory": 2.0, "measured": found,
                    "note": "omega_max from the eigenvalues of K + k phi phi^T",
                },
                *sides,
            )
        )  # fmt: skip
    for factor in (1.0, 10.0):
        kept = model.truncated(counts[-1])
        kept = replace(kept, decay_rate=factor * kept.decay_rate)
        step = 1.0 / float(kept.omega[-1])
        theory = lagged_stiffness(kept, step)

        def breaks(k: float, m: ModalModel = kept, h: float = step) -> bool:
            oscillator, rest = pressed(m, k)
            return grows(oscillator, rest, CentralDifference(step=h, lagged=True, beyond_limit=True), h)

        def turned_away(k: float, m: ModalModel = kept, h: float = step) -> bool:
            oscillator, rest = pressed(m, k)
            return refused(oscillator, disturbed(rest), CentralDifference(step=h, lagged=True), 40 * h)

        found = bisect(breaks, 0.2 * theory, 5.0 * theory, relative=1e-8)
        bound = bisect(turned_away, 0.1 * theory, 5.0 * theory, relative=1e-8)
        limits.append(
            Limit(
                method=NAME,
                case=f"{counts[-1]} modes in lasting contact, lagged damping, damping x {factor:g}, "
                "h omega_N = 1",
                knob="contact stiffness [N/m]", theory=theory, measured=found,
                refused=turned_away(1.0001 * found),
                note=f"theory is the sharp limit (a), from the eigenvalues; StepTooLarge from {bound:.6g} "
                f"N/m on, {abs(bound / theory - 1):.0e} from it",
            )
        )  # fmt: skip
    return limits


def hertz_limits(scene: Scene, model: ModalModel, quick: bool) -> list[Limit]:
    """Hertz's tangent: pressed to a depth, and met in the course of a collision."""
    hertz = hertz_of(scene)
    step = 1.0 / float(model.omega[-1])
    method = CentralDifference(step=step)
    stopped = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=hertz))
    critical = method.critical_stiffness(stopped.motion())
    depth = (critical / (1.5 * hertz.stiffness)) ** 2

    def fails(d: float) -> bool:
        oscillator, rest, _force = pressed_hertz(model, hertz.stiffness, d)
        return grows(oscillator, rest, CentralDifference(step=step, beyond_limit=True), step)

    found = bisect(fails, 0.2 * depth, 5.0 * depth, relative=1e-8)

    def turned_away(d: float) -> bool:
        oscillator, rest, _force = pressed_hertz(model, hertz.stiffness, d)
        return refused(oscillator, disturbed(rest), method, 40 * step)

    limits = [
        _one_sided(
            {
                "case": f"{model.n_modes} modes pressed into a Hertz contact, h omega_N = 1",
                "knob": "depth [m]", "theory": depth, "measured": found,
                "note": "3/2 k d^(1/2) equals the stiffness at which h omega_max = 2",
            },
            turned_away((1 - SHARE) * depth), turned_away((1 + SHARE) * depth),
        )
    ]  # fmt: skip
    # a free body: refused in the course of the contact, at a grid point that depends on the phase
    oscillator = ImpactOscillator(model=free_body(), stop=Stop(gap=1e-3, law=hertz))
    speed = 0.2
    deepest = hertz.greatest_approach(MASS, speed)
    step = math.sqrt(4.0 * MASS / (1.5 * hertz.stiffness * math.sqrt(deepest)))

    def met(v: float, part: float) -> bool:
        start = State(
            displacement=np.array([1e-3 - (2.0 + part) * step * v]) * math.sqrt(MASS),
            velocity=np.array([v]) * math.sqrt(MASS),
        )
        return refused(oscillator, start, CentralDifference(step=step), 20 * step)

    parts = np.linspace(0.0, 1.0, 5 if quick else 17)[:-1] + 0.01
    found_at = np.array([bisect(partial(met, part=float(s)), 0.2 * speed, 5.0 * speed) for s in parts])
    limits.append(
        Limit(
            method=NAME, case="free body meets a Hertz contact, tangent grows during the contact",
            knob="approach speed [m/s]", theory=None, measured=float(found_at.min()),
            refused=all(met(1.01 * v, float(s)) for v, s in zip(found_at, parts, strict=True)),
            note=f"StepTooLarge in the course of the contact, by the phase of the grid from "
            f"{found_at.min():.4g} to {found_at.max():.4g} m/s; a motion that were followed well would reach "
            f"the limit at {speed:g} m/s, but there the contact takes "
            f"{hertz.contact_time(MASS, speed) / step:.2f} steps",
        )
    )  # fmt: skip
    return limits


def plane(model: ModalModel, quick: bool) -> dict[str, np.ndarray]:
    """Growth per step over the plane of stiffness and step, and where theory puts the limit."""
    modal = model.omega[0] ** 2 / model.phi[0] ** 2
    steps = np.linspace(0.05, 2.2, 12 if quick else 36)
    stiffness = np.geomspace(1e-1, 1e7, 12 if quick else 36)
    count = 2000
    rate = np.empty((steps.size, stiffness.size))
    for j, k in enumerate(stiffness):
        oscillator, rest = pressed(model, k * modal)
        for i, x in enumerate(steps):
            h = x / float(model.omega[-1])
            method = CentralDifference(step=h, beyond_limit=True)
            rate[i, j] = growth_rate(oscillator, rest, method, h, count) / count
    fine = np.geomspace(1e-1, 1e7, 200)
    limit = np.array([2.0 * model.omega[-1] / combined_frequency(model, k * modal) for k in fine])
    return {
        "plane_step": steps, "plane_stiffness": stiffness, "plane_rate": rate, "limit_stiffness": fine,
        "limit_step": limit,
    }  # fmt: skip


def measure(*, quick: bool, scene: Scene) -> Findings:
    """All limits of central difference on the scene's modes and contact."""
    model = model_of(scene)
    counts = tuple(sorted({min(n, model.n_modes) for n in ((1, 5) if quick else (1, 2, 5, 15))}))
    few = model.truncated(min(5, model.n_modes))
    free, curve = flights(quick)
    short, energies = collisions(scene, quick)
    limits = [*free, *contacts(model, counts), *hertz_limits(scene, few, quick), *short]
    return Findings(limits=limits, arrays={**curve, **energies, **plane(few, quick)})


def draw(findings: Findings, record: Any) -> None:
    """The limits over damping and over the plane of step and stiffness; the energy of one contact."""
    record.write_figure(draw_limits(findings.arrays), "explicit_limits")
    record.write_figure(draw_contacts(findings.arrays), "explicit_contact")
