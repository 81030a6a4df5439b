"""The same strip out of its plane: bending both ways, twist, and a tip off the centroid of its section.

section   `SpatialSection`: strips `upright` and `flat`, a `channel`
spring    `SpatialSpring`
element   one piece, as stiffness and strain
modes     `spatial_modes`, for springs whose readings of "U shaped" differ out of the plane
"""

from .modes import SpatialModes, spatial_modes
from .section import SpatialSection, channel, channel_centroid, flat, upright
from .spring import SpatialSpring, Vector

__all__ = [
    "SpatialModes",
    "SpatialSection",
    "SpatialSpring",
    "Vector",
    "channel",
    "channel_centroid",
    "flat",
    "spatial_modes",
    "upright",
]
