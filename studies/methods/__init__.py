"""The methods: error against cost, where they fail, how large a model must be, published numbers.

Studies
    `work_precision`   how accurate is each method, and at what cost?
    `stability`        where does each method fail, and does theory say so?
    `adequacy`         how detailed must the model be for each question?
    `validation`       does the package have the numbers that other authors printed?

Shared by them
    `crossings`        crossings of the stop of known depth, at every phase of a method's steps
    `peers`            outside solvers behind the interface of the package's own methods
"""
