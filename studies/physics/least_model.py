"""No more model than a scene needs: the least number of modes that gives a quantity to a tolerance.

    scene, sentence = least_modes(scene, {"fold": 0.07})

The reference is the spring with `REFERENCE` coupled modes, solved once; fewer modes are its truncations.
From the bottom of `LADDER` upwards the first truncation is taken whose answers differ from those of the
reference by no more than the tolerances:

    frequency K    K-th frequency of the modes that move the ball: K modes have it
    kick           of the first collision at excess 0.0065, 0.013 and 0.026, middle drive frequency; absolute
    restitution    of these collisions; absolute
    born_period    period of the orbit settled at excess 1e-3, every drive frequency; whether it differs (0)
    fold           F/F_g - 1 at the fold of p_m, every drive frequency; relative to it, or to the letter's
                   amplitude stability of 2.5e-4 where it is smaller; infinite if another p_m is born
    fold_middle    the same at the middle drive frequency
    tip_trace      tip over one period of the orbit settled at excess 0.013, middle drive frequency; root
                   mean square of the difference over the gap

Folds are those of the collision as a kick of all modes (``contact.orbits.KickFamily``), which has them to
0.2 % (median; 1 % at worst) at a hundredth of the price of following the orbits. Modes left out act on a
collision through their compliance, sum phi_k^2/omega_k^2 over the modes beyond, so that errors fall steadily
along the ladder: the least number is found by bisection, and the next one is asked as well, lest errors
cancel by chance. A quantity that the reference does not have at a frequency (no orbit, no fold) asks nothing
there. `studies.methods.adequacy` holds this choice against a search that follows every orbit.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Callable, Hashable, Iterator, Mapping
from functools import cache, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue, ModalModel
from contact import ImpactOscillator, StroboscopicMap, first_collision, simulate
from contact.orbits import born, born_period
from studies import letter
from studies.physics.descriptions import kick_fold, or_none
from studies.shell.scene import Scene, SceneError, beam_at, model_of

REFERENCE = 40
"""Coupled modes of the reference: for the letter's spring 30 have its folds to 2e-4, 60 to 1e-4."""

LADDER = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 21, 25, 30)
"""Numbers of modes that are tried."""

TRACE_EXCESS = letter.TIME_TRACE_EXCESS
COLLISIONS = (0.5 * TRACE_EXCESS, TRACE_EXCESS, 2.0 * TRACE_EXCESS)
"""Excesses of the collisions that are asked for: three, lest errors that cancel at one pass for accuracy."""

SAMPLES = 256
"""Samples of a trace in a drive period."""

Values = NDArray[np.float64]
Answer = Values | None
At = Callable[[float], ImpactOscillator]
"""The oscillator of a model at a drive frequency [Hz]."""
Distance = Callable[[Values, Values], float]
Ask = Callable[[At, float], Answer]
Fold = Callable[[StroboscopicMap, int], float | None]
Off = Callable[[int], float]
Choice = TypeVar("Choice", bound=Hashable)


def distances(ask: Callable[[Choice], Answer], distance: Distance) -> Callable[[Choice, Choice], float]:
    """How far, from the answer of a reference, that of a model is, here of numbers of modes.

    Infinite where one has no answer: `ask`, called once for each, gives None or raises ContactError or
    ValueError.
    """

    @cache
    def answer(choice: Choice) -> Answer:
        return or_none(ask, choice)  # None for a drive above all modes, too

    def off(reference: Choice, choice: Choice) -> float:
        sharp, found = answer(reference), answer(choice)
        return math.inf if found is None or sharp is None else distance(found, sharp)

    return off


