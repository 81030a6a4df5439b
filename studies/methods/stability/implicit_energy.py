"""Implicit methods on a stop that is met and left: stable by linear theory, and what the energy does.

One contact of a free mass with a linear stop by the trapezoidal rule, with places of touch and release in
their steps evenly distributed, changes the energy by the part

    rms = (h w)^2 / sqrt(90),      w^2 = k/m, for a contact of many steps                              (A)

and for h w -> infinity by

    mean of ln(energy after/before) = (5/2) ln 3 - 2 = 0.7465.                                         (B)

Derivation: ``docs/theory/steps.md``.
"""

import math
from collections.abc import Mapping
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from contact.integrators import GeneralisedAlpha
from studies.methods.stability.model import IMPLICIT, Findings, Limit, energy_after
from studies.shell import plotting
from studies.shell.scene import Scene

STIFF, STIFF_GROWTH = 1e4, 2.5 * math.log(3.0) - 2.0
"""h w of a contact that counts as infinitely stiff, (B) being met to 1/(h w); equation (B)."""

entry = partial(Limit, family="implicit_energy", method=GeneralisedAlpha.name, refused=False)


def single_contact(label: str, products: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Energy after over energy before one contact of a free mass, by a method of `IMPLICIT`, for pairs of h w
    and place u of the touch in its step."""
    method = IMPLICIT[label](1.0)
    pairs = zip(products.tolist(), places[:, None], strict=True)
    return np.concatenate([energy_after(method, x, place) for x, place in pairs])


def evenly(product: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """`count` pairs for `single_contact` around h w = `product`: touch and release spread evenly over their
    steps, the release by contact times pi/w that spread over one step, or a third of themselves if less."""
    index = np.arange(count)
    place = (index * (math.sqrt(5.0) - 1.0) / 2.0) % 1.0 - 0.5
    steps = math.pi / product + place * min(1.0, math.pi / (3.0 * product))
    return math.pi / steps, (index + 0.5) / count


def stiff_contacts(count: int) -> list[Limit]:
    """One contact of a free mass by the trapezoidal rule against (A) and (B)."""
    places, case = (np.arange(count) + 0.5) / count, "trapezoidal, one contact of a free mass"
    stiff = single_contact("trapezoidal rule", np.full(count, STIFF), places)
    resolved = single_contact("trapezoidal rule", *evenly(0.05, count)) - 1.0
    found = (
        (STIFF, "mean of ln(energy after/before)", STIFF_GROWTH, np.mean(np.log(stiff))),
        (STIFF, "largest energy after/before", 9.0, stiff.max()),
        (0.05, "rms of energy after/before − 1", 0.05**2 / math.sqrt(90.0), np.sqrt(np.mean(resolved**2))),
    )
    return [
        entry(case=f"{case}, h ω = {x:g}", parameter=name, theory=theory, measured=float(measured))
        for x, name, theory, measured in found
    ]


def measure(scene: Scene, quick: bool) -> Findings:
    """Single contacts; nothing depends on the scene."""
    sizes, count = np.geomspace(0.1, 1e3, 9 if quick else 25), 60 if quick else 300
    arrays = {"single_h_w": sizes}
    for label in IMPLICIT:
        after = [single_contact(label, *evenly(size, count)) for size in sizes.tolist()]
        arrays[f"single_{label}"] = np.log(after).mean(axis=1)
    return stiff_contacts(300 if quick else 4000), arrays


HOLDS = "single_h_w: step times contact frequency [1]; the others: mean of ln(energy after/before) [1]."


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """Growth in one contact against its resolution."""
    figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.075)
    for number, label in enumerate(IMPLICIT):
        look = {**plotting.series(number), "markevery": 3, "label": label}
        axes.plot(arrays["single_h_w"], arrays[f"single_{label}"], **look)
    axes.axhline(STIFF_GROWTH, color="0.5", linewidth=0.8, linestyle=":", label="theory: trapezoidal, stiff")
    axes.axhline(0.0, **plotting.GUIDE, label="energy kept")
    axes.set_xscale("log")
    plotting.label(axes.xaxis, "step × contact frequency, h ω")
    plotting.label(axes.yaxis, "mean ln(energy ratio)")
    figure.legend(loc="outside lower center", ncols=2)
    return figure, "Mean growth of the energy of a free mass in one contact, by implicit methods."
