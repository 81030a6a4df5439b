"""Fitting ball mass and gap, which need the driven spring and its collisions.

    base amplitude at grazing  Z_g = gap / |H(f)|          ->  gap: Z_g of the letter's "typically 2 mm"
    kick of mode 1 in one collision at an excess           ->  mass of ball and mount: a kick of 1

A kick of 1 takes all velocity from mode 1, which makes the restitution smallest; the kick grows with the
mass. Each trial mass goes with the sheet thickness, the tape and the gap that keep the other three numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact.collision import Collision, first_collision
from studies.instruments.calibration import calibrate, solve_for
from studies.instruments.oscillators import beam_of
from studies.instruments.quantities import CALIBRATED
from studies.instruments.scene import Scene

__all__ = ["Targets", "calibrate_all", "calibrate_gap", "collision_at"]

KICK_ACCURACY = 1e-9
"""Relative accuracy of the fitted kick: a collision repeats to 1e-11, the spring behind it to 1e-10."""

MASSES = (0.3, 3.0)
"""The mass is looked for between these multiples of its present value."""


@dataclass(frozen=True, kw_only=True)
class Targets:
    """What the calibrated scene must reproduce.

    Parameters
    ----------
    free_period_s : float
        Damped period of mode 1 [s].
    decay_rate_per_s : float
        c of mode 1 [1/s].
    grazing_amplitude_m : float
        Base amplitude at grazing [m] at `frequency_hz`.
    kick : float
        Of the first collision at `excess` and `frequency_hz` [1].
    frequency_hz, excess : float
        Where gap and mass are fitted [Hz], [1].
    """

    free_period_s: float
    decay_rate_per_s: float
    grazing_amplitude_m: float = 2e-3
    kick: float = 1.0
    frequency_hz: float = 22.2
    excess: float = 0.013


def calibrate_gap(scene: Scene, amplitude: float, frequency: float) -> Scene:
    """The scene whose tip grazes the stop at base amplitude `amplitude` [m] and `frequency` [Hz]."""
    response = abs(beam_of(scene, frequency).tip_response())
    return scene.replace({"stop.gap_m": amplitude * response}, provenance=CALIBRATED)


def collision_at(scene: Scene, frequency: float, excess: float) -> Collision:
    """The collision that ends the motion without impacts at an excess above zero."""
    return first_collision(beam_of(scene, frequency).with_excess(excess))


def calibrate_all(scene: Scene, targets: Targets) -> Scene:
    """The scene with thickness, tape, gap and ball mass fitted to the four targets.

    Raises
    ------
    SceneError
        If no mass in range gives the kick, or one of the others has no solution.
    """

    def others(trial: Scene) -> Scene:
        fitted = calibrate(
            trial, free_period_s=targets.free_period_s, decay_rate_per_s=targets.decay_rate_per_s
        )
        return calibrate_gap(fitted, targets.grazing_amplitude_m, targets.frequency_hz)

    def kick(trial: Scene) -> float:
        return collision_at(others(trial), targets.frequency_hz, targets.excess).kick

    mass = scene.tip.mass_kg
    fitted = solve_for(
        "tip.mass_kg", scene, kick, targets.kick, name=f"kick at excess {targets.excess:g}", unit="1",
        low=MASSES[0] * mass, high=MASSES[1] * mass, accuracy=KICK_ACCURACY,
    )
    return others(fitted)
