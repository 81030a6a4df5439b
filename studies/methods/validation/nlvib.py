"""The response of NLvib's two masses: its turns, period doublings and tori.

The source shows an amplitude curve that overhangs, with period doublings near its top, a stable stretch at
W = 0.635 and a torus bifurcation below it, and prints no position.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from contact import simulate
from contact.orbits import Event, PeriodicOrbit, Shooting
from studies.methods.two_masses import two_masses
from studies.methods.validation.responses import drawn, followed, harmonic
from studies.methods.validation.rows import Curve, Panel, Row, Section, compared
from studies.shell.study import Run

SOURCE = "NLvib 03"
SLOW, FAST, STABLE = 0.5, 0.8, 0.635
"""W from and to which the source follows the response, and where it says it is stable."""

FULL, QUICK = (0.1, 1e-6, 400_000), (0.4, 1e-5, 50_000)
"""Longest step along the curve; distance in W at which each event is asked of simulated motions on both sides
(a third of the way to the next event, if it is closer); and their most periods."""

NUDGE, DECADES = 1e-7, 2.0
"""First distance of a simulated motion from the orbit; how far it should have grown or shrunk in the end by
the multipliers, in powers of ten."""


def simulated(event: Event, w: float, longest: int) -> float:
    """By how many powers of ten a simulated motion at W = `w`, started beside the orbit of an event, has left
    it, or come back, below zero.

    It runs as long as the multipliers need for `DECADES`; beside a fold, where one of them is 1, from the
    orbit of the fold itself as long as can be.
    """
    here, state, periods = two_masses(w), replace(event.orbit.strobe_state(), time=0.0), longest
    if event.kind != "fold":
        orbit = Shooting(oscillator=here, period=1).from_state(state)
        state = replace(orbit.strobe_state(), time=0.0)
        periods = min(math.ceil(DECADES / abs(math.log10(abs(orbit.multipliers[0])))), longest)
    end = simulate(here, replace(state, displacement=state.displacement + NUDGE), periods=periods).end
    away = np.append(end.displacement - state.displacement, end.velocity - state.velocity)
    return math.log10(np.linalg.norm(away) / NUDGE)


def size(orbit: PeriodicOrbit) -> float:
    """Amplitude of the first harmonic of mass 2, as the source draws it."""
    return abs(harmonic(orbit, "mass 2"))


def contact_begins(near: float) -> float:
    """W where the steady motion without contact reaches the gap:
    |sum phi_k f_k/(w_k^2 - W^2 + i c_k W)| = 1."""

    def reach(w: float) -> float:
        return abs(two_masses(w).tip_response()) * two_masses(w).driven.amplitude - 1.0

    return float(brentq(reach, near - 1e-3, near + 1e-3, xtol=1e-15))


def nlvib(run: Run) -> Section:
    """Rows of the events along the response curve, each by multipliers and by simulated motions."""
    step, apart, longest = QUICK if run.quick else FULL
    branch = followed(two_masses, STABLE, low=SLOW, high=FAST, step=step)
    w, sizes = np.array(branch.parameters), np.array([size(orbit) for orbit in branch.orbits])
    leading = np.array([orbit.multipliers[0] for orbit in branch.orbits])
    rows = [*claims(w, sizes, leading)]
    places = np.array([event.parameter for event in branch.events], dtype=float)
    for event, place in zip(branch.events, run.track(places, "events of two masses"), strict=True):
        if event.kind == "grazing":
            off = abs(contact_begins(place) - place)
            rows.append(
                compared(
                    SOURCE,
                    "W where contact begins",
                    None,
                    place,
                    None,
                    f"{place:.10f}; closed form {off:.0e} away",
                    holds=off < 1e-9,
                )
            )
            continue
        aside = min(apart, *(abs(places[places != place] - place) / 3.0))
        left = [simulated(event, place + side * aside, longest) for side in (-1.0, 1.0)]
        words = f"{place:.10f}; motions at W -+ {aside:.0e} go off by 10^{left[0]:.1f} and 10^{left[1]:.1f}"
        holds = max(left) - min(left) > 1.0 and (event.kind == "fold" or min(left) < 0.0)
        rows.append(compared(SOURCE, f"W of a {event.kind}", None, place, note=words, holds=holds))
    curves = drawn(branch, size)
    for look, kind in enumerate(("fold", "period doubling", "torus", "grazing"), start=3):
        met = [i for i, event in enumerate(branch.events) if event.kind == kind]
        heights = [size(branch.events[i].orbit) for i in met]
        curves.append(Curve(x=places[met], y=heights, name=kind, look=look, line=False))
    frequency = ("drive frequency W", "rad/s")
    return Section(
        rows=rows,
        panels=[
            Panel(title="response", x=frequency, y=("first harmonic of mass 2", "1"), curves=curves),
            Panel(
                title="stability",
                x=frequency,
                y=("largest multiplier", "1"),
                curves=[Curve(x=w, y=np.abs(leading))],
            ),
        ],
        caption="Two masses and a one-sided spring (NLvib 03): response of period 1 and its bifurcations.",
    )


def claims(w: np.ndarray, size: np.ndarray, leading: np.ndarray) -> Iterator[Row]:
    """What the source says of three points of its curve."""
    top = int(np.argmax(size))
    words, highest = f"beyond a period doubling; at W = {w[top]:.4f}", float(leading[top].real)
    yield compared(
        SOURCE, "multiplier at the largest response", None, highest, holds=highest < -1.0, note=words
    )
    for place, words, holds in (
        (STABLE, "stable", lambda m: abs(m) < 1.0),
        (0.6, "beyond a torus bifurcation", lambda m: abs(m) > 1.0 and m.imag != 0.0),
    ):
        m = leading[np.argmin(np.abs(w - place))]
        yield compared(SOURCE, f"largest multiplier at W = {place}", None, abs(m), holds=holds(m), note=words)
