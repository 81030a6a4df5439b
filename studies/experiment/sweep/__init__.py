"""The settled motion over one or two numbers of a scene or of its drive.

`model`    the axes of a sweep, its cells, and the motion of one of them
`figure`   lines over one axis, maps over two
"""
