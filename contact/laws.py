"""Laws of the contact between tip and stop: plain numbers, no materials.

With the penetration d = x - gap [m] and its rate d' [m/s], the stop pushes the tip back with a force
-N, N >= 0, that acts only where d > 0.

* Impact law: ``NewtonRestitution``, velocity of the tip d' -> -e d' at once (letter 1996, below Eq. (1)).
* Force law: ``LinearContact``, N = max(0, k d + c d').  With a dashpot (c > 0) the force vanishes before the
  tip has left the wall: the contact lets go inside, and may close again there.

Other laws have files of their own: ``HertzContact`` and ``HuntCrossley`` in ``contact.hertz``,
``PowerContact`` in ``contact.touch.power_law`` and ``DelayedRestitution`` in ``contact.touch.delayed``.

Compiled code sees no objects: a law gives it a small integer, two numbers and a table (`code`, `numbers`,
`table`).  ``contact.touch`` has the compiled part of each law, and says how to add one.
"""

from __future__ import annotations

import math
from dataclasses import field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from beam.parameters import final, record, require_within
from contact.restitution import damping_ratio
from contact.speed_table import SPEEDS, Points, SpeedFunction, raised, require_points, require_speeds, sampled

NEWTON, LINEAR, POWER = 0, 1, 2
"""Codes of the laws of instantaneous impact, of linear contact and of powers of d (``contact.touch.power``).
A new law stands with its code and its compiled part in one file of ``contact.touch``, as
``DelayedRestitution`` does."""


class ContactLaw:
    """Common part of all contact laws: the numbers that compiled code reads.

    Users take one of its children, such as `NewtonRestitution`; ``contact.touch`` says how to add another.

    Attributes
    ----------
    code : int
        Number by which ``contact.touch.LAWS`` finds the compiled part of the law.
    units : dict of str to str
        Names and units of the plain numbers of the law, two at most.  In a force law the first, its
        stiffness, is above zero and the other zero or more.
    one_mode_only : bool
        Whether the law holds for one mode only.

    Raises
    ------
    ValueError
        If a number of the law is out of its range or not finite.
    TypeError
        If a number of the law is of another kind.
    """

    code: ClassVar[int] = -1
    units: ClassVar[dict[str, str]] = {}
    one_mode_only: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for name, unit in self.units.items():
            above, low = (0.0, None) if name == "stiffness" else (None, 0.0)
            require_within(f"{name} of the contact", getattr(self, name), unit, above=above, low=low)

    @property
    def numbers(self) -> tuple[float, float]:
        """The law's plain numbers for the kernels, filled up with zero."""
        first, second = (*(getattr(self, name) for name in self.units), 0.0, 0.0)[:2]
        return first, second

    @property
    def adjustable(self) -> tuple[float, ...]:
        """The numbers that ``contact.sensitivity.change.Change`` can move, two at most."""
        return self.numbers[: len(self.units)]

    @property
    def table(self) -> np.ndarray:
        """More numbers for the kernels, in two dimensions; none for most laws."""
        return np.empty((0, 0))

    def moved(self: Any, first: float, second: float) -> Any:
        """The law with its adjustable numbers moved by so much, in their order."""
        steps = zip(self.units, (first, second), strict=False)
        return replace(self, **{name: getattr(self, name) + step for name, step in steps})


