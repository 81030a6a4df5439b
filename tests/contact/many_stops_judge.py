"""Motions between several stops in 40 digits, written apart from the package, and random problems.

    q_k'' + c_k q_k' + omega_k^2 q_k = Gamma_k Z w^2 sin(w t) - sum_j w_jk N_j,     d_j = w_j . q - gap_j

A problem is a dict of numbers, doubles or decimal strings, both taken exactly.  Between two events the modes
are sums of exponentials: their own, or under a linear contact N = k d + c d' the roots s of 1 + (k + c s) sum
w_k^2/(s^2 + c_k s + omega_k^2) = 0.  Signals are sampled at 64 points per period of the fastest one.  Each
maximum near zero between samples is found in 40 digits and decides, and so is the root before it.
"""

import math

import mpmath
import numpy as np

mpmath.mp.dps = 40
Exact = mpmath.mpf
ZERO, ONE = Exact(0), Exact(1)
exp, real, exact = (np.frompyfunc(f, 1, 1) for f in (mpmath.exp, lambda x: x.real, Exact))
CHUNK, DOUBLINGS, NUDGE = 256, 2.0 ** -np.arange(20, 0, -1), Exact("1e-22")
PLACES = ["tip", "b", "c", ("tip", "b"), ("b", "c")]


def numbers(values: list) -> np.ndarray:
    return exact(np.array(values, dtype=object))


class System:
    """The numbers of a problem, and what its motion is made of, free or in contact with one stop."""

    def __init__(self, problem: dict) -> None:
        names = ("omega", "decay_rate", "participation")
        self.omega, self.decay, gamma = (numbers(problem[name]) for name in names)
        self.w, self.law, self.known = Exact(problem["w"]), [stop["law"] for stop in problem["stops"]], {}
        self.force = gamma * Exact(problem["amplitude"]) * self.w**2
        rows = {name: numbers(row) for name, row in (problem["points"] | {"tip": problem["phi"]}).items()}
        places = [(stop["side"], stop["at"]) for stop in problem["stops"]]
        self.rows = [s * (rows[at] if isinstance(at, str) else rows[at[0]] - rows[at[1]]) for s, at in places]
        self.gaps = [Exact(stop["gap"]) for stop in problem["stops"]]

    def contact(self, stop: int | None) -> tuple:
        """The row, k and c of a linear contact; without one all are zero."""
        return (0 * self.omega, 0, 0) if stop is None else (self.rows[stop], *map(Exact, self.law[stop][1:]))

    def solve(self, s: mpmath.mpc, force: np.ndarray, stop: int | None) -> np.ndarray:
        """x of (s^2 + c s + omega^2) x + (k + c s) w (w . x) = force."""
        own, (row, k, c) = s * (s + self.decay) + self.omega**2, self.contact(stop)
        x, y = force / own, (k + c * s) * row / own
        return x - y * (row @ x) / (1 + row @ y)

    def rate(self, s: mpmath.mpc, stop: int) -> mpmath.mpc:
        """The rate of a motion in contact near `s`, by Newton's method on the polynomial."""
        row, k, c = self.contact(stop)
        for _ in range(20):
            own, slope = s * (s + self.decay) + self.omega**2, 2 * s + self.decay
            share, bend = (row**2 / own).sum(), (row**2 * slope / own**2).sum()
            f = 1 + (k + c * s) * share
            step = f / (c * share - (k + c * s) * bend + f * (slope / own).sum())
            s -= step
            if abs(step) < abs(s) * Exact("1e-25"):
                return s
        raise ArithmeticError("a rate of the contact was not found")

    def pieces(self, stop: int | None) -> tuple:
        """Rates and shapes of the free motions, static displacements, steady response."""
        if stop not in self.known:
            n, (row, k, c) = self.omega.size, self.contact(stop)
            rates = list(-self.decay / 2 + 1j * (self.omega**2 - self.decay**2 / 4) ** Exact(0.5))
            shapes, static = exact(np.eye(n)), 0 * self.omega
            if stop is not None:
                square = np.outer(row, row)
                lower = [-np.diag(self.omega**2) - k * square, -np.diag(self.decay) - c * square]
                whole = np.block([[np.zeros((n, n)), np.eye(n)], lower]).astype(float)
                rates = [self.rate(mpmath.mpc(s), stop) for s in np.linalg.eigvals(whole) if s.imag >= 0]
                shapes = np.array([self.solve(s, row, None) for s in rates])
                static = self.solve(Exact(0), k * self.gaps[stop] * row, stop)
            self.known[stop] = rates, shapes, static, self.solve(1j * self.w, self.force, stop)
        return self.known[stop]


