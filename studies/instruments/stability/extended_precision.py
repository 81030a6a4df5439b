r"""Free motion and one contact in decimal arithmetic of 60 digits: the reference where rounding is at stake.

Free motion of a mode, u'' + c u' + omega^2 u = 0, with h = c/2 and D = omega^2 - h^2 (exact products of
doubles): cos and sin of sqrt(D) t for D > 0, the two exponentials exp(-omega^2 t/(h + k)), exp(-(h + k) t)
with k = sqrt(-D) for D < 0, and (1, t) for D = 0. Near D = 0 the quotients lose digits, of which 60 leave
enough: doubles come no closer to critical damping than D/omega^2 = 1e-32 unless they meet it.

Contact with the force k d, d = sum phi u - gap: the coefficients of the power series of all modes,

    (n + 1)(n + 2) u[n+2] = -(n + 1) c u[n+1] - omega^2 u[n] - phi k d[n],

over steps of one radian of the fastest rate, to order 50: the first term left out is 1/51! = 1e-66. Touch and
release are Newton's roots of d, from the doubles that a run has found; what is checked by this is the value
of a root, not that it is the first. Nothing here is shared with the package's kernels.

Units: SI; sine and cosine by their series after reduction to less than pi/4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext

import numpy as np

__all__ = ["DIGITS", "collision", "flow", "flow_of_doubles", "sine_cosine"]

DIGITS = 60
ORDER = 50
NEWTON_STEPS = 6
"""From 1e-16 on every step doubles the digits, so that four suffice."""


def pi() -> Decimal:
    """pi to the digits of the context, by the series of arcsin(1/2)."""
    with localcontext() as context:
        context.prec += 4
        term = total = Decimal(3)
        last, n, m, d, e = Decimal(0), 1, 0, 0, 24
        while total != last:
            last = total
            n, m, d, e = n + m, m + 8, d + e, e + 32
            term = term * n / d
            total += term
    return +total


def sine_cosine(x: Decimal) -> tuple[Decimal, Decimal]:
    """sin(x) and cos(x) to the digits of the context."""
    with localcontext() as context:
        context.prec += 6 + max(0, x.adjusted())
        quarter = pi() / 2
        turns = int((x / quarter).to_integral_value())
        x -= turns * quarter
        s = term = x
        c = even = Decimal(1)
        n = 1
        while s + term != s or c + even != c:
            even = -even * x * x / ((2 * n - 1) * (2 * n))
            term = -term * x * x / ((2 * n) * (2 * n + 1))
            c, s, n = c + even, s + term, n + 1
            if n > 10 * DIGITS:
                break
        s, c = ((s, c), (c, -s), (-s, -c), (-c, s))[turns % 4]
    return +s, +c


def flow(omega: float, decay: float, time: Decimal) -> tuple[Decimal, Decimal, Decimal, Decimal]:
    """The 2 x 2 flow (u, v) -> (u, v) of a free mode over `time` [s], to the digits of the context."""
    w, half = Decimal(omega), Decimal(decay) / 2
    square = w * w - half * half
    if square > 0:
        rate = square.sqrt()
        s, c = sine_cosine(rate * time)
        fade = (-half * time).exp()
        cn, sn = fade * c, fade * s / rate
    elif square < 0:
        rate = (-square).sqrt()
        slow, fast = (-w * w / (half + rate) * time).exp(), (-(half + rate) * time).exp()
        cn, sn = (slow + fast) / 2, (slow - fast) / (2 * rate)
    else:
        cn = (-half * time).exp()
        sn = cn * time
    return cn + half * sn, sn, -w * w * sn, cn - half * sn


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Numbers of the modes as decimals."""

    omega: Sequence[float]
    decay: Sequence[float]
    phi: list[Decimal]

    def propagate(
        self, u: list[Decimal], v: list[Decimal], time: Decimal
    ) -> tuple[list[Decimal], list[Decimal]]:
        """Free motion over `time` [s]."""
        flows = [flow(w, c, time) for w, c in zip(self.omega, self.decay, strict=True)]
        return (
            [f[0] * x + f[1] * y for f, x, y in zip(flows, u, v, strict=True)],
            [f[2] * x + f[3] * y for f, x, y in zip(flows, u, v, strict=True)],
        )

    def tip(self, values: list[Decimal]) -> Decimal:
        """Sum of phi times `values`."""
        return sum((p * x for p, x in zip(self.phi, values, strict=True)), Decimal(0))

    def series(
        self, u: list[Decimal], v: list[Decimal], gap: Decimal, stiffness: Decimal
    ) -> list[list[Decimal]]:
        """Coefficients of the displacements in contact, shape (ORDER + 1, n_modes)."""
        rows = [u, v]
        square = [Decimal(w) ** 2 for w in self.omega]
        decay = [Decimal(c) for c in self.decay]
        for n in range(ORDER - 1):
            push = stiffness * (self.tip(rows[n]) - (gap if n == 0 else 0))
            rows.append([
                (-(n + 1) * c * b - q * a - p * push) / ((n + 1) * (n + 2))
                for a, b, c, q, p in zip(rows[n], rows[n + 1], decay, square, self.phi, strict=True)
            ])  # fmt: skip
        return rows


