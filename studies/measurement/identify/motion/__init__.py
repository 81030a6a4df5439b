"""Motions that a record may show: predicted rows with derivatives, and where a fit begins.

``predictions``     what is predicted of any record; strobe points of an orbit p_m, folds of a table
``displacement``    the displacement of the tip as a sensor reads it
``starts``          start values of strobe points, and of a displacement that repeats
``linear``          a displacement without impacts
``unsteady``        a transient, or chaos
"""
