"""Independent routes to the modes of strips: the frequency equation, and many straight frame elements."""

import math

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import eigsh

from beam import StripSection, Tip, UniformBeam
from beam.space import SpatialSection

BENT = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
CARRIED = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
"""Stiffness and mass of a cubic element of unit length."""


def uniform_beam(
    section: StripSection, length: float, tip: Tip, supports: tuple = ("clamped", "free")
) -> UniformBeam:
    """The strip with a rigid body at its end, for the frequency equation."""
    numbers = dict(bending_stiffness=section.bending_stiffness, mass_per_length=section.mass_per_length)
    body = dict(tip_mass=tip.mass, tip_rotary_inertia=tip.rotary_inertia)
    return UniformBeam(length=length, supports=supports, **numbers, **body)


def polygon(radius: float, leg: int, bend: int) -> np.ndarray:
    """Points of a U with legs of 0.13 m: straight legs and a polygon in the bend."""
    x, turn = np.linspace(0.0, 0.13, leg + 1), np.linspace(-0.5 * np.pi, 0.5 * np.pi, bend + 1)[1:-1]
    lower = np.stack([x, np.full_like(x, -radius)], axis=1)
    arc = np.stack([0.13 + radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    return np.concatenate([lower, arc, lower[::-1] * [1.0, -1.0]])


def frame_frequencies(
    points: np.ndarray,
    section: SpatialSection,
    tip: Tip,
    count: int,
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    moves: tuple[int, ...] = (0, 1, 2, 3, 4, 5),
) -> np.ndarray:
    """Frequencies [Hz] of straight 12 x 12 Euler-Bernoulli elements between points of the plane z = 0.

    Both ends are clamped, the tip is a rigid body at `offset` from the middle node. Unknowns: displacement
    and rotation along x, y, z, of which only these `moves` are free.
    """
    rows, columns, stiff, heavy = [], [], [], []
    ea, gj, m = section.axial_stiffness, section.torsional_stiffness, section.mass_per_length
    for i, step in enumerate(np.diff(points, axis=0)):
        h = math.hypot(*step)
        k, g = np.zeros((12, 12)), np.zeros((12, 12))
        for (first, second), stiffness, mass in (((0, 6), ea, m), ((3, 9), gj, section.polar_inertia)):
            pair = np.ix_([first, second], [first, second])
            k[pair] = stiffness / h * np.array([[1, -1], [-1, 1]])
            g[pair] = mass * h / 6 * np.array([[2, 1], [1, 2]])
        arms = np.diag([1.0, h, 1.0, h])
        cubic, carried = arms @ BENT @ arms / h**3, m * h / 420 * arms @ CARRIED @ arms
        for places, sign, ei in (
            ([1, 5, 7, 11], 1.0, section.in_plane_stiffness),
            ([2, 4, 8, 10], -1.0, section.out_of_plane_stiffness),
        ):
            flip = np.diag([1.0, sign, 1.0, sign])  # a slope of v is a rotation about -n
            k[np.ix_(places, places)] += ei * flip @ cubic @ flip
            g[np.ix_(places, places)] += flip @ carried @ flip
        c, s = step / h
        turn = np.kron(np.eye(4), np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
        where = np.arange(6 * i, 6 * i + 12)
        rows.append(np.repeat(where, 12))
        columns.append(np.tile(where, 12))
        stiff.append((turn.T @ k @ turn).ravel())
        heavy.append((turn.T @ g @ turn).ravel())
    x, y, z = offset
    arm = np.hstack([np.eye(3), np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])])  # d + theta x c
    body = tip.mass * arm.T @ arm + np.diag([0, 0, 0] + 3 * [tip.rotary_inertia])
    at = 6 * (len(points) // 2) + np.arange(6)
    rows, columns = np.concatenate([*rows, np.repeat(at, 6)]), np.concatenate([*columns, np.tile(at, 6)])
    size = 6 * len(points)
    k, g = (
        coo_array((np.concatenate([*values, extra]), (rows, columns)), shape=(size, size)).tocsc()
        for values, extra in ((stiff, np.zeros(36)), (heavy, body.ravel()))
    )
    free = (6 * np.arange(1, len(points) - 1)[:, None] + np.array(moves)).ravel()
    values = eigsh(k[free][:, free], count, M=g[free][:, free], sigma=0.0, v0=np.ones(free.size))[0]
    return np.sqrt(np.sort(values)) / (2.0 * np.pi)
