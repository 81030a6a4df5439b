"""Nordmark's map and its maximal orbits, against 50-digit arithmetic, iteration and a linearised impact."""

import math
import random
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from oscillators import modes_on_stop, newton

from contact import MapFamily, NordmarkMap, coexisting_m, frequency_band, maximal_m

T, MU, TAU = 0.0408, 3.56, 0.1
TABLE = [(20.90, 3), (21.50, 4), (22.20, 5), (22.60, 6), (23.05, 8), (23.40, 11)]
"""f [Hz], m of the map: 11 at 23.40 Hz, where the letter observed 10."""


def letter_map(frequency: float, **changes: object) -> NordmarkMap:
    numbers = {"free_period": T, "decay_rate": MU, "restitution": TAU} | changes
    return NordmarkMap.from_frequencies(drive_frequency=frequency, **numbers)


@pytest.mark.parametrize("damping", [0.15, 0.55, 1.0, 1.0 + 1e-9, 3.0, 30.0])
def test_coefficients_are_those_of_the_period_flow(damping: float) -> None:
    """Trace, determinant and M12 of exp([[0, 1], [-w^2, -c]]/f), by a matrix exponential of 40 digits."""
    omega, f = 200.0 if damping == 0.55 else 150.0, 20.9  # more than a turn in a period, strongly damped
    c = 2 * omega * damping
    made = NordmarkMap.from_mode(omega=omega, decay_rate=c, drive_frequency=f, restitution=0.3, delay=1e-4)
    with mp.workdps(40):
        flow = mp.expm(mp.matrix([[0, 1], [-(omega**2), -c]]) / f)
        alpha, gamma = flow[0, 0] + flow[1, 1], mp.det(flow)
        per_excess = (1 - alpha + gamma) / (2 * (2 * mp.pi * f * flow[0, 1] * mp.mpf("1.3")) ** 2)
        delay_term = mp.mpf("1e-4") / (2 * flow[0, 1] * mp.mpf("1.3") ** 2)
    assert made.alpha == pytest.approx(float(alpha), rel=1e-12)
    assert made.gamma == pytest.approx(float(gamma), rel=1e-12)
    assert made.delay_term == pytest.approx(float(delay_term), rel=1e-12)
    critical = abs(damping - 1) < 0.1  # there the exponents have the square root of the rounding of alpha
    assert made.rho_per_excess == pytest.approx(float(per_excess), rel=1e-7 if critical else 1e-11)


@pytest.mark.parametrize("y_line", ["corrected", "printed"])
def test_step_jacobian_and_iterate_agree(y_line: str) -> None:
    made = letter_map(21.5, y_line=y_line, delay=2e-4)
    for state in np.array([[0.2, -0.1], [-0.2, 0.05]]):
        steps = 1e-6 * np.eye(2)
        columns = [made.iterate(state + d, 0.01, 1)[0] - made.iterate(state - d, 0.01, 1)[0] for d in steps]
        assert np.allclose(np.column_stack(columns) / 2e-6, made.jacobian(state), atol=1e-9)
    determinant = np.linalg.det(made.jacobian([0.2, 0.0]))
    assert determinant == pytest.approx(made.gamma * (TAU**2 if y_line == "corrected" else 1.0), rel=1e-14)
    path = made.iterate([0.2, -0.1], 0.01, 50)
    state = np.array([0.2, -0.1])
    for row in path:
        state = made.iterate(state, 0.01, 1)[0]
        assert np.array_equal(state, row)
    assert made.iterate([0.2, -0.1], 0.01, 0).shape == (0, 2)


