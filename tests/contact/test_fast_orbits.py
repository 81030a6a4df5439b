"""Searches of orbits far from grazing: what they find, and where they say that they stopped."""

import math

import numpy as np
import pytest
from oscillators import equation_1, modes_on_stop, newton, slow

from contact import BranchEnded, ImpactOscillator, MaximalFamily, State, StroboscopicMap
from contact.orbits import Shooting, fold_of, orbit_end, settle
from contact.orbits.branches.amplitude_curve import whole_branch

pytestmark = pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
PARTS = {m: np.arange(0.505, m + 1.0, 0.02) for m in (1, 2, 3)}
SWEEP = [(m, e, part) for m in PARTS for e in (0.1, 0.3, 0.5, 0.7, 0.9) for part in PARTS[m]]
"""Period, restitution, f T: below f T = 2 the folds of p1 meet the stop faster than 2 times 2 pi f gap."""


def one_mode(w: float, gap: float, e: float, decay: float = 0.0) -> ImpactOscillator:
    """x'' + decay x' + x = sin(w t) before a stop."""
    drive = (w / (2.0 * math.pi), 1.0 / w**2)
    return modes_on_stop(1.0, decay, participation=1.0, law=newton(e), gap=gap, drive=drive)


@pytest.mark.parametrize(("w", "gap"), [(1.8, 0.02), (2.2, 0.1)])
def test_orbits_far_above_grazing_are_those_of_the_closed_form(w: float, gap: float) -> None:
    """A jump -(1 + e) v that repeats has u = -c v, u' = (1 + e) v/2 before it, c = (1 + e) cot(pi/w)/2."""
    e, c = 0.8, 0.9 / math.tan(math.pi / w)
    roots = np.roots([c * c + ((1.0 - e) / (2.0 * w)) ** 2, 2.0 * gap * c, gap**2 - 1.0 / (1.0 - w * w) ** 2])
    oscillator = one_mode(w, gap, e)
    found = Shooting(oscillator=oscillator, m=1).orbits(oscillator.excess)
    assert [orbit.speed for orbit in found] == pytest.approx([v for v in sorted(roots) if v > 0.0], rel=1e-10)


@pytest.mark.parametrize("cells", [[(1, 0.7, 1.7), (1, 0.9, 1.98)], *slow(SWEEP)], ids=["two", "all"])
def test_no_fold_is_missed(cells: list[tuple[int, float, float]]) -> None:
    count = 0
    for period, tau, part in cells:
        family = Shooting(oscillator=equation_1(part / 0.0408, newton(tau)), m=period)
        closed = MaximalFamily(oscillator=family.oscillator, m=period).fold()
        if closed is not None and closed.admissible:
            found, count = [fold_of(family)], count + 1
            found += whole_branch(family, None)[2].of_kind("fold") if len(cells) < 9 else []
            assert [fold.excess for fold in found] == pytest.approx(len(found) * [closed.excess], abs=1e-11)
    assert count > 0.4 * len(cells)


def test_a_bound_of_the_speed_is_said_with_its_orbit() -> None:
    """Next to twice the natural frequency an almost elastic orbit folds beyond 200 times 2 pi f gap."""
    far, usual = (Shooting(oscillator=one_mode(w, 0.1, e), m=1) for w, e in ((1.999, 0.999), (1.6, 0.5)))
    assert MaximalFamily(oscillator=far.oscillator, m=1).fold().speed > 200 * far.oscillator.unit_speed
    for family, excess, at in ((far, 0.0, 100.0), (usual, 1e6, 100.0), (usual, -1e-9, 1e-6)):
        with pytest.raises(BranchEnded) as caught:
            family.orbits(excess)
        orbit = caught.value.orbit
        assert orbit.speed == caught.value.velocity == pytest.approx(at * orbit.oscillator.unit_speed)


@pytest.mark.parametrize(("w", "start"), [(1.8, 0.1), (1.2, 0.05)])
def test_a_scan_tries_its_lowest_amplitude(w: float, start: float) -> None:
    """A doubled step passes over both the end of the orbit and the lowest excess."""
    strobed = StroboscopicMap(oscillator=one_mode(w, 0.3, 0.8, 0.1).with_excess(start))
    on = settle(strobed, State(displacement=[0.0], velocity=[3.0]), most_cycles=20_000).end
    fold = MaximalFamily(oscillator=strobed.oscillator, m=1).fold().excess
    for lowest, kind in ((fold - 0.06, "fold"), (fold - 0.2, "fold"), (fold + 0.01, "")):
        end = orbit_end(strobed, on, start, most_cycles=20_000, lowest=lowest)
        assert (end is None) if not kind else end.kind == kind and abs(end.excess - fold) < 1e-9


def test_without_an_orbit_to_start_from_the_branch_has_ended() -> None:
    family = Shooting(oscillator=one_mode(1.2, 0.3, 0.8, 0.1), m=2, impacts=3)
    with pytest.raises(BranchEnded, match="start from"):
        fold_of(family)
