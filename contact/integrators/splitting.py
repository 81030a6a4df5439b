"""Splitting: exact flight, contact force in kicks, composed symmetrically with a fixed step.

    order 2:  K(h/2) F(h) K(h/2)
    order 4:  K(b_0 h) F(a_1 h) K(b_1 h) F(a_2 h) ... F(a_6 h) K(b_6 h),   a_(7-i) = a_i,  b_(6-i) = b_i

F is the flow of the driven spring without the stop, K the contact acting on velocities alone; both are exact
(``contact.integrators.splitting_step``), so that the error is that of the composition and vanishes off the
stop.  Sources: G. Strang, SIAM J. Numer. Anal. 5 (1968) 506; S. Blanes, P. C. Moan, J. Comput. Appl. Math.
142 (2002) 313, the six-stage method of order 4 for second-order equations that begins with a kick.

Why that one: symmetric compositions of order 4 share their two order conditions, and differ in what is left.
At equal numbers of kicks the error in a contact that stays closed (a free body on a spring) is 1/140 of that
of M. Suzuki's five steps of order 2 (Phys. Lett. A 146 (1990) 319) and 1/420 of that of H. Yoshida's three
(Phys. Lett. A 150 (1990) 262).  The limits of the three are alike, 0.0695, 0.0740 and 0.0688 of what order 2
bears, and the one chosen exceeds its own by a growth of 0.24 % a step, and that only as far as 0.0697; it
fails for good at 0.175.

Order in a collision.  The expansions of the error need derivatives of the force that are not there at d = 0:
a step over a touch at which the force grows as d^p adds an error of order h^(p + 1), whatever the method.

    law                                       order 2     order 4
    Hertz (p = 3/2)                           2           2.5
    linear (p = 1)                            2           2
    linear with a dashpot (a jump, p = 0)     1           1

So order 4 gains where contacts are long against the step, little in short collisions.  For the same reason
the energy of a lossless motion, which symplecticity keeps from drifting in a contact that stays closed or in
flight, takes at every touch and release a step of that order h^(p + 1), of either sign: over many contacts
it wanders as a random walk does, with the square root of their number, and without drift.

The limit of stability is that of ``contact.integrators.splitting_limit``; in flight there is none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np

from contact.flight.motion import Motion, motion_of
from contact.integrators.fixed_step import check_step, fixed_step_run
from contact.integrators.method import Integrator
from contact.integrators.splitting_limit import closed_form_limit, first_instability, spectral_radius
from contact.integrators.splitting_step import Composition, march, split_of
from contact.laws import HERTZ, LINEAR, LinearContact
from contact.oscillator import ImpactOscillator
from contact.trajectory import Run, Trajectory

__all__ = ["COMPOSITIONS", "Splitting"]

STRANG = Composition(flows=np.array([1.0]), kicks=np.array([0.5, 0.5]))

_A1, _A2 = 0.245298957184271, 0.604872665711080
_B0, _B1, _B2 = 0.0829844064174052, 0.3963098014983681, -0.0390563049223486
_A3, _B3 = 0.5 - (_A1 + _A2), 1.0 - 2.0 * (_B0 + _B1 + _B2)
BLANES_MOAN = Composition(
    flows=np.array([_A1, _A2, _A3, _A3, _A2, _A1]),
    kicks=np.array([_B0, _B1, _B2, _B3, _B2, _B1, _B0]),
)

COMPOSITIONS = {2: STRANG, 4: BLANES_MOAN}
"""The coefficients of one step by order."""


@lru_cache(maxsize=256)
def _limit(numbers: bytes, n: int, order: int, step: float, damping: float) -> float:
    """`critical_stiffness`, kept: the search takes some hundredths of a second."""
    omega, decay, phi = np.frombuffer(numbers).reshape(3, n)
    law = LinearContact(stiffness=1.0, damping=damping)
    motion = motion_of(omega, decay, phi, law=law, gap=0.0)
    composition = COMPOSITIONS[order]
    closed = closed_form_limit(motion, step, damping) if order == 2 else None
    if closed is not None:
        undamped = damping == 0.0 and not np.any(decay > 0.0)
        if undamped or spectral_radius(motion, composition, step, 0.999 * closed, damping) <= 1.0:
            return closed
    return first_instability(motion, composition, step, damping)


@dataclass(frozen=True, kw_only=True)
class Splitting(Integrator):
    """Symmetric kick-flow-kick splitting with a fixed step.

    Parameters
    ----------
    step : float
        Time step [s]; it may be longer than the periods of high modes.
    order : int
        2 or 4.
    beyond_limit : bool
        Run even where the step is unstable, for a study of what happens there.
    """

    step: float
    order: int = 2  # type: ignore[misc]
    beyond_limit: bool = False
    name: ClassVar[str] = "splitting"
    laws: ClassVar[tuple[int, ...]] = (LINEAR, HERTZ)
    limit: ClassVar[str] = (
        "contact closed, omega h < pi: order 2, k h sum phi^2 tan(omega h/2)/(2 omega) <= 1; order 4, lowest "
        "root of det(step matrix + I); resonances of step and contact beyond"
    )
    source: ClassVar[str] = (
        "G. Strang, SIAM J. Numer. Anal. 5 (1968) 506; S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142 "
        "(2002) 313"
    )

    def __post_init__(self) -> None:
        check_step(self.step)
        if self.order not in COMPOSITIONS:
            raise ValueError(f"order is {self.order!r}; it must be 2 or 4")

    def critical_stiffness(self, motion: Motion) -> float:
        """Lowest stiffness of a lasting contact at which a step is unstable [N/m].

        With the dashpot of a linear law; for Hertz's and Hunt and Crossley's laws it is the tangent stiffness
        that counts, and their damping, which raises the limit as a dashpot does, is left out.
        """
        numbers = np.array([motion.omega, motion.decay, motion.phi])
        damping = motion.number1 if motion.law == LINEAR else 0.0
        return _limit(numbers.tobytes(), motion.size, self.order, self.step, damping)

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`."""
        motion = oscillator.motion()
        split = split_of(motion, COMPOSITIONS[self.order])
        return fixed_step_run(
            oscillator, run, step=self.step, motion=motion,
            critical=math.inf if self.beyond_limit else self.critical_stiffness(motion),
            march=lambda _equation, grid: march(split, grid),
        )  # fmt: skip
