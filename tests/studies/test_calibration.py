"""Springs from scenes, and the keys that are fitted to measured numbers."""

import math

import numpy as np
import pytest

from beam import StripDamping
from studies.physics import calibration
from studies.physics.calibration import ACCURACY, Targets, calibrate, calibrate_damping, calibrate_thickness
from studies.shell import scene as scenes
from studies.shell.scene import READOUT, SceneError, damping_of, free_period, model_of, modes_of, read_scene

LETTER, FOLDED = read_scene("letter"), read_scene("tight_fold")
PERIOD, RATE = 40.80e-3, 3.56
COARSE = {"spring.elements_per_leg": 12, "spring.elements_on_arc": 12, "modes.count": 4}
UNDAMPED = {"damping.kind": "constant_ratio", "damping.ratio": 0.0}


@pytest.mark.slow
def test_the_letters_scene_is_calibrated_to_the_digits_it_is_written_with():
    """Thickness and loss factor have eight digits; the period goes with a power of the thickness near -1."""
    assert free_period(LETTER) == pytest.approx(PERIOD, rel=1e-7)
    assert calibration.strip_decay_rate(LETTER) == pytest.approx(RATE, rel=1e-7)
    fitted = calibrate(LETTER, free_period_s=PERIOD, decay_rate_per_s=RATE)
    for key in ("spring.thickness_m", "spring.tape_loss_factor"):
        assert LETTER[key] == pytest.approx(fitted[key], rel=1e-7)
        assert LETTER.provenance()[key] == fitted.provenance()[key] == "calibrated"


def test_the_model_has_the_period_and_the_decay_that_were_measured():
    scene = calibrate(LETTER.replace(COARSE), free_period_s=41.2e-3, decay_rate_per_s=4.0)
    model = model_of(scene)
    damped = math.sqrt(model.omega[0] ** 2 - (0.5 * model.decay_rate[0]) ** 2)
    assert abs(2.0 * math.pi / damped / 41.2e-3 - 1.0) <= ACCURACY
    assert abs(model.decay_rate[0] / 4.0 - 1.0) <= ACCURACY
    assert abs(calibration.strip_decay_rate(scene) / 4.0 - 1.0) <= ACCURACY
    undamped = abs(2.0 * math.pi / model.omega[0] / 41.2e-3 - 1.0)
    assert undamped > 100.0 * ACCURACY  # the damped and the undamped period are distinguished


def test_without_scaling_the_modes_decay_as_the_strain_energies_say():
    """Two routes: energies of the strains, and the loss-weighted stiffness matrix of the beam package."""
    modes = modes_of(LETTER)
    scaled, bare = damping_of(LETTER).decay_rates(modes), StripDamping().decay_rates(modes)
    np.testing.assert_allclose(scaled, bare, rtol=1e-6)
    assert calibration.strip_decay_rate(LETTER) == pytest.approx(bare[0], rel=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        {"damping.kind": "constant_ratio"},
        {"damping.kind": "constant_loss_factor"},
        {"damping.kind": "rayleigh", "damping.rayleigh_beta_s": 1e-5},
        {"damping.kind": "measured", "damping.measured_rates_per_s": [3.0, 20.0, 50.0, 100.0]},
    ],
)
def test_other_kinds_of_damping_are_scaled_as_a_whole(changes):
    scene = LETTER.replace({**COARSE, **changes})
    fitted = calibrate_damping(scene, 2.0 * RATE)
    before, after = model_of(scene).decay_rate, model_of(fitted).decay_rate
    assert abs(after[0] / (2.0 * RATE) - 1.0) <= ACCURACY
    np.testing.assert_allclose(after / before, after[0] / before[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "fit", "words"),
    [
        (
            {},
            lambda scene: calibrate_thickness(scene, 1e-5),
            ["spring.thickness_m", "free period", "1e-05 s"],
        ),
        ({}, lambda scene: calibrate_thickness(scene, math.nan), ["free period", "finite"]),
        (
            {"tip.mass_kg": 0.0},
            lambda scene: calibration.calibrate_all(scene, Targets.of(scene)),
            ["tip.mass_kg is 0.0 kg", "above zero"],
        ),
        ({}, lambda scene: calibrate_damping(scene, 1e3), ["spring.tape_loss_factor", "1000 1/s"]),
        ({}, lambda scene: calibrate_damping(scene, -1.0), ["decay rate of mode 1", "not -1.0"]),
        ({"spring.tape_thickness_m": 0.0}, lambda scene: calibrate_damping(scene, 3.0), ["tape"]),
        (UNDAMPED, lambda scene: calibrate_damping(scene, 3.0), ["damping.ratio"]),
    ],
)
def test_what_cannot_be_fitted_is_refused_in_one_sentence(changes, fit, words):
    with pytest.raises(SceneError) as caught:
        fit(LETTER.replace({**COARSE, **changes}))
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_the_gap_is_fitted_at_the_middle_drive_frequency_of_the_scene():
    found = [Targets.of(scene).frequency_hz for scene in (LETTER, read_scene("steel_ruler"))]
    assert found == [22.2, 7.87]


