"""Vibration of a leaf spring at large amplitude, beyond the linear modes.

Its files are

    finite_rotation    `FiniteRotation`: strain energy, forces and tangent stiffness at finite rotations
    backbone           `backbone_coefficient`: the frequency of mode 1 over its amplitude
    harmonic_balance   `periodic_motion`, free or driven, and the decay of deviations from it
"""

from .backbone import Backbone, backbone_coefficient
from .finite_rotation import FiniteRotation
from .harmonic_balance import PeriodicMotion, periodic_motion

__all__ = ["Backbone", "FiniteRotation", "PeriodicMotion", "backbone_coefficient", "periodic_motion"]
