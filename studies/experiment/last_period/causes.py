"""Causes that can turn the p11 of map, Eq. (1) and beam at 23.40 Hz into p10, each with its size.

    finite rotations   cubic terms of mode 1 (``contact.NonlinearMode``); T of small deviations at the gap
    anticlastic        energy EI K^2/2 (1 + (nu^2/60) (b^2 K/t)^2) of a sheet of width b bent to K, as a cubic
                       stiffness of mode 1: an estimate, as a clamp holds the sheet flat
    recoil             the exciter moves too (``beam.ModalModel.on_exciter``), driven by a force
    harmonic           z = Z (sin w t + r sin(n w t + p)): the tip's response to it is the motion of one more
                       mode, free and undamped, whose phi is so small that impacts do not change it

They act on Eq. (1), the exciter with phi and Gamma of the beam's mode 1, where no other description is named.
The excess counts from the amplitude at which the whole motion without impacts grazes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from beam import Backbone, FiniteRotation, ModalModel, backbone_coefficient
from contact import ImpactOscillator, NonlinearMode, State, StroboscopicMap
from contact.orbits import settle
from studies.experiment.last_period.changes import known
from studies.letter import AMPLITUDE_STABILITY, FREE_PERIOD_ERROR_S
from studies.shell.scene import (
    Scene,
    beam_at,
    nonlinear_mode_at,
    nordmark_at,
    periods_of,
    single_mode_at,
    spring_of,
)

EXCESSES = (AMPLITUDE_STABILITY, 1e-3, 4e-3, 1e-2)
"""Of the columns `born` and `others`."""

BELOW, CYCLES, SUSPENSION_RATIO, TINY = -1e-3, 8000, 0.1, 1e-6
"""Excess before a step; most drive periods; damping ratio of exciter, assumed; phi of a harmonic's mode."""

