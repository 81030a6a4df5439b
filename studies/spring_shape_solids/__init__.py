"""Solid elements: what the strip theories of `beam` are checked against, and nothing else.

    swept_mesh    quadratic hexahedra swept along a centreline
    elasticity    K, M and modes of such a solid, clamped at its ends, with the tip on one cross-section
"""

from studies.spring_shape_solids.elasticity import SolidModes, SolidSpring, end_compliance, solid_modes
from studies.spring_shape_solids.swept_mesh import SweptMesh, channel_profile, rectangle_profile, sweep

__all__ = [
    "SolidModes",
    "SolidSpring",
    "SweptMesh",
    "channel_profile",
    "end_compliance",
    "rectangle_profile",
    "solid_modes",
    "sweep",
]
