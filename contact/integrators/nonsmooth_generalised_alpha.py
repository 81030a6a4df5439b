"""The nonsmooth generalised-alpha method: smooth motion of order 2, impacts as percussions within a step.

The velocity is split into a smooth part, followed by the generalised-alpha method (``generalised_alpha``),
and the jump w = -phi p of the step.  The force f, the tip velocity U, the restitution e and the conditions on
the percussion p are as in ``moreau_jean``:

    (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) f_{n+1} + alpha_f f_n
    v_{n+1} = v_n + h ((1 - gamma) a_n + gamma a_{n+1}) + w
    q_{n+1} = q_n + h v_n + h^2 ((1/2 - beta) a_n + beta a_{n+1}) + (h/2) w

(Q.-Z. Chen, V. Acary, G. Virlez, O. Bruls, Int. J. Numer. Meth. Engng 96 (2013) 487; the variant with the
constraint at velocity level and the whole contact force in the percussion).  The acceleration a is the smooth
one and is carried across impacts.  With D as in ``generalised_alpha``, v_{n+1} = v* - E phi p,

    E = (1 - alpha_m + (1 - alpha_f) (beta - gamma/2) h^2 omega^2) / D > 0,

and p = max(0, (U* + e U_n) / sum E phi^2).  alpha_m, alpha_f, beta, gamma follow from rho, the factor by
which a step damps infinite frequencies (``chung_hulbert``).  Order 2 in smooth motion, 1 after an impact,
whose instant is known to half a step; stable for any step.
"""

from collections.abc import Callable
from typing import ClassVar

from beam.record import record
from contact.integrators.fixed_step import FixedStep
from contact.integrators.generalised_alpha import chung_hulbert
from contact.integrators.grid import Grid
from contact.integrators.moreau_jean import MoreauJean, before_percussions, through_percussions


@record(eq=True)
class NonsmoothGeneralisedAlpha(FixedStep):
    """The nonsmooth generalised-alpha method with a fixed step, for Newton's law.

    Parameters
    ----------
    step : float
        Time step, above zero [s].
    beyond_limit : bool
        Whether to run even where the step is unstable, to study what happens there.
    rho : float
        Factor by which a step damps infinite frequencies, from 0 to 1 [1]; 1 damps nothing.

    Raises
    ------
    ValueError
        If the step is no finite number above zero, or `rho` lies outside 0 to 1.
    TypeError
        If `rho` is no number.
    """

    rho: float
    name: ClassVar[str] = "nonsmooth-generalised-alpha"
    order: ClassVar[float] = 2.0
    laws: ClassVar[tuple[int, ...]] = MoreauJean.laws
    time_loop: ClassVar[Callable[..., int]] = staticmethod(through_percussions)

    def __post_init__(self) -> None:
        super().__post_init__()
        chung_hulbert(self.rho)

    def prepare(self, grid: Grid) -> object:
        """The numbers of Chung and Hulbert for rho, with eta = 1/2."""
        return before_percussions(chung_hulbert(self.rho), grid)
