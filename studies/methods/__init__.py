"""The methods: error against cost, where they fail, how large a model must be, published numbers.

Shared here: `crossings` of known depth, and the outside solvers in `peers`.
"""
