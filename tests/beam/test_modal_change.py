"""Derivatives of the modal numbers: by differences and what they keep."""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

import beam

NUMBERS = dict(omega=[154, 1000, 3100], decay_rate=[60, 20, 90], phi=[6, 8, 9])
THREE = beam.ModalModel(**NUMBERS, participation=[0.1, 0.05, 0.03])
ARRAYS = [field.name for field in fields(beam.ModalChange)]

Numbers = dict[str, np.ndarray]


def differences(of: Callable[[float], Numbers], at: float, step: float) -> Numbers:
    """Central differences of order 8."""
    found = {name: np.zeros_like(value) for name, value in of(at).items()}
    for i, weight in enumerate((4 / 5, -1 / 5, 4 / 105, -1 / 280), start=1):
        above, below = of(at + i * step), of(at - i * step)
        for name in found:
            found[name] += weight / step * (above[name] - below[name])
    return found


def seen(model: beam.ModalModel) -> Numbers:
    """What the changes speak of."""
    first = np.sqrt(model.omega[:1] ** 2 - 0.25 * model.decay_rate[:1] ** 2)
    shapes = {"phi": model.phi, "participation": model.participation}
    times = {"period": 2.0 * np.pi / first, "overtones": model.omega[1:] / model.omega[0]}
    return {"rates": model.decay_rate, **times, **shapes}


KEPT = {"period": [0], "overtones": [0, 0]}


@pytest.mark.parametrize(
    ("change", "moved"),
    [
        (beam.free_period_change(THREE), KEPT | {"period": [1], "rates": [0, 0, 0]}),
        (beam.decay_rate_change(THREE), KEPT | {"rates": [1, 0, 0]}),
        (beam.decay_rate_change(THREE, 2), KEPT | {"rates": [0, 0, 1]}),
        (beam.decay_rate_change(THREE, None), KEPT | {"rates": [1, 1 / 3, 1.5]}),
    ],
)
def test_a_change_moves_its_own_parameter_and_keeps_the_others(change, moved):
    """Its own by 1 per unit; shapes are no business of theirs."""
    size = max(np.abs(getattr(change, name) / getattr(THREE, name)).max() for name in ARRAYS)

    def along(step: float) -> Numbers:
        return seen(replace(THREE, **{n: getattr(THREE, n) + step * getattr(change, n) for n in ARRAYS}))

    found, at = differences(along, 0.0, 1e-3 / size), seen(THREE)
    for name, expected in {"phi": [0, 0, 0], "participation": [0, 0, 0], **moved}.items():
        assert np.abs((found[name] - expected) / at[name]).max() < 1e-11 * size, name


def of_mass(mass: float, count: int = 20) -> beam.ModalModel:
    """The letter's spring, roughly, with a ball of this mass [kg]."""
    strip = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=0.65e-3)
    spring = beam.folded_u(leg_length=0.13, bend_radius=7.5e-3, section=strip, tip=beam.Tip(mass=mass))
    modes = beam.natural_modes(beam.assemble(spring), count=count)
    return beam.reduce(modes, beam.MeasuredDecay(decay_rate=3.56))


def test_another_mass_at_the_tip_is_the_finite_element_model_with_that_mass():
    """All frequencies in proportion, since the free period is kept; with all that the modes left out the mass
    of an instant impact is exact."""
    other, found = of_mass(3e-3), beam.with_tip_mass(of_mass(4e-3), 3e-3)
    assert found.free_period == pytest.approx(of_mass(4e-3).free_period, rel=1e-12)
    assert found.omega[:4] / found.omega[0] == pytest.approx(other.omega[:4] / other.omega[0], rel=2e-6)
    for name in ("phi", "participation"):
        assert getattr(found, name)[:4] == pytest.approx(getattr(other, name)[:4], rel=2e-4)
    softer = (other.omega[0] / found.omega[0]) ** 2
    assert found.static_compliance == pytest.approx(other.static_compliance * softer, rel=1e-6)
    whole = beam.with_tip_mass(of_mass(4e-3, 10).with_residual_mode(), 3e-3)
    assert np.sum(whole.phi**2) == pytest.approx(1.0 / 3e-3, rel=1e-12)


def test_the_change_with_the_tip_mass_is_that_of_differences():
    model = of_mass(4e-3, 10)

    def of(mass: float) -> Numbers:
        at = beam.with_tip_mass(model, mass)
        return {name: getattr(at, name) for name in ARRAYS}

    found, exact = differences(of, 4e-3, 1e-5), beam.tip_mass_change(model)
    for name in ARRAYS:
        assert getattr(exact, name) == pytest.approx(found[name], rel=1e-8, abs=1e-9 * np.ptp(found[name]))


def test_without_damping_all_modes_get_the_same() -> None:
    """There is no proportion to keep; the frequencies do not move to first order."""
    change = beam.decay_rate_change(replace(THREE, decay_rate=np.zeros(3)), None)
    assert np.array_equal(change.decay_rate, np.ones(3)) and not np.any(change.omega)


def test_what_does_not_swing_has_no_free_period() -> None:
    with pytest.raises(ValueError, match="does not oscillate"), pytest.warns(UserWarning, match="decay_rate"):
        beam.free_period_change(replace(THREE, decay_rate=[310.0, 1.0, 1.0]))