def _horner(rows: list[list[Decimal]], time: Decimal) -> tuple[list[Decimal], list[Decimal]]:
    """Values and rates of a series at `time`."""
    values, rates = list(rows[-1]), [Decimal(0)] * len(rows[-1])
    for row in reversed(rows[:-1]):
        rates = [r * time + x for r, x in zip(rates, values, strict=True)]
        values = [x * time + a for x, a in zip(values, row, strict=True)]
    return values, rates


def collision(
    *,
    omega: np.ndarray,
    decay: np.ndarray,
    phi: np.ndarray,
    gap: float,
    stiffness: float,
    displacement: np.ndarray,
    velocity: np.ndarray,
    touch: float,
    release: float,
    end: float,
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Displacements and velocities at `end` after a flight, one contact and a flight; touch and release.

    `touch` and `release` [s] are where the roots are looked for. All times count from the start.
    """
    with localcontext() as context:
        context.prec = DIGITS
        modes = Modes(
            omega=[float(w) for w in omega], decay=[float(c) for c in decay],
            phi=[Decimal(float(p)) for p in phi],
        )  # fmt: skip
        u, v = [Decimal(float(x)) for x in displacement], [Decimal(float(x)) for x in velocity]
        wall, k = Decimal(gap), Decimal(stiffness)
        begins = Decimal(touch)
        for _ in range(NEWTON_STEPS):
            at, rate = modes.propagate(u, v, begins)
            begins -= (modes.tip(at) - wall) / modes.tip(rate)
        u, v = modes.propagate(u, v, begins)
        closed = float(np.sqrt(stiffness * np.sum(np.asarray(phi) ** 2)))
        fastest = max(float(np.max(omega)), float(np.max(decay)), closed)
        last = Decimal(release)
        steps = max(1, int(np.ceil(float(last - begins) * fastest)))
        length = (last - begins) / steps
        for _ in range(steps - 1):
            u, v = _horner(modes.series(u, v, wall, k), length)
        rows, since = modes.series(u, v, wall, k), length
        for _ in range(NEWTON_STEPS):
            at, rate = _horner(rows, since)
            since -= (modes.tip(at) - wall) / modes.tip(rate)
        u, v = _horner(rows, since)
        ends = begins + (steps - 1) * length + since
        u, v = modes.propagate(u, v, Decimal(end) - ends)
        return (
            np.array([float(x) for x in u]), np.array([float(x) for x in v]), float(begins), float(ends),
        )  # fmt: skip


def flow_of_doubles(omega: float, decay: float, time: float) -> tuple[float, float, float, float]:
    """The flow of a free mode over `time` [s] with every digit that a double holds."""
    with localcontext() as context:
        context.prec = DIGITS
        a, b, c, d = flow(omega, decay, Decimal(time))
        return float(a), float(b), float(c), float(d)
