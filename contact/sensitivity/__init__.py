"""Derivatives of a motion with respect to its start and to the numbers of its oscillator.

`change`       a `Change` is a direction in which the numbers of an oscillator change
`touch_flow`   the flow from touch to touch and its derivatives, from which periodic orbits are found
`replay`       the variational replay of a simulated run
`derivatives`  derivatives of impact times, strobes and samples of a run
"""
