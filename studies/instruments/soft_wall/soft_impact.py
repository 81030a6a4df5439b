r"""A collision with a soft wall, and what it does to the orbits of one mode: closed forms.

The wall multiplies the spring constant by K (letter of 1996, Ref. [10]): behind the gap the force grows with
slope K Omega^2, so the contact adds kappa = (K - 1) Omega^2 [1/s^2], and a dashpot c = 2 zeta s [1/s] beside
it, s = sqrt(kappa).  The wall only pushes: it lets go where kappa d + c d' falls to zero.

**One collision.** Next to a peak of height h over the gap the incoming motion is a parabola of deceleration
a = omega^2 gap, and meets the wall at v = sqrt(2 a h).  With tau = s t and D = d kappa/a

    D'' + 2 zeta D' + D = -1,   D(0) = 0,   D'(0) = z = s v/a = sqrt(2 kappa h/a)

until D + 2 zeta D' = 0 at tau_c.  Without the wall the velocity would fall by tau_c, so the kick is

    J = (a/s) G(z),   G = z - tau_c - D'(tau_c),   dG/dz = 1 - p(tau_c),   p = exp(-zeta tau) (C - zeta S)

with C, S = cos, sin/w of w tau, w = sqrt(1 - zeta^2) (cosh, sinh/w beyond zeta = 1).  Without dashpot

    G = 2 (z - atan z),  tau_c = 2 atan z:
        J = (4/3) kappa sqrt(2/a) h^(3/2) [1 - (3/5) z^2 + ...],    J = 2 v - pi a/s + ...  for z >> 1,

two power laws that cross at z^2 = 3, h = (3/2) a/kappa.  The first one is the impulse of the undisturbed
parabola, kappa times the integral of h - a t^2/2.  With a dashpot the force sets in with c v, and

    G = zeta z^2 + (1/3) (1 - 4 zeta^2) z^3 + ...:     J = c h + ...

is linear in h: the wall lets go at the peak, where the dashpot no longer pushes.

**Restitution of a hard approach** (z >> 1): tau_c = (pi - 2 beta)/cos beta with zeta = sin beta, and

    restitution = exp(-(pi - 2 beta) tan beta);    beyond zeta = 1:  exp(-2 eta coth eta), zeta = cosh eta.

At zeta = 1 it is exp(-2) = 0.135, so that the letter's 0.1 needs an overdamped contact.  (The half period of
a wall that may also pull, exp(-pi zeta/w) = 0.1, has zeta = 0.591, which is a restitution of 0.253 here.)

**Period doubling of p1.** With M the free flow over 1/f (trace alpha, determinant gamma) the orbit with one
collision a period has, to leading order, the peak h and the trace

    excess = h/gap + M12 J(h)/((1 - alpha + gamma) gap),   trace = alpha - M12 J'(h),   J' = s (dG/dz)/z

A multiplier is -1 where J' = Lambda = (1 + alpha + gamma)/M12.  Without dashpot J' = 2 s z/(1 + z^2), hence

    z_f = (s/Lambda) [1 - sqrt(1 - (Lambda/s)^2)] -> Lambda/(2 s),     h_f = (a/2) z_f^2/kappa

and none near grazing if s < Lambda: J' never exceeds s.  As K grows, h_f -> (a/2) [Lambda/(2 K Omega^2)]^2,
excess -> (h_f/gap) [1 + r], r = (2/3)(1 + gamma + alpha)/(1 - alpha + gamma), which is too small by

    [2 + (Lambda/(2 Omega))^2 (2 + (12/5) r)/(1 + r)]/K      of itself, plus order K^(-2).

With a dashpot J' = c from the start: for c > Lambda the orbit is unstable as soon as it touches, as with a
hard wall.

**Fold of p_m.** At a hard approach the contact lasts t_c = tau_c/s and ends at the depth d_c = D v/s with the
velocity -tau v - (a_0/s) S, tau the restitution.  Referred to the touch by the free flow, to first order in
1/s, the deviation jumps by

    (tau v t_c + d_c,   -(1 + tau) v + a_0 (t_c - S/s)),   a_0 = omega^2 gap + (Omega^2 - omega^2) u + mu u'

with (u, u') before the touch, which are affine in v (terms mu v/s, small but of the same order, are in the
code).  Hence the amplitude of the drive over that at grazing,

    A^2 = (1 - u)^2 + ((v - u')/omega)^2       (lengths in units of gap)

is a quadratic in v, smallest at the fold, and differs from that of the hard wall by order 1/s, K^(-1/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq

from contact.flight.modal_flow import flow_matrix
from contact.flight.motion import damped_frequency
from contact.laws import LinearContact

__all__ = ["SoftImpact", "damping_ratio", "hard_contact", "release", "soft_contact"]

SMALL = 1e-4
"""z below which series are used: the root of the force would lose half of its digits there."""

LIMIT = 1e-7
"""Distance of zeta from 1 within which the critically damped formula is used: the error is its square."""


def _waves(zeta: float, tau: float) -> tuple[float, float]:
    """(C, S) at tau, both times exp(-zeta tau)."""
    w = math.sqrt(abs(1.0 - zeta * zeta))
    if w * tau < LIMIT:
        fade = math.exp(-zeta * tau)
        return fade, fade * tau
    if zeta < 1.0:
        fade = math.exp(-zeta * tau)
        return fade * math.cos(w * tau), fade * math.sin(w * tau) / w
    rise, fall = math.exp((w - zeta) * tau), math.exp(-(w + zeta) * tau)
    return 0.5 * (rise + fall), 0.5 * (rise - fall) / w


def release(zeta: float, drag: float = 0.0) -> tuple[float, float, float, float]:
    """(tau_c, D, D', S) where the wall lets go after a hard approach, D'(0) = 1.

    The wall pushes with D + 2 zeta D'; `drag` D' also acts on the mode but not on the wall.
    """
    if not (math.isfinite(zeta) and zeta >= 0.0):
        raise ValueError(f"zeta is {zeta}; it must be finite and zero or more")
    ratio = zeta + 0.5 * drag
    w = math.sqrt(abs(1.0 - ratio * ratio))
    turn = 2.0 * zeta * ratio - 1.0
    if w < LIMIT:
        duration = 2.0 * zeta / turn
    elif ratio < 1.0:
        duration = math.atan2(2.0 * zeta * w, turn) / w
    else:
        duration = math.atanh(2.0 * zeta * w / turn) / w
    c, s = _waves(ratio, duration)
    return duration, s, c - ratio * s, s


def hard_contact(zeta: float) -> tuple[float, float]:
    """(tau_c, restitution) of a contact that is short against the motion, at damping ratio `zeta` >= 0."""
    duration, _depth, velocity, _s = release(zeta)
    return duration, -velocity


def damping_ratio(restitution: float) -> float:
    """zeta at which a hard approach leaves with `restitution`, above 0 and at most 1."""
    if not 0.0 < restitution <= 1.0:
        raise ValueError(f"restitution is {restitution}; it must lie above 0 and not above 1")
    if restitution == 1.0:
        return 0.0
    # exp(-2 eta coth eta) < exp(-2 eta) bounds eta, and with it zeta
    high = math.cosh(max(1.0, -0.5 * math.log(restitution)) + 1.0)
    return float(brentq(lambda zeta: hard_contact(zeta)[1] - restitution, 0.0, high, xtol=1e-15, rtol=1e-14))


def soft_contact(z: float, zeta: float) -> tuple[float, float, float]:
    """(tau_c, G, dG/dz) of a collision with z = s v/a >= 0 at damping ratio `zeta` >= 0."""
    if not z >= 0.0:
        raise ValueError(f"z is {z}; it must be zero or more")
    if zeta == 0.0:
        turn = math.atan(z)
        lost = z**3 * (1 / 3 - z * z * (1 / 5 - z * z / 7)) if z < 1e-2 else z - turn
        return 2.0 * turn, 2.0 * lost, 2.0 * z * z / (1.0 + z * z)
    if z < SMALL * zeta:
        excess = 1.0 - 4.0 * zeta * zeta
        return z, z * z * (zeta + excess * z / 3.0), z * (2.0 * zeta + excess * z)

    def force(tau: float) -> float:
        c, s = _waves(zeta, tau)
        return (c + (z + zeta) * s) + 2.0 * zeta * (z * c - (1.0 + zeta * z) * s) - 1.0

    # the deceleration shortens the contact: at the end of the hard one the force is -1 - restitution
    end = float(brentq(force, 0.0, hard_contact(zeta)[0], xtol=1e-300, rtol=8.9e-16))
    c, s = _waves(zeta, end)
    return end, z - end - (z * c - (1.0 + zeta * z) * s), 1.0 - (c - zeta * s)


@dataclass(frozen=True, kw_only=True)
class SoftImpact:
    """One mode of unit mass against a soft wall.

    Parameters
    ----------
    omega, decay_rate : float
        Omega [rad/s] and mu [1/s] of the mode.
    drive_frequency : float
        f [Hz].
    gap : float
        [m].
    hardness : float
        K, above 1 [1].
    zeta : float
        Damping ratio of the contact, 0 without dashpot [1].
    """

    omega: float
    decay_rate: float
    drive_frequency: float
    gap: float
    hardness: float
    zeta: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("omega", "rad/s"), ("drive_frequency", "Hz"), ("gap", "m")):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise ValueError(f"{name} is {value} {unit}; it must be finite and above zero")
        if not 0.0 <= self.decay_rate < math.inf:
            raise ValueError(f"decay_rate is {self.decay_rate} 1/s; it must be finite and zero or more")
        if not 1.0 < self.hardness < math.inf:
            raise ValueError(f"hardness is {self.hardness}; the wall's K must be finite and above 1")
        if not 0.0 <= self.zeta < math.inf:
            raise ValueError(f"zeta is {self.zeta}; it must be finite and zero or more")

    @classmethod
    def of_mode(cls, oscillator: Any, *, hardness: float, zeta: float = 0.0) -> SoftImpact:
        """The wall of `hardness` in place of the stop of a single-mode oscillator."""
        model = oscillator.model
        if model.n_modes != 1 or model.phi[0] != 1.0:
            raise ValueError(f"oscillator has {model.n_modes} modes; a soft wall is for one, of unit mass")
        return cls(
            omega=float(model.omega[0]), decay_rate=float(model.decay_rate[0]), gap=oscillator.stop.gap,
            drive_frequency=oscillator.drive.frequency, hardness=hardness, zeta=zeta,
        )  # fmt: skip

    @property
    def angular_frequency(self) -> float:
        """omega of the drive [rad/s]."""
        return 2.0 * math.pi * self.drive_frequency

    @property
    def deceleration(self) -> float:
        """a = omega^2 gap [m/s^2]."""
        return self.angular_frequency**2 * self.gap

    @property
    def stiffness(self) -> float:
        """kappa = (K - 1) Omega^2, per unit mass [1/s^2]."""
        return (self.hardness - 1.0) * self.omega**2

    @property
    def rate(self) -> float:
        """s = sqrt(kappa) [1/s]."""
        return math.sqrt(self.stiffness)

    @property
    def dashpot(self) -> float:
        """c = 2 zeta s, per unit mass [1/s]."""
        return 2.0 * self.zeta * self.rate

    @property
    def law(self) -> LinearContact:
        """The contact law of the wall for a mode of unit mass."""
        return LinearContact(stiffness=self.stiffness, damping=self.dashpot)

    @property
    def restitution(self) -> float:
        """Of a hard approach [1]."""
        return hard_contact(self.zeta)[1]

    @cached_property
    def flow(self) -> np.ndarray:
        """M, the free flow over one drive period, shape (2, 2)."""
        return self.free_flow(1.0 / self.drive_frequency)

    def free_flow(self, time: float, *, touching: bool = False) -> np.ndarray:
        """Free flow (u, u') over `time` [s], of the mode alone or with the wall's spring and dashpot."""
        omega, decay = self.omega, self.decay_rate
        if touching:
            omega, decay = math.sqrt(omega**2 + self.stiffness), decay + self.dashpot
        high, low = damped_frequency(omega, decay)
        return np.array(flow_matrix(omega, decay, high, low, time)).reshape(2, 2)

    @property
    def alpha(self) -> float:
        """Trace of M."""
        return float(self.flow[0, 0] + self.flow[1, 1])

    @property
    def gamma(self) -> float:
        """Determinant of M."""
        return math.exp(-self.decay_rate / self.drive_frequency)

    def _z(self, peak: float) -> float:
        return math.sqrt(2.0 * self.stiffness * peak * self.gap / self.deceleration)

    def kick(self, peak: float) -> float:
        """J of a collision whose incoming peak stands `peak` gaps above the wall [m/s]."""
        return self.deceleration / self.rate * soft_contact(self._z(peak), self.zeta)[1]

    def kick_slope(self, peak: float) -> float:
        """dJ/dh [1/s]; as peak -> 0 it goes to 0 without dashpot, and to c with one."""
        z = self._z(peak)
        return self.rate * soft_contact(z, self.zeta)[2] / z if z > 0.0 else self.dashpot

    def local_power(self, peak: float) -> float:
        """d ln J/d ln h [1]."""
        return peak * self.gap * self.kick_slope(peak) / self.kick(peak)

    def soft_law(self, peak: float) -> float:
        """Leading power law of small peaks: (4/3) kappa sqrt(2/a) h^(3/2), or c h with a dashpot [m/s]."""
        h = peak * self.gap
        if self.zeta > 0.0:
            return self.dashpot * h
        return 4.0 / 3.0 * self.stiffness * math.sqrt(2.0 / self.deceleration) * h**1.5

    def hard_law(self, peak: float) -> float:
        """(1 + tau) sqrt(2 a h), the kick of the hard wall [m/s]."""
        return (1.0 + self.restitution) * math.sqrt(2.0 * self.deceleration * peak * self.gap)

    @property
    def crossover(self) -> float:
        """Peak in gaps where the two power laws cross: (3/2) a/kappa, or (a/kappa) (1 + tau)^2/(2 zeta^2)."""
        unit = self.deceleration / (self.stiffness * self.gap)
        return 1.5 * unit if self.zeta == 0.0 else unit * (1.0 + self.restitution) ** 2 / (2.0 * self.zeta**2)

    @property
    def half_peak(self) -> float:
        """Peak in gaps where the kick is half of the hard wall's."""

        def excess(log_z: float) -> float:
            z = math.exp(log_z)
            return soft_contact(z, self.zeta)[1] / z - 0.5 * (1.0 + self.restitution)

        z = math.exp(brentq(excess, math.log(1e-6), math.log(1e6), xtol=1e-13))
        return 0.5 * z * z * self.deceleration / (self.stiffness * self.gap)

    @property
    def critical_slope(self) -> float:
        """Lambda = (1 + alpha + gamma)/M12, the dJ/dh at which a multiplier of p1 is -1 [1/s]."""
        return (1.0 + self.alpha + self.gamma) / float(self.flow[0, 1])

    @property
    def least_hardness(self) -> float:
        """K below which p1 does not lose its stability near grazing at all."""
        steepest = self.omega * max(1.0, 2.0 * self.zeta)
        return 1.0 + (self.critical_slope / steepest) ** 2

    def excess_of(self, peak: float) -> float:
        """F/F_g - 1 at which p1 has this peak (in gaps) over the wall, to leading order."""
        return peak + float(self.flow[0, 1]) * self.kick(peak) / (1.0 - self.alpha + self.gamma) / self.gap

    def doubling_peak(self) -> float | None:
        """h_f/gap; 0 where p1 is unstable from grazing on, None where it stays stable.

        For 0 < zeta < 1/2 the slope dJ/dh first rises from c: the first crossing of Lambda is returned.
        """
        wanted = self.critical_slope / self.rate
        if 2.0 * self.zeta >= wanted:
            return 0.0
        if self.zeta == 0.0:
            if wanted > 1.0:
                return None
            z = wanted / (1.0 + math.sqrt(1.0 - wanted**2))
        else:
            grid = np.geomspace(1e-6, 10.0, 400)
            above = [i for i, z in enumerate(grid) if soft_contact(z, self.zeta)[2] / z > wanted]
            if not above or above[0] == 0:
                return None
            ends = grid[above[0] - 1], grid[above[0]]
            z = float(brentq(lambda z: soft_contact(z, self.zeta)[2] / z - wanted, *ends, rtol=1e-14))
        return 0.5 * z * z * self.deceleration / (self.stiffness * self.gap)

    def leading_doubling(self, *, minus_one: bool = False) -> tuple[float, float]:
        """(h_f/gap, excess) without dashpot as K -> infinity; `minus_one` puts K - 1 for K."""
        stiffness = self.stiffness if minus_one else self.hardness * self.omega**2
        peak = 0.5 * self.angular_frequency**2 * (self.critical_slope / (2.0 * stiffness)) ** 2
        ratio = (1.0 + self.gamma + self.alpha) / (1.0 - self.alpha + self.gamma)
        return peak, peak * (1.0 + 2.0 / 3.0 * ratio)

    @property
    def leading_shortfall(self) -> float:
        """K times the relative distance of the excess at the doubling from its limit, as K -> infinity."""
        r = 2.0 / 3.0 * (1.0 + self.gamma + self.alpha) / (1.0 - self.alpha + self.gamma)
        return 2.0 + (0.5 * self.critical_slope / self.omega) ** 2 * (2.0 + 2.4 * r) / (1.0 + r)

    @property
    def grazing_multipliers(self) -> tuple[complex, complex]:
        """Multipliers of p1 at its first touch, larger first: trace alpha - M12 c, determinant gamma."""
        values = np.roots([1.0, float(self.flow[0, 1]) * self.dashpot - self.alpha, self.gamma]).astype(
            complex
        )
        first, second = sorted(values.tolist(), key=abs, reverse=True)
        return first, second

    def fold_excess(self, period: int) -> float:
        """F/F_g - 1 at the fold of the orbit with one collision in `period` drive periods, to order 1/s."""
        w, one = self.angular_frequency, np.eye(2)
        return_flow = self.free_flow(period / self.drive_frequency)
        answer = return_flow @ np.linalg.inv(one - return_flow)
        drag = self.decay_rate / self.rate
        duration, depth, velocity, s = release(self.zeta, drag)
        tau, late = -velocity, (duration - s) / self.rate
        # jump = constant + along v + feedback (u, u'), lengths in gaps
        constant = np.array([0.0, w * w * late])
        moved = (tau * duration + depth) / self.rate
        slowed = self.decay_rate * (depth / self.rate - late - moved)
        along = np.array([moved, -(1.0 + tau) + slowed])
        feedback = np.array([[0.0, 0.0], [(self.omega**2 - w * w) * late, self.decay_rate * late]])
        solve = np.linalg.inv(one - answer @ feedback) @ answer
        rest, slope = solve @ constant, solve @ along
        start = np.array([1.0 - rest[0], -rest[1] / w])
        step = np.array([-slope[0], (1.0 - slope[1]) / w])
        speed = -float(start @ step) / float(step @ step)
        least = start + speed * step
        return float(np.hypot(*least)) - 1.0
