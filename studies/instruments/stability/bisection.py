"""Where something begins to fail, found by halving.

Between a value at which it holds and one at which it fails, the middle is tried until both ends lie within a
relative width; the middle is the geometric mean when both have the same sign, so that a bracket over many
decades takes no longer than a narrow one.  A bracket whose ends do not differ is an error: a limit that was
not seen on both sides is not a measured one.
"""

from __future__ import annotations

import math
from collections.abc import Callable

__all__ = ["bisect", "bisect_count"]

MOST = 200
"""Halvings: 64 suffice for neighbouring doubles, three times that for a bracket over all exponents."""


def bisect(
    fails: Callable[[float], bool], holds_at: float, fails_at: float, *, relative: float = 1e-6
) -> float:
    """The value between `holds_at` and `fails_at` where `fails` turns true, to a part `relative` of itself.

    Raises
    ------
    ValueError
        If it fails at `holds_at`, or holds at `fails_at`.
    """
    if fails(holds_at):
        raise ValueError(f"no limit is bracketed: it fails at {holds_at:g} already")
    if not fails(fails_at):
        raise ValueError(f"no limit is bracketed: it still holds at {fails_at:g}")
    low, high = holds_at, fails_at
    for _ in range(MOST):
        if abs(high - low) <= relative * max(abs(low), abs(high)):
            break
        middle = math.copysign(math.sqrt(low * high), low) if low * high > 0.0 else 0.5 * (low + high)
        if middle in (low, high):
            break
        if fails(middle):
            high = middle
        else:
            low = middle
    return math.copysign(math.sqrt(low * high), low) if low * high > 0.0 else 0.5 * (low + high)


def bisect_count(fails: Callable[[int], bool], holds_at: int, fails_at: int) -> int:
    """The first whole number above `holds_at` at which `fails` is true; it must hold and fail at the ends."""
    if fails(holds_at):
        raise ValueError(f"no limit is bracketed: it fails at {holds_at} already")
    if not fails(fails_at):
        raise ValueError(f"no limit is bracketed: it still holds at {fails_at}")
    low, high = holds_at, fails_at
    while high - low > 1:
        middle = (low + high) // 2
        if fails(middle):
            high = middle
        else:
            low = middle
    return high
