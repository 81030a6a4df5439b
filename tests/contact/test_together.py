"""Several stops hit at one instant under Newton's law: Moreau's law and one stop after the other.

Bodies without springs: v+ = v- - W^T p, W the rows of the stops.  With independent rows, p is by Moreau's law
the non-negative least-squares solution of W^T p = u, W u = (1 + e) W v-.
"""

import numpy as np
import pytest
from oscillators import before_stops, newton
from scipy.optimize import nnls

from contact import HarmonicDrive, ImpactKind, ImpactOscillator, LinearContact, Regime, State, simulate


def modes(rows, e, gaps, *, omega=0.0, decay=0.0, gamma=0.0, **more) -> ImpactOscillator:
    """Modes with a stop for each of the `rows`; a number holds for all modes or stops."""
    omega, decay, gamma, _ = np.broadcast_arrays(omega, decay, gamma, rows[0])
    each = zip(np.broadcast_to(gaps, len(rows)), np.broadcast_to(e, len(rows)), strict=True)
    return before_stops(omega, decay, gamma, rows, [(gap, newton(one)) for gap, one in each], **more)


def hit(rows, e, v, law="moreau", held=None):
    """Velocities after all stops are hit at t = 1/4 on the way along v; a weak load holds the stop `held`."""
    load = 1e-3 * rows[held] if held is not None else 0.0 * v
    regime = tuple(Regime.SUSTAINED if number == held else Regime.OUTSIDE for number in range(len(rows)))
    bodies = modes(rows, e, np.maximum(rows @ v, 0.0), load=load, simultaneous=law)
    run = simulate(bodies, State(displacement=0.75 * v, velocity=v, regime=regime), duration=0.5)
    hits, found = run.impacts.kind == ImpactKind.IMPACT, run.end.velocity - 0.25 * load
    np.testing.assert_allclose(run.impacts.start[hits], 0.25, rtol=1e-12)
    stop, impulse = run.impacts.stop[hits], run.impacts.impulse[hits]
    np.testing.assert_allclose(run.impacts.approach[hits], rows[stop] @ v, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(run.impacts.rebound[hits], rows[stop] @ found, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(impulse @ rows[stop], v - found, rtol=1e-12, atol=1e-12)
    assert len(set(stop)) == len(rows) - (held is not None) and np.all(run.impacts.together[hits])
    assert run.impacts.loss.sum() == pytest.approx(0.5 * (v @ v - found @ found), rel=1e-9)
    return found


TWO, AT_REST = [[1.0, 0.5], [1.0, -0.5]], [[1.0, 0.5], [0.6, -0.4]]
THREE = [[1.0, 0.5], [1.0, 0.0], [1.0, -0.5]]  # dependent: single impulses are not known
# rows, e, modal velocities before, stop at rest; W v+ by Moreau's law, and one stop after the other
TABLE = {
    "symmetric": (TWO, 0.7, [1.0, 0.0], None, [-0.7, -0.7], [-0.7, -0.02]),
    "each its own e": (TWO, [0.8, 0.4], [1.0, 0.0], None, [-0.8, -0.4], [-0.8, -0.08]),
    "at rest": (AT_REST, [0.7, 0.6], [5 / 7, -10 / 7], 0, [-16 / 13, -0.6], [-16 / 13, -0.6]),
    "uncoupled": (np.eye(2), [0.7, 0.6], [0.4, 1.0], None, [-0.28, -0.6], [-0.28, -0.6]),
    "three": (THREE, 0.7, [1.0, 0.4], None, [-0.84, -0.7, -0.56], None),
    "one of three": (THREE, 0.7, [1.0, 1.5], None, [-1.225, -1.38, -1.535], None),
}


@pytest.mark.parametrize("name", TABLE)
def test_table(name):
    """Moreau's law is the same in any order of the stops.  Of equal speeds the lowest number goes first."""
    rows, e, v, held, after, one_by_one = TABLE[name]
    rows, v, e = np.array(rows), np.array(v), np.broadcast_to(e, len(rows))
    np.testing.assert_allclose(rows @ hit(rows, e, v, held=held), after, rtol=1e-12)
    turned = None if held is None else len(rows) - 1 - held
    np.testing.assert_allclose(rows @ hit(rows[::-1], e[::-1], v, held=turned), after, rtol=1e-12)
    if one_by_one:
        np.testing.assert_allclose(rows @ hit(rows, e, v, "sequential", held), one_by_one, rtol=1e-12)


def test_random_impacts():
    rng = np.random.default_rng(56)
    for count in rng.integers(2, 6, 60):
        rows, v = np.eye(count, 5) + rng.normal(0.0, 0.4, (count, 5)), rng.uniform(0.5, 1.0, 5)
        rows *= np.sign(rows @ v)[:, None]
        e, each = rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0, count)
        if (rows @ v).min() < 0.1:  # a slow touch has a time that is less certain
            continue
        for own in (e + 0.0 * each, each):
            u = np.linalg.lstsq(rows, (1.0 + own) * (rows @ v))[0]
            known = v - rows.T @ nnls(rows.T, u)[0]
            np.testing.assert_allclose(hit(rows, own, v), known, rtol=0, atol=1e-12 * np.abs(v).max())
        one_by_one = hit(rows, e, v, "sequential")
        assert np.all(rows @ one_by_one < 1e-12) and one_by_one @ one_by_one < v @ v


@pytest.mark.parametrize("balls, thrown", [(3, 1), (5, 1), (5, 2)])
@pytest.mark.parametrize("e", [1.0, 0.5])
def test_newtons_cradle(balls, thrown, e):
    """Of equal balls that touch, as many leave as are thrown.  By Moreau's law all leave together."""
    v, rows, after = 1.0 * (np.arange(balls) < thrown), -np.diff(np.eye(balls), axis=0), {}
    for law in ("moreau", "sequential"):
        row = modes(rows, e, 0.0, simultaneous=law)
        after[law] = simulate(row, State(displacement=-0.25 * v, velocity=v), duration=0.5).end.velocity
        assert after[law].sum() == pytest.approx(thrown, rel=1e-13)
        assert after[law] @ after[law] <= thrown * (1.0 + 1e-13)
    np.testing.assert_allclose(after["moreau"], (1.0 + e) * thrown / balls - e * v, atol=1e-13)
    if e == 1.0:
        np.testing.assert_allclose(after["sequential"], v[::-1], rtol=1e-12, atol=1e-13)


EVEN, ODD = [[1.0, -0.8, 0.5, 0.3], [0.6, 0.9, -0.4, 0.7]], [[0.9, 0.7, -0.6, 0.2], [0.3, -0.5, 0.8, 0.4]]
FOUR = dict(omega=[1.0, 2.7, 5.1, 8.3, 1.9, 3.8, 6.6, 9.7], decay=[0.05] * 8)
FOUR |= dict(gamma=[1.0, 0.6, 0.4, 0.3, 0.0, 0.0, 0.0, 0.0])
# rows in even and odd modes, and e; numbers of the even and odd modes; drive and duration
TWO_MODES = dict(omega=[1.0, 2.5], decay=[0.1, 0.2], gamma=[1.0, 0.0])
MIRRORED = {
    "two points": ([[1.0]], [[0.5]], 0.7, TWO_MODES, 0.9, 60.0),
    "four points": (EVEN, ODD, 0.8, FOUR, 0.26 * np.pi, 3000.0),
}


@pytest.mark.parametrize("name", MIRRORED)
def test_points_that_mirror_each_other_are_hit_together(name):
    """A motion of even modes stays even, and meets each pair as one stop; two points also in 40 digits."""
    even, odd, e, numbers, w, duration = MIRRORED[name]
    rows = np.block([[np.array(even), np.array(odd)], [np.array(even), -np.array(odd)]])
    drive = HarmonicDrive(frequency=w / (2 * np.pi), amplitude=1.5)
    run = simulate(modes(rows, e, 1.0, **numbers, drive=drive), duration=duration)
    half = {key: value[: len(value) // 2] for key, value in numbers.items()}
    alone = simulate(modes(np.array(even), e, 1.0, **half, drive=drive), duration=duration).impacts
    for key in ("start", "approach", "rebound"):
        pairs = getattr(run.impacts, key).reshape(-1, 2)[:16]
        np.testing.assert_allclose(pairs, getattr(alone, key)[:16, None] + [0, 0], rtol=1e-9)
    assert np.all(run.impacts.together) and len(run.impacts) > (1000 if len(even) > 1 else 16)
    assert not run.strobe_displacement[:, len(even[0]) :].any()
    if name == "two points":
        known = [-0.4287297747445646, 0.0, -0.005770101775189248, 0.0]
        np.testing.assert_allclose([*run.end.displacement, *run.end.velocity], known, rtol=0, atol=1e-10)


def test_a_rest_of_points_that_mirror_each_other_begins_when_that_of_one_does():
    """The hops that are left last some 1e-6; the damping, which slows them, moves their end by 1e-11."""
    numbers = dict(gamma=[1.0, 0.0], decay=[8.0, 8.0], drive=HarmonicDrive(frequency=0.02, amplitude=300.0))
    pair = modes([[1.0, 0.5], [1.0, -0.5]], 0.9, 0.1, omega=[1.0, 2.5], **numbers)
    alone = modes([[1.0, 0.0]], 0.9, 0.1, omega=[1.0, 2.5], **numbers)
    runs = [simulate(each, periods=2).impacts for each in (pair, alone)]
    rests = [run.start[run.kind == ImpactKind.STAY] for run in runs]
    assert rests[1].size == 2
    np.testing.assert_allclose(rests[0].reshape(-1, 2), rests[1][:, None] + [0, 0], rtol=0, atol=1e-12)


def test_a_rest_begins_as_if_a_dashpot_that_is_pressed_too_were_in_the_mode():
    law, begun = LinearContact(stiffness=10.0, damping=2.0), State(displacement=[0.099], velocity=[0.0])
    stops = [(0.1, newton(0.9)), (0.05, law)]
    pressed = before_stops([1.0], [0.1], [0.0], [[1.0], [1.0]], stops, load=[0.8])
    stiffer = before_stops([np.sqrt(11.0)], [2.1], [0.0], [[1.0]], stops[:1], load=[1.3])
    runs = [simulate(each, begun, duration=5.0).impacts for each in (pressed, stiffer)]
    rests = [run.start[run.kind == ImpactKind.STAY] for run in runs]
    np.testing.assert_allclose(*rests, rtol=0, atol=1e-12)
