"""Motions between several stops in 60 digits: what happens at the ends of flights, and how answers compare.

Linear contacts N = max(0, k d + c d') act while d > 0.  Moreau's law acts at all stops under Newton's law
that are hit or hold: impulses p >= 0 along their rows and d'+ <= -e d'-, in each row one of them an equality.
After infinitely many hops a stop holds d = 0 by a force N >= 0.  It ends where N falls through zero, or by an
impact elsewhere.  The last hops take W = 2 w/(a (1 - e)), with the rebound w and the acceleration a.
"""

import math
from itertools import chain, combinations

import mpmath
import numpy as np
from many_stops_flights import ONE, TIE, TINY, ZERO, Exact, Flow, System, first_rise, numbers, solve

NUDGE, REST, SLOW, MOST = Exact("1e-22"), Exact("1e-18"), Exact("1e-6"), 1500
"""A change of the motion, the last rebound and an impact not listed, over the fastest; impacts of a run."""


class Unordinary(Exception):
    """Two stops are hit infinitely often in turn, or hold dependent points."""


def complementary(matrix: np.ndarray, value: np.ndarray) -> np.ndarray:
    """p >= 0 with value - matrix p <= 0, of which in each row one is zero."""
    tiny, every = TINY * max(abs(value)), range(len(value))
    for some in chain.from_iterable(combinations(every, n) for n in range(len(value) + 1)):
        p, some = 0 * value, list(some)
        try:
            p[some] = solve(matrix[np.ix_(some, some)], value[some])
        except ZeroDivisionError:
            continue
        if np.all(p >= 0) and np.all(value - matrix @ p <= tiny):
            return p
    raise Unordinary


class Motion:
    """The motion of a problem, event by event."""

    def __init__(self, problem: dict, system: System | None = None) -> None:
        self.system, self.time, self.end = system or System(problem), ZERO, Exact(problem["duration"])
        self.q, self.v = (numbers(problem[name]) for name in ("q", "v"))
        self.touches, self.stays, self.closed, self.resting = [], [], {}, {}
        self.pushed, self.fresh, self.last, self.highest, self.log = set(), set(), {}, ZERO, []

    def signals(self, flow: Flow) -> dict:
        found, system = {}, self.system
        for j, c in enumerate(system.damping):
            if j in self.resting:
                found["release", j] = flow.force(j)
            elif j not in self.closed:
                found["touch", j] = flow.distance(j)
            elif j in self.pushed and c:
                found["let go", j] = flow.distance(j, -system.first[j], -c)
            else:
                found["leave", j] = flow.distance(j, -ONE)
                if c:
                    found["push", j] = flow.distance(j, system.first[j], c)
        return found

    def run(self, *, nudge: Exact = ZERO, turn: int = 1, most: int = 10**6) -> dict:
        """The answer; a `nudge` changes the velocity at the start and at each event, as rounding does."""
        system = self.system
        start = self.v + system.force + system.load
        self.v = self.v + nudge * start / mpmath.norm(start)
        while sum(x[3] > 1e-3 * self.highest for x in self.touches) < most:
            if len(self.touches) > MOST:
                raise Unordinary
            flow = Flow(system, self.time, self.q, self.v, sorted(self.pushed), sorted(self.resting))
            found = first_rise(self.signals(flow), self.fresh, self.end - self.time)
            s = found[0][0] if found else self.end - self.time
            self.q, self.v = flow.state(s)
            self.time += s
            if not found:
                break
            nudge *= turn
            self.events([name for place, name in found if place - s < TIE], nudge)
        touches = [x for x in self.touches if x[3] >= SLOW * self.highest]
        return {"touches": touches, "stays": self.stays, "q": list(self.q), "v": list(self.v)}

    def events(self, names: list, nudge: Exact) -> None:
        """All that happens at this instant."""
        system, self.fresh = self.system, {j for _, j in names}
        self.log.append((self.time, names))
        rows = system.rows[sorted(self.resting)]
        push = system.rows[sorted(self.fresh)].sum(axis=0)
        self.v = self.v + nudge * (push - solve(rows @ rows.T, rows @ push) @ rows)
        speed = system.rows @ self.v
        hit = sorted(j for what, j in names if what == "touch" and system.newton[j])
        for what, j in names:
            if what == "touch" and j not in hit:
                self.closed[j] = [j, self.time, mpmath.nan, speed[j], mpmath.nan, mpmath.nan]
                self.touches.append(self.closed[j])
                self.highest = max(self.highest, speed[j])
            elif what == "leave":
                self.closed.pop(j)[2:5:2] = self.time, speed[j]
            elif what == "release":
                self.open(j)
            {"touch": self.pushed.add, "push": self.pushed.add}.get(what, self.pushed.discard)(j)
        self.pushed -= set(hit)
        small = self.impact(hit) if hit else []
        if small or self.resting:
            self.hold(small)

    def open(self, stop: int) -> None:
        self.resting.pop(stop)[2] = self.last[stop] = self.time
        self.fresh.add(stop)

    def impact(self, hit: list) -> list:
        """Moreau's law at the stops that are hit or hold; returns the stops whose rebound is the last."""
        system, stops = self.system, sorted([*hit, *self.resting])
        rows, e = system.rows[stops], system.first[stops]
        before = (rows @ self.v) * np.array([j in hit for j in stops])
        p = complementary(rows @ rows.T, (1 + e) * before)
        self.v = self.v - p @ rows
        self.highest, small = max(self.highest, *before), []
        for j, old, new, impulse in zip(stops, before, rows @ self.v, p, strict=True):
            if j in hit:
                self.touches.append([j, self.time, self.time, old, new, impulse])
                self.last[j] = self.time
                if abs(new) < REST * self.highest:
                    small.append(j)
            elif new < -Exact("1e-40") * self.highest:
                self.open(j)
        for j in self.closed:
            if c := system.damping[j]:
                d = system.rows[j] @ self.q - system.gaps[j]
                pushes = system.first[j] * d + c * (system.rows[j] @ self.v) > 0
                (self.pushed.add if pushes else self.pushed.discard)(j)
        free = [t for j, t in self.last.items() if j not in stops]
        if small and any((self.time - t) * system.w < 1e-9 for t in free):
            raise Unordinary
        return small

    def hold(self, small: list) -> None:
        """The same law at accelerations, for stops that hold and those whose hops are over."""
        system, stops = self.system, sorted([*self.resting, *small])
        stiff, damp, force = system.matrices(sorted(self.pushed))
        rows, old = system.rows[stops], [stops.index(j) for j in sorted(self.resting)]
        square = rows @ rows.T
        v = self.v - solve(square, rows @ self.v) @ rows
        a = force + system.force * mpmath.sin(system.w * self.time) - stiff @ self.q - damp @ v
        rate, waits = rows @ a, []
        holds = complementary(square, rate)
        if small and old:  # what pulls a hopping point back while the others hold
            rate = rate - square[:, old] @ complementary(square[np.ix_(old, old)], rate[old])
        for i, j in enumerate(stops):
            if holds[i] > 0 and j in small:
                waits.append(-2 * (rows[i] @ self.v) / (rate[i] * (1 - system.first[j])))
                self.resting[j] = [j, self.time + waits[-1], mpmath.nan]
                self.stays.append(self.resting[j])
            elif holds[i] <= 0 and j in self.resting:
                self.open(j)
        if waits and max(waits) - min(waits) > 1e-9 * max(waits):
            raise Unordinary
        held = system.rows[sorted(self.resting)]
        self.v = self.v - solve(held @ held.T, held @ self.v) @ held


