"""What every method for the motion with contacts offers, and what a run asks of it.

A method turns the equation of motion of ``contact.oscillator`` into a ``Trajectory``.  It states its order,
the laws that it accepts, the largest contact stiffness that its step can bear, and its source; whoever
compares methods needs no more.  A law that it does not know is refused before time starts (``TypeError``),
and so is a step beyond its limit of stability (``StepTooLarge``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.flight import Motion
from contact.laws import DELAYED, HERTZ, LINEAR, NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import State, Trajectory

__all__ = ["Integrator", "Run"]

LAW_NAMES = {
    NEWTON: "NewtonRestitution",
    DELAYED: "DelayedRestitution",
    LINEAR: "LinearContact",
    HERTZ: "HertzContact or HuntCrossley",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """From where to where, and what is wanted on the way.

    Parameters
    ----------
    start : State
    length : float
        Duration [s].
    first, last : int
        Numbers of the drive periods in which the run starts and ends.
    clock, clock_end : float
        Times since the strobes that begin them [s].
    times : ndarray, shape (n_times,)
        Times at which the state is wanted [s].
    sample_period, sample_clock : ndarray, shape (n_times,)
        The same as number of the drive period and time since its strobe [s].
    """

    start: State
    length: float
    first: int
    last: int
    clock: float
    clock_end: float
    times: np.ndarray
    sample_period: np.ndarray
    sample_clock: np.ndarray


class Integrator:
    """A method for the motion with contacts; its children are final.

    Attributes
    ----------
    name : str
        Under which ``INTEGRATORS`` lists it.
    order : float
        Power of the step with which the error of a smooth motion falls; infinite for an exact method, NaN for
        one whose error is set by a tolerance.
    laws : tuple of int
        Codes of the contact laws that it accepts.
    certified : bool
        Whether it proves that no touch is missed.
    accuracy : float
        Error of the state after a collision, relative to its size, that an exact method keeps for contacts up
        to 1e8 times as stiff as the spring (it grows as the root of that); NaN for one whose step or
        tolerance decides.
    limit : str
        Its limit of stability in words.
    source : str
        Where it is published.
    """

    name: ClassVar[str]
    order: ClassVar[float]
    laws: ClassVar[tuple[int, ...]]
    certified: ClassVar[bool] = False
    accuracy: ClassVar[float] = math.nan
    limit: ClassVar[str]
    source: ClassVar[str]

    def accepts(self, law: int) -> bool:
        """Whether the method knows the contact law with this code."""
        return law in self.laws

    def critical_stiffness(self, motion: Motion) -> float:
        """Largest tangent stiffness of a lasting contact for which the method is stable [N/m].

        Infinite for an unconditionally stable method, below zero if it is unstable even in flight.
        """
        return math.inf

    def follow(self, oscillator: ImpactOscillator, run: Run) -> Trajectory:
        """The motion of `run`; ``contact.simulation.simulate`` has checked law and step before."""
        raise NotImplementedError
