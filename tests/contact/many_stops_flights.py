"""Flights under any set of contacts in 60 digits, written apart from the package.

    q_k'' + c_k q_k' + omega_k^2 q_k = Gamma_k Z w^2 sin(w t) + g_k - sum_j w_jk N_j,    d_j = w_j . q - gap_j

A problem is a dict of numbers, doubles or decimal strings, both taken exactly.  Between two events a set of
linear contacts N = k d + c d' pushes and a set of stops under Newton's law holds d = 0.  With the basis B of
what these stops leave free, q = q_0 + B y is a sum of exponentials whose rates and shapes solve
(s^2 + C s + K) y = 0.  Signals are sampled at 64 points per period of the fastest one.  Each maximum near
zero between samples is found in all digits and decides, and so is the root before it.
"""

import math
from types import SimpleNamespace

import mpmath
import numpy as np

mpmath.mp.dps = 60
Exact = mpmath.mpf
ZERO, ONE = Exact(0), Exact(1)
exp, real, exact = (np.frompyfunc(f, 1, 1) for f in (mpmath.exp, lambda x: x.real, Exact))
CHUNK, DOUBLINGS = 256, 2.0 ** -np.arange(20, 0, -1)
TIE, TINY = Exact("1e-30"), Exact("1e-45")
"""Two events at one instant, and a relative size that counts as zero."""


def numbers(values: list) -> np.ndarray:
    with np.errstate(invalid="ignore"):  # NaN
        return exact(np.array(values, dtype=object))


def solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    if not right.size:
        return right
    return np.array(list(mpmath.lu_solve(mpmath.matrix(matrix.tolist()), mpmath.matrix(right.tolist()))))


