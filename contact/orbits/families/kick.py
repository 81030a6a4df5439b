"""A collision as a kick, and the p_m orbits that follow by linear algebra.

One collision is simulated, entered with approach velocity v from the steady motion without ringing.  It
changes the deviations of all modes by B(v), referred to the touch by their free flow.  The orbit follows from
B (``contact.orbits.families.single_impact``), and its fold is where the amplitude is smallest.  A law can
have its orbits in closed form (`repeated_touch` of ``contact.touch``).
"""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from beam.parameters import record, require, require_array, require_within, shown
from contact.flight.modal_flow import free_flow
from contact.flight.variation import variation
from contact.orbits.families.single_impact import Kick, SingleImpactFamily, SingleImpactOrbit
from contact.sensitivity.touch_flow import FEWER_TOUCHES, flow_error, flow_from_touch
from contact.touch import LAWS
from contact.touch.passage import new_touches

MOST_TOUCHES = 200  # bound of touches in one collision: a bare tip under a stiff spring makes some dozens
WINDOW = 0.5  # part of a drive period after the first touch in which further touches belong to the collision

SPEEDS = (1e-4, 1.0)
"""Approach velocities, over 2 pi f gap, among which orbits are looked for.  Faster ones belong to amplitudes
far above the letter's."""

GRID = 33  # velocities of a search, on a logarithmic grid: eight a decade


@record
class KickFamily(SingleImpactFamily):
    """The p_m orbits with one collision under any contact law, from kicks.

    A kick is the effect of one collision that starts without ringing.  With Newton's law the orbits are
    exact.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Driven oscillator with one stop and without constant load; its drive amplitude does not matter.
    m : int
        Period of the orbits in drive periods, one or more.
    collision : callable, optional
        Function of the approach velocity [m/s] that returns a Kick.  It replaces the simulated collision by
        a model, such as the letter's with its restitution and delay.  `monodromy` and `multipliers` of the
        orbits still belong to the oscillator's own collision.

    Raises
    ------
    TypeError
        If `oscillator` is no ImpactOscillator, or `m` is no number.
    ValueError
        If the oscillator has several stops, a constant load, or no drive that moves the tip.  If `m` is no
        whole number of one or more.
    """

    collision: Callable[[float], Kick] | None = None

    def kick(self, speed: float) -> Kick:
        """One collision with approach velocity `speed` [m/s], from rest.

        Where the law has it in closed form, it is the one that repeats once in m drive periods.  NotPeriodic
        is raised if it does not end within half a drive period, or its delay takes m periods.
        """
        require_within("speed", speed, "m/s", above=0)
        if self.collision is not None:
            return self.collision(speed)
        numbers = self.oscillator.numbers()
        known = LAWS[numbers.law].repeated_touch(numbers, speed, self.m)
        if known is not None:
            jump, duration, leaves = known
            return Kick(speed=speed, jump=jump, duration=duration, leaves=leaves)
        amplitude, phase = self.oscillator.drive_at(self.oscillator.stop.gap, speed)
        numbers, window = self.oscillator.with_amplitude(amplitude).numbers(), WINDOW * self.oscillator.period
        vary = variation(numbers, self.oscillator.tip_response())
        (u, v), record = np.zeros((2, numbers.size)), new_touches(MOST_TOUCHES + 1, numbers.size)
        outcome = flow_from_touch(vary, phase, u, v, window, np.empty((0, 0)), record)
        if outcome != FEWER_TOUCHES:
            raise flow_error(outcome, phase, speed, "the collision does not end within half a drive period")
        impacts = int(record.marks[0]["logged"])
        last, left = record.log[impacts - 1], record.states[impacts - 1, 1].T
        jump = np.einsum("kij,kj->ki", free_flow(numbers, -last["end"]), left)  # flown back to the touch
        leaves, duration = bool(last["rebound"] < 0.0), float(last["end"])
        return Kick(speed=speed, jump=jump, impacts=impacts, duration=duration, leaves=leaves)

    def _search(self, speeds: tuple[float, float]) -> tuple[list[float], float | None]:
        """Rising logarithms of velocities in a range over 2 pi f gap, and the one of least excess inside."""
        from scipy.optimize import minimize_scalar  # slow to import

        low, high = require_array("speeds", speeds, "[1]", shape=(2,), words="two rising numbers above zero")
        require(0.0 < low < high, f"speeds is {shown(speeds)}; it must be two rising numbers above zero")
        unit = self.oscillator.unit_speed
        grid = np.linspace(math.log(low * unit), math.log(high * unit), GRID).tolist()
        values = [self._excess(x) for x in grid]
        # a contact that is soft at low speed makes A(v) start from grazing upwards: look for minima inside
        inside = [i for i in range(1, GRID - 1) if values[i - 1] > values[i] <= values[i + 1]]
        if not inside:
            return grid, None
        i = min(inside, key=lambda k: values[k])
        bracket, options = tuple(grid[i - 1 : i + 2]), {"xtol": 1e-9}
        best = float(minimize_scalar(self._excess, bracket=bracket, method="brent", options=options).x)
        return sorted([*grid, best]), best

    def _excess(self, x: float) -> float:
        """F/F_g - 1 of the orbit with x = log v."""
        return self.excess(math.exp(x))

    def orbits(self, excess: float, speeds: tuple[float, float] = SPEEDS) -> tuple[SingleImpactOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` > -1, by rising speed, among `speeds` over 2 pi f gap."""
        from scipy.optimize import brentq  # slow to import

        require_within("excess", excess, "[1]", above=-1)

        def above(x: float) -> float:
            return self._excess(x) - excess

        places = pairwise(self._search(speeds)[0])
        roots = [brentq(above, a, b, xtol=1e-12) for a, b in places if above(a) * above(b) < 0.0]
        return tuple(self.orbit(math.exp(root)) for root in roots)

    def fold(self, speeds: tuple[float, float] = SPEEDS) -> SingleImpactOrbit | None:
        """The orbit of smallest amplitude, where the p_m orbit ends; None if it is not inside the range.

        The amplitude is searched on a logarithmic grid of approach velocities in the range `speeds`, over
        2 pi f gap, and then minimised by Brent's method.
        """
        lowest = self._search(speeds)[1]
        return None if lowest is None else self.orbit(math.exp(lowest))
