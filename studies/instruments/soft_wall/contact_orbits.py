r"""Periodic orbits of one mode that touches a soft wall, on the simulated period map, with exact multipliers.

The map P^m carries the state at a strobe over m drive periods (``contact.simulation``).  It is linear between
its events, so its derivative is a product of flows, with the times of touch and release as simulated:

    dP^m = F(t_n) C(t_c) E F(t_{n-1}) ...,     E = [[1, 0], [-c, 1]]

F the free flow, C the flow with spring and dashpot of the wall.  E is the saltation matrix at the touch,
where the dashpot's force c v sets in at once; at the release the force is zero and nothing jumps.

Fixed points by Newton's method on P^m(s) = s.  Period doubling: det(dP + I) = 0; fold: det(dP^m - I) = 0.
Peaks are measured over the wall in units of the gap, excess is F/F_g - 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, root

from contact.errors import ContactError, NotPeriodic
from contact.flight.modal_flow import steady_motion
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import ImpactKind, Regime, State
from studies.instruments.soft_wall.soft_impact import SoftImpact

__all__ = ["ContactOrbit", "SoftMap", "doubling", "fold_of"]

MOST_STEPS = 40
"""Newton steps: from a peak wrong by half it takes about eight."""

ROUNDING = 2e-15
"""Residual of a fixed point over the gap: steady motion and wall are known to some 1e-16 of it, and the map
multiplies that by its derivative."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactOrbit:
    """A fixed point of P^m.

    Parameters
    ----------
    excess : float
        F/F_g - 1 [1].
    deviation : ndarray, shape (2,)
        From the steady motion at a strobe, in gaps and gaps times the drive's angular frequency.
    derivative : ndarray, shape (2, 2)
        dP^m there.
    touches : int
        Contacts in the m periods.
    """

    excess: float
    deviation: np.ndarray
    derivative: np.ndarray
    touches: int

    @property
    def multipliers(self) -> np.ndarray:
        """Eigenvalues, complex, shape (2,)."""
        return np.asarray(np.linalg.eigvals(self.derivative).astype(complex))

    @property
    def doubling_test(self) -> float:
        """det(dP^m + I) = 1 + trace + determinant: negative when one multiplier lies below -1."""
        return float(np.linalg.det(self.derivative + np.eye(2)))

    @property
    def fold_test(self) -> float:
        """det(dP^m - I): negative when one multiplier lies above 1."""
        return float(np.linalg.det(self.derivative - np.eye(2)))


@dataclass(frozen=True, kw_only=True, eq=False)
class SoftMap:
    """P^m of one mode with the wall `wall`; `oscillator` gives the mode and the drive."""

    oscillator: ImpactOscillator
    wall: SoftImpact
    period: int = 1

    @classmethod
    def of(cls, oscillator: ImpactOscillator, wall: SoftImpact, period: int = 1) -> SoftMap:
        """The map of `oscillator` with its stop replaced by the wall."""
        stop = Stop(gap=oscillator.stop.gap, law=wall.law)
        return cls(oscillator=replace(oscillator, stop=stop), wall=wall, period=period)

    @property
    def units(self) -> np.ndarray:
        """Gap, and gap times the drive's angular frequency [m, m/s]."""
        return np.array([1.0, self.wall.angular_frequency]) * self.wall.gap

    def state(self, excess: float, deviation: np.ndarray) -> State:
        """The state at a strobe."""
        q, v = steady_motion(self.oscillator.with_excess(excess).motion(), np.zeros(1))
        shift = np.asarray(deviation) * self.units
        return State(displacement=q[0] + shift[0], velocity=v[0] + shift[1])

    def deviation(self, excess: float, state: State) -> np.ndarray:
        """The inverse of `state`."""
        q, v = steady_motion(self.oscillator.with_excess(excess).motion(), np.zeros(1))
        return np.array([state.displacement[0] - q[0, 0], state.velocity[0] - v[0, 0]]) / self.units

    def advance(self, excess: float, deviation: np.ndarray) -> ContactOrbit:
        """P^m of the deviation and its derivative there, in the units of `units`.

        Raises
        ------
        ContactError
            If the motion cannot be followed, or touches the wall at a strobe, where the product above breaks.
        """
        oscillator, wall, m = self.oscillator.with_excess(excess), self.wall, self.period
        start = self.state(excess, deviation)
        motion = simulate(oscillator, start, periods=m)
        touches = np.flatnonzero(motion.impacts.kind == ImpactKind.IMPACT)
        clock, derivative = 0.0, np.eye(2)
        for i in touches:
            touch, end = float(motion.impacts.start[i]), float(motion.impacts.end[i])
            strobes = {start.regime, motion.end.regime}
            if not math.isfinite(end) or strobes != {Regime.OUTSIDE}:
                raise NotPeriodic(time=touch, gap=0.0, velocity=0.0, detail="the wall is touched at a strobe")
            if wall.dashpot > 0.0:
                end = touch + self._release(oscillator, touch, motion.impacts.approach[i], end - touch)
            entry = np.array([[1.0, 0.0], [-wall.dashpot, 1.0]])
            derivative = wall.free_flow(touch - clock) @ derivative
            derivative = wall.free_flow(end - touch, touching=True) @ entry @ derivative
            clock = end
        derivative = wall.free_flow(m / wall.drive_frequency - clock) @ derivative
        scale = self.units
        return ContactOrbit(
            excess=excess,
            deviation=self.deviation(excess, motion.end),
            derivative=derivative * scale[None, :] / scale[:, None],
            touches=len(touches),
        )

    def _release(self, oscillator: ImpactOscillator, touch: float, speed: float, longest: float) -> float:
        """Time from the touch until the force is zero; with a dashpot the tip is then still inside [s]."""
        wall, w = self.wall, self.wall.angular_frequency
        omega_sq, decay = wall.omega**2 + wall.stiffness, wall.decay_rate + wall.dashpot
        drive = w * w * oscillator.model.participation[0] * self._amplitude(oscillator)
        response = drive / (omega_sq - w * w + 1j * decay * w)
        static = wall.stiffness * wall.gap / omega_sq

        def forced(t: float) -> np.ndarray:
            turn = response * complex(math.cos(w * (touch + t)), math.sin(w * (touch + t)))
            return np.array([static + turn.imag, w * turn.real])

        begin = np.array([wall.gap, speed]) - forced(0.0)

        def force(t: float) -> float:
            x, v = wall.free_flow(t, touching=True) @ begin + forced(t)
            return float(wall.stiffness * (x - wall.gap) + wall.dashpot * v)

        return float(brentq(force, 0.0, longest, xtol=1e-300, rtol=8.9e-16))

    @staticmethod
    def _amplitude(oscillator: ImpactOscillator) -> float:
        assert oscillator.drive is not None
        return oscillator.drive.amplitude

    def fixed_point(self, excess: float, guess: np.ndarray) -> ContactOrbit:
        """Newton's method from `guess`; NotPeriodic if it does not converge."""
        deviation = np.array(guess, dtype=float)
        best = math.inf
        for _ in range(MOST_STEPS):
            after = self.advance(excess, deviation)
            residual = after.deviation - deviation
            size = float(np.max(np.abs(residual)))
            if size < ROUNDING * (1.0 + float(np.max(np.abs(after.derivative)))):
                return replace(after, deviation=deviation)
            best = min(best, size)
            deviation = deviation + np.linalg.solve(np.eye(2) - after.derivative, residual)
        raise NotPeriodic(
            time=0.0,
            gap=0.0,
            velocity=0.0,
            detail=f"Newton's method left {best:.1e} gaps at excess {excess:.3e}",
        )

    def guess_at(self, excess: float) -> np.ndarray:
        """Deviation at the strobe of p1 with one collision, from the closed form of the kick."""
        wall = self.wall
        peak = float(
            brentq(lambda h: wall.excess_of(h) - excess, 1e-9 * excess, excess, rtol=1e-12, xtol=1e-300)
        )
        # just after the collision at the time of the peak, then on to the strobe
        flow = wall.flow
        after = np.linalg.solve(np.eye(2) - flow, np.array([0.0, -wall.kick(peak)]))
        response = self.oscillator.tip_response()
        phase = (math.pi / 2.0 - math.atan2(response.imag, response.real)) % (2.0 * math.pi)
        rest = (2.0 * math.pi - phase) / wall.angular_frequency
        return np.asarray(wall.free_flow(rest) @ after) / self.units


