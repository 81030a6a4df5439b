"""Measurements: parameters from records, and the effect of noise on a measured hysteresis.

``identify``            parameters with errors, from a record
``next_measurement``    the drive frequency and excess at which to measure next: ``identify --next``
``noise``               Fig. 3 of the letter as an experiment with a noisy drive shows it
"""
