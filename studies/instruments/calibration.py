"""Fitting what the letter leaves open to what it prints.

Each number that was measured fixes one key of the scene:

    free period T = 2 pi / sqrt(omega_1^2 - (c_1/2)^2)    ->  thickness of the sheet
    decay rate c_1 of mode 1                              ->  loss factor, thickness or coverage of the tape
    a collision that stops mode 1 (kick 1)                ->  mass of ball and mount      (needs collisions)
    drive amplitude at grazing                            ->  gap                         (needs the drive)

    scene = calibrate(scene, free_period_s=40.80e-3, decay_rate_per_s=3.56)

T [s] is the period of the damped free motion and omega_1, c_1 belong to the first coupled mode. With
damping.kind strips its rate follows from the strain energies U_i stored in stretching and bending of the
pieces (C. D. Johnson and D. A. Kienholz, AIAA J. 20 (1982) 1284),

    c_1 = omega_1 sum_i eta_i U_i / sum_i U_i     [1/s],

eta_i the loss factor [1] of the section in stretching or in bending.

`solve_for` is the one way in which a key is fitted: any quantity of a scene that varies continuously with any
key that is a number. The value found carries the provenance "calibrated".
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from beam import SuspiciousValue
from studies.instruments.quantities import CALIBRATED, SceneError, keys_of
from studies.instruments.scene import SECTIONS, Scene, split
from studies.instruments.spring_of_scene import damping_of, modes_of

ACCURACY = 1e-10
"""Largest relative deviation of a calibrated quantity from its target; computed ones repeat to 1e-12."""

SHAPE_ACCURACY = 5e-8
"""The same for a tape fitted by thickness or coverage: its share of the energy has the error of the mode
shape, not its square."""

KEY_TOLERANCE = 1e-13
"""Relative tolerance of Brent's method on the key; quantities vary with a low power of it."""

BEYOND = 1e9
"""Stands for an infinite deviation: the search needs its sign only."""

THINNEST = 0.02
"""The sheet is looked for from this part of its present thickness on."""

LOSS_FACTORS = (1e-9, 5.0)
COVERAGES = (0.02, 0.98)
TAPE_FACTORS = (0.01, 5.0)
"""Where the tape is looked for: its loss factor, its part of a leg (a piece shorter than an element would
cost digits), its thickness over the present one."""

MOST_STEPS = 200
"""Of Brent's method: four times the bisections that pin down a double."""

MOST_ROUNDS = 40
"""Of fitting the period and the damping in turn: each shifts the other by a small part of its own change."""

TAPE_KEYS = ("spring.tape_loss_factor", "spring.tape_thickness_m", "spring.tape_coverage")
"""Keys that can carry the damping of mode 1."""

RATE_KEYS = {
    "constant_ratio": ("damping.ratio",),
    "constant_loss_factor": ("damping.loss_factor",),
    "rayleigh": ("damping.rayleigh_alpha_per_s", "damping.rayleigh_beta_s"),
    "measured": ("damping.measured_rates_per_s",),
}
"""For each other damping.kind the keys to which the rates are proportional."""


def solve_for(
    key: str,
    scene: Scene,
    quantity: Callable[[Scene], float],
    target: float,
    *,
    name: str,
    unit: str,
    low: float,
    high: float,
    accuracy: float = ACCURACY,
) -> Scene:
    """The scene with `key` such that `quantity(scene)` is `target`, to the relative `accuracy`.

    Parameters
    ----------
    key : dotted key, a number.
    quantity : continuous in the key; may be infinite.
    target : [unit], greater than 0.
    name, unit : of the quantity, for the sentence that says why there is no solution.
    low, high : interval of the key; the quantity must be on opposite sides of the target at its ends.
    """
    _require_target(name, target, unit)
    section, entry = split(key)
    key_unit = keys_of(SECTIONS[section])[entry][1].unit

    def changed(value: float) -> Scene:
        return scene.replace({key: value}, provenance=CALIBRATED)

    def excess(value: float) -> float:
        with warnings.catch_warnings():  # nobody gave the values that a search tries
            warnings.simplefilter("ignore", SuspiciousValue)
            return min(quantity(changed(value)) / target - 1.0, BEYOND)

    at_low, at_high = excess(low), excess(high)
    if not at_low * at_high <= 0.0:
        least, most = sorted((1.0 + at_low, 1.0 + at_high))
        raise SceneError(
            f"no {key} between {low:.6g} and {high:.6g} (unit {key_unit}) gives a {name} of {target:.10g} "
            f"{unit}: at the ends it is {least * target:.6g} and {most * target:.6g} {unit}"
        )
    value = brentq(excess, low, high, xtol=KEY_TOLERANCE * high, rtol=KEY_TOLERANCE, maxiter=MOST_STEPS)
    if not abs(excess(value)) <= accuracy:
        raise SceneError(
            f"{key} cannot be calibrated: the {name} jumps across {target:.10g} {unit} at {value:.10g} "
            f"(unit {key_unit})"
        )
    return changed(value)


