"""A touch near grazing, and the orbit of period 1 that survives it: closed forms.

The wall multiplies the spring constant by K (letter of 1996, Ref. [10]): behind the gap the contact adds
kappa = (K - 1) Omega^2 = s^2 [1/s^2], without loss.  A peak of height h over the gap, with deceleration
a = omega^2 gap, meets the wall at v = sqrt(2 a h).  With z = s v/a the kick is

    J = (2 a/s)(z - atan z) = (4/3) kappa sqrt(2/a) h^(3/2) [1 - (3/5) z^2 + ...]  and  2 v - pi a/s + ...

for small and large z.  A Hertz contact of stiffness k [N/m^1.5] has the impulse k (3 pi/8) sqrt(2/a) h^2.

**p1 with one touch** that changes the velocity of the tip, per unit of phi^2, by J(h): to leading order

    excess gap = h + S_- J(h),   a multiplier -1 at  S_+ dJ/dh = 1,
    S_-, S_+ = sum_k phi_k^2 M12_k/(1 -+ alpha_k + gamma_k)   [s/kg]

with M_k the free flow of mode k over 1/f, alpha its trace, gamma its determinant.  For one mode, with
Lambda = 1/S_+,

    z_f = (s/Lambda) [1 - sqrt(1 - (Lambda/s)^2)],   h_f = (a/2) z_f^2/kappa

and no doubling near grazing if s < Lambda.  Derivation: ``docs/theory/collision.md``.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from beam import InvalidType, InvalidValue
from contact import HertzContact, ImpactOscillator, LinearContact, Stop
from contact.orbits import KickFamily


def survival_sums(oscillator: ImpactOscillator) -> tuple[float, float]:
    """(S_-, S_+) of the module [s/kg]."""
    flow, model = KickFamily(oscillator=oscillator, m=1).flow, oscillator.model
    trace, determinant = flow[:, 0, 0] + flow[:, 1, 1], np.linalg.det(flow)
    parts = model.phi**2 * flow[:, 0, 1]
    less, more = (float(np.sum(parts / (1.0 + sign * trace + determinant))) for sign in (-1.0, 1.0))
    return less, more


def impulse_per_square(oscillator: ImpactOscillator) -> float:
    """k (3 pi/8) sqrt(2/a) of a Hertz contact: impulse over h^2 [N s/m^2]."""
    law, gap = oscillator.stop.law, oscillator.stop.gap
    if not isinstance(law, HertzContact):
        raise InvalidType(f"law of the stop is {type(law).__name__}; these formulas are for HertzContact")
    return law.stiffness * (3.0 * math.pi / 8.0) * math.sqrt(2.0 / gap) * oscillator.period / (2.0 * math.pi)


def hertz_kick(oscillator: ImpactOscillator, peak: float) -> float:
    """Kick of mode 1 by a Hertz contact whose incoming peak stands `peak` gaps over it, small peaks [m/s]."""
    weight = float(oscillator.model.phi[0]) ** 2
    return weight * impulse_per_square(oscillator) * (peak * oscillator.stop.gap) ** 2


def hertz_doubling(oscillator: ImpactOscillator) -> tuple[float, float] | None:
    """Peak in gaps and F/F_g - 1 at the doubling of p1 under Hertz contact; None if there is none."""
    (less, more), per_square = survival_sums(oscillator), impulse_per_square(oscillator)
    if more <= 0.0:
        return None
    height = 0.5 / (more * per_square)
    return height / oscillator.stop.gap, (height + per_square * height**2 * less) / oscillator.stop.gap


@dataclass(frozen=True, kw_only=True, eq=False)
class SoftWall:
    """The elastic wall of `hardness` K in place of the stop of Eq. (1), `oscillator`.

    Peaks are counted in gaps over the wall.
    """

    oscillator: ImpactOscillator
    hardness: float

    def __post_init__(self) -> None:
        if not 1.0 < self.hardness < math.inf:
            raise InvalidValue(f"hardness is {self.hardness}; the wall's K must be finite and above 1")

    def __str__(self) -> str:
        return f"{self.frequency:g} Hz, K = {self.hardness:g}"

    @property
    def frequency(self) -> float:
        """Of the drive [Hz]."""
        return self.oscillator.driven.frequency

    @property
    def deceleration(self) -> float:
        """a = omega^2 gap [m/s^2]."""
        return self.oscillator.driven.angular_frequency * self.oscillator.unit_speed

    @property
    def rate(self) -> float:
        """s = sqrt((K - 1) Omega^2) [1/s]."""
        return math.sqrt(self.hardness - 1.0) * float(self.oscillator.model.omega[0])

    @cached_property
    def struck(self) -> ImpactOscillator:
        """Eq. (1) with this wall as its stop."""
        law = LinearContact(stiffness=self.rate**2)
        return replace(self.oscillator, stop=Stop(gap=self.oscillator.stop.gap, law=law))

    @cached_property
    def sums(self) -> tuple[float, float]:
        """(S_-, S_+) [s]."""
        return survival_sums(self.oscillator)

    def peak_of(self, z: float) -> float:
        """Peak at which z has this value."""
        return 0.5 * z * z * self.deceleration / (self.rate**2 * self.oscillator.stop.gap)

    def kick(self, peak: float) -> float:
        """J of a collision with this incoming peak [m/s]."""
        z = math.sqrt(peak / self.peak_of(1.0))
        lost = z**3 * (1 / 3 - z * z * (1 / 5 - z * z / 7)) if z < 1e-2 else z - math.atan(z)
        return 2.0 * self.deceleration / self.rate * lost

    def soft_law(self, peak: float) -> float:
        """Leading power law of small peaks, (4/3) kappa sqrt(2/a) h^(3/2) [m/s]."""
        h = peak * self.oscillator.stop.gap
        return 4.0 / 3.0 * self.rate**2 * math.sqrt(2.0 / self.deceleration) * h**1.5

    def hard_law(self, peak: float) -> float:
        """2 sqrt(2 a h), the kick of the hard wall [m/s]."""
        h = peak * self.oscillator.stop.gap
        return 2.0 * math.sqrt(2.0 * self.deceleration * h)

    def doubling(self) -> tuple[float, float] | None:
        """Peak and F/F_g - 1 at the doubling of p1; None where s < Lambda."""
        wanted = 1.0 / (self.sums[1] * self.rate)
        if wanted > 1.0:
            return None
        peak = self.peak_of(wanted / (1.0 + math.sqrt(1.0 - wanted**2)))
        return peak, peak + self.sums[0] * self.kick(peak) / self.oscillator.stop.gap
