"""Measurements: parameters from records, and the effect of noise on a measured hysteresis."""
