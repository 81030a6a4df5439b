"""The spring: its modes, its calibration, its shape.

`modes`       which modes does the spring have?  Table, shapes, films of the lowest, files for ParaView
`calibrate`   which thickness, tape, gap and ball give the four numbers that were measured?
`shape`       which springs do the words "U shaped" allow, and what do they change?

A study of one file holds claim, physics and figure.  A folder has them in `__main__`, `model` and `figure`,
and names its further files in its ``__init__``.
"""
