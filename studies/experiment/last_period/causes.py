"""Causes that can turn the p11 of map, Eq. (1) and beam at 23.40 Hz into p10, each with its size.

    finite rotations   cubic terms of mode 1 (``contact.NonlinearMode``); T of small deviations at the gap
    anticlastic        energy EI K^2/2 (1 + (nu^2/60) (b^2 K/t)^2) of a sheet of width b bent to K, as a cubic
                       stiffness of mode 1: an estimate, as a clamp holds the sheet flat
    recoil             the exciter moves too (``beam.ModalModel.on_exciter``), driven by a force

They act on Eq. (1), the exciter with phi and Gamma of the beam's mode 1, where no other description is named.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any

import numpy as np

from beam import Backbone, FiniteRotation, ModalModel, backbone_coefficient
from contact import ImpactOscillator, NonlinearMode, StroboscopicMap
from contact.orbits import onset_m
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S
from studies.physics.descriptions import or_none
from studies.shell.scene import (
    Scene,
    beam_at,
    nonlinear_mode_at,
    nordmark_at,
    periods_of,
    single_mode_at,
    spring_of,
)

EXCESSES = {f"at_excess_{excess:g}": excess for excess in (AMPLITUDE_STABILITY, 1e-3, 4e-3, 1e-2)}
"""Of the columns `born` and `others`, by their names."""

CYCLES, SUSPENSION_RATIO = 8000, 0.1  # most drive periods; damping ratio of the exciter, assumed

Of = Callable[[float], Any]  # drive frequency [Hz] to an oscillator or to a strobed map


def cubic(scene: Scene, width: float = 0.0) -> Backbone:
    """Cubic terms of mode 1: of finite rotations, and of a sheet of `width` b [m] that curves across."""
    spring, keys = spring_of(scene), scene.spring
    found, model = backbone_coefficient(spring), FiniteRotation.of(spring)
    bent = model.strains[2] @ model.first_mode[1]
    stiffer = (keys.poisson_ratio * width**2 / keys.thickness_m) ** 2 / 30.0
    stiffer *= float(model.bending @ bent**4) / float(model.bending @ bent**2)  # b of the cubic term [1/m^2]
    return replace(found, elastic=found.elastic + 0.375 * stiffer * found.length**2)


def one_mode(scene: Scene, **values: float) -> Of:
    """Eq. (1) with other values of keys of [single_mode]."""
    there = {f"single_mode.{key}": value for key, value in values.items()}
    return partial(single_mode_at, scene.replace(there))


def cubic_mode(scene: Scene, terms: Backbone, wider: float = 1.0) -> Of:
    """Eq. (1) with these cubic terms, the gap `wider` by a factor."""
    there = scene.replace({"stop.gap_m": wider * scene.stop.gap_m})
    return partial(nonlinear_mode_at, there, backbone=terms)


def recoiling(scene: Scene, modes: ModalModel, mass: float, hz: float, *, still: bool) -> Of:
    """Eq. (1) on an exciter of `mass` [kg] on a suspension of `hz`; T was measured on a base held `still`, or
    on the exciter."""
    own = single_mode_at(scene, max(periods_of(scene))).model
    mode = replace(own, phi=modes.phi[:1], participation=modes.participation[:1])
    shake = {"mass": mass, "suspension_hz": hz, "damping_ratio": SUSPENSION_RATIO}
    moving = mode.on_exciter(**shake, measured_on_it=not still)
    return lambda frequency: replace(single_mode_at(scene, frequency), model=moving)


@dataclass(frozen=True, kw_only=True, eq=False)
class Cause:
    """A cause in words, its free period, and its strobed map at each of the letter's frequencies [Hz]."""

    words: str
    effective_period_s: float | None
    motions: Mapping[float, Any]


