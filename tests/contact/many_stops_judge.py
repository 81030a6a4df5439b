"""Motions between several stops in 40 digits, written apart from the package, and random problems for it.

    q_k'' + c_k q_k' + omega_k^2 q_k = Gamma_k Z w^2 sin(w t) - sum_j w_jk N_j,     d_j = w_j . q - gap_j

A problem is a dict of numbers, doubles or decimal strings, both taken exactly.  Between two events the modes
are a sum of exponentials: their own, or under a linear contact N = k d + c d' the roots of
1 + (k + c s) sum w^2/(s^2 + c_k s + omega_k^2) = 0.  Signals are sampled at 64 points per period of the fastest
term.  Each maximum between samples near zero is found and decided in 40 digits, as is the first root.
"""

import math

import mpmath
import numpy as np
from mpmath import mpc, mpf

mpmath.mp.dps = 40
POINTS, CHUNK, DOUBLINGS = 64, 256, 2.0 ** -np.arange(20, 0, -1)
NUDGE, LARGEST, SLOW, FEWEST = mpf("1e-22"), 4e4, 1e-3, 5
"""Size of the change of a start by which amplification is measured; the largest amplification, the slowest
impact over the fastest one, and the fewest touches of a random problem."""


class System:
    """The numbers of a problem, and the rates and shapes of its motion, free or in contact with one stop."""

    def __init__(self, problem: dict) -> None:
        self.omega, self.decay, gamma = (
            [mpf(x) for x in problem[name]] for name in ("omega", "decay_rate", "participation")
        )
        points = {"tip": problem["phi"], **problem["points"]}
        self.rows, self.gaps, self.laws, self.known = [], [], [], {}
        for stop in problem["stops"]:
            one, *other = [stop["at"]] if isinstance(stop["at"], str) else stop["at"]
            second = points[other[0]] if other else [0] * len(gamma)
            self.rows.append(
                [stop["side"] * (mpf(a) - mpf(b)) for a, b in zip(points[one], second, strict=True)]
            )
            self.gaps.append(mpf(stop["gap"]))
            self.laws.append((stop["law"][0], *map(mpf, stop["law"][1:])))
        self.w = mpf(problem["w"])
        self.force = [g * mpf(problem["amplitude"]) * self.w**2 for g in gamma]

    def solve(self, s: mpc, force: list, stop: int | None) -> list:
        """x of (s^2 + c s + omega^2) x + (k + c s) w (w . x) = force, with the contact of `stop`."""
        own = [s * (s + c) + o * o for o, c in zip(self.omega, self.decay, strict=True)]
        x = [f / d for f, d in zip(force, own, strict=True)]
        if stop is None:
            return x
        row, (_, k, c) = self.rows[stop], self.laws[stop]
        y = [a / d for a, d in zip(row, own, strict=True)]
        part = (k + c * s) * dot(row, x) / (1 + (k + c * s) * dot(row, y))
        return [a - part * b for a, b in zip(x, y, strict=True)]

    def polished(self, s: mpc, stop: int) -> mpc:
        """The root of the contact's equation near `s`, by Newton's method on its polynomial."""
        row, (_, k, c) = self.rows[stop], self.laws[stop]
        for _ in range(20):
            own = [s * (s + b) + o * o for o, b in zip(self.omega, self.decay, strict=True)]
            slope = [2 * s + b for b in self.decay]
            total = sum(a * a / d for a, d in zip(row, own, strict=True))
            change = sum(a * a * g / d**2 for a, d, g in zip(row, own, slope, strict=True))
            f, rise = 1 + (k + c * s) * total, c * total - (k + c * s) * change
            step = 1 / (rise / f + sum(g / d for g, d in zip(slope, own, strict=True))) if f else mpf(0)
            s -= step
            if abs(step) < abs(s) * mpf("1e-30"):
                return s
        raise ArithmeticError("a rate of the contact was not found")

    def pieces(self, stop: int | None) -> tuple:
        """Rates and shapes of the free vibrations, the static displacement and the steady motion's phasor."""
        if stop not in self.known:
            n = len(self.omega)
            shapes = [[mpf(i == k) for i in range(n)] for k in range(n)]
            rates = [-c / 2 + 1j * mpmath.sqrt(o * o - c * c / 4) for o, c in zip(self.omega, self.decay)]
            static = [mpf(0)] * n
            if stop is not None:
                row, (_, k, c) = self.rows[stop], self.laws[stop]
                w, o, d = (np.array(x, dtype=float) for x in (row, self.omega, self.decay))
                whole = np.block(
                    [
                        [np.zeros((n, n)), np.eye(n)],
                        [-np.diag(o * o) - float(k) * np.outer(w, w), -np.diag(d) - float(c) * np.outer(w, w)],
                    ]
                )
                rates = [self.polished(mpc(s), stop) for s in np.linalg.eigvals(whole) if s.imag >= 0]
                shapes = [self.solve(s, row, None) for s in rates]
                static = self.solve(mpf(0), [k * self.gaps[stop] * a for a in row], stop)
            self.known[stop] = rates, shapes, static, self.solve(1j * self.w, self.force, stop)
        return self.known[stop]


