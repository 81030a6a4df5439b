"""The law of a force that grows with a power of the depth, with a dashpot that fits it.

In w = d^((p+1)/2) and dtau = d^((p-1)/2) dt a free mass m is a linear oscillator at every speed:

    w'' + (c/m) w' + (p+1)/2 (k/m) w = 0,      N = -2 m/(p+1) d^((p-1)/2) w''.

The compiled part is ``contact.touch.power``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import ClassVar

import numpy as np

from beam.parameters import InvalidValue, final, record, require_within
from contact.flight.elementary import EPS
from contact.laws import POWER, ContactLaw
from contact.restitution import damping_ratio
from contact.touch.series import WINDOW

MOST = WINDOW  # largest m: the modes move at each order m of sigma, the last `WINDOW` orders limit a step


@final
@record(eq=True)
class PowerContact(ContactLaw):
    """Power of the depth with a dashpot: N = max(0, k d^p + c d^((p-1)/2) d') for d > 0.

    For p = 3/2 it is the law of Y. Tsuji, T. Tanaka and T. Ishida (Powder Technol. 71 (1992) 239), cut at
    zero force.  The restitution of a free mass is the same at every speed, for any exponent.

    Parameters
    ----------
    stiffness : float
        Stiffness k of the contact, above zero [N/m^p].
    exponent : float
        Exponent p, from 1 to 3 [1]: a fraction with a denominator of at most 8.  With damping (p - 1)/2 must
        be such a fraction.  All halves, thirds and quarters are valid in both cases.
    damping : float
        Constant c of the dashpot, zero or more [N s/m^((p+1)/2)].

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, or the exponent is no such fraction.
    TypeError
        If one of them is no number.
    """

    stiffness: float
    exponent: float
    damping: float = 0.0
    code: ClassVar[int] = POWER
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m^p", "damping": "N s/m^((p+1)/2)"}

    def __post_init__(self) -> None:
        super().__post_init__()
        given = require_within("exponent of the contact", self.exponent, "[1]", low=1.0, high=3.0)
        nearest = self._fraction
        if abs(given - float(nearest)) > 4.0 * EPS * given:
            one = "with damping (p - 1)/2" if self.damping > 0.0 else "without damping it"
            words = f"{one} must be a fraction with a denominator of at most {MOST}"
            near = f"the nearest valid exponent is {nearest} = {float(nearest)!r}"
            raise InvalidValue("exponent of the contact", f"is {given!r} [1]; {words}, and {near}")

    @property
    def _fraction(self) -> Fraction:
        """The valid exponent next to the given one."""
        part = 2 if self.damping > 0.0 else 1
        return 1 + part * (Fraction(float(self.exponent) - 1.0) / part).limit_denominator(MOST)

    @property
    def adjustable(self) -> tuple[float, ...]:
        """Stiffness and damping; only the stiffness without damping, as m may differ with it."""
        return self.numbers if self.damping > 0.0 else self.numbers[:1]

    @property
    def table(self) -> np.ndarray:
        """m, m x and m y, shape (1, 3); see ``contact.touch.power``."""
        p = self._fraction
        x, y = ((p - 1) / 2, (p + 1) / 2) if self.damping > 0.0 else (p, Fraction(0))
        return np.array([[float(x.denominator * each) for each in (1, x, y)]])

    @staticmethod
    def with_restitution(
        *, stiffness: float, exponent: float, restitution: float, mass: float
    ) -> PowerContact:
        """Return the law under which a free `mass` [kg] leaves with `restitution` times its approach speed.

        `restitution` lies above 0 and is at most 1, and holds at every speed.  The dashpot of a mass m is
        c = 2 zeta sqrt((p + 1)/2 k m), with zeta of ``contact.damping_ratio``.  The docstring of
        ``LinearContact.with_restitution`` says which mass a tip has.
        """
        elastic = PowerContact(stiffness=stiffness, exponent=exponent)
        mass = require_within("mass", mass, "kg", above=0)
        rate = math.sqrt(0.5 * (elastic.exponent + 1.0) * elastic.stiffness * mass)
        return replace(elastic, damping=2.0 * damping_ratio(restitution) * rate)
