"""The straight equivalent of the folded U, and the residual mode that stands for a truncation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from beam import (
    BRASS,
    DAMPING_TAPE,
    ConstantRatio,
    Layer,
    StripSection,
    Tip,
    as_one_spring,
    assemble,
    cantilever,
    folded_u,
    natural_modes,
    reduce,
    straight_equivalent,
)

STRIP = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
TAPED = replace(STRIP, layer=Layer(material=DAMPING_TAPE, thickness=0.4e-3, both_sides=True))
TIP = Tip(mass=5e-3)
RATIO = ConstantRatio(ratio=0.01)


@pytest.mark.parametrize("radius", [4e-3, 7.5e-3, 15e-3])
@pytest.mark.parametrize("span", [None, (0.0, 0.13), (0.02, 0.09)])
def test_sway_stiffness_is_that_of_the_u(radius: float, span: tuple[float, float] | None) -> None:
    """The closed form of bend and legs against the static solution of all elements."""
    taped = {} if span is None else {"damped_section": TAPED, "damped_span": span}
    spring = folded_u(leg_length=0.13, bend_radius=radius, section=STRIP, tip=TIP, **taped)
    leg = straight_equivalent(spring)
    whole, half = (assemble(one).static_compliance() for one in (spring, leg))
    assert whole is not None and half is not None
    bend = 0.3 * (STRIP.thickness / radius) ** 2 * radius / 0.13  # its extension, which is left out
    assert half / 2 == pytest.approx(whole, rel=bend + 1e-5)
    assert 0.6 * radius < leg.centreline.length - 0.13 < radius
    mass = spring.strip_mass + spring.tip.mass
    assert 2 * (leg.strip_mass + leg.tip.mass) == pytest.approx(mass, rel=1e-12)


def test_modes_are_those_of_the_u() -> None:
    """Up to mode 8 frequencies agree to 2e-3; legs without their share of the bend are 5 % off in statics."""
    spring = folded_u(leg_length=0.13, bend_radius=7.5e-3, section=STRIP, tip=TIP)
    u = reduce(natural_modes(assemble(spring), 20), RATIO, 8)
    leg = as_one_spring(reduce(natural_modes(assemble(straight_equivalent(spring)), 8), RATIO))
    np.testing.assert_allclose(leg.omega, u.omega, rtol=2e-3)
    np.testing.assert_allclose(np.abs(leg.phi), np.abs(u.phi), rtol=2e-2)
    np.testing.assert_allclose(np.abs(leg.participation), np.abs(u.participation), rtol=2e-2, atol=1e-4)
    short = replace(straight_equivalent(spring), centreline=straight_equivalent(spring).centreline)
    bare = cantilever(length=0.13, section=STRIP, tip=TIP)
    bare = replace(bare, supports=("clamped", "guided"), tip=replace(TIP, mass=0.5 * TIP.mass))
    assert short.supports == bare.supports
    assert abs(assemble(bare).static_compliance() / assemble(short).static_compliance() - 1) > 0.05


def test_only_a_folded_u_has_a_straight_equivalent() -> None:
    with pytest.raises(ValueError, match="no folded U"):
        straight_equivalent(cantilever(length=0.13, section=STRIP, tip=TIP))


@pytest.mark.parametrize("count", [1, 2, 4])
def test_residual_mode_fulfils_the_sum_rules(count: int) -> None:
    spring = folded_u(leg_length=0.13, bend_radius=7.5e-3, section=STRIP, tip=TIP)
    model = reduce(natural_modes(assemble(spring), 30), RATIO, count)
    whole = model.with_residual_mode()
    assert whole.n_modes == count + 1 and whole.omega[-1] > model.omega[-1]
    assert np.sum(whole.phi**2) == pytest.approx(1 / TIP.mass, rel=1e-12)
    assert np.sum(whole.phi**2 / whole.omega**2) == pytest.approx(model.static_compliance, rel=1e-12)
    assert whole.phi @ whole.participation == pytest.approx(1.0, rel=1e-12)


def test_no_residual_mode_without_statics_tip_mass_or_remainder() -> None:
    spring = folded_u(leg_length=0.13, bend_radius=7.5e-3, section=STRIP, tip=TIP)
    model = reduce(natural_modes(assemble(spring), 30), RATIO, 3)
    with pytest.raises(ValueError, match="tip_mass is 0"):
        replace(model, tip_mass=0.0).with_residual_mode()
    with pytest.raises(ValueError, match="static_compliance is None"):
        replace(model, static_compliance=None).with_residual_mode()
    enough = float(np.sum(model.phi**2 / model.omega**2))
    with pytest.raises(ValueError, match="above zero"):
        replace(model, static_compliance=enough).with_residual_mode()
