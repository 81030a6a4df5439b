"""Power series in extended precision: values, slopes, and how far they reach.

A series x(t) = sum_n x_n t^n of M terms is used up to the step at which its last terms lie below the working
precision of a size S, |x_n| h^n <= S 10^(-digits): h = (S 10^(-digits)/|x_n|)^(1/n).
"""

from __future__ import annotations

from typing import Any

from mpmath import mp

__all__ = ["Series", "horner", "order_for_digits", "reach", "slope"]

Series = list[Any]


def order_for_digits() -> int:
    """Terms with which a step of a fifth of the radius of convergence reaches the working precision."""
    return int(mp.dps * 1.45) + 4


def horner(series: Series, t: Any) -> Any:
    """Value of a power series."""
    value = series[-1]
    for term in series[-2::-1]:
        value = value * t + term
    return value


def slope(series: Series, t: Any) -> Any:
    """Derivative of a power series."""
    return horner([n * term for n, term in enumerate(series)][1:], t)


def reach(series: Series, size: Any) -> Any:
    """Step for which the last terms lie below the working precision of `size`.

    Six of them: of a mass alone, four in five terms of the series in sigma vanish.
    """
    goal = size * mp.mpf(10) ** (-mp.dps)
    steps = [mp.root(goal / abs(series[n]), n) for n in range(len(series) - 6, len(series)) if series[n] != 0]
    return min(steps, default=mp.inf)
