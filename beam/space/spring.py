"""A leaf spring in space: plane centreline, sections, supports, and a tip off the centroid of its section.

The centreline lies in the x-y plane with frame t, n, z; u, w, v [m] are displacements along these and phi
[rad] is the rotation about t. Supports are as in `beam.spring`; without warping stiffness a clamp does not
hold phi'. The tip is a body of mass M [kg] with the rotary inertia J [kg m^2] about every axis. It is fixed
to one section at the point c [m] from its centroid.
"""

from ..centreline import Centreline
from ..parameters import record, require, require_array
from ..spring import Support, Tip, check_strip
from .section import SpatialSection

Vector = tuple[float, float, float]


@record(eq=True)
class SpatialSpring:
    """A strip in space that follows a plane centreline between two supports.

    Parameters
    ----------
    centreline : Centreline
        Curve of the centroids at rest [m].
    sections : tuple of SpatialSection
        One section for each piece of the centreline.
    supports : tuple of two Support
        Supports at s = 0 and at the far end: "clamped", "pinned", "guided" or "free".
    tip : Tip
        The body that meets the stop. Its rotary inertia counts about every axis.
    tip_at : float
        Arc length of the section that carries the tip [m].
    tip_offset : tuple of three floats
        Vector c from the centroid of that section to the tip, along x, y and z [m].
    drive : tuple of three floats
        Direction e of the base motion [1]; stored as a unit vector.

    Raises
    ------
    ValueError
        If the number of sections is wrong, a support is unknown or holds the tip, or `tip_at` is off the
        centreline. Also if the drive has length 0, or a section with a shear offset is on an arc.
    TypeError
        If a value is of another class than stated above.
    """

    centreline: Centreline
    sections: tuple[SpatialSection, ...]
    supports: tuple[Support, Support]
    tip: Tip
    tip_at: float
    tip_offset: Vector = (0.0, 0.0, 0.0)
    drive: Vector = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        check_strip(self, SpatialSection, 3)
        for section, piece in zip(self.sections, self.centreline.pieces, strict=True):
            a = section.shear_offset
            require(not (a and piece.curvature), "shear_offset", f"is {a} m; on an arc it must be 0")
        require_array("tip_offset", self.tip_offset, "m", shape=(3,), words="three finite numbers")
