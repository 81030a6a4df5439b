"""Periodic orbits of the impact oscillator, one idea a file.

`single_impact`: one impact every m drive periods under Newton's law, in closed form, over `driven_modes` and
with the multipliers of `saltation`; `kick`: one collision of any law, by linear algebra; `shooting`: any law
and any number of touches, with exact tangents; `continuation`: branches and their events; `lyapunov`:
exponents.
"""
