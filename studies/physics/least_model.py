"""No more model than a scene needs: the least number of modes that gives a quantity to a tolerance.

    scene, sentence = least_modes(scene, {"fold": 0.07})

The reference is the spring with `REFERENCE` coupled modes, solved once; fewer modes are its truncations.
From the bottom of `LADDER` upwards the first truncation is taken whose answers differ from the answers of the
reference by no more than the tolerances:

    frequency K    K-th frequency of the modes that move the ball: K modes have it
    response       grazing amplitude, middle drive frequency; relative
    kick           of the first collision at half, once and twice the excess, middle drive frequency; absolute
    restitution    of these collisions; absolute
    born_period    period and impacts of the orbit settled at scan.born_excess, every drive frequency;
                   whether they differ (0)
    fold           F/F_g - 1 at the fold of p_m, every drive frequency; relative to it, or to the letter's
                   amplitude stability of 2.5e-4 where it is smaller; infinite if another p_m is born, or
                   one with several impacts
    fold_middle    the same at the middle drive frequency
    tip_trace      tip over one period of the orbit settled at the excess, middle drive frequency; root
                   mean square of the difference over the gap, infinite if impacts differ in number

The command gives drive frequencies, excess and law; the excess is 0.013 where it gives none.

Folds come from the collision as a kick of all modes (``contact.orbits.KickFamily``), which has them to
0.2 % (median; 1 % at worst) at a hundredth of the price of following the orbits. Modes left out act on a
collision through their compliance, sum phi_k^2/omega_k^2 over the modes beyond, so that errors fall steadily
along the ladder: the least number is found by bisection, and the next one is tried as well, lest errors
cancel by chance. Where the reference lacks a quantity (no orbit, no fold), the quantities of `ALWAYS` are
compared there. Where it lacks a first collision too, all its modes are kept. The modes kept always reach
above the fastest drive. `studies.methods.adequacy` holds this choice against a search that follows every
orbit.
"""

import math
from bisect import bisect
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from beam import InvalidValue, ModalModel
from contact import ImpactOscillator, StroboscopicMap, first_collision, simulate
from contact.orbits import onset_orbit
from studies import letter
from studies.physics.descriptions import kick_fold, or_none
from studies.shell.scene import Scene, SceneError, beam_at, model_of, periods_of

REFERENCE = 40
"""Coupled modes of the reference: for the letter's spring 30 have its folds to 2e-4, 60 to 1e-4."""

LADDER = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 15, 18, 21, 25, 30)  # numbers of modes that are tried

TRACE_EXCESS, BORN = letter.TIME_TRACE_EXCESS, 1e-3
COLLISIONS = (0.5 * TRACE_EXCESS, TRACE_EXCESS, 2.0 * TRACE_EXCESS)
"""Excesses of the collisions that are compared: three, lest errors that cancel at one pass for accuracy."""

ALWAYS = {"response": 1e-3, "kick": 0.005, "restitution": 0.01}
"""Quantities, with tolerances, that take the place of one that the reference lacks."""

SAMPLES = 256  # samples of a trace in a drive period

Values = NDArray[np.float64]
Answer = Values | None
At = Callable[[float], ImpactOscillator]  # the oscillator of a model at a drive frequency [Hz]
Distance = Callable[[Values, Values], float]
AnswerOf = Callable[..., Answer]  # of a model at a drive frequency [Hz] and, if given, an excess [1]
Fold = Callable[[StroboscopicMap, int], float | None]
Off = Callable[[int], float]
Choice = TypeVar("Choice", bound=Hashable)


def distances(answer_of: Callable[[Choice], Answer], distance: Distance) -> Callable[[Choice, Choice], float]:
    """How far, from the answer of a reference, that of a model is, here of numbers of modes.

    Infinite where one has no answer: `answer_of`, called once for each, gives None or raises ContactError or
    ValueError.
    """

    @cache
    def answer(choice: Choice) -> Answer:
        return or_none(answer_of, choice)  # None for a drive above all modes, too

    def off(reference: Choice, choice: Choice) -> float:
        sharp, found = answer(reference), answer(choice)
        return math.inf if found is None or sharp is None else distance(found, sharp)

    return off


