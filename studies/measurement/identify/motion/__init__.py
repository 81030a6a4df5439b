"""Motions that a record may show: predicted rows with derivatives, and where a fit begins.

``predictions``     what is predicted of any record; folds of a table
``readings``        what a sensor reads of a motion: displacement, velocity or acceleration, and strobe points
``starts``          start values of strobe points, and of a motion that repeats
``linear``          a motion without impacts
``unsteady``        a transient, or chaos
"""
