"""Least squares: from a record to the best fit, with errors and intervals.

Read ``search`` first; it calls the others, which stand in the order of their imports.

``descent``     least squares along curved valleys
``problem``     residuals and derivatives by unknowns without units; are residuals like noise?
``profiles``    the likelihood along one parameter
``result``      errors, correlations and intervals; whether the record determines the parameters
``diagnosis``   after a fit: hum, drift, filter, a transient or chaos in the residuals
``search``      `fit`: from a record to the best fit of many starts
"""
