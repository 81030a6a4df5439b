"""Fitting what the letter leaves open to what it prints.

Each number that was measured fixes one key of the scene:

    free period T = 2 pi / sqrt(omega_1^2 - (c_1/2)^2)    ->  thickness of the sheet
    decay rate c_1 of mode 1                              ->  loss factor of the tape
    a collision that stops mode 1 (kick 1)                ->  mass of ball and mount      (needs collisions)
    drive amplitude at grazing                            ->  gap                         (needs the drive)

    scene = calibrate(scene, free_period_s=40.80e-3, decay_rate_per_s=3.56)

T [s] is the period of the damped free motion and omega_1, c_1 belong to the first coupled mode. With
damping.kind strips its rate follows from the strain energies U_i stored in stretching and bending of the
pieces (C. D. Johnson and D. A. Kienholz, AIAA J. 20 (1982) 1284),

    c_1 = omega_1 sum_i eta_i U_i / sum_i U_i     [1/s],

eta_i the loss factor [1] of the section in stretching or in bending.

A kick of 1 takes all velocity from mode 1, which makes the restitution smallest; the kick grows with the
mass. Each trial mass goes with the sheet thickness, the tape and the gap that keep the other three numbers.

`solve_for` is the one way in which a key is fitted: any quantity of a scene that varies continuously with any
key that is a number. The value found carries the provenance "calibrated".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import brentq

from contact import Collision, first_collision
from studies import letter
from studies.physics.least_model import middle_of
from studies.physics.parameters import through_any_value
from studies.shell.scene import Scene, SceneError, beam_at, damping_of, free_period, modes_of, spring_of
from studies.shell.scene.key import CALIBRATED
from studies.shell.scene.spring import DAMPING
from studies.shell.scene.values import KEYS

ACCURACY = 1e-10
"""Largest relative deviation of a calibrated quantity from its target; computed ones repeat to 1e-12."""

KEY_TOLERANCE = 1e-13
"""Relative tolerance of Brent's method on the key; quantities vary with a low power of it."""

BEYOND = 1e9  # replaces an infinite deviation: the search needs its sign only

THINNEST, LOSS_FACTORS, MASSES = 0.02, (1e-9, 5.0), (0.3, 3.0)
"""Where is looked: thickness of the sheet over the present one, from; loss factor of the tape; mass of the
ball over the present one."""

MOST_STEPS, MOST_ROUNDS = 200, 40
"""Of Brent's method, four times the bisections that pin down a double; of fitting period and damping in
turn: each shifts the other by a small part of its own change."""

KICK_ACCURACY = 1e-9
"""Relative accuracy of the fitted kick: a collision repeats to 1e-11, the spring behind it to 1e-10."""


def solve_for(
    key: str,
    scene: Scene,
    quantity: Callable[[Scene], float],
    target: float,
    *,
    name: str,
    unit: str,
    between: tuple[float, float],
    accuracy: float = ACCURACY,
) -> Scene:
    """The scene with `key` such that `quantity(scene)` is `target`, to the relative `accuracy`.

    Parameters
    ----------
    key : dotted key, a number.
    quantity : continuous in the key; may be infinite.
    target : [unit], greater than 0.
    name, unit : of the quantity, for the sentence that says why there is no solution.
    between : interval of the key; the quantity must be on opposite sides of the target at its ends.
    """
    if not (math.isfinite(target) and target > 0.0):
        raise SceneError(f"the {name} to fit must be finite and greater than 0 (unit {unit}), not {target}")
    low, high = between
    key_unit = KEYS[key].unit

    def changed(value: float) -> Scene:
        return scene.replace({key: value}, provenance=CALIBRATED)

    def excess(value: float) -> float:
        with through_any_value():
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


def strip_decay_rate(scene: Scene) -> float:
    """c_1 from the strain energies of sheet and tape alone [1/s], whatever damping.kind says."""
    modes = modes_of(scene, 1)
    pieces = modes.discretization.pieces
    energies = modes.discretization.strain_energies(modes.shapes[:, -1:])[..., 0]
    stretching = [piece.section.axial_loss_factor for piece in pieces]
    bending = [piece.section.bending_loss_factor for piece in pieces]
    return float(modes.omega[-1] * np.sum([stretching, bending] * energies) / np.sum(energies))


def calibrate_thickness(
    scene: Scene, free_period_s: float, period_of: Callable[[Scene], float] = free_period
) -> Scene:
    """The scene with the sheet so thick that mode 1, damped, has this period [s], by `period_of` a scene.

    The sheet is looked for up to the width of the spring, and to the thickness that the bend allows.
    """
    keys, search = scene.spring, partial(solve_for, "spring.thickness_m", name="free period", unit="s")
    thickest = min(keys.width_m, 1.999 * keys.bend_radius_m) if keys.kind == "folded_u" else keys.width_m
    between = min(keys.thickness_m, thickest) * THINNEST, thickest
    return search(scene, period_of, free_period_s, between=between)


