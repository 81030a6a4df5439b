"""The stop: a wall that rides on the base, at a distance `gap` from a point of the resting spring."""

from collections.abc import Sequence

import numpy as np

from beam import ModalModel
from beam.parameters import InvalidType, final, require, require_each, require_kind, require_within, shown
from beam.record import record
from contact.laws import ContactLaw

PARALLEL = 1e-12  # relative difference within which two stops are met by the same motion


@final
@record(eq=True)
class Stop:
    """A wall that a point of the spring can reach, with the law of its contact.

    Parameters
    ----------
    gap : float
        Distance from the point at rest to the wall, zero or more [m]; a driven spring needs more than zero.
    law : ContactLaw
        Law of the contact, such as a `NewtonRestitution`.
    at : str or (str, str)
        Name of a point of the model.  With two names (a, b) the stop lies between two points.  It is reached
        when the displacement of a minus that of b is the gap.
    side : {+1, -1}
        Side of the wall: that of positive or that of negative displacements [1].

    Raises
    ------
    ValueError
        If the gap is negative or not finite, if `side` is neither +1 nor -1, or if both names are equal.
    TypeError
        If the gap is no number, `law` no contact law, or `at` neither a name nor two names.

    See Also
    --------
    ImpactOscillator : A spring with one stop or several.
    NewtonRestitution : Instantaneous impact.
    LinearContact : Spring and dashpot at the stop.

    Examples
    --------
    A stop for the tip, and the same stop on the other side:

    >>> from dataclasses import replace
    >>> from contact import NewtonRestitution, Stop
    >>> stop = Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1))
    >>> stop
    Stop(gap=0.0119 m, law=NewtonRestitution(local_restitution=0.1))
    >>> replace(stop, side=-1).side
    -1
    """

    gap: float
    law: ContactLaw
    at: str | tuple[str, str] = "tip"
    side: int = 1

    def __post_init__(self) -> None:
        require_within("gap", self.gap, "m", low=0)
        require_kind("law of the stop", self.law, ContactLaw, "a contact law such as NewtonRestitution")
        require(self.side in (1, -1), "side", f"is {shown(self.side)} [1]; it must be +1 or -1")
        names = (self.at,) if isinstance(self.at, str) else self.at
        known = isinstance(names, tuple | list) and len(names) in (1, 2)
        if not (known and all(isinstance(name, str) for name in names)):
            raise InvalidType("at", f"is {shown(self.at)}; it must be the name of a point, or two names")
        if len(names) == 2:
            require(names[0] != names[1], "at", f"is {shown(self.at)}; it must be two different points")
            object.__setattr__(self, "at", tuple(names))

    def row_in(self, model: ModalModel) -> np.ndarray:
        """Return the weights of the modes in the motion towards the wall, shape (n_modes,) [kg^(-1/2)].

        ValueError is raised for a name that the model does not have.
        """
        names, known = (self.at,) if isinstance(self.at, str) else self.at, ", ".join(model.points)
        for name in names:
            words = f"is {shown(name)}; the points of the model are {known}"
            require(name in model.points, "at", words)
        rows = [model.points[name].row for name in names]
        return float(self.side) * (rows[0] if len(rows) == 1 else rows[0] - rows[1])


class OnlyStop(tuple[Stop, ...]):
    """The stop of an oscillator that has one; ``dataclasses.replace(oscillator, stop=...)`` changes it."""


def given_stops(stop: Stop | None, stops: Sequence[Stop] | None) -> tuple[Stop, ...]:
    """The stops of an oscillator from one of the two ways to give them."""
    if stop is not None:
        words = "stop and stops are both given; give one of them"
        require(stops is None or isinstance(stops, OnlyStop), words)
        return OnlyStop((require_kind("stop", stop, Stop, "a Stop"),))
    given = require_each("stops", () if stops is None else stops, Stop, "a sequence of Stop")
    require(len(given) > 0, "stop is missing; give a Stop, or at least one Stop in stops")
    return OnlyStop(given) if len(given) == 1 else given


def only_stop_of(stops: tuple[Stop, ...], what: str) -> Stop:
    """The only stop, at the tip and on its positive side; ValueError says that `what` needs this."""
    words = f"{what} needs one stop at the tip, on its positive side"
    require(len(stops) == 1, "stops", f"has {len(stops)} entries; {words}")
    at, side = stops[0].at, stops[0].side
    hint = "give a model whose phi is the row of that stop"
    require(at == "tip" and side == 1, "stop", f"is at {at!r}, side {side:+d}; {words}, so {hint}")
    return stops[0]


def rows_of(stops: tuple[Stop, ...], model: ModalModel) -> list[np.ndarray]:
    """The row of each stop in a model; refuses stops that no mode moves, that lie at one place, or that leave
    a point no clearance, and laws that hold for one mode."""
    rows, units, ways = [stop.row_in(model) for stop in stops], list[np.ndarray](), list[float]()
    for i, (stop, row) in enumerate(zip(stops, rows, strict=True)):
        size, law = float(np.linalg.norm(row)), type(stop.law).__name__
        require(size > 0.0, "at", f"is {shown(stop.at)}, a point that no mode moves towards the stop")
        if stop.law.one_mode_only and row.size > 1:
            remedy = "so give a force law or NewtonRestitution, or truncate the model"
            words = f"which holds for one mode; the model has {row.size}, {remedy}"
            raise InvalidType(f"law of the stop is {law}, {words}")
        unit, way = row / size, stop.gap / size
        for j, (other, reach) in enumerate(zip(units, ways, strict=True)):
            gaps = f"is {stops[j].gap} m and {stop.gap} m at stops {j} and {i}, which"
            limit = PARALLEL * max(way, reach)
            same = np.linalg.norm(unit - other) <= PARALLEL and abs(way - reach) <= limit
            require(not same, "gap", f"{gaps} lie at one place; one of them must go")
            closed = np.linalg.norm(unit + other) <= PARALLEL and not way + reach > 0.0
            words = f"{gaps} hold the point from both sides; it must have clearance"
            require(not closed, "gap", words)
        units, ways = [*units, unit], [*ways, way]
    return rows