Of = Callable[[float], Any]
"""Drive frequency [Hz] to an oscillator or to a strobed map."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Distorted(StroboscopicMap):
    """A drive with a harmonic, which moves the last mode: the tip by Im(`answer` e^(i n w t)) per amplitude
    of the fundamental [1], which is `grazing` [m] where the whole motion grazes."""

    answer: complex
    grazing: float

    def at(self, excess: float) -> Distorted:
        """At another excess."""
        return replace(self, oscillator=self.oscillator.with_amplitude((1.0 + excess) * self.grazing))

    def steady(self) -> State:
        """The motion without impacts."""
        state, model = super().steady(), self.oscillator.model
        moved = self.answer * self.oscillator.driven.amplitude / model.phi[-1]
        q, rate = np.array(state.displacement), np.array(state.velocity)
        q[-1], rate[-1] = moved.imag, moved.real * model.omega[-1]
        return State(displacement=q, velocity=rate)


def distorted(of: Of, order: int, ratio: float, phase: float, frequency: float) -> Distorted:
    """`of` a drive frequency [Hz], with a harmonic of n = `order`, `ratio` r [1] and `phase` p [rad]."""
    model, w = (oscillator := of(frequency)).model, 2.0 * math.pi * order * frequency
    own = model.participation * w**2 / (model.omega**2 - w**2 + 1j * model.decay_rate * w)
    answer = complex(ratio * np.exp(1j * phase) * (model.phi @ own))
    turn = np.exp(1j * np.linspace(0.0, 2.0 * math.pi, 100_000))
    most = float(np.max((oscillator.tip_response() * turn + answer * turn**order).imag))
    more = {"omega": w, "decay_rate": 0.0, "participation": 0.0, "phi": TINY * model.phi[0]}
    rows: dict[str, Any] = {name: np.append(getattr(model, name), one) for name, one in more.items()}
    whole = replace(oscillator, model=replace(model, **rows, readouts={}))
    return Distorted(oscillator=whole, answer=answer, grazing=oscillator.stop.gap / most)


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
    """A cause in words, its free period, and its motions.

    ``motions`` has the strobed map at each of the letter's frequencies [Hz], once for each phase of a
    harmonic.
    """

    words: str
    effective_period_s: float | None
    motions: list[dict[float, Any]]


def cause_of(scene: Scene, words: str, *makes: Of) -> Cause:
    """The cause whose motions are made by `makes`."""
    letter = periods_of(scene)
    period: float | None = scene.single_mode.free_period_s
    motions = [{f: make(f) for f in letter} for make in makes]
    match motions[0][max(letter)]:
        case ImpactOscillator() as one:
            period = one.model.free_period
            motions = [{f: StroboscopicMap(oscillator=one) for f, one in motions[0].items()}]
        case NonlinearMode() as one:
            period = known(getattr, one, "effective_period")
    return Cause(words=words, effective_period_s=period, motions=motions)


def causes_of(scene: Scene, modes: ModalModel) -> list[Cause]:
    """All causes; the first three change nothing."""
    keys, gap, last, error = scene.single_mode, scene.stop.gap_m, max(periods_of(scene)), FREE_PERIOD_ERROR_S
    free, cause, beam = keys.free_period_s, partial(cause_of, scene), partial(beam_at, scene, model=modes)
    shorter, turning = scene.replace({"single_mode.free_period_s": free - error}), cubic(scene)
    found = [
        cause("map", lambda f: nordmark_at(scene, f)),
        cause("Eq. (1)", one_mode(scene)),
        cause("beam", beam),
    ]
    for sign in (-1, 1):
        rate, tau = keys.decay_rate_per_s + sign * 0.1, max(0.0, keys.restitution + sign * 0.05)
        as_period = free * (1.0 + sign * 0.005 / last)
        found += [
            cause(f"T {1e3 * sign * error:+.2f} ms", one_mode(scene, free_period_s=free + sign * error)),
            cause(f"f {sign * 0.005:+g} Hz, as a change of T", one_mode(scene, free_period_s=as_period)),
            cause(f"decay rate {sign * 0.1:+g} 1/s", one_mode(scene, decay_rate_per_s=rate)),
            cause(f"restitution {sign * 0.05:+g}", one_mode(scene, restitution=tau)),
        ]
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
    harmonics = [(n, 0.01, f"harmonic {n} of 1 %", one_mode(scene)) for n in range(2, 8)]
    harmonics += [(7, r, f"harmonic 7 of {r:.1%}, beam", beam) for r in (0.001, 0.01)]
    for n, r, words, of in harmonics:
        found.append(cause(words, *(partial(distorted, of, n, r, 0.5 * math.pi * k) for k in range(4))))
    still_base = recoiling(shorter, modes, 20, 2, still=True)
    return [
        *found,
        cause("T -0.02 ms, finite rotations", cubic_mode(shorter, turning)),
        cause("T -0.02 ms, finite rotations, gap x 1.25", cubic_mode(shorter, turning, 1.25)),
        cause("T -0.02 ms, recoil of 20 kg on 2 Hz, T on a base held still", still_base),
    ]


@dataclass(frozen=True, kw_only=True)
class Effect:
    """The periods that are born with a cause.

    Attributes
    ----------
    born : tuple of int or None
        The period at the letter's last frequency, at each of `EXCESSES` (0: not settled).
    others : tuple of int
        How many of the letter's other transitions agree there.
    p10_from, p10_to, six_from, six_to : float or None
        Least and greatest excess of a grid with p10, and with all six periods of the letter.
    gaps : tuple of int
        Excesses of the grid between these without p10, and without all six.
    """

    cause: str
    effective_period_s: float | None
    born: tuple[int | None, ...]
    others: tuple[int, ...]
    p10_from: float | None
    p10_to: float | None
    six_from: float | None
    six_to: float | None
    gaps: tuple[int, ...]


def period_of(strobed: Any, excess: float) -> int:
    """The period on which the motion settles after a step out of the motion without impacts."""
    start, proved = strobed.at(BELOW).steady(), not isinstance(strobed, Distorted)
    return settle(strobed.at(excess), start, most_cycles=CYCLES, prove=proved).period


def effect_of(scene: Scene, step: float, cause: Cause) -> Effect:
    """The effect of a cause on a grid of excesses from the letter's stability to 0.02.

    Each excess is `step` times the one before.  Of the phases of a harmonic the one that helps p10 most
    counts.
    """
    letter, grid = periods_of(scene), (EXCESSES[0] * step ** np.arange(math.log(80.0, step))).tolist()
    *five, last = sorted(letter)

    def effect(motions: Mapping[float, Any]) -> Effect:
        def right(f: float, excess: float) -> bool:
            return known(period_of, motions[f], excess) == letter[f]

        ten = [e for e in grid if right(last, e)]
        six = [e for e in ten if all(right(f, e) for f in five)]
        gaps = [sum(part[0] <= e <= part[-1] for e in grid) - len(part) if part else 0 for part in (ten, six)]
        return Effect(
            cause=cause.words,
            effective_period_s=cause.effective_period_s,
            gaps=tuple(gaps),
            p10_from=min(ten, default=None),
            p10_to=max(ten, default=None),
            six_from=min(six, default=None),
            six_to=max(six, default=None),
            born=tuple(known(period_of, motions[last], e) for e in EXCESSES),
            others=tuple(sum(right(f, e) for f in five) for e in EXCESSES),
        )

    return min(map(effect, cause.motions), key=lambda row: row.p10_from or math.inf)
