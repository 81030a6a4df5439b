"""The film of an orbit: from the motion to pictures, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beam import Modes
from beam.spring_mesh import STRIP, SpringMesh, solid_spring
from studies.instruments.motion.bench import bench_of
from studies.instruments.motion.filmed_orbit import FilmedOrbit
from studies.instruments.motion.magnified_shape import MagnifiedShape, magnified_shape
from studies.instruments.motion.scene_bodies import Bodies, Moment, Stage, bodies_of
from studies.instruments.motion.view import View, view_of

__all__ = ["OrbitFilm", "orbit_film", "smooth_mesh", "stage_of"]

ROWS = 120
"""Rows of cells along the spring, at least: a bend looks round."""


SLOW_WEIGHT = 4.0
"""Weight of a frame in slow motion, beyond that of the flight, among the stills."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OrbitFilm:
    """Everything that the frames show.

    Parameters
    ----------
    orbit : FilmedOrbit
    mesh : SpringMesh
    shape : MagnifiedShape
    bodies : Bodies
    view : View
    drive : ndarray, shape (3,)
        Direction of the base motion, from the ball to the plate.
    shaken : bool
        Whether the base is seen to move: the viewer stands in the laboratory, not on the base.
    reach : ndarray, shape (3,)
        Largest displacement of the base as it is drawn [m].
    """

    orbit: FilmedOrbit
    mesh: SpringMesh
    shape: MagnifiedShape
    bodies: Bodies
    view: View
    drive: NDArray[np.float64]
    shaken: bool
    reach: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Number of frames."""
        return int(self.orbit.law.time.size)

    def moment(self, number: int) -> Moment:
        """Where everything is in a frame."""
        base, tip = float(self.orbit.base[number]), float(self.orbit.tip[number])
        return Moment(
            points=self.shape.displacement(self.orbit.coordinates[number]),
            ball=tip * self.drive,
            base=base * self.drive if self.shaken else np.zeros(3),
            pressed=max(0.0, tip - self.orbit.oscillator.stop.gap) * self.drive,
            flash=bool(self.orbit.touching[number]),
        )

    def stills(self, count: int) -> list[int]:
        """Frames for a contact sheet: more of them where time is slow, and the strongest contact among
        them."""
        slowed = self.orbit.law.slowed
        weight = np.cumsum(np.where(slowed > slowed.min(), SLOW_WEIGHT, 1.0))
        wanted = np.linspace(weight[0], weight[-1], count)
        chosen = np.searchsorted(weight, wanted - 1e-9)
        touching = np.flatnonzero(self.orbit.touching)
        if touching.size and not np.any(self.orbit.touching[chosen]):
            force = np.nan_to_num(self.orbit.force[touching], nan=0.0)
            strongest = int(touching[np.argmax(force)])
            chosen[1 + np.argmin(np.abs(chosen[1:-1] - strongest))] = strongest
        return [int(number) for number in np.unique(chosen)]


def orbit_film(
    orbit: FilmedOrbit,
    modes: Modes,
    *,
    ball_radius: float,
    width: int,
    height: int,
    shaken: bool,
    magnification: float | None = None,
) -> OrbitFilm:
    """The film of a filmed orbit; `magnification` of the higher modes is chosen unless it is given."""
    spring = modes.discretization.spring
    mesh = smooth_mesh(modes, ball_radius)
    shape = magnified_shape(mesh, modes, orbit.coordinates, magnification)
    drive = np.array([*spring.drive, 0.0])
    swing = float(np.abs(orbit.tip).max())
    bench = bench_of(mesh, modes, ball_radius=ball_radius, gap=orbit.oscillator.stop.gap, swing=swing)
    reach = float(np.abs(orbit.base).max()) * drive if shaken else np.zeros(3)
    drawn = [mesh.points + shape.displacement(row) for row in orbit.coordinates]
    cloud = np.concatenate([bench.points, *drawn])
    view = view_of(np.concatenate([cloud - reach, cloud + reach]), spring.drive, width=width, height=height)
    return OrbitFilm(
        orbit=orbit,
        mesh=mesh,
        shape=shape,
        bodies=bodies_of(mesh, modes, bench, ball_radius),
        view=view,
        drive=drive,
        shaken=shaken,
        reach=reach,
    )


def smooth_mesh(modes: Modes, ball_radius: float) -> SpringMesh:
    """The solid spring with enough cells to look smooth."""
    mesh = solid_spring(modes, ball_radius=ball_radius)
    rows = int(np.sum(mesh.part == STRIP))
    if rows >= ROWS:
        return mesh
    return solid_spring(modes, ball_radius=ball_radius, points_per_element=-(-ROWS // rows))


def stage_of(renderer: str, bodies: Bodies, view: View) -> Stage:
    """The stage of this name, "vtk" or "matplotlib"."""
    if renderer == "vtk":
        from studies.instruments.motion.rendered_stage import RenderedStage

        return RenderedStage(bodies, view)
    from studies.instruments.motion.painted_stage import PaintedStage

    return PaintedStage(bodies, view)
