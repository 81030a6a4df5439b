"""Reduction of the modes of a leaf spring, with a rule for their damping, to a modal model."""

import numpy as np

from .damping import Damping
from .modal_model import ModalModel, Point
from .modes import Modes
from .parameters import require, require_kind, require_whole


def reduce(modes: Modes, damping: Damping, count: int | None = None) -> ModalModel:
    """Return the modal model of a discretized spring, with the static compliance of the whole spring.

    Modes that neither the drive nor a force on the tip or on a point of the spring can excite are left out.

    Parameters
    ----------
    modes : Modes
        Modes from `natural_modes`.
    damping : Damping
        Rule for the decay rate of each mode [1/s].
    count : int, optional
        Number of modes to keep, lowest first; all by default.

    Returns
    -------
    ModalModel
        The coupled modes, with the read-outs and the points of the spring among its `points`.

    Raises
    ------
    ValueError
        If `modes` holds fewer than `count` such modes, or none, or the rule of damping cannot be applied.
    TypeError
        If `modes` is not of the class Modes, `damping` is not a rule, or `count` is not a number.

    See Also
    --------
    natural_modes : The step before, the modes.
    MeasuredDecay : The measured decay rate of mode 1, and a rule for the others.
    contact.ImpactOscillator : The next step, the model with a drive and a stop.

    Examples
    --------
    >>> from beam import STEEL, MeasuredDecay, StripSection, assemble, cantilever, natural_modes, reduce
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip)), count=4)
    >>> model = reduce(modes, MeasuredDecay(decay_rate=3.56), count=2)
    >>> [round(f, 1) for f in model.frequencies_hz.tolist()], [round(c, 1) for c in model.decay_rate.tolist()]
    ([18.6, 116.7], [3.6, 22.3])
    """
    require_kind("modes", modes, Modes, "Modes, from natural_modes")
    require_kind("damping", damping, Damping, "a rule for decay rates such as StripDamping()")
    keep = np.flatnonzero(modes.coupled)
    wanted = keep.size if count is None else require_whole("count", count, "modes", low=0)
    words = f"it must lie between 1 and the {keep.size} coupled modes among the {modes.omega.size} computed"
    require(1 <= wanted <= keep.size, "count", f"is {wanted} modes; {words} (natural_modes computes more)")
    keep, found = keep[:wanted], modes.discretization
    spring, points = found.spring, dict[str, Point]()
    for name, row in modes.readouts.items():
        own = name in spring.points
        at_tip = own and abs(spring.point_at[name] - spring.tip_at) <= 1e-9 * spring.centreline.length
        points[name] = Point(
            row=row[keep],
            static_compliance=found.static_compliance(name) if own else None,
            mass=(spring.tip.mass if at_tip else 0.0) if own else None,
        )
    return ModalModel(
        omega=modes.omega[keep],
        decay_rate=damping.decay_rates(modes)[keep],
        phi=modes.phi[keep],
        participation=modes.participation[keep],
        static_compliance=found.static_compliance(),
        tip_mass=spring.tip.mass,
        points=points,
    )
