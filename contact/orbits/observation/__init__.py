"""Observation of a motion that is followed in time.

`settling`         the orbit on which a motion settles
`repetition`       after how many periods a motion repeats itself
`scan`             orbit diagrams: the drive changed step by step, the state carried along
`ends`             the loss of an orbit when the drive is lowered
`amplitude_scan`   one column of a chart, compiled
`lyapunov`         Lyapunov exponents
`covariance`       strobe points under noise of the drive
"""
