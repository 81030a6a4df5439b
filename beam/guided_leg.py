"""The straight equivalent of the folded U: one guided leg with half of the ball.

In sway the two legs of the U bend alike; the bend ties their ends together and keeps them from turning,
up to its own bending. One leg, clamped and guided, of the length that gives half the sway stiffness of
the U, with half of the ball and of the bend's surplus mass at its end, is the simplest model with all
bending modes.

Half of the U under half of a force F on the ball, along the drive: with the axial force X that the other
half puts on the middle of the bend, and B = EI, the moments are

    bend, angle a from the middle   M = (F/2) r (1 - cos a) - X r sin a
    leg, t from the bend            M = (F/2)(r + t) - X r

X follows from no displacement of the middle along the legs, int M dM/dX ds / B = 0, and the sway per
force from int M dM/d(F/2) ds / B; with S(g) = int g ds / B over half of the U, and E the extension of the
leg per axial force, int ds / EA,

    2 y / F = S(p^2) - S(p n)^2 / (S(n^2) + E),   p = r (1 - cos a) or r + t,   n = r sin a or r.

The guided leg of length l, with M = P (t - t0) and no rotation of its end, has y / P = S(t^2) - S(t)^2 /
S(1). Its length beyond the leg itself, of the bare section, is the one at which both are equal: between
0.6 and 1 bend radius. The leg's extension counts for (thickness/r)^2/4; that of the bend is left out.

Two such legs move as one: phi -> phi/sqrt(2), participation -> sqrt(2) participation, half the
compliance, twice the tip mass. Units: SI.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .centreline import Arc, Centreline, Straight
from .modal_model import ModalModel
from .parameters import require, require_kind
from .section import StripSection
from .spring import LeafSpring, Tip

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(20)

LONGEST = 10.0
"""Bound of the search for the added length, in bend radii."""


def straight_equivalent(spring: LeafSpring) -> LeafSpring:
    """Return the guided leg with the sway stiffness of half of `spring`, a folded U.

    A read-out point keeps its distance from the nearer support; one on the bend goes to the guided end.

    Raises
    ------
    ValueError
        Unless `spring` is a folded U: legs, a bend of half a turn, the same legs back, clamped, ball in the
        middle of the bend, driven across the legs.
    """
    legs, bare, radius = _half(spring)
    bending = [(length, section.bending_stiffness) for length, section in legs]
    stretch = sum(length / section.axial_stiffness for length, section in legs)
    wanted = _half_compliance(bending, bare.bending_stiffness, radius, stretch)

    def surplus(extension: float) -> float:
        return _guided_compliance([*bending, (extension, bare.bending_stiffness)]) / wanted - 1.0

    extension = float(brentq(surplus, 0.0, LONGEST * radius, xtol=1e-15, rtol=1e-14))
    length, whole = sum(piece for piece, _ in legs), spring.centreline.length
    end = length + extension
    surplus_mass = (0.5 * math.pi * radius - extension) * bare.mass_per_length
    if legs[-1][1] == bare:  # one piece with what stands for the bend
        pieces = [*legs[:-1], (legs[-1][0] + extension, bare)]
    else:
        pieces = [*legs, (extension, bare)]
    return LeafSpring(
        centreline=Centreline(pieces=tuple(Straight(length=piece) for piece, _ in pieces)),
        sections=tuple(section for _, section in pieces),
        supports=("clamped", "guided"),
        tip=Tip(mass=0.5 * spring.tip.mass + surplus_mass),
        tip_at=end,
        readouts={
            name: replace(point, at=min(point.at, whole - point.at, end))
            for name, point in spring.readouts.items()
        },
    )


def _half(spring: LeafSpring) -> tuple[list[tuple[float, StripSection]], StripSection, float]:
    """Lengths and sections of a leg, support first, section and radius of the bend; ValueError if no U."""
    require_kind("spring", spring, LeafSpring, "a LeafSpring")
    pieces, sections = spring.centreline.pieces, spring.sections
    middle = len(pieces) // 2
    bend = pieces[middle]
    folded = (
        len(pieces) % 2 == 1
        and isinstance(bend, Arc)
        and math.isclose(bend.angle, math.pi)
        and pieces[:middle] == pieces[:middle:-1]
        and sections[:middle] == sections[:middle:-1]
        and all(isinstance(piece, Straight) for piece in pieces[:middle])
        and spring.supports == ("clamped", "clamped")
        and math.isclose(spring.tip_at, 0.5 * spring.centreline.length)
        and abs(spring.drive[0]) < 1e-12
    )
    require(
        folded,
        f"centreline has {len(pieces)} pieces [no unit] that are no folded U; the straight equivalent needs "
        "two equal clamped legs, a bend of half a turn with the ball amid it, and a drive across the legs",
    )
    lengths = [piece.length for piece in pieces[:middle]]
    return list(zip(lengths, sections[:middle], strict=True)), sections[middle], 1.0 / bend.curvature


def as_one_spring(half: ModalModel) -> ModalModel:
    """Return the model of two such legs that move as one, from `half`, the model of one of them."""
    require_kind("half", half, ModalModel, "a ModalModel")
    root = math.sqrt(2.0)
    return replace(
        half,
        phi=half.phi / root,
        participation=half.participation * root,
        static_compliance=None if half.static_compliance is None else 0.5 * half.static_compliance,
        tip_mass=None if half.tip_mass is None else 2.0 * half.tip_mass,
        readouts={name: row / root for name, row in half.readouts.items()},
    )


def _points(start: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss points and weights on an interval."""
    half = 0.5 * (end - start)
    return start + half * (_POINTS + 1.0), half * _WEIGHTS


def _half_compliance(
    legs: list[tuple[float, float]], bend_stiffness: float, radius: float, stretch: float
) -> float:
    """Sway of the ball per half of the force on it [m/N]."""
    a, weight = _points(0.0, 0.5 * math.pi)
    pieces = [(radius * (1.0 - np.cos(a)), radius * np.sin(a), weight * radius / bend_stiffness)]
    at = 0.0
    for length, stiffness in reversed(legs):  # from the bend to the support
        t, weight = _points(at, at + length)
        pieces.append((radius + t, np.full(t.size, radius), weight / stiffness))
        at += length
    p, n, w = (np.concatenate(rows) for rows in zip(*pieces, strict=True))
    return float(w @ p**2 - (w @ (p * n)) ** 2 / (w @ n**2 + stretch))


def _guided_compliance(pieces: list[tuple[float, float]]) -> float:
    """End displacement per force of a clamped and guided beam of pieces (length, EI), support first [m/N]."""
    zero = first = second = at = 0.0
    for length, stiffness in reversed(pieces):  # t from the guided end
        end = at + length
        zero += (end - at) / stiffness
        first += (end**2 - at**2) / (2.0 * stiffness)
        second += (end**3 - at**3) / (3.0 * stiffness)
        at = end
    return second - first**2 / zero
