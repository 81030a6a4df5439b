"""Where a periodic orbit ends when the drive amplitude is lowered.

The amplitude is lowered in steps that carry the physical state along.  A step succeeds if the motion settles
on an orbit of the same period with the same impacts; the step is then enlarged, otherwise halved and tried
again from the last orbit that held.  (Impacts alone would not do: below the end of a p_m orbit they can go on
for thousands of periods.)  What is left at the end is a bracket of the excess at which the orbit ends, by a
fold, a further impact or a loss of stability.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from contact.errors import ContactError
from contact.stroboscope import StrobedMap
from studies.instruments.periodicity import settle

__all__ = ["OrbitEnd", "orbit_end"]

S = TypeVar("S")

MOST_STEPS = 400
"""Bound of amplitude steps: 40 doublings reach any excess, 40 halvings any tolerance, with room to spare."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitEnd(Generic[S]):
    """The end of a p_m orbit in a downward scan.

    Parameters
    ----------
    period, impacts : int
        Of the orbit that was followed.
    held, lost : float
        Lowest excess at which the orbit held, and highest one at which it was lost [1].
    state : State
        On the orbit at `held`.
    """

    period: int
    impacts: int
    held: float
    lost: float
    state: S

    @property
    def excess(self) -> float:
        """Midpoint of the bracket [1]."""
        return 0.5 * (self.held + self.lost)


def orbit_end(
    strobed: StrobedMap[S],
    state: S,
    excess: float,
    *,
    most_cycles: int,
    relative: float = 0.01,
    absolute: float = 1e-7,
    first_step: float = 2e-4,
    lowest: float = -0.5,
) -> OrbitEnd[S] | None:
    """Follow the orbit on which `state` settles at `excess` downwards until it ends.

    Parameters
    ----------
    strobed : StrobedMap
    state : State
    excess : float
        Where to start [1].
    most_cycles : int
        Bound of the transient at each amplitude.
    relative, absolute : float
        The bracket is narrowed below `relative` of the excess itself or `absolute`, whichever is larger.
    first_step : float
        First step of the excess.
    lowest : float
        Excess below which the search is given up.

    Returns
    -------
    OrbitEnd, or None if the motion at `excess` is not periodic with impacts, or never ends above `lowest`.
    """
    start = settle(strobed.at(excess), state, most_cycles=most_cycles)
    if start.period == 0 or start.impacts == 0:
        return None
    held, state, step = excess, start.end, first_step
    lost = -1.0
    for _ in range(MOST_STEPS):
        if held - lost <= max(relative * abs(held), absolute):
            break
        trial = held - step
        if trial < lowest:
            return None
        try:
            settled = settle(strobed.at(trial), state, most_cycles=most_cycles)
            keeps = settled.period == start.period and settled.impacts == start.impacts
        except ContactError:
            keeps = False
        if keeps:
            held, state = trial, settled.end
            step *= 2.0 if trial - 2.0 * step > lost else 1.0
            lost = lost if lost < held else -1.0
        else:
            lost = trial
            step *= 0.5
            # never a step shorter than a quarter of the wanted bracket: its failure is the answer
            step = max(step, 0.25 * max(relative * abs(held), absolute))
    return OrbitEnd(period=start.period, impacts=start.impacts, held=held, lost=lost, state=state)
