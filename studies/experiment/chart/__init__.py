"""Which period, how many impacts: the plane of drive frequency and amplitude.

`model`     the plane: its grid, the cells of one column, bands and exact folds
`settled`   one frequency of the plane: Lyapunov exponents of the settled motions, and basins of attraction
"""
