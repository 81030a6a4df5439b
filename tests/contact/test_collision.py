"""Restitution, delay, kick and shift of a collision: synthetic ones come back; special collisions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oscillators import GAMMA, GAP, LIGHT, OMEGA, equation_1, light_tip, newton
from whole_motions import pressed

import contact
from beam import ModalModel
from contact import ImpactOscillator, State, before_collision, collisions, first_collision, simulate
from contact.integrators import CentralDifference, Integrator
from contact.orbits import KickFamily


@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.7, 1.0])
@pytest.mark.parametrize("delay", [0.0, 1e-5, 3e-4, 2e-3])
def test_planted_restitution_and_delay_are_given_back(restitution: float, delay: float) -> None:
    for frequency in (20.90, 23.05):
        for excess in (1e-5, 1e-3, 1e-2, 5e-2):
            law = contact.DelayedRestitution(restitution=restitution, delay=delay)
            law = newton(restitution) if delay == 0.0 < restitution else law
            found = first_collision(equation_1(frequency, law, gap=0.0107, excess=excess))
            height = math.sqrt(excess * (2 + excess))
            assert found.approach == pytest.approx(2 * math.pi * frequency * 0.0107 * height, rel=1e-9)
            assert abs(found.restitution - restitution) < 2e-10 and abs(found.delay - delay) < 1e-13
            assert found.contact_time == pytest.approx(delay, abs=1e-16)
            # the wait is a kick and a shift of mode 1, to the order of delay x frequency
            speed, a = found.approach, found.deceleration
            off = 0.15 * delay * 2 * math.pi * frequency * (1 + delay * a / speed)
            assert abs(found.kick - 1 - restitution + delay * a / speed) < off + 1e-9


def two_modes(first: float, second: float, e: float, lead: float) -> tuple[ImpactOscillator, State]:
    """Mode 1 of `first` gaps, `lead` [rad] before its peak; mode 2 of `second` gaps, rising through zero."""
    oscillator = light_tip(2, newton(e), excess=None, damping=0.0)
    amplitude = GAP / LIGHT[:2] * np.array([first, second])
    velocity = amplitude * OMEGA[:2] * [math.sin(lead), 1.0]
    return oscillator, State(displacement=amplitude * [math.cos(lead), 0.0], velocity=velocity)


@pytest.mark.parametrize("second, returns", [(0.056, False), (0.2, True)])
def test_ringing_alone_can_make_the_touch(second: float, returns: bool) -> None:
    """Mode 1 peaks at 0.97 gaps: it would pass by; mode 2 carries the tip into the wall."""
    oscillator, state = two_modes(0.97, second, 0.1, 0.2)
    run = simulate(oscillator, state, duration=0.06)
    c = collisions(run, unfinished="drop")[0]
    assert c.forced_by_ringing and c.returns == returns and c.impacts == 1
    assert all(math.isnan(x) for x in (c.approach, c.restitution, c.delay, c.kick))
    assert c.time == c.first_touch == run.impacts.start[0]
    assert c.ringing == pytest.approx(second * GAP, rel=1e-12)
    share = 1.1 / (1 + 0.81)
    assert c.kick_velocity == pytest.approx(share * c.real_approach, rel=1e-12)
    assert abs(c.shift) < 1e-17
    # with a little more of mode 1 the same touch is one of its own
    oscillator, state = two_modes(1.001, second, 0.1, 0.2)
    other = collisions(simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not other.forced_by_ringing and other.approach > 0


def test_outgoing_motion_may_stay_below_the_gap() -> None:
    """Touched early by the ringing and turned back at once: kick but neither restitution nor delay."""
    oscillator, state = two_modes(1.01, 0.08, 0.1, 0.4)
    c = collisions(simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not c.forced_by_ringing and not c.returns and c.impacts == 1
    assert math.isnan(c.restitution) and math.isnan(c.delay)
    assert c.first_touch < c.time - 1e-4 and c.real_approach != pytest.approx(c.approach, rel=0.01)
    assert c.kick * c.approach == pytest.approx(c.kick_velocity, rel=1e-14) and c.kick > 0.5
    # mode 1 has 1.01 gaps of amplitude before, and less than one after
    after = math.hypot(GAP + c.shift, (c.approach - c.kick_velocity) / OMEGA[0])
    before = math.hypot(GAP, c.approach / OMEGA[0])
    assert before == pytest.approx(1.01 * GAP, rel=1e-12) and after < GAP


def test_collision_that_is_not_final_is_refused_in_a_sentence() -> None:
    oscillator = equation_1(22.2, newton(0.3), gap=0.0107, excess=0.01)
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=8)
    touch, final = float(whole.impacts.start[0]), None
    for after in (1e-5, 0.1 / 22.2, 0.4 / 22.2, 0.6 / 22.2, 0.95 / 22.2):
        run = simulate(oscillator, start, duration=touch - start.time + after)
        assert len(run.impacts) == 1
        try:
            found = collisions(run)
        except ValueError as error:
            assert f"{run.end.time:.6g} s" in str(error) and f"{touch:.6g} s" in str(error)
            assert collisions(run, unfinished="drop") == [] and final is None
            continue
        final = after if final is None else final
        assert len(found) == 1 and found[0] == collisions(whole, unfinished="drop")[0]
    # the next minimum of a motion at about the drive frequency comes half a period later
    assert final == pytest.approx(0.6 / 22.2)


def test_contact_under_way_at_the_end_is_no_collision_yet() -> None:
    oscillator = light_tip(4, contact.HertzContact(stiffness=3e7))
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=4)
    middle = 0.5 * (whole.impacts.start[0] + whole.impacts.end[0])
    run = simulate(oscillator, start, duration=middle - start.time)
    assert len(run.impacts) == 1 and math.isnan(run.impacts.end[0])
    with pytest.raises(ValueError, match="final"):
        collisions(run)
    assert collisions(run, unfinished="drop") == []
    free = simulate(oscillator, start, duration=0.5 * (whole.impacts.start[0] - start.time))
    assert collisions(free) == []


@pytest.mark.parametrize("method", [None, CentralDifference(step=1e-6)], ids=["exact", "stepped"])
def test_contact_under_way_at_the_start_is_no_touch(method: Integrator | None) -> None:
    """Cut in the second collision: it is logged as what it is, and the others are found as without a cut."""
    oscillator = light_tip(4, contact.HertzContact(stiffness=3e7))
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=12, method=method)
    found = collisions(whole, unfinished="drop")
    chosen = np.flatnonzero(whole.impacts.start > found[1].time - 1e-4)[0]
    middle = 0.5 * (whole.impacts.start[chosen] + whole.impacts.end[chosen])
    state = simulate(oscillator, start, duration=middle - start.time, method=method).end
    rest = simulate(oscillator, state, duration=whole.end.time - middle, method=method)
    assert rest.impacts.kind[0] == contact.ImpactKind.UNDER_WAY and math.isnan(rest.impacts.approach[0])
    assert rest.impacts.end[0] == pytest.approx(whole.impacts.end[chosen], abs=1e-8)
    assert np.all(rest.impacts.kind[1:] == contact.ImpactKind.IMPACT)
    again = collisions(rest, unfinished="drop")
    assert len(again) == len(found) - 2 >= 3
    assert [c.kick for c in again] == pytest.approx([c.kick for c in found[2:]], abs=1e-4 if method else 1e-9)


def test_stay_that_goes_on_is_a_stay() -> None:
    oscillator = pressed(3, 0.5)
    whole = simulate(oscillator, periods=30)
    i = np.flatnonzero((whole.impacts.kind == contact.ImpactKind.STAY) & np.isfinite(whole.impacts.end))[0]
    length = whole.impacts.end[i] - whole.impacts.start[i]
    held = simulate(oscillator, duration=float(whole.impacts.start[i] + 0.9 * length)).end
    rest = simulate(oscillator, held, duration=whole.end.time - held.time).impacts
    np.testing.assert_array_equal(rest.kind, whole.impacts.kind[i:])
    assert rest.end[0] == pytest.approx(whole.impacts.end[i], abs=1e-10)


def test_phase_is_kept_over_any_number_of_periods() -> None:
    oscillator = equation_1(22.2, newton(0.1), gap=0.0107, excess=1e-4)
    start = contact.StroboscopicMap(oscillator=oscillator).steady()
    first = first_collision(oscillator, start)
    for periods in (10**6, 10**8):
        later = first_collision(oscillator, replace(start, time=periods * oscillator.period))
        for name in ("kick", "restitution", "delay", "shift", "approach"):
            assert getattr(later, name) == pytest.approx(getattr(first, name), abs=1e-12), name


def test_with_one_mode_each_impact_is_a_collision_however_slow_the_drive() -> None:
    """Between two impacts the motion is the virtual one, and has a minimum."""
    oscillator = equation_1(0.3, newton(0.5), gap=0.0107, excess=0.02)
    run = simulate(oscillator, before_collision(oscillator), periods=3)
    touches = run.impacts.start[run.impacts.kind == contact.ImpactKind.IMPACT]
    found = collisions(run, unfinished="drop")
    assert [c.first_touch for c in found] == touches[:-1].tolist() and touches.size > 40
    assert [c.time for c in found] == pytest.approx(touches[:-1], abs=1e-9)
    assert [c.approach for c in found] == pytest.approx([c.real_approach for c in found], abs=1e-9)


def test_mode_1_is_the_one_that_moves_the_tip_most() -> None:
    """A suspension of 3 Hz below it, or another order of the modes, changes nothing of what is said of it."""
    rows = {"omega": OMEGA[:3], "decay_rate": 0.02 * OMEGA[:3], "phi": LIGHT[:3], "participation": GAMMA[:3]}
    one, three = (ModalModel(**{name: row[:n] for name, row in rows.items()}) for n in (1, 3))
    turned = ModalModel(**{name: row[[2, 0, 1]] for name, row in rows.items()})
    stop, drive = contact.Stop(gap=GAP, law=newton(0.1)), contact.HarmonicDrive(frequency=21.5)
    exciter = one.on_exciter(mass=20.0, suspension_hz=3.0)
    for model, other, digits in ((one, exciter, 2e-2), (three, turned, 1e-9)):
        first, second = (ImpactOscillator(model=m, stop=stop, drive=drive) for m in (model, other))
        pairs = [(model.free_period, other.free_period)]
        pairs.append(tuple(contact.NordmarkMap.from_oscillator(o).alpha for o in (first, second)))
        speed = 0.1 * first.unit_speed
        pairs.append(tuple(KickFamily(oscillator=o, m=3).orbit(speed).excess for o in (first, second)))
        hits = [first_collision(oscillator.with_excess(0.02)) for oscillator in (first, second)]
        pairs += [tuple(getattr(hit, name) for hit in hits) for name in ("kick", "restitution", "ringing")]
        for expected, found in pairs:
            assert found == pytest.approx(expected, rel=digits, abs=digits)
        assert hits[0].kick == pytest.approx(1.1 if model is one else 0.45, abs=0.05)


def test_grazes_are_no_collisions() -> None:
    oscillator = equation_1(22.2, newton(0.3), gap=0.0107, excess=0.0)
    run = simulate(oscillator, before_collision(oscillator), periods=6)
    assert np.all(run.impacts.kind == 1) and collisions(run) == []
