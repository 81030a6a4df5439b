"""Limits of the generalised-alpha family in flight and in a lasting contact: theory and bisection.

Theory is ``contact.integrators.generalised_alpha``: for Newmark's method h omega = (gamma/2 - beta)^(-1/2),
without limit if 2 beta >= gamma >= 1/2; in a lasting linear contact omega is the highest frequency of K + k
phi phi^T.  Measured with the method itself: the step, or the stiffness of the contact, at which a disturbance
of a loaded spring grows 1e5-fold (``pressed_contact``).  With gamma > 1/2 the amplification leaves the unit
circle in proportion to the excess over the limit, and n steps see an excess of some 10/n.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from beam import ModalModel
from contact.errors import StepTooLarge
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.findings import Limit
from studies.instruments.stability.pressed_contact import grows, pressed

__all__ = ["flight_limits", "pressed_limits"]

FORMS = (
    ("newmark beta 0, gamma 1/2", GeneralisedAlpha.newmark(step=1.0, beta=0.0)),
    ("newmark beta 1/12, gamma 1/2", GeneralisedAlpha.newmark(step=1.0, beta=1 / 12)),
    ("newmark beta 1/6, gamma 1/2", GeneralisedAlpha.newmark(step=1.0, beta=1 / 6)),
    ("newmark beta 0.2, gamma 1/2", GeneralisedAlpha.newmark(step=1.0, beta=0.2)),
    ("newmark beta 0, gamma 0.6", GeneralisedAlpha.newmark(step=1.0, beta=0.0, gamma=0.6)),
    ("newmark beta 0.2, gamma 0.8", GeneralisedAlpha.newmark(step=1.0, beta=0.2, gamma=0.8)),
    ("alpha_f 0.2, beta 0.22, gamma 0.7", GeneralisedAlpha(step=1.0, beta=0.22, gamma=0.7, alpha_f=0.2)),
    ("alpha_m -0.5, beta 1/4, gamma 1", GeneralisedAlpha(step=1.0, beta=0.25, gamma=1.0, alpha_m=-0.5)),
    ("newmark beta 1/4, gamma 1/2", GeneralisedAlpha.newmark(step=1.0)),
    ("hht alpha 0.3", GeneralisedAlpha.hht(step=1.0, alpha=0.3)),
    ("rho 0.5", GeneralisedAlpha.with_dissipation(step=1.0, rho=0.5)),
)

SHORT = 500
"""Steps in which an unconditionally stable method must not let a mode grow 1e5-fold."""


def _refuses(spring: ImpactOscillator, start: State, method: GeneralisedAlpha) -> bool:
    """Whether the method refuses before its first step."""
    try:
        simulate(spring, start, duration=method.step, method=method)
    except StepTooLarge:
        return True
    return False


def flight_limits(quick: bool) -> list[Limit]:
    """h omega at which one mode starts to grow: theory and bisection."""
    model = ModalModel(omega=np.ones(1), decay_rate=np.zeros(1), phi=np.ones(1), participation=np.ones(1))
    far = Stop(gap=1e11, law=LinearContact(stiffness=1.0))
    spring, rest = ImpactOscillator(model=model, stop=far, load=np.ones(1)), np.ones(1)
    steps, rows = (20_000 if quick else 100_000), []
    for words, form in FORMS:
        theory = form.stability_limit()

        def fails(size: float, form: GeneralisedAlpha = form, steps: int = steps) -> bool:
            return grows(spring, rest, replace(form, step=size, beyond_limit=True), size, steps)

        measured, refused = None, None
        if math.isinf(theory):
            tried = [size for size in np.geomspace(0.1, 1e4, 11) if fails(float(size), steps=SHORT)]
            measured = float(min(tried)) if tried else None
            note = f"eleven h omega from 0.1 to 1e4, {SHORT} steps each: " + (
                "growth" if tried else "no growth, as theory has it"
            )
        else:
            measured = bisect(fails, 0.5 * theory, 2.0 * theory, relative=1e-6)
            refused = _refuses(spring, State.rest(1), replace(form, step=1.001 * theory))
            note = f"growth by 1e5 within {steps} steps; StepTooLarge before the first step"
        rows.append(Limit(
            method="generalised-alpha", case=f"flight, {words}", knob="h omega_max [1]",
            theory=None if math.isinf(theory) else theory, measured=measured, refused=refused, note=note,
        ))  # fmt: skip
    return rows


def pressed_limits(model: ModalModel, quick: bool) -> list[Limit]:
    """Stiffness of a lasting contact at which the beam starts to grow, with h omega_max = 1."""
    steps, rows = (5_000 if quick else 50_000), []
    step = 1.0 / float(model.omega.max())
    for words, form in FORMS[:5:2]:
        method = replace(form, step=step, beyond_limit=True)

        def fails(stiffness: float, method: GeneralisedAlpha = method) -> bool:
            return grows(*pressed(model, stiffness), method, step, steps)

        theory = method.critical_stiffness(pressed(model, 1.0)[0].motion())
        spring, rest = pressed(model, 1.001 * theory)
        start = State(displacement=rest, velocity=np.zeros(rest.size))
        rows.append(Limit(
            method="generalised-alpha", case=f"lasting contact, h omega_max 1, {words}",
            knob="contact stiffness [N/m]", theory=theory,
            measured=bisect(fails, 0.5 * theory, 2.0 * theory, relative=1e-6),
            refused=_refuses(spring, start, replace(method, beyond_limit=False)),
            note=f"growth by 1e5 within {steps} steps; StepTooLarge before the first step",
        ))  # fmt: skip
    return rows
