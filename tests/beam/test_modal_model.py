"""The modal model: what it holds, what it refuses, and what reduction keeps of the spring."""

import doctest
import pickle
import warnings
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import beam

STRIP = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=0.65e-3)
THREE = dict(omega=[1.0, 2.0, 3.0], decay_rate=[0.1, 0.2, 0.0], phi=[1, 2, 3], participation=[3, 2, 1])
U = dict(leg_length=0.13, bend_radius=7.5e-3, section=STRIP)


def u_modes(count: int = 12) -> beam.Modes:
    ball, laser = beam.Readout(at=0.13 + 0.5 * np.pi * 7.5e-3), beam.Readout(at=0.1, quantity="rotation")
    spring = beam.folded_u(**U, tip=beam.Tip(mass=4e-3), readouts={"ball": ball, "laser": laser})
    return beam.natural_modes(beam.assemble(spring), count)


def test_single_mode_is_equation_1() -> None:
    """Integrated numerically, the free motion returns after T, smaller by exp(-mu T / 2)."""
    model = beam.single_mode(free_period=40.80e-3, decay_rate=3.56)
    assert model.n_modes == 1 and model.phi[0] == model.participation[0] == 1.0
    start = np.array([1e-3, 0.2])
    rates = np.array([[0.0, 1.0], [-(model.omega[0] ** 2), -model.decay_rate[0]]])
    path = solve_ivp(lambda t, y: rates @ y, (0.0, 40.80e-3), start, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(path.y[:, -1], np.exp(-0.5 * 3.56 * 40.80e-3) * start, rtol=1e-7)


def test_arrays_are_copied_and_read_only() -> None:
    source = np.array([1.0, 2.0, 3.0])
    model = beam.ModalModel(**(THREE | {"omega": source}), points={"laser": beam.Point(row=source)})
    source[0] = 9.0
    rows = (model.omega, model.points["laser"].row, model.phi, model.decay_rate, model.participation)
    assert rows[0][0] == rows[1][0] == 1.0 and model.phi.dtype == np.float64
    for row in rows:
        with pytest.raises(ValueError, match="read-only"):
            row[0] = 5.0
    with pytest.raises(FrozenInstanceError):
        model.omega = source  # type: ignore[misc]
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(model)).phi, model.phi)
    np.testing.assert_allclose(model.frequencies_hz * 2 * np.pi, model.omega)


def test_truncated() -> None:
    points = {"laser": beam.Point(row=[4, 5, 6], static_compliance=3.0)}
    model = beam.ModalModel(**THREE, points=points, static_compliance=1.0, tip_mass=2.0)
    short = model.truncated(2)
    assert short.n_modes == 2 and short.static_compliance == 1.0 and short.tip_mass == 2.0
    np.testing.assert_array_equal(short.points["laser"].row, [4, 5])
    np.testing.assert_array_equal(short.points["tip"].row, short.phi)
    assert [short.points[name].static_compliance for name in ("laser", "tip")] == [3.0, 1.0]


def test_a_lowest_mode_that_hardly_oscillates_is_warned_of() -> None:
    with pytest.warns(beam.SuspiciousValue, match="decay_rate"):
        beam.ModalModel(**(THREE | {"decay_rate": [1.1, 0.0, 0.0]}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        beam.ModalModel(**(THREE | {"omega": [0.0, 2.0, 3.0], "decay_rate": [1.0, 1.9, 7.0]}))


def test_uncoupled_modes_drop_out() -> None:
    modes = u_modes()
    model = beam.reduce(modes, beam.ConstantRatio(ratio=0.01))
    assert model.n_modes == 6
    np.testing.assert_array_equal(model.omega, modes.omega[modes.coupled])
    np.testing.assert_allclose(model.decay_rate, 0.02 * model.omega)
    np.testing.assert_allclose(model.points["ball"].row, model.phi, rtol=1e-9)
    assert set(model.points) == {"ball", "laser", "tip"} and model.points["tip"].mass == 4e-3
    assert beam.reduce(modes, beam.ConstantRatio(ratio=0.01), 4).n_modes == 4


def test_uncoupled_modes_take_no_part_in_the_motion_of_the_tip() -> None:
    """The response of the full matrices to a base motion and a tip force is that of the coupled modes."""
    modes = u_modes(60)
    full = modes.discretization
    model = beam.reduce(modes, beam.ConstantRatio(ratio=0.0))
    for frequency in (20.0, 80.0, 300.0):
        square = (2.0 * np.pi * frequency) ** 2
        dynamic = (full.stiffness - square * full.mass).toarray()
        forced, driven = full.tip @ np.linalg.solve(dynamic, np.stack([full.tip, full.base_load], axis=1))
        gain = model.phi / (model.omega**2 - square)
        residual = model.static_compliance - np.sum(model.phi**2 / model.omega**2)
        close = dict(rel=1e-5, abs=1e-6 * model.static_compliance)
        assert gain @ model.phi + residual == pytest.approx(forced, **close)
        assert gain @ model.participation == pytest.approx(driven, rel=1e-5)


def test_residual_compliance_falls_as_the_cube_of_the_number_of_modes() -> None:
    """Its terms fall as omega^-2, i.e. as the fourth power of the mode number."""
    spring = beam.cantilever(length=0.13, section=STRIP)
    model = beam.reduce(beam.natural_modes(beam.assemble(spring, 60), 16), beam.ConstantRatio(ratio=0.01))
    residual = model.static_compliance - np.cumsum(model.phi**2 / model.omega**2)
    assert np.all(residual > 0.0)
    assert np.log2(residual[7] / residual[15]) == pytest.approx(3.0, abs=0.15)


def test_floating_strip_has_no_static_compliance() -> None:
    spring = beam.straight_strip(length=0.1, section=STRIP, supports=("pinned", "free"), tip_at=0.1)
    model = beam.reduce(beam.natural_modes(beam.assemble(spring, 10), 3), beam.ConstantRatio(ratio=0.01))
    assert model.static_compliance is None and model.omega[0] == model.decay_rate[0] == 0.0
    assert replace(model, static_compliance=1.0).static_compliance == 1.0


def test_the_package_keeps_its_word() -> None:
    assert doctest.testmod(beam).failed == 0 and set(beam.__all__) <= set(dir(beam))
    with pytest.raises(AttributeError, match="drum"):
        _ = beam.drum


@pytest.mark.parametrize("count", [1, 2, 4])
def test_residual_mode_fulfils_the_sum_rules(count: int) -> None:
    spring = beam.folded_u(**U, tip=beam.Tip(mass=5e-3))
    model = beam.reduce(beam.natural_modes(beam.assemble(spring), 30), beam.ConstantRatio(ratio=0.01), count)
    whole = model.with_residual_mode()
    assert whole.n_modes == count + 1 and whole.omega[-1] > model.omega[-1]
    assert np.sum(whole.phi**2) == pytest.approx(1 / 5e-3, rel=1e-12)
    assert np.sum(whole.phi**2 / whole.omega**2) == pytest.approx(model.static_compliance, rel=1e-12)
    assert whole.phi @ whole.participation == pytest.approx(1.0, rel=1e-12)
