r"""Flights of a modal spring in extended precision.

A mode q'' + c q' + omega^2 q = g + P sin(w t), P = Gamma Z w^2, moves as

    q = g/omega^2 + Im(H e^{i w t}) + u,   H = P/(omega^2 - w^2 + i c w),
    u(t) = e^{-ct/2} [ u_0 C(t) + (v_0 + c u_0/2) S(t) ],
    (C, S) = (cos, sin/d) of d t, d^2 = omega^2 - c^2/4;  (1, t) for d = 0;  (cosh, sinh/|d|) for d^2 < 0

(g only for omega > 0).  Everything is formed in multiple precision from the same doubles that the package's
own methods are given, so that a difference between the two is an error of the method.  By the second route
the flow of (omega u, u') over t is the exponential of [[0, omega], [-omega, -c]] t, by scaling and squaring.

A touch is bracketed by sampling the tip in double precision, `SAMPLES` points in a swing of the fastest mode,
and found by Newton's method in full precision.  The search is not certified; instead it refuses a flight with
a peak so near to the stop that sampling could be wrong about it.  Units: SI, q in m kg^0.5.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp

from contact.laws import DELAYED, HERTZ, LINEAR
from contact.oscillator import ImpactOscillator
from contact.trajectory import State

__all__ = ["ExtendedSpring", "Modal", "NoReference", "newton_root"]

Modal = tuple[list[Any], list[Any]]
"""Displacements and velocities of all modes, or their deviations from the steady motion."""

SAMPLES = 48
"""In a swing of the fastest mode: a parabola through three of them errs by 1e-4 of its part in a peak."""

TOO_NEAR = 1e-6
"""Peaks within this part of the tip's travel of the stop are left to certified methods."""

WIDER = 1e-6
"""Part by which brackets found in double precision are widened: a root may lie at their edge."""

MOST_ITERATIONS = 60
"""Of Newton's method: from a bracket of 1/48 swing it takes six to reach 50 digits."""


class NoReference(ValueError):
    """A motion that the extended reference cannot follow, or is not sure of."""


def newton_root(function: Any, low: Any, high: Any, guess: Any, unit: Any = 0) -> Any:
    """The root of `function`, t -> (value, rate), in [low, high]: Newton's method held in the bracket.

    Its steps square from one to the next, so that one below 10^(-0.6 digits) of the root, of the bracket or
    of `unit` is the last that counts.
    """
    t, goal = mp.mpf(guess), mp.mpf(10) ** (-0.6 * mp.dps)
    for _ in range(MOST_ITERATIONS):
        value, rate = function(t)
        step = value / rate
        following = t - step
        if not low <= following <= high:
            following = (low + high) / 2
            sign, _rate = function(following)
            edge, _rate = function(low)
            low, high = (following, high) if sign * edge > 0 else (low, following)
        elif abs(step) <= goal * max(abs(t), high - low, unit):
            return following
        t = following
    raise NoReference(f"no root to {mp.dps} digits between {float(low)} and {float(high)} s")


