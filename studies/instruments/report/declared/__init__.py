"""The studies in the order of the report: the letter's questions, the spring, then how it was computed."""

from __future__ import annotations

from studies.instruments.report.declared import (
    breakdown,
    claims,
    effective_impact,
    hysteresis,
    methods,
    plane,
    soft_wall,
    spring,
    trace,
    transitions,
)
from studies.instruments.report.entry import Entry

__all__ = ["DECLARED", "WITHOUT_SUMMARY"]

DECLARED: tuple[Entry, ...] = (
    transitions.ENTRY,
    hysteresis.ENTRY,
    effective_impact.ENTRY,
    soft_wall.ENTRY,
    trace.TRACE,
    trace.MOTION,
    breakdown.ENTRY,
    claims.OTHERS,
    claims.SENSITIVITY,
    plane.CHART,
    plane.ATTRACTORS,
    spring.MODES,
    spring.SHAPE,
    spring.CALIBRATION,
    methods.ADEQUACY,
    methods.WORK,
    methods.STABILITY,
    methods.BENCHMARKS,
    trace.TOUR,
)

WITHOUT_SUMMARY = ("tour",)
"""Programs that store pictures only."""
