"""From a measured record to the parameters and their errors: ``__main__`` says how to use it.

The files in reading order:
    records         records: the three kinds, read, checked and made
    predictions     a model's rows: strobe points of an orbit p_m, folds of a table
    displacement    a model's rows: what a sensor reads of the tip
    problem         residuals and derivatives by unknowns without units
    descent         least squares along curved valleys
    fit             from a record to the best fit of many starts
    result          errors, correlations and intervals; whether the record determines the parameters
    profiles        the likelihood along one parameter
Where a fit starts:
    starts          strobe points; a displacement that repeats
    spectrum        harmonics, drive frequencies, repetition
    kicks           a settled motion as one that is kicked
    linear          a displacement without impacts
    unsteady        a transient, or chaos
What is wrong with a record:
    soundness       before a search: rows, drive and units
    diagnosis       lines, corners and noise: the faults that rows and residuals show
What is shown:
    estimates       the rows of the tables
    figure          record, residuals and trade-off
"""