def cause_of(scene: Scene, words: str, make: Of) -> Cause:
    """The cause whose motions are made by `make`."""
    letter = periods_of(scene)
    period: float | None = scene.single_mode.free_period_s
    motions = {f: make(f) for f in letter}
    match motions[max(letter)]:
        case ImpactOscillator() as one:
            period = one.model.free_period
            motions = {f: StroboscopicMap(oscillator=one) for f, one in motions.items()}
        case NonlinearMode() as one:
            period = or_none(getattr, one, "effective_period")
    return Cause(words=words, effective_period_s=period, motions=motions)


def causes_of(scene: Scene, modes: ModalModel) -> list[Cause]:
    """All causes; the first three change nothing."""
    free, gap, error = scene.single_mode.free_period_s, scene.stop.gap_m, FREE_PERIOD_ERROR_S
    cause, beam = partial(cause_of, scene), partial(beam_at, scene, model=modes)
    shorter, turning = scene.replace({"single_mode.free_period_s": free - error}), cubic(scene)
    found = [
        cause("map", lambda f: nordmark_at(scene, f)),
        cause("Eq. (1)", one_mode(scene)),
        cause("beam", beam),
    ]
    for shift in (-error, error):
        found.append(cause(f"T {1e3 * shift:+.2f} ms", one_mode(scene, free_period_s=free + shift)))
    for wider in (0.75, 1.0, 1.25, 1.5):
        words = f"finite rotations, gap {1e3 * wider * gap:.1f} mm"
        found.append(cause(words, cubic_mode(scene, turning, wider)))
    for mm in (12, 24, 40):
        words = f"finite rotations and anticlastic, legs of {mm} mm"
        found.append(cause(words, cubic_mode(scene, cubic(scene, 1e-3 * mm))))
    for still, base in ((False, "it"), (True, "a base held still")):
        for mass, hz in ((2, 2), (2, 15), (10, 2), (20, 2), (20, 15)):
            words = f"recoil of {mass} kg on {hz} Hz, T on {base}"
            found.append(cause(words, recoiling(scene, modes, mass, hz, still=still)))
    still_base = recoiling(shorter, modes, 20, 2, still=True)
    return [
        *found,
        cause("T -0.02 ms, finite rotations", cubic_mode(shorter, turning)),
        cause("T -0.02 ms, finite rotations, gap x 1.25", cubic_mode(shorter, turning, 1.25)),
        cause("T -0.02 ms, recoil of 20 kg on 2 Hz, T on a base held still", still_base),
    ]


@dataclass(frozen=True, kw_only=True)
class Effect:
    """The periods that begin with a cause, looked for at the excesses of a grid."""

    cause: str
    effective_period_s: Annotated[float | None, "free period of small deviations at the gap [s]"]
    born: Annotated[Mapping[str, int | None], "period at the last frequency; 0 where it does not settle"]
    others: Annotated[Mapping[str, int], "how many of the other transitions agree"]
    p10_from: Annotated[float | None, "least excess with p10"]
    p10_to: Annotated[float | None, "greatest excess with p10"]
    six_from: Annotated[float | None, "least excess with all six periods"]
    six_to: Annotated[float | None, "greatest excess with all six periods"]


def effect_of(scene: Scene, step: float, cause: Cause) -> Effect:
    """The effect of a cause on a grid of excesses from the letter's stability to 0.02.

    Each excess is `step` times the one before.
    """
    letter, grid = periods_of(scene), (AMPLITUDE_STABILITY * step ** np.arange(math.log(80.0, step))).tolist()
    *five, last = sorted(letter)

    def period(f: float, excess: float) -> int | None:
        return or_none(onset_m, cause.motions[f], excess, most_cycles=CYCLES)

    ten = [e for e in grid if period(last, e) == letter[last]]
    six = [e for e in ten if all(period(f, e) == letter[f] for f in five)]
    return Effect(
        cause=cause.words,
        effective_period_s=cause.effective_period_s,
        p10_from=min(ten, default=None),
        p10_to=max(ten, default=None),
        six_from=min(six, default=None),
        six_to=max(six, default=None),
        born={at: period(last, e) for at, e in EXCESSES.items()},
        others={at: sum(period(f, e) == letter[f] for f in five) for at, e in EXCESSES.items()},
    )
