"""Implicit methods on a stop that is met and left: stable by linear theory, and what the energy does.

In flight and in a contact that lasts, the methods tried here have no limit by linear theory (J. Chung, G. M.
Hulbert, J. Appl. Mech. 60 (1993) 371).

One contact of a free mass m with a linear stop k by the trapezoidal rule (beta = 1/4, gamma = 1/2), which
keeps the energy as long as the contact is closed. The step in which it opens, from penetration d to -d',
gains k d d'/2, the step in which it closes loses as much; with d + d' = h v and the places u, u' of touch
and release in their steps evenly distributed, (h w)^2 [u'(1-u') - u(1-u)] of the energy, w^2 = k/m, has
the mean 0 and

    rms = (h w)^2 / sqrt(90)                                                                           (A)

for a contact of many steps. For h w -> infinity the force puts the tip on the stop at the end of a step:
it leaves at speed (3 - 4u) v if u < 2/3 and (8u - 5) v if u > 2/3, anything from v/3 to 3 v, and

    mean of ln(energy after/before) = (3/4) [x ln x - x] from 1/3 to 3 = (5/2) ln 3 - 2 = 0.7465       (B)

so that the energy grows e-fold in less than two contacts, whatever the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from beam import ModalModel
from contact import ImpactOscillator, LinearContact, State, Stop, simulate
from contact.integrators import GeneralisedAlpha, Integrator
from studies import plotting
from studies.scene import Scene
from studies.stability import Findings, Limit

__all__ = ["draw", "evenly", "measure", "single_contact", "stiff_contacts"]

SCALE = 2.0**-10
"""Speed of the free mass [m/s], a power of two, so that the scaled motion rounds alike and the stop lies
within a metre."""

STIFF, STIFF_GROWTH = 1e4, 2.5 * math.log(3.0) - 2.0
"""h w of a contact that counts as infinitely stiff, (B) being met to 1/(h w); equation (B)."""

Maker = Callable[[float], Integrator]
"""A method for a step [s]."""

FORCE: Mapping[str, Maker] = {
    "trapezoidal": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "generalised-alpha 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "generalised-alpha 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
"""Methods that take the stop as a spring; the number is alpha or rho."""

Row = partial(Limit, family="implicit_energy", method=GeneralisedAlpha.name)


def single_contact(make: Maker, stiffness: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Energy after over energy before one contact of a free mass of 1 kg, step 1 s, for pairs of
    (h w)^2 and place u of the touch in its step."""
    one = np.ones(1)
    model = ModalModel(omega=0.0 * one, decay_rate=0.0 * one, phi=one, participation=one)
    start = State(displacement=0.0 * one, velocity=SCALE * one)
    left = []
    for k, u in zip(stiffness, places, strict=True):
        stop = Stop(gap=SCALE * (2.0 + float(u)), law=LinearContact(stiffness=float(k)))
        mass = ImpactOscillator(model=model, stop=stop)
        duration = 10.0 + math.ceil(1.5 * math.pi / math.sqrt(k))
        end = simulate(mass, start, duration=duration, method=make(1.0)).end
        left.append((float(end.velocity[0]) / SCALE) ** 2)
    return np.array(left)


def evenly(product: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """`count` pairs for `single_contact` around h w = `product`: touch and release spread evenly over their
    steps, the release by contact times pi/w that spread over one step, or a third of themselves if less."""
    index = np.arange(count)
    place = (index * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0 - 0.5
    steps = math.pi / product + place * min(1.0, math.pi / (3.0 * product))
    return (math.pi / steps) ** 2, (index + 0.5) / count


def mean_growth(make: Maker, product: float, count: int) -> float:
    """Mean of ln(energy after/before) over contacts of a free mass around h w = `product`."""
    return float(np.mean(np.log(single_contact(make, *evenly(product, count)))))


def stiff_contacts(count: int) -> list[Limit]:
    """One contact of a free mass by the trapezoidal rule against (A) and (B)."""
    places, case = (np.arange(count) + 0.5) / count, "trapezoidal, one contact of a free mass"
    stiff = single_contact(FORCE["trapezoidal"], np.full(count, STIFF**2), places)
    resolved = single_contact(FORCE["trapezoidal"], *evenly(0.05, count)) - 1.0
    return [
        Row(case=f"{case}, h w = {STIFF:g}", parameter="mean of ln(energy after/before) [1]",
            theory=STIFF_GROWTH, measured=float(np.mean(np.log(stiff))), refused=False),
        Row(case=f"{case}, h w = {STIFF:g}", parameter="largest energy after/before [1]", theory=9.0,
            measured=float(stiff.max()), refused=False),
        Row(case=f"{case}, h w = 0.05", parameter="rms of energy after/before - 1 [1]",
            theory=0.05**2 / math.sqrt(90.0), measured=float(np.sqrt(np.mean(resolved**2))), refused=False),
    ]  # fmt: skip


def measure(scene: Scene, quick: bool) -> Findings:
    """Single contacts; nothing depends on the scene."""
    sizes = np.geomspace(0.1, 1e3, 9 if quick else 25)
    arrays = {"single_h_w": sizes}
    arrays |= {
        f"single_{label}": np.array([mean_growth(make, float(size), 60 if quick else 300) for size in sizes])
        for label, make in FORCE.items()
    }
    return Findings(limits=stiff_contacts(300 if quick else 4000), arrays=arrays)


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Growth in one contact against its resolution."""
    figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.070)
    for number, label in enumerate(FORCE):
        axes.plot(arrays["single_h_w"], arrays[f"single_{label}"], **plotting.series(number), markevery=3,
                  label=label)  # fmt: skip
    axes.axhline(STIFF_GROWTH, color="0.5", linewidth=0.8, linestyle=":")
    axes.text(0.1, STIFF_GROWTH + 0.02, "(5/2) ln 3 - 2", fontsize=plotting.NOTE)
    axes.axhline(0.0, **plotting.GUIDE)
    axes.set_xscale("log")
    plotting.label(axes.xaxis, "step × contact frequency, h ω")
    plotting.label(axes.yaxis, "mean of ln(energy after/before)")
    figure.legend(loc="outside lower center", ncols=2)
    return figure, "Implicit methods: mean growth of energy in one contact of a free mass against the step."