def dot(a: list, b: list) -> mpc:
    return mpmath.fsum(x * y for x, y in zip(a, b, strict=True))


class Flow:
    """q(s) = Re sum_j vectors_j exp(rates_j s) + drift s from a state (q, v) at `time` on."""

    def __init__(self, system: System, time: mpf, q: list, v: list, stop: int | None) -> None:
        rates, shapes, static, phasor = system.pieces(stop)
        turned = [-1j * mpmath.expj(system.w * time) * x for x in phasor]
        u = [a - b - c.real for a, b, c in zip(q, static, turned, strict=True)]
        du = [a - (1j * system.w * c).real for a, c in zip(v, turned, strict=True)]
        damped, (row, c) = system.decay, (system.rows[stop], system.laws[stop][2]) if stop is not None else (u, 0)
        self.system, self.drift = system, [mpf(0)] * len(u)
        self.rates, self.vectors = [mpf(0), 1j * system.w], [static, turned]
        for s, r in zip(rates, shapes, strict=True):
            if s == 0:  # a free mass
                self.drift = [a + b * d for a, b, d in zip(self.drift, r, du, strict=True)]
                top, bottom = dot(r, u), mpf(1)
            else:
                pull = [(b + s) * x + y for b, x, y in zip(damped, u, du, strict=True)]
                top = dot(r, pull) + c * dot(row, r) * dot(row, u)
                bottom = dot([b + 2 * s for b in damped], [x * x for x in r]) + c * dot(row, r) ** 2
            part = top / bottom * (1 if s.imag == 0 else 2)
            self.rates.append(s)
            self.vectors.append([part * x for x in r])

    def state(self, s: mpf) -> tuple[list, list]:
        grown = [mpmath.exp(r * s) for r in self.rates]
        rising = [g * r for g, r in zip(grown, self.rates, strict=True)]
        columns = list(zip(*self.vectors, strict=True))
        q = [dot(grown, x).real + d * s for x, d in zip(columns, self.drift, strict=True)]
        return q, [dot(rising, x).real + d for x, d in zip(columns, self.drift, strict=True)]


