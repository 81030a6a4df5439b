"""Laws of the contact between tip and stop: plain numbers, no materials.

With the penetration d = x - gap [m] and its rate d' [m/s], the stop pushes the tip back with a force
-N, N >= 0, that acts only where d > 0.

* Impact law (no duration): ``NewtonRestitution``, velocity of the tip d' -> -e d' (letter 1996, below Eq. (1)).
* Force laws: ``LinearContact``, N = max(0, k d + c d').  With a dashpot (c > 0) the force vanishes before the
  tip has left the wall: the contact lets go inside, and may close again there.

Each law names the kernel that handles it by a small integer and three numbers (`code`, `numbers`), so that
compiled code sees no objects.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["ContactLaw", "LinearContact", "NewtonRestitution"]

NEWTON, LINEAR = 0, 1


class ContactLaw:
    """What all laws offer to the compiled motion."""

    code: int = -1

    @property
    def numbers(self) -> tuple[float, float, float]:
        """The law's parameters for the kernels."""
        raise NotImplementedError


def _require(condition: bool, sentence: str) -> None:
    if not condition:
        raise ValueError(sentence)


@dataclass(frozen=True, kw_only=True)
class NewtonRestitution(ContactLaw):
    """Instantaneous impact: the tip leaves with -`local_restitution` times its approach velocity.

    Parameters
    ----------
    local_restitution : float
        e, from 0 (plastic) to 1 (elastic) [1].  The letter's tau is this number for one mode only.
    """

    local_restitution: float
    code = NEWTON

    def __post_init__(self) -> None:
        e = self.local_restitution
        _require(math.isfinite(e) and 0 <= e <= 1, f"local_restitution is {e}; it must lie between 0 and 1")

    @property
    def numbers(self) -> tuple[float, float, float]:
        return (self.local_restitution, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class LinearContact(ContactLaw):
    """Spring and dashpot at the stop: N = max(0, `stiffness` d + `damping` d') for d > 0.

    Parameters
    ----------
    stiffness : float
        k, above zero [N/m].
    damping : float
        c, zero or more [N s/m].
    """

    stiffness: float
    damping: float = 0.0
    code = LINEAR

    def __post_init__(self) -> None:
        k, c = self.stiffness, self.damping
        _require(math.isfinite(k) and k > 0, f"stiffness of the contact is {k} N/m; it must be finite and above zero")
        _require(math.isfinite(c) and c >= 0, f"damping of the contact is {c} N s/m; it must be finite and zero or more")

    @property
    def numbers(self) -> tuple[float, float, float]:
        return (self.stiffness, self.damping, 0.0)
