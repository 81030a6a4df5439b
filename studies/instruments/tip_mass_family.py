"""The same spring with another ball: tip mass varied at fixed free period and drive amplitude at grazing.

    M = r m_leaf        mass of ball and mount as a part r of the mass of the leaf spring, tape included
    h                   thickness of the sheet such that mode 1, damped, keeps the period of the scene
    gap                 such that the tip grazes at the letter's drive amplitude, 2 mm

A heavier ball needs a thicker, hence heavier, sheet: M and h are found together, from one equation for h.
"""

from __future__ import annotations

from studies.instruments.calibration import THINNEST, free_period, solve_for
from studies.instruments.contact_calibration import calibrate_gap
from studies.instruments.quantities import CALIBRATED
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import spring_of
from studies.published import DRIVE_AMPLITUDE_M

__all__ = ["bare_cantilever", "leaf_mass", "with_mass_ratio"]


def leaf_mass(scene: Scene) -> float:
    """Mass of sheet and tape, without ball and mount [kg]."""
    return spring_of(scene).strip_mass


def with_mass_ratio(scene: Scene, ratio: float, frequency: float) -> Scene:
    """The scene with M = `ratio` times the leaf, its period kept, and grazing at 2 mm at `frequency` [Hz].

    The contact law becomes Hertz's, which a ball without mass has as well.

    Raises
    ------
    SceneError
        If no thickness gives the period.
    """
    scene = scene.replace({"contact.law": "hertz"})

    def weighted(trial: Scene) -> Scene:
        return trial.replace({"tip.mass_kg": ratio * leaf_mass(trial)}, provenance=CALIBRATED)

    keys = scene.spring
    thickest = min(keys.width_m, 1.999 * keys.bend_radius_m) if keys.kind == "folded_u" else keys.width_m
    low = min(keys.thickness_m, thickest) * THINNEST
    fitted = solve_for(
        "spring.thickness_m",
        scene,
        lambda trial: free_period(weighted(trial)),
        scene.single_mode.free_period_s,
        name="free period",
        unit="s",
        low=low,
        high=thickest,
    )
    return calibrate_gap(weighted(fitted), DRIVE_AMPLITUDE_M, frequency)


def bare_cantilever(scene: Scene, frequency: float) -> Scene:
    """A straight leaf without ball, of the same length, width, period and drive amplitude at grazing."""
    return with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.0, frequency)
