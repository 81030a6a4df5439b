"""Motions between several stops against 40 digits: stored ones, random ones, and planted grazes."""

import json
import os
from collections import Counter
from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from make_many_stops import judged, random_problem
from many_stops_flights import Exact, System
from many_stops_judge import distance, follow
from oscillators import modes_on_stop, newton, slow
from tip_judge import PLANTED, Real, Signal, judge, with_gap

from beam import ModalModel, Point
from contact import HarmonicDrive, ImpactKind, ImpactOscillator, State, Stop, Trajectory, simulate
from contact.flight.crossing import GRAZE_TOLERANCE
from contact.flight.elementary import EPS
from contact.flight.modal_flow import steady_motion
from contact.flight.tip import tip_rounding
from contact.laws import LinearContact

PROBLEMS = {one["name"]: one for one in json.loads(Path(__file__).with_name("many_stops.json").read_text())}
SLOW = 1e-5
FRESH = int(os.environ.get("MANY_STOPS_FRESH", "40"))
"""Random problems of the slow test; drawing one takes some two seconds."""


def oscillator_of(problem: dict) -> ImpactOscillator:
    rows = {name: problem[name] for name in ("omega", "decay_rate", "phi", "participation")}
    points = {name: Point(row=row) for name, row in problem["points"].items()}
    stops = []
    for one in problem["stops"]:
        name, *law = one["law"]
        at = one["at"] if isinstance(one["at"], str) else tuple(one["at"])
        law = newton(*law) if name == "newton" else LinearContact(stiffness=law[0], damping=law[1])
        stops.append(Stop(gap=one["gap"], law=law, at=at, side=one["side"]))
    return ImpactOscillator(
        model=ModalModel(**rows, points=points, dimensionless=True),
        stops=tuple(stops),
        drive=HarmonicDrive(frequency=problem["w"] / (2.0 * np.pi), amplitude=problem["amplitude"]),
        load=problem.get("load"),
    )


def run(problem: dict) -> Trajectory:
    q, v = (np.array(problem[name], dtype=float) for name in ("q", "v"))
    start = State(displacement=q, velocity=v)
    return simulate(oscillator_of(problem), start, duration=float(problem["duration"]))


def check(problem: dict) -> None:
    """Every touch and stay and the end to 1e3 roundings of the start, dates after infinite hops to 1e-10.

    Impacts below 1e-5 of the fastest are left out: the package sums hops lower than 20 rounding bounds.
    """
    answer, end = dict(problem["answer"]), run(problem)
    i, known = end.impacts, [Exact(x[3]) for x in answer["touches"]]
    answer["touches"] = [x for x, v in zip(answer["touches"], known, strict=True) if v >= SLOW * max(known)]
    assert not np.any(i.kind == ImpactKind.GRAZE)
    stays, hits = (i.kind == ImpactKind.STAY), (i.kind != ImpactKind.STAY)
    hits &= i.approach >= SLOW * i.approach[hits].max(initial=0.0)
    columns = [i.stop, i.start, i.end, i.approach, i.rebound, i.impulse]
    found = {
        "touches": list(zip(*(x[hits].tolist() for x in columns), strict=True)),
        "stays": list(zip(*(x[stays].tolist() for x in columns[:3]), strict=True)),
        "q": end.end.displacement,
        "v": end.end.velocity,
    }
    far, hops = distance(problem, answer, found)
    assert far <= 1e3 * EPS * answer["amplification"] and hops <= 1e-10


@pytest.mark.filterwarnings("ignore:frequency of the drive:beam.SuspiciousValue")
@pytest.mark.parametrize("name", PROBLEMS)
def test_stored_motions(name):
    check(PROBLEMS[name])


@pytest.mark.parametrize("name", [name for name, one in PROBLEMS.items() if "known" in one])
def test_judge_agrees_with_another_program(name):
    """To 1e-20: the judge computes anew what the other program has computed in 40 digits."""
    answer, known, pairs = follow(PROBLEMS[name]), PROBLEMS[name]["known"], []
    for stop, time, speed in known.get("touches", []):
        ends = [x[i::2][:2] for x in answer["touches"] for i in (1, 2) if x[0] == stop and x[i] == x[i]]
        pairs.append((min(ends, key=lambda x: abs(x[0] - Exact(time))), [time, speed]))
    if "end" in known:
        pairs.append((answer["q"] + answer["v"], [*known["end"][0], *known["end"][1]]))
    for ours, theirs in pairs:
        assert max(abs(a - Exact(b)) for a, b in zip(ours, theirs, strict=True)) < Exact("1e-20")


def test_judge_knows_the_bouncing_mass():
    """A mass under the pull g: each hop takes e times as long as the last, until the stop holds it."""
    e, g, gap = Exact("0.5"), Exact("9.8125"), Exact("0.25")
    numbers = {name: [0.0] for name in ("omega", "decay_rate", "participation", "q", "v")}
    stop = {"gap": gap, "at": "tip", "side": 1, "law": ["newton", e]}
    numbers |= {"phi": [1.0], "load": [g], "points": {}, "w": 1.0, "amplitude": 0.0, "stops": [stop]}
    answer, first = follow(numbers | {"duration": 2.0}), (2 * gap / g) ** 0.5
    for n, touch in enumerate(answer["touches"]):
        time, speed = first * (1 + 2 * e * (1 - e**n) / (1 - e)), g * first * e**n
        assert abs(touch[1] - time) < Exact("1e-30") > abs(touch[3] - speed)
    [(_, start, _)] = answer["stays"]
    assert len(answer["touches"]) == 20 and abs(start - 3 * first) < Exact("1e-30")
    assert (answer["q"], answer["v"]) == ([gap], [0])


