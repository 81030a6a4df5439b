"""Cross-section of a thin strip or channel that bends both ways and twists.

The frame of the section is (n, z): n lies in the plane of the centreline, z across it. With y the coordinate
along n and the origin in the centroid,

    EA     `axial_stiffness`                                                                [N]
    EI_z   `in_plane_stiffness`, int E y^2 dA: bending in the plane of the centreline       [N m^2]
    EI_n   `out_of_plane_stiffness`, int E z^2 dA: bending out of it                        [N m^2]
    GJ     `torsional_stiffness` (Saint-Venant)                                             [N m^2]
    EG     `warping_stiffness`, E times the warping constant (Vlasov)                       [N m^4]
    m      `mass_per_length`                                                                [kg/m]
    I      `polar_inertia` about the centroid, int rho (y^2 + z^2) dA                       [kg m]
    a      `shear_offset`: the centroid lies at +a n from the shear centre                  [m]

Strip of width b, thickness t: with EA, EI, GJ, m of `beam.StripSection`,

    bending about its width EI,  edgewise EA b^2/12,  EG = EI b^2/12  (a warping displacement y z),
    I = m (b^2 + t^2)/12.

`upright` puts the width along z, as in a strip that is folded out of its own plane. `flat` puts it along n,
as in a shape cut out of a sheet.

Channel of outer width b (web, along z) and sheet thickness t: its flanges stand h out of the web along +n,
h = H - t with H the outer flange height. Area, centroid and second moments follow from its three rectangles.
For the midlines, of lengths c = b - t and p = H - t/2,

    J = (c + 2 p) t^3/3,     shear centre 3 p^2/(6 p + c) behind the midline of the web,
    warping constant = t c^2 p^3/12 (3 p + 2 c)/(6 p + c) + b^3 t^3/144

(S. P. Timoshenko and J. M. Gere, Theory of Elastic Stability, table A-3; the last term is the web's own
warping as a strip). For h = 0 the section is the strip. J of `channel` is then larger than J of `upright` by
the part 0.63 t/b, since it neglects the two edges of the strip.
"""

from dataclasses import replace
from typing import ClassVar

from ..material import Material
from ..parameters import record, require, require_kind, require_within
from ..section import StripSection


