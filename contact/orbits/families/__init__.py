"""Families of periodic orbits, each in one description.

`family`          what all families offer, and an orbit given by its first touch
`single_impact`   one impact every m drive periods under Newton's law, in closed form
`kick`            one collision of any law as a kick of all modes, by linear algebra
`shooting`        any law and any number of touches, by Newton's method with exact tangents
`periodic_orbit`  an orbit found by shooting
"""
