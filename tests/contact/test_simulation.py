"""Whole motions against closed forms, against DOP853 split at events, and against their own invariants."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from oscillators import OMEGA, PHI, equation_1, heights, spring
from scipy.integrate import solve_ivp

from beam import ModalModel
from contact.errors import Chatter, ContactTooStiff, UnresolvedCrossing
from contact.laws import ContactLaw, LinearContact, NewtonRestitution
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import Regime, State, Trajectory

FREE, CONTACT, INSIDE, HELD = 0, 1, 2, 3
IMPACT, GRAZE, STAY = 0, 1, 2


def falling_body(
    height: float, law: ContactLaw, *, gravity: float = 9.81, beside: tuple[float, ...] = ()
) -> ImpactOscillator:
    """Unit mass falling on a floor; modes `beside` [rad/s] that neither touch nor feel anything."""
    omega = np.array([0.0, *beside])
    one = (omega == 0).astype(float)
    model = ModalModel(omega=omega, decay_rate=0 * omega, phi=one, participation=0 * omega)
    return ImpactOscillator(model=model, stop=Stop(gap=height, law=law), load=gravity * one)


# ------------------------------------------------------------------------- an independent event-driven motion


@dataclass
class Motion:
    """What the independent integration found."""

    times: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    end: np.ndarray = field(default_factory=lambda: np.zeros(0))
    touch: list[float] = field(default_factory=list)
    release: list[float] = field(default_factory=list)
    approach: list[float] = field(default_factory=list)
    rebound: list[float] = field(default_factory=list)
    loss: list[float] = field(default_factory=list)


def integrate(oscillator: ImpactOscillator, state: State, times: np.ndarray, *, held: bool = False) -> Motion:
    """The modal equations by DOP853, split at every touch, release and change of sign of the contact force.

    Beside the modes it integrates the work done on the stop.  `held` starts on the wall, kept there by
    whatever force that takes, until it would pull.
    """
    model, law, gap = oscillator.model, oscillator.stop.law, oscillator.stop.gap
    omega, decay, phi = model.omega, model.decay_rate, model.phi
    n = omega.size
    load = np.zeros(n) if oscillator.load is None else oscillator.load
    w = oscillator.drive.angular_frequency if oscillator.drive else 0.0
    push = model.participation * (oscillator.drive.amplitude if oscillator.drive else 0.0) * w**2
    linear = isinstance(law, LinearContact)
    k, c = (law.stiffness, law.damping) if linear else (0.0, 0.0)

    def free(t, y):
        return load + push * math.sin(w * t) - decay * y[n : 2 * n] - omega**2 * y[:n]

    def law_force(y):
        return k * (phi @ y[:n] - gap) + c * (phi @ y[n : 2 * n])

    def holding(t, y):
        return phi @ free(t, y) / (phi @ phi)

    def right(t, y, regime):
        force = {FREE: 0.0, INSIDE: 0.0, CONTACT: law_force(y), HELD: holding(t, y)}[regime]
        return np.concatenate([y[n : 2 * n], free(t, y) - phi * force, [force * (phi @ y[n : 2 * n])]])

    def height(t, y, regime):
        return phi @ y[:n] - gap

    def sign_of_force(t, y, regime):
        return holding(t, y) if regime == HELD else law_force(y)

    motion = Motion(times, np.full((times.size, n), np.nan), np.full((times.size, n), np.nan))
    t, end = state.time, float(times[-1])
    y = np.concatenate([state.displacement, state.velocity, [0.0]])
    regime = HELD if held else FREE
    while t < end:
        surface = {FREE: [(height, 1)], CONTACT: [(sign_of_force, -1)], HELD: [(sign_of_force, -1)],
                   INSIDE: [(height, -1), (sign_of_force, 1)]}[regime]  # fmt: skip
        events = []
        for function, direction in surface:

            def event(t, y, regime=regime, function=function):
                return function(t, y, regime)

            event.terminal, event.direction = True, direction
            events.append(event)
        # leave the surface on which the stretch begins before watching it
        dt = min(1e-6 / omega.max() if omega.max() > 0 else 1e-6, 0.5 * (end - t))
        settings = dict(args=(regime,), method="DOP853", rtol=3e-14, atol=1e-18)
        first = solve_ivp(right, (t, t + dt), y, **settings)
        rest = solve_ivp(right, (t + dt, end), first.y[:, -1], events=events, dense_output=True,
                         max_step=1.0 / max(omega.max(), w, 1.0), **settings)  # fmt: skip
        inside = (times >= t) & (times <= rest.t[-1])
        for i in np.flatnonzero(inside):
            at = rest.sol(max(times[i], t + dt)) if times[i] > t else y
            motion.displacement[i], motion.velocity[i] = at[:n], at[n : 2 * n]
        t, y = float(rest.t[-1]), rest.y[:, -1].copy()
        if rest.status == 0:
            break
        speed = phi @ y[n : 2 * n]
        if regime == FREE:
            motion.touch.append(t)
            motion.approach.append(speed)
            y[-1] = 0.0
            if linear:
                regime = CONTACT
                continue
            e = law.local_restitution
            y[n : 2 * n] -= phi * (1 + e) * speed / (phi @ phi)
            motion.release.append(t)
            motion.rebound.append(-e * speed)
            motion.loss.append(0.5 * (1 - e * e) * speed**2 / (phi @ phi))
            if e == 0 and holding(t, y) > 0:
                regime = HELD
        elif regime == CONTACT and c > 0:
            regime = INSIDE
        elif regime == INSIDE and rest.t_events[1].size:
            regime = CONTACT
        else:
            motion.release.append(t)
            motion.rebound.append(speed)
            motion.loss.append(y[-1])
            regime = FREE
    motion.end = y
    return motion


def assert_same_motion(run: Trajectory, other: Motion, *, digits: float) -> None:
    """States at the sample times and the whole list of impacts, errors relative to the largest value."""
    for mine, theirs in ((run.displacement, other.displacement), (run.velocity, other.velocity)):
        assert np.max(np.abs(mine - theirs)) < digits * np.max(np.abs(theirs))
    impacts = run.impacts
    own = impacts.kind == IMPACT
    assert own.sum() == len(other.touch)
    np.testing.assert_allclose(impacts.start[own], other.touch, rtol=0, atol=digits * run.end.time)
    np.testing.assert_allclose(
        impacts.approach[own], other.approach, rtol=0, atol=digits * max(other.approach)
    )
    done = np.isfinite(impacts.end[own])
    assert done.sum() >= len(other.release) >= done.sum() - 1
    count = len(other.release)
    np.testing.assert_allclose(impacts.end[own][:count], other.release, rtol=0, atol=digits * run.end.time)
    np.testing.assert_allclose(
        impacts.rebound[own][:count], other.rebound, rtol=0, atol=digits * max(other.approach)
    )
    np.testing.assert_allclose(
        impacts.loss[own][:count], other.loss, rtol=0, atol=digits * max(max(other.loss), 1e-3)
    )


# ------------------------------------------------------------------------------------------ the bouncing ball


def test_bouncing_ball_comes_to_rest_when_it_should():
    """Impacts at t_n = sqrt(2h/g) (1 + 2 (e + ... + e^n)), accumulating at 2.55863 s; then the ball stays."""
    e, h, g = 0.7, 1.0, 9.81
    run = simulate(
        falling_body(h, NewtonRestitution(local_restitution=e)), duration=4.0,
        times=np.sort(np.append(np.linspace(0, 4, 401), [2.5586, 2.55864])),  # next to the end of the hops
    )  # fmt: skip
    fall = math.sqrt(2 * h / g)
    total = fall * (1 + 2 * e / (1 - e))
    assert total == pytest.approx(2.55863, abs=5e-6)
    hits = run.impacts.kind == IMPACT
    n = np.arange(hits.sum())
    # the first 25 have speeds above 1e-4 of the first
    np.testing.assert_allclose(
        run.impacts.start[hits][:25], (fall * (1 + 2 * e * (1 - e**n) / (1 - e)))[:25], rtol=1e-13
    )
    # a hop of height h e^(2n) is known to the rounding of h
    speed = g * fall * e**n
    error = np.abs(run.impacts.approach[hits] / speed - 1)[:25]
    assert np.all(error < 30 * np.finfo(float).eps / e ** (2 * n[:25]))
    np.testing.assert_allclose(
        run.impacts.loss[hits], 0.5 * (1 - e * e) * run.impacts.approach[hits] ** 2, rtol=1e-15
    )
    assert hits.sum() > 30
    # from every impact on, the hops left take 2 e v/(g (1 - e))
    left = 2 * e * run.impacts.approach[hits] / (g * (1 - e))
    np.testing.assert_allclose((run.impacts.start[hits] + left)[:20], total, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.impacts.start[hits] + left, total, rtol=0, atol=1e-9)
    assert list(np.flatnonzero(run.impacts.kind == STAY)) == [len(run.impacts) - 1]
    assert run.impacts.start[-1] == pytest.approx(total, abs=1e-5)
    resting = run.time > total + 1e-6
    assert np.max(np.abs(run.displacement[resting] - h)) < 1e-15
    assert np.max(np.abs(run.velocity[resting])) < 1e-14
    assert np.all(run.displacement[~resting] < h)
    assert run.end.regime == HELD
    assert run.impacts.loss[hits].sum() == pytest.approx(g * h, rel=1e-10)


@pytest.mark.parametrize("e", [0.5, 0.9, 0.99])
def test_accumulation_takes_the_time_it_should(e):
    """A clock mode beside the ball shows when it came to rest: only then does the stay begin."""
    h, g = 1e-3, 9.81
    total = math.sqrt(2 * h / g) * (1 + 2 * e / (1 - e))
    run = simulate(falling_body(h, NewtonRestitution(local_restitution=e)), duration=1.1 * total)
    # what is left when hops drown in rounding: their sum, w 2/(g (1 - e)) of the last speed
    stay = run.impacts.kind == STAY
    assert stay.sum() == 1
    left = 2 * abs(run.impacts.approach[stay][0]) / (g * (1 - e))
    assert run.impacts.start[stay][0] + left == pytest.approx(total, rel=1e-9)


@pytest.mark.parametrize("left", [3e-3, 1e-3, 3e-4, 1.3e-4])
def test_hops_of_an_almost_elastic_ball_do_not_lock_into_one_another(left):
    """Rounding moves a speed by some left/10 in each of the lowest hops, in 1/left hops by sqrt(left)/10."""
    gravity, gap = 9.81, 1e-3
    ball = ModalModel(omega=[0.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(
        model=ball, stop=Stop(gap=gap, law=NewtonRestitution(local_restitution=1.0 - left)), load=[gravity]
    )
    speed = 0.25 * gravity * left
    state = State(displacement=np.array([gap]), velocity=np.array([-speed]))
    run = simulate(oscillator, state, duration=0.9)
    hops = run.impacts.approach[run.impacts.kind == 0]
    assert run.end.regime == 3
    expected = speed * (1.0 - left) ** np.arange(hops.size)
    np.testing.assert_allclose(hops / expected, 1.0, atol=0.1 * math.sqrt(left))
    rest = run.impacts.start[-1] + 2 * abs(run.impacts.approach[-1]) / (gravity * left)
    assert rest == pytest.approx(0.5, rel=1e-5)


@pytest.mark.parametrize("e", [0.7, 0.99])
def test_accumulation_that_straddles_a_strobe_loses_no_time(e):
    """Without a drive nothing depends on when the run starts; the strobe is put among the last hops."""
    h, beside = 1e-3, 2 * np.pi * 3.0
    oscillator = falling_body(h, NewtonRestitution(local_restitution=e), beside=(beside,))
    total = math.sqrt(2 * h / 9.81) * (1 + 2 * e / (1 - e))
    length = total + 0.1
    start = dict(displacement=np.array([0.0, 0.0]), velocity=np.array([0.0, 1.0]))
    plain = simulate(oscillator, State(**start), duration=length)
    stay = np.flatnonzero(plain.impacts.kind == STAY)[0]
    left = 2 * abs(plain.impacts.approach[stay]) / (9.81 * (1 - e))
    assert left > 1e-8
    strobe = 20 * oscillator.period
    for part in (0.1, 0.5, 0.9):
        at = strobe - plain.impacts.start[stay] - part * left
        run = simulate(oscillator, State(time=at, **start), duration=length)
        assert run.end.displacement[1] == pytest.approx(math.sin(beside * length) / beside, abs=1e-12)
        assert run.end.velocity[1] == pytest.approx(math.cos(beside * length), abs=1e-11)
        assert run.end.regime == HELD


# ----------------------------------------------------------------------------------------------- Equation (1)


@pytest.mark.parametrize("frequency, excess", [(20.90, 0.02), (22.20, 0.05), (23.40, 0.3)])
def test_equation_1_is_the_motion_of_an_independent_integration(frequency, excess):
    oscillator = equation_1(frequency, excess=excess)
    state = State(displacement=[0.2], velocity=[-11.0], time=0.3 * oscillator.period)
    times = np.linspace(state.time, state.time + 12.4 * oscillator.period, 150)
    other = integrate(oscillator, state, times)
    run = simulate(oscillator, state, duration=times[-1] - times[0], times=times)
    assert len(other.touch) >= 4
    assert_same_motion(run, other, digits=3e-10)


FOLDS = [
    (20.90, 3, -1.2784409283e-3),
    (21.50, 4, -1.32105924246e-2),
    (22.20, 5, -1.4773426733e-3),
    (22.60, 6, -1.6810390565e-4),
    (23.05, 8, -1.2823017008e-4),
    (23.40, 11, -1.0196700981e-3),
]


def keeps_its_period(
    frequency: float, excess: float, state: State | None, period: int, blocks: int
) -> State | None:
    """The state after `blocks` times `period` drive periods if each held one impact; else None."""
    oscillator = equation_1(frequency, excess=excess)
    run = simulate(oscillator, state, periods=blocks * period)
    impacts = run.strobe_impacts.reshape(blocks, period).sum(axis=1)
    x = run.strobe_displacement[period - 1 :: period, 0]
    if np.any(impacts[-blocks // 2 :] != 1) or abs(x[-1] - x[-2]) > 1e-5:
        return None
    end = run.end
    return State(displacement=end.displacement, velocity=end.velocity, regime=end.regime)


@pytest.mark.parametrize(
    "frequency, period, fold", [FOLDS[0], *(pytest.param(*row, marks=pytest.mark.slow) for row in FOLDS[1:])]
)
def test_downward_scan_ends_at_the_fold_of_the_letters_orbits(frequency, period, fold):
    """The orbit with one impact in m periods, born at grazing, carried down until it is lost.

    Next to a fold the motion lingers for about pi/sqrt(distance) orbits: 12 000 tell 2e-8 of the excess.
    """
    start = min(1e-3, 2 * abs(fold))
    state = keeps_its_period(frequency, start, None, period, 1500)
    assert state is not None, "no orbit of this period above grazing"
    kept, step = start, 0.25 * abs(fold)
    while step > 1e-8:
        moved = keeps_its_period(frequency, kept - step, state, period, 12_000)
        if moved is None:
            step *= 0.5
        else:
            kept, state = kept - step, moved
        assert kept > 2 * fold, "the orbit outlived its fold"
    assert kept == pytest.approx(fold, abs=1e-7)
    assert keeps_its_period(frequency, fold - 2e-7, state, period, 12_000) is None


# ------------------------------------------------------------------------------------------- many modes, laws


@pytest.mark.parametrize(
    "n_modes, law",
    [
        (2, LinearContact(stiffness=2e4)),
        (6, LinearContact(stiffness=3e5)),
        (2, LinearContact(stiffness=2e4, damping=4.0)),
        (6, LinearContact(stiffness=3e5, damping=10.0)),
        (4, LinearContact(stiffness=1e4, damping=60.0)),
        (3, NewtonRestitution(local_restitution=0.6)),
    ],
    ids=repr,
)
def test_driven_modes_are_those_of_an_independent_integration(n_modes, law):
    """Some drive periods with several contacts: states, times of touch and release, speeds, losses."""
    oscillator = spring(n_modes, law, drive=(21.5, 1.6e-3))
    state = State(displacement=np.zeros(n_modes), velocity=np.full(n_modes, 0.02), time=0.01)
    times = np.linspace(state.time, state.time + (2.3 if n_modes > 3 else 6.3) * oscillator.period, 200)
    other = integrate(oscillator, state, times)
    run = simulate(oscillator, state, duration=times[-1] - times[0], times=times)
    assert len(other.touch) >= 2
    assert_same_motion(run, other, digits=3e-8)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.5, 0.99, 1.0, 1.01, 3.0])
def test_free_mass_on_spring_and_dashpot_rebounds_without_pull(ratio):
    """m d'' = -(k d + c d') lets go where k d + c d' = 0; the rest is free flight.  In closed form."""
    k, speed = 4e4, 0.3
    c = 2 * ratio * math.sqrt(k)
    oscillator = falling_body(0.01, LinearContact(stiffness=k, damping=c), gravity=0.0)
    run = simulate(oscillator, State(displacement=[0.0], velocity=[speed]), duration=0.2)
    w = math.sqrt(k)
    if ratio < 1:
        wd = w * math.sqrt(1 - ratio**2)
        # k d + c d' = 0 at tan(wd t) = -2 r sqrt(1 - r^2)/(1 - 2 r^2)
        t = math.atan2(2 * ratio * math.sqrt(1 - ratio**2), 2 * ratio**2 - 1) / wd if ratio else math.pi / wd
        depth = speed / wd * math.exp(-ratio * w * t) * math.sin(wd * t)
    elif ratio == 1:
        t = 2 / w
        depth = speed * t * math.exp(-w * t)
    else:
        a, b = w * (ratio - math.sqrt(ratio**2 - 1)), w * (ratio + math.sqrt(ratio**2 - 1))
        # k d + c d' with k = a b, c = a + b: a^2 exp(-at) = b^2 exp(-bt)
        t = 2 * math.log(b / a) / (b - a)
        depth = speed * (math.exp(-a * t) - math.exp(-b * t)) / (b - a)
    rebound = k * depth / c if ratio else speed
    assert len(run.impacts) == 1
    assert run.impacts.start[0] == pytest.approx(0.01 / speed, rel=1e-13)
    assert run.impacts.rebound[0] == pytest.approx(-rebound, rel=1e-10)
    assert run.impacts.end[0] == pytest.approx(
        0.01 / speed + t + (depth / rebound if ratio else 0.0), rel=1e-10
    )
    assert run.impacts.loss[0] == pytest.approx(0.5 * (speed**2 - rebound**2), rel=1e-9, abs=1e-14)
    assert run.end.velocity[0] == pytest.approx(-rebound, rel=1e-10)


@pytest.mark.parametrize("damping", [2.0, 30.0, 300.0])
def test_dashpot_never_pulls(damping):
    """The energy of the modes rests while the tip is off the wall, or inside it with k d + c d' < 0.

    Elsewhere it changes by the work of k d + c d'.
    """
    law = LinearContact(stiffness=5e4, damping=damping)
    oscillator = spring(6, law, damping=0.0)
    state = State(displacement=[-0.003, 0, 0, 0, 0, 0], velocity=np.zeros(6))
    times = np.linspace(0, 0.1, 100_001)
    run = simulate(oscillator, state, duration=0.1, times=times)
    energy = oscillator.energy(run.displacement, run.velocity)
    depth = heights(oscillator, run.displacement)
    speed = run.velocity @ oscillator.model.phi
    force = law.stiffness * depth + law.damping * speed
    pushed, inside = (depth > 0) & (force > 0), (depth > 0) & (force < 0)
    assert inside.sum() > 20, "it never let go inside the wall: nothing was tested"
    change = np.diff(energy) / energy[0]
    # a contact within one sampling interval of 1 us would not show in the samples
    brief = np.zeros(change.size, dtype=bool)
    brief[np.searchsorted(times, run.impacts.start) - 1] = True
    free = ~pushed[1:] & ~pushed[:-1] & ~brief
    assert np.max(np.abs(change[free])) < 1e-13
    work = -force * speed / energy[0] * times[1]
    along = pushed[1:] & pushed[:-1]
    assert np.max(np.abs(change - 0.5 * (work[1:] + work[:-1]))[along]) < 5e-3 * np.max(np.abs(work[pushed]))
    assert len(run.impacts) >= 2
    assert np.all(run.impacts.rebound[np.isfinite(run.impacts.end)] <= 0)


# --------------------------------------------------------------------------------------------- energy balance


@pytest.mark.parametrize(
    "law, allowed",
    [(LinearContact(stiffness=3e5), 2e-12), (NewtonRestitution(local_restitution=1.0), 1e-13)],
    ids=repr,
)
def test_energy_is_kept_over_1e4_contacts_of_a_conservative_spring(law, allowed):
    oscillator = spring(6, law, damping=0.0)
    state = State(displacement=[-0.002, 0, 0, 0, 0, 0], velocity=np.zeros(6))
    run = simulate(oscillator, state, duration=260.0)
    assert len(run.impacts) > 10_000
    first = oscillator.energy(state.displacement, state.velocity)
    for q, v in (
        (run.strobe_displacement, run.strobe_velocity),
        (run.impacts.displacement_start, run.impacts.velocity_start),
        (run.impacts.displacement_end, run.impacts.velocity_end),
    ):
        energy = oscillator.energy(q, v)
        outside = heights(oscillator, q) < 1e-12  # inside, the stop stores some of it
        assert outside.sum() > 0.9 * outside.size
        assert np.max(np.abs(energy[outside] / first - 1)) < allowed
    assert np.max(np.abs(run.impacts.loss)) < 1e-13 * first
    assert abs(run.impacts.loss.sum()) < 50 * allowed * first


@pytest.mark.parametrize(
    "law",
    [LinearContact(stiffness=3e5, damping=5.0), LinearContact(stiffness=2e4, damping=100.0),
     NewtonRestitution(local_restitution=0.4), NewtonRestitution(local_restitution=0.0)],
    ids=repr,
)  # fmt: skip
def test_energy_lost_is_the_sum_of_the_losses_reported(law):
    oscillator = spring(6, law, damping=0.0)
    state = State(displacement=[-0.003, 0, 0, 0, 0, 0], velocity=np.zeros(6))
    run = simulate(oscillator, state, duration=2.0)
    assert run.end.regime == FREE
    energy = oscillator.energy(run.end.displacement, run.end.velocity)
    first = oscillator.energy(state.displacement, state.velocity)
    finished = np.isfinite(run.impacts.loss)
    assert len(run.impacts) > 10
    assert first - energy == pytest.approx(run.impacts.loss[finished].sum(), rel=1e-11)
    assert first - energy > 0.05 * first
    # and impact by impact
    each = oscillator.energy(run.impacts.displacement_start, run.impacts.velocity_start) - oscillator.energy(
        run.impacts.displacement_end, run.impacts.velocity_end
    )
    np.testing.assert_allclose(each[finished], run.impacts.loss[finished], rtol=0, atol=1e-12 * first)


# ---------------------------------------------------------------------------------------------------- staying


def pressed(n_modes: int, restitution: float, *, amplitude: float = 4e-4) -> ImpactOscillator:
    """A spring whose static load would hold its tip 1.2 gaps out; the drive pulls it off now and then."""
    load = np.zeros(n_modes)
    load[0] = 1.2 * 0.005 / PHI[0] * OMEGA[0] ** 2
    return spring(
        n_modes, NewtonRestitution(local_restitution=restitution), drive=(21.5, amplitude), load=load
    )


@pytest.mark.parametrize("n_modes, restitution", [(1, 0.0), (3, 0.0), (6, 0.0), (1, 0.5), (3, 0.5), (6, 0.5)])
def test_stay_on_the_wall_is_the_constrained_motion(n_modes, restitution):
    """Held, the tip stays at the gap to rounding, the modes obey the constrained equations until pulled."""
    oscillator = pressed(n_modes, restitution, amplitude=2e-3 if n_modes == 1 else 4e-4)
    period = oscillator.period
    run = simulate(oscillator, periods=30)
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
        model, w = oscillator.model, oscillator.drive.angular_frequency
        base = model.participation * oscillator.drive.amplitude * w**2 * math.sin(w * impacts.end[i])
        terms = model.phi * np.array([oscillator.load, base, -model.decay_rate * v, -(model.omega**2) * q])
        assert abs(terms.sum()) < 1e-9 * np.abs(terms).sum()


def test_held_for_good_under_a_load_without_drive():
    """Plastic impact on the wall, pressed: it never leaves, and the modes settle under the constraint."""
    n = 3
    load = np.zeros(n)
    load[0] = 2.0 * 0.005 / PHI[0] * OMEGA[0] ** 2
    oscillator = spring(n, NewtonRestitution(local_restitution=0.0), load=load)
    run = simulate(oscillator, duration=60.0)
    assert run.end.regime == HELD
    assert abs(heights(oscillator, run.end.displacement)) < 1e-14
    # statics: omega^2 q = g - phi N with phi q = gap
    flexible = PHI[:n] / OMEGA[:n] ** 2
    force = (flexible @ load - oscillator.stop.gap) / (flexible @ PHI[:n])
    np.testing.assert_allclose(run.end.displacement, (load - PHI[:n] * force) / OMEGA[:n] ** 2, rtol=1e-10)
    assert np.max(np.abs(run.end.velocity)) < 1e-10


def test_plastic_tip_that_is_not_pressed_leaves_at_once():
    """e = 0 at a peak: no speed is left, the acceleration takes the tip away, nothing sticks."""
    oscillator = spring(1, NewtonRestitution(local_restitution=0.0), damping=0.0)
    run = simulate(oscillator, State(displacement=[0.0], velocity=[0.1]), duration=1.0)
    assert list(run.impacts.kind[:1]) == [IMPACT]
    assert np.all(run.impacts.kind != STAY)
    assert run.end.regime == FREE
    energy = oscillator.energy(run.end.displacement, run.end.velocity)
    assert energy == pytest.approx(0.5 * (OMEGA[0] * 0.005 / PHI[0]) ** 2, rel=1e-12)


# ----------------------------------------------------------------------------------- sampling and composition

SYSTEMS = {
    "one mode, Newton": lambda: equation_1(22.2, excess=0.05),
    "six modes, Newton": lambda: spring(6, NewtonRestitution(local_restitution=0.5), drive=(21.5, 1.5e-3)),
    "three modes, linear": lambda: spring(3, LinearContact(stiffness=2e4, damping=5.0), drive=(21.5, 1.5e-3)),
    "three modes, pressed": lambda: pressed(3, 0.5),
    "no drive": lambda: spring(3, LinearContact(stiffness=2e4), damping=0.0),
}


def shaken(n_modes: int) -> State:
    velocity = np.zeros(n_modes)
    velocity[0] = 0.15
    return State(displacement=np.zeros(n_modes), velocity=velocity)


@pytest.mark.parametrize("name", SYSTEMS)
def test_samples_at_the_strobes_are_the_strobes(name):
    oscillator = SYSTEMS[name]()
    state = shaken(oscillator.n_modes)
    run = simulate(oscillator, state, periods=25, times=np.arange(26) * oscillator.period)
    assert np.array_equal(run.strobe_time, np.arange(1, 26) * oscillator.period)
    scale = np.max(np.abs(run.strobe_velocity))
    np.testing.assert_allclose(run.displacement[0], state.displacement, atol=1e-17)
    np.testing.assert_allclose(run.displacement[1:], run.strobe_displacement, atol=1e-13)
    np.testing.assert_allclose(run.velocity[1:], run.strobe_velocity, atol=1e-12 * scale)
    assert np.array_equal(run.end.displacement, run.strobe_displacement[-1])
    assert np.array_equal(run.end.velocity, run.strobe_velocity[-1])
    hits = run.impacts.start[run.impacts.kind == IMPACT]
    assert hits.size >= 3
    expected = np.histogram(hits, np.arange(26) * oscillator.period)[0]
    assert np.array_equal(run.strobe_impacts, expected)


@pytest.mark.parametrize("name", SYSTEMS)
def test_run_split_in_two_is_the_run_in_one(name):
    """Split anywhere: in flight, in contact, while held, at a strobe, at a touch; ends and samples agree."""
    oscillator = SYSTEMS[name]()
    start = shaken(oscillator.n_modes)
    period = oscillator.period
    length = 6.0 * period
    times = np.linspace(0, length, 120)
    whole = simulate(oscillator, start, duration=length, times=times)
    scale = np.max(np.abs(whole.velocity))
    cuts = [*np.random.default_rng(3).uniform(0.1, 5.9, 25) * period, 2 * period]
    contacts = np.flatnonzero(whole.impacts.end > whole.impacts.start)
    cuts += [0.5 * (whole.impacts.start[i] + whole.impacts.end[i]) for i in contacts[:3]]
    cuts += list(whole.impacts.start[:3])
    regimes = set()
    for cut in cuts:
        one = simulate(oscillator, start, duration=cut, times=times[times <= cut])
        regimes.add(one.end.regime)
        assert one.end.time == pytest.approx(cut, rel=1e-14)
        two = simulate(oscillator, one.end, duration=length - cut, times=times[times > cut])
        both = np.concatenate([one.velocity, two.velocity])
        assert np.max(np.abs(both - whole.velocity)) < 1e-8 * scale
        assert np.max(np.abs(two.end.velocity - whole.end.velocity)) < 1e-8 * scale
        if one.end.regime == FREE:
            starts = np.concatenate([x.impacts.start[x.impacts.kind == IMPACT] for x in (one, two)])
            reference = whole.impacts.start[whole.impacts.kind == IMPACT]
            if cut not in whole.impacts.start:
                np.testing.assert_allclose(starts, reference, rtol=0, atol=1e-9 * period)
    if name in ("three modes, linear", "no drive"):
        assert CONTACT in regimes
    if name == "three modes, pressed":
        assert HELD in regimes


@pytest.mark.parametrize("name", SYSTEMS)
def test_samples_that_are_asked_for_do_not_change_the_motion(name):
    oscillator = SYSTEMS[name]()
    state = shaken(oscillator.n_modes)
    length = 7.3 * oscillator.period
    plain = simulate(oscillator, state, duration=length)
    sampled = simulate(oscillator, state, duration=length, times=np.linspace(0, length, 1000))
    assert np.array_equal(plain.end.displacement, sampled.end.displacement)
    assert np.array_equal(plain.impacts.start, sampled.impacts.start)
    assert np.all(np.isfinite(sampled.displacement))
    np.testing.assert_allclose(sampled.displacement[-1], sampled.end.displacement, rtol=0, atol=1e-15)


def test_every_sample_is_filled_in_whatever_the_length():
    """Lengths at random, a sample at the very end: none is left out by rounding."""
    oscillator = spring(1, NewtonRestitution(local_restitution=0.5), drive=(21.5, 1.5e-3))
    generator = np.random.default_rng(4)
    start = shaken(1)
    for length in generator.uniform(0.01, 0.5, 200):
        run = simulate(oscillator, start, duration=length, times=[0.3 * length, length])
        scale = abs(run.velocity).max() + 1e-3
        assert run.displacement[-1] == pytest.approx(run.end.displacement, abs=1e-14)
        assert run.velocity[-1] == pytest.approx(run.end.velocity, abs=1e-12 * scale)


def test_motion_without_drive_does_not_depend_on_the_clock():
    oscillator = spring(3, LinearContact(stiffness=2e4, damping=3.0))
    velocity = np.array([0.3, 0.0, 0.0])
    ends = []
    for time in (0.0, 0.0123, 17.0, -0.4):
        state = State(displacement=np.zeros(3), velocity=velocity, time=time)
        run = simulate(oscillator, state, duration=0.5)
        assert run.end.time == pytest.approx(time + 0.5, abs=1e-14)
        assert len(run.impacts) >= 3
        ends.append(np.concatenate([run.end.displacement, run.end.velocity, run.impacts.start - time]))
    for end in ends[1:]:
        np.testing.assert_allclose(end, ends[0], rtol=0, atol=1e-11)


def test_drive_is_periodic_in_the_clock():
    """Started whole periods later the run is the same, to the rounding of the larger times."""
    oscillator = spring(3, NewtonRestitution(local_restitution=0.5), drive=(16.0, 1.5e-3))
    runs = []
    for turns in (0, 7, 1000):
        state = State(displacement=np.zeros(3), velocity=[0.2, 0.0, 0.0], time=turns / 16.0 + 0.01)
        run = simulate(oscillator, state, periods=5)
        assert run.end.time == pytest.approx(state.time + 5 / 16.0, rel=1e-15)
        runs.append(run)
    assert len(runs[0].impacts) > 3
    for run in runs[1:]:
        np.testing.assert_allclose(run.end.velocity, runs[0].end.velocity, rtol=0, atol=1e-10)


def test_start_in_contact_is_the_rest_of_the_contact():
    """A start behind a wall that pushes is a contact at once (a force law allows it)."""
    oscillator = falling_body(0.01, LinearContact(stiffness=4e4), gravity=0.0)
    depth = 1e-4
    run = simulate(oscillator, State(displacement=[0.01 + depth], velocity=[0.0]), duration=0.1)
    assert run.impacts.end[0] == pytest.approx(0.5 * math.pi / 200.0, rel=1e-12)
    assert run.end.velocity[0] == pytest.approx(-depth * 200.0, rel=1e-12)
    # with a dashpot and moving out fast it lies inside without force, and leaves freely
    oscillator = falling_body(0.01, LinearContact(stiffness=4e4, damping=1e3), gravity=0.0)
    run = simulate(oscillator, State(displacement=[0.01 + depth], velocity=[-0.5]), duration=0.1)
    assert run.end.velocity[0] == -0.5
    assert run.impacts.end[0] == pytest.approx(depth / 0.5, rel=1e-12)


def test_graze_is_logged_and_does_nothing():
    """An undamped mode whose amplitude is the gap: grazes, no impact, no loss."""
    model = ModalModel(omega=[2.0], decay_rate=[0.0], phi=[1.0], participation=[0.0])
    oscillator = ImpactOscillator(
        model=model, stop=Stop(gap=0.25, law=NewtonRestitution(local_restitution=0.3))
    )
    run = simulate(oscillator, State(displacement=[-0.25], velocity=[0.0]), duration=10.0)
    assert np.all(run.impacts.kind == GRAZE)
    assert len(run.impacts) >= 3
    np.testing.assert_allclose(run.impacts.start[:3], np.pi / 2 * np.array([1, 3, 5]), atol=1e-7)
    assert run.end.displacement[0] == pytest.approx(-0.25 * math.cos(20.0), abs=1e-13)
    assert not np.any(run.impacts.loss)
    assert np.all(run.strobe_impacts == 0)


# ------------------------------------------------------------------------------------ what cannot be followed


def test_impacts_without_end_are_reported_with_their_place():
    """e = 0.99999: more than 1e5 impacts in one second, none of them below rounding."""
    oscillator = falling_body(1e-8, NewtonRestitution(local_restitution=0.99999))
    with pytest.raises(Chatter, match="impacts accumulate at t = ") as caught:
        simulate(oscillator, duration=20.0)
    assert 0 < caught.value.time < 10
    assert abs(caught.value.gap) <= 1e-8
    assert caught.value.displacement == pytest.approx([1e-8], abs=1e-8)
    assert abs(caught.value.velocities[0]) <= 5e-4


def test_graze_lost_in_rounding_is_reported_and_not_passed():
    """Two modes that cancel to a thousandth of their size reach the stop to rounding of the larger ones."""
    model = ModalModel(omega=[100.0, 100.0], decay_rate=[0.0, 0.0], phi=[1.0, -1.0], participation=[0.0, 0.0])
    state = State(displacement=[-0.01 - 2.0**-17, -0.01], velocity=[0.0, 0.0])
    for factor, outcome in ((1.0, None), (1 + 1e-9, 0), (1 - 1e-9, 1)):
        gap = (0.01 + 2.0**-17 - 0.01) * factor
        stop = Stop(gap=gap, law=NewtonRestitution(local_restitution=1.0))
        oscillator = ImpactOscillator(model=model, stop=stop)
        if outcome is None:
            with pytest.raises(UnresolvedCrossing, match="neither excluded nor located") as caught:
                simulate(oscillator, state, duration=0.05)
            assert caught.value.time == pytest.approx(0.01 * math.pi, abs=1e-3)
        else:
            assert len(simulate(oscillator, state, duration=0.05).impacts) == outcome


@pytest.mark.parametrize("given", [3, 3.0, np.int64(3), Regime.SUSTAINED])
def test_a_regime_given_as_a_number_is_the_regime(given):
    assert State(displacement=[0.0], velocity=[0.0], regime=given).regime is Regime.SUSTAINED


def test_a_state_cannot_be_changed():
    state = State(displacement=[0.0, 1.0], velocity=[0.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        state.displacement[0] = 1.0
