"""Impacts that accumulate, and stays on the wall: closed forms, constrained motion, statics."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oscillators import OMEGA, PHI, heights, modes_on_stop, newton, spring
from whole_motions import HELD, IMPACT, STAY, accelerations, falling_body, integrate, pressed

from beam import ModalModel
from contact import Chatter, HarmonicDrive, ImpactOscillator, State, Stop, simulate


@pytest.mark.parametrize("e", [0.0, 0.5, 0.7, 0.9, 0.99])
def test_bouncing_ball_comes_to_rest_when_it_should(e):
    """Impacts at t_n = sqrt(2h/g) (1 + 2 (e + ... + e^n)), accumulating at 2.55863 s if e = 0.7; then it
    stays. All energy is lost, and the impulses balance the weight."""
    h, g = 1.0, 9.81
    fall = math.sqrt(2 * h / g)
    total = fall * (1 + 2 * e / (1 - e))
    assert e != 0.7 or total == pytest.approx(2.55863, abs=5e-6)
    last = total * np.array([1 - 1.2e-5, 1 + 4e-6])  # next to the last hops
    times = np.append(np.linspace(0, 1.5 * total, 401), last)
    run = simulate(falling_body(h, newton(e)), duration=1.5 * total, times=np.sort(times))
    hits = run.impacts.kind == IMPACT
    n = np.arange(hits.sum())
    known, arrivals = e**n > 1e-4, fall * (1 + 2 * e * (1 - e**n) / (1 - e))
    np.testing.assert_allclose(run.impacts.start[hits][known], arrivals[known], rtol=5e-14 / (1 - e))
    # a hop of height h e^(2n) is known to the rounding of h
    speed = g * fall * e**n
    error = np.abs(run.impacts.approach[hits] / speed - 1)[known]
    assert np.all(error < 30 * np.finfo(float).eps / e ** (2 * n[known]))
    assert hits.sum() > 20 or e == 0.0
    # from every impact on, the hops left take 2 e v/(g (1 - e))
    left = 2 * e * run.impacts.approach[hits] / (g * (1 - e))
    np.testing.assert_allclose(run.impacts.start[hits] + left, total, rtol=1e-8)
    assert list(np.flatnonzero(run.impacts.kind == STAY)) == [len(run.impacts) - 1]
    assert run.impacts.start[-1] == pytest.approx(total, rel=1e-13) and run.impacts.approach[-1] == 0.0
    resting = run.time > total + 1e-6
    assert np.max(np.abs(run.displacement[resting] - h)) < 1e-15
    assert np.max(np.abs(run.velocity[resting])) < 1e-14 and np.all(run.displacement[~resting] < h)
    assert run.end.regime == HELD and run.impacts.loss.sum() == pytest.approx(g * h, rel=1e-13)
    assert run.impacts.impulse.sum() == pytest.approx(1.5 * total * g, rel=1e-13)
    assert run.impacts.peak_force[-1] == pytest.approx(g, rel=1e-14) and math.isnan(run.impacts.duration[-1])
    assert np.all(np.isnan(run.impacts.peak_force[:-1]))


@pytest.mark.parametrize("left", [3e-3, 1e-3, 3e-4, 1.3e-4])
def test_hops_of_an_almost_elastic_ball_do_not_lock_into_one_another(left):
    """Rounding moves a speed by some left/10 in each of the lowest hops, in 1/left hops by sqrt(left)/10."""
    gravity, gap = 9.81, 1e-3
    speed = 0.25 * gravity * left
    state = State(displacement=np.array([gap]), velocity=np.array([-speed]))
    run = simulate(falling_body(gap, newton(1.0 - left)), state, duration=0.9)
    hops = run.impacts.approach[run.impacts.kind == 0]
    assert run.end.regime == 3
    expected = speed * (1.0 - left) ** np.arange(hops.size)
    np.testing.assert_allclose(hops / expected, 1.0, atol=0.1 * math.sqrt(left))
    rest = run.impacts.start[-1] + 2 * abs(run.impacts.approach[-1]) / (gravity * left)
    assert rest == pytest.approx(0.5, rel=1e-5)


def test_more_hops_than_are_counted_are_refused_as_chatter():
    """Hops of a ball that rests after half a period: 1e5, as many as one may hold, at 1 - e = 4.69e-5."""
    for left, refused in ((4.9e-5, False), (4.5e-5, True)):
        ball = falling_body(1e-3, newton(1.0 - left))
        start = State(displacement=np.array([1e-3]), velocity=np.array([-0.25 * 9.81 * left]))
        if refused:
            with pytest.raises(Chatter, match="accumulate") as caught:
                simulate(ball, start, duration=0.9)
            assert 0 < caught.value.time < 0.9 and abs(caught.value.gap) <= 1e-8
            assert abs(caught.value.velocity) <= 5e-4
        else:
            run = simulate(ball, start, duration=0.9)
            assert run.end.regime == HELD and 0.9e5 < len(run.impacts) < 1e5


@pytest.mark.parametrize("left", [2.0**-53, 1e-14, 1e-12, 1e-10, 1e-6, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("drop", [5e-3, 1e-5])
def test_impacts_next_to_elastic_lose_their_part_and_no_more(left, drop):
    """An undamped spring that a load presses on the stop: speeds fall as e^n, and the log has all energy."""
    omega, rest = 154.0, 0.02
    ball = modes_on_stop(omega, law=newton(1.0 - left), gap=0.01, load=rest * omega**2)
    start = State(displacement=np.array([0.01 - drop]), velocity=np.zeros(1))
    run = simulate(ball, start, duration=0.3)
    assert (run.end.regime == HELD) == (left >= 0.1)
    hits = run.impacts.approach[run.impacts.kind == IMPACT]
    speeds = omega * math.sqrt(drop * (2 * (rest - 0.01) + drop)) * (1.0 - left) ** np.arange(hits.size)
    known = speeds > 0.1 * speeds[0]
    np.testing.assert_allclose(hits[known], speeds[known], rtol=1e-14 / drop)
    before, after = (ball.energy(state.displacement - rest, state.velocity) for state in (start, run.end))
    assert before - after == pytest.approx(run.impacts.loss.sum(), rel=0, abs=3e-14 * before)


@pytest.mark.parametrize("e", [0.7, 0.99])
def test_accumulation_that_straddles_a_strobe_loses_no_time(e):
    """Without a drive nothing depends on when the run starts; the strobe is put among the last hops."""
    h, beside = 1e-3, 2 * np.pi * 3.0
    oscillator = falling_body(h, newton(e), beside=(beside,))
    total = math.sqrt(2 * h / 9.81) * (1 + 2 * e / (1 - e))
    length = total + 0.1
    start = dict(displacement=np.array([0.0, 0.0]), velocity=np.array([0.0, 1.0]))
    plain = simulate(oscillator, State(**start), duration=length)
    stay = np.flatnonzero(plain.impacts.kind == STAY)[0]
    left = 2 * abs(plain.impacts.rebound[stay - 1]) / (9.81 * (1 - e))
    assert left > 1e-8
    strobe = 20 * oscillator.period
    for part in (0.1, 0.5, 0.9):
        at = strobe - plain.impacts.start[stay] - part * left
        hops = plain.impacts.start[stay] + 0.5 * part * left  # the strobe comes after them
        times = np.array([0.5 * total, hops, total + 1e-3, total + 0.03])
        run = simulate(oscillator, State(time=at, **start), duration=length, times=at + times)
        np.testing.assert_allclose(run.displacement[:, 1], np.sin(beside * times) / beside, atol=1e-12)
        np.testing.assert_allclose(heights(oscillator, run.displacement)[1:], 0.0, atol=1e-15)
        assert run.end.displacement[1] == pytest.approx(math.sin(beside * length) / beside, abs=1e-12)
        assert run.end.velocity[1] == pytest.approx(math.cos(beside * length), abs=1e-11)
        assert run.end.regime == HELD


@pytest.mark.parametrize("n_modes, restitution", [(1, 0.0), (3, 0.0), (6, 0.0), (1, 0.5), (3, 0.5), (6, 0.5)])
def test_stay_on_the_wall_is_the_constrained_motion(n_modes, restitution):
    """Held, the tip stays at the gap to rounding, the modes obey the constrained equations until pulled."""
    oscillator = pressed(n_modes, restitution, amplitude=2e-3 if n_modes == 1 else 4e-4)
    period, run = oscillator.period, simulate(oscillator, periods=30)
    impacts = run.impacts
    stays = np.flatnonzero((impacts.kind == STAY) & np.isfinite(impacts.end))
    long = stays[impacts.end[stays] - impacts.start[stays] > 0.02 * period]
    assert long.size >= 1, "the tip never stayed: nothing was tested"
    for i in long[:2]:
        # from a little after the accumulation to a little after the release
        begin = impacts.start[i] + 1e-3 * period
        times = np.linspace(begin, impacts.end[i] + 2e-3 * period, 60)
        sampled = simulate(oscillator, duration=30 * period, times=np.append(times, 30 * period))
        held = times < impacts.end[i]
        assert np.max(np.abs(heights(oscillator, sampled.displacement[:-1][held]))) < 1e-14
        assert np.max(np.abs(sampled.velocity[:-1][held] @ oscillator.model.phi)) < 1e-12
        start = State(displacement=sampled.displacement[0], velocity=sampled.velocity[0], time=begin)
        other = integrate(oscillator, start, times, held=True)
        scale = np.max(np.abs(other.velocity))
        assert len(other.release) == 1
        assert other.release[0] == pytest.approx(impacts.end[i], abs=1e-9 * period)
        assert np.max(np.abs(sampled.velocity[:-1] - other.velocity)) < 1e-9 * scale
        # at the release force and relative acceleration vanish together
        q, v = impacts.displacement_end[i], impacts.velocity_end[i]
        assert abs(heights(oscillator, q)) < 1e-14
        model = oscillator.model
        pull = model.phi * accelerations(oscillator)(impacts.end[i], q, v)
        assert abs(pull.sum()) < 1e-9 * np.abs(model.phi) @ (model.omega**2 * np.abs(q))


def test_held_for_good_under_a_load_without_drive():
    """Plastic impact on the wall, pressed: it never leaves, and the modes settle under the constraint."""
    n = 3
    load = 2.0 * 0.005 / PHI[0] * OMEGA[0] ** 2 * np.eye(n)[0]
    oscillator = spring(n, newton(0.0), load=load)
    run = simulate(oscillator, duration=60.0)
    assert run.end.regime == HELD and abs(heights(oscillator, run.end.displacement)) < 1e-14
    # statics: omega^2 q = g - phi N with phi q = gap
    flexible = PHI[:n] / OMEGA[:n] ** 2
    force = (flexible @ load - oscillator.stop.gap) / (flexible @ PHI[:n])
    np.testing.assert_allclose(run.end.displacement, (load - PHI[:n] * force) / OMEGA[:n] ** 2, rtol=1e-10)
    assert np.max(np.abs(run.end.velocity)) < 1e-10


def test_a_mass_thrown_at_a_ceiling_comes_to_rest_on_the_floor():
    """Two stops: up against the ceiling at h, down to the floor, and there hops for 2 e v/(g (1 - e))."""
    g, h, start, v, ceiling, floor = 9.81, 0.1, 0.01, 3.0, 0.6, 0.5
    model = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[1.0])
    stops = Stop(gap=0.0, law=newton(floor), side=-1), Stop(gap=h, law=newton(ceiling))
    box = ImpactOscillator(model=model, stops=stops, load=np.array([-g]))
    run = simulate(box, State(displacement=[start], velocity=[v]), duration=1.0)
    up = math.sqrt(v**2 - 2 * g * (h - start))
    down = math.hypot(ceiling * up, math.sqrt(2 * g * h))
    times = np.cumsum([(v - up) / g, (down - ceiling * up) / g, 2 * floor * down / (g * (1 - floor))])
    assert run.impacts.stop.tolist() == [1] + [0] * (len(run.impacts) - 1)
    np.testing.assert_allclose([*run.impacts.start[:2], run.impacts.start[-1]], times, rtol=1e-14)
    assert run.impacts.kind[-1] == STAY and (run.end.regime, run.end.stop) == (HELD, 0)
    stays = simulate(box, run.end, duration=0.5)
    assert stays.impacts.kind.tolist() == [STAY] and stays.end.displacement[0] == 0.0


@pytest.mark.parametrize("beside", [0, 1])
@pytest.mark.parametrize("turns, stays", [(0.5, False), (1.0, True), (0.0, True)])
def test_plastic_touch_without_acceleration(turns, stays, beside):
    """A free mass under A sin w t meets the wall where this vanishes: it leaves with -A w t^3/6 where it
    falls, and stays where it rises, or where there is no drive at all.  So it does beside another stop."""
    w, v, law = 2.0 * math.pi, 2.0, newton(0.0)
    drive = HarmonicDrive(frequency=1.0, amplitude=0.1) if turns else None
    start = State(displacement=[1.0 - v * turns - 0.1 * w * turns], velocity=[v])
    far = Stop(gap=9.0, law=law, side=-1)
    one = modes_on_stop(0.0, participation=1.0, gap=1.0, law=law)
    model = replace(one.model, dimensionless=True)
    oscillator = ImpactOscillator(model=model, stops=(one.stop, far)[: 1 + beside], drive=drive)
    run = simulate(oscillator, start, duration=1.3)
    assert list(run.impacts.kind) == [IMPACT] + [STAY] * stays
    late = 1.3 - turns
    way = 0.0 if stays else 0.1 * (math.sin(w * late) - w * late)
    assert run.end.displacement[0] - 1.0 == pytest.approx(way, abs=1e-13)
