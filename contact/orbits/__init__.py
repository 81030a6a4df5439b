"""Periodic orbits of the impact oscillator, one idea a file.

`single_impact`: one impact every m drive periods under Newton's law, in closed form.
"""
