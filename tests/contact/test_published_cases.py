"""Published and exactly solved contact problems, each held to the tolerance that its source justifies."""

import math
from types import SimpleNamespace

import mpmath as mp
import numpy as np
import pytest
from oscillators import modes_on_stop, newton

from beam import UniformBeam, exact_modes
from contact import ContactLaw, HertzContact, HuntCrossley, ImpactOscillator, LinearContact, State, simulate
from contact.hertz import HERTZ_TIME

GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(24)


def over(start: float, end: float, panels: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of Gauss's rule on `panels` equal parts of an interval."""
    edges = np.linspace(start, end, panels + 1)
    half = 0.5 * np.diff(edges)[:, None]
    points = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * GAUSS_POINTS
    return points.ravel(), (half * GAUSS_WEIGHTS).ravel()


def free_mass(mass: float, law: ContactLaw) -> ImpactOscillator:
    return modes_on_stop(0.0, phi=1 / math.sqrt(mass), law=law, gap=0.0)


def thrown(mass: float, speed: float, *, distance: float = 0.0) -> State:
    root = math.sqrt(mass)
    return State(displacement=[-distance * root], velocity=[speed * root])


SDNL32 = {
    18000.0: [-2.66, -4.33, -4.92, -4.78, -3.82, -2.87, -2.71, -3.09, -3.41, -3.36, -2.64, -0.742],
    45000.0: [-2.25, -2.66, -1.96, -1.15, -0.124, -0.364, -2.01, -2.74, -1.89, -0.352, 1.70, 4.99],
}
"""Tip displacement at 1 ... 12 ms [mm], for each stiffness [N/m]."""


def swung_beam(stiffness: float, bending_modes: int, damping_ratio: float) -> tuple[ImpactOscillator, State]:
    """A square bar, pinned at one end, turns as a rigid body and meets the spring with its free end at t = 0.

    Modes: the rotation, w = phi_0 s/L with phi_0 = sqrt(3/(rho A L)), and bending modes of the pinned-free
    bar.  The stop lies where the tip moves to: what the model counts positive the source counts negative.
    """
    side, length, turning, line = 0.014, 0.783, 3.8, 2400.0 * 0.014**2
    numbers = dict(length=length, bending_stiffness=6.7e10 * side**4 / 12, mass_per_length=line)
    bar = UniformBeam(**numbers, supports=("pinned", "free"))
    bending = exact_modes(bar, bending_modes)
    phi = np.append(math.sqrt(3 / (line * length)), bending.phi)
    omega = np.append(0.0, bending.omega)
    law = LinearContact(stiffness=stiffness)
    oscillator = modes_on_stop(omega, 2 * damping_ratio * omega, phi, law=law, gap=0.0)
    velocity = turning * length / phi[0] * np.eye(phi.size)[0]
    return oscillator, State(displacement=np.zeros(phi.size), velocity=velocity)


def tip_of_swung_beam(stiffness: float, bending_modes: int = 9, damping_ratio: float = 0.01) -> np.ndarray:
    """Tip displacement at 1 ... 12 ms [mm], counted as the source counts it."""
    oscillator, start = swung_beam(stiffness, bending_modes, damping_ratio)
    run = simulate(oscillator, start, duration=0.0121, times=1e-3 * np.arange(1, 13))
    assert run.impacts.start[0] < 1e-15 and run.impacts.approach[0] == pytest.approx(3.8 * 0.783, rel=1e-12)
    return -1e3 * run.displacement @ oscillator.model.phi


@pytest.mark.parametrize("stiffness", SDNL32)
def test_beam_swung_on_a_spring(stiffness: float) -> None:
    found = tip_of_swung_beam(stiffness)
    assert np.max(np.abs(found - SDNL32[stiffness])) < 0.05
    # its authors state 0.8 % of the largest displacement
    assert np.max(np.abs(found - SDNL32[stiffness])) < 0.008 * np.max(np.abs(SDNL32[stiffness]))
    # and the reading of the data is the only one that fits
    for factor, changes in ((1.0, {"damping_ratio": 0.0}), (1.0, {"bending_modes": 3}), (1.02, {})):
        other = tip_of_swung_beam(factor * stiffness, **changes)
        assert np.max(np.abs(other - SDNL32[stiffness])) > 0.05


def test_sprung_mass_on_a_wall_spring() -> None:
    """Peak force 9950 N, contact 0.03126 s, impulse 198.05 N s in print; closed forms to rounding."""
    mass, spring, wall, speed = 100.0, 1e4, 1e6, 1.0
    law, phi = LinearContact(stiffness=wall), 1 / math.sqrt(mass)
    oscillator = modes_on_stop(math.sqrt(spring / mass), phi=phi, law=law, gap=0.0)
    start = thrown(mass, speed)
    ends = simulate(oscillator, start, duration=0.05).impacts
    span = float(ends.end[0] - ends.start[0])
    points, weights = over(float(ends.start[0]), float(ends.end[0]), 4)
    times = np.sort(np.append(points, 0.5 * span))
    run = simulate(oscillator, start, duration=0.05, times=times)
    force = wall * run.displacement @ oscillator.model.phi
    middle = int(np.flatnonzero(times == 0.5 * span)[0])
    impulse = float(weights @ np.delete(force, middle))
    turn = math.sqrt((spring + wall) / mass)
    assert span == pytest.approx(math.pi / turn, rel=1e-13)
    assert force[middle] == pytest.approx(wall * speed / turn, rel=1e-13)
    assert impulse == pytest.approx(2 * mass * speed * wall / (wall + spring), rel=1e-12)
    assert np.max(force) <= force[middle] * (1 + 1e-15)
    assert force[middle] == pytest.approx(9950.0, rel=1e-4)
    assert span == pytest.approx(0.03126, abs=5e-6)
    assert impulse == pytest.approx(198.05, rel=2e-4)  # the printed figure is itself a quadrature
    assert ends.rebound[0] == pytest.approx(-speed, rel=1e-13)


MODES = np.array([8, 16, 32, 64, 128, 256])


def bar(n_modes: int, law: ContactLaw, *, depth: float = 0.0) -> tuple[ImpactOscillator, State]:
    """Unit bar fixed at x = 1, free end at x = 0 over a stop at u = -depth, let go at u = (1 - x)/2.

    Modes sqrt(2) cos((k + 1/2) pi x); the model counts positive what moves towards the stop.
    """
    omega = (np.arange(n_modes) + 0.5) * math.pi
    oscillator = modes_on_stop(omega, phi=-math.sqrt(2), law=law, gap=depth)
    return oscillator, State(displacement=1 / (math.sqrt(2) * omega**2), velocity=np.zeros(n_modes))


def exact_end(time: np.ndarray, depth: float = 0.0) -> np.ndarray:
    """u(0, t) by d'Alembert up to the second touch at 4 (1 + depth).

    Down with velocity -1/2 from 1/2, held from t = 1 + 2 depth to t = 2, up to 1/2 again, down again.
    """
    down, held = (1 - time) / 2, np.full_like(time, -depth)
    rise, fall = time / 2 - 1 - depth, 2 + depth - time / 2
    return np.where(time < 1 + 2 * depth, down, np.where(time < 2, held, np.minimum(rise, fall)))


def top(n_modes: int) -> float:
    """The highest frequency retained [rad/s]."""
    return (n_modes - 0.5) * math.pi


BAR_LAWS = {
    **{name: lambda n, e=e: newton(e) for name, e in (("plastic", 0.0), ("half", 0.5), ("elastic", 1.0))},
    "spring": lambda n: LinearContact(stiffness=top(n)),
    "dashpot": lambda n: LinearContact(stiffness=top(n), damping=1.0),
}
"""Laws that tend to the rigid stop as modes are added.  Newton's because an impulse on N modes moves the mass
1/(2 N); springs because theirs grows with N.  The dashpot has the wave resistance of the bar."""


def rate(errors: np.ndarray) -> float:
    """Least-squares slope of log |error| over log(number of modes)."""
    return float(np.polyfit(np.log(MODES), np.log(np.abs(errors)), 1)[0])


def bar_errors(law: str, depth: float) -> SimpleNamespace:
    """Errors of the end's motion up to t = 3.4, for each number of modes."""
    rows = []
    for n_modes in MODES:
        oscillator, state = bar(int(n_modes), BAR_LAWS[law](int(n_modes)), depth=depth)
        run = simulate(oscillator, state, duration=3.4, times=np.linspace(0.0, 3.4, 3401))
        error = -(run.displacement @ oscillator.model.phi) - exact_end(run.time, depth)
        energy, hits = oscillator.energy(run.displacement, run.velocity), run.impacts
        row = dict(largest=np.max(np.abs(error)), mean=np.sqrt(np.mean(error**2)))
        row |= dict(touch=hits.start[0] - 1 - 2 * depth, release=hits.end[np.isfinite(hits.end)][-1] - 2)
        row |= dict(missing=0.125 - energy[-1], change=energy[-1] - energy[0], loss=np.sum(hits.loss))
        rows.append(row | dict(stays=np.count_nonzero(hits.kind == 2), impacts=len(hits)))
    return SimpleNamespace(**{name: np.array([row[name] for row in rows]) for name in rows[0]})


@pytest.mark.parametrize(
    "law, depth",
    [(law, depth) for law in BAR_LAWS for depth in (0.0, 0.05) if (law, depth) != ("plastic", 0.0)],
)
def test_bar_converges_with_the_first_power_of_the_number_of_modes(law: str, depth: float) -> None:
    """8 to 256 modes: motion, release and energy err by a constant over N, the touch by less.

    At depth 0 the plastic touch is a case of its own: see below.
    """
    found = bar_errors(law, depth)
    assert -1.2 < rate(found.largest) < -0.85 and -1.2 < rate(found.mean) < -0.8
    assert np.all(MODES * found.largest < 0.6) and np.all(MODES * found.mean < 0.22)
    assert np.all(MODES * np.abs(found.release) < (0.36 if law != "elastic" else 1.4))
    # the touch comes before any law acts: exact by symmetry at depth 0, else the series' tail of higher order
    assert np.max(np.abs(found.touch)) < 1e-13 if depth == 0 else rate(found.touch) < -1.7
    # energy: 1/(4 pi^2 N) is in the modes left out, the rest is what the law takes
    np.testing.assert_allclose(found.missing + found.change, 1 / (4 * math.pi**2 * MODES), rtol=2e-3)
    np.testing.assert_allclose(found.change, -found.loss, rtol=0, atol=2e-12)
    if law in ("spring", "elastic"):
        assert np.max(np.abs(found.change)) < 1e-13
    else:
        assert -1.05 < rate(found.missing) < -0.95
    if law in ("plastic", "half"):
        # the stay on the wall is one, and ends early by the same share of a half wave for any N
        assert np.all(found.stays == 1)
        np.testing.assert_allclose(MODES[1:] * found.release[1:], -0.2225, atol=4e-3)
    if law in ("spring", "dashpot"):
        assert np.all(found.impacts == 1)
    if law == "plastic":
        # one impact of speed 1/2 on the mass 1/(2 N) loses 1/(16 N)
        np.testing.assert_allclose(MODES * found.loss, 1 / 16, rtol=0.08)
        assert MODES[-1] * found.loss[-1] == pytest.approx(1 / 16, rel=0.01)


@pytest.mark.xfail(strict=True, reason="a plastic touch without acceleration is not resolved")
def test_plastic_touch_of_the_bar_at_depth_0() -> None:
    """By symmetry the tip arrives without acceleration: the third derivative must decide what follows."""
    releases = []
    for n_modes in (8, 16, 32):
        oscillator, state = bar(n_modes, BAR_LAWS["plastic"](n_modes))
        run = simulate(oscillator, state, duration=3.4)
        releases.append(n_modes * (float(run.impacts.end[-1]) - 2))
    np.testing.assert_allclose(releases, -0.2225, atol=0.02)


def test_force_on_the_bar_is_one_half_throughout() -> None:
    """The impulse 1/2 and its thirds, by Gauss's rule over k d, with an error that falls as 1/N."""
    errors = []
    for n_modes in MODES[:5]:
        law = LinearContact(stiffness=top(int(n_modes)))
        oscillator, state = bar(int(n_modes), law)
        thirds = []
        for i in range(3):
            points, weights = over(1 + i / 3, 1 + (i + 1) / 3, max(4, int(n_modes) // 6))
            run = simulate(oscillator, state, duration=3.4, times=points)
            depths = np.maximum(run.displacement @ oscillator.model.phi, 0)
            thirds.append(float(weights @ (law.stiffness * depths)))
        errors.append([3 * third - 0.5 for third in thirds])
    scaled = MODES[:5, None] * np.array(errors)
    assert np.all(np.abs(scaled) < 2.2) and np.all(np.abs(errors[-1]) < 0.02)


def test_contact_time_of_hertz() -> None:
    """2.9432 times greatest approach over speed: 2 int dx/sqrt(1 - x^(5/2)), by quadrature."""
    with mp.workdps(30):
        # x = (1 - y^2)^(2/5) takes the root out of the integrand
        exact = 2 * mp.quad(lambda y: mp.mpf(4) / 5 * (1 - y * y) ** mp.mpf("-0.6"), [0, 0.9, 0.999, 1])
    assert HERTZ_TIME == pytest.approx(float(exact), rel=1e-9)
    assert HERTZ_TIME == pytest.approx(2.9432, abs=1e-4)
    for mass, stiffness, speed in ((0.005, 9.65e9, 0.24), (2.0, 1e5, 1e-3), (1e-3, 1e10, 40.0)):
        law = HertzContact(stiffness=stiffness)
        expected = 2.9432751 * (1.25 * mass * speed**2 / stiffness) ** 0.4 / speed
        assert law.contact_time(mass, speed) == pytest.approx(expected, rel=1e-7)
        start = thrown(mass, speed, distance=speed * 1e-3)
        end = 2e-3 + expected
        impact = simulate(free_mass(mass, law), start, duration=end).impacts
        span = float(impact.end[0] - impact.start[0])
        assert span == pytest.approx(law.contact_time(mass, speed), rel=1e-9)
        middle = simulate(free_mass(mass, law), start, duration=end, times=[impact.start[0] + 0.5 * span])
        depth = float(middle.displacement[0, 0]) / math.sqrt(mass)
        assert depth == pytest.approx(law.greatest_approach(mass, speed), rel=1e-12)
        assert impact.peak_force[0] == pytest.approx(stiffness * depth**1.5, rel=1e-12)
        assert abs(float(middle.velocity[0, 0])) < 1e-9 * speed * math.sqrt(mass)
        assert impact.rebound[0] == pytest.approx(-speed, rel=1e-13)
        assert impact.impulse[0] == pytest.approx(2 * mass * speed, rel=1e-13)


@pytest.mark.parametrize("restitution", [0.01, 0.03, 0.1, 0.3, 0.5, 0.8, 0.95, 0.999, 0.999999, 1.0])
@pytest.mark.parametrize("speed", [1e-3, 0.24, 3.0])
def test_rebound_of_hunt_and_crossley(restitution: float, speed: float) -> None:
    """a - ln(1 + a) = -b - ln(1 - b): the mass leaves with the restitution of the law, to 1e-10."""
    mass, stiffness = 0.005, 9.65e9
    law = HuntCrossley.with_restitution(stiffness=stiffness, restitution=restitution, velocity=speed)

    def rebound(v: float) -> float:
        state, duration = thrown(mass, v, distance=v * 1e-4), 0.02 + 0.1 / speed**0.2
        return -float(simulate(free_mass(mass, law), state, duration=duration).impacts.rebound[0])

    assert rebound(speed) == pytest.approx(restitution * speed, rel=1e-10)
    # the same law at other speeds, by the relation solved in 40 digits
    with mp.workdps(40):
        for factor in (0.3, 3.0):
            a = mp.mpf(law.dissipation) * mp.mpf(factor * speed)
            if a == 0:
                expected = factor * speed
            else:
                left = a - mp.log(1 + a)
                low = mp.mpf(1) if a > 1 else a * (1 - a)
                near = left + min(low, 1) if a > 1 else low
                # b = 1 - exp(-w): -b - ln(1 - b) = w - b
                w = mp.findroot(lambda w, left=left: w + mp.expm1(-w) - left, near)
                expected = float(-mp.expm1(-w) / mp.mpf(law.dissipation))
            assert rebound(factor * speed) == pytest.approx(expected, rel=1e-10)
