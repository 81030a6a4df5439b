"""Derivatives of a motion with respect to its start and to the numbers of its oscillator.

`change`       a `Change` is a direction in which the numbers of an oscillator move
`touch_flow`   the flow from touch to touch with its tangents, of which periodic orbits are made
`replay`       a simulated run once more, with its variational equation
`motion`       derivatives of impact times, strobes and samples of a run
"""
