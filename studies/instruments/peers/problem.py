"""What a general solver is given: the equations of a run, and the accuracy that one tolerance stands for.

Absolute tolerances are those of one energy: with V = max(|q'|, |omega q|) over the start, the steady motion
and a swing that reaches the stop, velocities get tolerance * V and displacements tolerance * V/omega_k
(omega_k at least that of the drive, or of the lowest mode), so that fast modes are resolved like slow ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from contact.errors import ContactError
from contact.integrators.equation import Equation, equation_of
from contact.integrators.method import Run
from contact.laws import NEWTON
from contact.oscillator import ImpactOscillator
from contact.trajectory import State
from studies.instruments.peers.equations import packed

__all__ = ["Problem", "check_tolerance", "problem_of"]

EPS = 2.220446049250313e-16


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """What a solver needs to know.

    Parameters
    ----------
    equation : Equation
    modes, scalars : ndarray
        The same as plain arrays, see ``equations``.
    start : float
        Time at which the run starts [s]; all other times count from there.
    rounding : float
        Bound of the rounding error of the penetration [m].
    size : int
        Length of y: displacements, velocities and, for a dissipative force law, the work on the stop.
    tolerance : float
        Relative tolerance.
    absolute : ndarray, shape (size,)
        Absolute tolerances.
    looks : list of float, optional
        If given, filled with the times at which a solver that samples has looked for events [s].
    """

    equation: Equation
    modes: np.ndarray
    scalars: np.ndarray
    start: float
    rounding: float
    size: int
    tolerance: float
    absolute: np.ndarray
    looks: list[float] | None = None

    def tip(self, y: np.ndarray) -> tuple[float, float]:
        """Penetration [m] and its rate [m/s]."""
        phi, n = self.equation.phi, self.equation.phi.size
        return float(phi @ y[:n] - self.equation.gap), float(phi @ y[n : 2 * n])

    def failed(self, kind: type[ContactError], s: float, y: np.ndarray, detail: str = "") -> ContactError:
        """The error `kind` at the place where a solver has stopped."""
        depth, rate = self.tip(y)
        return kind(time=self.start + s, gap=-depth, velocity=rate, detail=detail)


def check_tolerance(tolerance: float, least: float) -> None:
    """ValueError unless `tolerance` is one that the library takes [1]."""
    if not (isinstance(tolerance, (int, float)) and least <= tolerance < 1):
        raise ValueError(f"tolerance is {tolerance}; it must lie between {least:g} and 1")


def _scales(oscillator: ImpactOscillator, equation: Equation, start: State) -> tuple[float, np.ndarray]:
    """Size of the modal velocities, and the frequency that each mode is measured by [rad/s]."""
    omega = oscillator.model.omega
    lowest = equation.drive if equation.drive > 0.0 else 2.0 * math.pi / oscillator.period
    pace = np.maximum(omega, lowest)
    amplitude = 0.0 if oscillator.drive is None else oscillator.drive.amplitude
    vectors = (
        start.velocity,
        omega * start.displacement,
        amplitude * lowest * np.abs(oscillator.steady_response()),
        equation.constant / pace,
    )
    reach = lowest * equation.gap / math.sqrt(equation.compliance) if equation.compliance > 0.0 else 0.0
    return max(reach, *(float(np.linalg.norm(vector)) for vector in vectors)) or 1.0, pace


def problem_of(
    oscillator: ImpactOscillator, run: Run, tolerance: float, looks: list[float] | None = None
) -> Problem:
    """The problem of `run` for a solver with this relative tolerance [1]."""
    equation = equation_of(oscillator, run.clock)
    speed, pace = _scales(oscillator, equation, run.start)
    rounding = 32.0 * EPS * (equation.gap + float(np.abs(equation.phi) @ (speed / pace)))
    modes, scalars = packed(equation, rounding)
    absolute = np.concatenate([speed / pace, np.full(pace.size, speed)])
    if equation.law != NEWTON and equation.number1 > 0.0:
        absolute = np.append(absolute, speed**2)
    return Problem(
        equation=equation, modes=modes, scalars=scalars, start=run.start.time, rounding=rounding,
        size=absolute.size, tolerance=tolerance, absolute=tolerance * absolute, looks=looks,
    )  # fmt: skip
