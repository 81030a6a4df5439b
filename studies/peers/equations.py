"""The modal equations as a general solver sees them: y = (q, v), one smooth right-hand side in flight and one
in contact.

    q_k' = v_k,   v_k' = P_k sin(w t + phase) - c_k v_k - omega_k^2 q_k - phi_k N
    N = 0 in flight, k d in a linear contact, k d^(3/2) in Hertz's;   d = sum phi_k q_k - gap

In contact N is not cut off for d < 0 (Hertz's is continued by zero), so that the right-hand side is smooth
past the release, within the step that finds it. What is watched rises through zero: d less a bound of its
rounding in flight, -d in contact. The right-hand side is compiled; in numpy it would make SciPy and CVODE a
third slower.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from contact import ContactError, HertzContact, ImpactOscillator, LinearContact, NewtonRestitution
from contact.integrators import Run

__all__ = ["EPS", "Array", "Equations"]

EPS = 2.220446049250313e-16

FLIGHT, LINEAR, HERTZ = 0, 1, 2
"""What a piece is, for the kernel."""

Array = NDArray[np.float64]
compiled: Any = numba.njit(cache=True, nogil=True)


@compiled
def rates(t: float, y: Array, out: Array, modes: Array, scalars: Array, kind: int) -> None:
    """Fill `out` with dy/dt; `modes` (4, n): omega^2, c, phi, P; `scalars`: w, phase, gap, k."""
    n = modes.shape[1]
    depth, force, swing = -scalars[2], 0.0, math.sin(scalars[0] * t + scalars[1])
    for k in range(n):
        depth += modes[2, k] * y[k]
    if kind == LINEAR:
        force = scalars[3] * depth
    elif kind == HERTZ and depth > 0.0:
        force = scalars[3] * depth * math.sqrt(depth)
    for k in range(n):
        out[k] = y[n + k]
        out[n + k] = modes[3, k] * swing - modes[1, k] * y[n + k] - modes[0, k] * y[k] - modes[2, k] * force


@compiled
def penetration(y: Array, modes: Array, scalars: Array) -> float:
    """d [m]."""
    depth = -scalars[2]
    for k in range(modes.shape[1]):
        depth += modes[2, k] * y[k]
    return depth


class Equations:
    """The equations of a run; times count from its start."""

    def __init__(self, oscillator: ImpactOscillator, run: Run, tolerance: float) -> None:
        model, law, drive = oscillator.model, oscillator.stop.law, oscillator.drive
        self.hard, self.hertz = law.code == NewtonRestitution.code, law.code == HertzContact.code
        dissipates = not self.hard and any(law.numbers[1:])
        if dissipates or oscillator.load is not None or not (
            self.hard or self.hertz or law.code == LinearContact.code
        ):  # fmt: skip
            raise TypeError(f"law of the stop is {law}; outside solvers follow elastic contacts without load")
        self.n, self.phi, self.start, self.tolerance = oscillator.n_modes, model.phi, run.start, tolerance
        self.compliance, self.number = float(model.phi @ model.phi), law.numbers[0]
        amplitude, w = (0.0, 0.0) if drive is None else (drive.amplitude, drive.angular_frequency)
        push = model.participation * amplitude * w**2
        self.modes = np.ascontiguousarray([model.omega**2, model.decay_rate, model.phi, push])
        self.scalars = np.array([w, w * run.clock, oscillator.stop.gap, self.number])
        lowest = w if w > 0.0 else 2.0 * math.pi / oscillator.period
        pace = np.maximum(model.omega, lowest)
        vectors = (run.start.velocity, model.omega * run.start.displacement,
                   amplitude * lowest * np.abs(oscillator.steady_response()))  # fmt: skip
        reach = lowest * oscillator.stop.gap / math.sqrt(self.compliance)
        speed = max(reach, *(float(np.linalg.norm(vector)) for vector in vectors)) or 1.0
        self.absolute = tolerance * np.concatenate([speed / pace, np.full(self.n, speed)])
        self.rounding = 32.0 * EPS * (oscillator.stop.gap + float(np.abs(model.phi) @ (speed / pace)))

    def tip(self, y: Array) -> tuple[float, float]:
        """Penetration [m] and its rate [m/s]."""
        return float(penetration(y, self.modes, self.scalars)), float(self.phi @ y[self.n :])

    def rates(self, contact: bool, t: float, y: Array, out: Array) -> Array:
        """Fill `out`, shape (2 n_modes,), with dy/dt and return it."""
        rates(t, y, out, self.modes, self.scalars, (HERTZ if self.hertz else LINEAR) if contact else FLIGHT)
        return out

    def jacobian(self, contact: bool, y: Array) -> Array:
        """The derivatives of the rates, shape (2 n_modes, 2 n_modes)."""
        n, slope = self.n, 0.0
        if contact:
            depth = self.tip(y)[0]
            slope = 1.5 * self.number * math.sqrt(max(depth, 0.0)) if self.hertz else self.number
        found = np.zeros((2 * n, 2 * n))
        found[:n, n:] = np.eye(n)
        found[n:, :n] = -np.diag(self.modes[0]) - slope * np.outer(self.phi, self.phi)
        found[n:, n:] = -np.diag(self.modes[1])
        return found

    def surface(self, contact: bool, begin: float, t: float, y: Array) -> float:
        """What rises through zero at the event of a piece that began at `begin`, on the surface."""
        depth = float(penetration(y, self.modes, self.scalars))
        value = -depth if contact else depth - self.rounding
        return -abs(value) - 1e-300 if t <= begin else value

    def failed(
        self, s: float, y: Array, detail: str, kind: type[ContactError] = ContactError
    ) -> ContactError:
        """The error at the place where a solver has stopped."""
        depth, rate = self.tip(np.nan_to_num(y))
        return kind(time=self.start.time + s, gap=-depth, velocity=rate, detail=detail)

    def touch(self, y: Array) -> tuple[bool, Array, Array]:
        """Whether a contact begins, the states just before and just after the touch; the root finding leaves
        a trace of penetration, which would be found again."""
        n, before = self.n, y.copy()
        before[:n] -= self.phi * self.tip(y)[0] / self.compliance
        after = before.copy()
        if not self.hard:
            return True, before, after
        after[n:] -= self.phi * (1.0 + self.number) * self.tip(y)[1] / self.compliance
        return False, before, after
