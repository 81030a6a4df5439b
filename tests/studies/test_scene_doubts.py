"""Values of a scene that are legal and can hardly be meant: they are taken with a warning."""

import pytest

from beam import SuspiciousValue
from studies.shell.scene import read_scene

#: A slip of a unit or a value beyond the theory, and a word of the warning that it brings.
SLIPS = {
    "stop.gap_m=10.7": "gap is 10.7",
    "stop.gap_m=0.02": "small motion",
    "spring.leg_length_m=130": "weight",
    "spring.width_m=12 spring.bend_radius_m=9": "width",
    "spring.thickness_m=0.006": "a bar",
    "spring.bend_radius_m=7.5": "bend_radius",
    "spring.young_modulus_pa=105": "speed of sound",
    "spring.density_kg_m3=8.5": "speed of sound",
    "spring.tape_modulus_pa=1": "speed of sound",
    "spring.tape_thickness_m=0.45": "thickness",
    "spring.tape_loss_factor=49": "loss_factor",
    "tip.mass_kg=6.16": "heavier than",
    "tip.ball_radius_m=2.5": "ball_radius",
    "tip.ball_young_modulus_pa=370": "youngs_modulus",
    "tip.plate_young_modulus_pa=210e3": "other_modulus",
    "drive.frequencies_hz=[0.0222]": "first mode",
    "drive.frequencies_hz=[22.2,139.5]": "first mode",
    "drive.frequencies_hz=[2,98]": "has 2 Hz",
    "single_mode.free_period_s=1": "first mode",
    "single_mode.decay_rate_per_s=3560": "damping ratio",
    "damping.decay_rate_per_s=3560": "damping ratio",
    "scan.born_excess=1": "grazing",
    "damping.kind=constant_ratio damping.ratio=1.16": "damping.ratio",
    "damping.kind=constant_loss_factor damping.loss_factor=2.3": "damping.loss_factor",
    "damping.kind=rayleigh damping.rayleigh_beta_s=0.1": "damping.rayleigh_beta_s",
    "contact.law=linear contact.stiffness_n_per_m=1000": "contact.stiffness_n_per_m",
}


@pytest.mark.parametrize("overrides", SLIPS)
def test_a_slip_of_a_unit_is_taken_with_a_warning(overrides):
    with pytest.warns(SuspiciousValue) as found:
        read_scene("letter", overrides.split())
    assert any(SLIPS[overrides] in str(warning.message) for warning in found)