@pytest.mark.slow
def test_fresh_motions():
    for seed in range(FRESH):
        check(judged(np.random.default_rng([53, seed])))


def views(rng: np.random.Generator) -> tuple:
    """A flight before several stops: oscillator, start, length, and how each stop sees it."""
    problem = random_problem(rng) | {"load": None}
    oscillator, rows = oscillator_of(problem), System(problem).rows
    time, length = rng.uniform(0.0, 0.5) * oscillator.period, min(4.0, 0.4 * oscillator.period)
    start = State(displacement=problem["q"], velocity=problem["v"], time=time)
    numbers = [problem["omega"], problem["decay_rate"], problem["participation"]]
    seen, stops, drive = [], [], (oscillator.drive.frequency, oscillator.drive.amplitude)
    for stop, row in zip(oscillator.stops, rows, strict=True):
        one = modes_on_stop(*numbers[:2], row.astype(float), numbers[2], drive=drive).numbers()
        steady = steady_motion(one, time)
        flight = start.displacement - steady[0], start.velocity - steady[1]
        signal = Signal(one, time, *flight)
        tops = signal.peaks(length)
        phis = (before[0].phi for before in seen)
        same = any(np.linalg.matrix_rank([one.phi, phi]) < 2 and one.phi @ phi > 0 for phi in phis)
        if tops.size and signal(tops).max() > 0.01 and not same:
            seen.append((one, flight, signal, tops, signal(tops).max()))
            stops.append(stop)
    return oscillator, start, length, stops, seen


@pytest.mark.parametrize("count", [1000, *slow(100_000)])
@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_planted_grazes(count):
    """The highest peak before each stop is 1e-1 to 1e-12 of the gap above or below it: which is first?"""
    rng, counts = np.random.default_rng([54, count]), Counter()
    while counts.total() < count:
        oscillator, start, length, stops, seen = views(rng)
        for _ in range(48 if seen else 0):
            h = rng.choice(PLANTED, len(seen), replace=False)
            touches, blurred, planted = [(length, None, 0.0)], False, []
            for j, (motion, flight, signal, tops, highest) in enumerate(seen):
                gap = float(highest / (1 + Real(h[j])))
                planted.append(replace(stops[j], gap=gap, law=newton(0.5)))
                verdict = judge(signal, gap, length, peaks=tops)
                bound = tip_rounding(with_gap(motion, gap), *flight)
                blurred |= bool(abs(verdict.peak) <= 2.0 * bound)
                if verdict.peak > 0:
                    allowed = bound / verdict.slope + 4 * EPS * (start.time + verdict.time)
                    touches.append((float(verdict.time), j, float(allowed)))
            touches.sort()
            time, stop, allowed = touches[0]
            if blurred or (len(touches) > 2 and touches[1][0] - time <= allowed + touches[1][2]):
                counts["within rounding"] += 1
                continue
            until = length if stop is None else min(length, time + 1e-6 * oscillator.period)
            planted = replace(oscillator, stops=tuple(planted))
            i = simulate(planted, start, duration=until).impacts
            assert i.stop[:1].tolist() == ([] if stop is None else [stop])
            assert np.all(abs(i.clock[:1] - start.time - time) <= allowed)
            assert np.all(i.kind[:1] == ImpactKind.IMPACT)
            counts["free" if stop is None else "touches"] += 1
    assert counts["within rounding"] < 0.01 * counts.total()
    assert min(counts["free"], counts["touches"]) > 0.2 * count


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_a_graze_of_one_stop_goes_before_or_after_the_hit_of_another():
    """The gap of the first stop is its highest peak, rounded to a double."""
    rng, counts = np.random.default_rng(55), Counter()
    while counts.total() < 400:
        oscillator, start, length, stops, seen = views(rng)
        for (one, view), (two, (_, _, other, peaks, top)) in permutations(zip(stops, seen, strict=True), 2):
            motion, flight, signal, tops, highest = view
            at, gap = float(tops[np.argmax(signal(tops))]), float(top / (1 + Real(0.1)))
            hit, height = float(judge(other, gap, length, peaks=peaks).time), float(highest)
            blurred = tip_rounding(with_gap(motion, height), *flight) > GRAZE_TOLERANCE * height
            higher = signal(np.array([length])).max() > highest  # still rising at the end
            if blurred or higher or abs(hit - at) < 1e-3 * length:
                continue
            both = replace(one, gap=height, law=newton(0.5)), replace(two, gap=gap, law=newton(0.5))
            until = max(at, hit) + 1e-6 * length
            found = simulate(replace(oscillator, stops=both), start, duration=until).impacts
            if hit < at:
                assert (found.stop[0], found.kind[0]) == (1, ImpactKind.IMPACT)
                assert found.clock[0] - start.time == pytest.approx(hit, rel=1e-9)
            else:
                assert found.stop[:2].tolist() == [0, 1] and found.kind[0] != ImpactKind.STAY
                if found.kind[0] == ImpactKind.GRAZE:  # else rounding has put the peak above the stop
                    assert found.clock[:2] - start.time == pytest.approx([at, hit], rel=1e-6)
                    assert np.all(found.deviations_start[0] == found.deviations_end[0])
            counts["hit" if hit < at else ("impact", "graze")[int(found.kind[0])]] += 1
    assert min(counts["graze"], counts["hit"]) > 20 and counts["impact"] < 3
