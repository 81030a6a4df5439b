"""While one stop is touched the others are watched: a second touch is found, or refused beside some laws."""

from dataclasses import replace

import numpy as np
import pytest
from oscillators import GAMMA, OMEGA, PHI, modes_on_stop, newton, slow

from beam import Point
from contact import ImpactOscillator, PowerContact, State, Stop, TouchedAtOnce, simulate
from contact.hertz import HertzContact, HuntCrossley
from contact.laws import LinearContact

LAWS = {
    "linear": LinearContact(stiffness=4e4),
    "damped": LinearContact(stiffness=4e4, damping=20.0),
    "Hertz": HertzContact(stiffness=5e6),
    "Hunt-Crossley": HuntCrossley(stiffness=5e6, dissipation=0.5),
    "cube": PowerContact(stiffness=1e10, exponent=3.0),
    "Tsuji": PowerContact(stiffness=5e6, exponent=1.5, damping=200.0),
    "rest": newton(0.0),
}
FOLLOWED = ("linear", "damped", "rest")
ROW = np.array([7.0, -8.0, 9.0, -6.0])  # of the other point
FAR = 1.0
"""A gap that is never reached [m]."""


def pair(law, gap: float, side: int) -> ImpactOscillator:
    """Four modes; the tip before a stop with this law, another point before one of Newton's law."""
    one = modes_on_stop(OMEGA[:4], 12.0, PHI[:4], GAMMA[:4], law=law, gap=0.004, drive=(21.5, 3e-3))
    model = replace(one.model, points={"back": Point(row=ROW)})
    second = Stop(gap=gap, law=newton(0.5), at="back", side=side)
    return ImpactOscillator(model=model, stops=(one.stop, second), drive=one.drive)


def in_a_touch(law, side: int, rng: np.random.Generator) -> tuple:
    """A start at a touch, times in it, and the motion of the other point towards its stop."""
    phi, free = PHI[:4], pair(law, FAR, side)
    while True:
        q, v = 2e-4 * rng.normal(size=4), 0.03 * rng.normal(size=4)
        q, v = q + phi * (0.004 - phi @ q) / (phi @ phi), v + phi * (0.05 - phi @ v) / (phi @ phi)
        start = State(displacement=q, velocity=v, time=rng.uniform(0.0, 0.04))
        touch = simulate(free, start, duration=0.02).impacts
        i = int(np.argmax(touch.end > touch.start))
        if touch.end[i] > touch.start[i] and touch.start[i] == touch.start[0]:
            times = np.linspace(touch.start[0], touch.end[i], 4001)
            run = simulate(free, start, duration=times[-1] - start.time, times=times)
            height = side * run.displacement @ ROW
            if height.max() > max(height[0], height[-1]) + 1e-3 * np.ptp(height) and height.max() > 0.0:
                return start, times, height


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("touches", [2, *slow(8)])
def test_the_height_of_the_other_point_decides(name, side, touches):
    """The gap of the second stop is the highest position of its point in a touch, by samples of the states,
    and a little less or more."""
    rng = np.random.default_rng(list(LAWS).index(name))
    for _ in range(touches):
        start, times, height = in_a_touch(LAWS[name], side, rng)
        top, length = int(np.argmax(height)), times[-1] - start.time
        size = np.ptp(height)
        met = pair(LAWS[name], height[top] - 1e-5 * size, side)
        if name in FOLLOWED:
            i = simulate(met, start, duration=length).impacts
            time = i.start[i.stop == 1][0]
        else:
            with pytest.raises(TouchedAtOnce, match="touched at once") as caught:
                simulate(met, start, duration=length)
            time = caught.value.time
        assert time == pytest.approx(times[top], abs=0.02 * (times[-1] - times[0]))
        missed = simulate(pair(LAWS[name], height[top] + 1e-5 * size, side), start, duration=length)
        assert np.all(missed.impacts.stop == 0)
