"""Implicit methods on a stop that is met and left: stable by linear theory, and what the energy does.

In flight and in a contact that lasts, the methods tried here have no limit by linear theory (J. Chung, G. M.
Hulbert, J. Appl. Mech. 60 (1993) 371).

1. One contact of a free mass m with a linear stop k by the trapezoidal rule (beta = 1/4, gamma = 1/2), which
   keeps the energy as long as the contact is closed. The step in which it opens, from penetration d to -d',
   gains k d d'/2, the step in which it closes loses as much; with d + d' = h v and the places u, u' of touch
   and release in their steps evenly distributed, (h w)^2 [u'(1-u') - u(1-u)] of the energy, w^2 = k/m, has
   the mean 0 and

       rms = (h w)^2 / sqrt(90)                                                                           (A)

   for a contact of many steps. For h w -> infinity the force puts the tip on the stop at the end of a step:
   it leaves at speed (3 - 4u) v if u < 2/3 and (8u - 5) v if u > 2/3, anything from v/3 to 3 v, and

       mean of ln(energy after/before) = (3/4) [x ln x - x] from 1/3 to 3 = (5/2) ln 3 - 2 = 0.7465       (B)

   so that the energy grows e-fold in less than two contacts, whatever the step.

2. The schemes made for impacts keep or lose energy by theorem (``contact.integrators.moreau_jean``; V. Acary,
   Z. Angew. Math. Mech. 96 (2016) 585): many impacts of an undamped beam under Newton's law with e = 1,
   struck at its tip, gap 0. There theta <= 1/(1 + e) is sufficient for an impact to gain nothing; theta = 1
   lies outside. E = sum (v^2 + omega^2 q^2)/2 is taken at grid points.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from beam import ModalModel
from contact import (
    ImpactOscillator,
    LinearContact,
    NewtonRestitution,
    State,
    Stop,
    simulate,
)
from contact.integrators import GeneralisedAlpha, Integrator, MoreauJean, NonsmoothGeneralisedAlpha
from studies import plotting
from studies.scene import Scene, model_of
from studies.stability import Findings, Limit

__all__ = ["draw", "evenly", "history", "kept", "measure", "single_contact", "stiff_contacts", "undamped"]

MODES = 5
"""Modes of the beam: the spread of frequencies matters here, not their number."""

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

IMPACT: Mapping[str, Maker] = {
    "Moreau-Jean 1/2": lambda h: MoreauJean(step=h),
    "nonsmooth 1": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=1.0),
    "nonsmooth 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
    "Moreau-Jean 1": lambda h: MoreauJean(step=h, theta=1.0),
}
"""Methods for Newton's law; the number is theta or rho. The first and the second keep the energy."""

Row = partial(Limit, family="implicit_energy", method=GeneralisedAlpha.name)


# one contact of a free mass


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


# many impacts of a beam


def undamped(model: ModalModel) -> ModalModel:
    """The model without its damping."""
    return replace(model, decay_rate=0.0 * model.decay_rate)


def history(model: ModalModel, make: Maker, size: float, contacts: int) -> np.ndarray:
    """Impacts begun, and the logarithm of energy over that at the start, at grid points as columns; about
    `contacts` impacts, two in each period of the first mode, with h omega_max = `size`."""
    h, compliance = size / float(model.omega.max()), float(model.phi @ model.phi)
    elastic = Stop(gap=0.0, law=NewtonRestitution(local_restitution=1.0))
    beam = ImpactOscillator(model=model, stop=elastic)
    start = State(displacement=np.zeros(model.omega.size), velocity=-SCALE / compliance * model.phi)
    steps = max(2, math.ceil(contacts * math.pi / float(model.omega.min()) / h))
    every = np.unique(np.round(np.geomspace(1, steps, 400))).astype(int)
    run = simulate(beam, start, duration=steps * h, times=every * h, method=make(h))
    energy = beam.energy(run.displacement / SCALE, run.velocity / SCALE)
    begun = np.searchsorted(run.impacts.start, every * h, side="right")
    with np.errstate(divide="ignore"):  # it may be lost altogether
        return np.array([begun.astype(float), np.log(2.0 * compliance * energy)])


