"""Families of periodic orbits: the orbits p_m of one oscillator, over their approach speed.

`protocol`        what every orbit and every family offers, whatever describes the motion
`touch_orbit`     an orbit of an impact oscillator, given by its first touch

Three ways to the orbits of a family, from the fastest to the most general:
`single_impact`   in closed form, with the fold: one collision in m drive periods, under Newton's law one
                  impact (`MaximalFamily`)
`kick`            by linear algebra: one collision of any law, taken as a kick of all modes (`KickFamily`)
`newton_family`   by Newton's method: any law and any number of touches; `Shooting` is built on it

`equations`       the equations of an orbit for Newton's method, F(z, p) = 0, and their derivatives
`newton`          the method, for a point of a curve of orbits
"""
