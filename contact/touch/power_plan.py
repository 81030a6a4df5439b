"""Powers of rho for the contact N = k d^p + c d^((p-1)/2) d', each the product of two lower ones.

The kernels of ``contact.touch.power`` need five powers of rho, d = rho^m, as series.  Which they are depends
on the exponent.  A table names their rows and the products that lead to them, so that no kernel branches.
"""

from fractions import Fraction

import numpy as np

from contact.touch.hertz import ROOT

ONE = 8  # row of the scalar series that holds the power zero; the products of the plan follow

NUMBERS, LEFT, RIGHT = range(3)
"""Rows of the table: numbers; the two factors of each product, as rows of the scalar series."""

FINENESS, EXPONENT, EFFECT, PRODUCTS, TIME, LEVER, RISE, SLOPE, DASHPOT_SLOPE = range(9)
"""Numbers of the table: m, p, m (p+1)/2, the number of products, and the rows that hold rho to the powers
m - 1, l, h, a - 1 and b - 1."""


def plan_of(exponent: Fraction, damped: bool) -> np.ndarray:
    """The table of a law with this exponent p; see `NUMBERS`."""
    half = (exponent - 1) / 2
    m = half.denominator if damped else exponent.denominator
    a, b = int(m * exponent), int(m * half) if damped else 0
    rows, factors = {0: ONE, 1: ROOT}, list[tuple[int, int]]()

    def row_of(power: int) -> int:
        """The row that holds rho to this power, after the products that it needs."""
        if power not in rows:
            one = next((x for x in rows if x > 0 and power - x in rows), power // 2)
            factors.append((row_of(one), row_of(power - one)))
            rows[power] = ONE + len(factors)
        return rows[power]

    powers = (m - 1, b + m - 1, b + m, a - 1, max(0, b - 1)) if damped else (m - 1, a - 1, m, a - 1, 0)
    for power in sorted(powers):
        row_of(power)
    table = np.zeros((3, max(DASHPOT_SLOPE + 1, len(factors))))
    numbers = m, float(exponent), float(m * (1 + half)), len(factors), *(rows[power] for power in powers)
    table[NUMBERS, : len(numbers)], table[LEFT:, : len(factors)] = numbers, np.reshape(factors, (-1, 2)).T
    return table