@pytest.mark.parametrize("y_line", ["corrected", "printed"])
@pytest.mark.parametrize(("frequency", "period"), TABLE)
def test_folds_by_fifty_digit_newton(frequency: float, period: int, y_line: str) -> None:
    """Iterate the branches themselves; the fold is where a multiplier of the chain of Jacobians is one."""
    made = letter_map(frequency, y_line=y_line, delay=3e-5)
    at_fold = MapFamily(made, period).fold()
    assert at_fold.admissible and maximal_m(letter_map(frequency)) == period
    assert at_fold.trace == pytest.approx(1 + at_fold.determinant, abs=1e-12)
    with mp.workdps(50):
        gamma = mp.e ** (-mp.mpf(MU) / mp.mpf(frequency))
        angle = 2 * mp.pi / (mp.mpf(frequency) * mp.mpf(T))
        alpha = 2 * mp.sqrt(gamma) * mp.cos(angle)
        m12 = mp.sqrt(gamma) * mp.sin(angle) * mp.mpf(T) / (2 * mp.pi)
        lag = mp.mpf(3e-5) / (2 * m12 * (1 + mp.mpf(TAU)) ** 2)
        impact = gamma * mp.mpf(TAU) ** 2 if y_line == "corrected" else gamma

        def conditions(root, y, rho):
            x0 = root**2
            x1, y1 = -root + lag + y + rho, -impact * x0
            chain = mp.matrix([[-1 / (2 * root), 1], [-impact, 0]])
            for _ in range(period - 1):
                x1, y1 = alpha * x1 + y1 + rho, -gamma * x1
                chain = mp.matrix([[alpha, 1], [-gamma, 0]]) * chain
            return [x1 - x0, y1 - y, 1 - chain[0, 0] - chain[1, 1] + mp.det(chain)]

        start = [mp.mpf(at_fold.speed), mp.mpf(at_fold.states[0, 1]), mp.mpf(at_fold.rho)]
        root, y, rho = mp.findroot(conditions, [value * mp.mpf("1.001") for value in start])
    assert at_fold.speed == pytest.approx(float(root), rel=1e-11)
    assert at_fold.states[0, 1] == pytest.approx(float(y), rel=1e-11)
    assert abs(at_fold.rho - float(rho)) < 1e-12


@pytest.mark.parametrize("delay", [0.0, 1e-4])
@pytest.mark.parametrize("period", [1, 2, 3, 4, 7])
def test_orbits_repeat_and_have_their_multipliers(period: int, delay: float) -> None:
    """Both solutions are carried round by the branches (whichever side of zero their iterates lie)."""
    made = letter_map(20.9, delay=delay)
    at_fold = MapFamily(made, period).fold()
    rho = 0.05 if at_fold is None else at_fold.rho + 0.02
    orbits = MapFamily(made, period).at_rho(rho)
    assert orbits
    for orbit in orbits:
        assert len(orbit.states) == period
        linear = np.array([[made.alpha, 1.0], [-made.gamma, 0.0]])
        impact = np.array([[-0.5 / orbit.speed, 1.0], [-made.gamma_impact, 0.0]])
        x, y = orbit.states[0]
        assert x == orbit.speed**2
        state = np.array([-orbit.speed + made.delay_term + y + rho, -made.gamma_impact * x])
        for expected in orbit.states[1:]:
            assert np.allclose(state, expected, atol=1e-14)
            state = linear @ state + [rho, 0.0]
        assert np.allclose(state, orbit.states[0], atol=1e-14)
        chain = np.linalg.matrix_power(linear, period - 1) @ impact
        assert orbit.trace == pytest.approx(np.trace(chain), rel=1e-11)
        assert orbit.determinant == pytest.approx(np.linalg.det(chain), rel=1e-9)
        assert np.prod(orbit.multipliers).real == pytest.approx(orbit.determinant, rel=1e-9)


