r"""Phase and amplitude of a free mode under the methods with a fixed step.

In flight such a method multiplies a mode by the principal root z of its characteristic polynomial in every
step, x = h omega:

    phase error per radian   arg(z)/x - 1,        growth per radian   ln|z|/x

with, per mode and without damping,

    central difference       z^2 - (2 - x^2) z + 1 = 0                      phase error  +x^2/24
    Newmark, beta = 1/4      (and Moreau-Jean, theta = 1/2)                 phase error  -x^2/12
    generalised-alpha        (z - 1)^2 (am + (1 - am) z)
                             + x^2 (af + (1 - af) z)(b z^2 + (1/2 + g - 2 b) z + 1/2 - g + b) = 0

(J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371, for the last) and splitting, whose flights are exact,
0. Measured: the rate s in q = Re(A exp(s omega t)), from amplitudes fitted over one period at the beginning
and at the end of a run; s = i would be exact.  Units: SI.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from beam import ModalModel
from contact.integrators import CentralDifference, Integrator
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.integrators.splitting import Splitting
from contact.laws import NEWTON, ContactLaw, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.stability.findings import Limit

__all__ = ["OMEGA", "drift", "drifts", "methods", "one_mode"]

OMEGA = 2.0 * math.pi * 24.5
STEPS = (0.05, 0.1, 0.2, 0.4, 0.8)
"""h omega of the runs [1]."""
PASSES = 10
"""Of the fit: each uses the rate of the one before, so that in the end the model fits the samples exactly."""
QUOTED = 0.1
"""h omega of the rows of the table."""

Methods = dict[str, tuple[Callable[[float], Integrator], Callable[[float], complex]]]


def _alpha_root(x: float, am: float, af: float, beta: float, gamma: float) -> complex:
    """Principal root of the generalised-alpha method."""
    inertia = np.polymul([1.0, -2.0, 1.0], [1.0 - am, am])
    force = x * x * np.polymul([1.0 - af, af], [beta, 0.5 + gamma - 2.0 * beta, 0.5 - gamma + beta])
    return _principal(np.polyadd(inertia, force), x)


def _principal(polynomial: np.ndarray, x: float) -> complex:
    """The root nearest to exp(ix)."""
    roots = np.roots(polynomial)
    return complex(roots[np.argmin(np.abs(roots - np.exp(1j * x)))])


def _chung_hulbert(x: float, rho: float) -> complex:
    am, af = (2.0 * rho - 1.0) / (1.0 + rho), rho / (1.0 + rho)
    return _alpha_root(x, am, af, 0.25 * (1.0 - am + af) ** 2, 0.5 - am + af)


def methods() -> Methods:
    """What is run, and the root that theory gives it."""
    return {
        "central-difference": (
            lambda h: CentralDifference(step=h), lambda x: _principal(np.array([1.0, x * x - 2.0, 1.0]), x)
        ),
        "newmark 1/4, 1/2": (
            lambda h: GeneralisedAlpha.newmark(step=h), lambda x: _alpha_root(x, 0.0, 0.0, 0.25, 0.5)
        ),
        "hht 0.1": (
            lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
            lambda x: _alpha_root(x, 0.0, 0.1, 0.25 * 1.1**2, 0.6),
        ),
        "generalised-alpha 0.8": (
            lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8), lambda x: _chung_hulbert(x, 0.8)
        ),
        "moreau-jean 1/2": (
            lambda h: MoreauJean(step=h, theta=0.5), lambda x: _alpha_root(x, 0.0, 0.0, 0.25, 0.5)
        ),
        "nonsmooth-generalised-alpha 0.8": (
            lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8), lambda x: _chung_hulbert(x, 0.8)
        ),
        "splitting 2": (lambda h: Splitting(step=h, order=2), lambda x: complex(np.exp(1j * x))),
    }  # fmt: skip


def one_mode(law: ContactLaw, gap: float, omega: float = OMEGA, load: float = 0.0) -> ImpactOscillator:
    """An undamped mode of unit mass."""
    one = np.ones(1)
    return ImpactOscillator(
        model=ModalModel(omega=omega * one, decay_rate=0.0 * one, phi=one, participation=one),
        stop=Stop(gap=gap, law=law), load=load * one,
    )  # fmt: skip


def _far_stop(method: Integrator) -> ContactLaw:
    """A law that the method knows, for a stop that is never reached."""
    if method.accepts(NEWTON):
        return NewtonRestitution(local_restitution=0.5)
    return LinearContact(stiffness=1e-9)


def drift(make: Callable[[float], Integrator], x: float, turns: int) -> tuple[float, float]:
    """Phase error and growth per radian of a free mode over `turns` periods with h omega = `x`."""
    step = x / OMEGA
    method = make(step)
    window = max(8, math.ceil(2.0 * math.pi / x))
    total = math.ceil(turns * 2.0 * math.pi / x) + window
    grid = np.concatenate([np.arange(1, window + 1), np.arange(total - window + 1, total + 1)])
    oscillator = one_mode(_far_stop(method), 1e3)
    start = State(displacement=np.ones(1), velocity=np.zeros(1))
    run = simulate(oscillator, start, duration=total * step, times=grid * step, method=method)
    q = run.displacement[:, 0]
    angle = x * grid
    rate = 1j
    for _ in range(PASSES):
        amplitudes = []
        for part in (slice(0, window), slice(window, 2 * window)):
            turn = np.exp(rate * (angle[part] - angle[part][0]))
            a, b = np.linalg.lstsq(np.column_stack([turn.real, -turn.imag]), q[part], rcond=None)[0]
            amplitudes.append(complex(a, b))
        # what the second amplitude adds to the first, turned on at the rate assumed
        whole = x * (total - window)
        rate += np.log(amplitudes[1] / amplitudes[0] * np.exp(-rate * whole)) / whole
    return float(rate.imag - 1.0), float(rate.real)


def drifts(quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """All methods over the step."""
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"drift_step": np.array(STEPS)}
    for name, (make, root) in methods().items():
        found, theory = [], []
        for x in STEPS:
            turns = max(4, int(min(30.0 if quick else 200.0, 0.2 / (x * x))))
            found.append(drift(make, x, turns))
            z = root(x)
            theory.append((math.atan2(z.imag, z.real) / x - 1.0, math.log(abs(z)) / x))
        for i, part in enumerate(("phase", "growth")):
            arrays[f"{part}_{name}"] = np.array(found)[:, i]
            arrays[f"{part}_theory_{name}"] = np.array(theory)[:, i]
        i = STEPS.index(QUOTED)
        limits.append(
            Limit(
                method=name, case=f"free mode, h omega = {QUOTED:g}", knob="phase error per radian [1]",
                theory=theory[i][0], measured=found[i][0], refused=None,
                note=f"growth of the amplitude per radian {found[i][1]:.2e}, theory {theory[i][1]:.2e}; "
                f"after 1e6 periods {abs(theory[i][0]) * 1e6:.3g} periods off",
            )
        )  # fmt: skip
    return limits, arrays