class Flow:
    """q(s) = Re sum_j vectors_j exp(rates_j s) + drift s, from a state (q, v) at a time on."""

    def __init__(self, system: System, time: Exact, q: np.ndarray, v: np.ndarray, stop: int | None) -> None:
        rates, shapes, static, response = system.pieces(stop)
        steady = -1j * mpmath.expj(system.w * time) * response
        u, du, (row, _, c) = q - static - real(steady), v - real(1j * system.w * steady), system.contact(stop)
        self.rows, self.gaps, self.drift = system.rows, system.gaps, 0 * u
        self.rates, self.vectors = np.array([Exact(0), 1j * system.w, *rates]), [static, steady]
        for s, r in zip(rates, shapes, strict=True):
            if s == 0:  # a free mass
                self.drift = self.drift + r * du
                self.vectors.append(r * u)
            else:
                part = r @ ((system.decay + s) * u + du) + c * (row @ r) * (row @ u)
                part /= r @ ((system.decay + 2 * s) * r) + c * (row @ r) ** 2
                self.vectors.append(part * r if s.imag == 0 else 2 * part * r)
        self.vectors = np.array(self.vectors)

    def state(self, s: Exact) -> tuple[np.ndarray, np.ndarray]:
        grown = exp(self.rates * s)
        q, v = (real(x @ self.vectors) for x in (grown, grown * self.rates))
        return q + self.drift * s, v + self.drift


class Signal:
    """a d + b d' of a stop along a flow."""

    def __init__(self, flow: Flow, stop: int, a: Exact = ONE, b: Exact = ZERO) -> None:
        drift, self.rates = flow.rows[stop] @ flow.drift, flow.rates
        self.terms, self.drift = (a + b * flow.rates) * (flow.vectors @ flow.rows[stop]), a * drift
        self.terms[0] += b * drift - a * flow.gaps[stop]
        self.fast = np.array([self.rates, self.terms, self.terms * self.rates]).astype(complex)
        sizes = np.abs(self.fast)
        self.fastest, self.size = float(sizes[0].max()), float(sizes[1].sum())

    def samples(self, s: np.ndarray) -> np.ndarray:
        """Value and slope in double precision, shape (2, n)."""
        grown = np.exp(np.multiply.outer(self.fast[0], s))
        return (self.fast[1:] @ grown).real + float(self.drift) * np.array([s, np.ones_like(s)])

    def exact(self, s: Exact) -> list:
        """Value, slope and second derivative."""
        one = self.terms * exp(self.rates * s)
        value, slope, bend = (x.sum().real for x in (one, one * self.rates, one * self.rates**2))
        return [value + self.drift * s, slope + self.drift, bend]

    def rise(self, low: Exact, high: Exact, *, peak: bool = False) -> Exact:
        """Where the value, or for a `peak` minus the slope, rises through zero."""
        s = (low + high) / 2
        for _ in range(300):
            y, rate = (-x for x in self.exact(s)[1:]) if peak else self.exact(s)[:2]
            low, high = (s, high) if y < 0 else (low, s)
            new = s - y / rate if rate > 0 else low - 1
            new = new if low <= new <= high else (low + high) / 2
            if abs(new - s) * self.fastest < Exact("1e-26") * (1 + self.fastest * abs(s)):
                return new
            s = new
        raise ArithmeticError("a root was not found")


