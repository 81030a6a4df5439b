"""Families of periodic orbits, each in one description.

`family`              what all families offer, and an orbit given by its first touch
`single_impact`       one impact every m drive periods under Newton's law, in closed form
`kick`                one collision of any law as a kick of all modes, by linear algebra
`equations`           the equations of an orbit, F(z, p) = 0, their derivatives, and Newton's method
`continuable_family`  families of which each orbit leads to its neighbours
"""
