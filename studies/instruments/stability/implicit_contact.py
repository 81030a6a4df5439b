"""Implicit methods on a stop that is met and left: what linear theory calls stable, and what the energy does.

1. In flight and in a lasting linear contact: ``implicit_limits``.

2. One contact of a free mass m with a linear stop k by the trapezoidal rule (beta = 1/4, gamma = 1/2), which
   keeps the energy as long as the contact is closed.  The step in which it opens, from penetration d to -d',
   gains k d d'/2, the step in which it closes loses as much; with d + d' = h v and the places u, u' of the
   touch and the release in their steps evenly distributed, (h w)^2 [u'(1-u') - u(1-u)] of the energy, w^2 =
   k/m, has the mean 0 and

       rms = (h w)^2 / sqrt(90)                                                                       (A)

   for a contact of many steps.  For h w -> infinity the force puts the tip on the stop at the end of a step:
   it then leaves at speed (3 - 4u) v if u < 2/3 and (8u - 5) v if u > 2/3, anything from v/3 to 3 v, and

       mean of ln(energy after/before) = (3/4) [x ln x - x] from 1/3 to 3 = (5/2) ln 3 - 2 = 0.7465   (B)

   so that the energy grows e-fold in less than two contacts, whatever the step.

3. Many contacts of an undamped beam, struck at its tip (``contact_energy``): energy against contact number.

4. The schemes made for impacts keep or lose energy by theorem (``contact.integrators.moreau_jean``; V. Acary,
   Z. Angew. Math. Mech. 96 (2016) 585, whose reason for them is the blow-up of the others): the same beam
   under Newton's law with e = 1.  There theta <= 1/(1 + e) is sufficient for an impact to gain nothing.
"""

from __future__ import annotations

import math

import numpy as np

from beam import ModalModel
from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.laws import LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.scene import Scene
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.contact_energy import (
    History,
    Maker,
    conservative,
    evenly,
    history,
    modal_stiffness,
    rigid_contact,
    single_contact,
)
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.implicit_figures import draw
from studies.instruments.stability.implicit_limits import flight_limits, pressed_limits

__all__ = ["draw", "measure"]

MODES = 5
"""Modes of the beam: the spread of frequencies matters here, not their number."""

FORCE: dict[str, Maker] = {
    "trapezoidal": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "generalised-alpha 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "generalised-alpha 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
"""Methods that take the stop as a spring; the number is alpha or rho."""

IMPACT: dict[str, Maker] = {
    "Moreau-Jean 1/2": lambda h: MoreauJean(step=h),
    "nonsmooth 1": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=1.0),
    "nonsmooth 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
    "Moreau-Jean 1": lambda h: MoreauJean(step=h, theta=1.0),
}
"""Methods for Newton's law; the number is theta or rho."""

RATIOS = (1.0, 1e2, 1e4)
"""k/k_modal."""

GAIN = 0.01
"""Mean growth of ln(energy) per contact that counts: with fewer than a thousand contacts the scatter of (A)
leaves a mean of less than this in doubt."""

STIFF = 1e4
"""h w of a contact that counts as infinitely stiff: (B) is met to (h w)^-1."""

STIFF_GROWTH = 2.5 * math.log(3.0) - 2.0
"""Equation (B)."""


def _mean_growth(make: Maker, product: float, count: int) -> float:
    """Mean of ln(energy after/before) over contacts of a free mass around h w = `product`."""
    return float(np.mean(np.log(single_contact(make, *evenly(product, count)))))