def first_rise(signals: dict, at_zero: tuple, end: Exact) -> list:
    """Sorted (place, name) of signals that first rise through zero in (0, end]; `at_zero` falls from it."""
    step, start = 2 * math.pi / 64 / next(iter(signals.values())).fastest, 0.0
    while start < end:
        s = start + step * np.arange(CHUNK + 1)
        s = np.concatenate([[0.0], step * DOUBLINGS, s[1:]]) if start == 0 else s
        found = []
        for name, signal in signals.items():
            x, slope = signal.samples(s)
            if start == 0 and name == at_zero:
                x[0] = -signal.size
            tops = (slope[:-1] > 0) & (slope[1:] <= 0) & (np.maximum(x[:-1], x[1:]) > -0.02 * signal.size)
            for i in np.flatnonzero(tops | (x[1:] > 0)):
                low, high = Exact(s[i]), Exact(s[i + 1])
                high = signal.rise(low, high, peak=True) if tops[i] else high
                if signal.exact(high)[0] > 0:
                    found.append((signal.rise(low, high), name))
                    break
        if found := sorted(one for one in found if one[0] <= end):
            return found
        start = float(s[-1])
    return []


def follow(problem: dict, *, nudge: Exact = ZERO, turn: int = 1, most: int = 10**6) -> dict:
    """Touches [stop, start, end, approach, rebound], NaN if one has not ended, and the state at the end.

    If a second stop is reached while one is touched the run ends, and `at_once` is the time.  A `nudge`
    changes the velocity at the start and at each event, as rounding does, with turn = -1 in alternation.
    """
    system, time, end = System(problem), Exact(0), Exact(problem["duration"])
    q, v = (numbers(problem[name]) for name in ("q", "v"))
    touches, held, pushed, at_zero, stop = [], None, False, (), 0
    while len(touches) < most or held is not None:
        v, nudge = v + nudge * system.rows[stop], turn * nudge
        flow = Flow(system, time, q, v, held if pushed else None)
        signals = {("touch", j): Signal(flow, j) for j in range(len(system.rows)) if j != held}
        if held is not None:
            _, k, c = system.contact(held)
            if pushed:
                signals["let go", held] = Signal(flow, held, -k, -c)
            else:
                signals |= {
                    ("push", held): Signal(flow, held, k, c),
                    ("leave", held): Signal(flow, held, -ONE),
                }
        if not (found := first_rise(signals, at_zero, end - time)):
            q, v = flow.state(end - time)
            break
        s, (what, stop) = found[0]
        q, v = flow.state(s)
        time, row = time + s, system.rows[stop]
        speed, law = row @ v, system.law[stop]
        if what == "touch" and (held is not None or [x for x in found[1:] if x[0] - s < Exact("1e-30")]):
            return {"touches": touches, "at_once": time, "pushed": pushed or held is None}
        if what == "touch" and law[0] == "newton":
            v = v - (1 + Exact(law[1])) * speed / (row @ row) * row
            touches.append([stop, time, time, speed, row @ v])
            at_zero = "touch", stop
        elif what == "touch":
            touches.append([stop, time, mpmath.nan, speed, mpmath.nan])
            held, pushed, at_zero = stop, True, () if law[2] else ("let go", stop)
        elif what == "leave" or (what == "let go" and not law[2]):
            touches[-1][2::2] = time, speed
            held, pushed, at_zero = None, False, ("touch", stop)
        else:
            pushed, at_zero = what == "push", ("push" if what == "let go" else "let go", stop)
    return {"touches": touches, "q": list(q), "v": list(v)}


def size(problem: dict, q: list, v: list) -> Exact:
    """The root of twice the energy of a state."""
    return mpmath.norm([*(numbers(problem["omega"]) * numbers(q)), *numbers(v)])


