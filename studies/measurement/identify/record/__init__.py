"""What a record shows without any parameter of a model.

``records``     the three kinds of record: what they hold, and synthetic ones
``reading``     a record from a file: which column is the time, which the channel
``channel``     what a sensor reads: displacement, velocity or acceleration of the tip
``spectrum``    lines: harmonics, drive frequencies, repetition
``kicks``       a displacement as a settled motion that is kicked: when, how strongly, how damped
``soundness``   before a fit: rows, drive and units that cannot be right
"""
