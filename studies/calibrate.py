"""Calibration: four keys of the scene fitted to the four numbers that the letter prints about its spring.

Thickness from the free period (40.80 ms), tape from the decay rate of mode 1 (3.56 1/s), gap from the base
amplitude at grazing (2 mm at 22.2 Hz), and the mass of ball and mount from a collision that stops mode 1
(kick 1 at excess 0.013), where the restitution is smallest.

Run time: about ten seconds.  Command: python -m studies.calibrate.  Outputs: summary.json and
calibrated.toml, a scene that every study takes with --scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, run_study
from studies.instruments.contact_calibration import Targets, calibrate_all, collision_at
from studies.instruments.scene import Scene
from studies.instruments.scene_file import dump_scene
from studies.published import DRIVE_AMPLITUDE_M

KEYS = ("spring.thickness_m", "spring.tape_loss_factor", "stop.gap_m", "tip.mass_kg")


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Fit, report and write the scene."""
    targets = Targets(
        free_period_s=scene.single_mode.free_period_s,
        decay_rate_per_s=scene.single_mode.decay_rate_per_s,
        grazing_amplitude_m=DRIVE_AMPLITUDE_M,
    )
    fitted = calibrate_all(scene, targets)
    for key in KEYS:
        print(f"{key:<26} {scene[key]:.10g} -> {fitted[key]:.10g}", flush=True)
    collision = collision_at(fitted, targets.frequency_hz, targets.excess)
    print(
        f"collision at excess {targets.excess:g}: kick {collision.kick:.9f}, restitution "
        f"{collision.restitution:.6f}, "
        f"delay {1e6 * collision.delay:.3f} us, contact {1e6 * collision.contact_time:.3f} us",
        flush=True,
    )
    path = request.record.write_text("calibrated.toml", dump_scene(fitted))
    print(f"scene: {path}", flush=True)
    return {
        "keys": {key: fitted[key] for key in KEYS},
        "kick": collision.kick,
        "restitution": collision.restitution,
        "delay_s": collision.delay,
        "contact_s": collision.contact_time,
    }


NEEDS = (Need(quantity="frequency 1", tolerance=1e-5), Need(quantity="kick", tolerance=0.005))
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "calibrate", "Fit thickness, tape, gap and ball mass to the letter's numbers.", run, argv,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