def _single_contacts(quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """One contact of a free mass against (A) and (B); where the other methods turn from loss to gain."""
    count = 300 if quick else 4000
    trapezoidal = FORCE["trapezoidal"]
    places = (np.arange(count) + 0.5) / count
    stiff = single_contact(trapezoidal, np.full(count, STIFF**2), places)
    resolved = single_contact(trapezoidal, *evenly(0.05, count))
    name, case = "generalised-alpha", "trapezoidal, one contact of a free mass"
    rows = [
        Limit(
            method=name, case=f"{case}, h w {STIFF:g}", knob="mean growth of ln(energy) per contact [1]",
            theory=STIFF_GROWTH, measured=float(np.mean(np.log(stiff))), refused=False,
            note=f"equation (B), {count} places of the touch; energy grows although the step is stable",
        ),
        Limit(
            method=name, case=f"{case}, h w {STIFF:g}", knob="greatest energy after/before [1]",
            theory=9.0, measured=float(stiff.max()), refused=False,
            note=f"the tip leaves at up to three times its speed; the nearest of {count} places",
        ),
        Limit(
            method=name, case=f"{case}, h w 0.05", knob="rms of energy after/before - 1 [1]",
            theory=0.05**2 / math.sqrt(90.0), measured=float(np.sqrt(np.mean((resolved - 1.0) ** 2))),
            refused=False, note=f"equation (A), {count} contacts; it averages out, and the energy wanders",
        ),
    ]  # fmt: skip
    sizes = np.geomspace(0.1, 1e3, 9 if quick else 25)
    arrays = {"single_h_w": sizes}
    few = 100 if quick else 300
    for label, make in FORCE.items():
        curve = np.array([_mean_growth(make, float(size), few) for size in sizes])
        arrays[f"single_growth_{label}"] = curve
        rising = np.flatnonzero((curve[:-1] <= GAIN) & (curve[1:] > GAIN))
        measured = None
        if rising.size:
            i = int(rising[0])
            measured = bisect(
                lambda size, make=make: _mean_growth(make, size, few) > GAIN,  # type: ignore[misc]
                float(sizes[i]), float(sizes[i + 1]), relative=1e-2,
            )  # fmt: skip
        rows.append(Limit(
            method=name, case=f"{label}, one contact of a free mass", knob="h w [1]", theory=None,
            measured=measured, refused=False if rising.size else None,
            note=f"from here on a contact feeds {GAIN} in the mean of ln(energy)" if rising.size
            else "loses energy at every h w from 0.1 to 1e3",
        ))  # fmt: skip

    def feeds(rho: float) -> bool:
        return _mean_growth(lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=rho), STIFF, few) > 0.0

    def feeds_rigid(rho: float) -> bool:
        method = GeneralisedAlpha.with_dissipation(step=1.0, rho=rho)
        return float(np.mean(np.log(rigid_contact(method, (np.arange(20_000) + 0.5) / 20_000)))) > 0.0

    rows.append(Limit(
        method=name, case=f"one contact of a free mass, h w {STIFF:g}", knob="rho [1]",
        theory=bisect(feeds_rigid, 0.1, 0.9, relative=1e-6),
        measured=bisect(feeds, 0.1, 0.9, relative=1e-5), refused=False,
        note="with more dissipation than this (smaller rho) a stiff contact feeds no energy in the mean; "
        "theory by the complementarity problem of a rigid stop",
    ))  # fmt: skip
    return rows, arrays


