"""Leaf springs of the usual shapes, bare or with a glued damping layer.

The folded U has two legs, parallel to x and 2 r apart, clamped at x = 0. A semicircle of radius r [m] joins
them, with the ball in its middle. The drive is along y, in the plane of the U (sway).

The flat U is cut out of a sheet, clamped at x = 0 and driven along y, across the sheet. Its legs lie side by
side and bend as one strip with a slot. The bend, a half ring of radius r and width b, is replaced by a plate
of its area as wide as the U, 2 r + b. For b = 12 mm and legs of 130 mm, `beam.space` gives the first four
frequencies within 1 % at r = 9 mm and 4 % at r = 15 mm. The tip displacements agree within 3 % and 6 %.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .centreline import Arc, Centreline, Straight
from .parameters import require, require_array, require_kind, require_within, suspect
from .section import BeamSection, StripSection
from .spring import LeafSpring, Readout, Support, Tip


def folded_u(
    *,
    leg_length: float,
    bend_radius: float,
    section: StripSection | BeamSection,
    tip: Tip,
    damped_section: StripSection | None = None,
    damped_span: tuple[float, float] | None = None,
    readouts: Mapping[str, Readout] | None = None,
) -> LeafSpring:
    """Return a strip folded into a U, the tip in the middle of the bend.

    Parameters
    ----------
    leg_length, bend_radius : float
        Straight length of each leg and radius of the centreline of the bend [m].
    section : StripSection or BeamSection
        Section of the strip without layer.
    tip : Tip
        The body in the middle of the bend.
    damped_section : StripSection, optional
        Section of the strip with the glued layer; without it the strip is bare.
    damped_span : tuple of two floats, optional
        Start and end of the layer on each leg, measured from the supports [m]; the whole leg by default.
    readouts : mapping of str to Readout, optional
        Points where the motion is measured, by name.

    Returns
    -------
    LeafSpring
        The spring, clamped at both ends and driven along y.

    Raises
    ------
    ValueError
        If a length is not positive, the bend is tighter than half the thickness, or the span is off the leg.
    TypeError
        If a value is of another class than stated above.

    Warns
    -----
    SuspiciousValue
        If the bend is wider than the legs are long. Also in the cases that are listed at `LeafSpring`.
    """
    leg, sections = _leg(leg_length, section, damped_section, damped_span)
    bend = Arc(radius=bend_radius, angle=math.pi)
    if bend_radius > leg_length:
        suspect(f"bend_radius is {bend_radius:g} m, above leg_length, {leg_length:g} m; this is hardly a U")
    return LeafSpring(
        centreline=Centreline(pieces=(*leg, bend, *reversed(leg)), start=(0.0, -bend_radius)),
        sections=(*sections, section, *reversed(sections)),
        supports=("clamped", "clamped"),
        tip=tip,
        tip_at=leg_length + 0.5 * math.pi * bend_radius,
        readouts=readouts or {},
    )


def flat_u(
    *,
    leg_length: float,
    bend_radius: float,
    section: StripSection | BeamSection,
    tip: Tip,
    damped_section: StripSection | None = None,
    damped_span: tuple[float, float] | None = None,
    readouts: Mapping[str, Readout] | None = None,
) -> LeafSpring:
    """Return a U cut out of a sheet, clamped at its legs, the tip on its bend.

    Parameters
    ----------
    leg_length, bend_radius : float
        Straight length of each leg and radius of the middle line of the bend [m]. The legs are 2
        `bend_radius` apart, which must be more than their width and should be at most twice their width.
    section : StripSection
        Section of one leg without layer.
    tip : Tip
        The body at the apex of the bend, at `bend_radius` from the legs.
    damped_section : StripSection, optional
        Section of one leg with the glued layer; without it the legs are bare.
    damped_span : tuple of two floats, optional
        Start and end of the layer on each leg, measured from the supports [m]; the whole leg by default.
    readouts : mapping of str to Readout, optional
        Points where the motion is measured, by name.

    Returns
    -------
    LeafSpring
        The spring as one straight strip with a slot, clamped at x = 0, free at its bend and driven along y.

    Raises
    ------
    ValueError
        If a length is not positive, the legs overlap, or the span is off the leg.
    TypeError
        If a value is of another class than stated above.

    Warns
    -----
    SuspiciousValue
        If `bend_radius` exceeds the width of a leg. Also in the cases that are listed at `LeafSpring`.

    See Also
    --------
    folded_u : A strip folded into a U out of its own plane.
    assemble : The next step, the finite-element model.

    Examples
    --------
    >>> from beam import BRASS, StripSection, Tip, assemble, flat_u, natural_modes
    >>> leg = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
    >>> spring = flat_u(leg_length=0.13, bend_radius=9e-3, section=leg, tip=Tip(mass=4e-3))
    >>> [round(f, 1) for f in natural_modes(assemble(spring), count=3).frequencies_hz.tolist()]
    [13.4, 97.0, 288.2]
    """
    width = require_kind("section", section, StripSection, "a StripSection").width
    r = require_within("bend_radius", bend_radius, "m")
    require(r > 0.5 * width, "bend_radius", f"is {r} m; it must be above half the width of a leg, {width} m")
    if r > width:
        words = f"above the width of a leg, {width} m; such a bend also twists, unlike a plate"
        suspect(f"bend_radius is {r} m, {words}")
    legs, sections = _leg(leg_length, section, damped_section, damped_span)
    both = [replace(leg, width=2.0 * width, slot=2.0 * r - width) for leg in sections]
    outer = 2.0 * r + width
    bend = Straight(length=max(r, math.pi * r * width / outer))
    return LeafSpring(
        centreline=Centreline(pieces=(*legs, bend)),
        sections=(*both, replace(section, width=outer)),
        supports=("clamped", "free"),
        tip=tip,
        tip_at=leg_length + r,
        readouts=readouts or {},
    )


def straight_strip(
    *,
    length: float,
    section: StripSection | BeamSection,
    supports: tuple[Support, Support],
    tip_at: float,
    tip: Tip | None = None,
    damped_section: StripSection | None = None,
    damped_span: tuple[float, float] | None = None,
    readouts: Mapping[str, Readout] | None = None,
) -> LeafSpring:
    """Return a straight strip along x, driven along y, with any two supports and the tip anywhere.

    Parameters
    ----------
    length : float
        Length of the strip [m].
    section : StripSection or BeamSection
        Section of the strip without layer.
    supports : tuple of two Support
        Supports at x = 0 and at x = length: "clamped", "pinned", "guided" or "free".
    tip_at : float
        Distance of the tip from x = 0 [m].
    tip : Tip, optional
        The body at `tip_at`; without mass by default.
    damped_section : StripSection, optional
        Section of the strip with the glued layer; without it the strip is bare.
    damped_span : tuple of two floats, optional
        Start and end of the layer, measured from x = 0 [m]; the whole strip by default.
    readouts : mapping of str to Readout, optional
        Points where the motion is measured, by name.

    Returns
    -------
    LeafSpring
        The spring with one straight centreline.

    Raises
    ------
    ValueError
        If a length is not positive, a support is unknown or holds the tip, or a place is off the strip.
    TypeError
        If a value is of another class than stated above.

    Warns
    -----
    SuspiciousValue
        In the cases that are listed at `LeafSpring`.

    See Also
    --------
    cantilever : The strip that is clamped at one end, with its tip at the other.
    LeafSpring : A strip of any shape, with further points and supports.

    Examples
    --------
    >>> from beam import STEEL, StripSection, assemble, natural_modes, straight_strip
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> spring = straight_strip(length=0.2, section=strip, supports=("clamped", "clamped"), tip_at=0.1)
    >>> natural_modes(assemble(spring), count=3).coupled.tolist()  # mode 2 has a node at the tip
    [True, False, True]
    """
    pieces, sections = _leg(length, section, damped_section, damped_span)
    return LeafSpring(
        centreline=Centreline(pieces=pieces),
        sections=sections,
        supports=supports,
        tip=tip or Tip(),
        tip_at=tip_at,
        readouts=readouts or {},
    )


def cantilever(
    *, length: float, section: StripSection | BeamSection, tip: Tip | None = None, **others: Any
) -> LeafSpring:
    """Return a straight strip clamped at x = 0 and free at the other end, where the tip sits.

    Parameters
    ----------
    length : float
        Length of the strip [m].
    section : StripSection or BeamSection
        Section of the strip without layer.
    tip : Tip, optional
        The body at the free end; without mass by default.
    **others
        The parameters `damped_section`, `damped_span` and `readouts` of `straight_strip`.

    Returns
    -------
    LeafSpring
        The spring with one straight centreline, driven along y.

    Raises
    ------
    ValueError
        If a length is not positive, or a place is off the strip.
    TypeError
        If a value is of another class than stated above, or another parameter is unknown.

    Warns
    -----
    SuspiciousValue
        In the cases that are listed at `LeafSpring`.

    See Also
    --------
    straight_strip : A strip with any two supports and the tip anywhere.
    assemble : The next step, the finite-element model.

    Examples
    --------
    >>> from beam import STEEL, StripSection, Tip, cantilever
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> spring = cantilever(length=0.15, section=strip, tip=Tip(mass=2e-3))
    >>> spring.supports, spring.tip_at, round(1e3 * spring.strip_mass, 2)  # [1], [m], [g]
    (('clamped', 'free'), 0.15, 7.03)
    """
    supports: tuple[Support, Support] = ("clamped", "free")
    return straight_strip(length=length, section=section, supports=supports, tip_at=length, tip=tip, **others)


def _leg(
    length: float,
    bare: StripSection | BeamSection,
    damped: StripSection | None,
    span: tuple[float, float] | None,
) -> tuple[tuple[Straight, ...], tuple[StripSection | BeamSection, ...]]:
    """Return pieces and sections of a straight run, from the support outwards."""
    require_within("length of the straight strip or leg", length, "m", above=0)
    require_kind("damped_section", damped, (StripSection, type(None)), "a StripSection or None")
    if damped is None:
        require(span is None, "damped_span", f"is {span} m without a damped_section; give both or neither")
        return (Straight(length=length),), (bare,)
    ends = (0.0, length) if span is None else span
    start, end = require_array("damped_span", ends, "m", shape=(2,), words="its start and its end").tolist()
    rising = 0.0 <= start < end <= length
    require(rising, "damped_span", f"is {span} m; it must increase and lie between 0 and {length} m")
    runs = [(start, bare), (end - start, damped), (length - end, bare)]
    kept = [(Straight(length=run), section) for run, section in runs if run > 0.0]
    return tuple(piece for piece, _ in kept), tuple(section for _, section in kept)