@final
@record(eq=True)
class NewtonRestitution(ContactLaw):
    """Instantaneous impact: the tip leaves with -`local_restitution` times its approach velocity.

    Parameters
    ----------
    local_restitution : float, callable or array_like of shape (2, n)
        Restitution e, from 0 (plastic) to 1 (elastic) [1].  It can be a function of the approach speed [m/s].
        It can also be a table: two or more rising speeds [m/s], zero or more, and the restitution at each.
    speeds : (float, float)
        Range of approach speeds in which a function is sampled [m/s].

    Raises
    ------
    ValueError
        If a restitution at one of these speeds lies outside 0 to 1, or if speeds do not rise.
    TypeError
        If a restitution is neither a number, nor a function that returns one, nor a table of numbers.

    See Also
    --------
    LinearContact : A contact with a force, in which the tip stays for a time.
    DelayedRestitution : A restitution after a delay, for one mode.
    restitution_from_bounces : The restitution of a ball, from a measurement.

    Notes
    -----
    With one mode this restitution is the letter's tau.  With more modes tau is an outcome of the motion:
    `collisions` measures it.

    An impact acts on all modes at once.  A tip without a mass of its own gets lighter with each further
    mode, so that results need not converge.  Give the tip its mass, or take a law with a force.

    Functions and tables keep their end values beyond their range.  At vanishing speed (hops, grazing,
    Nordmark's map) the value at the lowest speed holds.  A table is interpolated by monotone cubics (F. N.
    Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300) and kept as a pair of tuples.

    Examples
    --------
    A spring falls against a stop, with a restitution that is lower in faster impacts:

    >>> from beam import single_mode
    >>> from contact import ImpactOscillator, NewtonRestitution, State, Stop, simulate
    >>> law = NewtonRestitution(local_restitution=([0.0, 0.1, 1.0], [0.9, 0.7, 0.5]))
    >>> model = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> spring = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law))
    >>> start = State(displacement=[-1e-3], velocity=[0.0])
    >>> impacts = simulate(spring, start, duration=0.06).impacts
    >>> print(impacts.approach.round(3), (-impacts.rebound / impacts.approach).round(3))
    [0.151 0.098 0.067] [0.675 0.701 0.744]
    """

    local_restitution: float | SpeedFunction | Points
    speeds: tuple[float, float] = field(default=(1e-5, 10.0), repr=False)
    code: ClassVar[int] = NEWTON
    units: ClassVar[dict[str, str]] = {"local_restitution": "[1]"}

    def __post_init__(self) -> None:
        given, name = self.local_restitution, "local_restitution"
        require_speeds(self.speeds)
        if isinstance(given, list | tuple | np.ndarray):
            given = require_points(name, given, "[1]")
            object.__setattr__(self, name, given)
        elif not callable(given):
            require_within(name, given, "[1]", low=0, high=1)
        for v, e in zip(*given, strict=True) if isinstance(given, tuple) else self.table[:2].T:
            if not 0.0 <= e <= 1.0:
                require_within(f"{name} at an approach speed of {v:g} m/s", e, "[1]", low=0, high=1)

    @property
    def numbers(self) -> tuple[float, float]:
        """The restitution, that at the lowest speed if it depends on the speed, and zero."""
        return (float(self.table[1, 0]), 0.0) if self.table.size else super().numbers

    @cached_property
    def table(self) -> np.ndarray:
        """Rows: speed, restitution and its slope, shape (3, n); of a constant restitution, shape (0, 0)."""
        given = self.local_restitution
        if callable(given):
            speed = np.geomspace(*self.speeds, SPEEDS)
            return np.array([speed, *sampled("local_restitution", given, speed)])
        if not isinstance(given, tuple):
            return np.empty((0, 0))
        from scipy.interpolate import PchipInterpolator  # slow to import

        speed, values = np.array(given)
        return np.array([speed, values, PchipInterpolator(speed, values)(speed, 1)])

    def moved(self, first: float, second: float) -> NewtonRestitution:
        """The law with its restitution moved by `first` at every speed."""
        return replace(self, local_restitution=raised(self.local_restitution, first))


@final
@record(eq=True)
class LinearContact(ContactLaw):
    """Spring and dashpot at the stop: N = max(0, `stiffness` d + `damping` d') for d > 0.

    Parameters
    ----------
    stiffness : float
        Stiffness k of the spring, above zero [N/m].
    damping : float
        Constant c of the dashpot, zero or more [N s/m].

    Raises
    ------
    ValueError
        If a number is out of its range or not finite.
    TypeError
        If one of them is no number.

    See Also
    --------
    HertzContact : The force of an elastic ball, without loss.
    PowerContact : A force with any power of the depth.
    damping_ratio : The damping ratio of the dashpot for a given restitution.

    Examples
    --------
    The dashpot under which a ball of 4 g leaves with half its approach speed:

    >>> from contact import LinearContact
    >>> law = LinearContact.with_restitution(stiffness=1e5, restitution=0.5, mass=4e-3)
    >>> print(f"{law.damping:.2f} N s/m")
    10.21 N s/m
    """

    stiffness: float
    damping: float = 0.0
    code: ClassVar[int] = LINEAR
    units: ClassVar[dict[str, str]] = {"stiffness": "N/m", "damping": "N s/m"}

    @staticmethod
    def with_restitution(*, stiffness: float, restitution: float, mass: float) -> LinearContact:
        """Return the law under which a free `mass` [kg] leaves with `restitution` times its approach speed.

        `restitution` lies above 0 and is at most 1, and holds at every speed.  The dashpot of a mass m is
        c = 2 zeta sqrt(k m), with zeta of ``contact.damping_ratio``.  The tip of a modal model meets the stop
        with the mass 1/sum phi^2 of its modes; ``ModalModel.tip_mass`` is the limit for all modes.  If its
        modes move during the contact, the tip leaves with another restitution than the free mass.
        """
        elastic = LinearContact(stiffness=stiffness)
        mass = require_within("mass", mass, "kg", above=0)
        damping = 2.0 * damping_ratio(restitution) * math.sqrt(elastic.stiffness * mass)
        return replace(elastic, damping=damping)
