"""A wall of finite stiffness: how it smooths the square root, and the orbits that this adds at grazing.

`model`          the simulated kicks, the period doubling of p1, and the beam
`closed_forms`   the same for one touch near grazing, in closed form
"""
