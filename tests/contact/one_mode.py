"""One mode under Newton's law in any scaling, and its drive periods by the fast and the general loop."""

import math

import numpy as np
from oscillators import modes_on_stop, newton

from contact import ImpactOscillator, State
from contact.engine.event_loop import DONE, advance
from contact.engine.recorder import strobes_only
from contact.engine.start import start_of
from contact.flight.elementary import EPS
from contact.maps.strobed_motion import strobed_system
from contact.one_mode.loop import one_mode_periods
from contact.state import IMPACT
from contact.touch.passage import TOUCH

GAP = 0.01
OMEGA = 2.0 * math.pi / 40.80e-3
FREQUENCIES = (20.90, 21.50, 22.20, 22.60, 23.05, 23.40)
DAMPINGS = {"undamped": 0.0, "letter": 3.56, "strong": 150.0, "over-damped": 2.5 * OMEGA}


def oscillator(
    frequency: float = 22.2,
    *,
    tau: float = 0.1,
    decay: float = 3.56,
    excess: float = 0.02,
    phi: float = 1.0,
    participation: float | None = None,
) -> ImpactOscillator:
    """Eq. (1) of the letter in any scaling of its mode."""
    omega = math.hypot(OMEGA, decay / 2) if decay < 2 * OMEGA else OMEGA
    gamma = 1.0 / phi if participation is None else participation
    single = modes_on_stop(omega, decay, phi, gamma, law=newton(tau), gap=GAP, drive=frequency)
    return single.with_excess(excess)


class Period:
    """One drive period after the other, by both loops from the same deviation."""

    def __init__(self, single: ImpactOscillator) -> None:
        self.system = strobed_system(single)
        self.numbers, self.table = self.system.numbers, self.system.table
        assert self.table is not None
        self.log, self.log_state = np.empty(110_000, dtype=TOUCH), np.empty((110_000, 4))

    def fast(self, u, v, runs):
        """Status, impacts and periods left; the arrays are overwritten."""
        counts = np.zeros(1, dtype=np.int64)
        given = self.table, self.system, np.empty(0), u, v, runs, np.empty((1, 2)), counts
        status, left = one_mode_periods(*given)
        return status, int(counts[0]), left

    def general(self, u, v, runs):
        """Status, impacts and approach velocities."""
        counts = np.zeros(1, dtype=np.int64)
        recorder = strobes_only(np.empty((1, 2)), counts)._replace(log=self.log, log_state=self.log_state)
        status = advance(self.numbers, u, v, runs, int(runs[0]["stretch"]) + 1, 0.0, recorder, None, None)
        rows = self.log[: recorder.marks[0]["logged"]]
        return status, int(counts[0]), rows["approach"][rows["kind"] == IMPACT]

    def size(self, u, v) -> float:
        """Deviation in the norm whose square never grows [m]."""
        m = self.numbers
        return abs(m.phi[0]) * math.hypot(u[0], v[0] / m.omega[0])

    def compare(self, u, v, periods: int) -> tuple[float, int, int]:
        """Follow the general loop, each period also by the fast one: worst error, impacts, left.

        The error is that of the strobed state in roundings, over what the impacts make of one rounding: an
        impact at speed s turns an error d of the tip displacement into (1 + tau) a d/s of its velocity, a the
        greatest acceleration.
        """
        m, runs = self.numbers, at_a_strobe()
        worst, impacts, lefts = 0.0, 0, 0
        for _ in range(periods):
            ours = (u.copy(), v.copy(), runs.copy())
            start = self.size(u, v)
            status, count, speeds = self.general(u, v, runs)
            mine, mine_count, left = self.fast(*ours)
            assert mine == status
            if status != DONE:
                break
            assert mine_count == count
            names = ["regime", "contact_order", "stretch", "clock"]
            assert ours[2][0][names] == runs[0][names]
            scale = max(abs(m.level) + math.hypot(m.tip_sine, m.tip_cosine), start, self.size(u, v))
            fastest = max(m.drive, m.omega[0], m.decay[0])
            growth = np.sum(np.log1p((1.0 + m.number0) * fastest * scale / speeds))
            if not left and growth < 25.0:
                off = self.size(ours[0] - u, ours[1] - v) / scale
                worst = max(worst, off / EPS / math.exp(growth))
            impacts += count
            lefts += left
        return worst, impacts, lefts


def at_a_strobe() -> np.ndarray:
    """A run that starts at a strobe, off the wall."""
    return start_of(oscillator().numbers(), State.rest(1), 0, 0.0)[2]


ROUNDINGS = 40.0
"""Roundings by which the two loops may differ in a period: both make some ten operations on each term of the
motion in each of a flight's parts; the worst seen in two million periods is 11."""


def compared(single: ImpactOscillator, periods: int) -> tuple[int, int]:
    """Impacts, and periods that the fast loop leaves to the general one, of motions from rest that agree."""
    u, v, _ = start_of(single.numbers(), State.rest(1), 0, 0.0)
    worst, impacts, left = Period(single).compare(u, v, periods)
    assert worst < ROUNDINGS
    return impacts, left
