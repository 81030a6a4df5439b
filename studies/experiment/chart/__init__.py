"""Which period, how many impacts: the plane of drive frequency and amplitude."""
