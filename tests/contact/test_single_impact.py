"""Closed-form maximal orbits against integrations and 50-digit arithmetic that share no code with them."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import oscillators
import pytest
from oscillators import many_modes, modes_on_stop, newton
from simulated_orbit import EQUATION_1

from beam import single_mode
from contact import LinearContact, MaximalFamily, NordmarkMap, Stop, StroboscopicMap
from contact.maps.nordmark_orbits import MapFamily

T, MU, TAU = 0.0408, 3.56, 0.1


def equation_1(frequency: float, period: int, restitution=TAU, free_period=T) -> MaximalFamily:
    plain = oscillators.equation_1(frequency, newton(restitution))
    model = single_mode(free_period=free_period, decay_rate=MU)
    return MaximalFamily(oscillator=replace(plain, model=model), m=period)


@pytest.mark.parametrize(("frequency", "period"), [place[:2] for place in EQUATION_1])
def test_folds_of_equation_1_in_fifty_digits(frequency: float, period: int) -> None:
    """F as a function of the impact time alone: periodicity and x = gap fix the rest; its minimum is F_m."""
    at_fold = equation_1(frequency, period).fold()
    with mp.workdps(50):
        half, f, tau = mp.mpf(MU) / 2, mp.mpf(frequency), mp.mpf(TAU)
        pole, w = mp.mpc(-half, 2 * mp.pi / mp.mpf(T)), 2 * mp.pi * f
        steady = 1 / (abs(pole) ** 2 - w**2 + 2j * half * w)
        span = mp.e ** (pole * period / f)

        # x = F Im(steady e^{iwt}) + Re(c e^{pole s}) with s since the impact; unknown F, Re c, Im c, v
        def amplitude(time):
            e = steady * mp.e ** (1j * w * time)
            rows, right = [], [1, 1, 0, 0]  # gap = 1 at both ends, velocity -tau v and v there
            rows.append([e.imag, 1, 0, 0])
            rows.append([e.imag, span.real, -span.imag, 0])
            rate = [(w * e.real), pole.real, -pole.imag]
            arrive = pole * span
            rows.append([rate[0], rate[1], rate[2], tau])
            rows.append([w * e.real, arrive.real, -arrive.imag, -1])
            return mp.lu_solve(mp.matrix(rows), mp.matrix(right))[0]

        start = mp.mpf(at_fold.phase)
        best = mp.findroot(lambda time: mp.diff(amplitude, time), start + mp.mpf("1e-6"))
        excess = abs(amplitude(best)) * abs(steady) - 1
    assert abs(at_fold.excess - float(excess)) < 1e-14
    assert at_fold.phase == pytest.approx(float(best), abs=1e-11)


def test_ratio_to_the_map_at_a_band_edge() -> None:
    """(1 - tau g)^2/((1 + tau^2 g)(1 + g)), not one: the map drops terms of the order of b^2."""
    for period, tau, expected in ((3, 0.1, 0.476), (5, 0.1, None), (4, 0.8, None)):
        upper = 2 * period / ((2 * period + 1) * T)
        g = math.exp(-MU * period / (2 * upper))
        limit = (1 - tau * g) ** 2 / ((1 + tau**2 * g) * (1 + g))
        assert expected is None or limit == pytest.approx(expected, abs=5e-4)
        errors = []
        for below in (1e-3, 1e-4):
            frequency = upper * (1 - below)
            numbers = dict(free_period=T, decay_rate=MU, restitution=tau)
            chart = NordmarkMap.from_frequencies(drive_frequency=frequency, **numbers)
            exact = equation_1(frequency, period, restitution=tau).fold().excess
            errors.append(abs(chart.excess(MapFamily(chart, period).fold().rho) / exact - limit))
        assert errors[1] < 0.15 * errors[0] and errors[1] < 2e-3


def test_many_modes_with_one_tip_value_are_equation_1() -> None:
    """A second mode that the tip does not see changes nothing, even if it is rigid and undamped."""
    plain = equation_1(21.5, 4)
    omega, law = [*plain.oscillator.model.omega, 0.0], plain.oscillator.stop.law
    two = modes_on_stop(omega, [MU, 0.0], [2.0, 0.0], [0.5, 1.0], law=law, drive=21.5)
    family = replace(plain, oscillator=two)
    assert family.fold().excess == pytest.approx(plain.fold().excess, rel=1e-12)
    assert family.fold().speed / 0.01 == pytest.approx(plain.fold().speed, rel=1e-12)


def test_another_law_needs_its_restitution() -> None:
    plain = many_modes("three modes")
    soft = replace(plain, stop=Stop(gap=0.012, law=LinearContact(stiffness=1e6)))
    given = MaximalFamily.from_oscillator(soft, m=3, local_restitution=0.35)
    assert given.fold().excess == MaximalFamily(oscillator=plain, m=3).fold().excess
    with pytest.raises(TypeError, match="restitution"):
        MaximalFamily.from_oscillator(soft, m=3)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"omega": [0.0, 960.0, 2690.0]}, r"omega\[0\]"),
        ({"omega": [154.0, 6 * math.pi * 20.5, 2690.0], "decay_rate": [3.56, 0.0, 80.0]}, r"omega\[1\]"),
        ({"omega": [2 * math.pi * 20.5, 960.0, 2690.0], "decay_rate": [0.0, 0.0, 0.0]}, "frequency"),
    ],
)
def test_a_mode_without_a_return_is_named(changes: dict[str, list[float]], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        MaximalFamily(oscillator=many_modes("three modes", **changes), m=3)


def test_of_fig_5_a_second_impact_ends_the_orbits_below_grazing() -> None:
    """19.65 Hz: p3 exists below grazing only, between its fold and the excess of a second impact."""
    for tau, lowest, end in ((0.1, -0.132, -0.13097), (0.05, -0.116, -0.11282)):
        family = equation_1(19.65, 3, free_period=0.0412, restitution=tau)
        assert family.fold().excess == pytest.approx(lowest, abs=1e-3)
        below, above = (family.orbits(end + side * 2e-5)[-1] for side in (-1, 1))
        assert below.stable and below.admissible and not above.admissible


def test_slow_orbits_are_certified_down_to_grazing() -> None:
    family = equation_1(20.90, 3)
    for part in (1e-2, 1e-4, 1e-6):
        assert family.orbit(part * family.oscillator.unit_speed).admissible


def test_an_orbit_repeats_to_rounding_for_20_000_periods() -> None:
    """p5 of Eq. (1) at 22.2 Hz, from its closed form on."""
    orbits = equation_1(22.2, 5).orbits(1e-3)
    (orbit,) = [o for o in orbits if o.stable and o.admissible]
    strobed = StroboscopicMap(oscillator=orbit.oscillator)
    points = strobed.orbit(replace(orbit.strobe_state(), time=0.0), 20_000).points.reshape(-1, 5, 2)
    assert np.abs(points - points[0]).max() < 1e-13 * strobed.scale
    assert np.abs(points[-2:] - points[-3]).max() < 1e-15 * strobed.scale
