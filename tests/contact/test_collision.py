"""Restitution, delay, kick and shift of a collision: synthetic ones come back; special collisions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from light_spring import PHI, equation_1, flow, newton, real_differs, spring
from oscillators import GAP, OMEGA

from beam import ModalModel, UniformBeam, exact_modes
from contact.collision import before_collision, collisions, first_collision
from contact.drive import HarmonicDrive
from contact.laws import (
    DelayedRestitution,
    HertzContact,
)
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State

# ------------------------------------------------------------------------ planted restitution and delay


@pytest.mark.parametrize("frequency", [20.90, 22.20, 23.40])
@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.3, 0.7, 1.0])
def test_equation_1_has_its_own_restitution_and_no_delay(frequency: float, restitution: float) -> None:
    for excess in (1e-5, 1e-4, 1e-3, 1e-2, 5e-2):
        found = first_collision(equation_1(frequency, newton(restitution), excess))
        speed = 2 * math.pi * frequency * 0.0107 * math.sqrt(excess * (2 + excess))
        assert found.approach == pytest.approx(speed, rel=1e-9)
        assert found.real_approach == pytest.approx(speed, rel=1e-9)
        assert abs(found.restitution - restitution) < 1e-10
        assert abs(found.delay) < 1e-13
        assert abs(found.kick - 1 - restitution) < 1e-10
        assert abs(found.shift) < 1e-16
        assert found.impacts == 1 and found.returns and not found.forced_by_ringing
        assert not real_differs(found)
        assert found.energy_lost == pytest.approx(0.5 * (1 - restitution**2) * speed**2, rel=1e-8, abs=1e-18)
        assert found.energy_to_higher_modes == 0 and found.ringing == 0
        assert found.deceleration == pytest.approx((2 * math.pi * frequency) ** 2 * 0.0107, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("delay", [0.0, 1e-5, 3e-4, 2e-3])
def test_planted_restitution_and_delay_are_given_back(restitution: float, delay: float) -> None:
    for frequency in (20.90, 23.05):
        for excess in (1e-5, 1e-3, 1e-2, 5e-2):
            law = DelayedRestitution(restitution=restitution, delay=delay)
            found = first_collision(equation_1(frequency, law, excess))
            assert abs(found.restitution - restitution) < 2e-10
            assert abs(found.delay - delay) < 1e-13
            assert found.contact_time == pytest.approx(delay, abs=1e-16)
            # the wait is a kick and a shift of mode 1, to the order of delay x frequency
            speed, a = found.approach, found.deceleration
            off = 0.15 * delay * 2 * math.pi * frequency * (1 + delay * a / speed)
            assert abs(found.kick - 1 - restitution + delay * a / speed) < off + 1e-9


def test_planted_functions_of_the_speed_are_given_back() -> None:
    def restitution(v: float) -> float:
        return 0.15 + 0.5 / (1 + 20 * v)

    def delay(v: float) -> float:
        return 2e-4 * (0.1 + v) ** -0.2

    law = DelayedRestitution(restitution=restitution, delay=delay)
    seen = []
    for excess in (1e-5, 1e-4, 1e-3, 1e-2, 5e-2):
        found = first_collision(equation_1(22.2, law, excess))
        assert found.restitution == pytest.approx(restitution(found.approach), abs=2e-9)
        assert found.delay == pytest.approx(delay(found.approach), abs=1e-12)
        seen.append(found.restitution)
    assert seen[0] > seen[-1] + 0.3


def test_every_collision_of_a_long_run_gives_the_planted_numbers() -> None:
    law = DelayedRestitution(restitution=0.25, delay=2e-4)
    oscillator = equation_1(21.5, law, 0.02)
    run = simulate(oscillator, periods=400)
    found = collisions(oscillator, run, unfinished="drop")
    assert len(found) > 40 and np.ptp([c.approach for c in found]) > 0.05
    for c in found:
        # (rounding of the gap) / (height of the hump of the outgoing motion)
        assert abs(c.restitution - 0.25) < 1e-9 and abs(c.delay - 2e-4) < 1e-12


# ------------------------------------------------------------------------------ Newton's law on several modes

SHARES = {
    0.1: [1, 0.634, 0.419, 0.351, 0.320, 0.295],
    0.3: [1, 0.768, 0.634, 0.592, 0.573, 0.557],
    1.0: [1, 0.900, 0.842, 0.824, 0.816, 0.809],
}
"""r_N for N = 1, 2, 5, 10, 20, 100 modes of a cantilever, for each ratio of tip mass to beam mass."""


def cantilever(ratio: float, count: int) -> ModalModel:
    beam = UniformBeam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0, tip_mass=ratio)
    modes = exact_modes(beam, count)
    scale = 2 * math.pi * 24.5 / modes.omega[0]
    return ModalModel(
        omega=scale * modes.omega, decay_rate=0.01 * scale * modes.omega, phi=modes.phi,
        participation=modes.participation,
    )  # fmt: skip


@pytest.mark.parametrize("ratio", SHARES)
def test_kick_of_one_newton_impact_is_the_share_of_mode_1(ratio: float) -> None:
    """(1 + e) phi_1^2 / sum phi_k^2 with the higher modes at rest, and r_N as tabulated."""
    whole = cantilever(ratio, 100)
    seen = 0
    for count, tabulated in zip((1, 2, 5, 10, 20, 100), SHARES[ratio], strict=True):
        model = whole.truncated(count)
        share = float(model.phi[0] ** 2 / np.sum(model.phi**2))
        assert share == pytest.approx(tabulated, abs=6e-4)
        if count > 20:
            continue
        for e in (0.0, 0.4, 1.0):
            oscillator = ImpactOscillator(
                model=model, stop=Stop(gap=0.01, law=newton(e)), drive=HarmonicDrive(frequency=21.5)
            ).with_excess(0.02)
            found = first_collision(oscillator)
            if found.impacts > 1:
                continue
            seen += 1
            assert found.kick == pytest.approx((1 + e) * share, rel=1e-10)
            assert abs(found.shift) < 1e-15 and found.ringing < 1e-15
            assert abs(found.first_touch - found.time) < 1e-15
            assert not real_differs(found)
            # what does not stay in mode 1 is in the others or lost
            assert found.energy_lost == pytest.approx(
                0.5 * (1 - e * e) * found.approach**2 / np.sum(model.phi**2), rel=1e-10, abs=1e-18
            )
    assert seen >= 8


@pytest.mark.parametrize("e", [0.3, 0.6, 0.8])
def test_several_impacts_of_a_collision_are_one_kick(e: float) -> None:
    """Mode 1 gets the sum of the impulses, each carried back to t_in by its own free flow."""
    oscillator = spring(6, newton(e), damping=0.01)
    run = simulate(oscillator, before_collision(oscillator), periods=60)
    found = collisions(oscillator, run, unfinished="drop")
    impacts = run.impacts
    assert np.all(impacts.kind == 0)  # a stay on the wall would push too
    compliance = float(np.sum(PHI**2))
    several = position = 0
    for c in found:
        rows = np.arange(position, position + c.impacts)
        position += c.impacts
        assert impacts.start[rows[0]] == c.first_touch and impacts.end[rows[-1]] == c.end
        u = v = 0.0
        for i in rows:
            du, dv = flow(oscillator, 0.0, -PHI[0] * (1 + e) * impacts.approach[i] / compliance,
                          c.time - impacts.start[i])  # fmt: skip
            u, v = u + du, v + dv
        assert PHI[0] * u == pytest.approx(c.shift, rel=1e-8, abs=1e-13)
        assert -PHI[0] * v == pytest.approx(c.kick_velocity, rel=1e-9)
        assert c.energy_lost == pytest.approx(
            0.5 * (1 - e * e) * np.sum(impacts.approach[rows] ** 2) / compliance, rel=1e-12
        )
        several += c.impacts > 1
    assert several >= 1


# --------------------------------------------------------------------------- collisions of a special kind


def two_modes(first: float, second: float, e: float, lead: float) -> tuple[ImpactOscillator, State]:
    """Mode 1 of `first` gaps, `lead` [rad] before its peak; mode 2 of `second` gaps, rising through zero."""
    oscillator = spring(2, newton(e), excess=None, damping=0.0)
    amplitude = GAP / PHI[:2] * np.array([first, second])
    return oscillator, State(
        displacement=[amplitude[0] * math.cos(lead), 0.0],
        velocity=[amplitude[0] * OMEGA[0] * math.sin(lead), amplitude[1] * OMEGA[1]],
    )


@pytest.mark.parametrize("second, returns", [(0.056, False), (0.2, True)])
def test_ringing_alone_can_make_the_touch(second: float, returns: bool) -> None:
    """Mode 1 peaks at 0.97 gaps: it would pass by; mode 2 carries the tip into the wall."""
    oscillator, state = two_modes(0.97, second, 0.1, 0.2)
    run = simulate(oscillator, state, duration=0.06)
    c = collisions(oscillator, run, unfinished="drop")[0]
    assert c.forced_by_ringing and real_differs(c) and c.returns == returns and c.impacts == 1
    assert all(math.isnan(x) for x in (c.approach, c.restitution, c.delay, c.kick))
    assert c.time == c.first_touch == run.impacts.start[0]
    assert c.ringing == pytest.approx(second * GAP, rel=1e-12)
    share = 1.1 / (1 + 0.81)
    assert c.kick_velocity == pytest.approx(share * c.real_approach, rel=1e-12)
    assert abs(c.shift) < 1e-17
    # with a little more of mode 1 the same touch is one of its own
    oscillator, state = two_modes(1.001, second, 0.1, 0.2)
    other = collisions(oscillator, simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not other.forced_by_ringing and other.approach > 0


def test_outgoing_motion_may_stay_below_the_gap() -> None:
    """Touched early by the ringing and turned back at once: kick but neither restitution nor delay."""
    oscillator, state = two_modes(1.01, 0.08, 0.1, 0.4)
    c = collisions(oscillator, simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not c.forced_by_ringing and not c.returns and c.impacts == 1
    assert math.isnan(c.restitution) and math.isnan(c.delay)
    assert c.first_touch < c.time - 1e-4 and real_differs(c)
    assert c.kick * c.approach == pytest.approx(c.kick_velocity, rel=1e-14) and c.kick > 0.5
    # mode 1 has 1.01 gaps of amplitude before, and less than one after
    after = math.hypot(GAP + c.shift, (c.approach - c.kick_velocity) / OMEGA[0])
    before = math.hypot(GAP, c.approach / OMEGA[0])
    assert before == pytest.approx(1.01 * GAP, rel=1e-12) and after < GAP


def test_collision_that_is_not_final_is_refused_in_a_sentence() -> None:
    oscillator = equation_1(22.2, newton(0.3), 0.01)
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=8)
    touch = float(whole.impacts.start[0])
    final = None
    for after in (1e-5, 0.1 / 22.2, 0.4 / 22.2, 0.6 / 22.2, 0.95 / 22.2):
        run = simulate(oscillator, start, duration=touch - start.time + after)
        assert len(run.impacts) == 1
        try:
            found = collisions(oscillator, run)
        except ValueError as error:
            text = str(error)
            assert text.count(". ") == 0 and "\n" not in text and "before the collision" in text
            assert f"{run.end.time:.6g} s" in text and f"{touch:.6g} s" in text and "longer" in text
            assert collisions(oscillator, run, unfinished="drop") == []
            assert final is None
            continue
        final = after if final is None else final
        assert len(found) == 1
        assert found[0] == collisions(oscillator, whole, unfinished="drop")[0]
    # the next minimum of a motion at about the drive frequency comes half a period later
    assert final == pytest.approx(0.6 / 22.2)
    with pytest.raises(ValueError, match=r'unfinished is .*must be "refuse" or "drop"'):
        collisions(oscillator, whole, unfinished="keep")


def test_contact_under_way_at_the_end_is_no_collision_yet() -> None:
    oscillator = spring(4, HertzContact(stiffness=3e7))
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=4)
    middle = 0.5 * (whole.impacts.start[0] + whole.impacts.end[0])
    run = simulate(oscillator, start, duration=middle - start.time)
    assert len(run.impacts) == 1 and math.isnan(run.impacts.end[0])
    with pytest.raises(ValueError, match="final"):
        collisions(oscillator, run)
    assert collisions(oscillator, run, unfinished="drop") == []
    free = simulate(oscillator, start, duration=0.5 * (whole.impacts.start[0] - start.time))
    assert collisions(oscillator, free) == []


def test_grazes_are_no_collisions() -> None:
    oscillator = equation_1(22.2, newton(0.3), 0.0)
    run = simulate(oscillator, before_collision(oscillator), periods=6)
    assert np.all(run.impacts.kind == 1)
    assert collisions(oscillator, run) == []