def distance(problem: dict, one: dict, other: dict) -> float:
    """The largest difference of two answers: times by w, speeds over the highest, the end over its size."""
    if [x[0] for x in one["touches"]] != [x[0] for x in other["touches"]]:
        return math.inf
    a, b = (numbers([x[1:] for x in answer["touches"]]) for answer in (one, other))
    if np.any((a != a) != (b != b)):
        return math.inf
    far = np.where(a == a, abs(a - b), ZERO) * ([Exact(problem["w"])] * 2 + [1 / a[:, 2].max()] * 2)
    end = size(problem, *(numbers(one[x]) - numbers(other[x]) for x in "qv"))
    return float(max(far.max(), end / size(problem, one["q"], one["v"])))


def complete(problem: dict) -> dict:
    """A problem with its answer, and its amplification: by how much changes of the motion grow."""
    answer = follow(problem)
    if "at_once" not in answer:
        nudge = NUDGE * max(size(problem, answer["q"], answer["v"]), *(x[3] for x in answer["touches"]))
        far = (distance(problem, answer, follow(problem, nudge=nudge, turn=turn)) for turn in (1, -1))
        answer["amplification"] = max(1.0, max(far) / float(NUDGE))
    return problem | {"answer": answer}


def random_problem(rng: np.random.Generator) -> dict:
    """One to eight modes between one to four stops, with gaps that the motion without them exceeds."""
    n = int(rng.integers(1, 9))
    omega = np.append(1.0, np.sort(rng.uniform(1.3, 40.0, n - 1)))
    phi, b, c, gamma = rng.uniform(-1.0, 1.0, (4, n)) * omega**-0.5 + np.eye(1, n)
    problem = {
        "omega": omega.tolist(),
        "decay_rate": (2.0 * 10.0 ** rng.uniform(-3.0, -1.3, n) * omega).tolist(),
        "participation": gamma.tolist(),
        "phi": phi.tolist(),
        "points": {"b": b.tolist(), "c": c.tolist()},
        "w": rng.uniform(0.4, 1.6),
        "amplitude": rng.uniform(0.2, 1.0),
        "q": [0.0] * n,
        "v": (rng.normal(size=n) * omega**-0.5).tolist(),
        "duration": 200.0,
        "stops": [],
    }
    for i in rng.choice(2 * len(PLACES), rng.integers(1, 5), replace=False):
        stop = {"gap": 0.0, "at": PLACES[i // 2], "side": int(1 - 2 * (i % 2))}
        system = System(problem | {"stops": [stop | {"law": []}]})
        free = Signal(Flow(system, Exact(0), *(numbers(problem[name]) for name in ("q", "v")), None), 0)
        stop["gap"] = rng.uniform(0.1, 0.5) * float(free.samples(np.arange(0.0, 40.0, 0.02))[0].max())
        mobility, stop["law"] = float(system.rows[0] @ system.rows[0]), ["newton", rng.uniform(0.3, 0.95)]
        if rng.random() < 0.4:
            unit, damping = rng.uniform(5.0, 60.0), rng.choice((0.0, rng.uniform(0.05, 0.6)))
            stop["law"] = ["linear", unit**2 / mobility, float(damping * unit / mobility)]
        problem["stops"].append(stop)
    return problem


def judged(rng: np.random.Generator) -> dict:
    """A random problem with its answer, without slow impacts or chaos."""
    while True:
        problem, most = random_problem(rng), int(rng.integers(6, 40))
        answer = follow(problem, most=most)
        touches, at_once = answer["touches"], answer.get("at_once")
        speeds = [x[3] for x in touches] or [ZERO]
        if min(speeds) <= 1e-3 * max(speeds):
            continue
        if at_once and answer["pushed"] and len(touches) < 6:
            return complete(problem | {"duration": float(at_once) + 1.0})
        if not at_once and len(touches) > 5 and (gap := touches[-1][1] - touches[-2][2]) > 0.01:
            problem = complete(problem | {"duration": float(touches[-1][1] - gap / 2)})
            if problem["answer"]["amplification"] < 4e4:
                return problem