@record(eq=True)
class SpatialSection:
    """Stiffness and inertia of a section in space.

    The frame of the section is (n, z): n lies in the plane of the centreline, z across it.

    Parameters
    ----------
    axial_stiffness : float
        Axial stiffness EA [N], positive.
    in_plane_stiffness, out_of_plane_stiffness, torsional_stiffness : float
        Stiffness EI_z of bending in the plane, EI_n of bending out of it, GJ of twist [N m^2], positive.
    mass_per_length, polar_inertia : float
        Mass per length m [kg/m], and moment I about the centroid per length [kg m], positive.
    warping_stiffness : float
        Stiffness EG, Young's modulus times the warping constant [N m^4], not negative.
    shear_offset : float
        Distance a of the centroid from the shear centre, along n [m], not negative; 0 on an arc.

    Raises
    ------
    ValueError
        If a value is out of range or not finite.
    TypeError
        If a value is not a number.
    """

    axial_stiffness: float
    in_plane_stiffness: float
    out_of_plane_stiffness: float
    torsional_stiffness: float
    mass_per_length: float
    polar_inertia: float
    warping_stiffness: float = 0.0
    shear_offset: float = 0.0

    axial_loss_factor: ClassVar[float] = 0.0
    bending_loss_factor: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        require_within("axial_stiffness", self.axial_stiffness, "N", above=0)
        for name in ("in_plane_stiffness", "out_of_plane_stiffness", "torsional_stiffness"):
            require_within(name, getattr(self, name), "N m^2", above=0)
        require_within("mass_per_length", self.mass_per_length, "kg/m", above=0)
        require_within("polar_inertia", self.polar_inertia, "kg m", above=0)
        require_within("warping_stiffness", self.warping_stiffness, "N m^4", low=0)
        require_within("shear_offset", self.shear_offset, "m", low=0)

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness EI_z [N m^2], under its name in `beam.StripSection`."""
        return self.in_plane_stiffness


def upright(section: StripSection) -> SpatialSection:
    """Return a strip with its width out of the plane of the centreline.

    Parameters
    ----------
    section : StripSection
        Section of the strip, without slot.

    Returns
    -------
    SpatialSection
        The stiffness and inertia of the strip in space.

    Raises
    ------
    ValueError
        If the section has a slot.
    TypeError
        If `section` is not a StripSection.
    """
    require_kind("section", section, StripSection, "a StripSection")
    require(section.slot == 0.0, "slot", f"is {section.slot} m; legs side by side need a strip each here")
    b, t, m = section.width, section.total_thickness, section.mass_per_length
    return SpatialSection(
        axial_stiffness=section.axial_stiffness,
        in_plane_stiffness=section.bending_stiffness,
        out_of_plane_stiffness=section.axial_stiffness * b**2 / 12.0,
        torsional_stiffness=section.torsional_stiffness,
        mass_per_length=m,
        polar_inertia=m * (b**2 + t**2) / 12.0,
        warping_stiffness=section.bending_stiffness * b**2 / 12.0,
    )


def flat(section: StripSection) -> SpatialSection:
    """Return a strip with its width in the plane of the centreline.

    Parameters
    ----------
    section : StripSection
        Section of the strip, without slot.

    Returns
    -------
    SpatialSection
        The stiffness and inertia of the strip in space.

    Raises
    ------
    ValueError
        If the section has a slot.
    TypeError
        If `section` is not a StripSection.
    """
    up = upright(section)
    easy, stiff = up.in_plane_stiffness, up.out_of_plane_stiffness
    return replace(up, in_plane_stiffness=stiff, out_of_plane_stiffness=easy)


def channel(*, material: Material, width: float, flange: float, thickness: float) -> SpatialSection:
    """Return a channel section, its web out of the plane of the centreline, its flanges towards +n.

    Parameters
    ----------
    material : Material
        Material of the sheet.
    width : float
        Outer width b over both flanges [m], positive.
    flange : float
        Length h by which the flanges stand out of the web [m], not negative.
    thickness : float
        Thickness t of the sheet [m], positive, at most half of the width.

    Returns
    -------
    SpatialSection
        The stiffness and inertia of the channel in space.

    Raises
    ------
    ValueError
        If a length is out of range, or the thickness exceeds half of the width.
    TypeError
        If `material` is not a Material, or a length is not a number.
    """
    require_kind("material", material, Material, "a Material, such as BRASS")
    require_within("width", width, "m", above=0)
    require_within("flange", flange, "m", low=0)
    require_within("thickness", thickness, "m", above=0)
    b, h, t = width, flange, thickness
    require(2.0 * t <= b, "thickness", f"is {t} m; it must not exceed half of the width {b} m")
    web, both = b * t, 2.0 * h * t
    area, arm = web + both, 0.5 * (h + t)  # arm: from the middle of the web to the middle of a flange
    centroid = both * arm / area
    about_z = web * (t**2 / 12.0 + centroid**2) + both * (h**2 / 12.0 + (arm - centroid) ** 2)
    about_n = web * b**2 / 12.0 + both * (t**2 / 12.0 + 0.25 * (b - t) ** 2)
    c, p = b - t, (h + 0.5 * t if h else 0.0)
    warping = t * c**2 * p**3 / 12.0 * (3.0 * p + 2.0 * c) / (6.0 * p + c) + (b * t) ** 3 / 144.0
    e, g, rho = material.youngs_modulus, material.shear_modulus, material.density
    return SpatialSection(
        axial_stiffness=e * area,
        in_plane_stiffness=e * about_z,
        out_of_plane_stiffness=e * about_n,
        torsional_stiffness=g * (c + 2.0 * p if h else b) * t**3 / 3.0,
        mass_per_length=rho * area,
        polar_inertia=rho * (about_z + about_n),
        warping_stiffness=e * warping,
        shear_offset=3.0 * p**2 / (6.0 * p + c) + centroid,
    )
