r"""Splitting: the stiffest stop and the longest step of a contact that lasts.

A step of order 2 is kick, flight, kick. Its limit in a lasting contact, for omega h < pi, is the stiffness at
which an eigenvalue of the step passes -1,

    k_crit = 1/X,   without damping   X = h sum_k phi_k^2 tan(omega_k h/2)/(2 omega_k),

for h -> 0 that of central difference on a free body, 4/(h^2 sum phi^2) (``contact.integrators.splitting``).
Beyond pi a resonance of step and contact opens a tongue of instability that closes again for a longer step.

For order 4 the limit is the lowest root of det(M(k) + I), M the matrix of the step, by which the package
refuses (``Splitting.critical_stiffness``). It is a limit of M alone: an inner kick of a long step may find
the tip off the stop even at rest; the motion then is affine in pieces, M not its slope, and it is unstable
from up to 2.2 % below that limit at h omega_N = 2.5. So order 4 is shown, and not measured.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from beam import ModalModel
from contact.integrators import Splitting
from studies.methods.stability import Findings, Limit
from studies.methods.stability.lasting_contact import pressed, stiffest
from studies.shell import plotting
from studies.shell.scene import Scene, model_of


def limit(model: ModalModel, angle: float) -> Limit:
    """Largest stiffness of a lasting contact at h omega_N = `angle`, order 2."""
    return stiffest(
        model,
        Splitting(step=angle / float(model.omega[-1])),
        family="splitting",
        case=f"order 2, lasting contact, modes: {model.n_modes}, h omega_N = {angle:g}",
    )


def measure(scene: Scene, quick: bool) -> Findings:
    """Limits on the modes of the scene, and over the step those of both orders for five of them."""
    model = model_of(scene)
    counts = sorted({min(n, model.n_modes) for n in ((1, 3) if quick else (1, 2, 5, 15))})
    limits = [limit(model.truncated(n), angle) for n in counts for angle in (1.0, 2.5)]
    few, angles = model.truncated(min(5, model.n_modes)), np.linspace(0.5, 3.0, 3 if quick else 6)
    fine, motion = np.linspace(0.1, 7.0, 40 if quick else 280), pressed(few, 1.0)[0].motion()
    found = [limit(few, float(angle)).measured for angle in angles]
    arrays = {"fine": fine, "angle": angles, "measured": np.array(found, dtype=float)}
    for order in (2, 4):
        steps = [Splitting(step=x / float(few.omega[-1]), order=order) for x in fine]
        arrays[f"limit_{order}"] = np.array([method.critical_stiffness(motion) for method in steps])
    return limits, arrays


@plotting.in_house_style
def draw(arrays: Mapping[str, np.ndarray]) -> tuple[Figure, str]:
    """The stiffest lasting contact over the step, both orders."""
    figure, axes = plotting.new_figure(width=plotting.COLUMN, height=0.075)
    for number, order in enumerate((2, 4)):
        axes.plot(
            arrays["fine"],
            arrays[f"limit_{order}"],
            color=plotting.PALETTE[number + 1],
            label=f"order {order}, limit of refusal",
        )
    axes.plot(arrays["angle"], arrays["measured"], **plotting.points(1), label="order 2, found")
    axes.axvline(math.pi, color="black", linewidth=0.6, linestyle=":", label="h ω$_N$ = π")
    axes.set_yscale("log")
    plotting.label(axes.xaxis, "h ω$_N$, step × highest free frequency")
    plotting.label(axes.yaxis, "contact stiffness", "N/m")
    figure.legend(loc="outside lower center", ncols=2)
    return figure, (
        "Splitting, five modes pressed on the stop: the stiffest contact that a step bears; beyond "
        "h omega_N = pi the instabilities are resonances of step and contact."
    )
