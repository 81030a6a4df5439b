"""What a record shows without any parameter of a model.

``records``     the three kinds of record: read, checked and made
``spectrum``    lines: harmonics, drive frequencies, repetition
``kicks``       a displacement as a settled motion that is kicked: when, how strongly, how damped
``soundness``   before a fit: rows, drive and units that cannot be right
"""