def follow(problem: dict, **how: float) -> dict:
    """Touches [stop, start, end, approach, rebound, impulse], stays [stop, start, end], the state at the end.

    Without impulse or end these are NaN; impacts below 1e-6 of the fastest are left out.
    """
    return Motion(problem).run(**how)


def size(problem: dict, q: list, v: list) -> Exact:
    """The root of twice the energy of a state."""
    return mpmath.norm([*(numbers(problem["omega"]) * numbers(q)), *numbers(v)])


def distance(problem: dict, one: dict, other: dict) -> tuple[float, float]:
    """The largest difference of two answers, and that of the dates of rest after infinitely many hops.

    Times by w, speeds and impulses over the highest, the end over its size.
    """
    w, parts, hops = Exact(problem["w"]), [], [ZERO]
    for name, width in (("touches", 6), ("stays", 3)):
        a, b = (sorted(map(list, numbers(answer[name]).reshape(-1, width))) for answer in (one, other))
        a, b = (np.array(x, dtype=object).reshape(-1, width) for x in (a, b))
        if a.shape != b.shape or np.any(a[:, 0] != b[:, 0]) or np.any((a != a)[:, :5] != (b != b)[:, :5]):
            return math.inf, math.inf
        hopped = [name == "stays" and float(problem["stops"][int(j)]["law"][1]) > 0 for j in a[:, 0]]
        a, b = a[:, 1:], b[:, 1:]
        far = np.where((a == a) & (b == b), abs(a - b), ZERO)
        for i in range(2, width - 1):
            known = a[:, i][a[:, i] == a[:, i]]
            far[:, i] /= max([TINY, *abs(known)])
        far[:, :2] *= w
        hops += list(far[hopped, 0])
        far[hopped, 0] = ZERO
        parts += list(far.ravel())
    end = size(problem, *(numbers(one[x]) - numbers(other[x]) for x in "qv"))
    return float(max([*parts, end / size(problem, one["q"], one["v"])])), float(max(hops))


def complete(problem: dict, system: System | None = None) -> dict:
    """A problem with its answer, and its amplification: by how much changes of the motion grow."""
    system = system or System(problem)
    answer = Motion(problem, system).run()
    nudge = NUDGE * max(size(problem, answer["q"], answer["v"]), *(x[3] for x in answer["touches"]), ZERO)
    other = (Motion(problem, system).run(nudge=nudge, turn=turn) for turn in (1, -1))
    far = max(max(distance(problem, answer, one)) for one in other)
    return problem | {"answer": answer | {"amplification": max(1.0, far / float(NUDGE))}}