class System:
    """The numbers of a problem, and what its motion is made of under each set of contacts."""

    def __init__(self, problem: dict) -> None:
        names = ("omega", "decay_rate", "participation")
        self.omega, self.decay, gamma = (numbers(problem[name]) for name in names)
        self.load = numbers(problem.get("load") or [0.0] * gamma.size)
        self.w, self.law, self.known = Exact(problem["w"]), [stop["law"] for stop in problem["stops"]], {}
        self.force = gamma * Exact(problem["amplitude"]) * self.w**2
        rows = {name: numbers(row) for name, row in (problem["points"] | {"tip": problem["phi"]}).items()}
        places = [(stop["side"], stop["at"]) for stop in problem["stops"]]
        rows = [s * (rows[at] if isinstance(at, str) else rows[at[0]] - rows[at[1]]) for s, at in places]
        self.rows = np.array(rows).reshape(-1, gamma.size)
        self.gaps = numbers([stop["gap"] for stop in problem["stops"]])
        self.newton = [law[0] == "newton" for law in self.law]
        first = [[law[1], 0] if law[0] == "newton" else law[1:] for law in self.law]
        self.first, self.damping = numbers(first).reshape(-1, 2).T  # e, or k and c

    def matrices(self, pushed: list) -> tuple:
        """Stiffness, damping and constant force with these linear contacts."""
        rows, k, c = self.rows[pushed], self.first[pushed], self.damping[pushed]
        stiff, damp = (np.diag(a) + (rows.T * b) @ rows for a, b in ((self.omega**2, k), (self.decay, c)))
        return stiff, damp, self.load + (k * self.gaps[pushed]) @ rows

    def modes(self, stiff: np.ndarray, damp: np.ndarray) -> tuple[list, np.ndarray]:
        """Rates and shapes by Newton's method, one of each complex pair."""
        n, rates, shapes = len(stiff), [], []
        whole = np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -damp]]).astype(float)
        for s, x in zip(*(a.T for a in np.linalg.eig(whole)), strict=True):
            if s.imag < 0:
                continue
            s, x, fixed = mpmath.mpc(s), np.array([mpmath.mpc(a) for a in x[:n] / np.abs(x[:n]).max()]), x[:n]
            fixed = np.conj(fixed) / np.linalg.norm(fixed)
            for _ in range(20):
                bend = 2 * s * x + damp @ x
                own = s**2 * exact(np.eye(n)) + s * damp + stiff
                border = np.block([[own, bend[:, None]], [fixed[None], np.zeros((1, 1))]])
                *dx, ds = solve(border, np.append(-(own @ x), ZERO))
                s, x = s + ds, x + np.array(dx)
                if abs(ds) < abs(s) * Exact("1e-32") and max(np.abs(dx)) < Exact("1e-32"):
                    break
            else:
                raise ArithmeticError("a rate was not found")
            rates.append(s)
            shapes.append(x)
        return rates, np.array(shapes)

    def pieces(self, pushed: list, resting: list) -> SimpleNamespace:
        """Rates, shapes and their duals, the static and the steady motion, and what holds the stops."""
        key = tuple(pushed), tuple(resting)
        if key not in self.known:
            stiff, damp, force = self.matrices(pushed)
            rows, eye = self.rows[resting], exact(np.eye(self.omega.size))
            hold, base, start, rigid = rows, eye, 0 * self.load, 0 * self.load
            if resting:
                square = rows @ rows.T
                start = solve(square, self.gaps[resting]) @ rows
                hold = np.array([solve(square, column) for column in rows.T]).T
                turned = mpmath.qr(mpmath.matrix(rows.T.tolist()))[0].tolist()
                base = np.array(turned, dtype=object)[:, len(resting) :]
            inner = [base.T @ a @ base for a in (stiff, damp)]
            if pushed or resting:
                rates, shapes = self.modes(*inner) if base.size else ([], np.zeros((0, 0), dtype=object))
                static = start + base @ solve(inner[0], base.T @ (force - stiff @ start))
            else:
                rates = -self.decay / 2 + 1j * (self.omega**2 - self.decay**2 / 4) ** Exact(0.5)
                shapes, rigid = eye, numbers([w == 0 for w in self.omega])
                static = numbers([g / w**2 if w else ZERO for g, w in zip(force, self.omega, strict=True)])
            left, right = [], []
            for s, r in zip(rates, shapes, strict=True):
                both = r @ inner[1] + s * r, r
                weight = 0 if s == 0 else (2 if s.imag else 1) / (both[0] @ r + s * (r @ r))
                left.append(r if s == 0 else weight * both[0])
                right.append(weight * r)
            own = -(self.w**2) * exact(np.eye(base.shape[1])) + 1j * self.w * inner[1] + inner[0]
            self.known[key] = SimpleNamespace(
                rates=np.array([ZERO, 1j * self.w, *rates]),
                shapes=np.reshape(shapes, (len(rates), base.shape[1])) @ base.T,
                left=np.reshape(left, (len(rates), base.shape[1])) @ base.T,
                right=np.reshape(right, (len(rates), base.shape[1])) @ base.T,
                static=static,
                response=base @ solve(own, base.T @ self.force),
                rigid=rigid,
                hold=[hold @ a for a in (stiff, damp, force, self.force)],
            )
            one = self.known[key]
            if np.any(abs(real(one.left.T @ one.shapes) - base @ base.T) > 1e-30):
                raise ArithmeticError("the modes are not complete")
        return self.known[key]


class Flow:
    """q(s) = Re sum_j vectors_j exp(rates_j s) + drift s + pull s^2/2, from a state (q, v) at a time on."""

    def __init__(self, system: System, time: Exact, q: np.ndarray, v: np.ndarray, *held: list) -> None:
        self.system, self.pieces, self.resting = system, system.pieces(*held), held[1]
        one, self.turn = self.pieces, -1j * mpmath.expj(system.w * time)
        steady = self.turn * one.response
        u, du = q - one.static - real(steady), v - real(1j * system.w * steady)
        parts = one.left @ u + one.right @ du
        self.rates, self.drift, self.pull = one.rates, one.rigid * du, one.rigid * system.load
        self.vectors = np.array([one.static, steady, *(parts[:, None] * one.shapes)])

    def state(self, s: Exact) -> tuple[np.ndarray, np.ndarray]:
        grown = exp(self.rates * s)
        q, v = (real(x @ self.vectors) for x in (grown, grown * self.rates))
        return q + self.drift * s + self.pull * s**2 / 2, v + self.drift + self.pull * s

    def distance(self, stop: int, a: Exact = ONE, b: Exact = ZERO) -> "Signal":
        """a d + b d'."""
        row = self.system.rows[stop]
        terms = (a + b * self.rates) * (self.vectors @ row)
        terms[0] -= a * self.system.gaps[stop]
        return Signal(self.rates, terms, a * (row @ self.drift), a * (row @ self.pull))

    def force(self, stop: int) -> "Signal":
        """-N of a stop that holds."""
        stiff, damp, force, drive = (a[self.resting.index(stop)] for a in self.pieces.hold)
        terms = self.vectors @ stiff + self.rates * (self.vectors @ damp)
        terms[:2] -= force, self.turn * drive
        return Signal(self.rates, terms, ZERO, ZERO)


