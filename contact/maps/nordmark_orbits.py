"""Maximal orbits of Nordmark's map: one impact every m drive periods, in closed form.

Without impacts the height obeys x_{n+1} = alpha x_n - gamma x_{n-1} + rho. Its response to a unit impulse,
and that to an impulse repeated every m steps, are

    p_{-1} = 0,  p_0 = 1,  p_k = alpha p_{k-1} - gamma p_{k-2},
    G_k = (p_k + gamma^(k+1) p_{m-k-2}) / D,  k = 0 ... m-1 (mod m),  D = 1 - (p_m - gamma p_{m-2}) + gamma^m.

An impact at x_0 = X^2 > 0 adds u_1 = d - X - alpha X^2 to x_1 and u_2 = (gamma - gamma_impact) X^2 to x_2:

    x_k = c rho + G_{k-1} u_1 + G_{k-2} u_2,    c = 1/(1 - alpha + gamma),                              (a)
    k = 0:   a X^2 + b X = c rho + b d,   b = G_{m-1},   a = 1 + alpha b - (gamma - gamma_impact) G_{m-2}.

For b < 0 < a a node (larger X) and a saddle meet in a **fold**, X = -b/(2a), rho_m = -b^2/(4 a c) - b d/c.
Multipliers: determinant gamma^(m-1) gamma_impact, trace -p_{m-1}/(2X) - (gamma_impact + gamma) p_{m-2}.
An orbit is *admissible* if x_1 ... x_{m-1} <= 0; a **second impact** ends it.

Sources: letter of 1996, Fig. 3 and text; W. Chin, E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994)
4427.  Derivation: ``docs/theory/map.md``.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from beam.parameters import record, require_kind, require_whole, require_within
from contact.flight.polynomial_root import positive_roots
from contact.maps.nordmark import NordmarkMap

MOST_PERIODS = 100_000  # longest period of an orbit, in drive periods; its states are computed one by one


@record
class MaximalOrbit:
    """A periodic solution of Nordmark's map with one impact, at its first state.

    `MapFamily` returns such orbits.  All quantities are pure numbers.

    Parameters
    ----------
    map : NordmarkMap
        The map.
    rho : float
        Control parameter of the orbit [1].
    m : int
        Period of the orbit in drive periods.
    speed : float
        Root X = sqrt(x_0) at the impact, in proportion to the approach speed [1].
    states : ndarray, shape (m, 2)
        The states (x, y) in order of time.
    trace, determinant : float
        Trace and determinant of the derivative of m steps [1].
    """

    map: NordmarkMap
    rho: float
    m: int
    speed: float
    states: NDArray[np.float64]
    trace: float
    determinant: float

    @property
    def excess(self) -> float:
        """F/F_g - 1 [1]."""
        return self.map.excess(self.rho)

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Eigenvalues of the derivative of m steps, shape (2,), larger modulus first."""
        pair = np.roots([1.0, -self.trace, self.determinant]).astype(complex)
        return pair[np.argsort(-np.abs(pair))]

    @property
    def stable(self) -> bool:
        """Whether both multipliers lie inside the unit circle."""
        return abs(self.trace) < 1.0 + self.determinant and self.determinant < 1.0

    @property
    def admissible(self) -> bool:
        """Whether no other iterate is an impact, so that the map has this orbit."""
        return bool(np.all(self.states[1:, 0] <= 0.0))


