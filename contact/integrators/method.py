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
from contact.touch import LAWS
from contact.trajectory import CONTACT, Trajectory

LAW_NAMES = {code: file.LAW for code, file in LAWS.items()}  # the laws in words, by their codes
FORCE_LAWS = tuple(code for code, file in LAWS.items() if CONTACT in file.REGIMES)
"""Codes of the laws whose stop pushes with a force; the others are impact laws."""


class Integrator:
    """A method for the motion with contacts; its children are final.

    Attributes
    ----------
    name : str
        Its name in ``INTEGRATORS``.
    order : float
        Power of the step with which the error of a smooth motion falls; infinite for an exact method, NaN if
        a tolerance sets the error.
    laws : tuple of int
        Codes of the contact laws that it accepts.
    certified : bool
        Whether it proves that no touch is missed.
    accuracy : float
        Bound of the relative error of the state after a collision, for an exact method and contacts up to 1e7
        times as stiff as the spring; it grows as the root of that.  NaN if a step or tolerance decides.
    """

    name: ClassVar[str]
    order: ClassVar[float]
    laws: ClassVar[tuple[int, ...]]
    certified: ClassVar[bool] = False
    accuracy: ClassVar[float] = math.nan

    def accepts(self, law: int) -> bool:
        """Whether the method knows the contact law with this code."""
        return law in self.laws

    def critical_stiffness(self, numbers: Numbers) -> float:
        """Largest tangent stiffness of a lasting contact for which the method is stable [N/m].

        Infinite for an unconditionally stable method, below zero if it is unstable even in flight.
        """
        return math.inf

    def follow(self, oscillator: ImpactOscillator, plan: Plan) -> Trajectory:
        """The motion of `plan`; ``contact.simulation.simulate`` has checked the law before."""
        raise NotImplementedError