@pytest.mark.parametrize("y_line", ["corrected", "printed"])
@pytest.mark.parametrize(("frequency", "period"), TABLE)
def test_a_second_impact_ends_the_stable_range(frequency: float, period: int, y_line: str) -> None:
    made = letter_map(frequency, y_line=y_line)
    ends = MapFamily(made, period).stable_range()
    assert ends is not None
    low, high = ends
    assert low == pytest.approx(MapFamily(made, period).fold().rho, rel=1e-14)
    assert high > 0  # in the map it is never below grazing; in Eq. (1) it may be
    before, after = (MapFamily(made, period).at_rho(high + side * 1e-6)[-1] for side in (-1, 1))
    assert before.admissible and before.stable and after.stable and not after.admissible
    assert max(after.states[1:, 0]) == pytest.approx(0, abs=1e-4)
    for rho, same in ((high - 1e-4, True), (high + 1e-4, False)):
        node = MapFamily(made, period).at_rho(rho)[-1]
        later = made.iterate(node.states[0], rho, 3000)[-period:]
        assert np.allclose(np.sort(later[:, 0]), np.sort(node.states[:, 0]), atol=1e-8) is same


def test_stable_ranges_are_those_of_a_row_of_nodes() -> None:
    """Random maps, some with flips, some with a range that begins above the fold."""
    draw, kinds = random.Random(4), set()
    for _ in range(150):
        made = letter_map(
            draw.uniform(0.668, 0.9999) / T,
            decay_rate=10 ** draw.uniform(-2, 2),
            restitution=draw.random(),
            y_line=draw.choice(["printed", "corrected"]),
            delay=draw.choice([0.0, 1e-4, 1e-3]),
        )
        family = MapFamily(made, draw.randint(1, 9))
        if not (at_fold := family.fold()):
            continue
        row = [family.orbit(at_fold.speed * x) for x in np.geomspace(1.0 + 1e-6, 1e3, 150)]
        held, ends = [one.stable and one.admissible for one in row], family.stable_range() or (0.0, 0.0)
        kinds |= {"flip"} if not row[-1].stable else set()
        if not any(held):
            kinds.add("none")
            assert sum(ends[0] < one.rho < ends[1] for one in row) == 0
            continue
        first = held.index(True)
        last = held.index(False, first)
        kinds.add("late" if first else "from the fold")
        assert (row[first - 1].rho if first else at_fold.rho) <= ends[0] <= row[first].rho
        assert row[last - 1].rho <= ends[1] <= row[last].rho
    assert kinds == {"flip", "none", "late", "from the fold"}


def test_band_edges() -> None:
    found = [frequency_band(m, free_period=T, decay_rate=MU, restitution=TAU) for m in range(2, 13)]
    for entry in found:
        m = entry.m
        assert entry.upper == pytest.approx(2 * m / ((2 * m + 1) * T), rel=1e-14)
        made = letter_map(entry.upper * (1 - 1e-6))
        at_fold = MapFamily(made, m).fold()
        assert at_fold is not None and -1e-5 < at_fold.rho < 0 and maximal_m(made) == m
        past = MapFamily(letter_map(entry.upper * (1 + 1e-6)), m).fold()
        assert past is None  # no hysteresis at the upper edge, no fold above it
    for below, entry in pairwise(found):
        assert entry.lower < below.upper < entry.upper  # neighbours overlap
        for side in (-1, 1):
            made = letter_map(entry.lower * (1 + side * 1e-6))
            node = MapFamily(made, entry.m).at_rho(0.0)[-1]
            assert node.admissible is (side > 0)
            assert (entry.m in coexisting_m(made)) is (side > 0)
        middle = 0.5 * (entry.lower + below.upper)
        assert coexisting_m(letter_map(middle)) == (below.m, entry.m)


def test_period_ten_needs_another_period_or_frequency() -> None:
    """Band edges depend on f T alone: 23.40 Hz lies in p11 for T = 40.80 +- 0.02 ms and any damping."""
    for period_of_spring in (T - 2e-5, T, T + 2e-5):
        for rate in (0.5, MU, 10.0):
            for tau in (0.0, 0.1, 0.9):
                made = letter_map(23.40, free_period=period_of_spring, decay_rate=rate, restitution=tau)
                assert maximal_m(made) == 11
    assert maximal_m(letter_map(23.40, free_period=0.04070)) == 10
    assert maximal_m(letter_map(23.342)) == 10 and maximal_m(letter_map(23.343)) == 11


