"""The settled motion over any one or two numbers of a scene, of its drive, or of both.

`model`    the axes of a sweep, its cells, and the motion of one of them
`figure`   lines over one axis, maps over two
"""
