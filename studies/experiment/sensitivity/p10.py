"""What can make p10 at 23.40 Hz of the p11 of map, Eq. (1) and beam, each cause with its size.

    finite rotations   cubic terms of mode 1 (``contact.NonlinearMode``); T of small deviations at the gap
    anticlastic        energy EI K^2/2 (1 + (nu^2/60) (b^2 K/t)^2) of a sheet of width b bent to K, as a cubic
                       stiffness of mode 1: an estimate, as a clamp holds the sheet flat
    recoil             the exciter moves too (``beam.ModalModel.on_exciter``), driven by a force
    harmonic           z = Z (sin w t + r sin(n w t + p)): the tip's answer to it is the motion of one more
                       mode, free and undamped, whose phi is so small that impacts leave it alone

They act on Eq. (1), the exciter with phi and Gamma of the beam's mode 1, where no other description is named.
Excess counts from the amplitude at which the whole motion without impacts grazes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from beam import Backbone, FiniteRotation, ModalModel, backbone_coefficient
from contact import ImpactOscillator, NonlinearMode, State, StroboscopicMap
from contact.orbits import settle
from studies.experiment.sensitivity.changes import known
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


def distorted(
    of: Callable[[float], ImpactOscillator], order: int, ratio: float, phase: float, frequency: float
) -> Distorted:
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


Cause = tuple[str, float | None, list[dict[float, Any]]]
"""Words; T [s]; the strobed map at each of the letter's frequencies [Hz], for each phase of a harmonic."""


def causes_of(scene: Scene, modes: ModalModel) -> list[Cause]:
    """All of them, nothing changed in the first three."""
    keys, gap, letter, error = scene.single_mode, scene.stop.gap_m, periods_of(scene), FREE_PERIOD_ERROR_S
    free, rate, tau = keys.free_period_s, keys.decay_rate_per_s, keys.restitution
    last, beam, found = max(letter), partial(beam_at, scene, model=modes), list[Cause]()
    terms = cache(partial(cubic, scene))  # they depend neither on T nor on the gap

    def add(words: str, *makes: Callable[[float], Any]) -> None:
        made = [{f: make(f) for f in letter} for make in makes]
        one, period = made[0][last], free
        if isinstance(one, ImpactOscillator):
            period = one.model.free_period
            made = [{f: StroboscopicMap(oscillator=one) for f, one in made[0].items()}]
        found.append((words, known(getattr, one, "effective_period", period), made))

    def eq_1(period: float = free, **keys: float) -> Callable[[float], ImpactOscillator]:
        there = {f"single_mode.{name}": value for name, value in {"free_period_s": period, **keys}.items()}
        return partial(single_mode_at, scene.replace(there))

    def bent(period: float = free, wider: float = 1.0, width: float = 0.0) -> Callable[..., NonlinearMode]:
        there = scene.replace({"single_mode.free_period_s": period, "stop.gap_m": wider * gap})
        return partial(nonlinear_mode_at, there, backbone=terms(width))

    def recoil(mass: float, hz: float, held: bool, period: float = free) -> Callable[..., ImpactOscillator]:
        of, shake = eq_1(period), {"mass": mass, "suspension_hz": hz, "damping_ratio": SUSPENSION_RATIO}
        mode = replace(of(last).model, phi=modes.phi[:1], participation=modes.participation[:1])
        moving = mode.on_exciter(**shake, measured_on_it=not held)
        return lambda f: replace(of(f), model=moving)

    add("map", lambda f: nordmark_at(scene, f))
    add("Eq. (1)", eq_1())
    add("beam", beam)
    for sign in (-1, 1):
        add(f"T {1e3 * sign * error:+.2f} ms", eq_1(free + sign * error))
        add(f"f {sign * 0.005:+g} Hz, told as T", eq_1(free * (1.0 + sign * 0.005 / last)))
        add(f"decay rate {sign * 0.1:+g} 1/s", eq_1(decay_rate_per_s=rate + sign * 0.1))
        add(f"restitution {sign * 0.05:+g}", eq_1(restitution=max(0.0, tau + sign * 0.05)))
    for wider in (0.75, 1.0, 1.25, 1.5):
        add(f"finite rotations, gap {1e3 * wider * gap:.1f} mm", bent(wider=wider))
    for mm in (12, 24, 40):
        add(f"finite rotations and anticlastic, legs of {mm} mm", bent(width=1e-3 * mm))
    for held, on in ((False, "it"), (True, "a base held still")):
        for mass, hz in ((2, 2), (2, 15), (10, 2), (20, 2), (20, 15)):
            add(f"recoil of {mass} kg on {hz} Hz, T on {on}", recoil(mass, hz, held))
    phases = [0.5 * math.pi * n for n in range(4)]
    for n in range(2, 8):
        add(f"harmonic {n} of 1 %", *(partial(distorted, eq_1(), n, 0.01, turn) for turn in phases))
    for r in (0.001, 0.01):
        add(f"harmonic 7 of {r:.1%}, beam", *(partial(distorted, beam, 7, r, turn) for turn in phases))
    add("T -0.02 ms, finite rotations", bent(free - error))
    add("T -0.02 ms, finite rotations, gap x 1.25", bent(free - error, 1.25))
    add("T -0.02 ms, recoil of 20 kg on 2 Hz, T on a base held still", recoil(20, 2, True, free - error))
    return found


@dataclass(frozen=True, kw_only=True)
class Row:
    """A cause, T, what is `born` at `EXCESSES` (0: not settled), how many of the letter's `others` are there;
    least and greatest excess of a grid with p10 and with all six, and excesses without in the `gaps`."""

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
    """What a step out of the motion without impacts settles on."""
    start, proved = strobed.at(BELOW).steady(), not isinstance(strobed, Distorted)
    return settle(strobed.at(excess), start, most_cycles=CYCLES, prove=proved).period


def row_of(scene: Scene, step: float, cause: Cause) -> Row:
    """The row of a cause on a grid of excesses, each `step` times the one before, from the letter's stability
    to 0.02; of the phases of a harmonic the one that helps p10 most."""
    letter, grid = periods_of(scene), (EXCESSES[0] * step ** np.arange(math.log(80.0, step))).tolist()
    *five, last = sorted(letter)

    def row(motions: Mapping[float, Any]) -> Row:
        def right(f: float, excess: float) -> bool:
            return known(period_of, motions[f], excess) == letter[f]

        ten = [e for e in grid if right(last, e)]
        six = [e for e in ten if all(right(f, e) for f in five)]
        gaps = [sum(part[0] <= e <= part[-1] for e in grid) - len(part) if part else 0 for part in (ten, six)]
        return Row(
            cause=cause[0],
            effective_period_s=cause[1],
            gaps=tuple(gaps),
            p10_from=min(ten, default=None),
            p10_to=max(ten, default=None),
            six_from=min(six, default=None),
            six_to=max(six, default=None),
            born=tuple(known(period_of, motions[last], e) for e in EXCESSES),
            others=tuple(sum(right(f, e) for f in five) for e in EXCESSES),
        )

    return min(map(row, cause[2]), key=lambda row: row.p10_from or math.inf)