def free_period(scene: Scene) -> float:
    """Period of the damped free motion of mode 1 [s]; infinite if it does not swing."""
    modes = modes_of(scene, 1)
    rate = float(damping_of(scene).decay_rates(modes)[-1])
    square = float(modes.omega[-1]) ** 2 - (0.5 * rate) ** 2
    return 2.0 * math.pi / math.sqrt(square) if square > 0.0 else math.inf


def strip_decay_rate(scene: Scene) -> float:
    """c_1 from the strain energies of sheet and tape alone [1/s], whatever damping.kind says."""
    modes = modes_of(scene, 1)
    pieces = modes.discretization.pieces
    energies = modes.discretization.strain_energies(modes.shapes[:, -1:])[..., 0]
    loss_factors = [
        [piece.section.axial_loss_factor for piece in pieces],
        [piece.section.bending_loss_factor for piece in pieces],
    ]
    return float(modes.omega[-1] * np.sum(loss_factors * energies) / np.sum(energies))


def decay_rate(scene: Scene) -> float:
    """c_1 of the model [1/s]; with damping.kind strips the one that its tape gives by itself."""
    if scene.damping.kind == "strips":
        return strip_decay_rate(scene)
    return float(damping_of(scene).decay_rates(modes_of(scene, 1))[-1])


def calibrate_thickness(scene: Scene, free_period_s: float) -> Scene:
    """The scene with the sheet so thick that mode 1, damped, has this period [s]."""
    keys = scene.spring
    thickest = keys.width_m
    if keys.kind == "folded_u":
        thickest = min(thickest, 1.999 * keys.bend_radius_m)
    return solve_for(
        "spring.thickness_m",
        scene,
        free_period,
        free_period_s,
        name="free period",
        unit="s",
        low=min(keys.thickness_m, thickest) * THINNEST,
        high=thickest,
    )


def calibrate_damping(scene: Scene, decay_rate_per_s: float, key: str = TAPE_KEYS[0]) -> Scene:
    """The scene in which mode 1 decays at this rate [1/s].

    With damping.kind strips the tape is chosen by `key`, one of `TAPE_KEYS`, such that the strain energies
    give the rate without further scaling. For any other kind all its rates are scaled by one factor.
    """
    name, unit = "decay rate of mode 1", "1/s"
    _require_target(name, decay_rate_per_s, unit)
    if scene.damping.kind != "strips":
        return _scaled_rates(scene, decay_rate_per_s)
    if key not in TAPE_KEYS:
        raise SceneError(f"the damping of mode 1 is calibrated by {', '.join(TAPE_KEYS)}, not by {key}")
    low, high = _tape_range(scene, key)
    scene = scene.replace({"damping.decay_rate_per_s": decay_rate_per_s}, provenance=CALIBRATED)
    return solve_for(
        key,
        scene,
        decay_rate,
        decay_rate_per_s,
        name=name,
        unit=unit,
        low=low,
        high=high,
        accuracy=ACCURACY if key == TAPE_KEYS[0] else SHAPE_ACCURACY,
    )


def calibrate(
    scene: Scene, *, free_period_s: float, decay_rate_per_s: float, key: str = TAPE_KEYS[0]
) -> Scene:
    """The scene with both, thickness and damping fitted in turn until neither moves the other."""
    for _ in range(MOST_ROUNDS):
        scene = calibrate_damping(calibrate_thickness(scene, free_period_s), decay_rate_per_s, key)
        if abs(free_period(scene) / free_period_s - 1.0) <= ACCURACY:
            return scene
    raise SceneError(
        f"spring.thickness_m and {key} cannot be calibrated together: a free period of {free_period_s:.10g} "
        f"s and a decay rate of {decay_rate_per_s:.10g} 1/s do not settle in {MOST_ROUNDS} rounds"
    )


def _scaled_rates(scene: Scene, target: float) -> Scene:
    rate = decay_rate(scene)
    if not rate > 0.0:
        raise SceneError(
            f"damping.kind {scene.damping.kind} gives mode 1 a decay rate of {rate:.6g} 1/s, which no "
            f"scaling turns into {target:.10g} 1/s: change {' or '.join(RATE_KEYS[scene.damping.kind])}"
        )
    changes: dict[str, object] = {}
    for key in RATE_KEYS[scene.damping.kind]:
        value, factor = scene[key], target / rate
        changes[key] = tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value
    return scene.replace(changes, provenance=CALIBRATED)


def _tape_range(scene: Scene, key: str) -> tuple[float, float]:
    """Where a key of the tape is looked for."""
    if scene.spring.tape_thickness_m == 0.0:
        raise SceneError("there is no tape to calibrate: spring.tape_thickness_m must be greater than 0")
    present = scene.spring.tape_thickness_m
    return {
        "spring.tape_loss_factor": LOSS_FACTORS,
        "spring.tape_coverage": COVERAGES,
        "spring.tape_thickness_m": (TAPE_FACTORS[0] * present, TAPE_FACTORS[1] * present),
    }[key]


def _require_target(name: str, target: float, unit: str) -> None:
    if not (math.isfinite(target) and target > 0.0):
        raise SceneError(f"the {name} to fit must be finite and greater than 0 (unit {unit}), not {target}")
