"""What may be asked of a model, and how far one answer is from another.

    frequency K      K-th frequency of the modes that move the ball [Hz]; error relative
    restitution      of the first collision at excess 0.0065, 0.013 and 0.026 [1]; error absolute
    delay            of these collisions over v/a, the time in which the tip would turn by itself; absolute
    kick             of these collisions [1]; error absolute
    born_period      period of the settled orbit at excess 1e-3, at the drive frequency and at both ends of
                     what the error of the free period (letter, Fig. 2) makes of it; error: how many differ
    fold             F/F_g - 1 at which the p_m orbit ends; error relative to it, or to the letter's amplitude
                     stability of 2.5e-4 where it is smaller than that
    tip_trace        tip displacement over one period of the settled orbit at excess 0.013; error: root mean
                     square over the gap

Restitution, delay and kick are asked at three amplitudes, lest errors of different origin that cancel at
one pass for accuracy. A model that has no answer (no such mode, no return of the single mode, no orbit, no
fold) answers None.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.collision import first_collision
from contact.errors import ContactError
from contact.orbits.continuation import fold_of
from contact.orbits.settling import born, born_period
from contact.orbits.shooting import Shooting
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stroboscope import StroboscopicMap
from studies.instruments.adequacy.model_choice import ModelChoice, Models
from studies.instruments.oscillators import REFERENCE_EXCESS, approach_speed
from studies.published import (
    AMPLITUDE_STABILITY_M,
    DRIVE_AMPLITUDE_M,
    FREE_PERIOD_ERROR_S,
    FREE_PERIOD_S,
)

__all__ = ["QUANTITIES", "Asked"]

Answer = np.ndarray | None

BORN_EXCESS = 1e-3
AMPLITUDE_STABILITY = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M

MOST_CYCLES = 4000
"""Bound of a transient [drive periods]: the slowest at the letter's frequencies takes about 1000."""

SAMPLES = 256
"""Samples of a trace in a drive period."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A quantity at a drive frequency.

    Parameters
    ----------
    quantity : str
        A key of `QUANTITIES`; "frequency" is followed by the number of the mode, "frequency 3".
    frequency : float
        Drive frequency [Hz].
    """

    quantity: str
    frequency: float

    def __post_init__(self) -> None:
        name, _, number = self.quantity.partition(" ")
        if name not in QUANTITIES or (name == "frequency") != number.isdigit() or number == "0":
            names = ", ".join(key if key != "frequency" else "frequency K" for key in QUANTITIES)
            raise ValueError(f"quantity is {self.quantity!r}; it must be one of {names}")
        if not (math.isfinite(self.frequency) and self.frequency > 0):
            raise ValueError(f"frequency is {self.frequency} Hz; it must be finite and above zero")

    @property
    def unit(self) -> str:
        """Of the error."""
        return QUANTITIES[self.quantity.partition(" ")[0]][2]

    def answer(self, models: Models, choice: ModelChoice) -> Answer:
        """What the model says; None if it has no answer."""
        name, _, number = self.quantity.partition(" ")
        if name == "frequency":
            model = models.model(choice)
            place = int(number) - 1
            missing = model is None or place >= choice.modes
            return None if missing else model.frequencies_hz[place : place + 1]  # type: ignore[union-attr]
        try:
            return QUANTITIES[name][0](models, choice, self.frequency)
        except (ContactError, ValueError):
            return None

    def error(self, answer: Answer, reference: Answer) -> float:
        """How far `answer` is from `reference`; infinite without one of them."""
        if answer is None or reference is None:
            return math.inf
        return QUANTITIES[self.quantity.partition(" ")[0]][1](answer, reference)


def _driven(models: Models, choice: ModelChoice, frequency: float, excess: float) -> ImpactOscillator | None:
    oscillator = models.oscillator(choice, frequency)
    return None if oscillator is None else oscillator.with_excess(excess)


def _collision(name: str) -> Callable[[Models, ModelChoice, float], Answer]:
    def answer(models: Models, choice: ModelChoice, frequency: float) -> Answer:
        values = []
        for factor in (0.5, 1.0, 2.0):
            excess = factor * REFERENCE_EXCESS
            oscillator = _driven(models, choice, frequency, excess)
            if oscillator is None:
                return None
            value = getattr(first_collision(oscillator), name)
            if name == "delay":
                w, gap = 2.0 * math.pi * frequency, oscillator.stop.gap
                value /= approach_speed(frequency, gap, excess) / (w**2 * gap)
            values.append(value)
        return np.array(values) if np.all(np.isfinite(values)) else None

    return answer


