"""Searches of orbits far from grazing: what they find, and where they say that they stopped."""

import math

import numpy as np
import pytest
from oscillators import modes_on_stop, newton, slow

from beam import single_mode
from contact import BranchEnded, HarmonicDrive, ImpactOscillator, State, Stop, StroboscopicMap
from contact.orbits import MaximalFamily, Shooting, fold_of, folds_of, lowest_of, orbit_end, settle

FAST = [(1, 0.7, part) for part in (1.7, 1.94)] + [(1, 0.9, part) for part in (1.84, 1.96, 1.98)]
"""Period, restitution and f T of orbits p1 whose fold meets the stop faster than 2 times 2 pi f gap."""

SWEEP = [
    (m, tau, round(part, 2))
    for m in (1, 2, 3)
    for tau in (0.1, 0.3, 0.5, 0.7, 0.9)
    for part in np.arange(0.5, m + 1.0, 0.02)
    if round(2.0 * part, 2) % 1.0  # there the orbits are at resonance and the fold is at the graze
]


def one_mode(w: float, gap: float, restitution: float, decay: float = 0.0) -> ImpactOscillator:
    """x'' + decay x' + x = sin(w t) before a stop."""
    drive = (w / (2.0 * math.pi), 1.0 / w**2)
    return modes_on_stop(1.0, decay, participation=1.0, law=newton(restitution), gap=gap, drive=drive)


def speeds(w: float, gap: float, restitution: float) -> list[float]:
    """Approach speeds v of the orbits p1 of `one_mode` without decay, by rising speed.

    The free part of x repeats after 2 pi/w with a jump -(1 + r) v of its velocity: before the touch it is
    u = -(1 + r) v/2 cot(pi/w), u' = (1 + r) v/2.  The rest is the steady motion, of amplitude 1/|1 - w^2|.
    """
    c, r = 0.5 * (1.0 + restitution) / math.tan(math.pi / w), restitution
    # u = -c v:  (gap - u)^2 + ((v - u')/w)^2 = 1/(1 - w^2)^2
    square = c * c + ((1.0 - r) / (2.0 * w)) ** 2
    roots = np.roots([square, 2.0 * gap * c, gap * gap - 1.0 / (1.0 - w * w) ** 2])
    return sorted(float(v.real) for v in roots if abs(v.imag) < 1e-12 and v.real > 0.0)


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
@pytest.mark.parametrize(("w", "gap"), [(1.8, 0.3), (1.8, 0.02), (2.2, 0.1)])
def test_orbits_far_above_grazing_are_those_of_the_closed_form(w: float, gap: float) -> None:
    oscillator = one_mode(w, gap, 0.8)
    found = Shooting(oscillator=oscillator, period=1).orbits(oscillator.excess)
    assert [orbit.speed for orbit in found] == pytest.approx(speeds(w, gap, 0.8), rel=1e-10)


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
@pytest.mark.parametrize("cells", [FAST, *slow(SWEEP)], ids=lambda cells: str(len(cells)))
def test_no_fold_is_missed(cells: list[tuple[int, float, float]]) -> None:
    model, found = single_mode(free_period=0.0408, decay_rate=3.56), 0
    for period, restitution, part in cells:
        drive = HarmonicDrive(frequency=part / 0.0408)
        oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.01, law=newton(restitution)), drive=drive)
        closed = MaximalFamily(oscillator=oscillator, period=period).fold()
        if closed is not None and closed.admissible:
            fold, found = fold_of(Shooting(oscillator=oscillator, period=period)), found + 1
            assert fold is not None and fold.excess == pytest.approx(closed.excess, abs=1e-11)
    assert found > 0.4 * len(cells)


def test_all_searches_find_a_fast_fold() -> None:
    family = Shooting(oscillator=one_mode(1.8, 0.3, 0.8, 0.02), period=1)
    closed = MaximalFamily(oscillator=family.oscillator, period=1).fold().excess
    found = [fold_of(family), *folds_of(family), lowest_of(family).orbit]
    assert [fold.excess for fold in found] == pytest.approx(3 * [closed], abs=1e-11)


def test_a_bound_of_the_speed_is_said_with_its_orbit() -> None:
    """Next to twice the natural frequency an almost elastic orbit folds at 500 times 2 pi f gap."""
    oscillator = one_mode(1.999, 0.1, 0.999)
    family, unit = Shooting(oscillator=oscillator, period=1), oscillator.unit_speed
    assert MaximalFamily(oscillator=oscillator, period=1).fold().speed > 200.0 * unit
    usual = Shooting(oscillator=one_mode(1.6, 0.1, 0.5), period=1)
    beyond = [
        (lambda: folds_of(family), 100.0 * unit),
        (lambda: usual.orbits(1e6), 100.0 * usual.oscillator.unit_speed),
        (lambda: usual.orbits(-1e-9), 1e-6 * usual.oscillator.unit_speed),
    ]
    for search, bound in beyond:
        with pytest.raises(BranchEnded, match=f"{bound:.6g} m/s") as caught:
            search()
        assert caught.value.orbit.speed == pytest.approx(bound)


@pytest.mark.parametrize(("w", "start"), [(1.8, 0.1), (1.2, 0.05), *slow((1.8, 0.01), (1.2, 0.1))])
def test_a_scan_tries_its_lowest_amplitude(w: float, start: float) -> None:
    """A doubled step passes over both the end of the orbit and the lowest excess."""
    oscillator = one_mode(w, 0.3, 0.8, 0.1)
    strobed = StroboscopicMap(oscillator=oscillator.with_excess(start))
    on = settle(strobed, State(displacement=[0.0], velocity=[3.0]), most_cycles=20_000).end
    fold = MaximalFamily(oscillator=oscillator, period=1).fold().excess
    for lowest in (-0.5, -0.9):
        end = orbit_end(strobed, on, start, most_cycles=20_000, lowest=lowest)
        if fold > lowest:
            assert end.kind == "fold" and end.excess == pytest.approx(fold, abs=1e-9)
        else:
            assert end is None


def test_without_an_orbit_to_start_from_the_branch_has_ended() -> None:
    """No orbit with three touches in two periods follows from the orbit of a kick."""
    family = Shooting(oscillator=one_mode(1.2, 0.3, 0.8, 0.1), period=2, impacts=3)
    for search in (fold_of, lowest_of):
        with pytest.raises(BranchEnded, match="start from"):
            search(family)