def reference_of(scene: Scene) -> ModalModel:
    """The spring with as many coupled modes as `REFERENCE`, or as its mesh or its measured rates have."""
    most, refused = REFERENCE, None
    if scene.damping.kind == "measured":
        most = min(most, len(scene.damping.measured_rates_per_s))
    while True:
        try:
            return model_of(scene.replace({"modes.count": most}))
        except SceneError as error:
            refused = refused or error
            if most == 1:
                raise refused from None
            most = max(1, most // 2)


def middle_of(scene: Scene) -> float:
    """The drive frequency [Hz] in the middle of the drives of the scene."""
    drives = sorted(scene.drive.frequencies_hz)
    return drives[(len(drives) - 1) // 2]


def collisions(name: str, at: At, frequency: float, excess: float = TRACE_EXCESS) -> Answer:
    """`restitution`, `delay` or `kick` of the first collision at `COLLISIONS`, in proportion to `excess`."""
    struck = [at(frequency).with_excess(each * excess / TRACE_EXCESS) for each in COLLISIONS]
    values = [getattr(first_collision(oscillator), name) for oscillator in struck]
    return np.array(values) if np.all(np.isfinite(values)) else None


def tip_trace(at: At, frequency: float, excess: float = TRACE_EXCESS) -> Answer:
    """Impacts of the orbit settled at `excess`, and tip over gap during one period; 0 without an orbit."""
    oscillator = at(frequency)
    orbit = onset_orbit(StroboscopicMap(oscillator=oscillator), excess)
    driven = oscillator.with_excess(excess)
    if orbit.m == 0:
        return np.zeros(1)
    times = orbit.end.time + np.arange(orbit.m * SAMPLES) / SAMPLES * driven.period
    run = simulate(driven, orbit.end, periods=orbit.m, times=times)
    return np.append(orbit.impacts, driven.tip(run.displacement) / driven.stop.gap)


def born_at(at: At, frequency: float, excess: float = BORN) -> Answer:
    """Period and impacts of the orbit that settles at `excess`; both are 0 without an orbit."""
    orbit = onset_orbit(StroboscopicMap(oscillator=at(frequency)), excess)
    return np.array([orbit.m, orbit.impacts], dtype=float) * (orbit.m > 0)


def fold_of_born(fold: Fold, at: At, frequency: float, excess: float = BORN) -> Answer:
    """Excess at which the orbit that settles at `excess` has its fold, by `fold`, and its m.

    Orbits with several impacts mostly end otherwise: then the excess is not a number.
    """
    strobed = StroboscopicMap(oscillator=at(frequency))
    orbit = onset_orbit(strobed, excess)
    end = math.nan if orbit.m > 1 and orbit.impacts > 1 else fold(strobed, orbit.m)
    return None if end is None else np.array([end, float(orbit.m)])


def error_of_trace(answer: Values, reference: Values) -> float:
    """Root mean square of the difference; infinite if periods or impacts differ.

    A p_m orbit has m phases, and any of them is the same orbit.
    """
    if answer.size != reference.size or answer[0] != reference[0]:
        return math.inf
    if answer.size == 1:
        return 0.0
    turns = [np.roll(answer[1:], shift) for shift in range(0, answer.size - 1, SAMPLES)]
    return float(min(np.sqrt(np.mean((turn - reference[1:]) ** 2)) for turn in turns))


def error_of_fold(answer: Values, reference: Values) -> float:
    """Relative to the fold, or to the letter's amplitude stability where it is smaller; infinite if m
    differs, and for another model of an orbit without a fold."""
    if answer is reference:
        return 0.0
    if answer[1] != reference[1] or math.isnan(answer[0] - reference[0]):
        return math.inf
    return float(abs(answer[0] - reference[0]) / max(abs(reference[0]), letter.AMPLITUDE_STABILITY))


def largest_error(answer: Values, reference: Values) -> float:
    """The largest absolute difference."""
    return float(np.max(np.abs(answer - reference)))


def relative_error(answer: Values, reference: Values) -> float:
    """The largest difference over the reference."""
    return largest_error(answer / reference, reference / reference)


QUANTITIES: Mapping[str, tuple[AnswerOf, Distance, bool, bool]] = {
    "response": (lambda at, f, _=0.0: np.array([at(f).grazing_amplitude()]), relative_error, False, False),
    "kick": (partial(collisions, "kick"), largest_error, False, False),
    "restitution": (partial(collisions, "restitution"), largest_error, False, False),
    "fold": (partial(fold_of_born, kick_fold), error_of_fold, True, True),
    "fold_middle": (partial(fold_of_born, kick_fold), error_of_fold, False, True),
    "tip_trace": (tip_trace, error_of_trace, False, False),
    "born_period": (born_at, largest_error, True, True),
}
"""Name -> answer, distance, whether it is needed at every drive frequency, and whether at scan.born_excess.
Born periods come last: transients are long where modes are missing."""


class Question(NamedTuple):
    """A quantity at a drive frequency, `words`, its tolerance, and the distance of a number of modes.

    `lacking` is the quantity whose place it takes, and the frequency, as text.
    """

    words: str
    tolerance: float
    off: Off
    lacking: tuple[str, str] = ("", "")


def questions(
    scene: Scene, needs: Mapping[str, float], whole: ModalModel, excess: float = TRACE_EXCESS
) -> Iterator[Question]:
    """The questions of the needs, or of `ALWAYS` where the reference, the model `whole`, lacks one."""
    lacking = dict[float, tuple[str, str]]()

    def off_of(quantity: str, frequency: float) -> Off:
        answer_of, distance, _, born = QUANTITIES[quantity]

        def answer(modes: int) -> Answer:
            there = scene.scan.born_excess if born else excess
            return answer_of(lambda f: beam_at(scene, f, whole.truncated(modes)), frequency, there)

        return partial(distances(answer, distance), whole.n_modes)

    drives = sorted(scene.drive.frequencies_hz)
    for quantity in sorted(needs, key=list(QUANTITIES).index):
        name = quantity.removesuffix("_middle")
        for frequency in drives if QUANTITIES[quantity][2] else [middle_of(scene)]:
            off = off_of(quantity, frequency)
            if math.isfinite(off(whole.n_modes)):
                yield Question(f"{name} at {frequency:g} Hz", needs[quantity], off)
            else:
                lacking.setdefault(frequency, (name.replace("_", " "), f"{frequency:g}"))
    for frequency, words in lacking.items():
        for name, tolerance in ALWAYS.items():
            off = off_of(name, frequency)
            if math.isfinite(off(whole.n_modes)) or (name == "kick" and excess > 0.0):
                yield Question(f"{name} at {frequency:g} Hz", tolerance, off, words)


def at_letters_drives(scene: Scene, _: Mapping[str, object]) -> tuple[list[float], float]:
    """The drive frequencies [Hz] with the f T of the letter's six, for studies that scan their range."""
    return list(periods_of(scene)), TRACE_EXCESS


def least_modes(
    scene: Scene, needs: Mapping[str, float], frequencies: Sequence[float] = (), excess: float = TRACE_EXCESS
) -> tuple[Scene, str]:
    """The scene with the least number of modes for all `needs`, and why, in one sentence.

    Parameters
    ----------
    scene : Scene
        Returned as it is, with an empty sentence, if it says the number itself or has no drive or no shape.
    needs : mapping of quantity to tolerance
        Quantities and their errors are listed in the module's docstring.
    frequencies, excess : list of float, float
        Drive frequencies [Hz], by default of the scene, and excess [1] of the command.
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
        drives = frequencies or scene.drive.frequencies_hz
        there = scene.replace({"drive.frequencies_hz": tuple(drives)})
        whole = reference_of(there)
        sharp, fastest = whole.n_modes, max(*drives, *scene.drive.frequencies_hz)
        least = max(least, int(np.searchsorted(whole.frequencies_hz, fastest)) + 1)
        rungs = sorted({*(n for n in LADDER if least < n < sharp), min(least, sharp), sharp})
        low, worst, lacking = 0, None, dict[str, dict[str, None]]()
        for question in questions(there, others, whole, excess):
            lacking.setdefault(question.lacking[0], {})[question.lacking[1]] = None

            def enough(place: int, question: Question = question) -> bool:
                """Whether the rung with this number and the next one are near enough."""
                return all(question.off(n) <= question.tolerance for n in rungs[place : place + 2])

            if not enough(low):
                # the first rung above `low` that is good enough, or else the reference
                low, worst = bisect(range(low, len(rungs) - 1), False, key=enough) + low, question
        least = rungs[low]
        if least == sharp:
            reason = f"all that were tried, for {worst.words if worst else 'the drive'}"
        elif worst is not None:
            reason = f"{worst.words}, good to {worst.off(least):.1e} against {sharp} modes"
        for name, at in lacking.items():
            if name:
                reason += f"; no {name} at {', '.join(at)} Hz: response and first collision compared there"
    return scene.replace({"modes.count": least}, provenance="least"), f"modes kept: {least} ({reason})"
