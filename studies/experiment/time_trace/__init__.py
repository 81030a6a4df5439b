"""The letter's Fig. 4: a settled orbit against time, one of its collisions, its spectrum.

`model`   the motion, the collision from close by, and the spectrum
`film`    the orbit as a film, slow at the collision (``--film``)
"""