def _born_period(models: Models, choice: ModelChoice, frequency: float) -> Answer:
    found = []
    for shift in (-1.0, 0.0, 1.0):
        here = frequency * (1.0 + shift * FREE_PERIOD_ERROR_S / FREE_PERIOD_S)
        oscillator = _driven(models, choice, here, BORN_EXCESS)
        if oscillator is None:
            return None
        strobed = StroboscopicMap(oscillator=oscillator)
        found.append(born_period(strobed, BORN_EXCESS, most_cycles=MOST_CYCLES))
    return np.array(found, dtype=float)


def _fold(models: Models, choice: ModelChoice, frequency: float) -> Answer:
    oscillator = _driven(models, choice, frequency, BORN_EXCESS)
    if oscillator is None:
        return None
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = born(strobed, BORN_EXCESS, most_cycles=MOST_CYCLES)
    if settled.period < 2 or settled.impacts == 0:
        return None
    end = fold_of(Shooting(oscillator=oscillator, period=settled.period))
    return np.array([float(settled.period), math.nan if end is None else end.excess])


def _tip_trace(models: Models, choice: ModelChoice, frequency: float) -> Answer:
    oscillator = _driven(models, choice, frequency, REFERENCE_EXCESS)
    if oscillator is None:
        return None
    strobed = StroboscopicMap(oscillator=oscillator)
    settled = born(strobed, REFERENCE_EXCESS, most_cycles=MOST_CYCLES)
    if settled.period == 0 or settled.impacts == 0:
        return None
    count = settled.period * SAMPLES
    times = settled.end.time + np.arange(count) / SAMPLES * oscillator.period
    run = simulate(oscillator, settled.end, periods=settled.period, times=times)
    return run.displacement @ oscillator.model.phi / oscillator.stop.gap


def _relative(answer: np.ndarray, reference: np.ndarray) -> float:
    return float(np.max(np.abs(answer / reference - 1.0)))


def _absolute(answer: np.ndarray, reference: np.ndarray) -> float:
    return float(np.max(np.abs(answer - reference)))


def _mismatches(answer: np.ndarray, reference: np.ndarray) -> float:
    return float(np.count_nonzero(answer != reference))


def _of_the_same_period(answer: np.ndarray, reference: np.ndarray) -> float:
    """Error of the second entry, the fold, infinite if the first, the period, differs."""
    if answer[0] != reference[0] or math.isnan(answer[1]) != math.isnan(reference[1]):
        return math.inf
    if math.isnan(reference[1]):  # neither has a fold
        return 0.0
    return float(abs(answer[1] - reference[1]) / max(abs(reference[1]), AMPLITUDE_STABILITY))


def _best_aligned(answer: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square of the difference; a p_m orbit has m phases, and any of them is the same orbit."""
    if answer.size != reference.size:
        return math.inf
    turns = [np.roll(answer, shift) for shift in range(0, answer.size, SAMPLES)]
    return float(min(np.sqrt(np.mean((turn - reference) ** 2)) for turn in turns))


def _never(models: Models, choice: ModelChoice, frequency: float) -> Answer:
    raise AssertionError("a frequency is read off the model")


QUANTITIES: dict[str, tuple[Callable[..., Answer], Callable[[np.ndarray, np.ndarray], float], str, float]] = {
    "frequency": (_never, _relative, "relative", 1e-3),
    "restitution": (_collision("restitution"), _absolute, "1", 1e-2),
    "delay": (_collision("delay"), _absolute, "v/a", 2e-2),
    "kick": (_collision("kick"), _absolute, "1", 1e-2),
    "born_period": (_born_period, _mismatches, "differing periods", 0.0),
    "fold": (_fold, _of_the_same_period, "relative", 2e-2),
    "tip_trace": (_tip_trace, _best_aligned, "gap", 1e-2),
}
"""Name -> answer, error, unit of the error, usual tolerance."""
