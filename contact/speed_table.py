"""Functions of the approach speed as tables, which compiled code can interpolate.

A table has the approach speeds [m/s], rising, in its first row.  Each function takes two more rows, its
values and its slopes.  Between two columns a function is the cubic with their values and slopes; beyond the
table it keeps its end values.  Samples get the slopes of their cubic spline.
"""

from collections.abc import Callable, Sequence
from functools import partial
from numbers import Real
from typing import Any

import numpy as np

from beam.parameters import Array, InvalidValue, brief, require, require_array, require_kind, shown
from contact.machine.compiled import kernel

SpeedFunction = Callable[[float], float]
Points = Sequence[Sequence[float]]  # speeds [m/s], and a number at each

SPEEDS = 1025  # samples of a function of the approach speed: a cubic spline over six decades is good to 1e-9

CLOSEST = 1e-300  # least distance of two speeds of a table [m/s]: slopes stay finite


def require_speeds(speeds: object) -> None:
    """Refuse `speeds` [m/s] unless it is the range of a table, two rising numbers above zero."""
    words = "two rising numbers above zero"
    low, high = require_array("speeds", speeds, "m/s", shape=(2,), words=words)
    require(0 < low < high, f"speeds is {brief(speeds)} m/s; it must be {words}")


def require_points(name: str, given: object, unit: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Rising speeds [m/s], zero or more, and the numbers in `unit` at each; refuses any other `given`."""
    words = "two rows: two or more rising speeds, zero or more, and a number at each"
    points = require_array(name, given, f"m/s and {unit}", dimensions=2, words=words)
    if len(points) != 2 or points.shape[1] < 2 or points[0, 0] < 0.0 or np.any(np.diff(points[0]) < CLOSEST):
        raise InvalidValue(name, f"is {shown(points.tolist())} m/s and {unit}; it must be {words}")
    return tuple(points[0].tolist()), tuple(points[1].tolist())


def sampled(name: str, given: float | SpeedFunction, speed: Array) -> list[Array]:
    """Values and slopes of a number or a function at these speeds [m/s], each of the shape of `speed`.

    Raises InvalidType if the function returns something else than a number.
    """
    if not callable(given):
        return [np.full(speed.size, float(given)), np.zeros(speed.size)]
    from scipy.interpolate import CubicSpline  # slow to import

    at = f"{name} at an approach speed of"
    found = [require_kind(f"{at} {v:g} m/s", given(float(v)), Real, "a number") for v in speed]
    values = np.array(found, dtype=float)
    return [values, CubicSpline(speed, values)(speed, 1) if np.all(np.isfinite(values)) else values]


def _plus(given: SpeedFunction, step: float, speed: float) -> float:
    return given(speed) + step


def raised(given: Any, step: float) -> Any:
    """A number, function or points, higher by `step` at every speed; can be pickled if it could be."""
    if isinstance(given, tuple):
        return given[0], tuple(value + step for value in given[1])
    return partial(_plus, given, step) if callable(given) else given + step


@kernel
def at_speed(table, row, speed):
    """Value and slope at an approach speed [m/s] of the function whose values are in row `row`."""
    n = table.shape[1]
    if not speed > table[0, 0]:
        return table[row, 0], 0.0
    if speed >= table[0, n - 1]:
        return table[row, n - 1], 0.0
    high = np.searchsorted(table[0], speed, "right")
    low = high - 1
    h = table[0, high] - table[0, low]
    s = (speed - table[0, low]) / h
    a, b = table[row, low], table[row, high]
    da, db = h * table[row + 1, low], h * table[row + 1, high]
    square, cube = 3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db
    return a + s * (da + s * (square + s * cube)), (da + s * (2.0 * square + 3.0 * s * cube)) / h
