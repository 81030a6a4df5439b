"""From modes and a rule for their damping to the modal model: the last step of the drawing board.

Of n_dofs degrees of freedom the lowest modes are kept, of these only the ones that an impact or the drive can
excite; their decay rates come from a rule of `damping`, and the static compliance of the whole spring from a
static solution, so that what the truncation leaves out (see `modal_model`) stays known.
"""

from __future__ import annotations

import numpy as np

from .damping import Damping, require_rule
from .modal_model import ModalModel
from .modes import Modes
from .parameters import InvalidValue, require_kind, require_whole


def reduce(
    modes: Modes, damping: Damping, count: int | None = None, *, coupled_only: bool = True
) -> ModalModel:
    """Return the modal model of a discretized spring.

    Parameters
    ----------
    modes : Modes
        From `natural_modes`.
    damping : Damping
        Gives the decay rate of each mode.
    count : int, optional
        How many modes to keep, lowest first; all of `modes` by default.
    coupled_only : bool
        Drop the modes that neither the drive nor a force on the tip can excite (phi = participation = 0);
        `count` then counts the modes that stay.

    Returns
    -------
    ModalModel
        With the static compliance from a static solve, so that the residual compliance of the truncation is
        known.

    Raises
    ------
    ValueError
        If `modes` holds fewer than `count` modes of the wanted kind.
    """
    require_kind("modes", modes, Modes, "Modes, from natural_modes")
    require_rule("damping", damping)
    require_kind("coupled_only", coupled_only, bool, "True or False")
    keep = np.flatnonzero(modes.coupled) if coupled_only else np.arange(modes.omega.size)
    wanted = keep.size if count is None else require_whole("count", count, "modes", low=0)
    if not 1 <= wanted <= keep.size:
        kind = "coupled modes" if coupled_only else "modes"
        raise InvalidValue(
            f"count is {wanted} modes; it must lie between 1 and the {keep.size} {kind} found among the "
            f"{modes.omega.size} computed (ask natural_modes for more)"
        )
    keep = keep[:wanted]
    return ModalModel(
        omega=modes.omega[keep],
        decay_rate=damping.decay_rates(modes)[keep],
        phi=modes.phi[keep],
        participation=modes.participation[keep],
        static_compliance=modes.discretization.static_compliance(),
        tip_mass=modes.discretization.spring.tip.mass,
        readouts={name: row[keep] for name, row in modes.readouts.items()},
    )
