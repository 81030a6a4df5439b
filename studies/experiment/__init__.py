"""The experiment: its figures, its claims, and what lies behind them.

The figures of the letter
    `transitions`       Fig. 2: which period begins at grazing, and where does its orbit end?
    `hysteresis`        Fig. 3: how far below grazing do the orbits remain, and why do the models differ?
    `time_trace`        Fig. 4: what does a settled orbit look like, in time, as a spectrum, as a film?
    `breakdown`         Fig. 5: where does the square-root map fail?

Behind the figures
    `effective_impact`  what does one collision do to mode 1: restitution, delay, kick?
    `soft_wall`         how does a wall of finite hardness change the motion next to grazing?
    `claims`            do loss, secondary bifurcations, universality and period adding hold?
    `last_period`       why was p10 the last period that the letter saw?
    `chart`             which period and how many impacts, over the whole plane of frequency and amplitude?
    `sweep`             how does the settled motion change with any one or two numbers of a scene?

`period_map` and `period_colours` are what several of them use.

For students
    `lecture`           what to set on the bench, and what is seen?

What several of them use
    `trace`             a motion in time, its collisions and its spectrum
    `film`              an orbit as a film, slow at its impacts

A study is one file or a folder.  In each folder `__main__` has the claim, the options and the verdicts,
`model` the physics, and `figure` the figures.  A folder with further files names them in its ``__init__``.
"""