def _long_runs(model: ModalModel, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The beam over many contacts with a spring stop: histories, and where the energy doubles."""
    contacts = 1000 if quick else 10_000
    sizes = np.geomspace(0.5, 20.0, 3) if quick else np.geomspace(0.2, 20.0, 7)
    rows: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"ladder": sizes, "ratios": np.array(RATIOS)}
    for label, make in FORCE.items():
        growth, doubled = np.empty((len(RATIOS), sizes.size)), np.empty((len(RATIOS), sizes.size))
        for i, ratio in enumerate(RATIOS):
            law = LinearContact(stiffness=ratio * modal_stiffness(model))
            for j, size in enumerate(sizes):
                run = history(model, law, make, float(size), contacts)
                growth[i, j], doubled[i, j] = run.growth, run.contacts_to(2.0)
            fed = np.flatnonzero(np.isfinite(doubled[i]))
            first = int(fed[0]) if fed.size else -1
            rows.append(Limit(
                method="generalised-alpha", case=f"{label}, beam, k/k_modal {ratio:g}",
                knob="h omega_max [1]", theory=None, measured=float(sizes[first]) if fed.size else None,
                refused=False if fed.size else None,
                note=(
                    f"lowest of {sizes.size} steps from {sizes[0]:g} to {sizes[-1]:g} at which the energy "
                    f"doubled in {contacts} contacts, after {doubled[i, first]:.0f}"
                    if fed.size else f"the energy never doubled in {contacts} contacts, h omega_max up to 20"
                ),
            ))  # fmt: skip
        arrays[f"growth_{label}"], arrays[f"doubled_{label}"] = growth, doubled
    law = LinearContact(stiffness=1e2 * modal_stiffness(model))
    for label, make in FORCE.items():
        for size in (0.1, 1.0):
            _keep(arrays, f"{label}, {size:g}", history(model, law, make, size, contacts))
    return rows, arrays


def _keep(arrays: dict[str, np.ndarray], name: str, run: History) -> None:
    arrays[f"history_{name}"] = np.array([run.contacts.astype(float), run.log_energy])


def _impacts(model: ModalModel, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The beam under Newton's law with e = 1: what is kept over many impacts, and whether a step gains."""
    contacts, law = (1000 if quick else 10_000), NewtonRestitution(local_restitution=1.0)
    rows: list[Limit] = []
    arrays: dict[str, np.ndarray] = {}
    for label, make in IMPACT.items():
        kept = label in ("Moreau-Jean 1/2", "nonsmooth 1")
        worst, most = 0.0, -math.inf
        for size in (0.1, 1.0, 10.0):
            run = history(model, law, make, size, contacts)
            worst = max(worst, float(np.abs(np.expm1(run.log_energy)).max()))
            most = max(most, float(run.log_energy.max()))
            if size <= 1.0:
                _keep(arrays, f"{label}, {size:g}", run)
        knob = "largest |E/E_0 - 1| [1]" if kept else "largest ln(E/E_0) [1]"
        rows.append(Limit(
            method=make(1.0).name, case=f"{label}, beam, e = 1, h omega_max 0.1, 1 and 10", knob=knob,
            theory=0.0, measured=worst if kept else most, refused=None,
            note=f"{contacts} impacts; " + ("rounding only" if kept else "the energy stays below its start"),
        ))  # fmt: skip
    rows.append(Limit(
        method="moreau-jean", case="theta 1, e = 1, beam, h omega_max 1",
        knob="greatest E_{n+1}/E_n - 1 of a step [1]", theory=None, measured=_greatest_gain(model),
        refused=None, note="outside theta <= 1/(1 + e), where no theorem keeps a step from gaining",
    ))  # fmt: skip
    return rows, arrays


def _greatest_gain(model: ModalModel) -> float:
    """Greatest relative gain of energy in one step of Moreau and Jean's scheme with theta = 1, e = 1."""
    law = NewtonRestitution(local_restitution=1.0)
    beam = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law))
    h = 1.0 / float(model.omega.max())
    start = State(displacement=np.zeros(model.omega.size), velocity=-model.phi)
    times = h * np.arange(1, 4001)
    motion = simulate(beam, start, duration=4000 * h, times=times, method=MoreauJean(step=h, theta=1.0))
    energy = beam.energy(motion.displacement, motion.velocity)
    return float(np.max(energy[1:] / energy[:-1] - 1.0))


def _plane(model: ModalModel, quick: bool) -> dict[str, np.ndarray]:
    """Growth of ln(energy) per contact over the plane of step and contact stiffness."""
    sizes = np.geomspace(0.1, 30.0, 7 if quick else 16)
    ratios = np.geomspace(1e-3, 1e5, 7 if quick else 17)
    arrays = {"plane_size": sizes, "plane_ratio": ratios}
    for label in ("trapezoidal", "HHT 0.1", "generalised-alpha 0.8", "generalised-alpha 0"):
        growth = np.empty((ratios.size, sizes.size))
        for i, ratio in enumerate(ratios):
            law = LinearContact(stiffness=float(ratio) * modal_stiffness(model))
            for j, size in enumerate(sizes):
                growth[i, j] = history(model, law, FORCE[label], float(size), 60 if quick else 200).growth
        arrays[f"plane_{label}"] = growth
    return arrays


def measure(*, quick: bool, scene: Scene) -> Findings:
    """All of it; `quick` shortens runs and thins grids."""
    model = conservative(scene, MODES)
    single, single_arrays = _single_contacts(quick)
    runs, run_arrays = _long_runs(model, quick)
    impacts, impact_arrays = _impacts(model, quick)
    return Findings(
        limits=[*flight_limits(quick), *pressed_limits(model, quick), *single, *runs, *impacts],
        arrays={**single_arrays, **run_arrays, **impact_arrays, **_plane(model, quick)},
    )