def reference_of(scene: Scene) -> ModalModel:
    """The spring with as many coupled modes as `REFERENCE`, or as its mesh or its measured rates have."""
    most = REFERENCE
    if scene.damping.kind == "measured":
        most = min(most, len(scene.damping.measured_rates_per_s))
    while True:
        try:
            return model_of(scene.replace({"modes.count": most}))
        except SceneError:
            if most == 1:
                raise
            most = max(1, most // 2)


def middle_of(scene: Scene) -> float:
    """The drive frequency [Hz] in the middle of those of the scene."""
    drives = sorted(scene.drive.frequencies_hz)
    return drives[(len(drives) - 1) // 2]


def collisions(oscillator: ImpactOscillator, name: str) -> Answer:
    """`restitution`, `delay` or `kick` of the first collision at each of `COLLISIONS`."""
    values = [getattr(first_collision(oscillator.with_excess(excess)), name) for excess in COLLISIONS]
    return np.array(values) if np.all(np.isfinite(values)) else None


def tip_trace(oscillator: ImpactOscillator) -> Answer:
    """Tip over gap during one period of the orbit settled at excess 0.013; None without an orbit."""
    orbit = born(StroboscopicMap(oscillator=oscillator), TRACE_EXCESS)
    driven = oscillator.with_excess(TRACE_EXCESS)
    if orbit.period == 0 or orbit.impacts == 0:
        return None
    times = orbit.end.time + np.arange(orbit.period * SAMPLES) / SAMPLES * driven.period
    run = simulate(driven, orbit.end, periods=orbit.period, times=times)
    return driven.tip(run.displacement) / driven.stop.gap


def fold_of_born(fold: Fold, at: At, frequency: float) -> Answer:
    """Excess at which the orbit that is born has its fold, by `fold`, and its m."""
    strobed = StroboscopicMap(oscillator=at(frequency))
    period = born_period(strobed)
    end = fold(strobed, period)
    return None if end is None else np.array([end, float(period)])


def error_of_trace(answer: Values, reference: Values) -> float:
    """Root mean square of the difference; a p_m orbit has m phases, and any of them is the same orbit."""
    if answer.size != reference.size:
        return math.inf
    turns = [np.roll(answer, shift) for shift in range(0, answer.size, SAMPLES)]
    return float(min(np.sqrt(np.mean((turn - reference) ** 2)) for turn in turns))


def error_of_fold(answer: Values, reference: Values) -> float:
    """Relative to the fold, or to the letter's amplitude stability where it is smaller; infinite if m
    differs."""
    if answer[1] != reference[1]:
        return math.inf
    return float(abs(answer[0] - reference[0]) / max(abs(reference[0]), letter.AMPLITUDE_STABILITY))


def largest_error(answer: Values, reference: Values) -> float:
    """The largest absolute difference."""
    return float(np.max(np.abs(answer - reference)))


QUANTITIES: Mapping[str, tuple[Ask, Distance, bool]] = {
    "kick": (lambda at, f: collisions(at(f), "kick"), largest_error, False),
    "restitution": (lambda at, f: collisions(at(f), "restitution"), largest_error, False),
    "fold": (partial(fold_of_born, kick_fold), error_of_fold, True),
    "fold_middle": (partial(fold_of_born, kick_fold), error_of_fold, False),
    "tip_trace": (lambda at, f: tip_trace(at(f)), error_of_trace, False),
    "born_period": (
        lambda at, f: np.array([float(born_period(StroboscopicMap(oscillator=at(f))))]),
        largest_error,
        True,
    ),
}
"""Name -> answer, distance, whether it is asked at every drive frequency. Born periods are asked last:
transients are long where modes are missing."""


def questions(
    scene: Scene, needs: Mapping[str, float], whole: ModalModel
) -> Iterator[tuple[str, float, Off]]:
    """What the needs come to, where the reference, the model `whole`, has an answer: in words, the tolerance,
    and the distance of a number of modes."""
    for quantity in sorted(needs, key=list(QUANTITIES).index):
        ask, distance, everywhere = QUANTITIES[quantity]
        for frequency in sorted(scene.drive.frequencies_hz) if everywhere else [middle_of(scene)]:

            def answer(modes: int, ask: Ask = ask, frequency: float = frequency) -> Answer:
                return ask(lambda f: beam_at(scene, f, whole.truncated(modes)), frequency)

            off = partial(distances(answer, distance), whole.n_modes)
            if math.isfinite(off(whole.n_modes)):
                yield f"{quantity.removesuffix('_middle')} at {frequency:g} Hz", needs[quantity], off


def least_modes(scene: Scene, needs: Mapping[str, float]) -> tuple[Scene, str]:
    """The scene with the least number of modes for all `needs`, and why, in one sentence.

    Parameters
    ----------
    scene : Scene
        Returned as it is, with an empty sentence, if it says the number itself or has no drive or no shape.
    needs : mapping of quantity to tolerance
        Quantities and their errors are listed in the module's docstring.
    """
    if scene.modes.count or scene.spring.kind == "modal_data" or scene.drive.kind != "harmonic":
        return scene, ""
    numbers = [int(quantity.split()[1]) for quantity in needs if quantity.startswith("frequency ")]
    others = {quantity: needs[quantity] for quantity in needs if not quantity.startswith("frequency ")}
    if not others.keys() <= QUANTITIES.keys():
        known = ", ".join(QUANTITIES)
        raise InvalidValue(f"quantities are {', '.join(others)}; they must be of {known}, frequency K")
    least = max(numbers, default=1)
    reason = f"frequency {least}" if numbers else "the least there is"
    if others:
        whole = reference_of(scene)
        sharp = whole.n_modes
        rungs = sorted({*(n for n in LADDER if least < n < sharp), min(least, sharp), sharp})
        low, worst = 0, None
        for words, tolerance, off in questions(scene, others, whole):

            def enough(place: int, off: Off = off, tolerance: float = tolerance) -> bool:
                """Whether the rung with this number and the next one are near enough."""
                return all(off(n) <= tolerance for n in rungs[place : place + 2])

            if not enough(low):
                # the first rung above `low` that is good enough; the reference itself is
                low, worst = bisect(range(low, len(rungs)), False, key=enough) + low, (words, off)
        least = rungs[low]
        if least == sharp:
            reason = f"all that were tried; fewer do not give {worst[0] if worst else 'what is asked'}"
        elif worst is not None:
            reason = f"{worst[0]}, good to {worst[1](least):.1e} against {sharp} modes"
    return scene.replace({"modes.count": least}, provenance="least"), f"modes kept: {least} ({reason})"
