"""Four values of the scene, fitted to four measured numbers.

Thickness from the free period (40.80 ms), tape from the decay rate of mode 1 (3.56 1/s), gap from the base
amplitude at grazing (2 mm at the scene's middle drive frequency, for the letter 22.2 Hz), and the mass of
ball and mount from a collision that stops mode 1 (kick 1 at excess 0.013), where the restitution is smallest
(``studies.physics.calibration`` has the equations).

Run:     python -m studies calibrate
Writes:  keys.csv (before and after), calibrated.toml, a scene that every study takes with --scene
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from studies import letter
from studies.physics.calibration import Targets, calibrate_all, collision_at
from studies.shell.digits import written
from studies.shell.scene import Scene, beam_at, harmonic
from studies.shell.study import Run, study

KEYS = ("spring.thickness_m", "spring.tape_loss_factor", "stop.gap_m", "tip.mass_kg")

SMALL = 1e-3  # relative change of a key by the fit that is none


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """One key of the scene."""

    key: Annotated[str, "key of the scene; its name ends in the unit"]
    before: Annotated[float, "before the fit"]
    after: Annotated[float, "after the fit"]


@study(needs={"frequency 1": 1e-5, "kick": 0.002})
def calibrate(scene: Scene, run: Run) -> Mapping[str, object]:
    """Fit, report and write the scene."""
    targets = Targets.of(harmonic(scene))
    fitted = calibrate_all(scene, targets)
    rows = [Fitted(key=key, before=scene.number(key), after=fitted.number(key)) for key in KEYS]
    run.table("keys", rows, "Keys of the scene before and after the fit.", of=Fitted)
    run.text("calibrated.toml", fitted.dump(), "The scene with the fitted keys, for --scene.")
    collision = collision_at(fitted, targets.frequency_hz, targets.excess)
    amplitude = beam_at(fitted, targets.frequency_hz).grazing_amplitude()
    fits = abs(amplitude - letter.DRIVE_AMPLITUDE_M) <= letter.AMPLITUDE_STABILITY_M
    found = f"{1e3 * amplitude:.3f} mm at grazing, {targets.frequency_hz:g} Hz"
    run.verdict("drive_amplitude", "fitted" if fits else "differs", found=found)
    same = all(abs(row.after - row.before) <= SMALL * abs(row.before) for row in rows)
    change = "changes no key of the scene by more than a thousandth" if same else "changes the scene"
    run.finding(f"The fit to the four numbers {change}.")
    run.finding(f"The ball with its mount weighs {written(1e3 * fitted.tip.mass_kg, 3)} g after the fit.")
    return {
        "rows": rows,
        "kick": collision.kick,
        "restitution": collision.restitution,
        "delay_s": collision.delay,
        "contact_s": collision.contact_time,
    }
