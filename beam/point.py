"""A place of a structure: its motion in the modes, and its statics."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .parameters import final, record, require, require_array, require_within


@final
@record
class Point:
    """A place of a structure, with its motion in the modes and its statics.

    Parameters
    ----------
    row : array_like, shape (n_modes,)
        Values of the mass-normalised shapes there [kg^(-1/2), rotations kg^(-1/2) m^(-1)]. The motion of the
        place, relative to the base, is ``row @ q``.
    static_compliance : float, optional
        Displacement per unit static force at the place, all modes of the structure included [m/N].
    mass : float, optional
        Lumped mass at the place [kg], the limit of 1 / sum row^2.

    Raises
    ------
    ValueError
        If `row` is empty, of more dimensions or not finite, or one of the numbers is negative.
    TypeError
        If a value is not a number.
    """

    row: NDArray[np.float64]
    static_compliance: float | None = None
    mass: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "row", row_of("row", self.row, "kg^(-1/2)"))
        check_statics(self, static_compliance="m/N", mass="kg")


def check_statics(owner: object, **units: str) -> None:
    """Store these numbers of the owner as floats; a negative one is refused, None stays."""
    for name, unit in units.items():
        if (value := getattr(owner, name)) is not None:
            object.__setattr__(owner, name, require_within(name, value, unit, low=0))


def require_own_statics(tip: Point, old: Point | None) -> None:
    """Refuse statics of a tip that are equal to an old tip's, unless their rows agree up to signs."""
    if old is None or all(abs(a) == abs(b) for a, b in zip(old.row, tip.row, strict=False)):
        return
    words = "which belongs to another phi; it must be given for this phi, or None"
    c, m = tip.static_compliance, tip.mass
    require(c is None or c != old.static_compliance, "static_compliance", f"is {c} m/N, {words}")
    require(m is None or m != old.mass, "tip_mass", f"is {m} kg, {words}")


def row_of(name: str, values: ArrayLike, unit: str) -> NDArray[np.float64]:
    """Return a read-only float copy of shape (n,), n >= 1, all finite."""
    row = require_array(name, values, unit, dimensions=1, words="one row of numbers")
    require(row.size > 0, name, f"has shape {row.shape}; it must be one row of at least one mode [{unit}]")
    return row
