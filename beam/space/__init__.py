"""Vibration of a strip in space: bending both ways, twist, and a tip off the centroid of its section.

Its files are

    section   `SpatialSection`: strips `upright` and `flat`, a `channel`
    spring    `SpatialSpring`, a strip between two supports, with its tip
    element   strains and matrices of one piece that moves out of the plane
    modes     `spatial_modes`, the natural modes in the plane and out of it
"""

from .modes import SpatialModes, spatial_modes
from .section import SpatialSection, channel, flat, upright
from .spring import SpatialSpring, Vector

__all__ = [
    "SpatialModes",
    "SpatialSection",
    "SpatialSpring",
    "Vector",
    "channel",
    "flat",
    "spatial_modes",
    "upright",
]
