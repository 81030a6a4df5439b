"""The stop: a wall that rides on the base, at a distance `gap` from a point of the resting spring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beam import ModalModel
from beam.parameters import InvalidType, InvalidValue, final, require, require_kind, require_within, shown
from contact.laws import ContactLaw

PARALLEL = 1e-12  # relative difference within which two stops are met by the same motion


@final
@dataclass(frozen=True, kw_only=True)
class Stop:
    """A wall that a point of the spring can reach, with the law of its contact.

    Parameters
    ----------
    gap : float
        Distance from the point at rest to the wall, zero or more [m]; a driven spring needs more than zero.
    law : ContactLaw
        What happens when the point reaches it.
    at : str or (str, str)
        Name of a point of the model.  Of two names (a, b), the stop lies between two points and is reached
        when the difference of their displacements, a less b, is the gap.
    side : {+1, -1}
        Where the wall lies: on the side of positive or of negative displacements.
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
        """The weights of the modes in the motion towards the wall, shape (n_modes,) [kg^-0.5].

        InvalidValue is raised for a name that the model does not have.
        """
        names, rows = (self.at,) if isinstance(self.at, str) else self.at, []
        for name in names:
            if name not in model.points:
                known = ", ".join(model.points)
                raise InvalidValue("at", f"is {shown(name)}; the points of the model are {known}")
            rows.append(model.points[name].row)
        return float(self.side) * (rows[0] if len(rows) == 1 else rows[0] - rows[1])


def check_apart(stops: tuple[Stop, ...], rows: list[np.ndarray]) -> None:
    """Refuse stops that no mode moves, that lie at one place, or that leave a point no clearance."""
    sizes = [float(np.linalg.norm(row)) for row in rows]
    for stop, size in zip(stops, sizes, strict=True):
        require(size > 0.0, "at", f"is {shown(stop.at)}, a point that no mode moves towards the stop")
    for i in range(len(stops)):
        for j in range(i):
            a, b = rows[i] / sizes[i], rows[j] / sizes[j]
            near, far = stops[j].gap / sizes[j], stops[i].gap / sizes[i]
            if np.linalg.norm(a - b) <= PARALLEL and abs(near - far) <= PARALLEL * max(near, far):
                words = f"stops {j} and {i} are met by the same motion at the same time; one must go"
                raise InvalidValue("gap", f"is {stops[j].gap} m and {stops[i].gap} m, and {words}")
            if np.linalg.norm(a + b) <= PARALLEL and not near + far > 0.0:
                words = f"stops {j} and {i} hold the point from both sides; their total must be above zero"
                raise InvalidValue("gap", f"is {stops[j].gap} m and {stops[i].gap} m, and {words}")