class ExtendedSpring:
    """The numbers of an impact oscillator in the precision that is set, and its flights.

    Parameters
    ----------
    oscillator : ImpactOscillator
        With Newton's law, a linear contact without dashpot or Hertz's law.
    second : bool
        Whether flows are exponentials of matrices instead of closed forms.

    Raises
    ------
    ValueError
        For another contact law.
    """

    def __init__(self, oscillator: ImpactOscillator, *, second: bool = False) -> None:
        law, model, drive = oscillator.stop.law, oscillator.model, oscillator.drive
        if law.code == DELAYED or (law.code in (LINEAR, HERTZ) and law.numbers[1] != 0.0):
            raise ValueError(
                f"law of the stop is {law}; the extended reference knows NewtonRestitution, LinearContact "
                "without damping and HertzContact"
            )
        number = mp.mpf
        self.second, self.law, self.number = second, law.code, number(law.numbers[0])
        self.gap = number(oscillator.stop.gap)
        self.omega = [number(float(x)) for x in model.omega]
        self.decay = [number(float(x)) for x in model.decay_rate]
        self.phi = [number(float(x)) for x in model.phi]
        self.size = len(self.omega)
        self.drive = number(0) if drive is None else 2 * mp.pi * number(drive.frequency)
        self.push = [
            number(0) if drive is None else number(float(x)) * number(drive.amplitude) * self.drive**2
            for x in model.participation
        ]
        load = np.zeros(self.size) if oscillator.load is None else oscillator.load
        if np.any(load[np.asarray(model.omega) == 0.0] != 0.0):
            raise ValueError(
                "load acts on a mode of zero frequency; the extended reference knows no such flight"
            )
        self.load = [number(float(x)) for x in load]
        self.offset = [g / w**2 if w > 0 else number(0) for g, w in zip(self.load, self.omega, strict=True)]
        self.response = [
            p / mp.mpc(w**2 - self.drive**2, c * self.drive) if p != 0 else mp.mpc(0)
            for p, w, c in zip(self.push, self.omega, self.decay, strict=True)
        ]
        self.tip_response = mp.fdot(self.phi, self.response)
        self.level = mp.fdot(self.phi, self.offset) - self.gap
        self.mass = 1 / mp.fdot(self.phi, self.phi)
        self.swing = 2 * mp.pi / max([w for w in (*self.omega, self.drive) if w > 0], default=2 * mp.pi)

    def steady(self, t: Any) -> Modal:
        """Steady displacement and velocity of all modes at drive time `t`."""
        turn = mp.expjpi(self.drive * t / mp.pi)
        parts = [h * turn for h in self.response]
        return (
            [q + z.imag for q, z in zip(self.offset, parts, strict=True)],
            [self.drive * z.real for z in parts],
        )

    def deviation(self, state: Modal, t: Any) -> Modal:
        """What `state` has beyond the steady motion at time `t`."""
        q, v = self.steady(t)
        return (
            [a - b for a, b in zip(state[0], q, strict=True)],
            [a - b for a, b in zip(state[1], v, strict=True)],
        )

    def state(self, deviation: Modal, t: Any) -> Modal:
        """The inverse of `deviation`."""
        q, v = self.steady(t)
        return (
            [a + b for a, b in zip(deviation[0], q, strict=True)],
            [a + b for a, b in zip(deviation[1], v, strict=True)],
        )

    def flow(self, k: int, t: Any) -> tuple[Any, Any, Any, Any]:
        """The 2 x 2 flow of mode `k` over a time `t`."""
        omega, half = self.omega[k], self.decay[k] / 2
        if self.second and omega > 0:
            step = mp.expm(mp.matrix([[0, omega * t], [-omega * t, -2 * half * t]]))
            return step[0, 0], step[0, 1] / omega, step[1, 0] * omega, step[1, 1]
        square, fade = omega**2 - half**2, mp.exp(-half * t)
        d = mp.sqrt(abs(square))
        if square > 0:
            c, s = mp.cos(d * t), mp.sin(d * t) / d
        elif square < 0:
            c, s = mp.cosh(d * t), mp.sinh(d * t) / d
        else:
            c, s = mp.mpf(1), mp.mpf(t)
        return fade * (c + half * s), fade * s, -fade * omega**2 * s, fade * (c - half * s)

    def fly(self, deviation: Modal, t: Any) -> Modal:
        """The deviations after a free flight of length `t`."""
        u, v = [], []
        for k in range(self.size):
            a, b, c, d = self.flow(k, t)
            u.append(a * deviation[0][k] + b * deviation[1][k])
            v.append(c * deviation[0][k] + d * deviation[1][k])
        return u, v

    def tip(self, deviation: Modal, t: Any) -> tuple[Any, Any]:
        """Penetration [m] and its rate [m/s] of `deviation` at drive time `t`."""
        turn = self.tip_response * mp.expjpi(self.drive * t / mp.pi)
        return (
            self.level + turn.imag + mp.fdot(self.phi, deviation[0]),
            self.drive * turn.real + mp.fdot(self.phi, deviation[1]),
        )

    def touch(self, deviation: Modal, start: Any, length: Any) -> Any:
        """Time from `start` to the first touch within `length`, None if there is none.

        The tip starts before the stop, or on it and leaves.
        """
        count = max(8, int(mp.ceil(SAMPLES * length / self.swing)))
        grid = np.linspace(0.0, float(length), count + 1)
        depth = self._sampled(deviation, float(start), grid)
        travel = float(np.ptp(depth))
        inner = np.flatnonzero((depth[1:-1] >= depth[:-2]) & (depth[1:-1] >= depth[2:])) + 1
        rises = np.flatnonzero((depth[1:-1] <= 0.0) & (depth[2:] > 0.0)) + 1
        if depth[0] < -TOO_NEAR * travel and depth[1] > 0.0:
            rises = np.append(0, rises)
        first = int(rises[0]) if rises.size else count
        for i in inner[inner < first]:
            rise, bend = 0.5 * (depth[i + 1] - depth[i - 1]), depth[i + 1] - 2 * depth[i] + depth[i - 1]
            peak = depth[i] - (0.5 * rise**2 / bend if bend < 0 else 0.0)
            if peak > -TOO_NEAR * travel:
                raise NoReference(
                    f"the tip passes {-peak:.3g} m before the stop at {float(start) + grid[i]:.6g} s: "
                    "too near a graze for a reference"
                )
        if not rises.size:
            return None

        def tip_after(t: Any) -> tuple[Any, Any]:
            return self.tip(self.fly(deviation, t), start + t)

        low, high = grid[first], grid[first + 1]
        guess = low - depth[first] * (high - low) / (depth[first + 1] - depth[first])
        wider = WIDER * (high - low)
        return newton_root(tip_after, mp.mpf(max(low - wider, 0.0)), mp.mpf(high + wider), mp.mpf(guess))

    def _sampled(self, deviation: Modal, start: float, grid: np.ndarray) -> np.ndarray:
        """Penetration at times `grid` after `start`, in double precision."""
        turn = complex(self.tip_response) * np.exp(1j * float(self.drive) * (start + grid))
        depth = float(self.level) + turn.imag
        for k in range(self.size):
            omega, half = float(self.omega[k]), 0.5 * float(self.decay[k])
            root = np.sqrt(complex(omega**2 - half**2))
            c = np.cos(root * grid)
            s = np.sin(root * grid) / root if root != 0 else grid + 0j
            u, v = float(deviation[0][k]), float(deviation[1][k])
            free = np.exp(-half * grid) * (c * u + s * (v + half * u)).real
            depth = depth + float(self.phi[k]) * free
        return depth


def extended_state(state: State) -> Modal:
    """The doubles of a state, taken as exact."""
    return [mp.mpf(float(x)) for x in state.displacement], [mp.mpf(float(x)) for x in state.velocity]