def test_overdamped_map_adds_periods_and_has_no_fold() -> None:
    made = NordmarkMap.from_mode(omega=60.0, decay_rate=200.0, drive_frequency=40.0, restitution=0.0)
    assert made.alpha**2 > 4 * made.gamma and maximal_m(made) == 0 and coexisting_m(made) == ()
    assert all(MapFamily(made, m).fold() is None for m in range(1, 8))
    assert all(MapFamily(made, m).at_rho(-1e-3) == () for m in range(1, 8))
    seen = []
    for rho in np.geomspace(1e-6, 0.5, 100):
        tail = made.iterate([-0.1, 0.0], rho, 3000)[-840:, 0]
        period = next((m for m in range(1, 30) if np.allclose(tail[m:], tail[:-m], atol=1e-9)), 0)
        if period and np.sum(tail[:period] > 0) == 1:
            node = MapFamily(made, period).at_rho(rho)[-1]
            assert np.allclose(np.sort(tail[:period]), np.sort(node.states[:, 0]), atol=1e-8)
            seen.append(period)
    assert sorted(set(seen)) == list(range(2, max(seen) + 1)) and max(seen) > 9
    assert seen == sorted(seen, reverse=True)  # one period fewer, cascade by cascade, as rho grows


def window(nordmark: NordmarkMap, period: int) -> tuple[float, float] | None:
    """The rho between which p_m is stable and without a second impact; None if there are none."""
    size, ends = nordmark.alpha ** (2 * period - 2), []
    for unstable in (True, False):  # along rho p_m becomes stable once, and meets its second impact once
        low, high = math.log(1e-4), math.log(1e6)
        for _ in range(60):
            middle = 0.5 * (low + high)
            orbits = MapFamily(nordmark, period).at_rho(size * math.exp(middle))
            before = not any(o.stable for o in orbits) if unstable else any(o.admissible for o in orbits)
            low, high = (middle, high) if before else (low, middle)
        ends.append(size * math.exp(middle))
    return (ends[0], ends[1]) if ends[0] < ends[1] else None


@pytest.mark.parametrize("alpha", [0.2, 0.45, 0.6, 0.7])
def test_windows_of_the_overdamped_map_have_their_limits(alpha: float) -> None:
    """rho = l^(2m-2) (1 - l) z (z + 1), 1/2 < z < (1 - l)/l, none for l > 2/3 (Chin, Ott, Nusse, Grebogi)."""
    m, made = 14, NordmarkMap(alpha=alpha, gamma=0.0, restitution=0.0, whole_turns=0)
    found, size = window(made, m), alpha ** (2 * m - 2)
    if alpha > 2 / 3:
        assert found is None
        return
    # what is neglected is of the order alpha^m
    assert found is not None
    assert found[0] / size == pytest.approx(0.75 * (1.0 - alpha), rel=20 * alpha**m + 1e-12)
    assert found[1] / size == pytest.approx(((1.0 - alpha) / alpha) ** 2, rel=20 * alpha**m + 1e-12)


def test_map_of_an_oscillator() -> None:
    omega = math.hypot(2 * math.pi / T, MU / 2)
    oscillator = modes_on_stop([omega, 900.0], [MU, 9.0], 1.0, 1.0, law=newton(TAU), drive=21.5)
    assert NordmarkMap.from_oscillator(oscillator) == letter_map(21.5)
    assert NordmarkMap.from_oscillator(oscillator, restitution=0.4) == letter_map(21.5, restitution=0.4)


def test_above_resonance_the_map_is_refused_with_the_frequencies_below_it() -> None:
    with pytest.raises(ValueError, match=rf"from {1 / (1.5 * T):.6g} to {1 / T:.6g} Hz"):
        letter_map(1.2 / T)


def test_a_map_without_a_steady_motion_has_no_excess() -> None:
    with pytest.raises(ValueError, match="alpha"):
        _ = NordmarkMap(alpha=-1.8, gamma=0.8, restitution=0.1).rho_per_excess
