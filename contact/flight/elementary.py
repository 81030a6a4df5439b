"""Sine, cosine and exponential to one unit in the last place, and products without rounding error.

The inlined functions neither branch nor call the system's library, so that a loop over many modes compiles to
vector instructions.  A phase is an unevaluated sum of two doubles.  Sine and cosine are Taylor sums on |x| <=
pi/4 after one reduction by multiples of pi/2, whose leading 33 bits make the product exact (W. J. Cody and W.
Waite, Software Manual for the Elementary Functions, Prentice-Hall 1980); exp is one on |x| <= ln 2/2.
"""

import math

import numpy as np

from contact.machine.compiled import inlined, kernel

EPS = 2.220446049250313e-16  # distance from 1 to the next double
FARTHEST = 5e5  # largest phase for which the product of the number of quarter turns and pi/2 is exact [rad]
_SPLIT = 134217729.0  # 2^27 + 1, Veltkamp's splitting of a double into two halves
_QUARTER, _QUARTER_LOW = 1.5707963267341256, 6.077100506506192e-11  # pi/2, its first 33 bits and the rest
_LN2, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # ln 2, its first 32 bits and the rest
_LOWEST, _HIGHEST = -708.0, 709.0  # exponents between which powers of two are tabulated
_POWERS_OF_TWO = 2.0 ** np.arange(-1022.0, 1024.0)
_S3, _S5, _S7, _S9, _S11, _S13, _S15, _S17 = ((-1.0) ** n / math.factorial(2 * n + 1) for n in range(1, 9))
_C4, _C6, _C8, _C10, _C12, _C14, _C16 = ((-1.0) ** n / math.factorial(2 * n) for n in range(2, 9))
_E2, _E3, _E4, _E5, _E6, _E7, _E8, _E9, _E10, _E11, _E12, _E13 = (
    1.0 / math.factorial(n) for n in range(2, 14)
)


@inlined
def two_product(a, b):
    """a b and its rounding error, so that product + error is exact (Dekker)."""
    p = a * b
    t = _SPLIT * a
    ah = t - (t - a)
    al = a - ah
    t = _SPLIT * b
    bh = t - (t - b)
    bl = b - bh
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


@inlined
def fast_sine_cosine(phase, rest):
    """sin and cos of `phase` + `rest`, |phase| below `FARTHEST` and |rest| far below one."""
    n = np.floor(phase * (2.0 / math.pi) + 0.5)
    lead, part = phase - n * _QUARTER, n * _QUARTER_LOW
    near = lead - part
    low = ((lead - near) - part) + rest
    x = near + low
    low = (near - x) + low
    z = x * x
    z2 = z * z
    z4 = z2 * z2
    tail = (_S3 + z * _S5) + z2 * (_S7 + z * _S9) + z4 * ((_S11 + z * _S13) + z2 * (_S15 + z * _S17))
    s = x + (x * z * tail + low * (1.0 - 0.5 * z))
    half = 0.5 * z
    c = 1.0 - half
    tail = (_C4 + z * _C6) + z2 * (_C8 + z * _C10) + z4 * ((_C12 + z * _C14) + z2 * _C16)
    c += ((1.0 - c) - half) + (z2 * tail - x * low)
    quarter = n - 4.0 * np.floor(0.25 * n)
    odd = quarter == 1.0 or quarter == 3.0
    sine = c if odd else s
    cosine = s if odd else c
    sine = -sine if quarter >= 2.0 else sine
    cosine = -cosine if (quarter == 1.0 or quarter == 2.0) else cosine
    return sine, cosine


@kernel
def sine_cosine(phase, rest):
    """sin and cos of `phase` + `rest`, |rest| far below one."""
    if not abs(phase) < FARTHEST:
        s, c = math.sin(phase), math.cos(phase)
        return s + rest * c, c - rest * s
    return fast_sine_cosine(phase, rest)


@inlined
def exponential(x):
    """exp(x); 0 below -708, and no more than exp(709)."""
    y = x if x > _LOWEST else _LOWEST  # also for a NaN, which must not become an index
    y = y if y < _HIGHEST else _HIGHEST
    n = np.floor(y * 1.4426950408889634 + 0.5)
    r = (y - n * _LN2) - n * _LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    tail = (_E2 + r * _E3) + r2 * (_E4 + r * _E5)
    high = (_E10 + r * _E11) + r2 * (_E12 + r * _E13)
    tail += r4 * (((_E6 + r * _E7) + r2 * (_E8 + r * _E9)) + r4 * high)
    value = _POWERS_OF_TWO[int(n) + 1022] * (1.0 + (r + r2 * tail))
    return 0.0 if x < _LOWEST else value


@kernel
def square_root(high, low):
    """sqrt|high + low| as a sum of two doubles, |low| far below |high|."""
    lead = high + low
    back = lead - high
    low = (high - (lead - back)) + (low - back)
    root = math.sqrt(abs(lead))
    if root == 0.0:
        return 0.0, 0.0
    s, error = two_product(root, root)
    if lead < 0.0:
        lead, low = -lead, -low
    return root, ((lead - s) + (low - error)) / (2.0 * root)