def calibrate_damping(scene: Scene, decay_rate_per_s: float) -> Scene:
    """The scene in which mode 1 decays at this rate [1/s].

    With damping.kind strips the loss factor of the tape is chosen such that the strain energies give the
    rate without further scaling. For any other kind all its rates are scaled by one factor.
    """
    if scene.damping.kind != "strips":
        rate = float(damping_of(scene).decay_rates(modes_of(scene, 1))[-1])
        keys = tuple(DAMPING[scene.damping.kind][1].values())
        if not rate > 0.0:
            raise SceneError(
                f"damping.kind {scene.damping.kind} gives mode 1 a decay rate of {rate:.6g} 1/s, which no "
                f"scaling turns into {decay_rate_per_s:.10g} 1/s: change {' or '.join(keys)}"
            )
        scaled = {key: (np.array(scene[key]) * (decay_rate_per_s / rate)).tolist() for key in keys}
        return scene.replace(scaled, provenance=CALIBRATED)
    if scene.spring.tape_thickness_m == 0.0:
        raise SceneError("there is no tape to calibrate: spring.tape_thickness_m must be greater than 0")
    scene = scene.replace({"damping.decay_rate_per_s": decay_rate_per_s}, provenance=CALIBRATED)
    return solve_for(
        "spring.tape_loss_factor",
        scene,
        strip_decay_rate,
        decay_rate_per_s,
        name="decay rate of mode 1",
        unit="1/s",
        between=LOSS_FACTORS,
    )


def calibrate(scene: Scene, *, free_period_s: float, decay_rate_per_s: float) -> Scene:
    """The scene with both, thickness and damping fitted in turn until neither moves the other."""
    for _ in range(MOST_ROUNDS):
        scene = calibrate_damping(calibrate_thickness(scene, free_period_s), decay_rate_per_s)
        if abs(free_period(scene) / free_period_s - 1.0) <= ACCURACY:
            return scene
    raise SceneError(
        f"thickness and damping cannot be calibrated together: a free period of {free_period_s:.10g} s and a "
        f"decay rate of {decay_rate_per_s:.10g} 1/s do not settle in {MOST_ROUNDS} rounds"
    )


@dataclass(frozen=True, kw_only=True)
class Targets:
    """What the calibrated scene must reproduce.

    Damped period and c of mode 1; base amplitude at grazing at `frequency_hz`; kick of the first collision
    there at `excess`.
    """

    free_period_s: float
    decay_rate_per_s: float
    grazing_amplitude_m: float = letter.DRIVE_AMPLITUDE_M
    kick: float = 1.0
    frequency_hz: float = letter.TRANSITION_HZ[5]
    excess: float = letter.TIME_TRACE_EXCESS

    @classmethod
    def of(cls, scene: Scene) -> Targets:
        """The measured period and decay of a scene, its middle drive frequency, the rest as in the letter."""
        keys = scene.single_mode
        return cls(
            free_period_s=keys.free_period_s,
            decay_rate_per_s=keys.decay_rate_per_s,
            frequency_hz=middle_of(scene),
        )


def calibrate_gap(scene: Scene, amplitude: float, frequency: float) -> Scene:
    """The scene whose tip grazes the stop at base amplitude `amplitude` [m] and `frequency` [Hz]."""
    response = abs(beam_at(scene, frequency).tip_response())
    return scene.replace({"stop.gap_m": amplitude * response}, provenance=CALIBRATED)


def collision_at(scene: Scene, frequency: float, excess: float) -> Collision:
    """The collision that ends the motion without impacts at an excess above zero."""
    return first_collision(beam_at(scene, frequency).with_excess(excess))


def calibrate_all(scene: Scene, targets: Targets) -> Scene:
    """The scene with thickness, tape, gap and ball mass fitted to the four targets."""

    def others(trial: Scene) -> Scene:
        fitted = calibrate(
            trial, free_period_s=targets.free_period_s, decay_rate_per_s=targets.decay_rate_per_s
        )
        return calibrate_gap(fitted, targets.grazing_amplitude_m, targets.frequency_hz)

    def kick(trial: Scene) -> float:
        return collision_at(others(trial), targets.frequency_hz, targets.excess).kick

    if not (mass := scene.tip.mass_kg) > 0.0:
        words = "it must be above zero, as masses from {:g} to {:g} times it are tried".format(*MASSES)
        raise SceneError(f"tip.mass_kg is {mass} kg; {words}")
    fitted = solve_for(
        "tip.mass_kg",
        scene,
        kick,
        targets.kick,
        name=f"kick at excess {targets.excess:g}",
        unit="[1]",
        between=(MASSES[0] * mass, MASSES[1] * mass),
        accuracy=KICK_ACCURACY,
    )
    return others(fitted)


def with_mass_ratio(scene: Scene, ratio: float, frequency: float) -> Scene:
    """The scene with M = `ratio` times the leaf, its period kept, and grazing at 2 mm at `frequency` [Hz].

    A heavier ball needs a thicker, hence heavier, sheet: both are found together, from one equation for the
    thickness. The contact law becomes Hertz's, which a ball without mass has as well.

    Raises
    ------
    SceneError
        If no thickness gives the period.
    """
    scene = scene.replace({"contact.law": "hertz"})

    def weighted(trial: Scene) -> Scene:
        return trial.replace({"tip.mass_kg": ratio * spring_of(trial).strip_mass}, provenance=CALIBRATED)

    period = scene.single_mode.free_period_s
    fitted = calibrate_thickness(scene, period, lambda trial: free_period(weighted(trial)))
    return calibrate_gap(weighted(fitted), letter.DRIVE_AMPLITUDE_M, frequency)


def bare_cantilever(scene: Scene, frequency: float) -> Scene:
    """A straight leaf without ball, of the same length, width, period and drive amplitude at grazing."""
    return with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.0, frequency)
