"""Attractors along a scan: their kind, exponents and basins."""
