r"""Splitting: the stiffest stop and the longest step of a contact that lasts.

A step of order 2 is kick, flight, kick. Its limit in a lasting contact, for omega h < pi, is the stiffness at
which an eigenvalue of the step passes -1,

    k_crit = 1/X,   without damping   X = h sum_k phi_k^2 tan(omega_k h/2)/(2 omega_k),

for h -> 0 that of central difference on a free body, 4/(h^2 sum phi^2) (``contact.integrators.splitting``).
Beyond pi a resonance of step and contact opens a tongue of instability that closes again for a longer step.

For order 4 the limit is the lowest root of det(M(k) + I), M the matrix of the step, by which the package
refuses (``Splitting.critical_stiffness``). It is a limit of M alone: an inner kick of a long step may find
the tip off the stop even at rest; the motion then is affine in pieces, M not its slope, and it is unstable
from up to 2.2 % below that limit at h omega_N = 2.5. So order 4 is left out.
"""

from beam import ModalModel
from contact.integrators import Splitting
from studies.methods.stability.model import Findings, Limit, stiffest
from studies.shell.scene import Scene, model_of


def limit(model: ModalModel, angle: float) -> Limit:
    """Largest stiffness of a lasting contact at h omega_N = `angle`, order 2."""
    return stiffest(
        model,
        Splitting(step=angle / float(model.omega[-1])),
        family="splitting",
        case=f"order 2, lasting contact, modes: {model.n_modes}, h ω_N = {angle:g}",
    )


def measure(scene: Scene, quick: bool) -> Findings:
    """Limits on the modes of the scene."""
    model = model_of(scene)
    counts = sorted({min(n, model.n_modes) for n in ((1, 3) if quick else (1, 2, 5, 15))})
    return [limit(model.truncated(n), angle) for n in counts for angle in (1.0, 2.5)], {}
