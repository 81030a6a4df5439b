"""What "U shaped" can mean: springs of one period; the flat U as a plate.

There is no `model`: three theories of the spring answer three questions.

`shapes`             which shapes suppress torsion?  Strips in space, brought to one period
`finite_amplitude`   is a linear spring enough at the gap?  Finite rotations and the cubic mode
`plate`              the modes of the flat U as a Kirchhoff plate
`model_error`        what does the plate change in the orbits of the beam?
"""
