"""Leaf springs of the usual shapes, bare or with a glued damping layer.

The folded U has two legs, parallel to x and 2 r apart, clamped at x = 0. A semicircle of radius r [m] joins
them, with the ball in its middle. The drive is along y, in the plane of the U (sway).

The flat U is cut out of a sheet, clamped at x = 0 and driven along y, across the sheet. Its legs lie side by
side and bend as one strip with a slot. The bend, a half ring of radius r and width b, is replaced by a plate
of its area as wide as the U, 2 r + b. The ball sits at the apex, at r from the legs. A strip in space
(``beam.space``) checks this, for b = 12 mm, r = 9 mm and legs of 130 mm. The first four frequencies differ by
1 % at most (0.02, 0.1, 0.4, 1), the displacements of the tip by 3 % (0.01, 0.03, 0.7, 2.6). For r = 1.25 b
the differences are 1-4 % and 1-6 %.

The straight strip runs along x from x = 0 and is driven along y. A cantilever is clamped there, free at the
other end, and carries the tip at its free end.
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
    section, damped_section : StripSection
        Section of the bare strip, and if given of the strip with the glued layer.
    tip : Tip
    damped_span : tuple of two floats, optional
        Start and end of the layer on each leg, measured from the supports [m]; the whole leg by default.
    readouts : mapping of str to Readout, optional
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
    tip, damped_section, damped_span, readouts
        As for `folded_u`.
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
    section, damped_section, damped_span
        As for `folded_u`, the span measured from x = 0.
    supports : tuple of two supports
    tip_at : float
        Distance of the tip from x = 0 [m].
    tip : Tip, optional
        Without mass by default.
    readouts : mapping of str to Readout, optional
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
    """Return a `straight_strip` clamped at x = 0 and free at x = length [m], where the tip sits.

    `length`, `section`, `tip` and `others` are as for `straight_strip`.
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
