"""The spring: its modes, its calibration, its shape."""
