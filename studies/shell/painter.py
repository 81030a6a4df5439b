"""A spring with its ball, its plates and its base, drawn in space: the picture of one moment.

    scenery = Scenery.of(modes, ball_radius=2.5e-3, gaps=[0.0119], amplitude=0.013)
    picture = stage_of(scenery)(Moment(points=displacements, base=np.zeros(3)))

matplotlib draws, without any graphics library: the outer faces that look to the viewer, the farthest first,
in parallel projection. `Moment` holds positions, touched plates and lines of text. A graph may stand below.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from beam import BALL, LAYER, STRIP, Modes, SpringMesh, StripSection, solid_spring
from studies.shell.scene.spring import metal_of
from studies.shell.scene.values import Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
"""Rows, columns, and red, green, blue."""

WIDTH, HEIGHT, GRAPH_HEIGHT = 880, 400, 150
"""Size of a picture and of the graph below it, in points; even numbers, as video needs them."""

DOTS = 100
"""Points an inch."""

ROWS = 120
"""Rows of cells along the spring, at least: a bend looks round."""

WALL = 0.004
"""Thickness of the plate [m]."""

DRIVE = np.array([0.0, 1.0, 0.0])
"""Direction in which the base of every scene moves; x runs along the spring, z across the strip."""

FROM_THE_TIP = np.array([-0.55, 0.42, 0.72])
TOWARDS_VIEWER = np.array([0.20, 0.30, 0.93])
"""Along the strip; and across it, a little from the side of the ball, which a wide strip would hide."""

COLOURS = {LAYER: "#4A4A4A", BALL: "#E9EDF2"}
BRASS, OTHER = "#D0A62B", "#68747F"
"""Strips of brass, and of steel or anything else."""
SHADES = 10
"""Of a colour, from a face seen edge on to one that looks to the viewer."""
PLATE, TOUCHED = "#8C9AA8", "#FF7A1A"
"""The plate, and its edges and all marks while it is touched."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """Displacements of the points of the mesh relative to the base, shape (n_points, 3), and of the base
    [m]; whether each plate is touched; lines of text above; place of the mark in the graph below."""

    points: Array
    base: Array
    touched: Sequence[bool] = ()
    lines: Sequence[str] = ()
    mark: tuple[float, float] = (np.nan, np.nan)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenery:
    """What is drawn: the solid spring at rest, the plates, and what holds everything.

    `plates` and `extent` are boxes, the lowest and the highest corner, shape (2, 3) [m]; `strip` is a colour,
    and `more` are boxes that stand still, with their colours.
    """

    mesh: SpringMesh
    plates: Sequence[Array]
    extent: Array
    strip: str
    more: tuple[tuple[Array, str], ...] = ()

    def placed(self, moment: Moment) -> Array:
        """The points of the mesh at a moment, shape (n_points, 3) [m]."""
        points: Array = self.mesh.points + moment.points + moment.base
        return points

    @staticmethod
    def of(modes: Modes, *, ball_radius: float, amplitude: float, gaps: Sequence[float] = ()) -> Scenery:
        """The scenery of a spring that moves by `amplitude` [m]; plates at `gaps` [m] from the ball, negative
        ones on its other side."""
        mesh, spring = solid_spring(modes, ball_radius=ball_radius), modes.discretization.spring
        rows = int(np.sum(mesh.part == STRIP))
        if rows < ROWS:
            mesh = solid_spring(modes, ball_radius=ball_radius, points_per_element=-(-ROWS // rows))
        plates, ball = list[Array](), mesh.points[np.unique(mesh.triangles)].mean(axis=0)
        half, beside = 2.0 * ball_radius, ball[:2] - spring.centreline.points(spring.tip_at)[:2]
        half_strip = 0.5 * spring.sections[0].thickness
        for gap in gaps:
            side = math.copysign(1.0, gap)
            surface = max(ball_radius, half_strip - side * beside[1])  # below the ball lies the strip
            corners = np.sort([(-half, 0.0, -half), (half, side * WALL, half)], axis=0)
            plate = ball + (side * surface + gap) * DRIVE + corners
            if abs(beside[0]) > abs(beside[1]):  # a ball beyond the end: the strip passes the plate
                plate[:, 0] += math.copysign(half - 0.75 * ball_radius, beside[0])
            plates.append(plate)
        cloud = np.concatenate([mesh.points - amplitude * DRIVE, mesh.points + amplitude * DRIVE, *plates])
        extent, section = np.array([cloud.min(axis=0), cloud.max(axis=0)]), spring.sections[0]
        brass = isinstance(section, StripSection) and metal_of(section.material) == "brass"
        strip = BRASS if brass else OTHER
        return Scenery(mesh=mesh, plates=plates, extent=extent, strip=strip)


def box(corners: Array, pieces: int = 8) -> Array:
    """Faces of a box, shape (n, 4, 3), cut into `pieces` each way: what is near one side of it is sorted."""
    low, high = corners
    u, v = (part.ravel() for part in np.mgrid[0:pieces, 0:pieces])
    square = np.array([(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)]) / pieces
    faces = []
    for axis in range(3):
        across = (axis + 1) % 3, (axis + 2) % 3
        for end in (0.0, 1.0):
            unit = np.empty((4, pieces**2, 3))
            unit[..., across], unit[..., axis] = square.transpose(0, 2, 1)[:: 1 if end else -1], end
            faces.append(low + unit * (high - low))
    return np.concatenate(faces, axis=1).transpose(1, 0, 2)


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A parallel projection into a window that is `half` wide and high on each side of `centre` [m].

    The rows of `axes` point right, up and towards the viewer.
    """

    axes: Array
    centre: Array
    half: Array

    @staticmethod
    def of(towards: Array, extent: Array, aspect: float) -> View:
        """The view from `towards` of all that is in the box `extent`; `aspect` is height over width."""
        towards = towards / np.linalg.norm(towards)
        right = np.cross(DRIVE, towards)
        axes = np.array([right / np.linalg.norm(right), np.zeros(3), towards])
        axes[1] = np.cross(towards, axes[0])
        corners = np.array(list(product(*extent.T))) @ axes.T
        low, high = corners.min(axis=0), corners.max(axis=0)
        wide = 0.53 * max(high[0] - low[0], (high[1] - low[1]) / aspect)
        return View(axes=axes, centre=0.5 * (low + high) @ axes, half=np.array([wide, wide * aspect]))

    def __call__(self, points: Array) -> Array:
        """Places in the window, from -1 to 1 each way, shape (..., 2)."""
        places: Array = (points - self.centre) @ self.axes[:2].T / self.half
        return places

    def painted(self, faces: Array, colours: Array, away: Array | float = 0.0) -> tuple[Array, Array]:
        """Faces in the window and their shaded colours, (n, 4, 2) and (n, 3), the farthest first; they count
        as farther by `away` [m]."""
        normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        light = normal @ self.axes[2] / np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
        order = np.argsort(faces.mean(axis=1) @ self.axes[2] - away)
        order = order[light[order] > 0.0]
        steps = np.ceil(SHADES * light[order, None]) / SHADES  # a film of few colours is a small file
        return self(faces[order]), colours[order] * (0.5 + 0.5 * steps)