class Signal:
    """a d + b d' of a stop along a flow, with two derivatives."""

    def __init__(self, flow: Flow, stop: int, a: mpf, b: mpf) -> None:
        row, self.rates = flow.system.rows[stop], flow.rates
        self.terms = [(a + b * r) * dot(row, x) for r, x in zip(flow.rates, flow.vectors, strict=True)]
        drift = dot(row, flow.drift)
        self.terms[0] += b * drift - a * flow.system.gaps[stop]
        self.drift = a * drift
        self.quick = [np.array(x, dtype=complex) for x in (self.rates, self.terms)]
        self.size = float(np.abs(self.quick[1]).sum())

    def samples(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and slope in double precision."""
        rates, terms = self.quick
        grown = np.exp(np.multiply.outer(s, rates))
        return (grown @ terms).real + float(self.drift) * s, (grown @ (terms * rates)).real + float(self.drift)

    def exact(self, s: mpf) -> tuple[mpf, mpf, mpf]:
        one = [t * mpmath.exp(r * s) for r, t in zip(self.rates, self.terms, strict=True)]
        two = [r * x for r, x in zip(self.rates, one, strict=True)]
        bend = dot(self.rates, two).real
        return mpmath.fsum(one).real + self.drift * s, mpmath.fsum(two).real + self.drift, bend

    def rise(self, low: float, high: float, *, peak: bool) -> mpf:
        """Where the value, or for a `peak` minus the slope, rises through zero in [low, high]."""
        low, high = mpf(low), mpf(high)
        s = (low + high) / 2
        for _ in range(300):
            x, slope, bend = self.exact(s)
            y, rate = (-slope, -bend) if peak else (x, slope)
            low, high = (s, high) if y < 0 else (low, s)
            new = s - y / rate if rate > 0 else low - 1
            new = new if low <= new <= high else (low + high) / 2
            if abs(new - s) <= mpf("1e-35") * (abs(s) + high - low):
                return new
            s = new
        raise ArithmeticError("a root was not found")


def first_rise(signals: dict, at_zero: set, end: mpf) -> list:
    """Sorted (place, name) of signals that rise through zero first in (0, end]; `at_zero` start there, falling."""
    rates = next(iter(signals.values())).quick[0]
    step, start = 2 * math.pi / POINTS / float(np.abs(rates).max()), 0.0
    while start < end:
        s = start + step * np.arange(CHUNK + 1)
        s = np.concatenate([[0.0], step * DOUBLINGS, s[1:]]) if start == 0 else s
        found = []
        for name, signal in signals.items():
            x, slope = signal.samples(s)
            if start == 0 and name in at_zero:
                x[0] = -signal.size
            tops = (slope[:-1] > 0) & (slope[1:] <= 0) & (np.maximum(x[:-1], x[1:]) > -0.02 * signal.size)
            for i in np.flatnonzero(tops | (x[1:] > 0)):
                high = signal.rise(s[i], s[i + 1], peak=True) if tops[i] else mpf(s[i + 1])
                if signal.exact(high)[0] > 0:
                    found.append((signal.rise(s[i], high, peak=False), name))
                    break
        if found := sorted(one for one in found if one[0] <= end):
            return found
        start = float(s[-1])
    return []


def follow(problem: dict, *, nudge: mpf = mpf(0), most: int = 10**6) -> dict:
    """Touches [stop, start, end, approach, rebound] and the state at the end, in 40 digits.

    Where a second stop is reached while one is touched the run ends: `at_once` is the time.
    """
    system, time, end = System(problem), mpf(0), mpf(problem["duration"])
    q, v = ([mpf(x) for x in problem[name]] for name in ("q", "v"))
    v = [x + nudge * a for x, a in zip(v, map(sum, zip(*system.rows, strict=True)), strict=True)]
    touches, held, pushed, left = [], None, False, None
    while len(touches) < most or held is not None:
        flow = Flow(system, time, q, v, held if pushed else None)
        signals = {("touch", j): Signal(flow, j, 1, 0) for j in range(len(system.rows)) if j != held}
        at_zero = {("touch", left)}
        if held is not None:
            _, k, c = system.laws[held]
            if pushed:
                signals["let go", held] = Signal(flow, held, -k, -c)
                at_zero |= set() if c else {("let go", held)}
            else:
                signals |= {("leave", held): Signal(flow, held, -1, 0), ("push", held): Signal(flow, held, k, c)}
                at_zero |= {("push", held)}
        found = first_rise(signals, at_zero, end - time)
        if not found:
            q, v = flow.state(end - time)
            break
        (s, (what, stop)), left = found[0], None
        q, v = flow.state(s)
        time, speed = time + s, dot(system.rows[stop], v)
        if what == "touch" and (held is not None or (len(found) > 1 and found[1][0] - s < mpf("1e-30"))):
            return {"touches": touches, "at_once": time, "free": held is not None and not pushed}
        if what == "touch" and system.laws[stop][0] == "newton":
            e, row, left = system.laws[stop][1], system.rows[stop], stop
            v = [x - (1 + e) * speed / dot(row, row) * a for x, a in zip(v, row, strict=True)]
            touches.append([stop, time, time, speed, -e * speed])
        elif what == "touch":
            touches.append([stop, time, None, speed, None])
            held, pushed = stop, True
        elif what == "leave" or (what == "let go" and not c):
            touches[-1][2::2] = time, speed
            held, left = None, stop
        else:
            pushed = what == "push"
    return {"touches": touches, "q": q, "v": v, "at_once": None}


def distances(problem: dict, one: dict, other: dict) -> list[float]:
    """By how much two answers differ in each touch and at the end; infinite if their stops differ.

    Times are multiplied by w, speeds are over the highest one, the end is measured by its energy.
    """
    a, b = one["touches"], other["touches"]
    if [x[0] for x in a] != [x[0] for x in b]:
        return [math.inf]
    w, top = mpf(problem["w"]), max([abs(mpf(x[3])) for x in a], default=mpf(1))
    scales = (w, w, 1 / top, 1 / top)
    far = [
        max(abs(mpf(p) - mpf(r)) * z for p, r, z in zip(x[1:], y[1:], scales, strict=True))
        for x, y in zip(a, b, strict=True)
    ]
    weights = [*problem["omega"], *[1] * len(problem["omega"])]
    ends = [[z * mpf(x) for z, x in zip(weights, [*y["q"], *y["v"]], strict=True)] for y in (one, other)]
    return [float(x) for x in (*far, mpmath.norm([x - y for x, y in zip(*ends, strict=True)]) / mpmath.norm(ends[0]))]


def random_problem(rng: np.random.Generator) -> dict:
    """One to eight modes between one to four stops, whose gaps the motion without them exceeds."""
    n, m = int(rng.integers(1, 9)), int(rng.integers(1, 5))
    omega = np.append(1.0, np.sort(rng.uniform(1.3, 40.0, n - 1)))
    spread, first = omega**-0.5, np.arange(n) == 0
    rows = {name: rng.uniform(-1.0, 1.0, n) * spread + first for name in ("tip", "b", "c")}
    places = ["tip", "b", "c", ("tip", "b"), ("b", "c")]
    problem = {
        "omega": omega,
        "decay_rate": 2.0 * 10.0 ** rng.uniform(-3.0, -1.3, n) * omega,
        "participation": rng.uniform(-1.0, 1.0, n) * spread + first,
        "phi": rows["tip"],
        "points": {name: rows[name] for name in ("b", "c")},
        "w": float(2.0 * np.pi * (rng.uniform(0.4, 1.6) / (2.0 * np.pi))),
        "amplitude": float(rng.uniform(0.2, 1.0)),
        "q": np.zeros(n),
        "v": rng.normal(size=n) * spread,
        "duration": 200.0,
    }
    free = Flow(System(problem | {"stops": []}), mpf(0), [mpf(0)] * n, [mpf(x) for x in problem["v"]], None)
    grown = np.exp(np.multiply.outer(np.arange(0.0, 40.0, 0.02), np.array(free.rates, dtype=complex)))
    q = (grown @ np.array(free.vectors, dtype=complex)).real
    problem["stops"] = []
    for _ in range(m):
        at, side = places[int(rng.integers(len(places)))], int(rng.choice((-1, 1)))
        row = rows[at] if isinstance(at, str) else rows[at[0]] - rows[at[1]]
        law = ["newton", float(rng.uniform(0.3, 0.95))]
        if rng.random() < 0.4:
            stiffness = rng.uniform(5.0, 60.0) ** 2 / (row @ row)
            dashpot = rng.choice((0.0, rng.uniform(0.05, 0.6))) * np.sqrt(stiffness / (row @ row))
            law = ["linear", float(stiffness), float(dashpot)]
        gap = float(rng.uniform(0.3, 0.8) * (side * (q @ row)).max())
        problem["stops"].append({"gap": gap, "at": at, "side": side, "law": law})
    return problem


def judged(rng: np.random.Generator) -> dict | None:
    """A random problem with its `answer`, ended before slow impacts and chaos; None if little happens in it.

    Where two stops are touched at once, the answer is the time of that.
    """
    problem, most = random_problem(rng), int(rng.integers(12, 42))
    answer = follow(problem, most=most)
    touches, at_once = answer["touches"], answer["at_once"]
    top = max((x[3] for x in touches), default=mpf(0))
    moved = follow(problem, nudge=NUDGE * top, most=most)
    if at_once:
        steady = moved["at_once"] and abs(moved["at_once"] - at_once) < LARGEST * NUDGE
        if not steady or answer["free"] or min(x[3] for x in touches) < SLOW * top:
            return None
        return problem | {"duration": float(at_once) + 1.0, "answer": {"at_once": at_once}}
    grown = distances(problem, answer, moved) + [math.inf] * len(touches)
    bad = (n for n, x in enumerate(touches) if x[3] < SLOW * top or not grown[n] < LARGEST * NUDGE)
    last = next(bad, len(touches) - 1)
    if last < FEWEST or touches[last][1] - touches[last - 1][2] < 0.01:
        return None
    problem["duration"] = float((touches[last - 1][2] + touches[last][1]) / 2)
    return problem | {"answer": complete(problem)}


def complete(problem: dict) -> dict:
    """The answer of a problem with its amplification: how many times larger a change of the start becomes."""
    answer = follow(problem)
    top = max(x[3] for x in answer["touches"])
    moved = follow(problem, nudge=NUDGE * top)
    return answer | {"amplification": max(distances(problem, answer, moved)) / float(NUDGE)}