class MapFamily:
    """The orbits p_m of Nordmark's map, in closed form.

    Each orbit has one impact in m drive periods.

    Parameters
    ----------
    nordmark : NordmarkMap
        The map; its `control` does not matter.
    m : int
        Period of the orbits in drive periods, from 1 to 100 000.

    Raises
    ------
    TypeError
        If `nordmark` is no NordmarkMap, or `m` is no number.
    ValueError
        If `m` is no whole number within its range.

    See Also
    --------
    NordmarkMap : The map and its coefficients.
    maximal_m : The period of the orbit that appears at grazing.
    contact.orbits.MaximalFamily : The same orbits of an oscillator under Newton's law.

    Examples
    --------
    Two orbits of period 5 exist between the fold and grazing; the faster one is stable.

    >>> from contact import MapFamily, NordmarkMap
    >>> nordmark = NordmarkMap.from_frequencies(
    ...     drive_frequency=22.2, free_period=40.80e-3, decay_rate=3.56, restitution=0.1
    ... )
    >>> family = MapFamily(nordmark, 5)
    >>> print(f"{family.fold().excess:.5f}")
    -0.00082
    >>> [orbit.stable for orbit in family.orbits(-5e-4)]
    [False, True]
    """

    def __init__(self, nordmark: NordmarkMap, m: int) -> None:
        require_kind("nordmark", nordmark, NordmarkMap, "a NordmarkMap")
        self.map, self.m = nordmark, require_whole("m", m, "drive periods", high=MOST_PERIODS)
        m, alpha, gamma = self.m, nordmark.alpha, nordmark.gamma
        p = [0.0, 1.0]  # p_{-1}, p_0, ...
        for _ in range(m):
            p.append(alpha * p[-1] - gamma * p[-2])
        self.last, before = p[m], p[m - 1]  # p_{m-1}, p_{m-2}
        size = 1.0 - (p[m + 1] - gamma * before) + gamma**m
        self.periodic = np.array([p[k + 1] + gamma ** (k + 1) * p[m - k - 1] for k in range(m)]) / size
        self.loss = gamma - nordmark.gamma_impact
        self.c = 1.0 / (1.0 - alpha + gamma)
        self.b = float(self.periodic[m - 1])
        self.a = 1.0 + alpha * self.b - self.loss * float(self.periodic[(m - 2) % m])
        self.trace_limit = -(nordmark.gamma_impact + gamma) * before
        self.determinant = gamma ** (m - 1) * nordmark.gamma_impact

    def _height(self, k: int) -> tuple[float, float, float]:
        """Coefficients of X^2, X and 1 in x_k, by Eq. (a)."""
        m, first = self.m, float(self.periodic[(k - 1) % self.m]) - self.b
        second = float(self.periodic[(k - 2) % m] - self.periodic[(m - 2) % m])
        return 1.0 - self.map.alpha * first + self.loss * second, -first, self.map.delay_term * first

    def orbit(self, speed: float) -> MaximalOrbit:
        """The orbit with root X = `speed`, above zero [1]."""
        root = require_within("speed", speed, "[1]", above=0)
        return self._orbit(root, (self.a * root * root + self.b * (root - self.map.delay_term)) / self.c)

    def _orbit(self, root: float, rho: float) -> MaximalOrbit:
        m, square = self.m, root * root
        later = [self._height(k) for k in range(1, m)]
        x = np.array([square] + [a * square + b * root + c for a, b, c in later])
        y = -self.map.gamma * np.roll(x, 1)
        y[1 % m] = -self.map.gamma_impact * square
        return MaximalOrbit(
            map=self.map,
            rho=rho,
            m=m,
            speed=root,
            states=np.column_stack([x, y]),
            trace=-self.last / (2.0 * root) + self.trace_limit,
            determinant=self.determinant,
        )

    def at_rho(self, rho: float) -> tuple[MaximalOrbit, ...]:
        """The orbits at `rho`, 0 to 2, X rising: of two, the first is the saddle and the second the node."""
        require_within("rho", rho, "[1]")
        roots = positive_roots(self.a, self.b, -(self.c * rho + self.b * self.map.delay_term))
        return tuple(self._orbit(root, rho) for root in roots)

    def orbits(self, excess: float) -> tuple[MaximalOrbit, ...]:
        """The orbits at F/F_g - 1 = `excess` [1], 0 to 2, in the order of `at_rho`."""
        return self.at_rho(self.map.rho(excess))

    def fold(self) -> MaximalOrbit | None:
        """The orbit at which node and saddle meet, with rho = rho_m; None for b >= 0 or a <= 0."""
        return self.orbit(-self.b / (2.0 * self.a)) if self.b < 0.0 < self.a else None

    def stable_range(self) -> tuple[float, float] | None:
        """The first interval of rho, from the fold upwards, in which the node is stable and admissible.

        It begins at rho_m or at a second impact, and ends at a second impact or never: the multiplier -1
        comes to inadmissible nodes only.  Returns None where there is no fold or no such interval.
        """
        at_fold = self.fold()
        if at_fold is None:
            return None
        ends = [root for k in range(1, self.m) for root in positive_roots(*self._height(k))]
        marks = [at_fold.speed, *sorted(root for root in ends if root > at_fold.speed), math.inf]
        for low, high in pairwise(marks):
            orbit = self.orbit(0.5 * (low + high) if high < math.inf else 2.0 * low)
            if orbit.stable and orbit.admissible:
                return self.orbit(low).rho, self.orbit(high).rho if high < math.inf else math.inf
        return None


def maximal_m(nordmark: NordmarkMap) -> int:
    """Return the m with pi/m < theta <= pi/(m-1), theta the angle of the map.

    Parameters
    ----------
    nordmark : NordmarkMap
        The map; its `control` does not matter.

    Returns
    -------
    int
        Period in drive periods; 0 if the mode does not oscillate.

    Raises
    ------
    TypeError
        If `nordmark` is no NordmarkMap.
    """
    angle = require_kind("nordmark", nordmark, NordmarkMap, "a NordmarkMap").angle
    return math.floor(math.pi / angle) + 1 if angle > 0.0 else 0


def coexisting_m(nordmark: NordmarkMap) -> tuple[int, ...]:
    """Return all m for which the orbit p_m of the map is admissible as rho approaches zero from below.

    Parameters
    ----------
    nordmark : NordmarkMap
        The map; its `control` does not matter.

    Returns
    -------
    tuple of int
        The result of `maximal_m`, and m + 1 where the bands overlap; empty if the mode does not oscillate.

    Raises
    ------
    TypeError
        If `nordmark` is no NordmarkMap.
    """
    m = maximal_m(nordmark)
    if m == 0:
        return ()
    parts, gamma = MapFamily(nordmark, m), nordmark.gamma
    overlap = parts.last + nordmark.gamma_impact * gamma ** (m - 1) >= 0.0  # x_m <= 0 on p_{m+1}
    return (m, m + 1) if overlap else (m,)