def doubling(soft: SoftMap, low: float, high: float, steps: int = 60) -> ContactOrbit | None:
    """The p1 orbit whose multiplier is -1, at the lowest excess in [low, high]; None if there is none.

    The branch is followed on a geometric grid of `steps` amplitudes, each from the closed form of the kick;
    where that fails, from the orbit before.
    """
    last: ContactOrbit | None = None
    for excess in np.geomspace(low, high, steps):
        try:
            here = soft.fixed_point(float(excess), soft.guess_at(float(excess)))
        except (ContactError, ValueError, np.linalg.LinAlgError):
            if last is None:
                continue
            here = soft.fixed_point(float(excess), last.deviation)
        if here.touches != soft.period:
            return None
        if here.doubling_test < 0.0:
            if last is None:
                return here
            return _refined(soft, last, here)
        last = here
    return None


def _refined(soft: SoftMap, below: ContactOrbit, above: ContactOrbit) -> ContactOrbit:
    """Root of the doubling test between two orbits of the branch."""
    found: dict[float, ContactOrbit] = {below.excess: below, above.excess: above}

    def test(excess: float) -> float:
        if excess not in found:
            share = (excess - below.excess) / (above.excess - below.excess)
            guess = below.deviation + share * (above.deviation - below.deviation)
            found[excess] = soft.fixed_point(excess, guess)
        return found[excess].doubling_test

    excess = float(brentq(test, below.excess, above.excess, rtol=1e-9, xtol=1e-300))
    test(excess)
    return found[excess]


def fold_of(soft: SoftMap, excess: float, guess: np.ndarray) -> ContactOrbit:
    """The orbit at the fold next to a guess, P^m(s) = s and det(dP^m - I) = 0; else NotPeriodic."""
    size = float(np.max(np.abs(guess)))

    def residual(unknown: np.ndarray) -> np.ndarray:
        deviation = unknown[:2] * size
        after = soft.advance(float(unknown[2]) * size, deviation)
        return np.append((after.deviation - deviation) / size, after.fold_test)

    with np.errstate(all="ignore"):
        try:
            solution = root(_safe(residual), np.append(guess, excess) / size, method="hybr", tol=1e-13)
        except ContactError as error:
            raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail=str(error)) from error
    mismatch = residual(solution.x)
    if not np.max(np.abs(mismatch)) < 1e-8:
        raise NotPeriodic(time=0.0, gap=0.0, velocity=0.0, detail="no fold was found near the guess")
    here = float(solution.x[2]) * size
    return replace(soft.advance(here, solution.x[:2] * size), deviation=solution.x[:2] * size)


def _safe(residual: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    """The residual, large where the motion cannot be followed, so that the search steps back."""

    def guarded(unknown: np.ndarray) -> np.ndarray:
        try:
            return residual(unknown)
        except (ContactError, ValueError):
            return np.full(3, 1e3)

    return guarded
