"""From a measured record to the parameters and their errors: ``__main__`` says how to use it.

    record -> motions that it may show -> residuals -> least chi^2 -> parameters, errors, intervals

``record``      a record alone: read and checked, its lines and its kicks, what is wrong with it
``motion``      the rows that a model predicts for it, with derivatives; where a fit begins
``fit``         the least squares: residuals, search, errors, intervals
``figure``      record, residuals and trade-off
``report``      tables of the results, with values rounded for a person

None of them imports a later one.
"""