def outline(places: Array) -> Array:
    """The line around places in a window, closed."""
    around = ConvexHull(places).vertices
    found: Array = places[[*around, around[0]]]
    return found


def lines_above(figure: Figure, moment: Moment) -> list[Text]:
    """Write the lines of a moment at the top; the last is marked while a plate is touched."""
    found: list[Text] = []
    (width, height) = figure.canvas.get_width_height()
    for row, line in enumerate(moment.lines):
        marked = row == len(moment.lines) - 1 and any(moment.touched)
        colour, up = TOUCHED if marked else "#5A5A5A" if row else "black", 1.0 - (8 + 24 * row) / height
        look: Any = {"color": colour, "weight": "bold" if marked else "normal", "fontsize": 11.5}
        found.append(figure.text(12 / width, up, line, **look, va="top", animated=True))
    return found


Stage = Callable[[Moment], Picture]


def stage_of(
    scenery: Scenery,
    towards: Array = TOWARDS_VIEWER,
    size: tuple[int, int] = (WIDTH, HEIGHT),
    graph: Callable[[Axes], object] | None = None,
) -> Stage:
    """Return a function from a moment to a picture of `size` points, seen from `towards`.

    `graph` draws axes that stand below each picture, with the mark of its moment.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    from studies.shell.plotting import house_style

    (quads, part), triangles = scenery.mesh.surface(), scenery.mesh.triangles
    corners = np.concatenate([quads, triangles[:, [0, 1, 2, 2]]])
    plates = [box(plate) for plate in scenery.plates]
    still, names = [(box(one), colour) for one, colour in scenery.more], {**COLOURS, STRIP: scenery.strip}
    named = [names[one] for one in [*part.tolist(), *[BALL] * len(triangles)]]
    named += [PLATE] * sum(map(len, plates))
    # seen from above, a plate under the ball is behind the strip, whose faces are as wide as the strip
    under = [plate[1, 1] < scenery.mesh.points[triangles, 1].min() for plate in scenery.plates]
    away = np.repeat([0.0, *under, 0.0], [len(corners), *map(len, plates), sum(len(one) for one, _ in still)])
    colours = np.array([to_rgb(one) for one in [*named, *(c for faces, c in still for _ in faces)]])
    view = View.of(towards, scenery.extent, size[1] / size[0])
    height = size[1] + (GRAPH_HEIGHT if graph else 0)
    below = 1.0 - size[1] / height
    figure = Figure(figsize=(size[0] / DOTS, height / DOTS), dpi=DOTS)
    canvas, place = FigureCanvasAgg(figure), (0.0, below, 1.0, 1.0 - below)
    axes = figure.add_axes(place, xlim=(-1, 1), ylim=(-1, 1), frame_on=False, xticks=[], yticks=[])
    seen = axes.add_collection(PolyCollection([], linewidths=0.4, antialiaseds=False, animated=True))
    (edge,) = axes.plot([], [], color=TOUCHED, linewidth=2.5, animated=True)
    artists = [seen, edge]
    if graph:
        with house_style():
            graph(lower := figure.add_axes((0.07, 0.3 * below, 0.87, 0.65 * below)))
        artists += lower.plot([], [], "o", markersize=7, animated=True)
    canvas.draw()
    still_part = canvas.copy_from_bbox(figure.bbox)

    def picture(moment: Moment) -> Picture:
        moved = [plate + moment.base for plate in plates]
        faces = np.concatenate([scenery.placed(moment)[corners], *moved, *(one for one, _ in still)])
        places, shades = view.painted(faces, colours, away)
        seen.set(verts=places, facecolors=shades, edgecolors=shades)
        rims, gap = [np.empty((0, 2))], np.full((1, 2), np.nan)  # no line from one rim to the next
        for plate, touched in zip(moved, moment.touched, strict=False):
            rims += [outline(view(plate.reshape(-1, 3))), gap] if touched else []
        edge.set_data(*np.concatenate(rims).T)
        texts = lines_above(figure, moment)
        if graph:
            colour = TOUCHED if any(moment.touched) else "black"
            artists[-1].set(data=np.reshape(moment.mark, (2, 1)), color=colour)
        canvas.restore_region(still_part)
        for artist in [*artists, *texts]:
            figure.draw_artist(artist)
        for text in texts:
            text.remove()
        return np.asarray(canvas.buffer_rgba(), dtype=np.uint8)[..., :3].copy()

    return picture


def draw_rig(
    axes: Axes, scene: Scene, modes: Modes, coordinates: Sequence[Array], names: Sequence[str] = ("",)
) -> None:
    """The spring with ball, plate and base, in true scale, displaced by modal `coordinates` [m], one row a
    position: the first as it is, the others paler and with their names."""
    radius, gap, size = scene.tip.ball_radius_m, scene.stop.gap_m, (1274, 980)
    scenery = Scenery.of(modes, ball_radius=radius, gaps=[gap], amplitude=gap)
    mesh, wide = scenery.mesh, 1.3 * float(np.abs(scenery.mesh.points[:, 2]).max())
    base = np.array([(-0.8 * wide, -0.5 * wide, -wide), (0.1 * wide, 0.5 * wide, wide)])
    extent = np.array([np.minimum(scenery.extent[0], base[0]), np.maximum(scenery.extent[1], base[1])])
    scenery = replace(scenery, extent=extent, more=((base, COLOURS[LAYER]),))
    moving = np.flatnonzero(modes.coupled)[: len(coordinates[0])]
    moved = np.tensordot(np.array(coordinates), mesh.shapes[moving], 1)
    stage, view = stage_of(scenery, FROM_THE_TIP, size), View.of(FROM_THE_TIP, extent, size[1] / size[0])
    seen, *others = (stage(Moment(points=points, base=np.zeros(3))).astype(float) for points in moved)
    for share, one in zip((0.3, 0.2), others, strict=False):
        pale = 255.0 - share * (255.0 - one)
        seen = np.where(np.all(seen == 255.0, axis=2, keepdims=True), pale, seen)
    axes.imshow(seen.astype(np.uint8), extent=(-1, 1, -1, 1), aspect="auto")
    end = int(np.argmax(view(mesh.points)[:, 0]))
    ball, plate = mesh.points[np.unique(mesh.triangles)].mean(axis=0), scenery.plates[0]
    marks = [
        ("plate", plate.mean(axis=0), (-16, 12), "right"),
        ("base", base.mean(axis=0), (0, -42), "center"),
    ]
    marks += [("ball", ball + moved[0][mesh.triangles[0, 0]], (-52, 8), "right")]
    if np.any(mesh.part == LAYER):
        place = (mesh.points + moved[0])[mesh.hexahedra[len(mesh.hexahedra) // 9, 0]]
        marks += [("damping tape", place, (-24, 36), "right")]
    marks += [(n, (mesh.points + one)[end], (5, 0), "left") for n, one in zip(names, moved, strict=True) if n]
    for name, point, offset, side in marks:
        line = {"arrowstyle": "-", "color": "0.3"} if name in ("ball", "damping tape") else None
        look: Any = {"textcoords": "offset points", "ha": side, "va": "center", "arrowprops": line}
        axes.annotate(name, (*view(point),), offset, color="0.3", annotation_clip=False, **look)
    axes.axis("off")
