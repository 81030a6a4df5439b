"""The chart of periods over drive frequency and amplitude.

    plane.py      the cells: frequencies and amplitudes, refined around grazing
    overlays.py   band edges of the map and exact folds
    cells.py      a store as arrays, and what they say
    figure.py     the two scans side by side, period above and impacts below
    words.py      what is said to people
"""