def test_a_jump_is_no_solution():
    with pytest.raises(SceneError, match="jumps across"):
        said, key = dict(name="step", unit="m", between=(1e-3, 0.1)), "stop.gap_m"
        calibration.solve_for(key, LETTER, lambda one: 3.0 - 2.0 * (one.stop.gap_m < 0.01), 2.0, **said)


def test_the_model_keeps_the_coupled_modes_only():
    """Of a folded strip: its breathing modes leave the ball at rest."""
    modes, model = modes_of(FOLDED), model_of(FOLDED)
    assert model.n_modes == modes.coupled.sum() == FOLDED.kept_modes < modes.omega.size
    assert modes.coupled[-1] and np.all(model.phi > 0.0)
    np.testing.assert_array_equal(model.omega, modes.omega[modes.coupled])
    assert model.tip_mass == FOLDED.tip.mass_kg and model.static_compliance > 0.0
    assert modes_of(FOLDED, 3).coupled.sum() == 3


def test_every_kind_of_spring_makes_a_model_with_a_readout():
    for kind in ("flat_u", "folded_u", "cantilever", "straight_strip"):
        model = model_of(LETTER.replace({**COARSE, "spring.kind": kind}))
        assert model.n_modes == 4 and model.points[READOUT].row.shape == (4,)
    shapes = {"tip_values": [5.0, 8.0], "participation": [-0.05, 0.14]}
    data = {"frequencies_hz": [150.0, 24.5], "decay_rates_per_s": [20.0, 3.5], **shapes}
    lists = {f"modal_data.{name}": values for name, values in data.items()}
    measured = LETTER.replace({"spring.kind": "modal_data", **lists})
    model = model_of(measured)
    np.testing.assert_allclose(model.frequencies_hz, [24.5, 150.0])
    np.testing.assert_array_equal(model.points[READOUT].row, [8.0, 5.0])
    with pytest.raises(SceneError, match="without their shapes"):
        scenes.spring_of(measured)
    single = scenes.single_mode_of(LETTER)
    assert single.points[READOUT].row.tolist() == [1.0] == single.phi.tolist()


def test_the_readout_sees_the_ball_where_the_ball_is_and_rotation_where_it_is_wanted():
    for scene, place in ((LETTER, 1.0), (FOLDED, 0.5)):
        at_ball = model_of(scene.replace({**COARSE, "readout.arc_fraction": place}))
        np.testing.assert_allclose(at_ball.points[READOUT].row, at_ball.phi, rtol=1e-9)
    turn = {"readout.arc_fraction": 1.0, "readout.quantity": "rotation"}
    model = model_of(LETTER.replace({**COARSE, "spring.kind": "cantilever", "tip.mass_kg": 0.0, **turn}))
    assert model.points[READOUT].row[0] / model.phi[0] == pytest.approx(1.37650543 / 0.13, rel=1e-6)


def test_a_mode_number_beyond_the_mesh_is_refused():
    few = {"spring.elements_per_leg": 1, "spring.elements_on_arc": 1, "modes.count": 30}
    with pytest.raises(SceneError, match=r"modes\.count must be at most"):
        modes_of(LETTER.replace(few))
