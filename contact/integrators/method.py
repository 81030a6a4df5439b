"""The contract of every method for the motion with contacts.

A method turns the equation of motion of ``contact.oscillator`` into a ``Trajectory``.  It states its order,
the laws that it accepts, and the largest contact stiffness that its step can bear.  Its file opens with its
equations, its limit of stability and its source.  A law that it does not accept is refused before time starts
(``TypeError``), and so is a step beyond the limit (``StepTooLarge``).
"""

import math
from typing import ClassVar

from contact.engine.plan import Plan
from contact.flight.numbers import Numbers
from contact.oscillator import ImpactOscillator
from contact.state import CONTACT
from contact.touch import LAWS
from contact.trajectory import Trajectory

LAW_NAMES = {code: file.LAW for code, file in LAWS.items()}  # the laws in words, by their codes
FORCE_LAWS = tuple(code for code, file in LAWS.items() if CONTACT in file.REGIMES)
"""Codes of the laws whose stop pushes with a force; the others are impact laws."""


class Integrator:
    """A method for the motion with contacts.

    Users take one of its children, such as `Exact` or `CentralDifference`.

    Attributes
    ----------
    name : str
        Name of the method in ``INTEGRATORS``.
    order : float
        Power of the step with which the error of a smooth motion falls [1].  It is infinite for an exact
        method, and NaN if a tolerance sets the error.
    laws : tuple of int
        Codes of the contact laws that the method accepts.
    certified : bool
        Whether the method proves that no touch is missed.
    accuracy : float
        Bound of the relative error of the state after a collision with an exact method [1].  It holds for
        contacts up to 1e7 times as stiff as the spring; the error grows as the square root of the stiffness.
        The bound is NaN if a step or a tolerance sets the error.
    """

    name: ClassVar[str]
    order: ClassVar[float]
    laws: ClassVar[tuple[int, ...]]
    certified: ClassVar[bool] = False
    accuracy: ClassVar[float] = math.nan

    def accepts(self, law: int) -> bool:
        """Return whether the method accepts the contact law with this code."""
        return law in self.laws

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Return the largest tangent stiffness of a lasting contact for which the method is stable [N/m].

        Infinite for an unconditionally stable method, below zero if it is unstable even in flight.
        """
        return math.inf

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """Return the motion of `plan`; ``contact.simulate`` has checked the law before."""
        raise NotImplementedError