def kept(label: str, model: ModalModel, contacts: int) -> Limit:
    """Energy of the beam over many elastic impacts, largest of three steps: kept, or at least not raised."""
    keeps = label in ("Moreau-Jean 1/2", "nonsmooth 1")
    logs = [history(model, IMPACT[label], size, contacts)[1] for size in (0.1, 1.0, 10.0)]
    return Limit(
        family="implicit_energy", method=IMPACT[label](1.0).name, theory=0.0,
        case=f"{label}, beam, e = 1, h omega_max 0.1, 1 and 10, {contacts} impacts",
        parameter="largest |E/E_0 - 1| [1]" if keeps else "largest ln(E/E_0), at most theory [1]",
        measured=max(float((np.abs(np.expm1(log)) if keeps else log).max()) for log in logs),
    )  # fmt: skip


def measure(scene: Scene, quick: bool) -> Findings:
    """Limits, single contacts, and the energy of the beam over many."""
    model = undamped(model_of(scene.replace({"modes.count": MODES})))
    few, contacts = (60, 300) if quick else (300, 10_000)
    sizes = np.geomspace(0.1, 1e3, 9 if quick else 25)
    arrays = {"single_h_w": sizes}
    arrays |= {
        f"single_{label}": np.array([mean_growth(make, float(size), few) for size in sizes])
        for label, make in FORCE.items()
    }
    limits = [
        *stiff_contacts(300 if quick else 4000),
        *(kept(label, model, contacts) for label in IMPACT),
    ]
    for label, make in IMPACT.items():
        for size in (0.1, 1.0):
            arrays[f"history_{label}, {size:g}"] = history(model, make, size, contacts)
    return Findings(limits=limits, arrays=arrays)


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Growth in one contact against its resolution; energy against the number of impacts."""
    figure, (left, right) = plotting.new_figure(1, 2, width=plotting.PAGE, height=0.080)
    for number, label in enumerate(FORCE):
        left.plot(arrays["single_h_w"], arrays[f"single_{label}"], **plotting.series(number), markevery=3,
                  label=label)  # fmt: skip
    left.axhline(STIFF_GROWTH, color="0.5", linewidth=0.8, linestyle=":")
    left.text(0.1, STIFF_GROWTH + 0.02, "(5/2) ln 3 - 2", fontsize=plotting.NOTE)
    plotting.label(left.xaxis, "step × contact frequency, h ω")
    plotting.label(left.yaxis, "mean of ln(energy after/before)")
    plotting.panel(left, 0, "one contact of a free mass")
    for number, label in enumerate(IMPACT):
        style = plotting.series(number)
        for size, line, face in ((0.1, "-", style["color"]), (1.0, "--", "white")):
            impacts, log_energy = arrays[f"history_{label}, {size:g}"]
            right.plot(impacts, log_energy / math.log(10.0), color=style["color"], linestyle=line,
                       marker=style["marker"], markevery=40, markerfacecolor=face,
                       label=label if size < 1.0 else None)  # fmt: skip
    right.set_ylim(-30.0, 2.0)
    plotting.label(right.xaxis, "impacts")
    plotting.label(right.yaxis, "log$_{10}$ of energy / energy at the start")
    plotting.panel(right, 1, "beam, Newton's law, e = 1")
    for axis in (left, right):
        axis.axhline(0.0, **plotting.GUIDE)
        axis.set_xscale("log")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2)
    return figure, (
        "Implicit methods. (a) Mean growth of energy in one contact of a free mass against the step; (b) "
        "energy of an undamped beam over many impacts, solid and filled h omega_max = 0.1, dashed and open 1."
    )