class Signal:
    """Re sum terms exp(rates s) + drift s + pull s^2/2."""

    def __init__(self, rates: np.ndarray, terms: np.ndarray, drift: Exact, pull: Exact) -> None:
        self.rates, self.terms, self.drift, self.pull = rates, terms, drift, pull
        self.fast = np.array([terms, terms * rates]).astype(complex)
        self.fastest, self.size = float(max(abs(rates))), float(np.abs(self.fast[0]).sum())

    def samples(self, s: np.ndarray, grown: np.ndarray) -> np.ndarray:
        """Value and slope in double precision, shape (2, n)."""
        drift, pull = float(self.drift), float(self.pull)
        return (self.fast @ grown).real + np.array([(drift + pull * s / 2) * s, drift + pull * s])

    def exact(self, s: Exact) -> list:
        """Value, slope and second derivative."""
        one = self.terms * exp(self.rates * s)
        value, slope, bend = (x.sum().real for x in (one, one * self.rates, one * self.rates**2))
        return [
            value + (self.drift + self.pull * s / 2) * s,
            slope + self.drift + self.pull * s,
            bend + self.pull,
        ]

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

    def hop(self) -> Exact | None:
        """Where a value that falls from zero is back, if this is soon."""
        _, slope, bend = self.exact(ZERO)
        if slope < 0 < bend and (s := -2 * slope / bend) * self.fastest < 1e-3:
            if self.exact(s / 2)[0] < 0 < self.exact(2 * s)[0]:
                return self.rise(s / 2, 2 * s)
        return None


def first_rise(signals: dict, at_zero: set, end: Exact) -> list:
    """Sorted (place, name) of signals that first rise through zero in (0, end].

    Signals (what, stop) of a stop in `at_zero` are below zero at first, or fall from it.
    """
    if not signals:
        return []
    falling = [name for name in signals if name[0] == "touch" and name[1] in at_zero]
    found = [(s, name) for name in falling if (s := signals[name].hop()) and s <= end]
    end = min([end, *(s for s, _ in found)])
    one = next(iter(signals.values()))
    step, start, rates = 2 * math.pi / 64 / one.fastest, 0.0, one.rates.astype(complex)
    stop = float(end) * (1 + 1e-12)
    while start < stop:
        s = start + step * np.arange(CHUNK + 1)
        s = np.concatenate([[0.0], step * DOUBLINGS, s[1:]]) if start == 0 else s
        s = np.append(s[s < stop], stop) if s[-1] > stop else s
        grown = np.exp(np.multiply.outer(rates, s))
        for name, signal in signals.items():
            if any(name == other for _, other in found):
                continue
            x, slope = signal.samples(s, grown)
            if start == 0 and name[1] in at_zero:
                x[0] = -signal.size
            tops = (slope[:-1] > 0) & (slope[1:] <= 0) & (np.maximum(x[:-1], x[1:]) > -0.02 * signal.size)
            for i in np.flatnonzero(tops | (x[1:] > 0)):
                low, high = Exact(s[i]), Exact(s[i + 1])
                high = signal.rise(low, high, peak=True) if tops[i] else high
                if signal.exact(high)[0] > TINY * signal.size:
                    found.append((signal.rise(low, high), name))
                    break
        if found:
            break
        start = float(s[-1])
    return sorted(one for one in found if one[0] <= end + TIE)
