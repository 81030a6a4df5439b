"""Least squares: from residuals to the best fit, with errors and intervals.

``descent``     least squares along curved valleys
``problem``     residuals and derivatives by unknowns without units; are residuals like noise?
``profiles``    the likelihood along one parameter
``result``      errors, correlations and intervals; whether the record determines the parameters
``search``      `fit`: from a record to the best fit of many starts
"""
